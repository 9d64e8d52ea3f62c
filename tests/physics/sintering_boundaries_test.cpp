// sintering_boundaries_test.cpp: films, pressure, free bodies, and the continuum's viscosities, against closed forms.
#include <doctest/doctest.h>

#include <Eigen/Dense>

#include <cmath>

#include "sintering/viscosity.h"
#include "tests/physics/sintering_cases.h"

using namespace kiln;
using namespace sintering_cases;

namespace {

State simple_cubic(double s) {
    const double cell = 2.0 * radius * (1.0 - s);
    return state_of({{0, 0, 0}}, {radius}, Vec3::Constant(cell), true);
}

double overlap_of(const State& state, int axis) { return 2.0 * radius - state.box.lengths[axis]; }

}  // namespace

TEST_CASE("a simple cubic cell under pressure closes as a pair pressed with the force on its face") {
    const double pressure = 20e6, time = 5.0, start = 2.0 * radius * 0.02;
    sintering::SinteringSettings wanted = settings(1e-5);
    wanted.pressure = Vec3(0.0, 0.0, pressure);
    const State end = sintered(simple_cubic(0.02), time, wanted);
    // dh/dt = (9/8 pi 2R* gamma + P) 8 Delta/(pi a^4), P = p L_x L_y, with the other two axes by the pair law: Runge-Kutta.
    const auto side = [&](double t) { return 2.0 * radius - pair_law(start, 0.5 * radius, t); };
    const auto rate = [&](double h, double t) {
        const double force = 1.125 * std::numbers::pi * radius * surface_energy() + pressure * side(t) * side(t);
        return force * 8.0 * diffusion() / (std::numbers::pi * 4.0 * radius * radius * h * h);
    };
    double h = start;
    const int steps = 20000;
    const double dt = time / steps;
    for (int step = 0; step < steps; ++step) {
        const double t = step * dt, a = rate(h, t), b = rate(h + 0.5 * dt * a, t + 0.5 * dt),
                     c = rate(h + 0.5 * dt * b, t + 0.5 * dt);
        h += dt / 6.0 * (a + 2.0 * b + 2.0 * c + rate(h + dt * c, t + dt));
    }
    CHECK(deviation(overlap_of(end, 2), h) < 1e-4);
    CHECK(deviation(overlap_of(end, 0), pair_law(start, 0.5 * radius, time)) < 1e-6);
}

TEST_CASE("stress: minus the pressure along a loaded axis, tension along a fixed one, none along a free one") {
    sintering::SinteringSettings wanted = settings();
    wanted.pressure = Vec3(0.0, 0.0, 5e6);
    wanted.fixed = {true, false, false};
    sintering::ImplicitSintering sintering(face_centred_cell(0.03), wanted);
    const sintering::StepRecord record = sintering.advance(1.0, endless);
    CHECK(deviation(record.stress[2], -5e6) < 1e-5);
    CHECK(std::abs(record.stress[1]) < 1e2);
    CHECK(record.stress[0] > 1e6);
    CHECK(record.strain[0] == 0.0);
    CHECK_THROWS_WITH_AS(([] {
                             sintering::SinteringSettings both = settings();
                             both.pressure = Vec3(1e6, 0.0, 0.0);
                             both.fixed = {true, false, false};
                             return sintering::ImplicitSintering(face_centred_cell(0.03), both);
                         }()),
                         doctest::Contains("pressure"), Error);
}

TEST_CASE("a face-centred film shrinks across its plane by C12 and C11 of its viscosities") {
    const double s = 0.05, overlap = 2.0 * radius * s;
    const auto rate = [&](bool film) {
        sintering::SinteringSettings wanted = settings();
        wanted.fixed = {film, film, false};
        sintering::ImplicitSintering sintering(face_centred_cell(s), wanted);
        const double time = 1e-4 * std::pow(overlap, 3) * 0.5 * radius / (3.375 * diffusion() * surface_energy());
        return sintering.advance(time, endless).strain[2] / time;
    };
    const physics::ContactConstants constants;
    const double shear = physics::tangential_viscosity(constants, overlap, 0.5 * radius),
                 normal = physics::normal_viscosity_factor(constants, 0.5 * radius) * overlap * overlap;
    // Lattice of normal and tangential links: C11 = sqrt2 (kn + kt)/l, C12 = (kn - kt)/(sqrt2 l), so free to film is C11/(C11 + 2
    // C12).
    CHECK(deviation(rate(true) / rate(false), 2.0 * normal / (normal + shear)) < 1e-4);
}

TEST_CASE("sintering stress and viscosities of a face-centred lattice are those of affine motion") {
    const double s = 0.04, overlap = 2.0 * radius * s;
    State state = face_centred_cell(s);
    const double density = relative_density(state), spacing = 2.0 * radius - overlap;
    const sintering::ViscousResponse response = sintering::viscous_response(state, {}, temperature);
    const physics::ContactConstants constants;
    const double normal = physics::normal_viscosity_factor(constants, 0.5 * radius) * overlap * overlap / diffusion();
    const double shear = physics::tangential_viscosity(constants, overlap, 0.5 * radius) / diffusion();
    CHECK(deviation(response.viscosity(0, 0), std::sqrt(2.0) * (normal + shear) / spacing) < 1e-6);
    CHECK(deviation(response.viscosity(0, 1), (normal - shear) / (std::sqrt(2.0) * spacing)) < 1e-6);
    CHECK(deviation(response.viscosity(2, 0), response.viscosity(0, 2)) < 1e-9);
    // (9/32) Z rho gamma/R and Z rho <a^4>/(48 Delta R) hold for l = 2R; the distance of centres is l = 2R (1 - s).
    const double shorter = spacing / (2.0 * radius);
    CHECK(deviation(response.mean_sintering_stress(), 9.0 / 32.0 * 12.0 * density * surface_energy() / radius * shorter) < 1e-6);
    const double neck = std::pow(physics::contact_radius_squared(overlap, 0.5 * radius), 2);
    CHECK(deviation(response.bulk_viscosity(), 12.0 * density * neck / (48.0 * diffusion() * radius) * shorter * shorter) < 1e-6);
    state.box.periodic[0] = false;
    CHECK_THROWS_AS(sintering::viscous_response(state, {}, temperature), Error);
}

TEST_CASE("viscosities of a random packing are symmetric, below the affine bound, and predict its free shrinkage") {
    const State state = sintered(random_packing(400, 0.55, 1.0), 30.0);
    const sintering::ViscousResponse response = sintering::viscous_response(state, {}, temperature);
    CHECK(response.converged);
    CHECK((response.viscosity - response.viscosity.transpose()).norm() < 1e-5 * response.viscosity.norm());
    const ContactStatistics contacts =
        contact_statistics(state.box, state.particles, find_pairs(state.box, state.particles.position, state.particles.radius));
    const double bound = 9.0 / 32.0 * contacts.coordination_number * relative_density(state) * surface_energy() / radius;
    CHECK(response.mean_sintering_stress() > 0.3 * bound);
    CHECK(response.mean_sintering_stress() < 1.01 * bound);
    CHECK(response.shear_viscosity() > 0.0);
    // strain rate = -K^-1 (sintering stress)
    sintering::ImplicitSintering sintering(state, settings(1e-5));
    const double time = 0.02;
    while (sintering.time() < state.time + time) sintering.advance(state.time + time, endless);
    const double predicted = -response.viscosity.ldlt().solve(response.sintering_stress).sum() * time;
    CHECK(deviation(std::log(relative_density(state) / sintering.relative_density()), predicted) < 0.05);
}

TEST_CASE("a free cube of a lattice shrinks as the lattice does, its box with it, and stays where it is") {
    const double s = 0.01, spacing = 2.0 * radius * (1.0 - s), time = 20.0;
    std::vector<Vec3> positions;
    for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 4; ++y)
            for (int z = 0; z < 4; ++z) positions.push_back(spacing * (Vec3(x, y, z) + Vec3::Constant(0.5)));
    State state = state_of(positions, std::vector<double>(64, radius), Vec3::Constant(4.0 * spacing), true);
    sintering::SinteringSettings wanted = settings();
    wanted.faces = sintering::Faces::free;
    const double before = relative_density(state);
    const State end = sintered(state, time, wanted);
    const double reached = pair_law(2.0 * radius * s, 0.5 * radius, time) / (2.0 * radius);
    CHECK(deviation(relative_density(end), before * std::pow((1.0 - s) / (1.0 - reached), 3)) < 1e-6);
    CHECK_FALSE(end.box.periodic[0]);
    Vec3 centre = Vec3::Zero();
    for (const Vec3& position : end.particles.position) centre += position / 64.0;
    CHECK((centre - Vec3::Constant(2.0 * spacing)).norm() < 1e-10 * spacing);
    CHECK((end.box.origin + 0.5 * end.box.lengths - centre).norm() < 1e-9 * spacing);
}
