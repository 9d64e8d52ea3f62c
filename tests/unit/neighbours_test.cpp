// neighbours_test.cpp: the neighbour search against a search through every pair and image.
#include "core/neighbours.h"
#include "core/parallel.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <tuple>

using namespace kiln;

namespace {

struct Sample {
    Box box;
    std::vector<Vec3> position;
    std::vector<double> reach;
};

/// Particles anywhere in the box and up to `outside` boxes beyond it; reaches spread evenly in their logarithm.
Sample random_sample(unsigned seed, int particles, const Vec3& lengths, double smallest, double largest, double outside = 0.0) {
    std::mt19937_64 bits(seed);
    auto uniform = [&bits] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
    Sample sample;
    sample.box.origin = {0.3, -0.2, 7.0};
    sample.box.lengths = lengths;
    for (int n = 0; n < particles; ++n) {
        Vec3 position;
        for (int axis = 0; axis < 3; ++axis)
            position[axis] = sample.box.origin[axis] + lengths[axis] * (uniform() * (1.0 + 2.0 * outside) - outside);
        sample.position.push_back(position);
        sample.reach.push_back(smallest * std::pow(largest / smallest, uniform()));
    }
    return sample;
}

/// Pairs by trying every pair in every image up to `images` boxes away.
std::vector<Pair> brute_force(const Sample& sample, int images) {
    std::vector<Pair> pairs;
    std::array<int, 3> most;
    for (std::size_t axis = 0; axis < 3; ++axis) most[axis] = sample.box.periodic[axis] ? images : 0;
    const auto particles = static_cast<std::int32_t>(sample.reach.size());
    for (std::int32_t i = 0; i < particles; ++i)
        for (std::int32_t j = i; j < particles; ++j)
            for (int x = -most[0]; x <= most[0]; ++x)
                for (int y = -most[1]; y <= most[1]; ++y)
                    for (int z = -most[2]; z <= most[2]; ++z) {
                        if (i == j && std::tuple(x, y, z) <= std::tuple(0, 0, 0)) continue;
                        const Pair pair{
                            i, j, {static_cast<std::int8_t>(x), static_cast<std::int8_t>(y), static_cast<std::int8_t>(z)}};
                        const double near = sample.reach[static_cast<std::size_t>(i)] + sample.reach[static_cast<std::size_t>(j)];
                        if (pair_vector(sample.box, sample.position, pair).norm() < near) pairs.push_back(pair);
                    }
    return pairs;
}

std::vector<Pair> found(const Sample& sample) { return find_pairs(sample.box, sample.position, sample.reach); }

/// Compares with brute force, which counts in the same order: i, j, image.
void check_against_brute_force(const Sample& sample, int images, std::size_t at_least) {
    const std::vector<Pair> expected = brute_force(sample, images);
    CHECK(expected.size() >= at_least);
    CHECK(found(sample) == expected);
    // Those of every third particle: all pairs of it, and no other.
    std::vector<std::int32_t> some;
    for (std::size_t row = 0; row < sample.position.size(); row += 3) some.push_back(static_cast<std::int32_t>(row));
    std::vector<Pair> of_some;
    const auto of_a_third = [](const Pair& pair) { return pair.i % 3 == 0 || pair.j % 3 == 0; };
    std::ranges::copy_if(expected, std::back_inserter(of_some), of_a_third);
    CHECK(find_pairs(sample.box, sample.position, sample.reach, some) == of_some);
}

}  // namespace

TEST_CASE("neighbours: random boxes of any aspect") {
    check_against_brute_force(random_sample(1, 400, {1.0, 1.0, 1.0}, 0.05, 0.06), 1, 200);
    check_against_brute_force(random_sample(2, 400, {4.0, 1.0, 0.5}, 0.05, 0.1), 1, 200);
    check_against_brute_force(random_sample(3, 300, {0.11, 0.3, 60.0}, 0.05, 0.05), 2, 50);
}

TEST_CASE("neighbours: size ratios 10 and 100") {
    check_against_brute_force(random_sample(4, 500, {1.0, 1.0, 1.0}, 0.02, 0.2), 1, 1000);
    check_against_brute_force(random_sample(5, 500, {1.0, 1.0, 1.0}, 0.004, 0.4), 2, 1000);
}

TEST_CASE("neighbours: boxes shorter than the reach give several images of a pair, and of a particle itself") {
    check_against_brute_force(random_sample(6, 5, {1.0, 1.0, 1.0}, 0.9, 1.7), 5, 500);
    check_against_brute_force(random_sample(7, 7, {0.2, 1.0, 3.0}, 0.3, 0.6), 8, 100);
    check_against_brute_force(random_sample(8, 1, {1.0, 1.0, 1.0}, 1.3, 1.3), 4, 20);
}

TEST_CASE("neighbours: positions outside the box") {
    check_against_brute_force(random_sample(9, 200, {1.0, 1.0, 1.0}, 0.05, 0.1, 2.0), 8, 100);
    Sample open = random_sample(10, 300, {1.0, 1.0, 1.0}, 0.05, 0.2, 1.0);
    open.box.periodic = {true, false, false};
    check_against_brute_force(open, 5, 100);
    open.box.periodic = {false, false, false};
    check_against_brute_force(open, 0, 50);
}

TEST_CASE("neighbours: a particle far away from all others along an open axis") {
    Sample sample = random_sample(11, 200, {1.0, 1.0, 1.0}, 0.05, 0.1);
    sample.box.periodic = {false, false, true};
    sample.position.front() = {1e6, -1e6, 7.5};
    check_against_brute_force(sample, 1, 50);
}

TEST_CASE("neighbours: coincident particles, particles on faces and at image distance zero") {
    Sample sample = random_sample(12, 0, {1.0, 1.0, 1.0}, 0.1, 0.1);
    const Vec3 corner = sample.box.origin;
    sample.position = {corner, corner, corner + Vec3(1.0, 0.0, 0.0), corner + Vec3(1.0, 1.0, 1.0), corner - Vec3(0.0, 1e-17, 0.0)};
    sample.reach.assign(5, 0.1);
    check_against_brute_force(sample, 2, 10);
}

TEST_CASE("neighbours: a simple cubic cell of one particle has its three positive images") {
    Sample sample = random_sample(13, 1, {1.0, 1.0, 1.0}, 0.51, 0.51);
    const std::vector<Pair> pairs = found(sample);
    REQUIRE(pairs.size() == 3);
    CHECK(pairs[0].image == Image{0, 0, 1});
    CHECK(pairs[1].image == Image{0, 1, 0});
    CHECK(pairs[2].image == Image{1, 0, 0});
    sample.reach = {0.49};
    CHECK(found(sample).empty());
}

TEST_CASE("neighbours: the same order for any number of threads") {
    const Sample sample = random_sample(14, 20000, {1.0, 1.0, 1.0}, 0.002, 0.05);
    const int before = threads();
    set_threads(1);
    const std::vector<Pair> one = found(sample);
    set_threads(3);
    const std::vector<Pair> three = found(sample);
    set_threads(before);
    CHECK(one.size() > 10000);
    CHECK(one == three);
}

TEST_CASE("neighbours: what cannot be searched is an error") {
    Sample sample = random_sample(15, 3, {1.0, 1.0, 1.0}, 0.1, 0.1);
    sample.reach[1] = 70.0;
    CHECK_THROWS_WITH_AS(found(sample), doctest::Contains("128 times shorter along axis 0"), Error);
    sample.reach[1] = 0.0;
    CHECK_THROWS_WITH_AS(found(sample), doctest::Contains("particle row 1"), Error);
    sample.reach[1] = 0.1;
    sample.position = {Vec3(0.5, 0.0, 7.2), Vec3(0.0, 0.5, 7.7), Vec3(0.5, 200.0, 7.2)};
    CHECK_THROWS_WITH_AS(found(sample), doctest::Contains("particle rows 0 and 2"), Error);
    sample.position[2][1] = std::nan("");
    CHECK_THROWS_WITH_AS(found(sample), doctest::Contains("particle row 2"), Error);
    CHECK(find_pairs(sample.box, {}, {}).empty());
}
