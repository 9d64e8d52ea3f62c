// fourier_inverse.cpp: forces to spectrum, division by the symbol of the stiffness, spectrum to displacements.
#include "linalg/fourier_inverse.h"

#include <cmath>
#include <cstring>
#include <numbers>

namespace kiln::linalg {

namespace {

constexpr std::size_t lanes = Lines::lanes;

/// Symbols of a row of elements along x at one wave number along z, times those of eight wave numbers along y.
struct RowSymbols {
    float z_stiffness, z_mass, z_slope;
    float y_stiffness[lanes], y_mass[lanes], y_slope[lanes];
};

struct XSymbols {
    float stiffness, mass, slope;
};

/// Divides eight numbers of one wave number along x by the symbol; adds f . z to the sums.
void divide(const RowSymbols& row, const XSymbols& x, float conductivity, float /*unused*/, float scale, float* const (&re)[1],
            float* const (&im)[1], float* sums) {
#pragma omp simd
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        const float stiffness = x.stiffness * row.y_mass[lane] * row.z_mass +
                                x.mass * (row.y_stiffness[lane] * row.z_mass + row.y_mass[lane] * row.z_stiffness);
        const float inverse = stiffness > 0.0f ? scale / (conductivity * stiffness) : 0.0f;
        const float a = re[0][lane], b = im[0][lane];
        sums[lane] += inverse * (a * a + b * b);
        re[0][lane] = inverse * a;
        im[0][lane] = inverse * b;
    }
}

/// The same for the three components of a solid, whose symbol is a symmetric real matrix.
void divide(const RowSymbols& row, const XSymbols& x, float lambda_plus_shear, float shear, float scale, float* const (&re)[3],
            float* const (&im)[3], float* sums) {
#pragma omp simd
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        const float kx = x.stiffness * row.y_mass[lane] * row.z_mass, ky = x.mass * row.y_stiffness[lane] * row.z_mass;
        const float kz = x.mass * row.y_mass[lane] * row.z_stiffness, all = shear * (kx + ky + kz);
        const float xx = all + lambda_plus_shear * kx, yy = all + lambda_plus_shear * ky, zz = all + lambda_plus_shear * kz;
        const float xy = lambda_plus_shear * x.slope * row.y_slope[lane] * row.z_mass;
        const float xz = lambda_plus_shear * x.slope * row.y_mass[lane] * row.z_slope;
        const float yz = lambda_plus_shear * x.mass * row.y_slope[lane] * row.z_slope;
        const float a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;  // cofactors
        const float d = xx * zz - xz * xz, e = xy * xz - xx * yz, f = xx * yy - xy * xy;
        const float determinant = xx * a + xy * b + xz * c;
        const float inverse = determinant > 0.0f ? scale / determinant : 0.0f;
        float sum = 0.0f;
        for (float* const* part : {re, im}) {
            const float u = inverse * part[0][lane], v = inverse * part[1][lane], w = inverse * part[2][lane];
            const float p = a * u + b * v + c * w, q = b * u + d * v + e * w, r = c * u + e * v + f * w;
            sum += part[0][lane] * p + part[1][lane] * q + part[2][lane] * r;
            part[0][lane] = p;
            part[1][lane] = q;
            part[2][lane] = r;
        }
        sums[lane] += sum;
    }
}

float second_parameter(const HomogeneousConductor&) { return 0.0f; }
float second_parameter(const HomogeneousSolid& medium) { return static_cast<float>(medium.shear); }
float first_parameter(const HomogeneousConductor& medium) { return static_cast<float>(medium.conductivity); }
float first_parameter(const HomogeneousSolid& medium) { return static_cast<float>(medium.lambda + medium.shear); }

/// Copies lines between a plane of a field and places where they stand side by side: count numbers `step` floats apart, of up to
/// eight lines `next` floats apart.
void gather(const float* from, std::size_t count, std::size_t step, std::size_t next, std::size_t lines, float* to) {
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t line = 0; line < lines; ++line) to[lanes * i + line] = from[step * i + next * line];
}

void scatter(const float* from, std::size_t count, std::size_t step, std::size_t next, std::size_t lines, float* to) {
    for (std::size_t line = 0; line < lines; ++line)
        for (std::size_t i = 0; i < count; ++i) to[step * i + next * line] = from[lanes * i + line];
}

/// The same for lines that stand side by side in memory, `step` floats from one number to the next.
void gather_columns(const float* from, std::size_t count, std::size_t step, float* to) {
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + lanes * i, from + step * i, lanes * sizeof(float));
}

void scatter_columns(const float* from, std::size_t count, std::size_t step, float* to) {
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + step * i, from + lanes * i, lanes * sizeof(float));
}

}  // namespace

template <typename Medium>
FourierInverse<Medium>::FourierInverse(const PeriodicGrid& grid, const Medium& medium)
    : grid_(grid), waves_(grid.count[2] / 2 + 1), first_(first_parameter(medium)), second_(second_parameter(medium)),
      transform_{LineTransform(grid.count[0]), LineTransform(grid.count[1]), LineTransform(grid.count[2])},
      spectrum_(grid, components, 2 * waves_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t count = grid.count[axis];
        const double spacing = grid.spacing[static_cast<Eigen::Index>(axis)];
        for (std::size_t wave = 0; wave < count; ++wave) {
            const double angle = 2.0 * std::numbers::pi * static_cast<double>(wave) / static_cast<double>(count);
            const double half_sine = std::sin(0.5 * angle);
            symbols_[axis].stiffness.push_back(static_cast<float>(4.0 * half_sine * half_sine / spacing));
            symbols_[axis].mass.push_back(static_cast<float>(spacing * (2.0 + std::cos(angle)) / 3.0));
            symbols_[axis].slope.push_back(static_cast<float>(std::sin(angle)));
        }
    }
}

template <typename Medium>
double FourierInverse<Medium>::solve(const GridField& forces) {
    constexpr std::size_t columns = 2 * lanes;  // at a time: the second eight are the imaginary parts of the first
    const std::size_t length = grid_.count[2], plane = grid_.plane, rows = grid_.count[1];
    for_chunks(components * rows, [&](std::size_t task) {
        Lines lines(length);
        const std::size_t component = task / rows, row = task % rows;
        const float* from = forces.component(component) + row * grid_.row;
        float* to = spectrum_.component(component) + row * grid_.row;
        for (std::size_t x = 0; x < grid_.row; x += columns) {
            gather_columns(from + x, length, plane, lines.real());
            gather_columns(from + x + lanes, length, plane, lines.imaginary());
            transform_[2].forward(lines);
            const float *re = lines.real(), *im = lines.imaginary();
            for (std::size_t wave = 0; wave < waves_; ++wave) {
                const std::size_t here = lanes * wave, there = lanes * ((length - wave) % length);
                float *out_re = to + 2 * wave * plane + x, *out_im = out_re + plane;
#pragma omp simd
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    const float a = re[here + lane], b = im[here + lane], c = re[there + lane], d = im[there + lane];
                    out_re[lane] = 0.5f * (a + c);
                    out_im[lane] = 0.5f * (b - d);
                    out_re[lanes + lane] = 0.5f * (b + d);
                    out_im[lanes + lane] = 0.5f * (c - a);
                }
            }
        }
    });
    return sum_chunks(waves_, 0.0, [&](std::size_t wave) { return solve_plane(wave); });
}

template <typename Medium>
double FourierInverse<Medium>::solve_plane(std::size_t wave) {
    const std::size_t nx = grid_.count[0], ny = grid_.count[1], row = grid_.row, plane = grid_.plane;
    Lines column(ny);
    const auto along_y = [&](bool forward) {
        for (std::size_t component = 0; component < components; ++component) {
            float* re = spectrum_.component(component) + 2 * wave * plane;
            for (std::size_t x = 0; x < nx; x += lanes) {
                gather_columns(re + x, ny, row, column.real());
                gather_columns(re + plane + x, ny, row, column.imaginary());
                forward ? transform_[1].forward(column) : transform_[1].backward(column);
                scatter_columns(column.real(), ny, row, re + x);
                scatter_columns(column.imaginary(), ny, row, re + plane + x);
            }
        }
    };
    along_y(true);
    std::vector<Lines> rows;
    rows.reserve(components);
    for (std::size_t component = 0; component < components; ++component) rows.emplace_back(nx);
    double sum = 0.0;
    for (std::size_t y = 0; y < ny; y += lanes) sum += solve_rows(wave, y, rows);
    along_y(false);
    return sum * (wave == 0 || 2 * wave == grid_.count[2] ? 1.0 : 2.0);  // the other half of the spectrum is its mirror image
}

template <typename Medium>
double FourierInverse<Medium>::solve_rows(std::size_t wave, std::size_t y, std::vector<Lines>& lines) {
    const std::size_t nx = grid_.count[0], ny = grid_.count[1], row = grid_.row, plane = grid_.plane;
    const std::size_t present = std::min(lanes, ny - y);
    float *re[components], *im[components];
    for (std::size_t component = 0; component < components; ++component) {
        const float* from = spectrum_.component(component) + 2 * wave * plane + y * row;
        gather(from, nx, 1, row, present, lines[component].real());
        gather(from + plane, nx, 1, row, present, lines[component].imaginary());
        transform_[0].forward(lines[component]);
        re[component] = lines[component].real();
        im[component] = lines[component].imaginary();
    }
    RowSymbols symbols{symbols_[2].stiffness[wave], symbols_[2].mass[wave], symbols_[2].slope[wave], {}, {}, {}};
    for (std::size_t lane = 0; lane < present; ++lane) {
        symbols.y_stiffness[lane] = symbols_[1].stiffness[y + lane];
        symbols.y_mass[lane] = symbols_[1].mass[y + lane];
        symbols.y_slope[lane] = symbols_[1].slope[y + lane];
    }
    const float scale = 1.0f / static_cast<float>(grid_.nodes());
    double sum = 0.0;
    float sums[lanes] = {};
    for (std::size_t x = 0; x < nx; ++x) {
        divide(symbols, {symbols_[0].stiffness[x], symbols_[0].mass[x], symbols_[0].slope[x]}, first_, second_, scale, re, im,
               sums);
        for (std::size_t component = 0; component < components; ++component) {
            re[component] += lanes;
            im[component] += lanes;
        }
    }
    for (std::size_t lane = 0; lane < present; ++lane) sum += static_cast<double>(sums[lane]);
    for (std::size_t component = 0; component < components; ++component) {
        transform_[0].backward(lines[component]);
        float* to = spectrum_.component(component) + 2 * wave * plane + y * row;
        scatter(lines[component].real(), nx, 1, row, present, to);
        scatter(lines[component].imaginary(), nx, 1, row, present, to + plane);
    }
    return sum;
}

template <typename Medium>
void FourierInverse<Medium>::add_to(GridField& direction, float ratio) {
    constexpr std::size_t columns = 2 * lanes;
    const std::size_t length = grid_.count[2], plane = grid_.plane, rows = grid_.count[1];
    for_chunks(components * rows, [&](std::size_t task) {
        Lines lines(length);
        const std::size_t component = task / rows, row = task % rows;
        const float* from = spectrum_.component(component) + row * grid_.row;
        float* to = direction.component(component) + row * grid_.row;
        for (std::size_t x = 0; x < grid_.row; x += columns) {
            float *re = lines.real(), *im = lines.imaginary();
            for (std::size_t wave = 0; wave < waves_; ++wave) {
                const std::size_t here = lanes * wave, there = lanes * ((length - wave) % length);
                const float *in_re = from + 2 * wave * plane + x, *in_im = in_re + plane;
#pragma omp simd
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    const float a = in_re[lane], b = in_im[lane], c = in_re[lanes + lane], d = in_im[lanes + lane];
                    re[there + lane] = a + d;
                    im[there + lane] = c - b;
                    re[here + lane] = a - d;
                    im[here + lane] = b + c;
                }
            }
            transform_[2].backward(lines);
            re = lines.real(), im = lines.imaginary();
            for (std::size_t z = 0; z < length; ++z) {
                float* p = to + z * plane + x;
#pragma omp simd
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    p[lane] = re[lanes * z + lane] + ratio * p[lane];
                    p[lanes + lane] = im[lanes * z + lane] + ratio * p[lanes + lane];
                }
            }
        }
    });
}

template class FourierInverse<HomogeneousConductor>;
template class FourierInverse<HomogeneousSolid>;

}  // namespace kiln::linalg
