// fit_points.h: the points of a fit of modulus against porosity, from results of tests and from tables of measurements.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"
#include "io/document.h"
#include "tools/analyze/table_material.h"

namespace kiln::analyze {

struct Points {
    std::vector<double> porosity, modulus, error;  // -, Pa, Pa (NaN where there is none)
    std::vector<std::string> bond_law;             // of the test; empty where it does not say
    std::vector<std::string> test;                 // "bending", "cell", "voxels" of simulated bodies, "measured"
    std::vector<Json> material;                    // its name; null where nothing says it
    std::vector<std::string> warnings;             // of the tests, each once
};

/// Adds the point of a dem-modulus or dem-elastic document. Throws Error naming the key that is missing or out of range.
void add_point(Points& points, const io::Document& document);

/// Adds the points of a CSV: relative_density or porosity (plain numbers or %), young_modulus, and optionally standard_error, both
/// with units. Throws Error naming the file.
void add_table_points(Points& points, const std::string& file, const TableMaterial& material);

/// The points of all files, or of standard input: streams, and tables (io::is_csv). material: that of tables.
Points read_points(const std::vector<std::string>& files, const TableMaterial& material);

/// A list of {porosity, young_modulus, standard_error, test, material} and bond_law where it is known.
Json points_json(const Points& points);

}  // namespace kiln::analyze
