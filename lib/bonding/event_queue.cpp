// event_queue.cpp: the exact shrinking of overlapping spheres, from separation to separation.
//
// Time is the sweep parameter s (m): dR summed over the sweeps. A particle's radius falls at a rate that never rises, because its
// overlaps only become fewer. So the end of an overlap, foretold from the present rates, can only move later: a queue sorted by
// foretold ends is right if the foremost is foretold anew before it is believed.
#include "bonding/event_queue.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace kiln::bonding {

namespace {

constexpr std::size_t turns_between_looks = 10000;  // of the queue; a few milliseconds

/// radius(s) = intercept - rate s, since the last change at s = since.
struct Particle {
    double intercept;           // m
    double rate = 0.0;          // radius lost per s
    double since = 0.0;         // m
    double given = 0.0;         // m3, what each of its overlaps has had from it, all of them having begun at s = 0
    double smallest;            // m
    std::int32_t overlaps = 0;  // ends of overlaps at this particle
    bool stopped = false;

    double radius(double s) const { return intercept - rate * s; }

    /// When it comes down to its smallest radius.
    double stop() const { return rate > 0.0 ? (intercept - smallest) / rate : std::numeric_limits<double>::infinity(); }

    void settle(double s) {
        const double before = radius(since);
        const double after = radius(s);
        if (rate > 0.0)
            given += 4.0 / 3.0 * std::numbers::pi * rate * (s - since) * (before * before + before * after + after * after) /
                     overlaps;
        since = s;
    }

    /// After settle(): goes on at a new rate.
    void go_on(double new_rate) {
        intercept = radius(since) + new_rate * since;
        rate = new_rate;
    }
};

struct Event {
    double s;  // m, foretold, never too late
    std::uint32_t overlap;
};

/// Later than: puts the earliest event on top of a standard heap; ties go by the overlap's number.
bool later(const Event& left, const Event& right) {
    return left.s != right.s ? left.s > right.s : left.overlap > right.overlap;
}

class Shrinking {
   public:
    Shrinking(std::span<const double> radius, std::span<const Overlap> overlaps, Sharing sharing)
        : overlaps_(overlaps), sharing_(sharing), volume_(overlaps.size()) {
        particles_.reserve(radius.size());
        for (const double r : radius) particles_.push_back({.intercept = r, .smallest = min_share * r});
        for (const Overlap& overlap : overlaps) {
            ++first(overlap).overlaps;
            ++second(overlap).overlaps;
        }
        for (Particle& particle : particles_) particle.go_on(rate(particle));
        for (std::uint32_t index = 0; index < overlaps.size(); ++index) events_.push_back({foretell(overlaps[index]), index});
        std::make_heap(events_.begin(), events_.end(), later);
    }

    ShrunkSpheres run(const Watch& watch) {
        for (std::size_t turn = 0; !events_.empty(); ++turn) {
            if (turn % turns_between_looks == 0)
                watch.at(1.0 - static_cast<double>(events_.size()) / static_cast<double>(overlaps_.size()));
            std::pop_heap(events_.begin(), events_.end(), later);
            Event& event = events_.back();
            const double s = foretell(overlaps_[event.overlap]);
            if (s <= event.s && happens(event)) {
                events_.pop_back();
                continue;
            }
            event.s = std::max(s, now_);
            std::push_heap(events_.begin(), events_.end(), later);
        }
        ShrunkSpheres result;
        result.volume = std::move(volume_);
        for (const Particle& particle : particles_) {
            result.radius.push_back(particle.intercept);
            result.stopped += particle.stopped;
        }
        return result;
    }

   private:
    Particle& first(const Overlap& overlap) { return particles_[static_cast<std::size_t>(overlap.first)]; }
    Particle& second(const Overlap& overlap) { return particles_[static_cast<std::size_t>(overlap.second)]; }

    double rate(const Particle& particle) const {
        if (particle.stopped || particle.overlaps == 0) return 0.0;
        return sharing_ == Sharing::pair ? particle.overlaps : 1.0;
    }

    /// When the spheres touch, r_i + r_j = d, at the present rates.
    double end(const Overlap& overlap) {
        const Particle& a = first(overlap);
        const Particle& b = second(overlap);
        const double closing = a.rate + b.rate;
        return closing > 0.0 ? (a.intercept + b.intercept - overlap.distance) / closing : now_;
    }

    double foretell(const Overlap& overlap) {
        return std::max(now_, std::min({end(overlap), first(overlap).stop(), second(overlap).stop()}));
    }

    /// What the event stands for: true for the end of its overlap, false if one of its particles has stopped.
    bool happens(const Event& event) {
        const Overlap& overlap = overlaps_[event.overlap];
        Particle& a = first(overlap);
        Particle& b = second(overlap);
        const double touching = end(overlap);
        now_ = std::max(now_, event.s);
        a.settle(now_);
        if (&a != &b) b.settle(now_);
        const bool ends = touching <= std::min(a.stop(), b.stop());
        if (ends) {
            volume_[event.overlap] = a.given + b.given;
            --a.overlaps;
            --b.overlaps;
        } else {
            (a.stop() <= b.stop() ? a : b).stopped = true;
        }
        a.go_on(rate(a));
        if (&a != &b) b.go_on(rate(b));
        return ends;
    }

    std::span<const Overlap> overlaps_;
    Sharing sharing_;
    std::vector<Particle> particles_;
    std::vector<double> volume_;
    std::vector<Event> events_;
    double now_ = 0.0;
};

}  // namespace

ShrunkSpheres shrink_exactly(std::span<const double> radius, std::span<const Overlap> overlaps, Sharing sharing,
                             const Watch& watch) {
    return Shrinking(radius, overlaps, sharing).run(watch);
}

}  // namespace kiln::bonding
