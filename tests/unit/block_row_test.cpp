// block_row_test.cpp: rows of blocks times one field or several.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "linalg/block_row.h"

using namespace kiln::linalg;

namespace {

template <typename Real, int width>
void check_row(double tolerance) {
    constexpr std::size_t count = 9;
    std::vector<Eigen::Matrix<Real, 6, 6>> blocks(count);
    std::vector<Values<Real, width>> x(count);
    Eigen::Matrix<double, 6, width> straight = Eigen::Matrix<double, 6, width>::Zero(), across = straight;
    RowSum<Real, width> sum;
    RowSum<Real, width, true> sum_across;
    for (std::size_t k = 0; k < count; ++k) {
        const auto rough = [&](int place) {
            return static_cast<Real>(std::sin(1.0 + 12.9898 * static_cast<double>(k) + 78.233 * place));
        };
        for (int i = 0; i < 36; ++i) blocks[k].data()[i] = rough(i);
        for (int i = 0; i < 6 * width; ++i) x[k].data()[i] = rough(40 + i);
        straight += blocks[k].template cast<double>() * x[k].template cast<double>();
        across += blocks[k].transpose().template cast<double>() * x[k].template cast<double>();
        sum.add(blocks[k], x[k]);
        sum_across.add(blocks[k], x[k]);
    }
    CHECK((sum.values().template cast<double>() - straight).norm() < tolerance * straight.norm());
    CHECK((sum_across.values().template cast<double>() - across).norm() < tolerance * across.norm());
    const auto term_at = [&](std::int64_t k) {
        return Term<Real, width>{&blocks[static_cast<std::size_t>(k)], &x[static_cast<std::size_t>(k)]};
    };
    CHECK(sum_of_terms<Real, width>(count, term_at) == sum.values());
    const Values<Real, width> transposed = sum_of_terms<Real, width, true>(count, term_at);
    CHECK(transposed == sum_across.values());
}

}  // namespace

TEST_CASE("a row of blocks times one field or several, also transposed") {
    check_row<float, 1>(1e-5);
    check_row<float, 4>(1e-5);
    check_row<double, 1>(1e-13);
    check_row<double, 4>(1e-13);
}
