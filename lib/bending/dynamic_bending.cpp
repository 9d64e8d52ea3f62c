// dynamic_bending.cpp: motion of the punch, sampling of the curve and the balance of energy of the dynamic test.
#include "bending/dynamic_bending.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/materials.h"

namespace kiln::bending {

namespace {

constexpr double default_periods = 20.0;  // of the bar, from rest to the greatest deflection
constexpr double seating_force = 1e-9;    // of the greatest force
constexpr int steps_between_looks = 16;
constexpr double longest_travel = 10.0;  // of the punch, over the greatest deflection, and half the bar's height more

/// Mass of each particle of the body with its half of its bonds, kg.
std::vector<double> masses(const Specimen& specimen, double scaling) {
    const State& state = specimen.state;
    std::vector<double> volume(state.particles.size());
    for (std::size_t row = 0; row < volume.size(); ++row) {
        volume[row] = 4.0 / 3.0 * std::numbers::pi * std::pow(state.particles.radius[row], 3.0);
    }
    for (std::size_t bond = 0; bond < state.bonds->size(); ++bond) {
        for (const std::int32_t row : state.bonds->pair[bond])
            volume[static_cast<std::size_t>(row)] += 0.5 * state.bonds->volume[bond];
    }
    std::vector<double> mass;
    for (const std::int32_t particle : specimen.body.particle) {
        const auto row = static_cast<std::size_t>(particle);
        const Material& material = state.materials[static_cast<std::size_t>(state.particles.material[row])];
        mass.push_back(scaling * physics::required(material.density, material, "density") * volume[row]);
    }
    return mass;
}

/// Longest period of a beam on two supports, s: omega^2 = pi^4 S/(48 m) with S = 48 E I/L^3 and its mass m between the supports
/// (Timoshenko, Vibration Problems in Engineering, transverse vibration of bars with hinged ends).
double beam_period(double stiffness, double mass) { return 2.0 / std::numbers::pi * std::sqrt(48.0 * mass / stiffness); }

/// The test from the first touch on.
class PunchMotion {
   public:
    PunchMotion(Result& result, const Options& options, const Watch& watch)
        : result_(result),
          options_(options),
          watch_(watch),
          gauge_(result.specimen, result.fixture),
          deflection_(options.max_force > 0.0 ? options.max_force / estimated_stiffness(result.specimen, result.fixture)
                                              : max_deflection_of(result.specimen, options)),
          motion_(make_motion()) {}

    void run() {
        for (cycle_ = 0; cycle_ < options_.cycles; ++cycle_) {
            load();
            unload();
        }
        result_.dynamic.energy = motion_.energy();
        result_.friction_loss = result_.dynamic.energy.friction;
        result_.energy_error = energy_gap_ / (peak_energy_.bonds + peak_energy_.contacts);
    }

   private:
    mechanics::ExplicitMotion make_motion();
    void advance(double heading, double share);
    void load();
    void unload();
    void record();
    void keep_peak();
    Point now() const {
        return {gauge_.read(motion_.displacement()) - zero_, motion_.travel() - seat_, motion_.contacts().punch_force()};
    }
    /// Of the deflection or force at which unloading begins.
    double reached(const Point& point) const {
        return options_.max_force > 0.0 ? point.force / options_.max_force : point.deflection / deflection_;
    }

    Result& result_;
    const Options& options_;
    const Watch& watch_;
    Gauge gauge_;
    double deflection_;  // m, at which unloading begins, or about that
    double velocity_ = 0.0, period_ = 0.0;
    double zero_ = 0.0, seat_ = 0.0;  // m, deflection where the test begins, travel where the punch meets the bar
    bool met_ = false;
    mechanics::ExplicitMotion motion_;
    double punch_velocity_ = 0.0, energy_gap_ = 0.0;
    mechanics::MotionEnergy peak_energy_;
    int cycle_ = 0;
};

mechanics::ExplicitMotion PunchMotion::make_motion() {
    const Specimen& specimen = result_.specimen;
    const double stiffness = estimated_stiffness(specimen, result_.fixture), force = stiffness * deflection_;
    const std::vector<double> mass = masses(specimen, options_.mass_scaling);
    double total = 0.0;
    for (const double each : mass) total += each;
    period_ = beam_period(stiffness, total * result_.fixture.span / specimen.size[0]);
    velocity_ = options_.punch_velocity > 0.0 ? options_.punch_velocity : deflection_ / (default_periods * period_);
    const mechanics::Tooling tooling = find_contacts(specimen, result_.fixture);
    const mechanics::Seat seat = mechanics::seat_rigid(specimen.body.network, tooling.contacts, seating_force * force);
    seat_ = seat.punch;
    mechanics::ExplicitMotion motion(specimen.body.network, mechanics::elastic_spheres(specimen.state, specimen.body), mass,
                                     tooling, {options_.damping, options_.friction, force});
    motion.place(seat.displacement, seat_);
    zero_ = gauge_.read(seat.displacement);
    result_.dynamic.time_step = motion.time_step();
    result_.dynamic.velocity = velocity_;
    return motion;
}

/// Some steps with the punch going down (heading 1) or up (-1); it takes one period of the bar to turn from rest to full speed.
void PunchMotion::advance(double heading, double share) {
    const double dt = motion_.time_step(), change = velocity_ * dt / period_;
    for (int step = 0; step < steps_between_looks; ++step) {
        punch_velocity_ += std::clamp(heading * velocity_ - punch_velocity_, -change, change);
        motion_.step(punch_velocity_);
        met_ = met_ || motion_.contacts().punch_force() > 0.0;
        if (!met_) seat_ = motion_.travel();
    }
    result_.dynamic.steps += steps_between_looks;
    if (!std::isfinite(motion_.contacts().punch_force())) throw Error("the motion of the bar grew without bounds");
    watch_.at((cycle_ + std::clamp(share, 0.0, 1.0)) / options_.cycles);
}

void PunchMotion::record() {
    result_.curve.push_back(now());
    const mechanics::MotionEnergy energy = motion_.energy();
    energy_gap_ = std::max(energy_gap_, std::abs(energy.work - energy.total()));
}

void PunchMotion::keep_peak() {
    record();
    const double force = result_.curve.back().force;
    if (cycle_ > 0 && force <= result_.peak_force) return;
    result_.peak_force = force;
    peak_energy_ = motion_.energy();
    result_.peak.displacement = motion_.displacement();
    result_.peak.bond_energy = peak_energy_.bonds;
    result_.peak.contact_energy = peak_energy_.contacts;
    result_.loads = motion_.loads();
    result_.peak.contact_force = motion_.contacts().wall_forces();
    result_.peak.closed_gaps = motion_.contacts().touching_pairs();
    read_contacts(result_, find_contacts(result_.specimen, result_.fixture), result_.peak);
    if (!result_.on_both_supports)
        throw Error("at the largest force the bar lies on one support only; a moving punch (--punch-velocity) is too fast for it");
}

/// Down until the punch stands still at about the required deflection: it turns early enough to stop there.
void PunchMotion::load() {
    const double limit = motion_.travel() + longest_travel * deflection_ + 0.5 * result_.specimen.size[2];
    int next = 1;
    for (bool turning = false; !turning || punch_velocity_ > 0.0;) {
        const Point here = now();
        const double share = reached(here);
        if (!turning && share >= static_cast<double>(next) / options_.points) {
            record();
            next = static_cast<int>(share * options_.points) + 1;
        }
        const double stopping = 0.5 * punch_velocity_ * punch_velocity_ / velocity_ * period_;
        turning = turning || (here.punch > 0.0 && share * (1.0 + stopping / here.punch) >= 1.0);
        if (here.punch + seat_ > limit)
            throw Error("the punch went through the bar's height without the required deflection or force");
        advance(turning ? -1.0 : 1.0, 0.5 * share);
    }
    keep_peak();
}

/// Up until the punch is free.
void PunchMotion::unload() {
    const double peak = reached(result_.curve.back());
    int next = options_.points - 1;
    while (motion_.contacts().punch_force() > 0.0) {
        const double share = reached(now()) / peak;
        if (share <= static_cast<double>(next) / options_.points) {
            record();
            next = static_cast<int>(std::ceil(share * options_.points)) - 1;
        }
        advance(-1.0, 1.0 - 0.5 * share);
    }
    record();
}

}  // namespace

Result bend_dynamic(State state, const Options& options, const Watch& watch) {
    Result result = prepare(std::move(state), options);
    PunchMotion punch(result, options, watch);
    punch.run();
    add_warnings(result, options);
    return result;
}

}  // namespace kiln::bending
