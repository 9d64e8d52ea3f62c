// sizes.cpp: percentiles of sizes as JSON.
#include "tools/common/sizes.h"

#include <cmath>

#include "analysis/histogram.h"
#include "io/json.h"

namespace kiln::cli {

Json percentiles_json(const std::function<double(double fraction, bool by_volume)>& quantile) {
    const auto three = [&](bool by_volume) {
        return Json{{"d10", quantile(0.1, by_volume)}, {"d50", quantile(0.5, by_volume)}, {"d90", quantile(0.9, by_volume)}};
    };
    return {{"by_number", three(false)}, {"by_volume", three(true)}};
}

Json percentiles_json(const std::vector<double>& diameters) {
    const std::vector<double> numbers(diameters.size(), 1.0);
    std::vector<double> volumes;
    for (const double diameter : diameters) volumes.push_back(std::pow(diameter, 3));
    return percentiles_json([&](double fraction, bool by_volume) {
        return analysis::quantile_of(diameters, by_volume ? volumes : numbers, fraction);
    });
}

}  // namespace kiln::cli
