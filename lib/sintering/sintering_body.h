// sintering_body.h: a packing on its way through sintering: particles in memory order, pairs near touch, density, strains; either
// method's.
#pragma once

#include <algorithm>
#include <span>
#include <string>

#include "core/contacts.h"
#include "core/state.h"
#include "sintering/contact_network.h"

namespace kiln::sintering {

/// Which faces of the box are periodic.
enum class Faces { as_given, periodic, free };

/// What coarsening changes in a body: the radii of its grains, and the history of its necks.
struct Grains {
    std::vector<double> radius;   // m, of each particle; zero for a grain that has vanished
    std::vector<Pair> pair;       // those whose necks have a history, sorted
    std::vector<double> offset;   // m, of each of them: e in the overlap h = r1 + r2 - d + e that the force law sees
};

/// Times the approach that a guess says, by which a pair that comes to touch is a candidate.
inline constexpr double candidate_motion = 2.0;

/// Owns the state while it sinters. Particles stand in the order of a space-filling curve, positions unwrapped, so that the images
/// of pairs stay what they were when the list was made.
class SinteringBody {
   public:
    /// Throws Error where there are no particles, bonds, or centres that coincide.
    SinteringBody(State state, Faces faces);

    const Box& box() const { return state_.box; }
    const Particles& particles() const { return state_.particles; }
    const State& working() const { return state_; }
    std::size_t size() const { return state_.particles.size(); }
    double time() const { return state_.time; }
    double density() const { return density_; }        // relative, over the box
    const Vec3& strain() const { return strain_; }      // logarithmic, since the start
    double mean_radius() const { return mean_radius_; }  // m, that of the mean volume
    double max_radius() const { return max_radius_; }    // m
    const std::vector<double>& first_radius() const { return first_radius_; }  // m, that each particle came in with

    /// Pairs that touch or may come to touch while each particle has margin left to travel; sorted.
    const std::vector<Pair>& pairs() const { return pairs_; }

    /// Distance, m, that a pair is taken to close beside what a motion says of it when candidates for touch are chosen.
    double candidate_reach(const Motion& motion) const;

    /// Makes the list of pairs hold all that touch under `factor` times a motion, if it does not.
    void cover(const Motion& motion, double factor = 1.0);

    /// Lists the pairs anew, with the same margin (m) for each particle.
    void list_pairs(double margin);

    double min_margin() const { return min_margin_; }  // m, of any particle
    int lists() const { return lists_; }               // of pairs that were made so far

    /// Vector between the centres of a pair, m; its radii, m.
    Vec3 vector(const Pair& pair) const { return pair_vector(state_.box, state_.particles.position, pair); }
    std::pair<double, double> radii(const Pair& pair) const {
        return {state_.particles.radius[static_cast<std::size_t>(pair.i)],
                state_.particles.radius[static_cast<std::size_t>(pair.j)]};
    }

    /// What the history of a pair's neck adds to the overlap of its spheres, m, and that of each row of pairs(), none for zeros.
    double offset(const Pair& pair) const;
    const std::vector<double>& offsets() const { return offset_; }

    /// Overlap that the force law sees, m; negative for a gap.
    double overlap(const Pair& pair) const {
        const auto [first, second] = radii(pair);
        return contact_overlap(first, second, vector(pair).norm() - offset(pair));
    }

    /// Radii and necks, to be kept, changed and put back: a row a particle. Pairs of a grain without radius are not listed.
    Grains grains() const { return {state_.particles.radius, record_, record_offset_}; }
    void set_grains(const Grains& grains);

    /// Takes the grains without radius out of the body. Returns the rows of the others. Sums over the body are made anew.
    std::vector<std::int32_t> remove_vanished();

    /// Bound of how much any gap closes under a motion, m.
    double approach_bound(const Motion& motion) const;

    /// Change of the logarithm of the density under a motion. Along an axis that is not periodic the body's extent is the root mean
    /// square distance of its mass from its centre, which the box follows.
    double log_density_change(const Motion& motion) const;

    /// Moves particles and box.
    void apply(const Motion& motion, double until, double temperature);

    ContactStatistics statistics() const { return contact_statistics(state_.box, state_.particles, pairs_, offset_); }

    /// The present state, particles in the order they came in, positions inside the box.
    State state() const;

    /// The same in working order, with all that restore() needs to the last bit.
    State checkpoint() const;

    /// Takes up a run where a checkpoint of it left off: what checkpoint() and strain() were then. Throws Error where it has
    /// particles that this body has not.
    void restore(const State& checkpoint, const Vec3& strain);

   private:
    std::vector<double> reaches() const;  // m, of each particle: radius and margin
    void find_pairs();
    void find_pairs_of(const std::vector<std::int32_t>& few);
    void took_list();
    void take_necks(const Necks& necks, std::span<const Image> cells);
    void list_record();
    void measure();
    void end_contacts();
    Necks necks(std::span<const std::int32_t> present, std::span<const Image> cells) const;
    void keep_rows(const std::vector<std::int32_t>& rows);
    double growth(std::size_t row) const { return std::max(0.0, state_.particles.radius[row] - listed_radius_[row]); }
    double travel(std::size_t row, const Motion& motion) const;
    Vec3 body_stretch(const Motion& motion) const;

    State state_;
    std::vector<std::int32_t> order_;  // row in the input of each present row
    std::vector<Pair> pairs_;
    bool grains_change_ = false;
    std::vector<double> offset_;  // m, a row a pair; none where no neck has a history
    std::vector<std::size_t> first_pair_;  // row of the first pair of each particle, where there are offsets
    std::vector<Pair> record_;           // see Grains
    std::vector<double> record_offset_;  // m
    std::vector<double> first_radius_, listed_radius_;  // m, of each particle: at the start, and when pairs were listed last
    std::vector<double> margin_;  // how far each particle may still travel under the present list, m
    double min_margin_ = 0.0;   // of them all, m
    int lists_ = 0;
    double max_radius_ = 0.0, mean_radius_ = 0.0;  // m
    double solid_ = 0.0;                               // volume of the particles, m3
    double density_ = 0.0;
    Vec3 strain_ = Vec3::Zero();
};

}  // namespace kiln::sintering
