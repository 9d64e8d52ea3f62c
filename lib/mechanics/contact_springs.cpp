// contact_springs.cpp: tensions of springs whose freedoms of the whole are eliminated.
#include "mechanics/contact_springs.h"

#include <Eigen/Eigenvalues>

namespace kiln::mechanics {

namespace {

constexpr double negligible = 1e-10;  // stiffness of a freedom over that of the stiffest: nothing holds it

template <class Index>
std::size_t at(Index index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

void ContactSprings::add(const ContactSpring& spring, const Eigen::VectorXd& by_whole) {
    springs_.push_back(spring);
    by_whole_.conservativeResize(by_whole.size(), std::ssize(springs_));
    by_whole_.rightCols<1>() = by_whole;
}

void ContactSprings::let_whole_follow() {
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(by_whole_.rows(), by_whole_.rows());
    for (Eigen::Index k = 0; k < by_whole_.cols(); ++k)
        stiffness += springs_[at(k)].stiffness * by_whole_.col(k) * by_whole_.col(k).transpose();
    if (springs_.empty()) return;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(stiffness);
    const double least = negligible * axes.eigenvalues().maxCoeff();
    const Eigen::VectorXd inverse = (axes.eigenvalues().array() > least).select(axes.eigenvalues().cwiseInverse(), 0.0);
    compliance_ = axes.eigenvectors() * inverse.asDiagonal() * axes.eigenvectors().transpose();
}

linalg::NodeForces ContactSprings::forces(const std::function<Vec6(std::size_t)>& motion) const {
    if (springs_.empty()) return {};
    Eigen::VectorXd tension(by_whole_.cols());
    for (std::size_t k = 0; k < springs_.size(); ++k) {
        const ContactSpring& spring = springs_[k];
        double stretch = spring.by_node.dot(motion(at(spring.node)));
        if (spring.other >= 0) stretch += spring.by_other.dot(motion(at(spring.other)));
        tension[static_cast<Eigen::Index>(k)] = spring.stiffness * stretch;
    }
    const Eigen::VectorXd whole = -compliance_ * (by_whole_ * tension);
    linalg::NodeForces forces;
    for (std::size_t k = 0; k < springs_.size(); ++k) {
        const ContactSpring& spring = springs_[k];
        const auto column = static_cast<Eigen::Index>(k);
        const double held = tension[column] + spring.stiffness * by_whole_.col(column).dot(whole);
        forces.emplace_back(at(spring.node), held * spring.by_node);
        if (spring.other >= 0) forces.emplace_back(at(spring.other), held * spring.by_other);
    }
    return forces;
}

}  // namespace kiln::mechanics
