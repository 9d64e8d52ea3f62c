// materials.cpp: the table of built-in materials.
#include "physics/materials.h"

#include <cmath>
#include <numbers>

#include "physics/diffusion.h"

namespace kiln::physics {

namespace {

// The tables of Frost and Ashby were read in transcriptions, two of copper, which agree, and one of nickel and silver; the book
// itself was not at hand, nor was that of Tyson and Miller, of whose nickel two transcriptions have 2.4 and 2.45 J/m2.
constexpr const char* dosta = "Dosta et al. 2017, Table 1 and section 5";
constexpr const char* besler = "used with this contact law by Besler et al. (refs. 5 and 6 of Dosta et al. 2017)";
constexpr const char* second_set = "second published set of the same group";
constexpr const char* frost = "H. J. Frost, M. F. Ashby, Deformation-Mechanism Maps, Pergamon 1982";
constexpr const char* tyson =
    "W. R. Tyson, W. A. Miller, Surf. Sci. 62 (1977) 267: from the liquid's surface tension, mean over all faces";
constexpr const char* standard = "standard value, handbooks";
constexpr const char* boundary_meaning = "delta D_0b and Q_b: width of a boundary times diffusion along it";

BuiltinMaterial alumina() {
    Material material;
    material.name = "alumina";
    material.density = 3950.0;
    material.surface_energy = 1.1;
    material.atomic_volume = 8.47e-30;
    material.diffusion_prefactor = 1.3e-8;
    material.activation_energy = 475e3;
    material.young_modulus = 400e9;
    material.poisson_ratio = 0.23;
    return {material,
            "alpha-alumina with the constants of Dosta et al. 2017; Kiln's default. It has no constants of coarsening.",
            {{"density", "of the dense solid", dosta},
             {"surface_energy", "of the free surface, mean over all faces", dosta},
             {"atomic_volume", "per atom: a fifth of Al2O3", dosta},
             {"grain_boundary_diffusion", boundary_meaning, besler},
             {"young_modulus", "of the dense solid at room temperature", dosta},
             {"poisson_ratio", "of the dense solid at room temperature", dosta}}};
}

/// The thickness of the surface layer, 3e-10 m, is taken as about one lattice spacing.
BuiltinMaterial alumina_dihedral() {
    BuiltinMaterial builtin = alumina();
    Material& material = builtin.material;
    material.name = "alumina-dihedral";
    material.surface_energy = 0.905;
    material.atomic_volume = 2.11e-29;
    material.dihedral_angle = 138.0 * std::numbers::pi / 180.0;
    material.surface_prefactor = 3e-10 * 0.09;
    material.surface_activation = 313.8e3;
    material.mobility_prefactor = 0.01;
    material.mobility_activation = 443e3;
    builtin.about = "alpha-alumina with the second published set of the same group: what coarsening needs is in it. Measured "
                    "surface diffusivities of alumina scatter by two decades.";
    builtin.sources[1] = {"surface_energy", "of the free surface, mean over all faces", second_set};
    builtin.sources[2] = {"atomic_volume", "per aluminium ion: half of Al2O3", second_set};
    builtin.sources.push_back({"surface_diffusion", "delta_s D_0s and Q_s: a layer of 0.3 nm, D_0s 0.09 m2/s", second_set});
    builtin.sources.push_back({"boundary_mobility", "M_0 and its activation energy", second_set});
    builtin.sources.push_back({"dihedral_angle", "where a boundary meets the surface, 138 degrees", second_set});
    return builtin;
}

/// The aggregate of Overton and Gaffney's cubic constants 168.4, 121.4, 75.4 GPa: the mean of Voigt's and Reuss's shear moduli,
/// 54.6 and 40.0 GPa, and the bulk modulus 137.1 GPa.
BuiltinMaterial copper() {
    Material material;
    material.name = "copper";
    material.density = 8960.0;
    material.surface_energy = 1.79;
    material.atomic_volume = 1.18e-29;
    material.diffusion_prefactor = 5.0e-15;
    material.activation_energy = 104e3;
    material.young_modulus = 127e9;
    material.poisson_ratio = 0.345;
    const char* overton = "W. C. Overton, J. Gaffney, Phys. Rev. 98 (1955) 969, Hill's mean of the crystal's constants at 300 K";
    return {material,
            "Pure copper. It has no constants of coarsening.",
            {{"density", "of the dense metal", standard},
             {"surface_energy", "of the solid's free surface, clean", tyson},
             {"atomic_volume", "per atom", frost},
             {"grain_boundary_diffusion", boundary_meaning, frost},
             {"young_modulus", "of the dense metal without texture", overton},
             {"poisson_ratio", "of the dense metal without texture", overton}}};
}

BuiltinMaterial nickel() {
    Material material;
    material.name = "nickel";
    material.density = 8908.0;
    material.surface_energy = 2.4;
    material.atomic_volume = 1.09e-29;
    material.diffusion_prefactor = 3.5e-15;
    material.activation_energy = 115e3;
    material.young_modulus = 200e9;
    material.poisson_ratio = 0.31;
    return {material,
            "Pure nickel. It has no constants of coarsening.",
            {{"density", "of the dense metal", standard},
             {"surface_energy", "of the solid's free surface, clean, to two digits", tyson},
             {"atomic_volume", "per atom", frost},
             {"grain_boundary_diffusion", boundary_meaning, frost},
             {"young_modulus", "of the dense metal without texture", standard},
             {"poisson_ratio", "of the dense metal without texture", standard}}};
}

BuiltinMaterial silver() {
    Material material;
    material.name = "silver";
    material.density = 10490.0;
    material.surface_energy = 1.25;
    material.atomic_volume = 1.71e-29;
    material.diffusion_prefactor = 4.5e-15;
    material.activation_energy = 90e3;
    return {material,
            "Pure silver, for sintering: no source of its elastic constants was at hand, and it has no constants of coarsening.",
            {{"density", "of the dense metal", standard},
             {"surface_energy", "of the solid's free surface, clean", tyson},
             {"atomic_volume", "per atom", frost},
             {"grain_boundary_diffusion", boundary_meaning, frost}}};
}

/// Surface and boundary have the enthalpies 2.21 and 0.73 J/m2, whose ratio is 2 cos(psi/2). A cation of (ZrO2)0.97(Y2O3)0.03 has
/// the molar mass (0.97 123.22 + 0.03 225.81)/1.03 = 122.6 g/mol.
BuiltinMaterial zirconia_3y() {
    Material material;
    material.name = "zirconia-3y";
    material.density = 6050.0;
    material.surface_energy = 2.21;
    material.atomic_volume = 3.37e-29;
    material.dihedral_angle = 2.0 * std::acos(0.5 * 0.73 / 2.21);
    material.young_modulus = 205e9;
    material.poisson_ratio = 0.30;
    const char* data_sheet = "manufacturers' tables of Y-TZP, where 205 to 210 GPa are usual";
    const char* calorimetry =
        "Phys. Chem. Chem. Phys. 11 (2009) 3039: calorimetry of yttria-stabilized zirconia, 2.21 +- 0.14 and 0.73 +- 0.19 J/m2";
    return {material,
            "Zirconia with 3 mol% yttria, 3Y-TZP. Its grain_boundary_diffusion is left to you: the activation energy of "
            "densification is 485 +- 12 kJ/mol (M. Mazaheri et al., Ceram. Int. 35 (2009) 547), but no source of a prefactor was "
            "at hand. analyze kinetics finds both from your dilatometer. Where only densities are asked for and not times, any "
            "diffusion_parameter does.",
            {{"density", "of the dense ceramic", data_sheet},
             {"surface_energy", "enthalpy of the anhydrous surface; a wet one has 1.60 J/m2", calorimetry},
             {"atomic_volume", "per cation, Zr or Y: from density and composition", "derived"},
             {"dihedral_angle", "from the enthalpies of surface and boundary, 161 degrees", calorimetry},
             {"young_modulus", "of the dense ceramic at room temperature", data_sheet},
             {"poisson_ratio", "of the dense ceramic at room temperature", data_sheet}}};
}

}  // namespace

const std::vector<BuiltinMaterial>& builtin_materials() {
    static const std::vector<BuiltinMaterial> all{alumina(), alumina_dihedral(), copper(), nickel(), silver(), zirconia_3y()};
    return all;
}

std::vector<std::string> builtin_names() {
    std::vector<std::string> names;
    for (const BuiltinMaterial& each : builtin_materials()) names.push_back(each.material.name);
    return names;
}

Material builtin_material(const std::string& name) {
    std::string known;
    for (const BuiltinMaterial& each : builtin_materials()) {
        if (each.material.name == name) return each.material;
        known += (known.empty() ? "" : ", ") + each.material.name;
    }
    throw Error("material '" + name + "' is not known; built in are " + known);
}

std::string name_of(Use use) {
    switch (use) {
        case Use::sintering: return "sintering";
        case Use::surface_coarsening: return "coarsening by surface diffusion";
        case Use::boundary_coarsening: return "coarsening by boundaries";
        case Use::elasticity: return "elasticity";
        case Use::inertia: return "inertia";
    }
    throw Error("there is no such use of a material");
}

std::vector<std::string> missing_constants(const Material& material, Use use) {
    std::vector<std::string> missing;
    const auto need = [&](bool there, const char* key) {
        if (!there) missing.emplace_back(key);
    };
    switch (use) {
        case Use::sintering:
            need(material.surface_energy.has_value(), "surface_energy");
            if (material.diffusion_parameter) break;
            need(material.atomic_volume.has_value(), "atomic_volume");
            need(material.diffusion_prefactor && material.activation_energy, "grain_boundary_diffusion");
            break;
        case Use::surface_coarsening:
            need(material.atomic_volume.has_value(), "atomic_volume");
            need(material.surface_prefactor && material.surface_activation, "surface_diffusion");
            break;
        case Use::boundary_coarsening:
            need(material.mobility_prefactor && material.mobility_activation, "boundary_mobility");
            need(material.dihedral_angle.has_value(), "dihedral_angle");
            break;
        case Use::elasticity:
            need(material.young_modulus.has_value(), "young_modulus");
            need(material.poisson_ratio.has_value(), "poisson_ratio");
            break;
        case Use::inertia: need(material.density.has_value(), "density"); break;
    }
    return missing;
}

double required(const std::optional<double>& value, const Material& material, const std::string& key) {
    if (!value) throw MissingConstant("material '" + material.name + "' has no " + key);
    return *value;
}

double diffusion_parameter_of(const Material& material, double temperature) {
    if (material.diffusion_parameter) return *material.diffusion_parameter;
    return diffusion_parameter(required(material.atomic_volume, material, "atomic_volume"),
                               required(material.diffusion_prefactor, material, "grain_boundary_diffusion.prefactor"),
                               required(material.activation_energy, material, "grain_boundary_diffusion.activation_energy"),
                               temperature);
}

double surface_diffusion_of(const Material& material, double temperature) {
    return diffusion_parameter(required(material.atomic_volume, material, "atomic_volume"),
                               required(material.surface_prefactor, material, "surface_diffusion.prefactor"),
                               required(material.surface_activation, material, "surface_diffusion.activation_energy"),
                               temperature);
}

double boundary_mobility_of(const Material& material, double temperature) {
    return boundary_mobility(required(material.mobility_prefactor, material, "boundary_mobility.prefactor"),
                             required(material.mobility_activation, material, "boundary_mobility.activation_energy"),
                             temperature);
}

}  // namespace kiln::physics
