// conduction.cpp: the network of necks as conductors, and the temperatures at which their flows balance.
#include "mechanics/conduction.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "linalg/conjugate_gradient.h"
#include "linalg/incomplete_cholesky.h"
#include "mechanics/bond_network.h"
#include "mechanics/connectivity.h"
#include "physics/conduction.h"

namespace kiln::mechanics {

namespace {

using Mat3 = Eigen::Matrix3d;
using Field = std::vector<linalg::Quad<double>>;  // of each node, under the gradients along x, y and z

constexpr std::size_t nodes_of_a_range = 4096;  // factorised by themselves; fixed, whatever the number of threads
constexpr int max_iterations = 5000;
constexpr int max_restarts = 3;              // with the residual as it is
constexpr double min_conduction = 1e-12;   // of the largest principal value, below which nothing leads through the box

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

/// Bonds of a piece as conductors between its nodes.
struct Conductors {
    std::size_t nodes = 0;
    std::vector<std::array<std::int32_t, 2>> pair;
    std::vector<Vec3> vector;         // m
    std::vector<double> conductance;  // W/K
};

/// Sum of n n^T over the directions of the necks of each particle.
std::vector<Mat3> neck_directions(const State& state, const BondedPiece& piece) {
    std::vector<Mat3> sum(state.particles.size(), Mat3::Zero());
    for (const std::int32_t row : piece.bond) {
        const Vec3 direction = bond_vector(state, *state.bonds, at(row)).normalized();
        for (const std::int32_t particle : state.bonds->pair[at(row)]) sum[at(particle)] += direction * direction.transpose();
    }
    return sum;
}

Conductors conductors_of(const State& state, const BondedPiece& piece, double solid_fraction, const Conductor& conductor) {
    Conductors network{piece.particle.size(), {}, {}, {}};
    const Bonds& bonds = *state.bonds;
    const std::vector<Mat3> directions = neck_directions(state, piece);
    const double k = conductor.conductivity, to_solid = solid_fraction * state.box.volume() / particle_volume(state.particles);
    for (const std::int32_t row : piece.bond) {
        const auto [first, second] = bonds.pair[at(row)];
        const Vec3 vector = bond_vector(state, bonds, at(row)), n = vector.normalized();
        const double radius =
            std::min({bonds.radius[at(row)], state.particles.radius[at(first)], state.particles.radius[at(second)]});
        double resistance = conductor.boundary_resistance / (std::numbers::pi * radius * radius);
        for (const std::int32_t particle : {first, second}) {
            const double sphere = state.particles.radius[at(particle)];
            const physics::NeckSide side = physics::neck_side(k, sphere, radius, bonds.length[at(row)]);
            resistance += side.constriction + physics::bulk_resistance(k, side.length, to_solid * sphere_volume(sphere),
                                                                       0.5 * n.dot(directions[at(particle)] * n));
        }
        network.pair.push_back(piece.nodes_of(bonds, row));
        network.vector.push_back(vector);
        network.conductance.push_back(1.0 / resistance);
    }
    return network;
}

/// Three Laplace equations on the network, one for each gradient, with an incomplete factorisation as the preconditioner. Each
/// node's temperature is what it has beyond the gradient's.
class ConductionSystem {
   public:
    ConductionSystem(const Conductors& network)
        : network_(network),
          incidence_(find_incidence(network.nodes, network.pair)),
          ranges_(list_edges()),
          springs_(first_.size()),
          factor_(network.nodes, ranges_, first_, second_, springs_),
          x_(network.nodes),
          r_(network.nodes),
          z_(network.nodes),
          p_(network.nodes),
          q_(network.nodes) {
        for (std::size_t edge = 0; edge < first_.size(); ++edge) {  // the same to each of the three fields
            const double conductance = network_.conductance[bond_[edge]];
            springs_.set(edge, conductance, conductance);
        }
        for_chunks(ranges_.size(), [&](std::size_t range) { factor_.factorise(ranges_[range]); });
        double squares = 0.0;
        for (std::size_t bond = 0; bond < network.pair.size(); ++bond)
            squares += network.vector[bond].squaredNorm() * network.conductance[bond] * network.conductance[bond];
        driving_ = std::sqrt(squares);
    }

    /// Puts what is unbalanced now into the residual; its norm over that of what the gradients drive through the bonds, which is
    /// more than zero also where it is in balance from the beginning, as in a lattice.
    double residual() {
        for_rows(network_.nodes, [&](std::size_t node) {
            linalg::Quad<double> rest = linalg::Quad<double>{} - flow_from(node, x_);
            for (const std::int32_t row : incidence_.of(node)) {
                const auto [i, j] = network_.pair[at(row)];
                if (i == j) continue;
                const double sign = at(i) == node ? 1.0 : -1.0;
                rest += linalg::quad<double>(Vec3(sign * network_.conductance[at(row)] * network_.vector[at(row)]));
            }
            r_[node] = rest;
        });
        double left = 0.0;
        for (const auto& each : r_) left += linalg::vector(each).squaredNorm();
        size_ = std::sqrt(left);
        return iterated_residual();
    }

    /// The same, as the iteration knows it.
    double iterated_residual() const { return size_ / driving_; }

    double advance(double step) {
        struct Sum {
            double product = 0.0, squares = 0.0;
            void operator+=(const Sum& other) {
                product += other.product;
                squares += other.squares;
            }
        };
        const Sum sum = sum_chunks(ranges_.size(), Sum(), [&](std::size_t index) {
            const linalg::NodeRange& range = ranges_[index];
            for (std::size_t node = range.first_node; node < range.last_node; ++node) {
                x_[node] += step * p_[node];
                r_[node] -= step * q_[node];
            }
            factor_.apply(range, r_.data(), z_.data());
            linalg::WideQuad product, squares;
            for (std::size_t node = range.first_node; node < range.last_node; ++node) {
                linalg::add_product(r_[node], z_[node], product);
                linalg::add_product(r_[node], r_[node], squares);
            }
            return Sum{product.sum(), squares.sum()};
        });
        size_ = std::sqrt(sum.squares);
        return sum.product;
    }

    double turn(double ratio) {
        for_rows(network_.nodes, [&](std::size_t node) { p_[node] = z_[node] + ratio * p_[node]; });
        return sum_chunks(ranges_.size(), 0.0, [&](std::size_t index) {
            linalg::WideQuad product;
            for (std::size_t node = ranges_[index].first_node; node < ranges_[index].last_node; ++node) {
                q_[node] = flow_from(node, p_);
                linalg::add_product(p_[node], q_[node], product);
            }
            return product.sum();
        });
    }

    /// Sum over the bonds of conductance times the difference of temperature, along the bond: W m per unit gradient.
    Mat3 flow() const {
        Mat3 sum = Mat3::Zero();
        for (std::size_t bond = 0; bond < network_.pair.size(); ++bond) {
            const auto [i, j] = network_.pair[bond];
            const Vec3 difference = network_.vector[bond] + linalg::vector(x_[at(j)]) - linalg::vector(x_[at(i)]);
            sum += network_.conductance[bond] * network_.vector[bond] * difference.transpose();
        }
        return 0.5 * (sum + sum.transpose());
    }

   private:
    linalg::Quad<double> flow_from(std::size_t node, const Field& field) const {
        linalg::Quad<double> sum;
        for (const std::int32_t row : incidence_.of(node)) {
            const auto [i, j] = network_.pair[at(row)];
            const std::size_t other = at(i) == node ? at(j) : at(i);
            sum += network_.conductance[at(row)] * (field[node] - field[other]);
        }
        return sum;
    }

    /// Edges of each range: those inside it by their first node, then those that leave it.
    std::vector<linalg::NodeRange> list_edges() {
        std::vector<linalg::NodeRange> ranges;
        std::vector<std::size_t> leaving;
        for (std::size_t begin = 0; begin < network_.nodes; begin += nodes_of_a_range) {
            linalg::NodeRange range{begin, std::min(network_.nodes, begin + nodes_of_a_range), first_.size(), 0, 0};
            leaving.clear();
            for (std::size_t node = range.first_node; node < range.last_node; ++node)
                for (const std::int32_t row : incidence_.of(node)) {
                    const auto [i, j] = network_.pair[at(row)];
                    if (i == j) continue;
                    const std::size_t other = at(i) == node ? at(j) : at(i);
                    if (other < range.first_node || other >= range.last_node)
                        leaving.push_back(at(row));
                    else if (node < other)
                        add_edge(node, other, at(row));
                }
            range.inside = first_.size();
            for (const std::size_t row : leaving) add_edge(at(network_.pair[row][0]), at(network_.pair[row][1]), row);
            range.end = first_.size();
            ranges.push_back(range);
        }
        return ranges;
    }

    void add_edge(std::size_t first, std::size_t second, std::size_t bond) {
        first_.push_back(static_cast<std::int32_t>(first));
        second_.push_back(static_cast<std::int32_t>(second));
        bond_.push_back(bond);
    }

    const Conductors& network_;
    Grouping<std::int32_t> incidence_;
    std::vector<std::int32_t> first_, second_;
    std::vector<std::size_t> bond_;
    std::vector<linalg::NodeRange> ranges_;
    linalg::EdgeStiffness<double> springs_;
    linalg::IncompleteCholesky<double> factor_;
    Field x_, r_, z_, p_, q_;
    double size_ = 0.0, driving_ = 0.0;
};

void solve(ConductionSystem& system, double tolerance, const StopRequest& stop, Conductivity& result) {
    result.residual = system.residual();
    for (int pass = 0; pass <= max_restarts && result.residual > tolerance && result.iterations < max_iterations; ++pass) {
        result.iterations += linalg::conjugate_gradient(system, [&](const linalg::CgProgress& progress) {
                                 throw_if_stopped(stop);
                                 return system.iterated_residual() <= tolerance ||
                                        result.iterations + progress.iterations >= max_iterations;
                             }).iterations;
        result.residual = system.residual();
    }
    result.converged = result.residual <= tolerance;
}

/// True where flow leads through the box along all directions.
bool leads_through(const Mat3& network) {
    const Vec3 principal = network.selfadjointView<Eigen::Lower>().eigenvalues();
    return principal.minCoeff() > min_conduction * principal.maxCoeff();
}

}  // namespace

Conductivity conductivity(const State& state, double solid_fraction, const Conductor& conductor, double tolerance,
                          const StopRequest& stop) {
    const auto& periodic = state.box.periodic;
    if (!std::ranges::all_of(periodic, [](bool axis) { return axis; }))
        throw Error("the box is not periodic along all axes, so the state has no conductivity of its own");
    const BondedPiece piece = largest_piece(state);
    const Conductors network = conductors_of(state, piece, solid_fraction, conductor);
    Conductivity result;
    result.fragments = piece.fragments;
    result.rattlers = piece.rattlers;
    result.negligible_bonds = piece.negligible_bonds;
    result.coordination_number = 2.0 * static_cast<double>(piece.bond.size()) / static_cast<double>(piece.particle.size());
    ConductionSystem system(network);
    solve(system, tolerance, stop, result);
    result.tensor = system.flow() / state.box.volume();
    if (!leads_through(result.tensor)) throw Error("the bonded particles do not reach through the box along all axes");
    result.bound = conductor.conductivity * physics::conductivity_bound(solid_fraction);
    const double mean = result.tensor.trace() / 3.0;
    result.at_bound = mean > result.bound;
    if (result.at_bound) result.tensor *= result.bound / mean;
    return result;
}

}  // namespace kiln::mechanics
