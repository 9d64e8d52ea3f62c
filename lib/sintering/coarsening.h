// coarsening.h: the grains of a body exchange volume over their necks while their centres stay.
#pragma once

#include <cstdint>
#include <vector>

#include "physics/grain_size.h"
#include "sintering/kinetics.h"
#include "sintering/sintering_body.h"

namespace kiln::sintering {

struct CoarseningSettings {
    bool surface = false;       // exchange by surface diffusion
    bool boundary = false;      // exchange by migration of the boundaries
    double chi = 0.95;          // neck over the smaller radius from which on a boundary is free to migrate
    double neck_share = 0.5;    // of a grain's growth, that its necks' overlaps take up
    bool neck_growth = false;   // necks also grow by surface diffusion without shrinkage

    bool exchanges() const { return surface || boundary; }
    bool any() const { return exchanges() || neck_growth; }
};

/// What coarsening has done, for the record of a step.
struct CoarseningRecord {
    physics::GrainSize size;               // at the end of the step
    double surface = 0.0, boundary = 0.0;  // m3 that each mechanism has moved since the start of the run
    std::size_t vanished_grains = 0;       // since the start of the run
    std::vector<std::int64_t> vanished;    // ids, in this step
    int substeps = 0;                      // of the step
};

/// The laws of lib/physics/coarsening.h on the contacts of a body.
class Coarsening {
   public:
    /// Throws Error where a material of a particle lacks what a mechanism needs.
    Coarsening(const State& state, const CoarseningSettings& settings);

    struct Change {
        Grains grains;
        double surface = 0.0, boundary = 0.0;  // m3 moved
        int substeps = 0;
    };

    /// The grains of a body that has rested from one time to another (s) under the temperatures of its schedule. Grains exchange
    /// volume where they touch and are of one material. The volume of all is kept to rounding; what a vanished grain still had
    /// goes to its neighbours. The same numbers for any number of threads.
    Change over(const SinteringBody& body, const Kinetics& kinetics, double from, double until) const;

   private:
    CoarseningSettings settings_;
    std::vector<Material> material_;
    std::vector<bool> used_;  // by a particle, of each material
};

}  // namespace kiln::sintering
