// activation_energy.cpp: regression at constant density, and the narrowest master sintering curve.
#include "analysis/activation_energy.h"

#include <boost/math/tools/minima.hpp>
#include <cmath>

#include "analysis/activated_time.h"
#include "analysis/line_fit.h"
#include "core/types.h"
#include "physics/diffusion.h"

namespace kiln::analysis {

using physics::gas_constant;

namespace {

constexpr double same_temperature = 1e-9;  // spread over temperature below which a line has no slope
constexpr int minimum_bits = 30;           // of the place of a minimum

/// Times at which the curves pass the densities: rows of densities, columns of curves, NaN where one does not.
using Passages = std::vector<std::vector<double>>;

Passages passages_of(const std::vector<DensityCurve>& curves, const std::vector<double>& densities) {
    Passages passages;
    for (const double density : densities) {
        passages.emplace_back();
        for (const DensityCurve& curve : curves) {
            const auto found = crossing(curve, density);
            passages.back().push_back(found ? found->time : std::nan(""));
        }
    }
    return passages;
}

std::vector<FiringPath> paths_of(const std::vector<DensityCurve>& curves) {
    std::vector<FiringPath> paths;
    for (const DensityCurve& curve : curves) paths.emplace_back(curve.schedule, curve.schedule.begin(), curve.time.back());
    return paths;
}

/// The width, leaving out one curve or one density (their count: none).
double width_of(const std::vector<FiringPath>& paths, const Passages& passages, double energy, std::size_t without_curve,
                std::size_t without_density) {
    // Scaled to 1 at a temperature of furnaces, so that no number underflows.
    constexpr double reference = 1500.0;
    const auto rate = [energy](double temperature) {
        return reference / temperature * std::exp(-energy / gas_constant * (1.0 / temperature - 1.0 / reference));
    };
    std::vector<ActivatedTime> times;
    for (const FiringPath& path : paths) times.emplace_back(path, rate);
    double squares = 0.0;
    std::size_t points = 0;
    for (std::size_t density = 0; density < passages.size(); ++density) {
        if (density == without_density) continue;
        std::vector<double> logs;
        for (std::size_t curve = 0; curve < paths.size(); ++curve)
            if (curve != without_curve && !std::isnan(passages[density][curve]))
                logs.push_back(std::log(times[curve].at(passages[density][curve])));
        if (logs.size() < 2) continue;
        double mean = 0.0;
        for (const double each : logs) mean += each / static_cast<double>(logs.size());
        for (const double each : logs) squares += (each - mean) * (each - mean);
        points += logs.size();
    }
    return points > 0 ? std::sqrt(squares / static_cast<double>(points)) : std::nan("");
}

/// Energy and width of the minimum.
std::pair<double, double> narrowest(const std::vector<FiringPath>& paths, const Passages& passages, std::size_t without_curve,
                                    std::size_t without_density) {
    return boost::math::tools::brent_find_minima(
        [&](double energy) { return width_of(paths, passages, energy, without_curve, without_density); }, min_energy, max_energy,
        minimum_bits);
}

/// Standard error from the values with one of `count` left out in turn.
double jackknife_error(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    double mean = 0.0, squares = 0.0;
    for (const double each : values) mean += each / count;
    for (const double each : values) squares += (each - mean) * (each - mean);
    return std::sqrt((count - 1.0) / count * squares);
}

}  // namespace

std::vector<IsoDensity> iso_density_energies(const std::vector<DensityCurve>& curves, const std::vector<double>& densities) {
    std::vector<IsoDensity> energies;
    for (const double density : densities) {
        std::vector<double> inverse, rate;
        for (const DensityCurve& curve : curves) {
            const auto found = crossing(curve, density);
            if (!found) continue;
            inverse.push_back(1.0 / found->temperature);
            rate.push_back(std::log(found->temperature * found->rate));
        }
        if (inverse.size() < 2) continue;
        const auto [low, high] = std::ranges::minmax(inverse);
        if (!(high - low > same_temperature * high)) continue;
        const Line line = fit_line(inverse, rate);
        energies.push_back({density, {-gas_constant * line.slope, gas_constant * line.slope_error}, inverse.size()});
    }
    return energies;
}

double master_curve_width(const std::vector<DensityCurve>& curves, const std::vector<double>& densities, double energy) {
    return width_of(paths_of(curves), passages_of(curves, densities), energy, curves.size(), densities.size());
}

MasterCurve narrowest_master_curve(const std::vector<DensityCurve>& curves, const std::vector<double>& densities) {
    const std::vector<FiringPath> paths = paths_of(curves);
    const Passages passages = passages_of(curves, densities);
    const std::size_t no_curve = curves.size(), no_density = densities.size();
    if (std::isnan(width_of(paths, passages, min_energy, no_curve, no_density)))
        throw Error("no two measured curves pass one density");
    MasterCurve found;
    std::tie(found.energy.value, found.width) = narrowest(paths, passages, no_curve, no_density);
    std::vector<double> without;
    const bool by_curves = curves.size() > 2;
    found.error_from = by_curves ? "curves" : "densities";
    for (std::size_t each = 0; each < (by_curves ? no_curve : no_density); ++each) {
        const std::size_t curve = by_curves ? each : no_curve, density = by_curves ? no_density : each;
        if (std::isnan(width_of(paths, passages, min_energy, curve, density))) continue;
        without.push_back(narrowest(paths, passages, curve, density).first);
    }
    if (without.size() > 1) found.energy.error = jackknife_error(without);
    return found;
}

}  // namespace kiln::analysis
