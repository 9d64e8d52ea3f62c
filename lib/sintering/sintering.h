// sintering.h: what a method of sintering is asked for and what it tells of each step; implicit_sintering.h and
// explicit_sintering.h are the methods.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/contacts.h"
#include "core/stop.h"
#include "sintering/coarsening.h"
#include "sintering/kinetics.h"
#include "sintering/sintering_body.h"
#include "physics/sinter_contact.h"

namespace kiln::sintering {

struct SinteringSettings {
    physics::Schedule schedule = physics::Schedule::hold(1473.15);
    physics::ContactConstants constants;
    Faces faces = Faces::as_given;
    std::array<bool, 3> fixed{false, false, false};  // axes along which the box keeps its length
    std::array<bool, 3> confined{false, false, false};  // axes along which a die of the box's length at the start holds, see die.h
    Vec3 pressure = Vec3::Zero();                   // Pa, compressive, along the periodic axes
    double tolerance = 3e-4;         // relative error of the density over the whole run that the steps aim at
    double solver_tolerance = 9e-3;  // relative error of a step's motion in the energy norm
    bool second_order = true;        // of the implicit step
    double mass_scaling = 1e20;      // of the explicit method: inertial over real mass
    CoarseningSettings coarsening;   // of the implicit method
    StopRequest stop;  // asked during steps: Interrupted then leaves the state as it was before the step
};

/// What one step did; also the keys of the density history.
struct StepRecord {
    double time = 0.0, duration = 0.0;  // at the end of the step, s; length of the step, s
    double temperature = 0.0;           // at the end of the step, K
    double relative_density = 0.0;
    Vec3 strain = Vec3::Zero();         // logarithmic, since the start
    Vec3 stress = Vec3::Zero();         // mean over the step along the axes, tension positive, Pa
    ContactStatistics contacts{};
    double error = 0.0;                 // estimated, of the density since the start, relative
    int attempts = 0, newton = 0, conjugate_gradients = 0;  // of the step, rejected attempts included
    double imbalance = 0.0;             // largest force left on a particle, a cluster or the box, relative; see SinterStep
    bool converged = true;
    std::optional<CoarseningRecord> coarsening;  // where it is on
};

/// Numbers by name, one or a vector's three.
using Numbers = std::map<std::string, std::vector<double>>;

/// All that the next steps of a run depend on.
struct Checkpoint {
    State state;  // particles in working order, with arrays of the method among the unknown ones
    Numbers numbers;
};

/// A packing and the way it is integrated in time.
class SinteringMethod {
   public:
    virtual ~SinteringMethod() = default;
    SinteringMethod(const SinteringMethod&) = delete;  // methods refer to their own body
    SinteringMethod& operator=(const SinteringMethod&) = delete;

    /// One step (the explicit method: a few), ended early at latest_time (s) or where the density reaches highest_density.
    /// Throws Error if nothing densifies any more although the step has no latest time.
    virtual StepRecord advance(double latest_time, double highest_density) = 0;

    Checkpoint checkpoint() const;

    /// Takes up a run from its checkpoint; this must have been made from the same state and settings.
    /// Throws Error where the checkpoint has another number of particles or lacks something.
    void restore(const Checkpoint& checkpoint);

    const SinteringBody& packing() const { return body_; }
    const Kinetics& kinetics() const { return kinetics_; }
    std::size_t steps() const { return steps_; }
    double time() const { return body_.time(); }
    double relative_density() const { return body_.density(); }
    State state() const { return body_.state(); }

   protected:
    /// Throws Error where a material lacks what the contact law needs, or a pressure has no face to act on.
    SinteringMethod(State state, const SinteringSettings& settings);

    /// Numbers and arrays (a row a particle) of the method itself, and the way back.
    virtual Numbers numbers() const = 0;
    virtual std::vector<NamedArray> arrays() const = 0;
    virtual void take_up(const Numbers& numbers, const std::vector<NamedArray>& arrays) = 0;

    SinteringSettings settings_;
    SinteringBody body_;
    Kinetics kinetics_;
    std::size_t steps_ = 0;
};

/// A vector as numbers, and back; throws Error where there are none of that name.
inline std::vector<double> triple(const Vec3& vector) { return {vector[0], vector[1], vector[2]}; }
Vec3 triple_at(const Numbers& numbers, const std::string& name);

/// A number by its name; throws Error where there is none.
double number_at(const Numbers& numbers, const std::string& name);

/// The f8 array of three columns and the given number of rows; throws Error where there is none.
std::vector<double> column_of(const std::vector<NamedArray>& arrays, const std::string& name, std::size_t rows);

}  // namespace kiln::sintering
