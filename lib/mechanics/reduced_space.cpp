// reduced_space.cpp: fields, their stiffness, and what is new in a response.
#include "mechanics/reduced_space.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <utility>

namespace kiln::mechanics {

namespace {

constexpr double response_tolerance = 0.1;  // of one linear solve; the next one takes up what it leaves
constexpr double second_pass = 0.1;         // of a response's energy, below which rounding calls for another orthogonalisation
constexpr double min_novelty = 1e-10;       // of a response's energy, that the space does not have already

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// Of the freedoms.
Eigen::Index place_of(std::size_t field) { return static_cast<Eigen::Index>(field) + 1; }

}  // namespace

ReducedSpace::ReducedSpace(const BondNetwork& network) : network_(network), stiffness_(Eigen::MatrixXd::Zero(1, 1)) {}

Vector ReducedSpace::displacement(const Eigen::VectorXd& freedoms) const {
    Vector sum(network_.nodes(), Vec6::Zero());
    for (std::size_t k = 0; k < fields_.size(); ++k) linalg::add(freedoms[place_of(k)], fields_[k].displacement, sum);
    return sum;
}

Vector ReducedSpace::force(const Eigen::VectorXd& freedoms) const {
    Vector sum(network_.nodes(), Vec6::Zero());
    for (std::size_t k = rigid_motions_; k < fields_.size(); ++k) linalg::add(freedoms[place_of(k)], fields_[k].force, sum);
    return sum;
}

void ReducedSpace::add_rigid_motion(const Vec3& shift, const Vec3& turn) {
    Vec3 low = network_.position.front(), high = low;
    for (const Vec3& position : network_.position) {
        low = low.cwiseMin(position);
        high = high.cwiseMax(position);
    }
    const Vec3 middle = (low + high) / 2.0;
    const double size = (high - low).norm();
    Field field{Vector(network_.nodes()), {}};
    for (std::size_t node = 0; node < network_.nodes(); ++node) {
        const Vec3 arm = (network_.position[node] - middle) / size;
        field.displacement[node] << shift + turn.cross(arm), network_.rotation_length / size * turn;
    }
    add_field(std::move(field));
    ++rigid_motions_;
}

void ReducedSpace::add_field(Field field) {
    const Eigen::Index column = stiffness_.cols();
    stiffness_.conservativeResize(column + 1, column + 1);
    stiffness_.row(column).setZero();
    stiffness_.col(column).setZero();
    fields_.push_back(std::move(field));
    const Field& added = fields_.back();
    if (added.force.empty()) return;
    for (std::size_t k = rigid_motions_; k < fields_.size(); ++k) {
        stiffness_(place_of(k), column) = stiffness_(column, place_of(k)) = linalg::dot(fields_[k].displacement, added.force);
    }
}

ReducedSpace::Response ReducedSpace::response(ElasticSolver& solver, const Vector& load) const {
    Response response;
    Vector& displacement = response.displacement;
    response.iterations = solver.solve(load, displacement, response_tolerance).iterations;
    response.energy = linalg::dot(displacement, load);
    const auto responses = static_cast<Eigen::Index>(fields_.size() - rigid_motions_);
    const Eigen::LDLT<Eigen::MatrixXd> elastic(stiffness_.bottomRightCorner(responses, responses));
    double rest = 0.0;  // J, that the fields there do not have
    for (int pass = 0; pass == 0 || (pass == 1 && rest < second_pass * response.energy); ++pass) {
        for (std::size_t k = 0; k < rigid_motions_; ++k) {
            const Vector& rigid = fields_[k].displacement;
            linalg::add(-linalg::dot(displacement, rigid) / linalg::dot(rigid, rigid), rigid, displacement);
        }
        Eigen::VectorXd loads(responses);
        for (Eigen::Index k = 0; k < responses; ++k) {
            loads[k] = linalg::dot(displacement, fields_[rigid_motions_ + static_cast<std::size_t>(k)].force);
        }
        const Eigen::VectorXd amplitudes = responses > 0 ? elastic.solve(loads) : loads;
        for (Eigen::Index k = 0; k < responses; ++k) {
            linalg::add(-amplitudes[k], fields_[rigid_motions_ + static_cast<std::size_t>(k)].displacement, displacement);
        }
        rest = response.energy - loads.dot(amplitudes);
    }
    return response;
}

bool ReducedSpace::add(const ElasticSolver& solver, Response response, double unit) {
    if (!(unit > 0.0)) return false;
    Field field{std::move(response.displacement), {}};
    for (Vec6& each : field.displacement) each /= unit;
    solver.forces(field.displacement, field.force);
    if (!(linalg::dot(field.displacement, field.force) * unit * unit > min_novelty * response.energy)) return false;
    add_field(std::move(field));
    return true;
}

void ReducedSpace::remove_last() {
    fields_.pop_back();
    stiffness_.conservativeResize(stiffness_.rows() - 1, stiffness_.cols() - 1);
}

ReducedSpace::Field ReducedSpace::sum_of_responses(const Eigen::VectorXd& freedoms) const {
    Field sum{Vector(network_.nodes(), Vec6::Zero()), force(freedoms)};
    for (std::size_t k = rigid_motions_; k < fields_.size(); ++k) {
        linalg::add(freedoms[place_of(k)], fields_[k].displacement, sum.displacement);
    }
    return sum;
}

void ReducedSpace::replace_responses(Field sum, double unit) {
    while (fields_.size() > rigid_motions_) remove_last();
    for (Vec6& each : sum.displacement) each /= unit;
    for (Vec6& each : sum.force) each /= unit;
    add_field(std::move(sum));
}

void ReducedSpace::soften(std::size_t bond, double share) {
    const std::size_t i = at(network_.pair[bond][0]), j = at(network_.pair[bond][1]);
    const BondBlocks blocks = bond_blocks(network_, bond);
    const double lost = 1.0 - share;
    std::vector<Vec6> on_i, on_j;  // what the lost part of the bond held in each response
    for (std::size_t k = rigid_motions_; k < fields_.size(); ++k) {
        Field& field = fields_[k];
        const Vec6 &first = field.displacement[i], &second = field.displacement[j];
        on_i.emplace_back(lost * (blocks.ii * first + blocks.ij * second));
        on_j.emplace_back(lost * (blocks.ij.transpose() * first + blocks.jj * second));
        field.force[i] -= on_i.back();
        field.force[j] -= on_j.back();
    }
    for (std::size_t a = 0; a < on_i.size(); ++a) {
        const Field& field = fields_[rigid_motions_ + a];
        for (std::size_t b = 0; b < on_i.size(); ++b) {
            stiffness_(place_of(rigid_motions_ + a), place_of(rigid_motions_ + b)) -=
                field.displacement[i].dot(on_i[b]) + field.displacement[j].dot(on_j[b]);
        }
    }
}

}  // namespace kiln::mechanics
