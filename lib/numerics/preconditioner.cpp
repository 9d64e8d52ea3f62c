// preconditioner.cpp: the block incomplete factorisation and its two triangular solves, chunk by chunk.
#include "numerics/preconditioner.h"

#include <Eigen/Dense>
#include <algorithm>

namespace kiln::numerics {

namespace {

/// Part of a diagonal block's trace below which what elimination left of it is rounding: the block moves freely with what hangs on it.
constexpr double smallest_pivot = 1e-6;

Eigen::Matrix3d stiffness_of(const ContactNetwork& network, std::size_t entry) {
    const Vec3 n(network.nx[entry], network.ny[entry], network.nz[entry]);
    return network.tangential[entry] * Eigen::Matrix3d::Identity() +
           (network.normal[entry] - network.tangential[entry]) * n * n.transpose();
}

/// Inverse of a pivot; zero along directions that are free, so that a cluster which hangs on nothing stays where its last particle is.
Eigen::Matrix3d pivot_inverse(const Eigen::Matrix3d& pivot, double trace) {
    const double floor = smallest_pivot * trace;
    const Eigen::LLT<Eigen::Matrix3d> factor(pivot);
    if (factor.info() == Eigen::Success && factor.matrixLLT().diagonal().array().square().minCoeff() > floor)
        return factor.solve(Eigen::Matrix3d::Identity());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(pivot);
    const Vec3 values = modes.eigenvalues();
    const Vec3 inverse = (values.array() > floor).select(values.cwiseInverse(), 0.0);
    return modes.eigenvectors() * inverse.asDiagonal() * modes.eigenvectors().transpose();
}

}  // namespace

Preconditioner::Preconditioner(const ContactNetwork& network)
    : row_begin_(network.particles() + 1, 0), place_(network.first.size(), 0), diagonal_(network.particles()), inverse_(network.particles()) {
    for (const ContactNetwork::Chunk& chunk : network.chunks())
        for (std::size_t entry = chunk.begin; entry < chunk.first_only; ++entry)
            ++row_begin_[static_cast<std::size_t>(network.second[entry]) + 1];
    for (std::size_t row = 0; row < network.particles(); ++row) row_begin_[row + 1] += row_begin_[row];
    column_.resize(row_begin_.back());
    lower_.resize(row_begin_.back());
    std::vector<std::size_t> next(row_begin_.begin(), row_begin_.end() - 1);
    for (const ContactNetwork::Chunk& chunk : network.chunks())  // entries are sorted by their first particle, so rows come out sorted
        for (std::size_t entry = chunk.begin; entry < chunk.first_only; ++entry) {
            place_[entry] = next[static_cast<std::size_t>(network.second[entry])]++;
            column_[place_[entry]] = network.first[entry];
        }
}

void Preconditioner::assemble(const ContactNetwork& network, std::size_t index) {
    const ContactNetwork::Chunk& chunk = network.chunks()[index];
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) diagonal_[row].setZero();
    for (std::size_t entry = chunk.begin; entry < chunk.end; ++entry) {
        if (network.first[entry] == network.second[entry]) continue;  // its own image: no relative motion but by strain
        const Eigen::Matrix3d block = stiffness_of(network, entry);
        for (const std::int32_t particle : {network.first[entry], network.second[entry]}) {
            const auto row = static_cast<std::size_t>(particle);
            if (row >= chunk.first_particle && row < chunk.last_particle) diagonal_[row] += block;
        }
        if (entry < chunk.first_only) lower_[place_[entry]] = -block.cast<float>();
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
            Eigen::Matrix3d u = lower_[place].cast<double>();
            for (std::size_t a = begin, b = row_begin_[i]; a < place && b < row_begin_[i + 1];) {
                if (column_[a] == column_[b]) {
                    u -= upper[a - begin] * lower_[b].cast<double>().transpose();
                    ++a;
                    ++b;
                } else {
                    column_[a] < column_[b] ? ++a : ++b;
                }
            }
            upper[place - begin] = u;
            lower_[place] = (u * inverse_[i]).cast<float>();
            diagonal_[row] -= lower_[place].cast<double>() * u.transpose();
        }
        inverse_[row] = pivot_inverse(diagonal_[row], trace);
    }
}

void Preconditioner::factorise_strain(const ContactNetwork& network, std::span<const Vec3> levers) {
    std::vector<Eigen::Matrix3d> parts(network.chunks().size(), Eigen::Matrix3d::Zero());
    network.for_chunks([&](std::size_t index) {
        network.for_owned(index, [&](std::size_t entry) {
            const Vec3& l = levers[static_cast<std::size_t>(network.pair[entry])];
            parts[index] += l.asDiagonal() * stiffness_of(network, entry) * l.asDiagonal();
        });
    });
    Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
    for (const Eigen::Matrix3d& part : parts) strain += part;
    strain_inverse_ = pivot_inverse(strain, strain.trace());
}

void Preconditioner::factorise(const ContactNetwork& network, std::span<const Vec3> levers) {
    network.for_chunks([&](std::size_t index) {
        assemble(network, index);
        eliminate(network.chunks()[index]);
    });
    factorise_strain(network, levers);
}

void Preconditioner::apply(const ContactNetwork& network, std::size_t index, const Motion& r, Motion& z) const {
    const ContactNetwork::Chunk& chunk = network.chunks()[index];
    const double* in = r.displacement.data();
    double* out = z.displacement.data();
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {  // L y = r
        double x = in[3 * row], y = in[3 * row + 1], w = in[3 * row + 2];
        for (std::size_t place = row_begin_[row]; place < row_begin_[row + 1]; ++place) {
            const float* l = lower_[place].data();  // by columns
            const double* known = out + 3 * column_[place];
            const double a = known[0], b = known[1], c = known[2];
            x -= l[0] * a + l[3] * b + l[6] * c;
            y -= l[1] * a + l[4] * b + l[7] * c;
            w -= l[2] * a + l[5] * b + l[8] * c;
        }
        out[3 * row] = x;
        out[3 * row + 1] = y;
        out[3 * row + 2] = w;
    }
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {  // D
        const double* d = inverse_[row].data();
        double* value = out + 3 * row;
        const double a = value[0], b = value[1], c = value[2];
        value[0] = d[0] * a + d[3] * b + d[6] * c;
        value[1] = d[1] * a + d[4] * b + d[7] * c;
        value[2] = d[2] * a + d[5] * b + d[8] * c;
    }
    for (std::size_t row = chunk.last_particle; row-- > chunk.first_particle;) {  // L^T z = y
        const double a = out[3 * row], b = out[3 * row + 1], c = out[3 * row + 2];
        for (std::size_t place = row_begin_[row]; place < row_begin_[row + 1]; ++place) {
            const float* l = lower_[place].data();
            double* left = out + 3 * column_[place];
            left[0] -= l[0] * a + l[1] * b + l[2] * c;
            left[1] -= l[3] * a + l[4] * b + l[5] * c;
            left[2] -= l[6] * a + l[7] * b + l[8] * c;
        }
    }
}

}  // namespace kiln::numerics
