// material_option.cpp: materials of the command line in a document, and the question where none is named.
#include "tools/common/material_option.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "io/material_check.h"
#include "io/material_io.h"
#include "io/state_io.h"
#include "physics/materials.h"
#include "tools/common/each_state.h"

namespace kiln::cli {

namespace {

constexpr const char* say_what = "; --material NAME or FILE.json says what it is";

}  // namespace

void MaterialOption::add_to(CLI::App& app) {
    app.add_option_function<std::string>(
           "--material",
           [this](const std::string& list) {
               materials_.clear();
               std::istringstream names(list);
               for (std::string name; std::getline(names, name, ',');) materials_.push_back(io::material_named(name));
               if (materials_.empty()) materials_.push_back(io::material_named(list));  // nothing, which is no name
           },
           "Materials in place of those of the state, in their order: built-in ones (analyze materials lists them), or files "
           "NAME.json; a state that names none needs it")
        ->type_name("NAME,...");
}

State MaterialOption::state_from(io::Document document) const {
    const std::string place = document.place;
    Json& header = document.header;
    const bool named = header.contains("materials") && header["materials"].is_array() && !header["materials"].empty();
    if (!materials_.empty()) {
        if (named && header["materials"].size() != materials_.size())
            throw io::PlacedError(place + ": has " + std::to_string(header["materials"].size()) +
                                  " materials, and --material names " + std::to_string(materials_.size()));
        Json materials = Json::array();
        for (const Material& material : materials_) materials.push_back(io::material_json(material));
        header["materials"] = std::move(materials);
    }
    for (const Material& material : materials_)
        for (const std::string& sentence : io::unknown_keys(material)) warn_once(sentence);
    State state = io::state_from(std::move(document));
    if (state.particles.size() > 0 && std::ranges::any_of(state.materials, io::is_assumed))
        throw io::PlacedError(place + ": names no material" + say_what);
    check(state, place);
    return state;
}

void MaterialOption::check(const State& state, const std::string& place) const {
    std::vector<char> used(state.materials.size());
    for (const std::int32_t row : state.particles.material) used[static_cast<std::size_t>(row)] = 1;
    for (std::size_t row = 0; row < used.size(); ++row) {
        if (!used[row]) continue;
        const Material& material = state.materials[row];
        for (const std::string& sentence : io::implausible_constants(material, uses_)) warn_once(sentence);
        const std::string missing = io::missing_sentence(material, uses_);
        if (!missing.empty()) throw io::PlacedError(place + ": " + missing + say_what);
    }
}

void MaterialOption::warn_once(const std::string& sentence) const {
    if (warn_ && told_.insert(sentence).second) warn_(sentence);
}

void for_each_state(io::Input& input, const MaterialOption& material,
                    const std::function<bool(State, const std::string& place)>& work) {
    while (auto document = next_document(input)) {
        const std::string place = document->place;
        State state = material.state_from(std::move(*document));
        const auto with_advice = [&] {
            try {
                return work(std::move(state), place);
            } catch (const physics::MissingConstant& missing) {
                throw Error(missing.what() + std::string(say_what));
            }
        };
        if (!at_place(place, with_advice)) return;
    }
}

}  // namespace kiln::cli
