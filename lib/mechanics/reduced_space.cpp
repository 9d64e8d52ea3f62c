// reduced_space.cpp: fields, their stiffness, and what is new in a response.
#include "mechanics/reduced_space.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <utility>

#include "linalg/wide_registers.h"

namespace kiln::mechanics {

namespace {

constexpr double response_tolerance = 0.1;  // of one linear solve; the next one takes up what it leaves
constexpr double min_novelty = 1e-10;       // of a response's energy: what the space does not have already
constexpr std::size_t nodes_in_chunk = 256;

template <class Index>
std::size_t at(Index index) { return static_cast<std::size_t>(index); }

std::size_t chunks_of(std::size_t nodes) { return (nodes + nodes_in_chunk - 1) / nodes_in_chunk; }

// By single numbers, whose order the compiler keeps whatever registers it has.

double product_of(std::size_t nodes, const Vec6* a, const Vec6* b) {
    const double *x = a->data(), *y = b->data();
    std::array<double, 6> sums{};
    for (std::size_t k = 0; k < 6 * nodes; k += 6)
        for (std::size_t freedom = 0; freedom < 6; ++freedom) sums[freedom] += x[k + freedom] * y[k + freedom];
    return sums[0] + sums[1] + sums[2] + sums[3] + sums[4] + sums[5];
}

void add_scaled(double factor, std::size_t nodes, const Vec6* from, Vec6* to) {
    const double* x = from->data();
    double* y = to->data();
    for (std::size_t k = 0; k < 6 * nodes; ++k) y[k] += factor * x[k];
}

/// Of a response, among the freedoms.
Eigen::Index place_of(std::size_t rigid_motions, std::size_t response) {
    return static_cast<Eigen::Index>(rigid_motions + response) + 1;
}

}  // namespace

std::vector<Eigen::Index> freedoms_without(std::size_t fields, std::size_t first, std::size_t last) {
    std::vector<Eigen::Index> others;
    for (std::size_t freedom = 0; freedom <= fields; ++freedom)
        if (freedom <= first || freedom > last) others.push_back(static_cast<Eigen::Index>(freedom));
    return others;
}

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

/// What a force on the nodes does on each response, N.
Eigen::VectorXd ReducedSpace::work(const Vector& force) const {
    const auto count = static_cast<Eigen::Index>(responses_.size());
    return sum_chunks(chunks_of(force.size()), Eigen::VectorXd(Eigen::VectorXd::Zero(count)), [&](std::size_t chunk) {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(count);
        const std::size_t first = chunk * nodes_in_chunk, last = std::min(force.size(), first + nodes_in_chunk);
        std::array<Vec6, nodes_in_chunk> field;
        linalg::in_widest_registers([&] {
            for (Eigen::Index k = 0; k < count; ++k) {
                responses_[static_cast<std::size_t>(k)].read(first, last, field.data());
                sum[k] = product_of(last - first, field.data(), &force[first]);
            }
        });
        return sum;
    });
}

Vector ReducedSpace::sum(const Eigen::VectorXd& freedoms, std::size_t first, std::size_t last) const {
    Vector sum(network_.nodes(), Vec6::Zero());
    for_chunks(chunks_of(sum.size()), [&](std::size_t chunk) {
        const std::size_t begin = chunk * nodes_in_chunk, end = std::min(sum.size(), begin + nodes_in_chunk);
        std::array<Vec6, nodes_in_chunk> field;
        linalg::in_widest_registers([&] {
            for (std::size_t k = first; k < last; ++k) {
                responses_[k - rigid_.size()].read(begin, end, field.data());
                add_scaled(freedoms[static_cast<Eigen::Index>(k) + 1], end - begin, field.data(), &sum[begin]);
            }
        });
    });
    return sum;
}

Vector ReducedSpace::displacement(const Eigen::VectorXd& freedoms) const {
    Vector sum = this->sum(freedoms, rigid_.size(), fields());
    const RigidMotion motion = sum_of_rigid_motions(freedoms.segment(1, static_cast<Eigen::Index>(rigid_.size())));
    for_rows(
        sum.size(), [&](std::size_t node) { sum[node] += displacement(motion, node); }, worth_threads);
    return sum;
}

Vector ReducedSpace::force(const ElasticSolver& solver, const Eigen::VectorXd& freedoms) const {
    Vector force;
    solver.forces(sum(freedoms, rigid_.size(), fields()), force);
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
    Vector motion(network_.nodes());
    for (std::size_t node = 0; node < motion.size(); ++node) motion[node] = displacement(rigid_.back(), node);
    const Eigen::VectorXd products = work_on_rigid_motions(motion);
    rigid_products_.conservativeResize(products.size(), products.size());
    rigid_products_.rightCols<1>() = products;
    rigid_products_.bottomRows<1>() = products.transpose();
    add_freedom();
}

ReducedSpace::Response ReducedSpace::response(ElasticSolver& solver, const Vector& load, int max_iterations) const {
    Response response;
    response.iterations = solver.respond(load, response.displacement, response.force, response_tolerance, max_iterations);
    remove_rigid_motions(response.displacement);
    return response;
}

ReducedSpace::RigidMotion ReducedSpace::sum_of_rigid_motions(const Eigen::VectorXd& amplitudes) const {
    RigidMotion sum{Vec3::Zero(), Vec3::Zero()};
    for (std::size_t k = 0; k < rigid_.size(); ++k) {
        sum.shift += amplitudes[static_cast<Eigen::Index>(k)] * rigid_[k].shift;
        sum.turn += amplitudes[static_cast<Eigen::Index>(k)] * rigid_[k].turn;
    }
    return sum;
}

/// Products of a field with each rigid motion, by its resultant and its moment about the middle.
Eigen::VectorXd ReducedSpace::work_on_rigid_motions(const Vector& force) const {
    const Vec6 total = sum_chunks(chunks_of(force.size()), Vec6(Vec6::Zero()), [&](std::size_t chunk) {
        Vec6 sum = Vec6::Zero();
        const std::size_t last = std::min(force.size(), (chunk + 1) * nodes_in_chunk);
        for (std::size_t node = chunk * nodes_in_chunk; node < last; ++node) {
            const Vec3 push = force[node].head<3>();
            sum.head<3>() += push;
            sum.tail<3>() += (network_.position[node] - middle_).cross(push) + network_.rotation_length * force[node].tail<3>();
        }
        return sum;
    });
    Eigen::VectorXd work(static_cast<Eigen::Index>(rigid_.size()));
    for (std::size_t k = 0; k < rigid_.size(); ++k)
        work[static_cast<Eigen::Index>(k)] = rigid_[k].shift.dot(total.head<3>()) + rigid_[k].turn.dot(total.tail<3>());
    return work;
}

/// Takes from a displacement what rigid motions have of it, by least squares.
void ReducedSpace::remove_rigid_motions(Vector& displacement) const {
    const RigidMotion motion = sum_of_rigid_motions(rigid_products_.ldlt().solve(work_on_rigid_motions(displacement)));
    for_rows(
        displacement.size(), [&](std::size_t node) { displacement[node] -= this->displacement(motion, node); }, worth_threads);
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

void ReducedSpace::join(const ElasticSolver& solver, std::size_t first, std::size_t last, const Vector& sum, double unit) {
    const std::vector<Eigen::Index> others = freedoms_without(fields(), first, last);
    stiffness_ = stiffness_(others, others).eval();
    const auto place = [&](std::size_t field) { return responses_.begin() + static_cast<std::ptrdiff_t>(field - rigid_.size()); };
    responses_.erase(place(first), place(last));
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
