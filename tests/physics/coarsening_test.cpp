// coarsening_test.cpp: exchange of volume between grains against its closed forms, its scaling, conservation, and with sintering.
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "physics/coarsening.h"
#include "sintering/coarsening.h"
#include "tests/physics/sintering_cases.h"

namespace coarsening_test {

using namespace kiln;
using namespace kiln::sintering;
using namespace sintering_cases;

namespace {

Material alumina() { return physics::builtin_material("alumina-dihedral"); }

/// gamma D_s' and M gamma_gb at the temperature of the tests, m4/s and m2/s.
double surface_rate() { return *alumina().surface_energy * physics::surface_diffusion_of(alumina(), temperature); }
double boundary_rate() {
    return physics::boundary_energy(*alumina().surface_energy, *alumina().dihedral_angle) *
           physics::boundary_mobility_of(alumina(), temperature);
}

State grains_of(const std::vector<Vec3>& positions, const std::vector<double>& radii, const Vec3& box, bool periodic) {
    State state = state_of(positions, radii, box, periodic);
    state.materials = {alumina()};
    return state;
}

/// Two grains whose neck is set to a share of the smaller radius again and again, and the clock.
class SteadyPair {
   public:
    SteadyPair(double ratio, double share, const CoarseningSettings& settings)
        : share_(share),
          state_(grains_of({{1e-6, 1e-6, 1e-6}, {1e-6 + (1.0 + ratio) * radius, 1e-6, 1e-6}}, {radius, ratio * radius},
                           Vec3::Constant(1e-4), false)),
          kinetics_(state_, physics::Schedule::hold(temperature)),
          body_(state_, Faces::as_given),
          coarsening_(state_, settings) {}

    double small() const { return *std::ranges::min_element(body_.particles().radius); }
    double time() const { return time_; }

    void rest(double span) {
        Grains grains = body_.grains();
        const double first = grains.radius[0], second = grains.radius[1];
        const Pair pair{0, 1, {}};
        grains.pair = {pair};
        grains.offset = {physics::overlap_of_neck(share_ * std::min(first, second), physics::reduced_radius(first, second)) -
                         (first + second - body_.vector(pair).norm())};
        body_.set_grains(grains);
        body_.set_grains(coarsening_.over(body_, kinetics_, time_, time_ + span).grains);
        time_ += span;
    }

    /// Time until the smaller grain has vanished, in steps that take a little of the time it still has; power: of its radius in
    /// that.
    double vanishing_time(double unit, double power) {
        while (small() > 0.0) rest(5e-3 * unit * std::pow(small() / radius, power));
        return time_;
    }

   private:
    double share_, time_ = 0.0;
    State state_;
    Kinetics kinetics_;
    SinteringBody body_;
    Coarsening coarsening_;
};

constexpr CoarseningSettings by_surface{.surface = true}, by_boundary{.boundary = true}, by_both{.surface = true, .boundary = true};

/// A periodic packing of unequal grains.
State grains_packing(std::int64_t count, double density, double scale, double deviation_of_log, std::uint64_t seed = 3) {
    packing::PackingOptions wanted;
    wanted.particles = count;
    wanted.method = packing::Method::affine;
    wanted.density = 0.45;
    wanted.compact_to = density;
    wanted.seed = seed;
    wanted.distribution = packing::Lognormal{100e-9, deviation_of_log, 0.0, 1.0};
    State state = packing::pack(wanted);
    state.materials = {alumina()};
    state.box.lengths *= scale;
    for (Vec3& position : state.particles.position) position *= scale;
    for (double& each : state.particles.radius) each *= scale;
    return state;
}

/// The grains of a state after a rest.
Grains rested(const State& state, double time, const CoarseningSettings& settings) {
    const SinteringBody body(state, Faces::as_given);
    const Kinetics kinetics(state, physics::Schedule::hold(temperature));
    return Coarsening(state, settings).over(body, kinetics, 0.0, time).grains;
}

double volume_of(const std::vector<double>& radius) {
    double sum = 0.0;
    for (const double each : radius) sum += sphere_volume(each);
    return sum;
}

}  // namespace

TEST_CASE("coarsening: a pair that keeps its volume loses the smaller grain when it should, by boundary and by surface") {
    const double ratios[] = {1.1, 1.25, 1.5, 2.0, 3.0, 5.0, 10.0};
    const double free[] = {2.353, 2.112, 1.919, 1.743, 1.608, 1.521, 1.464};
    const double narrower[] = {3.695, 3.110, 2.706, 2.370, 2.127, 1.975, 1.879};
    const double surface[] = {1.534, 1.172, 0.976, 0.862, 0.830, 0.870, 0.980};
    const double boundary_unit = radius * radius / boundary_rate(), surface_unit = std::pow(radius, 4) / surface_rate();
    for (std::size_t row = 0; row < std::size(ratios); ++row) {
        CAPTURE(ratios[row]);
        CoarseningSettings settings = by_boundary;
        settings.chi = 1.0;
        CHECK(deviation(SteadyPair(ratios[row], 1.0 - 1e-6, settings).vanishing_time(boundary_unit, 2.0) / boundary_unit,
                        free[row]) < 0.01);
        settings.chi = 0.95;
        CHECK(deviation(SteadyPair(ratios[row], 0.95, settings).vanishing_time(boundary_unit, 2.0) / boundary_unit,
                        narrower[row]) < 0.01);
        CHECK(deviation(SteadyPair(ratios[row], 0.8, by_surface).vanishing_time(surface_unit, 4.0) / surface_unit, surface[row]) <
              0.01);
    }
}

TEST_CASE("coarsening: a boundary whose neck is narrower than chi of the smaller grain is pinned") {
    CoarseningSettings settings = by_boundary;
    SteadyPair pair(2.0, 0.94, settings);
    pair.rest(radius * radius / boundary_rate());
    CHECK(pair.small() == radius);
}

TEST_CASE("coarsening: small necks against closed forms: beside a much larger grain, and one of fixed size") {
    CoarseningSettings settings = by_boundary;
    settings.chi = 0.1;
    const double time = radius * radius / (settings.chi * settings.chi * boundary_rate());
    SteadyPair beside_wall(1e3, settings.chi, settings);
    while (beside_wall.time() < time) beside_wall.rest(time / 500.0);
    CHECK(deviation(std::pow(beside_wall.small() / radius, 2), 0.5) < 0.01);
    // t = 4 r_l^2/(chi^2 M gamma_gb) [-ln(1 - r_s/r_l) - r_s/r_l], r_l fixed: a ratio at which what it gets matters little.
    const double share = 1.0 / 8.0, unit = radius * radius / boundary_rate();
    const double expected = 4.0 / (share * share * settings.chi * settings.chi) * (-std::log1p(-share) - share);
    SteadyPair pair(1.0 / share, settings.chi, settings);
    CHECK(deviation(pair.vanishing_time(unit / (settings.chi * settings.chi), 2.0) / unit, expected) < 0.01);
    // By surface: r^4 falls linearly in time as long as the resistances stay what they are.
    SteadyPair film(1e3, 0.5, by_surface);
    const double resistance = physics::surface_resistance(0.5, 1.0) + physics::surface_resistance(0.5, 1e3);
    const double span = 0.05 * std::pow(radius, 4) * std::numbers::pi * resistance / surface_rate();
    for (int step = 0; step < 50; ++step) film.rest(span / 50.0);
    CHECK(deviation(1.0 - std::pow(film.small() / radius, 4), 0.1) < 0.01);
}

TEST_CASE("coarsening: what a grain gives in one step is exact for each mechanism alone, and never more than all") {
    for (const double part : {1e-6, 0.01, 0.3, 0.7}) {
        CHECK(std::pow(1.0 - physics::fraction_given(part, 0.0), 4.0 / 3.0) == test::relative(1.0 - 4.0 / 3.0 * part, 1e-9));
        CHECK(std::pow(1.0 - physics::fraction_given(0.0, part), 2.0 / 3.0) == test::relative(1.0 - 2.0 / 3.0 * part, 1e-9));
        const double given = physics::fraction_given(0.4 * part, 0.6 * part);
        CHECK(physics::times_for_fraction(0.4, 0.6, given) == test::relative(part, 1e-9));
    }
    CHECK(physics::fraction_given(1e9, 1e9) == 1.0);
}

TEST_CASE(
    "coarsening: the neck at equilibrium is that of equal spheres, the smaller grain from a ratio of sizes on, in between "
    "continuous") {
    const double psi = *alumina().dihedral_angle, sine = std::sin(0.5 * psi), critical = -1.0 / std::cos(psi);
    CHECK(physics::equilibrium_neck(1.0, 1.0, sine) == test::relative(sine, 1e-12));
    CHECK(critical == test::relative(1.346, 1e-3));
    CHECK(physics::equilibrium_neck(1.0, critical * (1.0 - 1e-9), sine) == test::relative(1.0 - 1e-6, 1e-6));
    CHECK(physics::equilibrium_neck(1.0, 1.001 * critical, sine) == 1.0 - physics::neck_clip);
    // The circle in which two spheres meet at the angle psi: by the cosines of the triangle of centres and a point of the circle.
    const double a = physics::equilibrium_neck(1.0, 1.2, sine);
    CHECK(std::asin(a / 1.0) + std::asin(a / 1.2) == test::relative(psi, 1e-12));
}

TEST_CASE("coarsening: grains of one size never exchange anything") {
    const State state = [] {
        State equal = random_packing(200, 0.5, 1.0);
        equal.materials = {alumina()};
        return equal;
    }();
    const Grains grains = rested(state, 1e6, by_both);
    CHECK(grains.pair.empty());
    CHECK(std::ranges::all_of(grains.radius, [&](double each) { return each == state.particles.radius.front(); }));
}

TEST_CASE("coarsening: lengths times lambda take times times lambda^2 by boundary and lambda^4 by surface; volume stays") {
    const double scale = 7.0;
    const State small = grains_packing(300, 0.75, 1.0, 1.4), large = grains_packing(300, 0.75, scale, 1.4);
    for (const auto& [settings, power, unit] :
         {std::tuple(by_boundary, 2.0, 3e-15 / boundary_rate()), {by_surface, 4.0, 1e-30 / surface_rate()}}) {
        CoarseningSettings wanted = settings;
        wanted.chi = 0.3;
        const Grains a = rested(small, unit, wanted), b = rested(large, unit * std::pow(scale, power), wanted);
        REQUIRE(a.radius.size() == b.radius.size());
        double largest = 0.0;
        for (std::size_t row = 0; row < a.radius.size(); ++row)
            largest = std::max(largest, std::abs(b.radius[row] / scale - a.radius[row]) / radius);
        CHECK(largest < 1e-6);
        CHECK(std::ranges::count(a.radius, 0.0) > 3);
        CHECK(std::ranges::count(a.radius, 0.0) < 200);
        CHECK(deviation(volume_of(a.radius), volume_of(small.particles.radius)) < 1e-12);
    }
}

TEST_CASE("coarsening: grains of unlike materials exchange nothing") {
    State state = grains_of({{1e-6, 1e-6, 1e-6}, {1.14e-6, 1e-6, 1e-6}}, {radius, 2.0 * radius}, Vec3::Constant(1e-5), false);
    CHECK(rested(state, 1e3, by_both).radius.size() == 2);
    CHECK(rested(state, 1e3, by_surface).radius != state.particles.radius);
    state.materials.push_back(alumina());
    state.materials[1].name = "another";
    state.particles.material[1] = 1;
    CHECK(rested(state, 1e3, by_both).radius == state.particles.radius);
}

TEST_CASE("coarsening: what a material lacks is one sentence") {
    State state = grains_of({{1e-6, 1e-6, 1e-6}}, {radius}, Vec3::Constant(1e-5), false);
    state.materials = {physics::builtin_material("alumina")};
    CHECK_THROWS_WITH_AS(Coarsening(state, by_surface), doctest::Contains("material 'alumina' has no surface_diffusion"), Error);
    CHECK_THROWS_WITH_AS(Coarsening(state, by_boundary), doctest::Contains("material 'alumina' has no boundary_mobility"), Error);
}

TEST_CASE("coarsening: necks grow by surface diffusion alone with the seventh root of time, and nothing shrinks by that") {
    const State state =
        grains_of({{1e-6, 1e-6, 1e-6}, {1e-6 + 2.0 * radius, 1e-6, 1e-6}}, {radius, radius}, Vec3::Constant(1e-5), false);
    for (const double time : {1e-3, 0.1}) {
        const Grains grains = rested(state, time, {.neck_growth = true});
        REQUIRE(grains.pair.size() == 1);
        const double neck = std::sqrt(physics::contact_radius_squared(grains.offset[0], 0.5 * radius));
        CHECK(deviation(std::pow(neck / radius, 7), 56.0 * surface_rate() * time / std::pow(radius, 4)) < 1e-6);
        CHECK(grains.radius == state.particles.radius);
    }
}

TEST_CASE("coarsening and sintering: the error of a step falls with the square of its length where no grain vanishes") {
    // Two sizes on the sites of a body-centred cell: every motion is affine, so that only the splitting of the two leaves an error.
    const double cell = 2.0 * 55e-9 * 0.98 / std::sqrt(0.75);
    const State state = grains_of({{0, 0, 0}, Vec3::Constant(0.5 * cell)}, {52e-9, 58e-9}, Vec3::Constant(cell), true);
    const auto density_after = [&](int steps) {
        SinteringSettings wanted = settings(0.5);
        wanted.coarsening = by_surface;
        wanted.schedule = physics::Schedule::hold(1700.0);
        const double start = 3e-3, end = 5e-2;  // s; up to the first the same short steps, after which the control allows long ones
        ImplicitSintering sintering(state, wanted);
        while (sintering.time() < start) sintering.advance(std::min(start, sintering.time() + 0.01 * start), endless);
        const std::size_t before = sintering.steps();
        for (int step = 1; step <= steps; ++step) sintering.advance(start + (end - start) * step / steps, endless);
        CHECK(sintering.steps() - before == static_cast<std::size_t>(steps));
        CHECK(sintering.time() == end);
        CHECK(sintering.state().particles.radius.front() < 0.998 * 52e-9);
        return sintering.relative_density();
    };
    const double reference = density_after(512), coarse = density_after(32) - reference, fine = density_after(64) - reference;
    CHECK(std::abs(coarse) > 1e-7);
    CHECK(coarse / fine == test::relative(4.0, 0.15));
}

}  // namespace coarsening_test
