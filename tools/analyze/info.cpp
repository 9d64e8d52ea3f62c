// info.cpp: what each document of a stream holds.
#include <CLI/CLI.hpp>

#include "io/array_types.h"
#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/report.h"
#include "analysis/structure.h"
#include "io/material_io.h"

namespace kiln::analyze {

namespace {

constexpr const char* info_footer =
    "Keys of a result:\n"
    "  document, kind\n"
    "  time (s), temperature (K), relative_density, particles, bonds (counts), box (m)\n"
    "  material, materials  names in one text (null where the state does not say); all constants\n"
    "  arrays               type and shape as they came\n"
    "  history, last_step   number of steps, and the last one\n"
    "  keys                 of a document that is not a state\n\n"
    "Examples:\n"
    "  analyze info sintered.kiln\n"
    "  analyze info sintered.kiln | jq .last_step.summary";

const std::vector<Column> info_columns{{"document", "document", ""},
                                  {"kind", "kind", ""},
                                  {"material", "material", ""},
                                  {"time", "time", "s"},
                                  {"relative_density", "relative density", ""},
                                  {"particles", "particles", ""},
                                  {"bonds", "bonds", ""}};

Json arrays_json(const std::vector<NamedArray>& arrays) {
    Json json = Json::object();
    for (const NamedArray& named : arrays) json[named.name] = {{"type", io::type_name(named.array)}, {"shape", named.array.shape}};
    return json;
}

void add_history(Json& entry, const Json& history) {
    if (!history.is_array()) return;
    entry["history"] = history.size();
    if (!history.empty()) entry["last_step"] = history.back();
}

Json state_info(io::Document document) {
    Json entry{{"format", "dem-info"}, {"version", io::format_version}, {"document", document.place}, {"kind", "dem-state"}};
    Json arrays{{"particles", arrays_json(document.particles)}};
    if (document.has_bonds) arrays["bonds"] = arrays_json(document.bonds);
    if (document.has_necks) arrays["necks"] = arrays_json(document.necks);
    const Json box = document.header["box"];
    const State state = io::state_from(std::move(document));
    const analysis::Density density = analysis::measured_density(state);
    entry["time"] = state.time;
    if (state.temperature) entry["temperature"] = *state.temperature;
    entry["relative_density"] = density.value ? Json(*density.value) : Json();
    entry["particles"] = state.particles.size();
    entry["bonds"] = state.bonds ? Json(state.bonds->size()) : Json();
    entry["box"] = box;
    entry["arrays"] = arrays;
    entry["material"] = io::material_names(state);
    entry["materials"] = Json::array();
    if (!io::names_no_material(state))
        for (const Material& material : state.materials) entry["materials"].push_back(io::material_json(material));
    add_history(entry, io::history_of(state));
    return entry;
}

Json other_info(const io::Document& document) {
    Json entry{{"format", "dem-info"}, {"version", io::format_version}, {"document", document.place}};
    entry["kind"] = document.header["format"];
    for (const char* key : {"material", "time", "relative_density"})
        if (document.header.contains(key)) entry[key] = document.header[key];
    entry["keys"] = Json::array();
    for (const auto& [key, value] : document.header.items()) entry["keys"].push_back(key);
    if (document.header.contains("history")) add_history(entry, document.header["history"]);
    return entry;
}

}  // namespace

int info(int argc, char** argv) {
    CLI::App app{"Says what each document of a stream holds.", "analyze info"};
    app.footer(info_footer);
    return report_each(app, argc, argv, info_columns, [](io::Document document) {
        const bool is_state = document.header.value("format", Json("dem-state")) == "dem-state";
        return is_state ? state_info(std::move(document)) : other_info(document);
    });
}

}  // namespace kiln::analyze
