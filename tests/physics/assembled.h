// assembled.h: the stiffness matrix of a bond network block by block, to compare products with.
#pragma once

#include "linalg/sparse_row.h"
#include "mechanics/bond_network.h"
#include "mechanics/connectivity.h"

namespace kiln::test {

inline linalg::BlockMatrix stiffness_matrix(const mechanics::BondNetwork& network) {
    const Grouping<std::int32_t> incidence = mechanics::find_incidence(network.nodes(), network.pair);
    linalg::BlockMatrix matrix;
    matrix.columns = static_cast<std::int32_t>(network.nodes());
    linalg::SparseRow sum(network.nodes());
    for (std::int32_t node = 0; node < matrix.columns; ++node) {
        for (const std::int32_t bond : incidence.of(static_cast<std::size_t>(node))) {
            const auto [i, j] = network.pair[static_cast<std::size_t>(bond)];
            const mechanics::BondBlocks blocks = bond_blocks(network, static_cast<std::size_t>(bond));
            if (node == i) {
                sum.at(i) += blocks.ii;
                sum.at(j) += blocks.ij;
            }
            if (node == j) {
                sum.at(j) += blocks.jj;
                sum.at(i) += blocks.ij.transpose();
            }
        }
        sum.end_row(matrix);
    }
    return matrix;
}

}  // namespace kiln::test
