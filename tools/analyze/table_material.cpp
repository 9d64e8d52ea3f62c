// table_material.cpp: what the bodies of tables consist of.
#include "tools/analyze/table_material.h"

#include <CLI/CLI.hpp>

#include "core/types.h"
#include "io/material_io.h"

namespace kiln::analyze {

void TableMaterial::add_to(CLI::App& app, const std::string& use) {
    app.add_option_function<std::string>(
           "--material", [this](const std::string& name) { material = io::material_named(name); },
           "What the bodies of tables consist of, a built-in material or a file NAME.json: " + use)
        ->type_name("NAME");
}

void TableMaterial::refuse_with_documents() const {
    if (material) throw Error("is no table, for which --material has no meaning");
}

}  // namespace kiln::analyze
