// state.h: one state of a particle assembly as a struct of arrays; docs/dem-state.5 describes its stream form.
#pragma once

#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "core/array.h"
#include "core/box.h"
#include "core/types.h"

namespace kiln {

/// Material data in SI units. A tool asks for what it needs and says which key of which material is missing.
struct Material {
    std::string name;
    std::optional<double> density;              // kg/m3
    std::optional<double> surface_energy;       // J/m2
    std::optional<double> atomic_volume;        // m3
    std::optional<double> diffusion_prefactor;  // delta D_0b, m3/s
    std::optional<double> activation_energy;    // of grain boundary diffusion, J/mol
    std::optional<double> diffusion_parameter;  // Delta, m5/(N s); constant, instead of the four above
    std::optional<double> surface_prefactor;    // delta_s D_0s of surface diffusion, m3/s
    std::optional<double> surface_activation;   // J/mol
    std::optional<double> mobility_prefactor;   // M_0 of grain boundaries, m4/(J s)
    std::optional<double> mobility_activation;  // J/mol
    std::optional<double> dihedral_angle;       // rad
    std::optional<double> young_modulus;        // Pa
    std::optional<double> poisson_ratio;
    std::string other = "{}";  // JSON of unknown keys, carried through; only lib/io looks inside
};

/// What holds between two unlike materials, in place of the mixing rule.
struct MaterialPair {
    std::array<std::int32_t, 2> materials;      // rows of State::materials
    std::optional<double> surface_energy;       // J/m2
    std::optional<double> diffusion_parameter;  // Delta, m5/(N s)
};

struct Particles {
    std::vector<std::int64_t> id;
    std::vector<Vec3> position;  // m
    std::vector<double> radius;  // m
    std::vector<std::int32_t> material;
    std::vector<NamedArray> other;  // unknown arrays, carried through

    std::size_t size() const { return radius.size(); }
};

struct Bonds {
    std::vector<std::array<std::int32_t, 2>> pair;  // rows of Particles
    std::vector<Image> image;                       // added to the position of the pair's second particle
    std::vector<double> radius;                     // m
    std::vector<double> length;                     // m, Eq. 4 of Dosta et al. 2017
    std::vector<double> volume;                     // m3, solid beside that of the particles; none for necks
    std::vector<NamedArray> other;

    std::size_t size() const { return radius.size(); }
};

/// Contacts whose neck is not the one that the sintering law gives to the overlap of their spheres, since the grains have changed
/// in size or surface diffusion has widened the neck. A contact that is not listed has a = sqrt(4 R* h).
struct Necks {
    std::vector<std::array<std::int32_t, 2>> pair;  // rows of Particles
    std::vector<Image> image;                       // added to the position of the pair's second particle
    std::vector<double> radius;                     // m
    std::vector<NamedArray> other;

    std::size_t size() const { return radius.size(); }
};

struct State {
    double time = 0.0;                  // s
    std::optional<double> temperature;  // K
    Box box;
    std::vector<Material> materials;
    std::vector<MaterialPair> contacts;
    Particles particles;
    std::optional<Bonds> bonds;
    std::optional<Necks> necks;
    std::string history = "[]";  // JSON, a list with what each program did; only lib/io looks inside
    std::string other = "{}";    // JSON of unknown keys of the document, carried through
};

/// Volume of a sphere, m3, of its radius, m.
inline double sphere_volume(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

/// Sum of the particles' volumes, m3 (overlaps counted twice, as mass is).
double particle_volume(const Particles& particles);

/// Solid volume of particles and bonds over the volume of the box.
double relative_density(const State& state);

/// Centre of the bond's second particle seen from its first, m.
Vec3 bond_vector(const State& state, const Bonds& bonds, std::size_t bond);

/// The given rows of the particles, every array included, in the given order.
Particles take_rows(const Particles& particles, const std::vector<std::int32_t>& rows);

/// The given rows of the bonds, every array included; pairs keep their particle rows.
Bonds take_rows(const Bonds& bonds, const std::vector<std::int32_t>& rows);

}  // namespace kiln
