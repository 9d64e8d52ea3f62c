// porosity_laws.h: how Young's modulus falls with porosity.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kiln::physics {

struct Parameter {
    std::string name;  // the key of results
    std::string unit;  // "Pa", or "" for a plain number
};

/// The form in which a law of two parameters is a straight line, y = intercept + slope x; a fit through it gives their first guess.
struct StraightForm {
    double (*x)(double porosity);
    double (*y)(double porosity, double modulus);
    std::vector<double> (*parameters)(double intercept, double slope);
};

/// A law E(P): porosity P = 1 - relative density, modulus in Pa.
struct PorosityLaw {
    std::string name;
    std::string formula;  // for help and results
    std::string source;
    std::vector<Parameter> parameters;
    double (*modulus)(double porosity, std::span<const double> parameters);
    std::optional<StraightForm> straight;  // nothing: E0 times a function of the porosity alone
    bool same_as_another = false;          // left out where all laws are compared
};

/// All laws; to add one is to add an entry.
const std::vector<PorosityLaw>& porosity_laws();

/// Law by name; throws Error that lists the known names.
const PorosityLaw& porosity_law(const std::string& name);

/// A curve of the literature to compare with; its values are those of its source.
struct ReferenceCurve {
    std::string name, formula, source;
    double max_porosity;             // up to which it is meant
    double (*modulus)(double porosity);  // Pa
};

const std::vector<ReferenceCurve>& reference_curves();

}  // namespace kiln::physics
