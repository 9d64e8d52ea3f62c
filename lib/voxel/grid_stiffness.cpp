// grid_stiffness.cpp: the product with a stiffness, a row of voxels at a time.
#include "voxel/grid_stiffness.h"

#include <algorithm>
#include <cstring>

#include "voxel/element.h"

namespace kiln::voxel {

namespace {

constexpr std::size_t width = 4;  // voxels at a time: four floats are a register of every x86-64 processor
template <typename Real>
struct WideOf {
    using Type [[gnu::vector_size(width * sizeof(Real))]] = Real;
};
template <typename Real>
using Wide = typename WideOf<Real>::Type;

// Wide doubles go through two registers; how they would be handed over between objects of different compilers does not matter here.
#pragma GCC diagnostic ignored "-Wpsabi"

template <typename Real>
[[gnu::always_inline]] inline Wide<Real> load(const Real* from) {
    Wide<Real> value;
    std::memcpy(&value, from, sizeof value);
    return value;
}
template <typename Real>
[[gnu::always_inline]] inline void store(Real* to, const Wide<Real>& value) {
    std::memcpy(to, &value, sizeof value);
}
/// Four floats of a field in the precision of the sums.
template <typename Real>
[[gnu::always_inline]] inline Wide<Real> convert(const float* from) {
    return __builtin_convertvector(load(from), Wide<Real>);
}

template <typename Medium>
double first_modulus(const Medium& medium) {
    if constexpr (Medium::components == 1)
        return medium.conductivity;
    else
        return medium.lambda;
}
template <typename Medium>
double second_modulus(const Medium& medium) {
    if constexpr (Medium::components == 1)
        return 0.0;
    else
        return medium.shear;
}

/// What is known while one row of voxels is at work. Arrays along x have room on both sides for the wrap.
template <typename Medium, typename Real>
class RowWork {
   public:
    static constexpr std::size_t components = Medium::components;
    using FieldRows = std::array<const float*, 4>;  // nodes of a row of voxels: at (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1)
    using ForceRows = std::array<Real*, 4>;

    RowWork(const PeriodicGrid& grid, const std::vector<Medium>& media, const Gradient<Medium>& gradient)
        : count_(grid.count[0]), row_(grid.row), stride_(grid.row + 2 * width), integrals_(edges_of(grid)),
          memory_((4 * 3 * components + 2) * stride_), media_(media) {
        for (std::size_t c = 0; c < components; ++c)
            for (std::size_t axis = 0; axis < 3; ++axis)
                affine_[c][axis] =
                    Wide<Real>{} +
                    static_cast<Real>(4.0 * gradient(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(axis)) *
                                      edges_of(grid)[axis]);
    }

    /// Moduli of the row's voxels.
    void take_phases(const std::uint8_t* phase) {
        Real *first = array(0), *second = array(1);
        for (std::size_t x = 0; x < count_; ++x) {
            first[x] = phase[x] == 0 ? Real(0) : static_cast<Real>(first_modulus(media_[phase[x] - 1u]));
            second[x] = phase[x] == 0 ? Real(0) : static_cast<Real>(second_modulus(media_[phase[x] - 1u]));
        }
    }

    /// Sums and differences of a component's nodal values along y and z.
    void take_field(std::size_t component, const FieldRows& rows) {
        Real* modes[4];
        for (std::size_t m = 0; m < 4; ++m) modes[m] = array(2 + 4 * component + m);
        for (std::size_t x = 0; x < row_; x += width) {
            const Wide<Real> a = convert<Real>(rows[0] + x), b = convert<Real>(rows[1] + x);
            const Wide<Real> c = convert<Real>(rows[2] + x), d = convert<Real>(rows[3] + x);
            const Wide<Real> sum0 = a + b, sum1 = c + d, difference0 = b - a, difference1 = d - c;
            store<Real>(modes[0] + x, sum0 + sum1);
            store<Real>(modes[1] + x, difference0 + difference1);
            store<Real>(modes[2] + x, sum1 - sum0);
            store<Real>(modes[3] + x, difference1 - difference0);
        }
        for (Real* mode : modes) mode[count_] = mode[0];  // round the box
    }

    /// Forces of the modes of each voxel, from the modes of its field. flux: sums over the row, where they are of interest.
    template <bool with_flux>
    void find_forces(Gradient<Medium>* flux) {
        const Real *first = array(0), *second = array(1);
        Wide<Real> sums[components][3] = {};
        for (std::size_t x = 0; x < row_; x += width) {
            Wide<Real> u[components][8], force[components][8];
#pragma GCC unroll 3
            for (std::size_t c = 0; c < components; ++c) {
#pragma GCC unroll 4
                for (std::size_t m = 0; m < 4; ++m) {
                    const Real* mode = array(2 + 4 * c + m) + x;
                    const Wide<Real> here = load(mode), next = load(mode + 1);
                    u[c][2 * m] = here + next;
                    u[c][2 * m + 1] = next - here;
                }
                if constexpr (with_flux)
                    for (std::size_t axis = 0; axis < 3; ++axis) u[c][std::size_t{1} << axis] += affine_[c][axis];
            }
            element_forces(integrals_, u, load(first + x), load(second + x), force);
#pragma GCC unroll 3
            for (std::size_t c = 0; c < components; ++c) {
                if constexpr (with_flux)
                    for (std::size_t axis = 0; axis < 3; ++axis) sums[c][axis] += force[c][std::size_t{1} << axis];
#pragma GCC unroll 4
                for (std::size_t m = 0; m < 4; ++m) {
                    store<Real>(low(c, m) + x, force[c][2 * m] - force[c][2 * m + 1]);
                    store<Real>(high(c, m) + x, force[c][2 * m] + force[c][2 * m + 1]);
                }
            }
        }
        for (std::size_t c = 0; c < components; ++c)
            for (std::size_t m = 0; m < 4; ++m) high(c, m)[-1] = high(c, m)[count_ - 1];
        if constexpr (with_flux)
            for (std::size_t c = 0; c < components; ++c)
                for (std::size_t axis = 0; axis < 3; ++axis)
                    (*flux)(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(axis)) +=
                        sums[c][axis][0] + sums[c][axis][1] + sums[c][axis][2] + sums[c][axis][3];
    }

    /// Adds the forces of a component to the rows of nodes.
    void give_forces(std::size_t c, const ForceRows& rows) const {
        for (std::size_t x = 0; x < row_; x += width) {
            Wide<Real> f[4];
#pragma GCC unroll 4
            for (std::size_t m = 0; m < 4; ++m) f[m] = load(low(c, m) + x) + load(high(c, m) + x - 1);
            const Wide<Real> minus = f[0] - f[2], plus = f[0] + f[2], minus_y = f[1] - f[3], plus_y = f[1] + f[3];
            store<Real>(rows[0] + x, load(rows[0] + x) + (minus - minus_y));
            store<Real>(rows[1] + x, load(rows[1] + x) + (minus + minus_y));
            store<Real>(rows[2] + x, load(rows[2] + x) + (plus - plus_y));
            store<Real>(rows[3] + x, load(rows[3] + x) + (plus + plus_y));
        }
    }

   private:
    static std::array<double, 3> edges_of(const PeriodicGrid& grid) { return {grid.spacing[0], grid.spacing[1], grid.spacing[2]}; }
    Real* array(std::size_t index) { return memory_.data() + index * stride_ + width; }
    const Real* array(std::size_t index) const { return memory_.data() + index * stride_ + width; }
    Real* low(std::size_t c, std::size_t m) { return array(2 + 4 * (components + c) + m); }
    const Real* low(std::size_t c, std::size_t m) const { return array(2 + 4 * (components + c) + m); }
    Real* high(std::size_t c, std::size_t m) { return array(2 + 4 * (2 * components + c) + m); }
    const Real* high(std::size_t c, std::size_t m) const { return array(2 + 4 * (2 * components + c) + m); }

    std::size_t count_, row_, stride_;
    ElementIntegrals<Wide<Real>> integrals_;
    Wide<Real> affine_[components][3];  // differences of the uniform gradient
    std::vector<Real> memory_;
    const std::vector<Medium>& media_;
};

constexpr std::size_t chunk_planes = 8;  // of nodes that one thread takes at a time

}  // namespace

template <typename Medium>
GridStiffness<Medium>::GridStiffness(const PeriodicGrid& grid, const std::vector<std::uint8_t>& phase,
                                     const std::vector<Medium>& media)
    : grid_(grid), phase_(phase), media_(media), solid_row_(grid.count[1] * grid.count[2]) {
    const std::size_t nx = grid.count[0];
    for_rows(solid_row_.size(), [&](std::size_t row) {
        const auto begin = phase.begin() + static_cast<std::ptrdiff_t>(row * nx);
        solid_row_[row] =
            std::any_of(begin, begin + static_cast<std::ptrdiff_t>(nx), [](std::uint8_t value) { return value != 0; });
    });
}

namespace {

/// Forces of the voxels around the planes of a chunk, added to an array of those planes that starts at zero.
template <bool with_flux, typename Medium, typename Real>
void add_forces(const PeriodicGrid& grid, const std::vector<std::uint8_t>& phase, const std::vector<char>& solid_row,
                const GridField& field, std::size_t first_plane, std::size_t end_plane, RowWork<Medium, Real>& work,
                const std::array<Real*, Medium::components>& forces, Gradient<Medium>* flux) {
    const auto [nx, ny, nz] = grid.count;
    std::vector<Real> beside(grid.row);  // what goes to planes of other chunks, which find it themselves
    for (std::size_t above = first_plane; above <= end_plane; ++above) {  // voxels between the planes above - 1 and above
        const std::size_t layer = (above + nz - 1) % nz, next = above % nz;
        for (std::size_t y = 0; y < ny; ++y) {
            if (!solid_row[layer * ny + y]) continue;
            const std::size_t low_row = y * grid.row, high_row = (y + 1) % ny * grid.row;
            work.take_phases(phase.data() + (layer * ny + y) * nx);
            for (std::size_t c = 0; c < Medium::components; ++c) {
                const float *here = field.component(c) + layer * grid.plane, *there = field.component(c) + next * grid.plane;
                work.take_field(c, {here + low_row, here + high_row, there + low_row, there + high_row});
            }
            if (above > first_plane || !with_flux) {
                work.template find_forces<with_flux>(flux);
            } else {
                Gradient<Medium> counted_elsewhere = Gradient<Medium>::Zero();
                work.template find_forces<with_flux>(&counted_elsewhere);
            }
            for (std::size_t c = 0; c < Medium::components; ++c) {
                std::array<Real*, 4> rows{beside.data(), beside.data(), beside.data(), beside.data()};
                if (above > first_plane) {
                    Real* plane = forces[c] + (above - 1 - first_plane) * grid.plane;
                    rows[0] = plane + low_row, rows[1] = plane + high_row;
                }
                if (above < end_plane) {
                    Real* plane = forces[c] + (above - first_plane) * grid.plane;
                    rows[2] = plane + low_row, rows[3] = plane + high_row;
                }
                work.give_forces(c, rows);
            }
        }
    }
    for (std::size_t plane = 0; plane < end_plane - first_plane; ++plane)
        for (std::size_t y = 0; y < ny; ++y)
            for (Real* component : forces) {
                Real* row = component + plane * grid.plane + y * grid.row;
                std::fill(row + nx, row + grid.row, Real(0));
            }
}

}  // namespace

template <typename Medium>
double GridStiffness<Medium>::apply(const GridField& field, GridField& forces) const {
    const std::size_t nz = grid_.count[2];
    return sum_chunks((nz + chunk_planes - 1) / chunk_planes, 0.0, [&](std::size_t chunk) {
        const std::size_t first = chunk * chunk_planes, end = std::min(nz, first + chunk_planes),
                          size = (end - first) * grid_.plane;
        RowWork<Medium, float> work(grid_, media_, Gradient<Medium>::Zero());
        std::array<float*, components> out;
        for (std::size_t c = 0; c < components; ++c) {
            out[c] = forces.component(c) + first * grid_.plane;
            std::fill(out[c], out[c] + size, 0.0f);
        }
        add_forces<false>(grid_, phase_, solid_row_, field, first, end, work, out, static_cast<Gradient<Medium>*>(nullptr));
        double product = 0.0;
        for (std::size_t c = 0; c < components; ++c) {
            const float *u = field.component(c) + first * grid_.plane, *f = out[c];
            product +=
                linalg::lane_sum(0, size, [=](std::size_t i) { return static_cast<double>(u[i]) * static_cast<double>(f[i]); });
        }
        return product;
    });
}

template <typename Medium>
Unbalanced<Medium> GridStiffness<Medium>::unbalanced(const GridField& field, const Gradient<Medium>& gradient,
                                                     GridField& forces) const {
    const std::size_t nz = grid_.count[2];
    Unbalanced<Medium> total = sum_chunks((nz + chunk_planes - 1) / chunk_planes, Unbalanced<Medium>(), [&](std::size_t chunk) {
        const std::size_t first = chunk * chunk_planes, end = std::min(nz, first + chunk_planes),
                          size = (end - first) * grid_.plane;
        RowWork<Medium, double> work(grid_, media_, gradient);
        std::vector<double> sums(components * size, 0.0);
        std::array<double*, components> out;
        for (std::size_t c = 0; c < components; ++c) out[c] = sums.data() + c * size;
        Unbalanced<Medium> part;
        add_forces<true>(grid_, phase_, solid_row_, field, first, end, work, out, &part.flux);
        for (std::size_t c = 0; c < components; ++c) {
            float* rounded = forces.component(c) + first * grid_.plane;
            for (std::size_t i = 0; i < size; ++i) rounded[i] = static_cast<float>(-out[c][i]);
            part.norm2 += linalg::lane_sum(0, size, [f = out[c]](std::size_t i) { return f[i] * f[i]; });
        }
        return part;
    });
    for (Eigen::Index axis = 0; axis < 3; ++axis) total.flux.col(axis) *= 4.0 * grid_.spacing[axis];
    return total;
}

template class GridStiffness<Conductor>;
template class GridStiffness<Solid>;

}  // namespace kiln::voxel
