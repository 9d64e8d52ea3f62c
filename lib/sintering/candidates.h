// candidates.h: the pairs that take part in a step: those that touch, and those that are expected to come to touch in it.
#pragma once

#include <vector>

#include "sintering/kinetics.h"
#include "sintering/sintering_body.h"
#include "sintering/rigid_clusters.h"
#include "sintering/sinter_step.h"
#include "physics/sinter_contact.h"

namespace kiln::sintering {

class Candidates {
   public:
    /// Refers to packing and kinetics as long as it lives.
    /// coarsens: necks end growing where unequal spheres are in equilibrium, and not at sin(psi/2) of the smaller radius.
    Candidates(const SinteringBody& packing, const Kinetics& kinetics, const physics::ContactConstants& constants,
               bool coarsens = false)
        : body_(packing), kinetics_(kinetics), constants_(constants), coarsens_(coarsens) {}

    /// Chooses from the packing's list by two motions that the step may turn out to make.
    /// diffusion: integral of Delta over the step for each pair of materials, m5/N. keep: what was chosen last stays chosen, so
    /// that choosing again and again comes to an end.
    void choose(const Motion& guess, const Motion& other, const std::vector<double>& diffusion, bool keep = false);

    /// True if no pair of the packing's list that was not chosen touches after the motion, or so little that it may begin with the
    /// next step.
    bool complete(const Motion& motion) const;

    /// Pairs and what they bring into the step, as the nodes of rigid clusters see them.
    void turn_to_nodes(const RigidClusters& clusters);

    /// What a pair brings into a step; forces over `unit`.
    PairStep pair_step(const Pair& pair, const std::vector<double>& diffusion, double unit) const;

    const std::vector<Pair>& pairs() const { return pairs_; }
    const std::vector<PairStep>& steps() const { return steps_; }        // a row a pair
    const std::vector<Pair>& touching() const { return touching_; }      // of particles
    const std::vector<Pair>& sticking() const { return sticking_; }      // of particles that do not diffuse, and touch
    /// Bound of the approach over a step of any touching pair by the law of an isolated pair, over the mean radius.
    double max_isolated_approach(const std::vector<double>& diffusion) const;
    double unit() const { return unit_; }                                // of the steps' forces: what 1 N is in it

   private:
    double max_neck(std::size_t kind, double first, double second) const;  // m
    double end_overlap(const Pair& pair, const Motion& motion) const;     // m, after the motion

    const SinteringBody& body_;
    const Kinetics& kinetics_;
    physics::ContactConstants constants_;
    bool coarsens_;
    std::vector<Pair> pairs_, chosen_, left_out_, touching_, sticking_;
    std::vector<double> left_out_overlap_;  // m, before the step, of each pair left out
    int lists_ = 0;  // of the packing, when pairs were chosen
    std::vector<PairStep> steps_;
    double unit_ = 1.0;
};

}  // namespace kiln::sintering
