// material_io.h: materials and pairs of materials in a document's header.
#pragma once

#include <string>
#include <vector>

#include "core/state.h"
#include "io/json.h"

namespace kiln::io {

/// The keys of a material that programs read, besides its name.
std::vector<std::string> material_keys();

/// JSON of one material, as it stands in a document.
Json material_json(const Material& material);

/// Material from JSON; place is for the message of the Error thrown for a value that is no finite number or out of its range.
Material material_from(const Json& json, const std::string& place);

/// The material of a state that names none, for programs that need no constants: alumina, with the key "assumed". It is not written
/// with the state; programs that need constants ask for it.
Material assumed_material();
bool is_assumed(const Material& material);

/// Whether all that a state has is that material.
bool names_no_material(const State& state);

/// What the particles of a state consist of, for results: "alumina", "alumina, zirconia"; null where the state does not say.
Json material_names(const State& state);

/// A built-in material by its name, or that of a file NAME.json. Throws Error for a name that is neither, or what the file holds.
Material material_named(const std::string& name);

/// The same for a pair of materials under "contacts".
Json material_pair_json(const MaterialPair& pair, const std::vector<Material>& materials);
MaterialPair material_pair_from(const Json& json, const std::vector<Material>& materials, const std::string& place);

}  // namespace kiln::io
