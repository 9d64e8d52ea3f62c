// materials.cpp: the built-in materials and those of files: what they have, where it comes from, and what they lack for what.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <sstream>

#include "io/json_values.h"
#include "io/material_check.h"
#include "io/material_io.h"
#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/report.h"

namespace kiln::analyze {

namespace {

using physics::Use;

constexpr const char* materials_footer =
    "Keys of a result:\n"
    "  name, built_in\n"
    "  about          what it is, and what is missing and why\n"
    "  material       its constants, SI, as --material FILE.json of all programs reads them\n"
    "  constants      for each key of material {value, unit, meaning, source}\n"
    "  missing        for each use of a material the keys that it would need\n"
    "  remarks        sentences: keys that nothing reads, constants that no solid has\n\n"
    "Units of the keys and what they mean: docs/materials.md.\n\n"
    "Examples:\n"
    "  analyze materials --table\n"
    "  analyze materials --table nickel\n"
    "  analyze materials nickel | jq .material >mine.json\n"
    "  analyze materials zirconia.json | jq .missing";

constexpr Use all_uses[] = {Use::sintering, Use::surface_coarsening, Use::boundary_coarsening, Use::elasticity, Use::inertia};

const std::vector<Column> list_columns{{"name", "name", ""},
                                       {"density", "density, kg/m3", ""},
                                       {"surface_energy", "surface energy, J/m2", ""},
                                       {"young_modulus", "Young's modulus", "Pa"},
                                       {"poisson_ratio", "Poisson's ratio", ""},
                                       {"sinters", "sinters", ""},
                                       {"coarsens", "coarsens", ""},
                                       {"bends", "bends", ""}};
const std::vector<Column> constant_columns{{"key", "key", ""}, {"value", "value", ""}, {"unit", "unit", ""}};

/// Unit of a key of the format; of an object those of its prefactor and activation energy.
const char* unit_of(const std::string& key) {
    static const std::map<std::string, const char*> units{{"density", "kg/m3"},
                                                          {"surface_energy", "J/m2"},
                                                          {"atomic_volume", "m3"},
                                                          {"diffusion_parameter", "m5/(N s)"},
                                                          {"dihedral_angle", "rad"},
                                                          {"young_modulus", "Pa"},
                                                          {"poisson_ratio", "1"},
                                                          {"grain_boundary_diffusion", "m3/s, J/mol"},
                                                          {"surface_diffusion", "m3/s, J/mol"},
                                                          {"boundary_mobility", "m4/(J s), J/mol"}};
    return units.at(key);
}

/// What a material is and lacks; builtin: null for one of a file.
Json result_of(const Material& material, const physics::BuiltinMaterial* builtin) {
    const Json json = io::material_json(material);
    Json result{{"format", "dem-material"},
                {"version", io::format_version},
                {"name", material.name},
                {"built_in", builtin != nullptr},
                {"about", builtin ? Json(builtin->about) : Json()},
                {"material", json},
                {"constants", Json::object()},
                {"missing", Json::object()},
                {"remarks", Json::array()}};
    for (const std::string& key : io::material_keys()) {
        if (!json.contains(key)) continue;
        Json entry{{"value", json[key]}, {"unit", unit_of(key)}};
        if (builtin) {
            const auto found = std::ranges::find(builtin->sources, key, &physics::ConstantSource::key);
            entry["meaning"] = found->meaning;
            entry["source"] = found->source;
        }
        result["constants"][key] = std::move(entry);
    }
    for (const Use use : all_uses) result["missing"][physics::name_of(use)] = physics::missing_constants(material, use);
    for (const std::string& sentence : io::unknown_keys(material)) result["remarks"].push_back(sentence);
    for (const std::string& sentence : io::implausible_constants(material, {std::begin(all_uses), std::end(all_uses)}))
        result["remarks"].push_back(sentence);
    return result;
}

/// A row of the list of materials.
Json row_of(const Json& result) {
    Json row = result["material"];
    const auto able = [&](std::initializer_list<Use> uses) {
        return std::ranges::all_of(uses, [&](Use use) { return result["missing"][physics::name_of(use)].empty(); });
    };
    row["sinters"] = able({Use::sintering}) ? "yes" : "no";
    row["coarsens"] = able({Use::surface_coarsening, Use::boundary_coarsening}) ? "yes" : "no";
    row["bends"] = able({Use::elasticity}) ? "yes" : "no";
    return row;
}

/// A paragraph in lines of at most `width` characters, the first with the indent of two, the others of four.
std::string wrapped(const std::string& paragraph) {
    constexpr std::size_t width = 100;
    std::string text, line = " ";
    std::istringstream words(paragraph);
    for (std::string word; words >> word;) {
        if (line.size() + 1 + word.size() > width) {
            text += line + "\n";
            line = "   ";
        }
        line += " " + word;
    }
    return text + line + "\n";
}

/// All of one material as text.
std::string text_of(const Json& result) {
    std::string text = result["name"].get<std::string>() + "\n";
    if (!result["about"].is_null()) text += wrapped(result["about"].get<std::string>());
    std::vector<Json> rows;
    for (const auto& [key, entry] : result["constants"].items()) {
        Json value = entry["value"];
        if (value.is_object()) value = value["prefactor"].dump() + ", " + value["activation_energy"].dump();
        rows.push_back({{"key", key}, {"value", value}, {"unit", entry["unit"]}});
    }
    if (!rows.empty()) text += table_text(constant_columns, rows) + "\n";
    for (const auto& [key, entry] : result["constants"].items())
        if (entry.contains("source"))
            text += wrapped(key + ": " + entry["meaning"].get<std::string>() + " [" + entry["source"].get<std::string>() + "]");
    for (const auto& [use, keys] : result["missing"].items()) {
        if (keys.empty()) continue;
        std::string list;
        for (const Json& key : keys) list += (list.empty() ? "" : ", ") + key.get<std::string>();
        text += wrapped(use + " needs " + list);
    }
    for (const Json& remark : result["remarks"]) text += wrapped(remark.get<std::string>());
    return text;
}

}  // namespace

int materials(int argc, char** argv) {
    CLI::App app{"Lists the built-in materials with the sources of their constants, or says what the named ones and those of files "
                 "have and lack.",
                 "analyze materials"};
    app.footer(materials_footer);
    cli::Common common;
    bool table = false;
    std::vector<std::string> names;
    app.add_option("NAME", names, "Built-in material, or a file NAME.json that holds one; all built-in ones without it")
        ->type_name("");
    add_table(app, table);
    common.add_to(app, false, false);
    cli::parse(app, argc, argv, common);

    const bool list = names.empty();
    if (list) names = physics::builtin_names();
    Report report(common, table && list, list_columns);
    std::string text;
    for (const std::string& name : names) {
        const auto& all = physics::builtin_materials();
        const auto builtin = std::ranges::find(all, name, [](const physics::BuiltinMaterial& each) { return each.material.name; });
        const Json result = result_of(io::material_named(name), builtin == all.end() ? nullptr : &*builtin);
        if (table && !list)
            text += (text.empty() ? "" : "\n") + text_of(result);
        else
            report.add(table ? row_of(result) : result);
    }
    if (table && !list) {
        io::Output output(common.output, true);
        output.write_text(text);
        output.commit();
        return cli::done;
    }
    report.finish();
    return cli::done;
}

}  // namespace kiln::analyze
