// sizes_test.cpp: size distributions by volume and by number: what is drawn, and what lies below a diameter, against closed forms.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "analysis/histogram.h"
#include "core/types.h"
#include "packing/size_distribution.h"
#include "packing/sphere_list.h"
#include "tests/physics/relative.h"

using namespace kiln;
using namespace kiln::packing;
using kiln::test::deviation;
using kiln::test::relative;

namespace {

constexpr auto by_number = Weighting::number, by_volume = Weighting::volume;

std::vector<double> drawn(const SizeDistribution& distribution, std::size_t particles, std::uint64_t seed = 1) {
    Random random(seed);
    std::vector<double> diameters = draw_radii(distribution, particles, random);
    for (double& diameter : diameters) diameter *= 2.0;
    return diameters;
}

/// Part of the number or the volume of particles that lies below a diameter.
double part_below(const std::vector<double>& diameters, double limit, Weighting weighting) {
    double below = 0.0, total = 0.0;
    for (const double diameter : diameters) {
        const double weight = weighting == by_volume ? std::pow(diameter, 3) : 1.0;
        total += weight;
        if (diameter < limit) below += weight;
    }
    return below / total;
}

const std::vector<Undersize> curve{{0.1e-6, 0.0}, {0.2e-6, 0.3}, {0.5e-6, 0.8}, {1e-6, 1.0}};

}  // namespace

TEST_CASE("sizes: classes by volume are drawn by the number that has this volume, to a particle") {
    const SizeClasses powder({{0.1e-6, 0.1e-6, 5.0}, {0.2e-6, 0.2e-6, 30.0}, {0.5e-6, 0.5e-6, 65.0}}, by_volume);
    std::map<double, double> counts;
    for (const double diameter : drawn(powder, 10000)) ++counts[std::round(diameter / 1e-8)];
    const double numbers[] = {5.0 / 1.0, 30.0 / 8.0, 65.0 / 125.0}, total = numbers[0] + numbers[1] + numbers[2];
    REQUIRE(counts.size() == 3);
    CHECK(std::abs(counts[10] - 1e4 * numbers[0] / total) < 2.0);
    CHECK(std::abs(counts[20] - 1e4 * numbers[1] / total) < 2.0);
    CHECK(std::abs(counts[50] - 1e4 * numbers[2] / total) < 2.0);
    CHECK(powder.quantile(0.34, by_volume) == relative(0.2e-6, 1e-15));
    CHECK(powder.quantile(0.36, by_volume) == relative(0.5e-6, 1e-15));
    CHECK(powder.quantile(0.5, by_number) == relative(0.1e-6, 1e-15));
    CHECK(powder.mean() == relative((0.1 * numbers[0] + 0.2 * numbers[1] + 0.5 * numbers[2]) / total * 1e-6, 1e-14));
}

TEST_CASE("sizes: a cumulative curve by volume comes back from the particles, by volume") {
    const SizeClasses powder(classes_between(curve), by_volume);
    CHECK(powder.quantile(0.5, by_volume) ==
          relative(0.2e-6 * std::pow(2.5, 0.4), 1e-14));  // 0.2 of 0.5 of the way from 0.2 to 0.5
    CHECK(powder.quantile(0.3, by_volume) == relative(0.2e-6, 1e-14));
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const std::vector<double> sample = drawn(powder, 20000, seed);
        for (const double diameter : {0.15e-6, 0.2e-6, 0.3e-6, 0.5e-6, 0.8e-6}) {
            CAPTURE(diameter);
            double expected = 0.0;
            for (std::size_t point = 1; point < curve.size(); ++point) {
                const auto [low, share] = curve[point - 1];
                const auto [high, next] = curve[point];
                const double way = std::clamp(std::log(diameter / low) / std::log(high / low), 0.0, 1.0);
                expected += way * (next - share);
            }
            // The upper class is 91 particles: one of them more or less is 0.3 % of the volume.
            CHECK(std::abs(part_below(sample, diameter, by_volume) - expected) < 4e-3);
        }
    }
}

TEST_CASE("sizes: by number within one class that was measured by volume, and the other way, by hand") {
    const double a = 1e-7, b = 4e-7;
    const SizeClasses measured_by_volume({{a, b, 1.0}}, by_volume), measured_by_number({{a, b, 1.0}}, by_number);
    const double inverse = std::pow(a, -3), last = std::pow(b, -3);
    for (const double fraction : {0.1, 0.5, 0.9}) {
        CHECK(measured_by_volume.quantile(fraction, by_number) ==
              relative(std::pow(inverse - fraction * (inverse - last), -1.0 / 3.0), 1e-13));
        CHECK(measured_by_volume.quantile(fraction, by_volume) == relative(a * std::pow(b / a, fraction), 1e-13));
        CHECK(measured_by_number.quantile(fraction, by_number) == relative(a * std::pow(b / a, fraction), 1e-13));
        CHECK(measured_by_number.quantile(fraction, by_volume) ==
              relative(std::cbrt(std::pow(a, 3) + fraction * (std::pow(b, 3) - std::pow(a, 3))), 1e-13));
    }
    CHECK(measured_by_number.mean() == relative((b - a) / std::log(b / a), 1e-13));
}

TEST_CASE("sizes: percentiles by volume are met exactly, and by the particles") {
    const SizeDistribution powder = parse_distribution("percentiles:0.2um:0.3um:0.6um", 0.0);
    CHECK(size_quantile(powder, 0.1, by_volume) == relative(0.2e-6, 1e-13));
    CHECK(size_quantile(powder, 0.5, by_volume) == relative(0.3e-6, 1e-13));
    CHECK(size_quantile(powder, 0.9, by_volume) == relative(0.6e-6, 1e-13));
    CHECK(size_quantile(powder, 0.0, by_number) == relative(0.2e-6 * 0.2 / 0.3, 1e-13));
    CHECK(size_quantile(powder, 1.0, by_number) == relative(0.6e-6 * 0.6 / 0.3, 1e-13));
    const std::vector<double> sample = drawn(powder, 20000);
    CHECK(std::abs(part_below(sample, 0.2e-6, by_volume) - 0.1) < 3e-3);
    CHECK(std::abs(part_below(sample, 0.3e-6, by_volume) - 0.5) < 3e-3);
    CHECK(std::abs(part_below(sample, 0.6e-6, by_volume) - 0.9) < 3e-3);
    // A lognormal distribution with its own tails cut far out is the one that its percentiles describe.
    const double sigma = std::log(1.3), z = 1.2815515655446004;
    const std::string d10 = std::to_string(100.0 * std::exp(-z * sigma)) + "nm",
                      d90 = std::to_string(100.0 * std::exp(z * sigma)) + "nm";
    const SizeDistribution same = parse_distribution("percentiles:" + d10 + ":100nm:" + d90 + ":20nm:500nm", 0.0, by_number);
    CHECK(size_quantile(same, 0.3, by_number) == relative(100e-9 * std::exp(-0.5244005127080407 * sigma), 1e-3));
    CHECK(size_quantile(same, 0.97, by_number) == relative(100e-9 * std::exp(1.8807936081512509 * sigma), 2e-3));
    for (const char* text : {"percentiles:0.3um:0.2um:0.6um", "percentiles:0.2um:0.3um:0.6um:0.25um:1um", "percentiles:1um:1um:1um",
                             "percentiles:0.2um:0.3um", "percentiles:0.2:0.3um:0.6um"})
        CHECK_THROWS_AS(parse_distribution(text, 0.0), TextError);
}

TEST_CASE("sizes: a lognormal distribution by volume has the median by number of Hatch and Choate") {
    const SizeDistribution powder = parse_distribution("lognormal:200nm:1.4", 0.0, by_volume);
    const double by_hand = 200e-9 * std::exp(-3.0 * std::pow(std::log(1.4), 2));
    CHECK(std::get<Lognormal>(powder).median == relative(by_hand, 1e-14));
    CHECK(size_quantile(powder, 0.5, by_volume) == relative(200e-9, 1e-10));
    CHECK(size_quantile(powder, 0.5, by_number) == relative(by_hand, 1e-10));
    CHECK(size_quantile(powder, 0.9, by_volume) == relative(200e-9 * std::pow(1.4, 1.2815515655446004), 1e-10));
    // The median by volume of 20000 draws scatters by 0.7 %.
    CHECK(std::abs(part_below(drawn(powder, 20000), 200e-9, by_volume) - 0.5) < 0.03);
    const SizeDistribution cut = parse_distribution("lognormal:100nm:1.4:50nm:200nm", 0.0);
    CHECK(size_quantile(cut, 0.0, by_number) == relative(50e-9, 1e-9));
    CHECK(size_quantile(cut, 0.5, by_number) == relative(100e-9, 1e-9));
    CHECK(size_quantile(cut, 1.0, by_volume) == relative(200e-9, 1e-9));
    const std::vector<double> sample = drawn(cut, 50000);
    CHECK(std::abs(part_below(sample, size_quantile(cut, 0.5, by_volume), by_volume) - 0.5) < 0.01);
}

TEST_CASE("sizes: a bimodal fraction by volume") {
    const SizeDistribution powder = parse_distribution("bimodal:200nm:100nm:0.5", 0.0, by_volume);
    const std::vector<double> sample = drawn(powder, 9000);
    CHECK(std::ranges::count_if(sample, [](double diameter) { return diameter > 150e-9; }) == 1000);
    CHECK(size_quantile(powder, 0.49, by_volume) == relative(100e-9, 1e-15));
    CHECK(size_quantile(powder, 0.51, by_volume) == relative(200e-9, 1e-15));
    CHECK(size_quantile(powder, 0.88, by_number) == relative(100e-9, 1e-15));
}

TEST_CASE("sizes: a list is drawn from at random by the seed, not from its beginning, and each line as often as another") {
    DiameterList sorted;
    for (int line = 0; line < 200; ++line) sorted.diameters.push_back(1e-9 * (55 + 5 * line));
    const auto mean_of = [](const std::vector<double>& values) {
        return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    };
    const double mean = mean_of(sorted.diameters);  // the standard error of 50 of 200 is 36 nm
    std::set<std::vector<double>> different;
    double all = 0.0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const std::vector<double> few = drawn(sorted, 50, seed);
        CHECK(std::set<double>(few.begin(), few.end()).size() == 50);
        CHECK(std::abs(mean_of(few) - mean) < 4.0 * 36e-9);
        all += mean_of(few) / 40.0;
        different.insert(few);
    }
    CHECK(std::abs(all - mean) < 4.0 * 36e-9 / std::sqrt(40.0));
    CHECK(different.size() == 40);
    CHECK(deviation(mean_of(drawn(sorted, 200)), mean) < 1e-14);
    std::map<double, int> counts;
    for (const double diameter : drawn(sorted, 500)) ++counts[diameter];
    CHECK(counts.size() == 200);
    CHECK(std::ranges::all_of(counts, [](const auto& each) { return each.second == 2 || each.second == 3; }));
}

TEST_CASE("sizes: what is no distribution is refused") {
    CHECK_THROWS_AS(SizeClasses({}, by_volume), Error);
    CHECK_THROWS_AS(SizeClasses({{1e-7, 1e-7, 0.0}}, by_volume), Error);
    CHECK_THROWS_AS(SizeClasses({{0.0, 1e-7, 1.0}}, by_volume), Error);
    CHECK_THROWS_AS(SizeClasses({{2e-7, 2e-7, 1.0}, {1e-7, 1e-7, 1.0}}, by_volume), Error);
    CHECK_THROWS_AS(SizeClasses({{1e-7, 2e-7, -1.0}}, by_volume), Error);
}

TEST_CASE("spheres: a free body reaches as far as they do, with their overlap") {
    const State state = body_of({{{0.5, 0.5, 0.5}, {1.45, 0.5, 0.5}}, {0.5, 0.5}}, {});
    CHECK(state.box.origin == Vec3(0.0, 0.0, 0.0));
    CHECK((state.box.lengths - Vec3(1.95, 1.0, 1.0)).norm() < 1e-15);
    CHECK(state.box.periodic == std::array{false, false, false});
    const Overlaps overlaps = overlaps_of(state);
    CHECK(overlaps.contacts == 1);
    CHECK(overlaps.mean == relative(0.05, 1e-12));
    CHECK(overlaps.max == relative(0.05, 1e-12));
}

TEST_CASE("spheres: a periodic box closes over its faces, and a swell brings spheres that touch into contact") {
    SphereOptions options;
    options.lengths = Vec3(2.0, 1.0, 1.0);
    options.periodic = {true, true, true};
    const SphereList touching{{{0.5, 0.5, 0.5}, {1.5, 0.5, 0.5}}, {0.5, 0.5}};
    CHECK(overlaps_of(body_of(touching, options)).contacts == 6);
    CHECK(overlaps_of(body_of(touching, options)).max < 1e-12);
    options.swell = 0.01;
    const State pressed = body_of(touching, options);
    CHECK(pressed.box.lengths[0] == relative(2.0 / 1.01, 1e-14));
    CHECK(overlaps_of(pressed).contacts == 6);
    CHECK(overlaps_of(pressed).mean == relative(1.0 - 1.0 / 1.01, 1e-12));
    options.swell = 0.0;
    options.origin = Vec3(-1.0, -0.5, -0.5);
    CHECK_THROWS_WITH_AS(body_of(touching, options),
                         "the centre of sphere 1 has x = 1.5 m, and the box reaches from -1 m to 1 m", Error);
    options.lengths.reset();
    CHECK_THROWS_WITH_AS(body_of(touching, options), doctest::Contains("periodic along x, and its length is not given"), Error);
}

TEST_CASE("spheres: two at one place, and one inside another, are no body") {
    CHECK_THROWS_WITH_AS(body_of({{{0, 0, 0}, {3, 0, 0}, {3, 0, 0}}, {1, 1, 1}}, {}), "sphere 1 and sphere 2 lie at one place",
                         Error);
    CHECK_THROWS_WITH_AS(body_of({{{0, 0, 0}, {0.5, 0, 0}}, {1, 0.4}}, {}), "sphere 0 and sphere 1 lie one inside the other",
                         Error);
    CHECK_THROWS_AS(body_of({}, {}), Error);
}
