// fixture.cpp: placing cylinders around a bar.
#include "bending/fixture.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "analysis/slenderness.h"
#include "physics/bending.h"
#include "physics/hertz.h"
#include "physics/materials.h"

namespace kiln::bending {

namespace {

constexpr double default_span = 0.8;         // of the length
constexpr double default_deflection = 1e-3;  // of the height
constexpr double default_radius = 0.75;      // of the height, as in ASTM C1161
constexpr double steepest_cosine = 0.5;      // of a contact normal against z
constexpr double contact_depth =
    0.1;  // of the height: particles that far behind the foremost one, and two radii more, may come to touch

struct Sphere {
    std::int32_t node;
    Vec3 position;  // m
    double radius;  // m
    std::int32_t material;
};

std::vector<Sphere> spheres_of(const Specimen& specimen) {
    std::vector<Sphere> spheres;
    for (std::size_t node = 0; node < specimen.body.particle.size(); ++node) {
        const auto row = static_cast<std::size_t>(specimen.body.particle[node]);
        spheres.push_back({static_cast<std::int32_t>(node), specimen.body.network.position[node],
                           specimen.state.particles.radius[row], specimen.state.particles.material[row]});
    }
    return spheres;
}

/// One cylinder and its contacts: side +1 for a punch above, -1 for a support below.
void add_cylinder(mechanics::Tooling& tooling, const std::vector<Sphere>& spheres, const Specimen& specimen, double x,
                  double cylinder_radius, double side) {
    struct Candidate {
        const Sphere* sphere;
        double height;  // m, of the cylinder's axis above the sphere's side when they touch
        Vec3 normal;    // from the cylinder to the sphere
    };
    std::vector<Candidate> candidates;
    double foremost = -HUGE_VAL, largest = 0.0;
    for (const Sphere& sphere : spheres) {
        const double distance = cylinder_radius + sphere.radius, offset = sphere.position[0] - x;
        const double cosine = std::sqrt(std::max(0.0, 1.0 - offset * offset / (distance * distance)));
        if (cosine < steepest_cosine) continue;
        candidates.push_back(
            {&sphere, side * sphere.position[2] + distance * cosine, Vec3(offset / distance, 0.0, -side * cosine)});
        foremost = std::max(foremost, candidates.back().height);
        largest = std::max(largest, sphere.radius);
    }
    if (candidates.empty()) {
        throw Error(side > 0.0 ? "the punch touches no particle" : "a support touches no particle");
    }
    const auto cylinder = static_cast<std::int32_t>(tooling.cylinders.size());
    tooling.cylinders.push_back({x, side * foremost, cylinder_radius, side > 0.0});
    for (const auto& [sphere, height, normal] : candidates) {
        const double gap = foremost - height;
        if (gap > contact_depth * specimen.size[2] + 2.0 * largest) continue;
        const Material& material = specimen.state.materials[static_cast<std::size_t>(sphere->material)];
        const double young = physics::required(material.young_modulus, material, "young_modulus");
        const double poisson = physics::required(material.poisson_ratio, material, "poisson_ratio");
        tooling.contacts.push_back({sphere->node, cylinder, side > 0.0, gap, normal, sphere->radius,
                                    physics::contact_modulus(young, poisson), physics::contact_shear_modulus(young, poisson)});
    }
}

/// Weights w of nodes so that the sum of w u is the value at (x, y) of the function a + b x + c y + e x2 fitted to u there.
std::vector<double> fit_weights(const std::vector<Vec3>& positions, double x, double y, double scale) {
    Eigen::MatrixX4d terms(static_cast<Eigen::Index>(positions.size()), 4);
    for (std::size_t k = 0; k < positions.size(); ++k) {
        const double dx = (positions[k][0] - x) / scale, dy = (positions[k][1] - y) / scale;
        terms.row(static_cast<Eigen::Index>(k)) << 1.0, dx, dy, dx * dx;
    }
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    for (Eigen::Index k = 0; k < terms.rows(); ++k) normal += terms.row(k).transpose() * terms.row(k);
    const Eigen::VectorXd weights = terms * normal.completeOrthogonalDecomposition().solve(Eigen::Vector4d::UnitX());
    return {weights.begin(), weights.end()};
}

/// Lowest and highest x that spheres of the state reach, m.
std::pair<double, double> reach(const Specimen& specimen, std::span<const std::int32_t> rows) {
    const Particles& particles = specimen.state.particles;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const std::int32_t row : rows) {
        const auto particle = static_cast<std::size_t>(row);
        low = std::min(low, particles.position[particle][0] - particles.radius[particle]);
        high = std::max(high, particles.position[particle][0] + particles.radius[particle]);
    }
    return {low, high};
}

}  // namespace

bool reaches_supports(const Specimen& specimen, const Fixture& fixture, std::span<const std::int32_t> rows) {
    const auto [low, high] = reach(specimen, rows);
    return low <= fixture.middle - fixture.span / 2.0 && high >= fixture.middle + fixture.span / 2.0;
}

Fixture place_fixture(const Specimen& specimen, const Options& options) {
    Fixture fixture;
    const double length = specimen.size[0];
    fixture.span = options.span > 0.0 ? options.span : default_span * length;
    fixture.radius = options.punch_radius > 0.0 ? options.punch_radius : default_radius * specimen.size[2];
    fixture.middle = specimen.origin[0] + length / 2.0;
    fixture.centre_y = specimen.origin[1] + specimen.size[1] / 2.0;
    std::ostringstream words;
    if (fixture.span >= length) {
        words << "the span of " << fixture.span << " m is not shorter than the bar of " << length << " m";
        throw Error(words.str());
    }
    if (!options.allow_block) analysis::refuse_block(fixture.span, specimen.size[2], "--allow-block");
    const auto [low, high] = reach(specimen, specimen.body.particle);
    if (!reaches_supports(specimen, fixture, specimen.body.particle)) {
        const double left = fixture.middle - fixture.span / 2.0, right = fixture.middle + fixture.span / 2.0;
        const mechanics::BondedBody& body = specimen.body;
        words << (body.fragments > 0 ? "the bar is in pieces: the largest, " : "the bar does not reach its supports: it has ")
              << body.particle.size() << " of " << specimen.state.particles.size() << " particles, reaches from x = " << low
              << " to " << high << " m, and the supports are at " << left << " and " << right << " m";
        throw Error(words.str());
    }
    return fixture;
}

double max_deflection_of(const Specimen& specimen, const Options& options) {
    return options.max_deflection > 0.0 ? options.max_deflection : default_deflection * specimen.size[2];
}

double estimated_stiffness(const Specimen& specimen, const Fixture& fixture) {
    const double softness = physics::bending_modulus(1.0, fixture.span, specimen.size[1], specimen.size[2], specimen.poisson_ratio);
    return specimen.relative_density * specimen.young_modulus / softness;
}

double expected_force(const Specimen& specimen, const Fixture& fixture, const Options& options) {
    if (options.max_force > 0.0) return options.max_force;
    return estimated_stiffness(specimen, fixture) * max_deflection_of(specimen, options);
}

mechanics::Tooling find_contacts(const Specimen& specimen, const Fixture& fixture) {
    const std::vector<Sphere> spheres = spheres_of(specimen);
    mechanics::Tooling tooling;
    add_cylinder(tooling, spheres, specimen, fixture.middle - fixture.span / 2.0, fixture.radius, -1.0);
    add_cylinder(tooling, spheres, specimen, fixture.middle + fixture.span / 2.0, fixture.radius, -1.0);
    add_cylinder(tooling, spheres, specimen, fixture.middle, fixture.radius, 1.0);
    return tooling;
}

std::optional<double> held_span(const Specimen& specimen, const mechanics::Tooling& tooling, std::span<const Vec3> force) {
    std::array<double, 3> moment{}, sum{};
    for (std::size_t c = 0; c < tooling.contacts.size(); ++c) {
        const mechanics::WallContact& contact = tooling.contacts[c];
        const auto cylinder = static_cast<std::size_t>(contact.cylinder);
        moment[cylinder] += force[c][2] * specimen.body.network.position[static_cast<std::size_t>(contact.node)][0];
        sum[cylinder] += force[c][2];
    }
    if (!(sum[0] > 0.0 && sum[1] > 0.0)) return std::nullopt;
    return moment[1] / sum[1] - moment[0] / sum[0];
}

double thrust(const mechanics::Tooling& tooling, std::span<const Vec3> force) {
    std::array<double, 3> along{};
    for (std::size_t c = 0; c < tooling.contacts.size(); ++c) {
        along[static_cast<std::size_t>(tooling.contacts[c].cylinder)] += force[c][0];
    }
    return 0.5 * (along[0] - along[1]);
}

Gauge::Gauge(const Specimen& specimen, const Fixture& fixture) {
    const mechanics::BondNetwork& network = specimen.body.network;
    const double layer = 2.0 * network.rotation_length;  // mean diameter
    const double half_width = std::max(specimen.size[2] / 8.0, 2.0 * layer);
    for (const double place : {-0.5, 0.0, 0.5}) {
        const double x = fixture.middle + place * fixture.span;
        const auto near = [&](std::size_t node) { return std::abs(network.position[node][0] - x) <= half_width; };
        double lowest = HUGE_VAL;
        for (std::size_t node = 0; node < network.nodes(); ++node) {
            if (near(node)) lowest = std::min(lowest, network.position[node][2]);
        }
        std::vector<std::int32_t> nodes;
        std::vector<Vec3> positions;
        for (std::size_t node = 0; node < network.nodes(); ++node) {
            if (!near(node) || (place == 0.0 && network.position[node][2] > lowest + layer)) continue;
            nodes.push_back(static_cast<std::int32_t>(node));
            positions.push_back(network.position[node]);
        }
        const std::vector<double> weights = fit_weights(positions, x, fixture.centre_y, half_width);
        // The supports' mean counts half each, upwards; the lower face under the load counts downwards.
        const double sign = place == 0.0 ? -1.0 : 0.5;
        for (std::size_t k = 0; k < nodes.size(); ++k) weights_.push_back({nodes[k], sign * weights[k]});
    }
}

double Gauge::read(const mechanics::Vector& displacement) const {
    double sum = 0.0;
    for (const auto& [node, weight] : weights_) sum += weight * displacement[static_cast<std::size_t>(node)][2];
    return sum;
}

}  // namespace kiln::bending
