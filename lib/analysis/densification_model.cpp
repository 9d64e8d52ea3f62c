// densification_model.cpp: the grid of densities, what the runs say between its nodes, and the way along a firing.
#include "analysis/densification_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/types.h"

namespace kiln::analysis {

namespace {

constexpr std::size_t spans = 240;        // of the grid of densities
constexpr double same_density = 1e-5;     // of the starts of two runs
constexpr double same_sigma = 0.3;        // relative: runs nearer than that count as one, or their scatter would become a slope
constexpr double min_share = 0.1;         // of theta, where the straight line between runs of other constants falls
constexpr int passes = 3;                 // over a span, for the sigma of its middle

/// Rows of a run at which its density is above all before.
std::vector<std::size_t> rising(const std::vector<double>& density) {
    std::vector<std::size_t> rows{0};
    for (std::size_t row = 1; row < density.size(); ++row)
        if (density[row] > density[rows.back()] * (1.0 + 1e-9)) rows.push_back(row);
    return rows;
}

std::vector<double> picked(const std::vector<double>& values, const std::vector<std::size_t>& rows) {
    std::vector<double> list;
    for (const std::size_t row : rows) list.push_back(values[row]);
    return list;
}

std::vector<double> cube_roots(std::vector<double> values) {
    for (double& each : values) each = std::cbrt(each);
    return values;
}

}  // namespace

Course::Course(const std::vector<double>& density, const std::vector<double>& theta, const std::vector<double>& diameter)
    : end_(theta.back()), density_(cube_roots(theta), density), diameter_(density, diameter) {}

DensificationModel::DensificationModel(const std::vector<SimulatedRun>& runs) {
    if (runs.empty()) throw Error("there is no simulated run");
    const SimulatedRun& first = runs.front();
    coarsens_ = first.surface.has_value();
    start_diameter_ = first.grain_diameter.empty() ? std::nan("") : first.grain_diameter.front();
    double end = 0.0;
    for (const SimulatedRun& run : runs) {
        if (run.surface.has_value() != coarsens_)
            throw Error(run.name + ": one run of a body coarsens and another one does not");
        if (std::abs(run.density.front() - first.density.front()) > same_density)
            throw Error(run.name + ": runs of one body start at relative densities of " + std::to_string(first.density.front()) +
                        " and " + std::to_string(run.density.front()));
        end = std::max(end, std::ranges::max(run.density));
    }
    const double start = first.density.front();
    if (!(end > start + same_density)) throw Error(first.name + ": the run does not densify");
    for (std::size_t node = 0; node <= spans; ++node)
        density_.push_back(start + (end - start) * static_cast<double>(node) / static_cast<double>(spans));
    samples_.resize(spans);
    for (const SimulatedRun& run : runs) add(run);
    order();
}

void DensificationModel::add(const SimulatedRun& run) {
    const FiringPath path(run.schedule, run.time.front(), run.time.back());
    const ActivatedTime theta(path, [&](double temperature) { return boundary_rate(run.material, temperature); });
    std::optional<ActivatedTime> sigma;
    if (run.surface)
        sigma.emplace(path, [&](double temperature) { return surface_rate(run.material, *run.surface, temperature); });
    const std::vector<std::size_t> rows = rising(run.density);
    std::vector<double> roots;
    for (const std::size_t row : rows) roots.push_back(std::cbrt(theta.at(run.time[row])));
    const std::vector<double> densities = picked(run.density, rows);
    const MonotoneCurve root_at(densities, roots);
    std::optional<MonotoneCurve> diameter_at;
    if (!run.grain_diameter.empty()) diameter_at.emplace(densities, picked(run.grain_diameter, rows));

    const auto theta_at = [&](double density) { return std::pow(root_at.at(density), 3); };
    const auto sigma_at = [&](double passed) { return sigma ? sigma->at(theta.time_of(passed)) : 0.0; };
    for (std::size_t span = 0; span < spans && density_[span + 1] <= densities.back() + same_density; ++span) {
        const double before = theta_at(density_[span]), after = theta_at(density_[span + 1]);
        samples_[span].push_back({0.5 * (sigma_at(before) + sigma_at(after)), after - before,
                                  diameter_at ? diameter_at->at(density_[span + 1]) : std::nan("")});
    }
}

void DensificationModel::order() {
    for (std::vector<Sample>& samples : samples_) {
        std::ranges::sort(samples, {}, &Sample::sigma);
        std::vector<Sample> merged;
        std::size_t alike = 0;  // runs in the last one
        for (const Sample& sample : samples) {
            if (merged.empty() || sample.sigma > merged.back().sigma * (1.0 + same_sigma)) {
                merged.push_back(sample);
                alike = 1;
                continue;
            }
            const auto mean = [&](double& last, double next) { last += (next - last) / static_cast<double>(alike + 1); };
            mean(merged.back().sigma, sample.sigma);
            mean(merged.back().theta, sample.theta);
            mean(merged.back().diameter, sample.diameter);
            ++alike;
        }
        samples = std::move(merged);
    }
}

DensificationModel::Sample DensificationModel::at(std::size_t span, double sigma) const {
    const std::vector<Sample>& samples = samples_[span];
    // Less than all runs had counts as the least of them, for straight on would come to no theta at all; more goes straight on.
    if (samples.size() == 1 || sigma <= samples.front().sigma) return samples.front();
    const auto after =
        std::clamp(std::ranges::lower_bound(samples, sigma, {}, &Sample::sigma), samples.begin() + 1, samples.end() - 1);
    const Sample& low = *(after - 1);
    const Sample& high = *after;
    const double part = (sigma - low.sigma) / (high.sigma - low.sigma);
    const auto quartic = [](double diameter) { return diameter * diameter * diameter * diameter; };
    const double size = quartic(low.diameter) + part * (quartic(high.diameter) - quartic(low.diameter));
    return {sigma, std::max(low.theta + part * (high.theta - low.theta), low.theta * min_share),
            std::pow(std::max(size, 0.0), 0.25)};
}

Course DensificationModel::course(const ActivatedTime& theta, const ActivatedTime* sigma) const {
    std::vector<double> reached{0.0}, diameter{start_diameter_};
    const auto sigma_at = [&](double passed) { return sigma != nullptr ? sigma->at(theta.time_of(passed)) : 0.0; };
    double before = 0.0;
    for (std::size_t span = 0; span < spans; ++span) {
        double after = before;
        Sample sample{};
        for (int pass = 0; pass < passes; ++pass) {
            sample = at(span, 0.5 * (before + after));
            after = sigma_at(reached.back() + sample.theta);
        }
        reached.push_back(reached.back() + sample.theta);
        diameter.push_back(sample.diameter);
        before = after;
    }
    return {density_, reached, diameter};
}

}  // namespace kiln::analysis
