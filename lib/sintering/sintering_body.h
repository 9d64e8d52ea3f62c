// sintering_body.h: a packing on its way through sintering: particles in memory order, pairs near touch, density, strains; either
// method's.
#pragma once

#include <string>

#include "core/contacts.h"
#include "core/state.h"
#include "sintering/contact_network.h"

namespace kiln::sintering {

/// Which faces of the box are periodic.
enum class Faces { as_given, periodic, free };

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

    /// Pairs that touch or may come to touch while each particle has margin left to travel; sorted.
    const std::vector<Pair>& pairs() const { return pairs_; }

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

    /// Bound of how much any gap closes under a motion, m.
    double approach_bound(const Motion& motion) const;

    /// Change of the logarithm of the density under a motion. Along an axis that is not periodic the body's extent is the root mean
    /// square distance of its mass from its centre, which the box follows.
    double log_density_change(const Motion& motion) const;

    /// Moves particles and box.
    void apply(const Motion& motion, double until, double temperature);

    ContactStatistics statistics() const { return contact_statistics(state_.box, state_.particles, pairs_); }

    /// The present state, particles in the order they came in, positions inside the box.
    State state() const;

    /// Takes up a run where a checkpoint of it left off: what working() and strain() were then.
    void restore(const Box& box, std::vector<Vec3> position, double time, double temperature, const Vec3& strain);

   private:
    std::vector<double> reaches() const;  // m, of each particle: radius and margin
    void find_pairs();
    void find_pairs_of(const std::vector<std::int32_t>& few);
    void took_list();
    double travel(std::size_t row, const Motion& motion) const;
    Vec3 body_stretch(const Motion& motion) const;

    State state_;
    std::vector<std::int32_t> order_;  // row in the input of each present row
    std::vector<Pair> pairs_;
    std::vector<double> margin_;  // how far each particle may still travel under the present list, m
    double min_margin_ = 0.0;   // of them all, m
    int lists_ = 0;
    double max_radius_ = 0.0, mean_radius_ = 0.0;  // m
    double solid_ = 0.0;                               // volume of the particles, m3
    double density_ = 0.0;
    Vec3 strain_ = Vec3::Zero();
};

}  // namespace kiln::sintering
