// materials_test.cpp: the built-in materials, what a use of a material needs, and what is said of keys and values that are wrong.
#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

#include "io/json.h"
#include "io/material_check.h"
#include "io/material_io.h"
#include "physics/diffusion.h"
#include "physics/materials.h"
#include "tests/physics/relative.h"

using namespace kiln;
using kiln::test::relative;
using physics::Use;

namespace {

const std::vector<Use> all{Use::sintering, Use::surface_coarsening, Use::boundary_coarsening, Use::elasticity, Use::inertia};

Material material_of(const char* json) { return io::material_from(Json::parse(json), "test"); }

}  // namespace

TEST_CASE("every constant of a built-in material has its meaning and its source, and no source is of nothing") {
    for (const physics::BuiltinMaterial& each : physics::builtin_materials()) {
        CAPTURE(each.material.name);
        CHECK(!each.about.empty());
        const Json json = io::material_json(each.material);
        for (const std::string& key : io::material_keys())
            CHECK(json.contains(key) == (std::ranges::count(each.sources, key, &physics::ConstantSource::key) == 1));
        CHECK(json.size() == each.sources.size() + 1);  // and the name
        for (const physics::ConstantSource& source : each.sources) CHECK((!source.meaning.empty() && !source.source.empty()));
        CHECK(io::unknown_keys(each.material).empty());
        CHECK(io::implausible_constants(each.material, all).empty());
    }
}

TEST_CASE("atomic volumes follow from density and molar mass, whatever the volume is of") {
    constexpr double avogadro = 6.02214076e23;
    struct Molar {
        const char* name;
        double mass;   // kg/mol of a formula unit
        double parts;  // of it that the volume is of
    };
    for (const Molar& each : {Molar{"alumina", 101.961e-3, 5.0}, Molar{"alumina-dihedral", 101.961e-3, 2.0},
                              Molar{"copper", 63.546e-3, 1.0}, Molar{"nickel", 58.693e-3, 1.0}, Molar{"silver", 107.868e-3, 1.0},
                              Molar{"zirconia-3y", 0.97 * 123.218e-3 + 0.03 * 225.81e-3, 1.03}}) {
        CAPTURE(each.name);
        const Material material = physics::builtin_material(each.name);
        CHECK(*material.atomic_volume == relative(each.mass / (*material.density * avogadro * each.parts), 0.02));
    }
}

TEST_CASE("the aggregate of copper is Hill's mean of its crystal's constants") {
    const double c11 = 168.4e9, c12 = 121.4e9, c44 = 75.4e9;
    const double bulk = (c11 + 2.0 * c12) / 3.0;
    const double voigt = (c11 - c12 + 3.0 * c44) / 5.0, reuss = 5.0 * (c11 - c12) * c44 / (4.0 * c44 + 3.0 * (c11 - c12));
    const double shear = 0.5 * (voigt + reuss);
    const Material copper = physics::builtin_material("copper");
    CHECK(*copper.young_modulus == relative(9.0 * bulk * shear / (3.0 * bulk + shear), 5e-3));
    CHECK(*copper.poisson_ratio == relative((3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear)), 5e-3));
}

TEST_CASE("what is missing for a use is all that the use asks for, and a constant Delta replaces what it is made of") {
    Material material;
    material.name = "m";
    using Keys = std::vector<std::string>;
    CHECK(physics::missing_constants(material, Use::sintering) ==
          Keys{"surface_energy", "atomic_volume", "grain_boundary_diffusion"});
    material.diffusion_parameter = 1e-35;
    CHECK(physics::missing_constants(material, Use::sintering) == Keys{"surface_energy"});
    CHECK(physics::missing_constants(material, Use::surface_coarsening) == Keys{"atomic_volume", "surface_diffusion"});
    CHECK(physics::missing_constants(material, Use::boundary_coarsening) == Keys{"boundary_mobility", "dihedral_angle"});
    CHECK(physics::missing_constants(material, Use::elasticity) == Keys{"young_modulus", "poisson_ratio"});
    CHECK(physics::missing_constants(material, Use::inertia) == Keys{"density"});
    CHECK(io::missing_sentence(material, all) ==
          "material 'm' has no surface_energy, which sintering needs, and no atomic_volume, surface_diffusion, which coarsening by "
          "surface diffusion needs, and no boundary_mobility, dihedral_angle, which coarsening by boundaries needs, and no "
          "young_modulus, poisson_ratio, which elasticity needs, and no density, which inertia needs");
    CHECK(io::missing_sentence(physics::builtin_material("alumina-dihedral"), all).empty());
}

TEST_CASE("a misspelt key is named with the one that it was meant for; remarks are not") {
    const auto said = [](const std::string& key) {
        const auto sentences = io::unknown_keys(material_of(("{\"name\":\"m\",\"" + key + "\":1}").c_str()));
        REQUIRE(sentences.size() <= 1);
        return sentences.empty() ? std::string() : sentences.front().substr(sentences.front().find("reads") + 5);
    };
    CHECK(said("surface_enrgy") == "; is surface_energy meant?");
    CHECK(said("Surface energy") == "; is surface_energy meant?");
    CHECK(said("youngs_modulus") == "; is young_modulus meant?");
    CHECK(said("young_modulus_GPa") == "; is young_modulus meant?");
    CHECK(said("poison_ratoi") == "; is poisson_ratio meant?");
    CHECK(said("boundary_mobilty") == "; is boundary_mobility meant?");
    CHECK(said("E").starts_with("; the keys are density, surface_energy"));
    CHECK(said("source").empty());
    CHECK(said("density").empty());
    CHECK(io::missing_sentence(material_of(R"({"name":"m","young_modulus":1e9,"poisson-ration":0.2})"), {Use::elasticity}) ==
          "material 'm' has no poisson_ratio, which elasticity needs; its 'poisson-ration' may be meant for poisson_ratio");
    CHECK_THROWS_WITH_AS(material_of(R"({"name":"m","surface_diffusion":{"prefactr":1,"activation_energy":2}})"),
                         "test: material 'm': surface_diffusion needs prefactor; it has prefactr, activation_energy", Error);
}

TEST_CASE("constants in the wrong unit are doubted, for the use at hand") {
    const Material material = material_of(R"({"name":"m","surface_energy":1000,"young_modulus":210,"dihedral_angle":138,
        "grain_boundary_diffusion":{"prefactor":1e-8,"activation_energy":580},"density":3.95,"atomic_volume":8.5e-6})");
    CHECK(io::implausible_constants(material, {Use::elasticity}) ==
          std::vector<std::string>{"material 'm': a young_modulus of 210.0 Pa is that of no solid; Pa are meant, not MPa or GPa"});
    const auto sintering = io::implausible_constants(material, {Use::sintering});
    REQUIRE(sintering.size() == 3);
    CHECK(sintering[0].find("surface_energy of 1000.0 J/m2") != std::string::npos);
    CHECK(sintering[1].find("atomic_volume") != std::string::npos);
    CHECK(sintering[2].find("activation_energy of 580.0 J/mol is that of no solid; J/mol are meant, not kJ/mol or eV") !=
          std::string::npos);
    CHECK(io::implausible_constants(material, all).size() == 6);
}
