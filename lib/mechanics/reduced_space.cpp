// reduced_space.cpp: fields, their stiffness, and what is new in a response.
#include "mechanics/reduced_space.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <utility>

namespace kiln::mechanics {

namespace {

constexpr double response_tolerance = 0.1;  // of one linear solve; the next one takes up what it leaves
constexpr double min_novelty = 1e-10;       // of a response's energy: what the space does not have already
constexpr std::size_t nodes_in_chunk = 256;

template <class Index>
std::size_t at(Index index) { return static_cast<std::size_t>(index); }

std::size_t chunks_of(std::size_t nodes) { return (nodes + nodes_in_chunk - 1) / nodes_in_chunk; }

/// Of a response, among the freedoms.
Eigen::Index place_of(std::size_t rigid_motions, std::size_t response) {
    return static_cast<Eigen::Index>(rigid_motions + response) + 1;
}

}  // namespace

ReducedSpace::ReducedSpace(const BondNetwork& network) : network_(network), stiffness_(Eigen::MatrixXd::Zero(1, 1)) {
    Vec3 low = network.position.front(), high = low;
    for (const Vec3& position : network.position) {
        low = low.cwiseMin(position);
        high = high.cwiseMax(position);
    }
    middle_ = (low + high) / 2.0;
    size_ = (high - low).norm();
}

Vec6 ReducedSpace::displacement(const RigidMotion& motion, std::size_t node) const {
    Vec6 displacement;
    displacement << motion.shift + motion.turn.cross(network_.position[node] - middle_), network_.rotation_length * motion.turn;
    return displacement;
}

Vec6 ReducedSpace::displacement(std::size_t field, std::size_t node) const {
    return field < rigid_.size() ? displacement(rigid_[field], node) : responses_[field - rigid_.size()][node];
}

Eigen::VectorXd ReducedSpace::amplitudes_of_responses(const Eigen::VectorXd& freedoms) const {
    return freedoms.tail(static_cast<Eigen::Index>(responses_.size()));
}

/// What a force on the nodes does on each response, N.
Eigen::VectorXd ReducedSpace::work(const Vector& force) const {
    const auto count = static_cast<Eigen::Index>(responses_.size());
    return sum_chunks(chunks_of(force.size()), Eigen::VectorXd(Eigen::VectorXd::Zero(count)), [&](std::size_t chunk) {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(count);
        const std::size_t first = chunk * nodes_in_chunk, last = std::min(force.size(), first + nodes_in_chunk);
        std::array<Vec6, nodes_in_chunk> field;
        for (Eigen::Index k = 0; k < count; ++k) {
            responses_[static_cast<std::size_t>(k)].read(first, last, field.data());
            for (std::size_t node = first; node < last; ++node) sum[k] += field[node - first].dot(force[node]);
        }
        return sum;
    });
}

/// Adds the responses times their amplitudes and a factor.
void ReducedSpace::add_scaled(double factor, const Eigen::VectorXd& amplitudes, Vector& displacement) const {
    for_chunks(chunks_of(displacement.size()), [&](std::size_t chunk) {
        const std::size_t first = chunk * nodes_in_chunk, last = std::min(displacement.size(), first + nodes_in_chunk);
        std::array<Vec6, nodes_in_chunk> field;
        for (std::size_t k = 0; k < responses_.size(); ++k) {
            const double amplitude = factor * amplitudes[static_cast<Eigen::Index>(k)];
            responses_[k].read(first, last, field.data());
            for (std::size_t node = first; node < last; ++node) displacement[node] += amplitude * field[node - first];
        }
    });
}

Vector ReducedSpace::sum_of_responses(const Eigen::VectorXd& freedoms) const {
    Vector sum(network_.nodes(), Vec6::Zero());
    add_scaled(1.0, amplitudes_of_responses(freedoms), sum);
    return sum;
}

Vector ReducedSpace::displacement(const Eigen::VectorXd& freedoms) const {
    Vector sum = sum_of_responses(freedoms);
    for_rows(
        sum.size(),
        [&](std::size_t node) {
            for (std::size_t k = 0; k < rigid_.size(); ++k)
                sum[node] += freedoms[static_cast<Eigen::Index>(k) + 1] * displacement(rigid_[k], node);
        },
        worth_threads);
    return sum;
}

Vector ReducedSpace::force(const ElasticSolver& solver, const Eigen::VectorXd& freedoms) const {
    Vector force;
    solver.forces(sum_of_responses(freedoms), force);
    return force;
}

void ReducedSpace::add_freedom() {
    const Eigen::Index size = stiffness_.cols();
    stiffness_.conservativeResize(size + 1, size + 1);
    stiffness_.row(size).setZero();
    stiffness_.col(size).setZero();
}

void ReducedSpace::add_rigid_motion(const Vec3& shift, const Vec3& turn) {
    rigid_.push_back({shift, turn / size_});
    add_freedom();
}

ReducedSpace::Response ReducedSpace::response(ElasticSolver& solver, const Vector& load, int max_iterations) const {
    Response response;
    response.iterations = solver.respond(load, response.displacement, response.force, response_tolerance, max_iterations);
    remove_rigid_motions(response.displacement);
    return response;
}

/// Takes from a displacement what rigid motions have of it, by least squares.
void ReducedSpace::remove_rigid_motions(Vector& displacement) const {
    constexpr int most = 6;
    using Sums = Eigen::Matrix<double, most, most + 1>;  // products with each other, and with the displacement
    const auto count = static_cast<Eigen::Index>(rigid_.size());
    Sums zero = Sums::Zero();
    const Sums sums = sum_chunks(chunks_of(displacement.size()), zero, [&](std::size_t chunk) {
        Sums sum = zero;
        Eigen::Matrix<double, 6, most> motions = Eigen::Matrix<double, 6, most>::Zero();
        const std::size_t last = std::min(displacement.size(), (chunk + 1) * nodes_in_chunk);
        for (std::size_t node = chunk * nodes_in_chunk; node < last; ++node) {
            for (Eigen::Index k = 0; k < count; ++k) motions.col(k) = this->displacement(rigid_[at(k)], node);
            sum.leftCols<most>() += motions.transpose() * motions;
            sum.rightCols<1>() += motions.transpose() * displacement[node];
        }
        return sum;
    });
    const Eigen::VectorXd work = sums.rightCols<1>().head(count);
    const Eigen::VectorXd amplitude = sums.topLeftCorner(count, count).ldlt().solve(work);
    for_rows(
        displacement.size(),
        [&](std::size_t node) {
            for (Eigen::Index k = 0; k < count; ++k) displacement[node] -= amplitude[k] * this->displacement(rigid_[at(k)], node);
        },
        worth_threads);
}

bool ReducedSpace::add(const Response& response, double unit, const ElasticSolver* exact) {
    return unit > 0.0 && add_response(response, unit, exact, min_novelty);
}

/// least: part of its energy that has to be new.
bool ReducedSpace::add_response(const Response& response, double unit, const ElasticSolver* exact, double least) {
    const Vector& displacement = response.displacement;
    CompactField field(displacement.size());
    for_rows(displacement.size(), [&](std::size_t node) { field.set(node, displacement[node] / unit); }, worth_threads);
    double energy = 0.0;
    Eigen::VectorXd shared;
    if (exact) {
        Vector kept(displacement.size()), force;
        for_rows(kept.size(), [&](std::size_t node) { kept[node] = field[node]; }, worth_threads);
        exact->forces(kept, force);
        energy = linalg::dot(kept, force);
        shared = work(force);
    } else {
        energy = linalg::dot(displacement, response.force) / unit / unit;
        shared = work(response.force) / unit;
    }
    const auto responses = static_cast<Eigen::Index>(responses_.size());
    const auto there = stiffness_.bottomRightCorner(responses, responses);
    const double novelty = responses > 0 ? energy - shared.dot(there.ldlt().solve(shared)) : energy;
    if (!(novelty > least * energy)) return false;
    add_freedom();
    stiffness_.col(stiffness_.cols() - 1).segment(stiffness_.rows() - 1 - responses, responses) = shared;
    stiffness_.row(stiffness_.rows() - 1).segment(stiffness_.rows() - 1 - responses, responses) = shared.transpose();
    stiffness_(stiffness_.rows() - 1, stiffness_.cols() - 1) = energy;
    responses_.push_back(std::move(field));
    return true;
}

void ReducedSpace::remove_last() {
    responses_.pop_back();
    stiffness_.conservativeResize(stiffness_.rows() - 1, stiffness_.cols() - 1);
}

void ReducedSpace::replace_responses(const ElasticSolver& solver, const Vector& sum, double unit) {
    while (!responses_.empty()) remove_last();
    add_response({sum, {}, 0}, unit, &solver, -1.0);
}

void ReducedSpace::soften(std::size_t bond, double share) {
    const std::size_t i = at(network_.pair[bond][0]), j = at(network_.pair[bond][1]);
    const BondBlocks blocks = bond_blocks(network_, bond);
    const double lost = 1.0 - share;
    std::vector<Vec6> on_i, on_j;  // what the lost part of the bond held in each response
    for (const CompactField& field : responses_) {
        const Vec6 first = field[i], second = field[j];
        on_i.emplace_back(lost * (blocks.ii * first + blocks.ij * second));
        on_j.emplace_back(lost * (blocks.ij.transpose() * first + blocks.jj * second));
    }
    for (std::size_t a = 0; a < on_i.size(); ++a) {
        const Vec6 first = responses_[a][i], second = responses_[a][j];
        for (std::size_t b = 0; b < on_i.size(); ++b)
            stiffness_(place_of(rigid_.size(), a), place_of(rigid_.size(), b)) -= first.dot(on_i[b]) + second.dot(on_j[b]);
    }
}

}  // namespace kiln::mechanics
