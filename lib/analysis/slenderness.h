// slenderness.h: whether a bar is one: what the formulas of beams are worth on its span and height.
#pragma once

#include <optional>
#include <string>

namespace kiln::analysis {

/// Span between the supports over height, L/h, both in m: below the first a result of a beam formula is warned of, below the second
/// it is refused unless it is asked for. The deflection of a block is that of its contacts and of struts from load to support.
constexpr double slender_bar = 4.0, shortest_bar = 2.0;

/// What to know of E and strength by beam formulas on this span and height (m): a sentence below L/h = 4, nothing above.
/// shear_correction: the factor on E (physics::shear_correction), 1 where E has none; nothing where only a strength is asked for.
std::optional<std::string> short_bar_warning(double span, double height, std::optional<double> shear_correction);

/// Whether a sentence is one of those.
bool is_short_bar_warning(const std::string& sentence);

/// Throws Error below L/h = 2, which says how to do otherwise; option: the one that lets such bars pass.
void refuse_block(double span, double height, const std::string& option);

}  // namespace kiln::analysis
