// green_test.cpp: green bodies: size distributions, overlaps, densities, and the coordination number of the paper's start.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "core/contacts.h"
#include "core/parallel.h"
#include "io/files.h"
#include "packing/packing.h"

using namespace kiln;
using namespace kiln::packing;

namespace {

State packed(const PackingOptions& options) { return pack(options); }

ContactStatistics contacts_of(const State& state) {
    return contact_statistics(state.box, state.particles, find_pairs(state.box, state.particles.position, state.particles.radius));
}

PackingOptions few(std::int64_t particles, std::uint64_t seed = 1) {
    PackingOptions options;
    options.particles = particles;
    options.seed = seed;
    return options;
}

/// Whether two numbers agree to a relative tolerance; doctest's own comparison allows an error of epsilon even for lengths of 1e-7
/// m.
bool close(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance * std::abs(b); }

/// Largest h/(r_i + r_j) of spheres, with radii multiplied by a factor.
double max_overlap(const State& state, double factor) {
    std::vector<double> radius = state.particles.radius;
    for (double& each : radius) each *= factor;
    double largest = 0.0;
    for (const Pair& pair : find_pairs(state.box, state.particles.position, radius))
        largest =
            std::max(largest, 1.0 - pair_vector(state.box, state.particles.position, pair).norm() /
                                        (radius[static_cast<std::size_t>(pair.i)] + radius[static_cast<std::size_t>(pair.j)]));
    return largest;
}

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(std::vector<double> values) {
    const double mean = mean_of(values);
    for (double& value : values) value = (value - mean) * (value - mean);
    return std::sqrt(mean_of(values));
}

std::vector<double> diameters(const std::string& text, std::size_t particles, std::uint64_t seed = 1) {
    Random random(seed);
    std::vector<double> drawn = draw_radii(parse_distribution(text, 100e-9), particles, random);
    for (double& each : drawn) each *= 2.0;
    return drawn;
}

}  // namespace

TEST_CASE("green: the random stream is the one that the C++ standard fixes") {
    // The standard states the 10000th output of mt19937_64 with its default seed 5489.
    Random random(5489);
    for (int drawn = 1; drawn < 10000; ++drawn) random.uniform();
    CHECK(random.uniform() == static_cast<double>(9981545732273789042ull >> 11) * 0x1p-53);
}

TEST_CASE("green: lognormal diameters have the median and the geometric deviation asked for") {
    std::vector<double> logarithm = diameters("lognormal:100nm:1.4", 200000);
    for (double& each : logarithm) each = std::log(each / 100e-9);
    // Standard errors of the mean, 7.5e-4, and of the deviation, 5.3e-4, of 200000 draws: four of them are allowed.
    CHECK(std::abs(mean_of(logarithm)) < 3.0e-3);
    CHECK(std::abs(deviation_of(logarithm) - std::log(1.4)) < 2.1e-3);
}

TEST_CASE("green: cut-offs of a lognormal distribution hold and symmetric ones keep the median") {
    std::vector<double> drawn = diameters("lognormal:100nm:1.4:50nm:200nm", 100001);
    const auto [smallest, largest] = std::minmax_element(drawn.begin(), drawn.end());
    CHECK(*smallest >= 50e-9);
    CHECK(*smallest < 51e-9);
    CHECK(*largest <= 200e-9);
    CHECK(*largest > 198e-9);
    std::nth_element(drawn.begin(), drawn.begin() + 50000, drawn.end());
    CHECK(close(drawn[50000], 100e-9, 0.006));
}

TEST_CASE("green: bimodal fractions are fractions of the number, exact to one particle") {
    const std::vector<double> drawn = diameters("bimodal:200nm:50nm:0.25", 1002);
    const auto drawn_as = [&](double diameter) {
        return std::count_if(drawn.begin(), drawn.end(), [&](double each) { return close(each, diameter, 1e-14); });
    };
    CHECK(drawn_as(200e-9) == 251);  // 250.5 rounded
    CHECK(drawn_as(50e-9) == 751);
}

TEST_CASE("green: a list of diameters gives each as often as it can, and sets the number of particles") {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "kiln_green_test_diameters";
    std::ofstream(file) << "100nm\n\n0.2um\n50\n";
    const std::string text = "file:" + file.string();
    CHECK_THROWS_WITH_AS(diameters(text, 3), doctest::Contains("line 4"), Error);
    std::ofstream(file) << "100nm\n\n0.2um\n";
    const std::vector<double> drawn = diameters(text, 3);
    CHECK(close(drawn[0], 100e-9, 1e-14));
    CHECK(close(drawn[1], 200e-9, 1e-14));
    CHECK((close(drawn[2], 100e-9, 1e-14) || close(drawn[2], 200e-9, 1e-14)));
    CHECK(std::get<DiameterList>(parse_distribution(text, 0.0)).diameters.size() == 2);
    std::filesystem::remove(file);
    CHECK_THROWS_WITH_AS(diameters(text, 3), doctest::Contains("cannot be opened"), Error);
}

TEST_CASE("green: relative density and box edges are exact") {
    for (const Method method : {Method::loose, Method::affine, Method::soft}) {
        PackingOptions options = few(500);
        options.method = method;
        options.aspect = {4.0, 2.0, 1.0};
        if (method == Method::affine) options.compact_to = 0.58;
        const State state = packed(options);
        CHECK(close(relative_density(state), method == Method::affine ? 0.58 : 0.43, 1e-13));
        CHECK(close(state.box.lengths[0], 4.0 * state.box.lengths[2], 1e-14));
        CHECK(close(state.box.lengths[1], 2.0 * state.box.lengths[2], 1e-14));
        CHECK(state.particles.size() == 500);
    }
}

TEST_CASE("green: loose spheres do not overlap before the swell, some touch, and none overlaps by more than the swell after it") {
    const State state = packed(few(2000));
    CHECK(max_overlap(state, 1.0 / 1.01) < 1.1e-5);
    CHECK(max_overlap(state, 1.0 / 1.0099) > 5e-5);
    CHECK(max_overlap(state, 1.0) <= 1.0 - (1.0 - 1.1e-5) / 1.01);
}

TEST_CASE("green: contacts of the paper's green body") {
    // Z = 1.72 and h/R = 0.013 at 0.43 give the paper's Table 2; the standard deviation at 6000 particles is 0.03 and 0.0002.
    for (const std::uint64_t seed : {11u, 12u, 13u}) {
        const State state = packed(few(6000, seed));
        const ContactStatistics contacts = contacts_of(state);
        CAPTURE(contacts.coordination_number);
        CAPTURE(contacts.mean_overlap_ratio);
        CHECK(close(contacts.coordination_number, 1.72, 0.06));
        CHECK(close(2.0 * contacts.mean_overlap_ratio, 0.0135, 0.06));
    }
}

TEST_CASE("green: more damping leaves more contacts") {
    PackingOptions options = few(2000);
    double before = 0.0;
    for (const double damping : {0.15, 0.3, 0.6}) {
        options.damping = damping;
        const State state = packed(options);
        const double coordination = contacts_of(state).coordination_number;
        CHECK(coordination > 1.3 * before);
        before = coordination;
    }
}

TEST_CASE("green: affine compaction scales every centre and keeps the radii") {
    PackingOptions options = few(300);
    const State loose = packed(options);
    options.method = Method::affine;
    options.compact_to = 0.6;
    const State compacted = packed(options);
    const double factor = std::cbrt(0.43 / 0.6);
    CHECK(close(compacted.box.lengths[0], factor * loose.box.lengths[0], 1e-14));
    CHECK(compacted.particles.radius == loose.particles.radius);
    for (std::size_t row = 0; row < loose.particles.size(); ++row)
        CHECK((compacted.particles.position[row] - factor * loose.particles.position[row]).norm() < 1e-13 * loose.box.lengths[0]);
}

TEST_CASE("green: only what is compacted has a density to compact to") {
    PackingOptions options = few(10);
    options.compact_to = 0.6;
    CHECK_THROWS_WITH_AS(packed(options), doctest::Contains("loose packing is not compacted"), Error);
    options.method = Method::affine;
    options.compact_to.reset();
    CHECK_THROWS_WITH_AS(packed(options), doctest::Contains("requires the density"), Error);
}

TEST_CASE("green: a soft packing ends at the wanted mean overlap") {
    PackingOptions options = few(2000);
    options.method = Method::soft;
    options.density = 0.58;
    options.mean_overlap = 0.03;
    const State state = packed(options);
    const double mean = contacts_of(state).mean_overlap_ratio;
    CHECK(mean <= 0.03);
    CHECK(mean > 0.027);
}

TEST_CASE("green: sizes apart by 10 and 100 part without overlap") {
    for (const std::string text : {"bimodal:100nm:10nm:0.05", "bimodal:1000nm:10nm:0.002"}) {
        PackingOptions options = few(1000);
        options.distribution = parse_distribution(text, 0.0);
        const State state = packed(options);
        CHECK(close(relative_density(state), 0.43, 1e-13));
        CHECK(max_overlap(state, 1.0 / 1.01) < 1.1e-5);
    }
}

TEST_CASE("green: one and few particles") {
    for (const std::int64_t particles : {1, 2, 3, 8}) {
        const State state = packed(few(particles));
        CHECK(close(relative_density(state), 0.43, 1e-13));
        CHECK(max_overlap(state, 1.0 / 1.01) < 1.1e-5);
    }
    // One sphere in a cube touches its own images above pi/6 = 0.52; just above, all its overlap comes from the swell.
    PackingOptions options = few(1);
    options.density = 0.53;
    const State state = packed(options);
    CHECK(contacts_of(state).coordination_number == 6.0);
    options.density = 0.56;
    CHECK_THROWS_WITH_AS(packed(options), doctest::Contains("jammed after 0 steps"), Error);
}

TEST_CASE("green: a density that cannot be reached says which can") {
    PackingOptions options = few(300);
    options.density = 0.72;
    CHECK_THROWS_WITH_AS(packed(options), doctest::Contains("can be reached"), Error);
    options.method = Method::soft;
    options.mean_overlap = 0.001;
    CHECK_THROWS_WITH_AS(packed(options), doctest::Contains("above the required 0.001"), Error);
}

TEST_CASE("green: the same body for any number of threads, another for another seed") {
    const int before = threads();
    set_threads(1);
    const State one = packed(few(10000));
    set_threads(2);
    const State three = packed(few(10000));
    set_threads(before);
    CHECK(one.particles.position == three.particles.position);
    CHECK(packed(few(100)).particles.position != packed(few(100, 2)).particles.position);
}

TEST_CASE("green: ids are rows, positions lie in the box, and neighbours in space are near each other in memory") {
    const State state = packed(few(4000));
    double apart = 0.0;
    for (std::size_t row = 0; row < state.particles.size(); ++row) {
        CHECK(state.particles.id[row] == static_cast<std::int64_t>(row));
        CHECK(state.box.wrap(state.particles.position[row]) == state.particles.position[row]);
        if (row > 0) apart += (state.particles.position[row] - state.particles.position[row - 1]).norm();
    }
    // Random neighbours in the list would be 0.66 edges apart.
    CHECK(apart / static_cast<double>(state.particles.size()) < 0.15 * state.box.lengths[0]);
}

TEST_CASE("green: an interrupted relaxation gives no body") {
    int steps = 0;
    CHECK_THROWS_AS(pack(few(100), [&] { return steps == 3; }, [&](const Relaxation& now) { steps = now.steps; }), Interrupted);
    CHECK(steps == 3);
}
