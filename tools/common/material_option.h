// material_option.h: --material of programs that need constants of the solid: what a state consists of that does not say so itself.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "io/files.h"
#include "physics/materials.h"

namespace CLI {
class App;
}

namespace kiln::cli {

/// A state that names no material has to be told what it is by programs that need its constants; the others let it pass.
class MaterialOption {
   public:
    void add_to(CLI::App& app);

    /// Who is told what is to be known of a material; nobody by default.
    void warn_by(std::function<void(const std::string& sentence)> warn) { warn_ = std::move(warn); }

    /// What will be done with the materials: state_from() refuses those that lack a constant of it, with all that they lack, before
    /// anything is computed, and warns of constants that no solid has.
    void needed_for(std::vector<physics::Use> uses) { uses_ = std::move(uses); }

    /// The state of a document: with the materials of --material in place of its own, in the same order, where there are any.
    /// Throws PlacedError as io::state_from() does, where their number is another, and where neither names any.
    State state_from(io::Document document) const;

   private:
    void check(const State& state, const std::string& place) const;
    void warn_once(const std::string& sentence) const;

    std::vector<Material> materials_;
    std::vector<physics::Use> uses_;
    mutable std::set<std::string> told_;
    std::function<void(const std::string&)> warn_;
};

/// for_each_state() for a program with --material.
void for_each_state(io::Input& input, const MaterialOption& material,
                    const std::function<bool(State, const std::string& place)>& work);

}  // namespace kiln::cli
