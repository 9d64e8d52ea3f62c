// extrapolation.cpp: straight lines through a few values.
#include "voxel/extrapolation.h"

#include <cmath>
#include <numeric>

namespace kiln::voxel {

namespace {

double weighted(const std::vector<double>& weights, std::span<const double> values) {
    return std::inner_product(weights.begin(), weights.end(), values.begin(), 0.0);
}

double power_of(double edge, Order order) { return order == Order::first ? edge : edge * edge; }

double mean_power(std::span<const double> edges, Order order) {
    double sum = 0.0;
    for (const double edge : edges) sum += power_of(edge, order);
    return sum / static_cast<double>(edges.size());
}

}  // namespace

std::vector<double> extrapolation_weights(std::span<const double> edges, Order order) {
    const double count = static_cast<double>(edges.size()), mean = mean_power(edges, order);
    double spread = 0.0;
    for (const double edge : edges) spread += std::pow(power_of(edge, order) - mean, 2);
    std::vector<double> weights;
    for (const double edge : edges)
        weights.push_back(1.0 / count - (edges.size() == 1 ? 0.0 : mean * (power_of(edge, order) - mean) / spread));
    return weights;
}

Extrapolated extrapolate(std::span<const double> edges, std::span<const double> values, Order order) {
    const double value = weighted(extrapolation_weights(edges, order), values);
    const double other = weighted(extrapolation_weights(edges, order == Order::first ? Order::second : Order::first), values);
    const double mean = mean_power(edges, order),
                 level = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    const double slope = (level - value) / mean;
    double squares = 0.0;
    for (std::size_t i = 0; i < edges.size(); ++i) squares += std::pow(values[i] - value - slope * power_of(edges[i], order), 2);
    return {value, 2.0 * std::abs(value - other) + 2.0 * std::sqrt(squares / static_cast<double>(edges.size()))};
}

Eigen::MatrixXd extrapolate(std::span<const double> edges, const std::vector<Eigen::MatrixXd>& tensors, Order order) {
    const std::vector<double> weights = extrapolation_weights(edges, order);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(tensors.front().rows(), tensors.front().cols());
    for (std::size_t i = 0; i < edges.size(); ++i) sum += weights[i] * tensors[i];
    return sum;
}

}  // namespace kiln::voxel
