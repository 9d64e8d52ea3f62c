// kinetics_input.h: what `analyze kinetics` reads: measured curves out of tables, simulated runs out of histories and states.
#pragma once

#include <string>
#include <vector>

#include "analysis/density_curve.h"
#include "analysis/kinetic_fit.h"
#include "analysis/simulated_run.h"

namespace kiln::analyze {

/// How shrinkage becomes density.
struct Dilatometer {
    double green_density = 0.0;  // relative; 0: not given
    double expansion = 0.0;      // thermal, of the length, 1/K; taken off the measured change of length
};

/// A curve, and the file and column that it came from.
struct MeasuredCurve {
    analysis::DensityCurve curve;
    std::string source;  // the same for the same column of the same file
};

/// The curves of "FILE" or "FILE:RATE". FILE is a table (io/csv.h) with a column of temperature and
/// - time, and one of relative density or shrinkage: the firing is that of the table; or
/// - columns named for their heating rates, "5 K/min", of relative density; RATE chooses one of them; or
/// - one of relative density or shrinkage, and RATE is the heating rate. With a heating rate it starts at 25 C.
/// Throws Error naming file and row.
std::vector<MeasuredCurve> read_curves(const std::string& text, const Dilatometer& dilatometer);

/// "SCHEDULE = DENSITY", one measured density at the end of a firing; the density may be missing where `required` is false (an
/// empty curve of one time then, with density NaN). Throws TextError.
analysis::DensityCurve read_firing(const std::string& text, bool required);

/// Grain sizes: columns relative_density, and grain size (a mean diameter) with its unit, or mean intercept length, which is times
/// 1.56 (M. I. Mendelson, J. Am. Ceram. Soc. 52 (1969) 443); standard_error with a unit if there is one.
std::vector<analysis::GrainSize> read_grain_sizes(const std::string& file);

/// The runs of one body under one set of options.
struct Body {
    std::string name;          // of its first history
    std::size_t particles = 0;  // 0 where no state was given
    std::vector<analysis::SimulatedRun> runs;
};

/// The runs of the histories (lines of `sinter --history`) of the files. A state before a history is that of its run: it says
/// material, schedule, and by its own history which runs are of one body under the same options, apart from schedule, material
/// and what was written. A history without a state is of a body of its own; it, and one whose state names no
/// material, is of `material`. Throws Error naming file and line, and where there is none.
std::vector<Body> read_bodies(const std::vector<std::string>& files, const std::optional<Material>& material);

}  // namespace kiln::analyze
