// kinetics_test.cpp: activation energies and constants of diffusion come back from curves that were made of known ones.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "analysis/activated_time.h"
#include "analysis/activation_energy.h"
#include "analysis/kinetic_fit.h"
#include "core/types.h"
#include "physics/diffusion.h"
#include "physics/materials.h"
#include "tests/physics/relative.h"

using namespace kiln::analysis;
using kiln::Material;
using kiln::physics::gas_constant;
using kiln::physics::Schedule;
using kiln::test::relative;

namespace {

constexpr double kelvin_a_minute = 1.0 / 60.0;  // K/s
constexpr double start_temperature = 298.15, end_temperature = 1800.0;

Schedule heating(double rate) {
    return Schedule(
        {{0.0, start_temperature}, {(end_temperature - start_temperature) / (rate * kelvin_a_minute), end_temperature}});
}

/// Alumina with other constants.
Material material_with(double prefactor, double energy) {
    Material material = kiln::physics::builtin_material("alumina-dihedral");
    material.diffusion_prefactor = prefactor;
    material.activation_energy = energy;
    return material;
}

/// A body without particles whose density obeys an equation: d rho/d theta = (1 - rho)^2/(rho - 0.55)^2/g/unit with the fourth
/// power of its grains' size, g, growing by d g/d sigma = (rho - 0.5)/surface_unit: the past matters by when sigma passed, as in a
/// packing whose necks open the way of the coarsening.
constexpr double unit = 3e-27, surface_unit = 3e-29;  // m4
constexpr double start_density = 0.587;

/// Its run along a firing; `rows` many lines.
SimulatedRun run_of(const Material& material, std::optional<Activated> surface, const Schedule& schedule, int rows) {
    constexpr int substeps = 20;
    SimulatedRun run{"run", material, surface, schedule, {0.0}, {start_density}, {300e-9}};
    double density = start_density, grains = 1.0;
    const auto rate = [&](double time, double at, double size) {
        const double temperature = schedule.temperature(time), pores = 1.0 - at, neck = at - 0.55;
        return std::pair(boundary_rate(material, temperature) * pores * pores / (neck * neck) / size / unit,
                         surface ? surface_rate(material, *surface, temperature) * (at - 0.5) / surface_unit : 0.0);
    };
    const double hot = 0.4 * schedule.end();  // nothing happens before
    for (int row = 1; row <= rows; ++row) {
        const double begin = row == 1 ? 0.0 : hot + (schedule.end() - hot) * (row - 1) / rows,
                     end = hot + (schedule.end() - hot) * row / rows, step = (end - begin) / substeps;
        for (int substep = 0; substep < substeps; ++substep) {  // the midpoint rule
            const double time = begin + step * substep;
            const auto [first, growth] = rate(time, density, grains);
            const auto [middle, middle_growth] =
                rate(time + 0.5 * step, density + 0.5 * step * first, grains + 0.5 * step * growth);
            density += step * middle;
            grains += step * middle_growth;
        }
        run.time.push_back(end);
        run.density.push_back(density);
        run.grain_diameter.push_back(300e-9 * std::pow(grains, 0.25));
    }
    return run;
}

/// The same as a measured curve: every temperature of a list, in C.
DensityCurve measured(const SimulatedRun& run, double rate, double noise = 0.0, unsigned seed = 1) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0.0, 1.0);
    DensityCurve curve{"curve", run.schedule, {}, {}};
    const MonotoneCurve density(run.time, run.density);
    for (double celsius = 1050.0; celsius <= 1500.0; celsius += 25.0) {
        const double time = (celsius + 273.15 - start_temperature) / (rate * kelvin_a_minute);
        curve.time.push_back(time);
        curve.density.push_back(density.at(time) + noise * normal(random));
    }
    return curve;
}

constexpr double true_prefactor = 1e-3, true_energy = 570e3;  // m3/s, J/mol
constexpr double surface_energy = 313.8e3;                   // J/mol
const Activated true_surface{2.7e-12, surface_energy};

}  // namespace

TEST_CASE("kinetics: the integral of an activated rate is the quadrature's, and its inverse gives the time back") {
    const Schedule firing({{0.0, 300.0}, {6000.0, 1500.0}, {9600.0, 1500.0}, {12000.0, 900.0}});
    const FiringPath path(firing, 0.0, 12000.0);
    const auto rate = [](double temperature) { return std::exp(-700e3 / gas_constant * (1.0 / temperature - 1.0 / 1500.0)); };
    const ActivatedTime time(path, rate);
    for (const double until : {5500.0, 5987.0, 7000.0, 9700.0, 12000.0}) {
        CHECK(time.at(until) == relative(firing.integral(0.0, until, rate), 1e-4));
        if (until < 9700.0) CHECK(time.time_of(time.at(until)) == relative(until, 1e-9));
    }
    CHECK(time.whole() == relative(firing.integral(0.0, 12000.0, rate), 2e-6));
    CHECK(time.at(-5.0) == 0.0);
    CHECK(time.time_of(2.0 * time.whole()) == 12000.0);
    // A fit may try constants whose rates are beyond all numbers.
    CHECK(time.time_of(std::nan("")) == 0.0);
    const ActivatedTime infinite(path, [](double) { return std::numeric_limits<double>::infinity(); });
    CHECK_FALSE(infinite.time_of(1.0) < 0.0);  // no number, or one of the firing, but nothing beyond its nodes is read
    CHECK(std::isnan(MonotoneCurve({0.0, 1.0}, {0.0, 1.0}).at(std::nan(""))));
}

TEST_CASE("kinetics: where a cubic passes a density, and how fast; noise is averaged, not differentiated") {
    const auto cubic = [](double t) { return 0.6 + 0.05 * t + 0.02 * t * t - 0.004 * t * t * t; };
    DensityCurve curve{"cubic", Schedule::hold(1500.0), {}, {}};
    for (double t = 0.0; t <= 3.0; t += 0.5) {
        curve.time.push_back(t);
        curve.density.push_back(cubic(t));
    }
    const auto found = crossing(curve, cubic(1.3));
    REQUIRE(found);
    CHECK(found->time == relative(1.3, 1e-9));
    CHECK(found->rate == relative(0.05 + 0.04 * 1.3 - 0.012 * 1.3 * 1.3, 1e-9));
    CHECK(!crossing(curve, 0.59));  // begins above
    CHECK(!crossing(curve, 0.9));   // ends below
    std::mt19937_64 random(7);
    std::normal_distribution<double> noise(0.0, 5e-4);
    DensityCurve noisy{"noisy", Schedule::hold(1500.0), {}, {}};
    for (double t = 0.0; t <= 3.0; t += 0.002) {
        noisy.time.push_back(t);
        noisy.density.push_back(cubic(t) + noise(random));
    }
    const auto smooth = crossing(noisy, cubic(1.3));
    REQUIRE(smooth);
    CHECK(smooth->time == relative(1.3, 2e-3));
    CHECK(smooth->rate == relative(found->rate, 0.02));
}

TEST_CASE("kinetics: without a model both ways give back the energy of bodies that do not coarsen") {
    const Material material = material_with(true_prefactor, true_energy);
    std::vector<DensityCurve> curves;
    for (const double rate : {5.0, 10.0, 20.0}) curves.push_back(measured(run_of(material, std::nullopt, heating(rate), 60), rate));
    const std::vector<double> densities = common_densities(curves, 11);
    REQUIRE(densities.size() == 11);
    const std::vector<IsoDensity> lines = iso_density_energies(curves, densities);
    REQUIRE(lines.size() == 11);
    for (const IsoDensity& each : lines) {
        CHECK(each.energy.value == relative(true_energy, 0.02));
        CHECK(std::abs(each.energy.value - true_energy) < 4.0 * each.energy.error + 2e3);
    }
    const MasterCurve master = narrowest_master_curve(curves, densities);
    CHECK(master.energy.value == relative(true_energy, 2e-3));
    CHECK(master.error_from == "curves");
    CHECK(std::abs(master.energy.value - true_energy) < 3.0 * master.energy.error + 500.0);
    CHECK(master.width < 2e-3);
    CHECK(master_curve_width(curves, densities, true_energy - 100e3) > 20.0 * master.width);
    curves.pop_back();
    CHECK(narrowest_master_curve(curves, densities).error_from == "densities");
    curves.pop_back();
    CHECK_THROWS_WITH_AS(narrowest_master_curve(curves, densities), "no two measured curves pass one density", kiln::Error);
}

TEST_CASE("kinetics: one run of any constants gives prefactor and energy of curves within their stated errors") {
    const Material wrong = material_with(3e-6, 475e3), truth = material_with(true_prefactor, true_energy);
    const DensificationModel model({run_of(wrong, std::nullopt, heating(10.0), 60)});
    CHECK_FALSE(model.coarsens());
    int within = 0;
    constexpr int trials = 10;
    const SimulatedRun slow = run_of(truth, std::nullopt, heating(5.0), 60), fast = run_of(truth, std::nullopt, heating(20.0), 60);
    for (unsigned seed = 1; seed <= trials; ++seed) {
        KineticProblem problem;
        problem.curves = {measured(slow, 5.0, 0.002, seed), measured(fast, 20.0, 0.002, seed + 100)};
        problem.runs.assign(2, nullptr);
        problem.material = wrong;
        const KineticFit fit = fit_kinetics(model, problem);
        REQUIRE(fit.covariance);
        const double error = std::sqrt((*fit.covariance)(1, 1));
        CHECK(error < 0.02 * true_energy);
        CHECK(std::abs((*fit.covariance)(0, 1)) < 1e-6 * error * std::sqrt((*fit.covariance)(0, 0)));  // so chosen
        CHECK(fit.diffusion == relative(kiln::physics::diffusion_parameter_of(truth, fit.reference_temperature), 0.05));
        CHECK(std::log(fit.constants.boundary.prefactor / true_prefactor) ==
              relative((fit.constants.boundary.activation_energy - true_energy) / (gas_constant * fit.reference_temperature), 0.2));
        within += std::abs(fit.constants.boundary.activation_energy - true_energy) < 2.0 * error ? 1 : 0;
    }
    CHECK(within >= 8);
}

/// Runs of one body at another energy and prefactor than the truth's, so that sigma passes at other densities, and the bounds of a
/// problem by them.
static std::vector<SimulatedRun> family_of(KineticProblem& problem) {
    const Material guess = material_with(1e-3 * std::exp(-40e3 / (gas_constant * 1600.0)), 530e3);
    const double temperature = reference_temperature(problem.curves);
    std::vector<SimulatedRun> family;
    problem.min_ratio = 1e300;
    for (const double factor : {0.03, 0.1, 0.3, 1.0, 3.0, 10.0}) {
        family.push_back(run_of(guess, Activated{factor * 2e-12, surface_energy}, heating(10.0), 60));
        const double ratio = surface_rate(guess, *family.back().surface, temperature) / boundary_rate(guess, temperature);
        problem.min_ratio = std::min(problem.min_ratio, ratio);
        problem.max_ratio = std::max(problem.max_ratio, ratio);
    }
    return family;
}

/// Two curves of the truth, with or without surface diffusion.
static KineticProblem problem_of(std::optional<Activated> surface, double noise) {
    const Material truth = material_with(true_prefactor, true_energy);
    KineticProblem problem;
    for (const double rate : {5.0, 20.0})
        problem.curves.push_back(measured(run_of(truth, surface, heating(rate), 60), rate, noise, static_cast<unsigned>(rate)));
    problem.runs.assign(2, nullptr);
    problem.material = truth;
    problem.surface = true_surface;
    return problem;
}

TEST_CASE("kinetics: with coarsening three constants come back, once runs at those found correct the interpolation") {
    KineticProblem problem = problem_of(true_surface, 0.0);
    const DensificationModel model(family_of(problem));
    REQUIRE(model.coarsens());
    KineticFit fit = fit_kinetics(model, problem);
    CHECK(fit.constants.boundary.activation_energy == relative(true_energy, 0.05));
    const double first_miss = std::abs(fit.constants.boundary.activation_energy - true_energy);
    for (int round = 0; round < 2; ++round) {
        const Material found = material_with(fit.constants.boundary.prefactor, fit.constants.boundary.activation_energy);
        const SimulatedRun slow = run_of(found, fit.constants.surface, heating(5.0), 60),
                           fast = run_of(found, fit.constants.surface, heating(20.0), 60);
        REQUIRE(follows(slow, problem.curves[0].schedule, problem.curves[0].time));
        CHECK_FALSE(follows(slow, problem.curves[1].schedule, problem.curves[1].time));
        problem.runs = {&slow, &fast};
        fit = fit_kinetics(model, problem);
    }
    CHECK(std::abs(fit.constants.boundary.activation_energy - true_energy) < std::max(0.2 * first_miss, 2e3));
    CHECK(std::abs(std::log(fit.constants.surface->prefactor / true_surface.prefactor)) < 0.1);
    CHECK_FALSE(fit.surface_at_bound);
    for (const auto& curve : fit.residuals)
        for (const double residual : curve) CHECK(std::abs(residual) < 5e-4);
}

TEST_CASE("kinetics: grain sizes narrow the surface diffusivity, and draw it to what they say") {
    KineticProblem problem = problem_of(true_surface, 0.004);
    const DensificationModel model(family_of(problem));
    const KineticFit alone = fit_kinetics(model, problem);
    const SimulatedRun truth = run_of(problem.material, true_surface, heating(10.0), 200);
    const MonotoneCurve size(truth.density, truth.grain_diameter);
    for (const double density : {0.70, 0.75, 0.80}) problem.grains.push_back({density, size.at(density), 0.02});
    const KineticFit sized = fit_kinetics(model, problem);
    REQUIRE(alone.covariance);
    REQUIRE(sized.covariance);
    CHECK((*sized.covariance)(2, 2) < (*alone.covariance)(2, 2));
    CHECK(sized.surface_interval->second / sized.surface_interval->first <
          alone.surface_interval->second / alone.surface_interval->first);
    FiringPrediction firing(model, problem.material, problem.curves[0].schedule, problem.curves[0].time);
    CHECK(firing.diameter(sized.constants, 0.75) == relative(size.at(0.75), 0.1));
    // Grains that did not grow ask for less surface diffusion, and the densities are met less well.
    for (GrainSize& grain : problem.grains) grain.diameter = 300e-9;
    const KineticFit small = fit_kinetics(model, problem);
    CHECK(firing.diameter(small.constants, 0.75) < firing.diameter(sized.constants, 0.75));
}

TEST_CASE("kinetics: where nothing coarsened the surface diffusivity ends at its lower bound") {
    KineticProblem problem = problem_of(std::nullopt, 0.001);
    const DensificationModel model(family_of(problem));
    const KineticFit fit = fit_kinetics(model, problem);
    CHECK(fit.surface_at_bound);
    CHECK(fit.constants.boundary.activation_energy == relative(true_energy, 0.05));
}

TEST_CASE("kinetics: fewer points than constants, and runs that are not of one body, are refused") {
    const Material truth = material_with(true_prefactor, true_energy);
    const SimulatedRun run = run_of(truth, std::nullopt, heating(10.0), 60);
    const DensificationModel model({run});
    KineticProblem problem;
    DensityCurve one = measured(run_of(truth, std::nullopt, heating(5.0), 60), 5.0);
    one.time.resize(1);
    one.density.resize(1);
    problem.curves = {one};
    problem.runs = {nullptr};
    problem.material = truth;
    CHECK_THROWS_WITH_AS(fit_kinetics(model, problem), "there are 1 measured points, and 2 constants to find", kiln::Error);
    CHECK_THROWS_WITH_AS(DensificationModel({}), "there is no simulated run", kiln::Error);
    SimulatedRun other = run;
    other.density.front() = 0.58;
    CHECK_THROWS_WITH_AS(DensificationModel({run, other}),
                         "run: runs of one body start at relative densities of 0.587000 and 0.580000", kiln::Error);
    other = run;
    other.surface = true_surface;
    CHECK_THROWS_WITH_AS(DensificationModel({run, other}), "run: one run of a body coarsens and another one does not", kiln::Error);
    other = run;
    other.density.assign(other.density.size(), start_density);
    CHECK_THROWS_WITH_AS(DensificationModel({other}), "run: the run does not densify", kiln::Error);
}
