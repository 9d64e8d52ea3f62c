// contact_softening.cpp: a body in contact whose bonds break one by one.
#include "mechanics/contact_problem.h"

namespace kiln::mechanics {

namespace {

constexpr std::size_t fields_of_a_sequence = 60;  // of bonds that are softened, before their sum takes their place

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

}  // namespace

/// Keeps of all elastic fields only what they add up to now. Contacts without friction need no more of the past.
void ContactProblem::start_anew() {
    Field sum{Vector(network_.nodes(), Vec6::Zero()), combine(true)};
    for (std::size_t k = rigid_motions_; k < fields_.size(); ++k) {
        linalg::add(amplitude_[static_cast<Eigen::Index>(k) + 1], fields_[k].displacement, sum.displacement);
    }
    fields_.resize(rigid_motions_);
    const auto columns = static_cast<Eigen::Index>(rigid_motions_) + 1;
    closing_.conservativeResize(Eigen::NoChange, columns);
    sliding_.conservativeResize(Eigen::NoChange, columns);
    amplitude_.conservativeResize(columns);
    kept_.conservativeResize(columns);
    stiffness_.conservativeResize(columns, columns);
    const double largest = largest_closing(sum.displacement);
    for (Vec6& each : sum.displacement) each /= largest;
    for (Vec6& each : sum.force) each /= largest;
    add_field(std::move(sum));
    amplitude_[columns] = kept_[columns] = largest;
}

void ContactProblem::soften(std::size_t bond, double share, const PairContact& ends) {
    if (fields_.size() > fields_of_a_sequence) start_anew();
    const std::size_t i = at(network_.pair[bond][0]), j = at(network_.pair[bond][1]);
    const BondBlocks blocks = bond_blocks(network_, bond);
    const double lost = 1.0 - share;
    std::vector<Vec6> on_i, on_j;  // what the lost part of the bond held in each field
    for (Field& field : fields_) {
        const Vec6 &first = field.displacement[i], &second = field.displacement[j];
        on_i.emplace_back(lost * (blocks.ii * first + blocks.ij * second));
        on_j.emplace_back(lost * (blocks.ij.transpose() * first + blocks.jj * second));
        if (field.force.empty()) continue;
        field.force[i] -= on_i.back();
        field.force[j] -= on_j.back();
    }
    for (std::size_t a = rigid_motions_; a < fields_.size(); ++a) {
        for (std::size_t b = rigid_motions_; b < fields_.size(); ++b) {
            stiffness_(static_cast<Eigen::Index>(a) + 1, static_cast<Eigen::Index>(b) + 1) -=
                fields_[a].displacement[i].dot(on_i[b]) + fields_[a].displacement[j].dot(on_j[b]);
        }
    }
    solver_->soften(network_, bond, share);
    open_pairs_.push_back(ends);
}

}  // namespace kiln::mechanics
