// sizes_test.cpp: size distributions by volume and by number: what is drawn, and what lies below a diameter, against closed forms.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "analysis/histogram.h"
#include "core/types.h"
#include "packing/size_distribution.h"
#include "packing/size_table.h"
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
                         "the centre of sphere 1 has x = 1.5 m, counted from 0, and the box reaches from -1 m to 1 m", Error);
    options.lengths.reset();
    CHECK_THROWS_WITH_AS(body_of(touching, options), doctest::Contains("periodic along x, and its length is not given"), Error);
}

TEST_CASE("spheres: two at one place, and one inside another, are no body") {
    CHECK_THROWS_WITH_AS(body_of({{{0, 0, 0}, {3, 0, 0}, {3, 0, 0}}, {1, 1, 1}}, {}),
                         "sphere 1 and sphere 2 lie at one place, counted from 0", Error);
    CHECK_THROWS_WITH_AS(body_of({{{0, 0, 0}, {0.5, 0, 0}}, {1, 0.4}}, {}),
                         "sphere 0 and sphere 1 lie one inside the other, counted from 0", Error);
    CHECK_THROWS_AS(body_of({}, {}), Error);
}

namespace {

struct Asked {
    std::optional<Weighting> weighting = {};
    std::optional<Shares> shares = {};
    FileManner manner = {};
};

SizeDistribution sizes_of(const std::string& text, const Asked& asked = {}) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "kiln_sizes_test.csv";
    std::ofstream(file) << text;
    return read_sizes(file.string(), asked.weighting, asked.shares, asked.manner);
}

std::string size_refusal(const std::string& text, const Asked& asked = {}) {
    try {
        sizes_of(text, asked);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

SphereList spheres_of(const std::string& text, const FileManner& manner = {}) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "kiln_spheres_test.txt";
    std::ofstream(file) << text;
    return read_spheres(file.string(), manner);
}

}  // namespace

TEST_CASE("size tables: the same three classes by volume in every manner") {
    const Asked plain{.manner = {{"size", "-", "volume"}, "um"}};
    const std::pair<const char*, Asked> cases[] = {
        {"Size (um),Volume (%)\n0.1,5\n0.2,30\n0.5,65\n", {}},
        {"\xef\xbb\xbf# a remark\r\nSize (um),Volume (%)\r\n0.1,5\r\n0.2,30\r\n0.5,65\r\n", {}},
        {"Probe 7;Nr 3\n\nDurchmesser;Volumen-Vol\n\u00b5m;%\n0,10;5,0\n0,20;30,0\n0,50;65,0\n", {}},
        {"Diameter [nm]\tmass fraction\n100\t0.05\n200\t0.30\n500\t0.65\n", {}},
        {"Size (um),Volume (%)\n0.5,65\n0.2,30\n0.1,5\n", {}},
        {"Size (um),share (%)\n0.1,5\n0.2,30\n0.5,65\n", {.weighting = by_volume}},
        {"0.1 1 5\n0.2 2 30\n0.5 3 65\n", plain},
        {"Size (um),q (%),Q (%)\n0.1,5,5\n0.2,30,35\n0.5,65,100\n", {.manner = {{"size (um)", "volume (%)", "-"}, ""}}},
        {"Size (um),Number (%),Volume (%)\n0.1,90,5\n0.2,9,30\n0.5,1,65\n", {.weighting = by_volume}},
    };
    const SizeClasses expected({{1e-7, 1e-7, 5}, {2e-7, 2e-7, 30}, {5e-7, 5e-7, 65}}, by_volume);
    for (const auto& [text, asked] : cases) {
        CAPTURE(text);
        const SizeDistribution found = sizes_of(text, asked);
        CHECK(std::get<SizeClasses>(found).mean() == relative(expected.mean(), 1e-13));
        for (const double fraction : {0.04, 0.06, 0.34, 0.36})
            CHECK(size_quantile(found, fraction, by_volume) == relative(expected.quantile(fraction, by_volume), 1e-13));
    }
}

TEST_CASE("size tables: the same cumulative curve in every manner") {
    const std::pair<const char*, Asked> cases[] = {
        {"Size (um),Cum. < Volume (%)\n0.1,0\n0.2,30\n0.5,80\n1,100\n", {}},
        {"Size (um),Volume (%)\n0.1,0\n0.2,30\n0.5,80\n1,100\n", {}},
        {"Size (um),Volume\n0.1,0\n0.2,0.3\n0.5,0.8\n1,1\n", {}},
        {"Sieve (um),Oversize mass (%)\n1,0\n0.5,20\n0.2,70\n0.1,100\n", {}},
        {"Sieve (um),mass (%)\n0.1,100\n0.2,70\n0.5,20\n1,0\n", {.shares = Shares::oversize}},
        {"Channel Diameter (Lower) (um),Diff. Volume (%)\n0.1,30\n0.2,50\n0.5,20\n1,0\n", {}},
        {"Upper size (um),Volume (%)\n0.1,0\n0.2,30\n0.5,50\n1,20\n", {}},
        {"from (um),to (um),Volume (%)\n0.1,0.2,30\n0.2,0.5,50\n0.5,1,20\n", {}},
        {"Size (um),Volume (%),Cumulative Volume (%)\n0.1,0,0\n0.2,30,30\n0.5,50,80\n1,20,100\n", {.shares = Shares::undersize}},
    };
    const SizeClasses expected(classes_between(curve), by_volume);
    for (const auto& [text, asked] : cases) {
        CAPTURE(text);
        const SizeDistribution found = sizes_of(text, asked);
        for (const double fraction : {0.01, 0.3, 0.5, 0.9})
            for (const Weighting by : {by_volume, by_number})
                CHECK(size_quantile(found, fraction, by) == relative(expected.quantile(fraction, by), 1e-12));
    }
}

TEST_CASE("size tables: counts, lists with a heading, and percentiles") {
    CHECK(size_quantile(sizes_of("Size (um),Count\n1,100\n2,50\n"), 0.66, by_number) == relative(1e-6, 1e-13));
    CHECK(size_quantile(sizes_of("Size (um),Count\n1,100\n2,50\n"), 0.67, by_number) == relative(2e-6, 1e-13));
    CHECK(std::get<DiameterList>(sizes_of("Diameter (nm)\n100\n200\n")).diameters == std::vector{1e-7, 2e-7});
    CHECK(std::get<DiameterList>(sizes_of("0.35\u00b5m\r\n0.85 \u03bcm\r\n# 3\r\n")).diameters == std::vector{0.35e-6, 0.85e-6});
    CHECK(std::get<DiameterList>(sizes_of("100\n200\n", {.manner = {{"d"}, "nm"}})).diameters == std::vector{1e-7, 2e-7});
    for (const char* text : {"D10 (um),D50 (um),D90 (um)\n0.2,0.3,0.6\n",
                             "Sample;Dx (10) (\u03bcm);Dx (50) (\u03bcm);Dx (90) (\u03bcm)\nA;0,2;0,3;0,6\n",
                             "d(0.1) [nm]\td(0.5) [nm]\td(0.9) [nm]\n200\t300\t600\n"}) {
        CAPTURE(text);
        const SizeDistribution found = sizes_of(text);
        CHECK(size_quantile(found, 0.1, by_volume) == relative(0.2e-6, 1e-12));
        CHECK(size_quantile(found, 0.5, by_volume) == relative(0.3e-6, 1e-12));
        CHECK(size_quantile(found, 0.9, by_volume) == relative(0.6e-6, 1e-12));
    }
}

TEST_CASE("size tables: what is not clear is refused with what would help") {
    const std::pair<const char*, const char*> cases[] = {
        {"Size (um),share (%)\n1,50\n2,50\n", "does not say what it counts; --sizes-by number, volume or mass does"},
        {"Size,Volume (%)\n1,50\n2,50\n", "column 'Size' has no unit; --length-unit names it"},
        {"Size (um),Volume (%)\n1,50\n2,40\n", "add up to 0.9"},
        {"Size (um),Volume (%)\n1,0\n2,0\n3,100\n", "may be those of classes or a cumulative curve; --shares says which"},
        {"Size (um),Number\n1,100\n2,50\n3,0\n", "may be those of classes or a cumulative curve; --shares says which"},
        {"Size (um),Cum. Volume (%)\n1,5\n2,40\n4,100\n",
         "5 % lie below the smallest diameter; add the row where the curve begins"},
        {"Size (um),Cum. Volume (%)\n1,0\n2,40\n4,95\n", "not between 0 and all of the powder; add the row that is missing"},
        {"Size (um),Cum. Volume (%)\n1,0\n2,60\n3,40\n4,100\n", "not between 0 and all of the powder"},
        {"Size (um),Volume (%)\n1,-5\n2,105\n", ", line 2: the share '-5' is below zero"},
        {"Size (um),Volume (%)\n1,30\n3,30\n2,40\n", ", line 4: the diameter '2' is out of order"},
        {"Size (um),Volume (%)\n1,30\n1,30\n2,40\n", ", line 3: the diameter '1' is out of order"},
        {"Size (um),Volume (%)\n0,30\n1,70\n", ", line 2: the diameter '0' is not above zero"},
        {"Size (um),Volume (%),Mass (%)\n1,30,30\n2,70,70\n", "'Volume (%)', 'Mass (%)' may all hold shares"},
        {"Size (um),Mean (um),Volume (%)\n1,1,30\n2,2,70\n", "'Size (um)', 'Mean (um)' may both hold sizes"},
        {"Lower (um),Volume (%)\n1,30\n2,70\n", "the last class has no upper edge; add a row with a share of 0"},
        {"Upper (um),Volume (%)\n1,30\n2,70\n", "the first class has no lower edge; add a row with a share of 0"},
        {"D10 (um),D50 (um),D90 (um)\n0.2,0.3,0.6\n0.3,0.4,0.7\n", "has 2 rows with D10, D50 and D90"},
        {"D10 (um),D50 (um),D90 (um)\n0.2,0.6,0.3\n", "do not ascend"},
        {"time (s),force (N)\n1,2\n", "has no column of sizes; its headings are 'time (s)', 'force (N)'"},
        {"100nm\n50\n", ", line 2: '50' has no unit"},
        {"", "empty"},
    };
    for (const auto& [text, said] : cases) {
        CAPTURE(text);
        const std::string found = size_refusal(text);
        CAPTURE(found);
        CHECK(found.find(said) != std::string::npos);
    }
    CHECK(size_refusal("Size (um),Volume (%)\n1,50\n2,50\n", {.weighting = by_number}).find("say different things") !=
          std::string::npos);
    CHECK(size_refusal("100nm\n", {.weighting = by_number}).find("list of diameters") != std::string::npos);
    CHECK(size_refusal("Size (um),Volume (%)\n1,50\n2,50\n", {.manner = {{}, "nm"}}).find("--length-unit gives one more") !=
          std::string::npos);
}

TEST_CASE("sphere lists: radius or diameter, units of headings or named, blanks or tabs between the columns") {
    const std::pair<const char*, FileManner> cases[] = {
        {"#format x_y_z_r\n0.5\t0.5\t0.5\t0.5\n1.45\t0.5\t0.5\t0.5\n", {{}, "um"}},
        {"x (um) y (um) z (um) radius (um)\n0.5 0.5 0.5 0.5\n1.45 0.5 0.5 0.5\n", {}},
        {"# x [nm]   y [nm]   z [nm]   d [nm]\n  500 500 500 1000\n 1450 500 500 1000\n", {}},
        {"# time 5 min\nx (um),y (um),z (um),radius (um)\n0.5,0.5,0.5,0.5\n1.45,0.5,0.5,0.5\n", {}},
        {"0.5 0.5 0.5 1.0\n1.45 0.5 0.5 1.0\n", {{"x", "y", "z", "d"}, "um"}},
        {"id;x;y;z;Durchmesser\n-;\u00b5m;\u00b5m;\u00b5m;\u00b5m\n7;0,5;0,5;0,5;1,0\n9;1,45;0,5;0,5;1,0\n", {}},
        {"Label,Centroid_X (um),Centroid_Y (um),Centroid_Z (um),Volume (um3),Diameter "
         "(um)\n1,0.5,0.5,0.5,9,1\n2,1.45,0.5,0.5,9,1\n",
         {}},
    };
    for (const auto& [text, manner] : cases) {
        CAPTURE(text);
        const SphereList spheres = spheres_of(text, manner);
        REQUIRE(spheres.radius.size() == 2);
        CHECK(spheres.radius[1] == relative(0.5e-6, 1e-14));
        CHECK((spheres.position[1] - Vec3(1.45e-6, 0.5e-6, 0.5e-6)).norm() < 1e-20);
    }
    for (const auto& [text, said] :
         {std::pair("#format x_y_z_r\n1 2 3 4\n", "column 'x' has no unit; --length-unit names it"),
          {"x (um),y (um),radius (um)\n1,2,3\n", "has no column z"},
          {"x (um),y (um),z (um)\n1,2,3\n", "neither a radius nor a diameter"},
          {"x (um),y (um),z (um),r (um),d (um)\n1,2,3,1,2\n", "both a radius and a diameter"},
          {"x (um),y (um),z (um),r (um)\n1,2,3,1\n1,2,3,-1\n", ", line 3: the radius '-1' is not above zero"},
          {"x (um),y (um),z (um),r (um),type\n1,2,3,1,1\n9,2,3,1,2\n", "'type' has several values"},
          {"x (um),y (um),z (s),r (um)\n1,2,3,1\n", "has the unit 's'"}}) {
        CAPTURE(text);
        CHECK_THROWS_WITH_AS(spheres_of(text), doctest::Contains(said), Error);
    }
}
