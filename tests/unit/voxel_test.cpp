// voxel_test.cpp: transforms, images, connected components, rasters and extrapolations against what is known in closed form.
#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <random>

#include "core/parallel.h"
#include "linalg/fourier_inverse.h"
#include "linalg/line_transform.h"
#include "tests/physics/relative.h"
#include "voxel/extrapolation.h"
#include "voxel/geometry.h"
#include "voxel/grid_stiffness.h"

using namespace kiln;
using namespace kiln::voxel;
using test::relative;

namespace {

using Complex = std::complex<double>;

std::vector<Complex> random_numbers(std::size_t count) {
    std::mt19937 generator(7);
    std::uniform_real_distribution<float> values(-1.0f, 1.0f);
    std::vector<Complex> numbers;
    for (std::size_t i = 0; i < count; ++i) {
        const float real = values(generator), imaginary = values(generator);
        numbers.emplace_back(real, imaginary);
    }
    return numbers;
}

std::vector<Complex> numbers_of(linalg::Lines& lines, std::size_t length) {
    std::vector<Complex> numbers;
    for (std::size_t i = 0; i < length * linalg::Lines::lanes; ++i) numbers.emplace_back(lines.real()[i], lines.imaginary()[i]);
    return numbers;
}

/// Norm of the difference over the norm of what is expected.
double deviation(const std::vector<Complex>& found, const std::vector<Complex>& expected) {
    double difference = 0.0, size = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        difference += std::norm(found[i] - expected[i]);
        size += std::norm(expected[i]);
    }
    return std::sqrt(difference / size);
}

std::vector<Complex> transform_by_sum(const std::vector<Complex>& numbers, std::size_t length) {
    std::vector<Complex> sums(numbers.size());
    for (std::size_t k = 0; k < length; ++k)
        for (std::size_t n = 0; n < length; ++n)
            for (std::size_t line = 0; line < linalg::Lines::lanes; ++line)
                sums[linalg::Lines::lanes * k + line] +=
                    numbers[linalg::Lines::lanes * n + line] *
                    std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(n * k % length) / static_cast<double>(length));
    return sums;
}

voxel::Image image_of(const std::array<std::size_t, 3>& count,
                      const std::function<bool(std::size_t, std::size_t, std::size_t)>& solid) {
    voxel::Image image;
    image.count = count;
    for (std::size_t z = 0; z < count[2]; ++z)
        for (std::size_t y = 0; y < count[1]; ++y)
            for (std::size_t x = 0; x < count[0]; ++x) image.phase.push_back(solid(x, y, z) ? 1 : 0);
    return image;
}

/// One sphere in a periodic box.
State one_sphere(const Vec3& lengths, const Vec3& centre, double radius) {
    State state;
    state.box.lengths = lengths;
    state.particles.position.push_back(centre);
    state.particles.radius.push_back(radius);
    state.particles.material.push_back(0);
    state.particles.id.push_back(1);
    return state;
}

const std::vector<std::uint8_t> one_phase{1};

/// Number of threads while this lives.
struct Threads {
    explicit Threads(int count) : before(threads()) { set_threads(count); }
    ~Threads() { set_threads(before); }
    int before;
};

}  // namespace

TEST_CASE("line transform: the sum itself for every radix, and back") {
    for (const std::size_t length : {1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 15, 30, 49, 97, 100}) {
        CAPTURE(length);
        const std::vector<Complex> numbers = random_numbers(length * linalg::Lines::lanes);
        linalg::Lines lines(length);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            lines.real()[i] = static_cast<float>(numbers[i].real());
            lines.imaginary()[i] = static_cast<float>(numbers[i].imag());
        }
        const linalg::LineTransform transform(length);
        transform.forward(lines);
        CHECK(deviation(numbers_of(lines, length), transform_by_sum(numbers, length)) < 1e-6);
        transform.backward(lines);
        std::vector<Complex> back = numbers_of(lines, length);
        for (Complex& number : back) number /= static_cast<double>(length);
        CHECK(deviation(back, numbers) < 1e-6);
    }
    CHECK(linalg::quick_length(97) == 100);
    CHECK(linalg::quick_length(1) == 1);
    CHECK(linalg::quick_length(150) == 150);
}

TEST_CASE("fourier inverse: the inverse of the stiffness of a grid that one medium fills, but for the mean") {
    for (const std::array<std::size_t, 3>& count : {std::array<std::size_t, 3>{6, 5, 8}, {9, 4, 7}, {17, 1, 2}}) {
        CAPTURE(count[0]);
        const PeriodicGrid grid(count, Vec3(1.1, 0.9, 1.0));
        const std::vector<std::uint8_t> phase(grid.nodes(), 1);
        const std::vector<Solid> media{{0.6, 0.4}};
        const GridStiffness<Solid> stiffness(grid, phase, media);
        linalg::FourierInverse<Solid> inverse(grid, media.front());
        GridField field(grid, 3, count[2]), forces(field), back(field);
        std::mt19937 generator(3);
        std::uniform_real_distribution<float> values(-1.0f, 1.0f);
        double largest = 0.0, norm = 0.0;
        for (std::size_t component = 0; component < 3; ++component) {
            double mean = 0.0;
            const auto for_nodes = [&](const auto& work) {
                for (std::size_t z = 0; z < count[2]; ++z)
                    for (std::size_t y = 0; y < count[1]; ++y)
                        for (std::size_t x = 0; x < count[0]; ++x) work(z * grid.plane + y * grid.row + x);
            };
            float* u = field.component(component);
            for_nodes([&](std::size_t node) { mean += static_cast<double>(u[node] = values(generator)); });
            mean /= static_cast<double>(grid.nodes());
            for_nodes([&](std::size_t node) { u[node] -= static_cast<float>(mean); });
        }
        const double energy = stiffness.apply(field, forces);
        CHECK(inverse.solve(forces) == relative(energy, 1e-4));
        inverse.add_to(back, 0.0f);
        for (std::size_t i = 0; i < field.size(); ++i) {
            largest = std::max(largest, static_cast<double>(std::abs(back.data()[i] - field.data()[i])));
            norm = std::max(norm, static_cast<double>(std::abs(field.data()[i])));
        }
        CHECK(largest < 2e-5 * norm);
    }
}

TEST_CASE("image: what reaches round the box, and what is loose") {
    voxel::Image pillar = image_of({6, 5, 4}, [](std::size_t x, std::size_t y, std::size_t z) {
        return (x == 1 && y == 2) || (x == 4 && y == 0 && z == 1);  // along z, and a voxel apart
    });
    const Percolation found = remove_loose(pillar);
    CHECK(found.along == std::array<bool, 3>{false, false, true});
    CHECK(found.loose == 1);
    CHECK(pillar.solid_fraction() == relative(4.0 / 120.0, 1e-12));

    // A stair that comes back to itself one box on along x and y together; voxels that share only an edge are not connected.
    voxel::Image stair = image_of({4, 4, 1}, [](std::size_t x, std::size_t y, std::size_t) { return x == y || (x + 1) % 4 == y; });
    CHECK(remove_loose(stair).along == std::array<bool, 3>{true, true, true});
    voxel::Image diagonal = image_of({4, 4, 3}, [](std::size_t x, std::size_t y, std::size_t z) { return x == y && z == 0; });
    CHECK(remove_loose(diagonal).loose == 4);
    CHECK(diagonal.solid_fraction() == 0.0);

    voxel::Image ring = image_of({5, 5, 5}, [](std::size_t x, std::size_t y, std::size_t z) {
        return z == 2 && ((x == 1 || x == 3) ? y >= 1 && y <= 3 : (x == 2 && (y == 1 || y == 3)));
    });
    CHECK(remove_loose(ring).loose == 8);  // closed, but not round the box
}

TEST_CASE("raster: volumes of a sphere and of a bond, across faces of the box, with unequal edges") {
    for (const Vec3& centre : {Vec3(1.0, 1.1, 1.2), Vec3(0.1, -0.2, 3.9), Vec3(-5.0, 7.3, 2.0)}) {
        const State state = one_sphere(Vec3(4.0, 3.0, 5.0), centre, 1.0);
        const Raster raster = rasterise(state, {64, 48, 75}, one_phase);
        CHECK(raster.union_fraction == relative(sphere_volume(1.0) / 60.0, 3e-3));
        CHECK(raster.image.edges[2] == relative(5.0 / 75.0, 1e-12));
    }
    // A sphere and a bond to its own image along a diagonal: the cylinder between the spheres has a length of Eq. 4.
    State chain = one_sphere(Vec3(3.0, 4.0, 20.0), Vec3(0.5, 0.6, 0.7), 1.0);
    const double radius = 0.6, distance = 5.0, side = std::sqrt(1.0 - radius * radius), height = 1.0 - side;
    chain.bonds = Bonds{{{0, 0}}, {kiln::Image{1, 1, 0}}, {radius}, {distance - 2.0 * side}, {0.0}, {}};
    const double cap = std::numbers::pi * height * height * (3.0 - height) / 3.0;
    const double volume = sphere_volume(1.0) + std::numbers::pi * radius * radius * (distance - 2.0 * side) - 2.0 * cap;
    CHECK(rasterise(chain, {60, 80, 400}, one_phase).union_fraction == relative(volume / 240.0, 3e-3));
}

TEST_CASE("raster: a gap thinner than a voxel stays open, a neck through it is solid") {
    // Two spheres side by side in a long box, 0.01 apart: on a grid of 0.1 their voxels would touch.
    State pair = one_sphere(Vec3(10.0, 4.0, 4.0), Vec3(3.0, 2.03, 2.02), 1.0);
    pair.particles.position.push_back(Vec3(5.01, 2.03, 2.02));
    pair.particles.radius.push_back(1.0);
    const std::vector<std::uint8_t> phases{1, 1};
    const auto open_layers = [&](const State& state) {  // between the spheres
        const voxel::Image image = rasterise(state, {100, 40, 40}, phases).image;
        std::size_t open_planes = 0;
        for (std::size_t x = 35; x < 45; ++x) {
            bool open = true;
            for (std::size_t row = 0; row < 1600; ++row) open = open && image.phase[100 * row + x] == 0;
            open_planes += open;
        }
        return open_planes;
    };
    CHECK(open_layers(pair) == 1);
    CHECK(rasterise(pair, {100, 40, 40}, phases).union_fraction == relative(2.0 * sphere_volume(1.0) / 160.0, 0.01));
    pair.bonds = Bonds{{{1, 0}}, {kiln::Image{}}, {0.3}, {0.1}, {0.0}, {}};
    CHECK(open_layers(pair) == 0);
    const voxel::Image image = rasterise(pair, {100, 40, 40}, phases).image;
    std::size_t neck = 0;
    for (std::size_t row = 0; row < 1600; ++row) neck += image.phase[100 * row + 40] != 0;
    CHECK(static_cast<double>(neck) * 0.01 == relative(std::numbers::pi * 0.09, 0.1));
}

TEST_CASE("raster: the material of a voxel is that of the nearer sphere") {
    State pair = one_sphere(Vec3(6.0, 3.0, 3.0), Vec3(2.0, 1.5, 1.5), 1.0);
    pair.particles.position.push_back(Vec3(3.6, 1.5, 1.5));
    pair.particles.radius.push_back(1.0);
    pair.bonds = Bonds{{{0, 1}}, {kiln::Image{}}, {0.9}, {0.1}, {0.0}, {}};
    const voxel::Image image = rasterise(pair, {60, 30, 30}, std::vector<std::uint8_t>{2, 1}).image;
    for (std::size_t voxel = 0; voxel < image.phase.size(); ++voxel) {
        const std::size_t x = voxel % 60;
        if (image.phase[voxel] != 0) CHECK_EQ(image.phase[voxel], x < 28 ? 2 : 1);
    }
    CHECK(image.phase[60 * (15 + 30 * 15) + 27] == 2);
    CHECK(image.phase[60 * (15 + 30 * 15) + 28] == 1);
}

TEST_CASE("raster: free faces are refused, counts suit the box, the same image for any number of threads") {
    State state = one_sphere(Vec3(4.0, 3.0, 5.0), Vec3(0.0, 0.0, 0.0), 1.0);
    const std::array<std::size_t, 3> counts = grid_counts(state.box, 1.0, 12.0);
    CHECK(counts == std::array<std::size_t, 3>{48, 36, 60});
    CHECK(grid_counts(state.box, 1.0, 0.01) == std::array<std::size_t, 3>{1, 1, 1});
    CHECK_THROWS_WITH_AS(grid_counts(state.box, 1.0, 1e9), doctest::Contains("more than a million"), Error);
    std::vector<std::uint8_t> one, four;
    { const Threads threads(1); one = rasterise(state, counts, one_phase).image.phase; }
    { const Threads threads(4); four = rasterise(state, counts, one_phase).image.phase; }
    CHECK(one == four);
    state.box.periodic[1] = false;
    CHECK_THROWS_WITH_AS(rasterise(state, counts, one_phase), doctest::Contains("not periodic along all axes"), Error);
}

TEST_CASE("extrapolation: exact for errors of its order, and an error that covers those of the other") {
    const std::vector<double> edges{1.0 / 6.0, 1.0 / 9.0, 1.0 / 12.0};
    std::vector<double> first, second;
    for (const double edge : edges) {
        first.push_back(50.0 + 30.0 * edge);
        second.push_back(50.0 + 200.0 * edge * edge);
    }
    CHECK(extrapolate(edges, first, Order::first).value == relative(50.0, 1e-12));
    CHECK(extrapolate(edges, second, Order::second).value == relative(50.0, 1e-12));
    for (const std::vector<double>& values : {first, second})
        for (const Order order : {Order::first, Order::second}) {
            const Extrapolated found = extrapolate(edges, values, order);
            CHECK(std::abs(found.value - 50.0) <= found.error);
            CHECK(found.error < 7.0);
        }
    CHECK(extrapolation_weights(std::vector<double>{0.1}, Order::second) == std::vector<double>{1.0});
}
