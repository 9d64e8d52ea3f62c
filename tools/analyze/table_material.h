// table_material.h: --material of subcommands that read tables of measurements: what the bodies in them consist of.
#pragma once

#include <optional>
#include <string>

#include "core/state.h"
#include "io/json.h"

namespace CLI {
class App;
}

namespace kiln::analyze {

struct TableMaterial {
    std::optional<Material> material;

    /// use: what of the material counts, for the help.
    void add_to(CLI::App& app, const std::string& use);

    /// Its name; null where none is given.
    [[nodiscard]] Json name() const { return material ? Json(material->name) : Json(); }

    /// Throws Error if one is given: a document says itself what its body consists of.
    void refuse_with_documents() const;
};

}  // namespace kiln::analyze
