// preconditioner.cpp: the block incomplete factorisation and its two triangular solves, chunk by chunk.
#include "sintering/preconditioner.h"

#include <Eigen/Dense>
#include <algorithm>

namespace kiln::sintering {

namespace {

/// Part of a diagonal block's trace below which what elimination left of it is rounding: the block moves freely with what hangs on
/// it.
constexpr double smallest_pivot = 1e-6;

/// Inverse of a pivot; zero along directions that are free, so that a cluster which hangs on nothing stays where its last particle
/// is.
Eigen::Matrix3d pivot_inverse(const Eigen::Matrix3d& pivot, double trace) {
    const double floor = smallest_pivot * trace;
    const double first = pivot(0, 0), second = pivot(1, 1) - pivot(1, 0) * pivot(1, 0) / first;  // D of its L D L^T
    const double rest = pivot(2, 1) - pivot(2, 0) * pivot(1, 0) / first;
    const double third = pivot(2, 2) - pivot(2, 0) * pivot(2, 0) / first - rest * rest / second;
    if (first > floor && second > floor && third > floor) return pivot.inverse();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(pivot);
    const Vec3& values = modes.eigenvalues();
    const Vec3 inverse = (values.array() > floor).select(values.cwiseInverse(), 0.0);
    return modes.eigenvectors() * inverse.asDiagonal() * modes.eigenvectors().transpose();
}

}  // namespace

Preconditioner::Preconditioner(const ContactNetwork& network)
    : row_begin_(network.particles() + 1, 0),
      place_(network.first.size(), 0),
      diagonal_(network.particles()),
      inverse_(block_floats * network.particles() + 1) {
    for (const ContactNetwork::Chunk& chunk : network.chunks())
        for (std::size_t entry = chunk.begin; entry < chunk.first_only; ++entry)
            ++row_begin_[static_cast<std::size_t>(network.second[entry]) + 1];
    for (std::size_t row = 0; row < network.particles(); ++row) row_begin_[row + 1] += row_begin_[row];
    column_.resize(row_begin_.back());
    lower_.resize(block_floats * row_begin_.back() + 1);
    std::vector<std::size_t> next(row_begin_.begin(), row_begin_.end() - 1);
    // Entries are sorted by their first particle, so the blocks of a row come out sorted by column.
    for (const ContactNetwork::Chunk& chunk : network.chunks())
        for (std::size_t entry = chunk.begin; entry < chunk.first_only; ++entry) {
            place_[entry] = next[static_cast<std::size_t>(network.second[entry])]++;
            column_[place_[entry]] = network.first[entry];
        }
}

void Preconditioner::assemble(const Stiffness& stiffness, std::size_t index) {
    const ContactNetwork& network = stiffness.network();
    const ContactNetwork::Chunk& chunk = network.chunks()[index];
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) diagonal_[row].setZero();
    for (std::size_t entry = chunk.begin; entry < chunk.end; ++entry) {
        if (network.first[entry] == network.second[entry]) continue;  // its own image: no relative motion but by strain
        const Eigen::Matrix3d joint = stiffness.block(entry);
        for (const std::int32_t particle : {network.first[entry], network.second[entry]}) {
            const auto row = static_cast<std::size_t>(particle);
            if (row >= chunk.first_particle && row < chunk.last_particle) diagonal_[row] += joint;
        }
        if (entry < chunk.first_only) block(lower_, place_[entry]) = -joint.cast<float>();
    }
}

void Preconditioner::eliminate(const ContactNetwork::Chunk& chunk) {
    // Row by row: U_ji = A_ji - sum_k L_jk U_ik^T over the columns k that rows j and i share, L_ji = U_ji D_i^-1,
    // D_j = A_jj - sum_i L_ji U_ji^T.
    std::vector<Eigen::Matrix3d> upper;  // U of row j
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {
        const double trace = diagonal_[row].trace();
        const std::size_t begin = row_begin_[row], end = row_begin_[row + 1];
        upper.resize(end - begin);
        for (std::size_t place = begin; place < end; ++place) {
            const auto i = static_cast<std::size_t>(column_[place]);
            Eigen::Matrix3d u = block(lower_, place).cast<double>();
            for (std::size_t a = begin, b = row_begin_[i]; a < place && b < row_begin_[i + 1];) {
                if (column_[a] == column_[b]) {
                    u -= upper[a - begin] * block(lower_, b).cast<double>().transpose();
                    ++a;
                    ++b;
                } else {
                    column_[a] < column_[b] ? ++a : ++b;
                }
            }
            upper[place - begin] = u;
            block(lower_, place) = (u * block(inverse_, i).cast<double>()).cast<float>();
            diagonal_[row] -= block(lower_, place).cast<double>() * u.transpose();
        }
        block(inverse_, row) = pivot_inverse(diagonal_[row], trace).cast<float>();
    }
}

void Preconditioner::factorise_strain(const Stiffness& stiffness, std::span<const Vec3> levers) {
    const ContactNetwork& network = stiffness.network();
    std::vector<Eigen::Matrix3d> parts(network.chunks().size(), Eigen::Matrix3d::Zero());
    network.for_chunks([&](std::size_t index) {
        network.for_owned(index, [&](std::size_t entry) {
            const Vec3& l = levers[static_cast<std::size_t>(network.pair[entry])];
            parts[index] += l.asDiagonal() * stiffness.block(entry) * l.asDiagonal();
        });
    });
    Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
    for (const Eigen::Matrix3d& part : parts) strain += part;
    strain_inverse_ = pivot_inverse(strain, strain.trace());
}

void Preconditioner::factorise(const Stiffness& stiffness, std::span<const Vec3> levers) {
    const ContactNetwork& network = stiffness.network();
    network.for_chunks([&](std::size_t index) {
        assemble(stiffness, index);
        eliminate(network.chunks()[index]);
    });
    factorise_strain(stiffness, levers);
}

void Preconditioner::apply(const ContactNetwork::Chunk& chunk, const QuadMotion& r, QuadMotion& z) const {
    // The fourth number of a column is the next column's first: what it brings into spare places is cleared in the end.
    Quad* out = z.displacement.data();
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {  // L y = r
        Quad y = r.displacement[row];
        for (std::size_t place = row_begin_[row]; place < row_begin_[row + 1]; ++place) {
            const float* l = &lower_[block_floats * place];
            const Quad known = out[column_[place]];
            y -= load(l) * all<0>(known) + load(l + 3) * all<1>(known) + load(l + 6) * all<2>(known);
        }
        out[row] = y;
    }
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {  // D
        const float* d = &inverse_[block_floats * row];
        out[row] = load(d) * all<0>(out[row]) + load(d + 3) * all<1>(out[row]) + load(d + 6) * all<2>(out[row]);
    }
    for (std::size_t row = chunk.last_particle; row-- > chunk.first_particle;) {  // L^T z = y
        const Quad known = out[row] = only_vector(out[row]);
        for (std::size_t place = row_begin_[row]; place < row_begin_[row + 1]; ++place) {
            const float* l = &lower_[block_floats * place];
            out[column_[place]] -= transposed_product(load(l), load(l + 3), load(l + 6), known);
        }
    }
}

}  // namespace kiln::sintering
