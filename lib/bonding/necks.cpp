// necks.cpp: the factor on all necks, sought between bounds.
#include "bonding/necks.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "bonding/union_volume.h"
#include "physics/neck.h"

namespace kiln::bonding {

namespace {

constexpr double volume_tolerance = 1e-5;  // of the solid
constexpr double power_of_growth = 4.0;    // volume of a thin neck with its radius
constexpr int max_trials = 40;

class NeckSearch {
   public:
    NeckSearch(const State& state, const physics::RecordedContacts& contacts, const Watch& watch)
        : state_(state),
          contacts_(contacts),
          pairs_(contacts.pairs),
          watch_(watch),
          mass_(particle_volume(state.particles)),
          volume_(state.box, state.particles.position, state.particles.radius, pairs_) {
        for (const Material& material : state.materials) limit_.push_back(physics::neck_limit(material));
        sizes_.radius.resize(pairs_.size());
        watch_.at(0.3);
    }

    /// Necks of a factor, and how much their union with the spheres is above the mass, over that.
    double excess(double factor) {
        sizes_.factor = factor;
        sizes_.limited = 0;
        for (std::size_t pair = 0; pair < pairs_.size(); ++pair) sizes_.radius[pair] = neck(pair, factor);
        const VolumeEstimate all = volume_.with_necks(sizes_.radius);
        sizes_.union_volume = all.value;
        sizes_.union_error = all.error;
        watch_.at(1.0 - 0.7 / ++trials_);
        return all.value / mass_ - 1.0;
    }

    /// By secants of the logarithms of factor and volume of the necks, kept between a factor that is too small and one that is
    /// too large.
    void find_factor() {
        const double missing = 1.0 - volume_.spheres().value / mass_;  // of the mass, without necks
        if (pairs_.empty() || missing <= volume_tolerance) return static_cast<void>(excess(1.0));
        double low = 0.0, high = max_neck_factor, factor = 1.0, power = power_of_growth, last_factor = 0.0, last_filled = 0.0;
        for (int trial = 0; trial < max_trials; ++trial) {
            const double filled = 1.0 + excess(factor) / missing;  // of what is missing
            if (std::abs(filled - 1.0) * missing <= volume_tolerance) return;
            sizes_.fills = filled > 1.0 || factor < max_neck_factor;
            if (!sizes_.fills) return;
            (filled < 1.0 ? low : high) = factor;
            if (last_filled > 0.0 && filled > 0.0)
                power = std::max(1.0, std::log(filled / last_filled) / std::log(factor / last_factor));
            last_factor = factor;
            last_filled = filled;
            const double next = filled > 0.0 ? factor * std::pow(filled, -1.0 / power) : max_neck_factor;
            factor = next > low && next < high                   ? next
                     : next >= high && high == max_neck_factor ? max_neck_factor
                                                                 : 0.5 * (low + high);
        }
    }

    NeckSizes take() { return std::move(sizes_); }

   private:
    double neck(std::size_t contact, double factor) {
        const Pair& pair = pairs_[contact];
        const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
        const auto limit_of = [&](std::size_t row) { return limit_[static_cast<std::size_t>(state_.particles.material[row])]; };
        const double first = state_.particles.radius[i], second = state_.particles.radius[j], smaller = std::min(first, second);
        double max = std::min({limit_of(i), limit_of(j), 1.0}) * smaller;
        if (contacts_.recorded[contact]) max = std::max(max, std::min(contacts_.neck[contact], smaller));
        const double distance = pair_vector(state_.box, state_.particles.position, pair).norm();
        const double radius = physics::neck_radius(factor * contacts_.neck[contact], distance, first, second, max);
        sizes_.limited += radius >= max;
        return radius;
    }

    const State& state_;
    const physics::RecordedContacts& contacts_;
    std::span<const Pair> pairs_;
    const Watch& watch_;
    double mass_;  // m3
    UnionVolume volume_;
    std::vector<double> limit_;  // of each material
    NeckSizes sizes_;
    int trials_ = 0;
};

}  // namespace

NeckSizes neck_sizes(const State& state, const physics::RecordedContacts& contacts, Necks necks, const Watch& watch) {
    NeckSearch search(state, contacts, watch);
    if (necks == Necks::law)
        search.excess(1.0);
    else
        search.find_factor();
    return search.take();
}

}  // namespace kiln::bonding
