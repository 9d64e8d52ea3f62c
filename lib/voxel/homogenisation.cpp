// homogenisation.cpp: uniform gradients one after the other, and the tensor of what answers them.
#include "voxel/homogenisation.h"

#include <algorithm>
#include <cmath>

#include "linalg/conjugate_gradient.h"

namespace kiln::voxel {

namespace {

/// Uniform gradients whose answers make a tensor: three, or Voigt's six strains with engineering shear.
std::vector<Gradient<Conductor>> load_cases(const Conductor&) {
    std::vector<Gradient<Conductor>> cases;
    for (int axis = 0; axis < 3; ++axis) cases.push_back(Gradient<Conductor>::Unit(axis));
    return cases;
}

std::vector<Gradient<Solid>> load_cases(const Solid&) {
    constexpr int rows[] = {0, 1, 2, 1, 0, 0}, columns[] = {0, 1, 2, 2, 2, 1};
    std::vector<Gradient<Solid>> cases;
    for (int component = 0; component < 6; ++component) {
        Gradient<Solid> strain = Gradient<Solid>::Zero();
        strain(rows[component], columns[component]) += 0.5;
        strain(columns[component], rows[component]) += 0.5;
        cases.push_back(strain);
    }
    return cases;
}

double stiffest(const Conductor& medium) { return medium.conductivity; }
double stiffest(const Solid& medium) { return medium.lambda + 2.0 * medium.shear; }
Conductor scaled(const Conductor& medium, double factor) { return {factor * medium.conductivity}; }
Solid scaled(const Solid& medium, double factor) { return {factor * medium.lambda, factor * medium.shear}; }

/// What conjugate gradients work on; see conjugate_gradient.h.
template <typename Medium>
struct System {
    const GridStiffness<Medium>& stiffness;
    linalg::FourierInverse<Medium>& inverse;
    GridField &solution, &residual, &direction, &product;
    double residual2 = 0.0;  // square of the norm of the residual as it was carried along

    double advance(double step) {
        const auto factor = static_cast<float>(step);
        float *x = solution.data(), *r = residual.data();
        const float *p = direction.data(), *q = product.data();
        const std::size_t size = solution.size();
        residual2 = sum_chunks((size + linalg::field_chunk - 1) / linalg::field_chunk, 0.0, [=](std::size_t chunk) {
            const std::size_t begin = chunk * linalg::field_chunk, end = std::min(size, begin + linalg::field_chunk);
#pragma omp simd
            for (std::size_t i = begin; i < end; ++i) {
                x[i] += factor * p[i];
                r[i] -= factor * q[i];
            }
            return linalg::lane_sum(begin, end,
                                    [=](std::size_t i) { return static_cast<double>(r[i]) * static_cast<double>(r[i]); });
        });
        return inverse.solve(residual);
    }

    double turn(double ratio) {
        inverse.add_to(direction, static_cast<float>(ratio));
        return stiffness.apply(direction, product);
    }
};

/// A field of one grid read at the nodes of another one of the same box, linearly in between, times a factor.
GridField interpolated(const GridField& from, const PeriodicGrid& coarse, const PeriodicGrid& fine, std::size_t components,
                       float factor) {
    GridField result(fine, components, fine.count[2]);
    struct Place {
        std::size_t low, high;
        float fraction;
    };
    std::array<std::vector<Place>, 3> places;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t count = coarse.count[axis];
        for (std::size_t node = 0; node < fine.count[axis]; ++node) {
            const double at = static_cast<double>(node * count) / static_cast<double>(fine.count[axis]);
            const auto low = static_cast<std::size_t>(at);
            places[axis].push_back({low, (low + 1) % count, static_cast<float>(at - static_cast<double>(low))});
        }
    }
    for_chunks(components * fine.count[2], [&](std::size_t task) {
        const std::size_t component = task / fine.count[2], plane = task % fine.count[2];
        const Place& z = places[2][plane];
        for (std::size_t row = 0; row < fine.count[1]; ++row) {
            const Place& y = places[1][row];
            const auto row_at = [&](std::size_t k, std::size_t j) {
                return from.component(component) + k * coarse.plane + j * coarse.row;
            };
            const float *a = row_at(z.low, y.low), *b = row_at(z.low, y.high), *c = row_at(z.high, y.low),
                        *d = row_at(z.high, y.high);
            float* to = result.component(component) + plane * fine.plane + row * fine.row;
            const auto at = [&](std::size_t x) {
                const float low = a[x] + y.fraction * (b[x] - a[x]), high = c[x] + y.fraction * (d[x] - c[x]);
                return low + z.fraction * (high - low);
            };
            for (std::size_t node = 0; node < fine.count[0]; ++node) {
                const Place& x = places[0][node];
                const float low = at(x.low);
                to[node] = factor * (low + x.fraction * (at(x.high) - low));
            }
        }
    });
    return result;
}

/// The image in units of its voxel and its stiffest medium, so that single precision has numbers near one.
template <typename Medium>
class Homogenisation {
   public:
    Homogenisation(const Image& image, const std::vector<Medium>& media, double modulus)
        : edge_(std::cbrt(image.edges.prod())),
          grid_(image.count, image.edges / edge_),
          media_(media),
          stiffness_(grid_, image.phase, media_),
          inverse_(grid_, *std::max_element(media_.begin(), media_.end(),
                                            [](const Medium& a, const Medium& b) { return stiffest(a) < stiffest(b); })),
          cases_(load_cases(media.front())),
          residual_(grid_, components, grid_.count[2]),
          direction_(residual_),
          product_(residual_),
          solutions_(cases_.size()),
          modulus_(modulus) {}

    Homogenised run(double tolerance, const Watch& watch, const Solutions* start) {
        Homogenised result;
        if (start && start->fields.size() == cases_.size()) take(*start);
        const auto size = static_cast<Eigen::Index>(cases_.size());
        result.tensor.resize(size, size);
        for (Eigen::Index column = 0; column < size; ++column) {
            const auto part = static_cast<double>(column) / static_cast<double>(size);
            const Unbalanced<Medium> left = solve(static_cast<std::size_t>(column), tolerance, result, [&](double fraction) {
                watch.at(part + fraction / static_cast<double>(size));
            });
            for (Eigen::Index row = 0; row <= column; ++row) {
                const double energy = (cases_[static_cast<std::size_t>(row)].array() * left.flux.array()).sum() -
                                      linalg::dot(solutions_[static_cast<std::size_t>(row)], residual_);
                result.tensor(row, column) = result.tensor(column, row) = modulus_ * energy / static_cast<double>(grid_.nodes());
            }
        }
        return result;
    }

    std::vector<GridField>& solutions() { return solutions_; }

   private:
    void take(const Solutions& start) {
        const PeriodicGrid coarse(start.count, Vec3::Ones());
        for (std::size_t index = 0; index < cases_.size(); ++index)
            solutions_[index] =
                interpolated(start.fields[index], coarse, grid_, components, static_cast<float>(start.edge / edge_));
    }

    static constexpr std::size_t components = Medium::components;
    static constexpr int max_iterations = 2000;
    static constexpr int max_restarts = 5;

    /// Solves one load case; residual_ is then what is left, in forces.
    template <typename Progress>
    Unbalanced<Medium> solve(std::size_t index, double tolerance, Homogenised& result, const Progress& progress) {
        GridField& solution = solutions_[index];
        std::fill_n(direction_.data(), direction_.size(), 0.0f);
        Unbalanced<Medium> left = stiffness_.unbalanced(direction_, cases_[index], residual_);
        const double load = std::sqrt(left.norm2), limit = tolerance * load;
        if (load <= rounding_of_load()) {  // nothing to balance, as where one medium fills the box
            solution = GridField(grid_, components, grid_.count[2]);
            return left;
        }
        if (solution.size() == 0)
            solution = GridField(grid_, components, grid_.count[2]);
        else
            left = stiffness_.unbalanced(solution, cases_[index], residual_);
        int iterations = 0;
        for (int restart = 0; restart <= max_restarts && std::sqrt(left.norm2) > limit && iterations < max_iterations; ++restart) {
            std::fill_n(direction_.data(), direction_.size(), 0.0f);
            std::fill_n(product_.data(), product_.size(), 0.0f);
            System<Medium> system{stiffness_, inverse_, solution, residual_, direction_, product_};
            const int before = iterations;
            linalg::conjugate_gradient(system, [&](const linalg::CgProgress& state) {
                iterations = before + state.iterations;
                const double reached = std::sqrt(system.residual2);
                progress(reached > limit ? std::max(0.0, std::log(reached / load) / std::log(tolerance)) : 1.0);
                return reached <= limit * kept_for_rounding || iterations >= max_iterations;
            });
            left = stiffness_.unbalanced(solution, cases_[index], residual_);
        }
        result.iterations += iterations;
        result.residual = std::max(result.residual, std::sqrt(left.norm2) / load);
        result.converged = result.converged && std::sqrt(left.norm2) <= limit;
        return left;
    }

    /// Forces below this are what is left of the forces of elements that cancel, in double precision.
    double rounding_of_load() const { return 1e-12 * std::sqrt(static_cast<double>(grid_.nodes())); }

    static constexpr double kept_for_rounding = 0.98;  // of the limit: what rounding may add to the residual carried along

    double edge_;  // m, the unit of length
    PeriodicGrid grid_;
    std::vector<Medium> media_;
    GridStiffness<Medium> stiffness_;
    linalg::FourierInverse<Medium> inverse_;
    std::vector<Gradient<Medium>> cases_;
    GridField residual_, direction_, product_;
    std::vector<GridField> solutions_;
    double modulus_;  // of the stiffest medium
};

}  // namespace

template <typename Medium>
double memory_of(const std::array<std::size_t, 3>& count) {
    const PeriodicGrid grid(count, Vec3::Ones());
    const double cases = Medium::components == 1 ? 3.0 : 6.0, fields = cases + 3.0;
    const double planes = fields * static_cast<double>(count[2]) + static_cast<double>(2 * (count[2] / 2 + 1));
    return planes * static_cast<double>(grid.plane) * static_cast<double>(Medium::components * sizeof(float));
}

template <typename Medium>
Homogenised homogenise(const Image& image, const std::vector<Medium>& media, double tolerance, const Watch& watch,
                       Solutions* solutions) {
    const std::uint8_t phases = image.phase.empty() ? std::uint8_t{0} : *std::max_element(image.phase.begin(), image.phase.end());
    if (media.empty() || phases > media.size()) throw Error("the image has a phase that no material belongs to");
    double modulus = 0.0;
    for (const Medium& medium : media) modulus = std::max(modulus, stiffest(medium));
    std::vector<Medium> relative;
    for (const Medium& medium : media) relative.push_back(scaled(medium, 1.0 / modulus));
    Homogenisation<Medium> problem(image, relative, modulus);
    Homogenised result = problem.run(tolerance, watch, solutions);
    if (solutions) *solutions = {image.count, std::cbrt(image.edges.prod()), std::move(problem.solutions())};
    return result;
}

Solid solid(double young_modulus, double poisson_ratio) {
    const double shear = young_modulus / (2.0 * (1.0 + poisson_ratio));
    return {2.0 * shear * poisson_ratio / (1.0 - 2.0 * poisson_ratio), shear};
}

template double memory_of<Conductor>(const std::array<std::size_t, 3>&);
template double memory_of<Solid>(const std::array<std::size_t, 3>&);
template Homogenised homogenise(const Image&, const std::vector<Conductor>&, double, const Watch&, Solutions*);
template Homogenised homogenise(const Image&, const std::vector<Solid>&, double, const Watch&, Solutions*);

}  // namespace kiln::voxel
