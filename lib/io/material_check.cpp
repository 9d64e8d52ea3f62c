// material_check.cpp: near keys, usual ranges of constants, and sentences on them.
#include "io/material_check.h"

#include <algorithm>
#include <cctype>
#include <numbers>
#include <set>

#include "io/json_values.h"
#include "io/material_io.h"

namespace kiln::io {

using physics::Use;

namespace {

constexpr const char* remarks[] = {"about", "assumed", "colour", "color",  "comment", "doi",     "formula",
                                   "note",  "notes",   "remark", "source", "sources", "reference"};

/// Where the constant of a solid lies, with a margin of a decade or more beyond what is known; and what a value outside may be.
struct Range {
    Use use;
    const char* key;
    std::optional<double> Material::*member;
    double lowest, highest;
    const char* unit;
    const char* advice;
};

constexpr Range ranges[] = {
    {Use::sintering, "surface_energy", &Material::surface_energy, 0.01, 20.0, "J/m2", "J/m2 are meant, not mJ/m2 or erg/cm2"},
    {Use::sintering, "atomic_volume", &Material::atomic_volume, 2e-30, 1e-27, "m3",
     "m3 per atom or molecule are meant, not m3/mol"},
    {Use::sintering, "grain_boundary_diffusion.prefactor", &Material::diffusion_prefactor, 1e-26, 10.0, "m3/s",
     "delta D_0b in m3/s is meant, a width times a diffusivity"},
    {Use::sintering, "grain_boundary_diffusion.activation_energy", &Material::activation_energy, 1e4, 3e6, "J/mol",
     "J/mol are meant, not kJ/mol or eV"},
    {Use::sintering, "diffusion_parameter", &Material::diffusion_parameter, 0.0, 1e-18, "m5/(N s)",
     "m5/(N s) are meant; alumina at 1200 C has 8e-35"},
    {Use::surface_coarsening, "surface_diffusion.prefactor", &Material::surface_prefactor, 1e-26, 10.0, "m3/s",
     "delta_s D_0s in m3/s is meant, a width times a diffusivity"},
    {Use::surface_coarsening, "surface_diffusion.activation_energy", &Material::surface_activation, 1e4, 3e6, "J/mol",
     "J/mol are meant, not kJ/mol or eV"},
    {Use::boundary_coarsening, "boundary_mobility.activation_energy", &Material::mobility_activation, 1e4, 3e6, "J/mol",
     "J/mol are meant, not kJ/mol or eV"},
    {Use::boundary_coarsening, "dihedral_angle", &Material::dihedral_angle, 0.35, std::numbers::pi, "rad",
     "radians are meant, not degrees"},
    {Use::elasticity, "young_modulus", &Material::young_modulus, 1e6, 3e12, "Pa", "Pa are meant, not MPa or GPa"},
    {Use::elasticity, "poisson_ratio", &Material::poisson_ratio, -1.0, 0.4999, "", "it lies between -1 and 0.5"},
    {Use::inertia, "density", &Material::density, 100.0, 3e4, "kg/m3", "kg/m3 are meant, not g/cm3"},
};

/// Letters to insert, to leave out, to change or to exchange with the next one, to make one word of the other.
std::size_t edits(const std::string& first, const std::string& second) {
    std::vector<std::vector<std::size_t>> cost(first.size() + 1, std::vector<std::size_t>(second.size() + 1));
    for (std::size_t i = 0; i <= first.size(); ++i)
        for (std::size_t j = 0; j <= second.size(); ++j) {
            if (i == 0 || j == 0) {
                cost[i][j] = i + j;
                continue;
            }
            const bool same = first[i - 1] == second[j - 1];
            cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + (same ? 0 : 1)});
            if (i > 1 && j > 1 && first[i - 1] == second[j - 2] && first[i - 2] == second[j - 1])
                cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
        }
    return cost.back().back();
}

/// The key of the format that a word was meant for; empty if none is near.
std::string meant(std::string word) {
    std::ranges::transform(word, word.begin(), [](unsigned char letter) {
        return letter == '-' || letter == ' ' ? '_' : static_cast<char>(letter < 128 ? std::tolower(letter) : letter);
    });
    std::string nearest;
    std::size_t fewest = 0;
    for (const std::string& key : material_keys()) {
        const std::size_t distance = edits(word, key);
        // A third of the letters may be wrong, or the word begins with the key, as young_modulus_GPa does.
        if (distance > word.size() / 3 && !word.starts_with(key)) continue;
        if (!nearest.empty() && distance >= fewest) continue;
        nearest = key;
        fewest = distance;
    }
    return nearest;
}

/// Unknown keys, and what each was meant for.
std::vector<std::pair<std::string, std::string>> strangers(const Material& material) {
    std::vector<std::pair<std::string, std::string>> found;
    const Json other = carried_json(material.other, "the unknown keys of material '" + material.name + "'");
    const std::vector<std::string> known = material_keys();
    for (const auto& [key, value] : other.items()) {
        // What is left of a known object are remarks beside its numbers.
        if (std::ranges::find(known, key) == known.end() && std::ranges::find(remarks, key) == std::end(remarks))
            found.emplace_back(key, meant(key));
    }
    return found;
}

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

}  // namespace

std::vector<std::string> unknown_keys(const Material& material) {
    std::vector<std::string> sentences;
    for (const auto& [key, near] : strangers(material))
        sentences.push_back("material '" + clipped(material.name) + "' has a key '" + clipped(key) + "' that nothing reads" +
                            (near.empty() ? "; the keys are " + listed(material_keys()) : "; is " + near + " meant?"));
    return sentences;
}

std::vector<std::string> implausible_constants(const Material& material, const std::vector<Use>& uses) {
    std::vector<std::string> sentences;
    for (const Range& range : ranges) {
        const std::optional<double>& value = material.*range.member;
        if (!value || std::ranges::find(uses, range.use) == uses.end()) continue;
        if (*value >= range.lowest && *value <= range.highest) continue;
        const std::string unit = *range.unit ? " " + std::string(range.unit) : "";
        sentences.push_back("material '" + clipped(material.name) + "': a " + range.key + " of " + shown(*value) + unit +
                            " is that of no solid; " + range.advice);
    }
    return sentences;
}

std::string missing_sentence(const Material& material, const std::vector<Use>& uses) {
    std::string text;
    std::set<std::string> lacking;
    for (const Use use : uses) {
        std::vector<std::string> missing = physics::missing_constants(material, use);
        std::erase_if(missing, [&](const std::string& key) { return !lacking.insert(key).second; });
        if (missing.empty()) continue;
        text += (text.empty() ? "material '" + clipped(material.name) + "' has no " : ", and no ") + listed(missing) + ", which " +
                physics::name_of(use) + " needs";
    }
    for (const auto& [key, near] : strangers(material))
        if (lacking.contains(near)) text += "; its '" + clipped(key) + "' may be meant for " + near;
    return text;
}

}  // namespace kiln::io
