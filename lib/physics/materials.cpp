// materials.cpp: the table of built-in materials.
#include "physics/materials.h"

#include <numbers>

#include "physics/diffusion.h"

namespace kiln::physics {

namespace {

/// Dosta et al. 2017, Table 1 (density, surface energy, atomic volume) and section 5 (elastic constants); grain boundary diffusion
/// of alumina as used with this contact model by Besler et al., refs. 5 and 6 there.
Material alumina() {
    Material material;
    material.name = "alumina";
    material.density = 3950.0;
    material.surface_energy = 1.1;
    material.atomic_volume = 8.47e-30;
    material.diffusion_prefactor = 1.3e-8;
    material.activation_energy = 475e3;
    material.young_modulus = 400e9;
    material.poisson_ratio = 0.23;
    return material;
}

/// Second published set of the same group: other surface energy and molecular volume, and a dihedral angle of 138 degrees. Of the
/// same set: surface diffusion D_0s = 0.09 m2/s with 313.8 kJ/mol, mobility of grain boundaries 0.01 m4/(J s) with 443 kJ/mol. The
/// thickness of the surface layer, 3e-10 m, is taken as about one lattice spacing. Measured surface diffusivities of alumina
/// scatter by two decades.
Material alumina_dihedral() {
    Material material = alumina();
    material.name = "alumina-dihedral";
    material.surface_energy = 0.905;
    material.atomic_volume = 2.11e-29;
    material.dihedral_angle = 138.0 * std::numbers::pi / 180.0;
    material.surface_prefactor = 3e-10 * 0.09;
    material.surface_activation = 313.8e3;
    material.mobility_prefactor = 0.01;
    material.mobility_activation = 443e3;
    return material;
}

}  // namespace

std::vector<std::string> builtin_names() { return {"alumina", "alumina-dihedral"}; }

Material builtin_material(const std::string& name) {
    if (name == "alumina") return alumina();
    if (name == "alumina-dihedral") return alumina_dihedral();
    std::string known;
    for (const std::string& each : builtin_names()) known += (known.empty() ? "" : ", ") + each;
    throw Error("material '" + name + "' is not known; built in are " + known);
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
