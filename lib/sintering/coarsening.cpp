// coarsening.cpp: substeps of the exchange of volume: flows over the necks, what each grain gives, what that does to radii and
// necks.
#include "sintering/coarsening.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/grouping.h"
#include "core/parallel.h"
#include "physics/coarsening.h"
#include "physics/materials.h"

namespace kiln::sintering {

namespace {

constexpr double max_fraction = 0.3;       // of its volume, that a grain gives or gets in a substep
constexpr double small_grain = 0.05;       // of the mean volume, below which a grain does not limit substeps
constexpr double vanishing = 1e-6;         // of its first volume, that is no grain any more
constexpr double shortening = 0.95;        // of a substep in which a grain would get too much
constexpr int max_shortenings = 60;

std::size_t at(std::int32_t row) { return static_cast<std::size_t>(row); }

double radius_of(double volume) { return std::cbrt(0.75 / std::numbers::pi * volume); }

/// Material data integrated over a span of time, of each material.
struct Dose {
    std::vector<double> surface;   // gamma D_s' t, m4
    std::vector<double> boundary;  // M gamma_gb t, m2
};

/// Outflows of a grain over its volume if they lasted for the whole dose.
struct Outflow {
    double surface = 0.0, boundary = 0.0;

    double fraction(double part) const { return physics::fraction_given(part * surface, part * boundary); }
};

/// The pairs of a body that touch. Those that come to touch while grains grow do so from the next rest on: which others are in the
/// body's list is chance.
std::vector<Pair> contacts_of(const SinteringBody& body) {
    const std::vector<Pair>& pairs = body.pairs();
    std::vector<char> touches(pairs.size());
    for_rows(pairs.size(), [&](std::size_t row) { touches[row] = body.overlap(pairs[row]) >= 0.0; });
    std::vector<Pair> contacts;
    for (std::size_t row = 0; row < pairs.size(); ++row)
        if (touches[row]) contacts.push_back(pairs[row]);
    return contacts;
}

/// One rest of a body: its grains step by step through the dose.
class Exchange {
   public:
    Exchange(const SinteringBody& body, const Kinetics& kinetics, const CoarseningSettings& settings, const Dose& dose)
        : body_(body),
          settings_(settings),
          dose_(dose),
          pairs_(contacts_of(body)),
          start_{body.particles().radius, std::vector<double>(pairs_.size())},
          volume_(body.size()),
          like_(pairs_.size()),
          distance_(pairs_.size()),
          sine_(pairs_.size()),
          surface_(pairs_.size()),
          boundary_(pairs_.size()),
          touched_(pairs_.size(), false),
          outflow_(body.size()),
          given_(body.size()) {
        const Particles& particles = body.particles();
        for_rows(body.size(), [&](std::size_t row) { volume_[row] = sphere_volume(start_.radius[row]); });
        for_rows(pairs_.size(), [&](std::size_t row) {
            const Pair& pair = pairs_[row];
            like_[row] = pair.i != pair.j && particles.material[at(pair.i)] == particles.material[at(pair.j)];
            distance_[row] = body.vector(pair).norm();
            start_.overlap[row] = body.overlap(pair);
            sine_[row] = kinetics.neck_limit(kinetics.row(particles, pair));
        });
        ends_ = group_by<std::int32_t>(body.size(), [&](const auto& visit) {
            for (std::size_t row = 0; row < pairs_.size(); ++row) {
                if (!like_[row]) continue;
                visit(at(pairs_[row].i), static_cast<std::int32_t>(row));
                visit(at(pairs_[row].j), static_cast<std::int32_t>(row));
            }
        });
        middle_ = start_;
    }

    Coarsening::Change run() {
        for (double left = 1.0; left > 0.0;) {
            const double part = substep(left);
            left = part < left ? left - part : 0.0;
            ++change_.substeps;
        }
        return finish();
    }

   private:
    /// Radii of the grains and overlaps of the contacts, m.
    struct Stage {
        std::vector<double> radius, overlap;
    };

    double material_dose(const std::vector<double>& dose, const Pair& pair) const {
        return dose[at(body_.particles().material[at(pair.i)])];
    }

    /// True for a pair that exchanges volume while it is as in the stage.
    bool exchanges(const Stage& stage, std::size_t row) const {
        const double first = stage.radius[at(pairs_[row].i)], second = stage.radius[at(pairs_[row].j)];
        return like_[row] && stage.overlap[row] > 0.0 && first > 0.0 && second > 0.0 && first != second;
    }

    /// Flows over a neck, m3, if they lasted for the whole dose as they are in the stage.
    void find_flow(const Stage& stage, std::size_t row) {
        surface_[row] = boundary_[row] = 0.0;
        if (!exchanges(stage, row)) return;
        const Pair& pair = pairs_[row];
        const auto [small, large] = std::minmax(stage.radius[at(pair.i)], stage.radius[at(pair.j)]);
        const double neck =
            std::sqrt(physics::contact_radius_squared(stage.overlap[row], physics::reduced_radius(small, large)));
        if (settings_.surface) surface_[row] = material_dose(dose_.surface, pair) * physics::surface_flow(small, large, neck);
        if (settings_.boundary && neck >= (settings_.chi - physics::neck_slack) * small)
            boundary_[row] = material_dose(dose_.boundary, pair) * physics::boundary_flow(small, large, neck);
    }

    /// The grain that gives over a neck is the smaller one at the start of the substep, or where they are equal then, in its
    /// middle.
    std::int32_t donor(const Pair& pair) const {
        const double first = start_.radius[at(pair.i)], second = start_.radius[at(pair.j)];
        if (first == second) return middle_.radius[at(pair.i)] < middle_.radius[at(pair.j)] ? pair.i : pair.j;
        return first < second ? pair.i : pair.j;
    }

    void sum_outflows() {
        for_rows(volume_.size(), [&](std::size_t grain) {
            Outflow sum;
            for (const std::int32_t row : ends_.of(grain)) {
                if (at(donor(pairs_[at(row)])) != grain) continue;
                sum.surface += surface_[at(row)];
                sum.boundary += boundary_[at(row)];
            }
            const double volume = volume_[grain];
            outflow_[grain] = volume > 0.0 ? Outflow{sum.surface / volume, sum.boundary / volume} : Outflow{};
        });
    }

    /// What a grain gets in the last give(), m3.
    double inflow(std::size_t grain) const {
        double sum = 0.0;
        for (const std::int32_t row : ends_.of(grain)) {
            const std::size_t giver = at(donor(pairs_[at(row)]));
            if (giver == grain || !(given_[giver] > 0.0)) continue;
            const double flow = surface_[at(row)] + boundary_[at(row)];
            sum += given_[giver] * flow / ((outflow_[giver].surface + outflow_[giver].boundary) * volume_[giver]);
        }
        return sum;
    }

    /// Volumes that the grains give away in a part of the dose by their outflows.
    void give(double part) {
        for_rows(volume_.size(), [&](std::size_t grain) { given_[grain] = volume_[grain] * outflow_[grain].fraction(part); });
    }

    /// Part of the dose in which no grain but the smallest gives or gets too much.
    double allowed(double left) {
        double total = 0.0, grains = 0.0;
        for (const double volume : volume_) {
            total += volume;
            grains += volume > 0.0;
        }
        const double counts = small_grain * total / std::max(grains, 1.0);
        double part = left;
        for (std::size_t grain = 0; grain < volume_.size(); ++grain) {
            const Outflow& out = outflow_[grain];
            if (volume_[grain] > counts && out.surface + out.boundary > 0.0)
                part = std::min(part, physics::times_for_fraction(out.surface, out.boundary, max_fraction));
        }
        for (int shortenings = 0; shortenings < max_shortenings; ++shortenings) {
            give(part);
            const double most = greatest_of_rows(volume_.size(), 0.0, [&](std::size_t grain) {
                return volume_[grain] > counts ? inflow(grain) / volume_[grain] : 0.0;
            });
            if (most <= max_fraction) return part;
            part *= shortening * max_fraction / most;
        }
        throw Error("grains take up their neighbours however short a step of coarsening is");
    }

    /// Overlap of a contact with the radii of another stage.
    double overlap_with(const Stage& to, std::size_t row, double part) const {
        const Pair& pair = pairs_[row];
        const double first = start_.radius[at(pair.i)], second = start_.radius[at(pair.j)], overlap = start_.overlap[row];
        const double first_after = to.radius[at(pair.i)], second_after = to.radius[at(pair.j)];
        if (first_after == 0.0 || second_after == 0.0) return overlap;  // its contacts end with the grain
        const double first_change = first_after - first, second_change = second_after - second;
        const bool grows = settings_.neck_growth && like_[row];
        if (first_change == 0.0 && second_change == 0.0 && !grows) return overlap;
        const double neck = std::sqrt(physics::contact_radius_squared(overlap, physics::reduced_radius(first, second)));
        const double reduced = physics::reduced_radius(first_after, second_after);
        double after = physics::neck_after(neck, reduced, first_change, second_change, settings_.neck_share);
        if (grows) after = physics::neck_by_surface(after, reduced, part * material_dose(dose_.surface, pair));
        const auto limit = [&](double one, double other) {
            return physics::equilibrium_neck(std::min(one, other), std::max(one, other), sine_[row]);
        };
        const double limit_before = limit(first, second), limit_after = limit(first_after, second_after);
        after = std::min(after, std::max(limit_after, neck * std::min(1.0, limit_after / limit_before)));
        return physics::overlap_of_neck(after, reduced);
    }

    void find_overlaps(Stage& to, double part) const {
        for_rows(pairs_.size(), [&](std::size_t row) { to.overlap[row] = overlap_with(to, row, part); });
    }

    /// Radii after give(), none of a grain that is left with nothing.
    void find_radii(std::vector<double>& radius, std::vector<double>& volume) const {
        for_rows(volume_.size(), [&](std::size_t grain) {
            const double got = inflow(grain);
            volume[grain] = volume_[grain] - given_[grain] + got;
            radius[grain] = given_[grain] == 0.0 && got == 0.0 ? start_.radius[grain] : radius_of(volume[grain]);
        });
    }

    /// Flows of the middle as they would be at the volumes of the start by the laws' own powers of it. A pair with a grain that is
    /// gone by then goes on as it began, one whose order of size has changed exchanges nothing.
    void find_middle_flows() {
        for_rows(pairs_.size(), [&](std::size_t row) {
            const Pair& pair = pairs_[row];
            const double first = middle_.radius[at(pair.i)], second = middle_.radius[at(pair.j)];
            if (first == 0.0 || second == 0.0) return;
            const double start = start_.radius[at(pair.i)] - start_.radius[at(pair.j)];
            find_flow(middle_, row);
            if (start * (first - second) < 0.0) surface_[row] = boundary_[row] = 0.0;
            const std::size_t giver = at(donor(pair));
            const double ratio = middle_.radius[giver] / start_.radius[giver];
            surface_[row] *= ratio;
            boundary_[row] /= ratio;
        });
    }

    /// The next substep; returns the part of the dose that it takes.
    double substep(double left) {
        for_rows(pairs_.size(), [&](std::size_t row) { find_flow(start_, row); });
        sum_outflows();
        const double part = allowed(left);
        std::vector<double> volume(volume_.size());
        give(0.5 * part);
        find_radii(middle_.radius, volume);
        find_overlaps(middle_, 0.5 * part);
        find_middle_flows();
        sum_outflows();
        give(part);
        end_.radius.resize(volume.size());
        end_.overlap.resize(pairs_.size());
        find_radii(end_.radius, volume);
        remove_vanished(volume);
        find_overlaps(end_, part);
        for (std::size_t grain = 0; grain < volume.size(); ++grain) {
            const Outflow& out = outflow_[grain];
            if (given_[grain] > 0.0) {
                const double by_surface = given_[grain] * out.surface / (out.surface + out.boundary);
                change_.surface += by_surface;
                change_.boundary += given_[grain] - by_surface;
            }
        }
        for_rows(pairs_.size(),
                 [&](std::size_t row) { touched_[row] = touched_[row] || end_.overlap[row] != start_.overlap[row]; });
        std::swap(start_, end_);
        volume_ = std::move(volume);
        middle_ = start_;
        return part;
    }

    bool is_swallowed(std::size_t grain) const {
        return std::ranges::any_of(ends_.of(grain), [&](std::int32_t row) {
            const Pair& pair = pairs_[at(row)];
            const std::size_t other = at(at(pair.i) == grain ? pair.j : pair.i);
            return distance_[at(row)] + end_.radius[grain] < end_.radius[other];
        });
    }

    /// Grains at the end of their life pass what they still have on to their neighbours, by the sections of the necks; the smallest
    /// first, so that it does not end in another one that vanishes.
    void remove_vanished(std::vector<double>& volume) {
        std::vector<std::int32_t> gone;
        for (std::size_t grain = 0; grain < volume.size(); ++grain) {
            if (volume_[grain] == 0.0) continue;
            const bool empty = given_[grain] >= volume_[grain] ||
                               volume[grain] < vanishing * sphere_volume(body_.first_radius()[grain]);
            if (empty || is_swallowed(grain)) gone.push_back(static_cast<std::int32_t>(grain));
        }
        std::ranges::stable_sort(gone, {}, [&](std::int32_t grain) { return start_.radius[at(grain)]; });
        for (const std::int32_t grain : gone) pass_on(at(grain), volume);
    }

    void pass_on(std::size_t grain, std::vector<double>& volume) {
        const auto section = [&](std::int32_t row, std::size_t other) {  // of the neck, m2; zero where nothing can be passed on
            const double reduced = physics::reduced_radius(start_.radius[grain], start_.radius[other]);
            return end_.radius[other] > 0.0 ? physics::contact_radius_squared(start_.overlap[at(row)], reduced) : 0.0;
        };
        const auto neighbours = [&](const auto& visit) {
            for (const std::int32_t row : ends_.of(grain)) {
                const std::size_t other = at(at(pairs_[at(row)].i) == grain ? pairs_[at(row)].j : pairs_[at(row)].i);
                if (const double each = section(row, other); each > 0.0) visit(other, each);
            }
        };
        double all = 0.0;
        neighbours([&](std::size_t, double each) { all += each; });
        if (!(all > 0.0) && volume[grain] > 0.0) return;  // nobody is there to take it
        const double rest = volume[grain];
        neighbours([&](std::size_t other, double each) {
            volume[other] += rest * each / all;
            end_.radius[other] = radius_of(volume[other]);
        });
        volume[grain] = end_.radius[grain] = 0.0;
    }

    /// The grains at the end, with a record of all contacts whose grains or necks have changed, and of pairs whose spheres overlap
    /// before they touch.
    Coarsening::Change finish() {
        Grains& grains = change_.grains;
        std::size_t contact = 0;
        for (std::size_t row = 0; row < body_.pairs().size(); ++row) {
            const Pair& pair = body_.pairs()[row];
            double offset = body_.offsets().empty() ? 0.0 : body_.offsets()[row];
            const double first = start_.radius[at(pair.i)], second = start_.radius[at(pair.j)];
            if (contact < pairs_.size() && pairs_[contact] == pair) {
                if (touched_[contact]) offset = start_.overlap[contact] - (first + second - distance_[contact]);
                ++contact;
            } else {
                offset = std::min(offset, 0.0);
            }
            if (offset == 0.0 || first == 0.0 || second == 0.0) continue;
            grains.pair.push_back(pair);
            grains.offset.push_back(offset);
        }
        grains.radius = std::move(start_.radius);
        return std::move(change_);
    }

    const SinteringBody& body_;
    const CoarseningSettings& settings_;
    const Dose& dose_;
    const std::vector<Pair> pairs_;        // that touch
    Stage start_, middle_, end_;           // of the substep
    std::vector<double> volume_;           // m3, at its start
    std::vector<char> like_;               // of each pair: two grains of one material
    std::vector<double> distance_, sine_;  // of each pair: m; sin(psi/2)
    std::vector<double> surface_, boundary_;  // flows of each pair, m3
    std::vector<char> touched_;            // pairs whose overlap has changed
    Grouping<std::int32_t> ends_;          // rows of the pairs of like grains, of each grain
    std::vector<Outflow> outflow_;
    std::vector<double> given_;            // m3, of each grain
    Coarsening::Change change_;
};

}  // namespace

Coarsening::Coarsening(const State& state, const CoarseningSettings& settings)
    : settings_(settings), material_(state.materials), used_(state.materials.size(), false) {
    for (const std::int32_t material : state.particles.material) used_[at(material)] = true;
    for (std::size_t row = 0; row < material_.size(); ++row) {
        if (!used_[row]) continue;
        const Material& material = material_[row];
        const auto require = [&](bool there, const char* key) {
            if (!there)
                throw Error("material '" + material.name + "' has no " + key +
                            ", which coarsening needs; of the built-in materials alumina-dihedral has it");
        };
        if (settings_.surface || settings_.neck_growth) {
            require(material.surface_prefactor && material.surface_activation, "surface_diffusion");
            require(material.atomic_volume.has_value(), "atomic_volume");
        }
        if (!settings_.boundary) continue;
        require(material.mobility_prefactor && material.mobility_activation, "boundary_mobility");
        require(material.dihedral_angle.has_value(), "dihedral_angle");
    }
}

Coarsening::Change Coarsening::over(const SinteringBody& body, const Kinetics& kinetics, double from, double until) const {
    Dose dose{std::vector<double>(material_.size(), 0.0), std::vector<double>(material_.size(), 0.0)};
    for (std::size_t row = 0; row < material_.size(); ++row) {
        if (!used_[row]) continue;
        const Material& material = material_[row];
        const auto integral = [&](const auto& of) { return kinetics.schedule().integral(from, until, of); };
        if (settings_.surface || settings_.neck_growth)
            dose.surface[row] = *material.surface_energy *
                                integral([&](double temperature) { return physics::surface_diffusion_of(material, temperature); });
        if (settings_.boundary)
            dose.boundary[row] = physics::boundary_energy(*material.surface_energy, *material.dihedral_angle) *
                                 integral([&](double temperature) { return physics::boundary_mobility_of(material, temperature); });
    }
    return Exchange(body, kinetics, settings_, dose).run();
}

}  // namespace kiln::sintering
