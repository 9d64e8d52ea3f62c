// fit_points.cpp: points of a fit, from documents and tables.
#include "tools/analyze/fit_points.h"

#include <algorithm>
#include <cmath>

#include "io/csv.h"
#include "tools/analyze/report.h"
#include "tools/analyze/results.h"

namespace kiln::analyze {

namespace {

/// Young's modulus: "modulus of rupture" is a strength, "shear modulus" another constant.
const io::ColumnNames modulus_names{
    "young_modulus", "young's modulus", "young modulus", "youngs modulus", "elastic modulus", "elastic_modulus",
    "modulus of elasticity", "modulus$", "e-modulus", "e modulus", "e_modulus", "emodulus", "e-modul", "e modul", "e_modul",
    "emodul", "elastizit\u00e4tsmodul", "e$"};

/// How a modulus was found.
std::string test_of(const io::Document& document) {
    if (document.header["format"] == "dem-elastic")
        return document.header.value("model", Json()) == "voxel" ? "voxels" : "cell";
    return document.header.value("method", Json()) == "experiment" ? "measured" : "bending";
}

}  // namespace

void add_point(Points& points, const io::Document& document) {
    expect_format(document, {"dem-modulus", "dem-elastic"}, "fit");
    const double density = positive_at(document, "relative_density");
    if (density > 1.0) throw Error("relative_density is " + Json(density).dump() + ", more than 1");
    points.porosity.push_back(1.0 - density);
    points.modulus.push_back(positive_at(document, "young_modulus"));
    const bool has_error = document.header.contains("standard_error") && !document.header["standard_error"].is_null();
    points.error.push_back(has_error ? number_at(document, "standard_error", 0.0) : std::nan(""));
    const bool has_law = document.header.contains("bond_law") && document.header["bond_law"].is_string();
    points.bond_law.push_back(has_law ? document.header["bond_law"].get<std::string>() : "");
    points.test.push_back(test_of(document));
    const Json material = document.header.value("material", Json());
    points.material.push_back(material.is_string() ? material : Json());
    for (const std::string& sentence : warnings_at(document))
        if (std::ranges::find(points.warnings, sentence) == points.warnings.end()) points.warnings.push_back(sentence);
}

void add_table_points(Points& points, const std::string& file, const TableMaterial& material) {
    const io::CsvTable table(file);
    std::optional<std::vector<double>> porosity = table.column({"porosity", "porosit\u00e4t"}, io::Dimension::fraction);
    if (!porosity) {
        porosity = table.required({"relative_density", "relative density", "rel. density", "relative dichte", "density"},
                                  io::Dimension::fraction);
        for (double& value : *porosity) value = 1.0 - value;
    }
    const std::vector<double> modulus = table.required(modulus_names, io::Dimension::pressure);
    const auto error = table.column({"standard_error", "standard error", "standardfehler", "error"}, io::Dimension::pressure);
    for (std::size_t row = 0; row < modulus.size(); ++row) {
        const std::string place = table.place(row);
        if (!((*porosity)[row] >= 0.0 && (*porosity)[row] < 1.0))
            throw Error(place + ": the porosity is " + Json((*porosity)[row]).dump() +
                        ", expected 0 or more and less than 1; a heading such as 'porosity (%)' says that numbers are percent");
        if (!(modulus[row] > 0.0))
            throw Error(place + ": the modulus is " + Json(modulus[row]).dump() + " Pa, expected a positive number");
        if (error && (*error)[row] < 0.0) throw Error(place + ": the standard error is negative");
        points.porosity.push_back((*porosity)[row]);
        points.modulus.push_back(modulus[row]);
        points.error.push_back(error ? (*error)[row] : std::nan(""));
        points.bond_law.emplace_back();
        points.test.push_back("measured");
        points.material.push_back(material.name());
    }
}

Points read_points(const std::vector<std::string>& files, const TableMaterial& material) {
    Points points;
    for_each_input(files, [&](const io::Document& document) { add_point(points, document); },
                   [&](const std::string& file) { add_table_points(points, file, material); });
    return points;
}

Json points_json(const Points& points) {
    Json list = Json::array();
    for (std::size_t point = 0; point < points.modulus.size(); ++point) {
        list.push_back({{"porosity", points.porosity[point]},
                        {"young_modulus", points.modulus[point]},
                        {"standard_error", std::isnan(points.error[point]) ? Json() : Json(points.error[point])},
                        {"test", points.test[point]},
                        {"material", points.material[point]}});
        if (!points.bond_law[point].empty()) list.back()["bond_law"] = points.bond_law[point];
    }
    return list;
}

}  // namespace kiln::analyze
