// slenderness.cpp: sentences on bars too short for the formulas of beams.
#include "analysis/slenderness.h"

#include <cstdio>

#include "core/types.h"

namespace kiln::analysis {

namespace {

constexpr double rounding = 1e-9;  // of sizes that are meant to be such a multiple
const std::string beginning = "L/h (span over height) is ";

std::string text(const char* form, double number) {
    char words[32];
    std::snprintf(words, sizeof words, form, number);
    return words;
}

}  // namespace

std::optional<std::string> short_bar_warning(double span, double height, std::optional<double> shear_correction) {
    const double slenderness = span / height;
    if (!(slenderness < slender_bar * (1.0 - rounding))) return std::nullopt;
    std::string reason = "much of the load goes straight to the supports; the strength lies above that", rest = "scatters";
    if (shear_correction) {
        reason = *shear_correction > 1.0 ? "shear is " + text("%.0f", 100.0 * (1.0 - 1.0 / *shear_correction)) +
                                               " % of a beam's deflection, for which E has a factor " +
                                               text("%.3g", *shear_correction)
                                         : std::string("much of the deflection is shear, for which E has no factor");
        reason += "; E and strength lie above those";
        rest = "scatter";
    }
    return beginning + text("%.2g", slenderness) + ", below 4: " + reason + " of longer bars of the same body, and " + rest +
           " more";
}

bool is_short_bar_warning(const std::string& sentence) { return sentence.starts_with(beginning); }

void refuse_block(double span, double height, const std::string& option) {
    const double slenderness = span / height;
    if (slenderness < shortest_bar * (1.0 - rounding))
        throw Error(
            beginning + text("%.2g", slenderness) +
            ": below 2 it is a block, of which the formulas of beams give up to several times the modulus; bend a bar (sinter "
            "green --aspect 6:1:1), or give " +
            option);
}

}  // namespace kiln::analysis
