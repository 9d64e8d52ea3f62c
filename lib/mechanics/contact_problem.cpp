// contact_problem.cpp: the search for equilibria in a growing space, and the path from load to load.
#include "mechanics/contact_problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace kiln::mechanics {

namespace {

constexpr std::size_t max_fields = 120;
constexpr std::size_t fields_to_begin_with = 26;  // of a search in a sound body; those of more that are the oldest become one
constexpr std::size_t fields_of_a_sequence = 60;  // of bonds that are softened, before all become one
constexpr int iterations_of_a_response = 5;       // what these leave, later responses find together, and sooner
constexpr int many_iterations = 1000;             // where soft motions do not show in few: after breaks, or as the space fills
constexpr double rounding_residual = 1e-9;        // below which rounding may have the last word
constexpr double min_progress = 0.5;              // residual with a field over that without it, below that
constexpr double min_force = 1e-9;                // of the measure of a load: contact forces below do not count as a measure

constexpr int max_passes = 200;
constexpr int idle_passes = 10;           // in a row that bring the limits no closer: rounding has the last word
constexpr double limit_tolerance = 1e-9;  // change of a friction limit over the punch force
constexpr double limit_share = 0.1;       // the same, of the tolerance for unbalanced forces where that is finer

/// The body lifted, rolled and pitched by a punch force on its contacts. It starts with the first ones at the overlap that carries
/// the force, so that no step is without a contact.
Eigen::VectorXd seat_in(ReducedSpace& space, ContactSet& contacts, double force) {
    space.add_rigid_motion(Vec3::UnitZ(), Vec3::Zero());
    space.add_rigid_motion(Vec3::Zero(), Vec3::UnitX());
    space.add_rigid_motion(Vec3::Zero(), Vec3::UnitY());
    for (std::size_t field = 0; field < space.fields(); ++field) contacts.add_field(space, field);
    const double overlap = contacts.max_overlap(force);
    Eigen::VectorXd freedoms = Eigen::VectorXd::Zero(space.stiffness().rows());
    freedoms[0] = 2.0 * overlap;
    freedoms[1] = -overlap;
    minimise(space, contacts, {force}, freedoms);
    return freedoms;
}

}  // namespace

Seat seat_rigid(const BondNetwork& network, const std::vector<WallContact>& walls, double force) {
    ReducedSpace space(network);
    ContactSet contacts(network, walls, {}, 0.0);
    const Eigen::VectorXd freedoms = seat_in(space, contacts, force);
    return {space.displacement(freedoms), freedoms[0]};
}

ContactProblem::ContactProblem(const BondNetwork& network, ElasticSolver& solver, const std::vector<WallContact>& walls,
                               std::vector<PairContact> pairs, double friction, double seating_force, double finest_tolerance)
    : network_(network),
      solver_(solver),
      exact_(finest_tolerance < rounding_residual),
      space_(network),
      contacts_(network, walls, std::move(pairs), friction),
      seated_(seat_in(space_, contacts_, seating_force)) {
    if (contacts_.friction()) {
        space_.add_rigid_motion(Vec3::UnitX(), Vec3::Zero());
        space_.add_rigid_motion(Vec3::UnitY(), Vec3::Zero());
        space_.add_rigid_motion(Vec3::Zero(), Vec3::UnitZ());
        for (std::size_t field = space_.fields() - 3; field < space_.fields(); ++field) {
            contacts_.add_field(space_, field);
        }
    }
    release();
}

void ContactProblem::release() {
    freedoms_ = Eigen::VectorXd::Zero(space_.stiffness().rows());
    freedoms_.head(seated_.size()) = seated_;
    contacts_.release(freedoms_);
}

/// Minima for limits of friction that are taken anew from each; false if they go on changing. The limits are forces that the
/// minimum takes as given, so they have to be known better than the forces are to be balanced.
bool ContactProblem::settle(const PunchLoad& load, double tolerance) {
    if (!contacts_.friction()) {
        minimise(space_, contacts_, load, freedoms_);
        return true;
    }
    if (contacts_.undecided()) {
        contacts_.stick(load.force);
        minimise(space_, contacts_, load, freedoms_);
    }
    const double required = std::min(limit_tolerance, limit_share * tolerance) * load.force;
    double least = HUGE_VAL;
    for (int pass = 0, idle = 0; pass < max_passes && idle < idle_passes; ++pass) {
        const double change = contacts_.follow(freedoms_);
        if (pass > 0) {  // the first change is that of the load
            if (change <= required) return true;
            idle = change < least ? 0 : idle + 1;
            least = std::min(least, change);
        }
        minimise(space_, contacts_, load, freedoms_);
    }
    return least <= tolerance * load.force;
}

/// What the contacts do to the nodes less what the bonds hold against it.
Vector ContactProblem::unbalanced(const ContactSet::Forces& forces) const {
    Vector rest = space_.force(solver_, freedoms_);
    for (Vec6& each : rest) each = -each;
    contacts_.add_to_nodes(forces, rest);
    return rest;
}

/// Adds what the body does under unbalanced forces to the space; false if the space has it.
bool ContactProblem::add_response(const Vector& unbalanced, int& iterations) {
    const bool patient = softened_ || space_.fields() > max_fields / 2;
    ReducedSpace::Response response =
        space_.response(solver_, unbalanced, patient ? many_iterations : iterations_of_a_response);
    iterations += response.iterations;
    const double unit = contacts_.max_approach(response.displacement);
    if (!space_.add(response, unit, exact_ ? &solver_ : nullptr)) return false;
    contacts_.add_field(space_, space_.fields() - 1);
    freedoms_.conservativeResize(freedoms_.size() + 1);
    freedoms_[freedoms_.size() - 1] = 0.0;
    return true;
}

/// Where rounding has the last word, a field no longer helps: it is taken out again, since it would spoil the space.
Equilibrium ContactProblem::search(const PunchLoad& load, double tolerance) {
    Equilibrium state;
    Eigen::VectorXd before;  // freedoms before the last field was added; empty if none was
    double before_residual = 0.0;
    const bool remembers = contacts_.friction();  // an equilibrium, in the freedoms that it had
    if (!softened_ && !remembers) join_old_fields(fields_to_begin_with, fields_to_begin_with);
    while (true) {
        const bool settled = settle(load, tolerance);
        ContactSet::Forces forces = contacts_.forces(freedoms_);
        Vector rest = unbalanced(forces);
        const auto residual = [&] { return linalg::norm(rest) / std::max(forces.force.norm(), min_force * load.force); };
        state.residual = residual();
        const bool stuck = before.size() > 0 && state.residual > tolerance && before_residual < rounding_residual &&
                           !(state.residual < min_progress * before_residual);
        if (stuck) {
            space_.remove_last();
            contacts_.remove_fields(space_.fields(), space_.fields() + 1);
            freedoms_ = before;
            contacts_.follow(freedoms_);
            forces = contacts_.forces(freedoms_);
            rest = unbalanced(forces);
            state.residual = residual();
        }
        state.converged = settled && state.residual <= tolerance;
        before = freedoms_;
        before_residual = state.residual;
        if (!stuck && state.residual > tolerance && space_.fields() < max_fields && add_response(rest, state.iterations)) continue;
        before.resize(0);
        state.displacement = space_.displacement(freedoms_);
        if (contacts_.add_closed_pairs(space_, state.displacement)) continue;
        conclude(state, forces, load);
        return state;
    }
}

void ContactProblem::conclude(Equilibrium& state, const ContactSet::Forces& forces, const PunchLoad& load) const {
    state.punch = freedoms_[0];
    state.punch_force = load.held ? contacts_.punch_force(forces) : load.force;
    state.contact_force = contacts_.on_walls(forces);
    state.closed_gaps = contacts_.closed_pairs(forces);
    state.contact_energy = forces.energy + contacts_.stored(freedoms_);
    state.friction_loss = friction_loss();
    state.bond_energy = space_.energy(freedoms_);
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(freedoms_.size(), 0);
    state.punch_compliance = tangent_stiffness(space_, contacts_, forces, freedoms_).ldlt().solve(unit)[0];
}

/// Takes the oldest of more than so many fields as one, as they are now, so that these are left: memory is for fields that serve.
void ContactProblem::join_old_fields(std::size_t most, std::size_t left) {
    const std::size_t fields = space_.fields(), first = space_.rigid_motions();
    if (fields <= most) return;
    const std::size_t last = fields - std::max(left, first + 1) + first + 1;
    const Vector sum = space_.sum(freedoms_, first, last);
    const double unit = contacts_.max_approach(sum);
    if (!(unit > 0.0)) return;
    space_.join(solver_, first, last, sum, unit);
    freedoms_ = freedoms_(freedoms_without(fields, first, last)).eval();
    freedoms_.conservativeResize(freedoms_.size() + 1);
    freedoms_[freedoms_.size() - 1] = unit;
    contacts_.remove_fields(first, last);
    contacts_.add_field(space_, space_.fields() - 1);
}

void ContactProblem::soften(std::size_t bond, double share, const PairContact& ends) {
    join_old_fields(fields_of_a_sequence, 1);
    softened_ = true;
    space_.soften(bond, share);
    solver_.soften(network_, bond, share);
    contacts_.add_pair(ends);
}

}  // namespace kiln::mechanics
