// elastic.cpp: elastic tensor of periodic states of bonded particles, as a network of bonds or on voxels, and of images.
#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/stiffness_bound.h"
#include "io/material_io.h"
#include "io/state_io.h"
#include "mechanics/elastic_tensor.h"
#include "physics/materials.h"
#include "physics/solid_law.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/report.h"
#include "tools/analyze/voxel_options.h"
#include "tools/common/bond_model.h"
#include "tools/common/material_option.h"
#include "tools/common/quantity_options.h"
#include "tools/common/solver_option.h"
#include "tools/common/value_options.h"

namespace kiln::analyze {

namespace {

constexpr const char* elastic_footer =
    "Keys of a result:\n"
    "  material        names in one text; null of an image\n"
    "  model, relative_density, iterations, residual, converged\n"
    "  stiffness       6x6, Pa; xx, yy, zz, yz, xz, xy, engineering shear\n"
    "  young_modulus (Pa), poisson_ratio  of its isotropic (Voigt) average\n"
    "  shear_modulus, bulk_modulus (Pa)  of the same\n"
    "  axial_moduli, axial_modulus  Young's moduli along x, y, z, Pa; their mean\n"
    "  anisotropy      0 for an isotropic tensor (Ranganathan & Ostoja-Starzewski 2008)\n"
    "of a network also\n"
    "  bond_law, bond_shear\n"
    "  fragments, fragment_particles, rattlers  pieces beside the largest; single particles\n"
    "  negligible_bonds  too thin to count\n"
    "  affine, affine_young_modulus  of particles that follow the strain: an upper bound of the network\n"
    "  bound           Pa, of Hashin & Shtrikman: no isotropic body of that density is stiffer\n"
    "  warnings        sentences: a modulus above the bound\n"
    "of voxels also\n"
    "  extrapolation_error (Pa, of young_modulus), poisson_ratio_error, axial_modulus_error\n"
    "  union_fraction  of the box, by spheres and bonds together\n"
    "  grids           what each grid gave {voxels (a mean radius), count, union_fraction,\n"
    "                  loose_fraction (not connected to the rest), iterations, residual, young_modulus,\n"
    "                  poisson_ratio, axial_modulus}\n"
    "A gap between two spheres stays open on voxels that are wider than it. An image is taken as it is: nothing is extrapolated, "
    "and "
    "where few voxels cross a neck it is too stiff.\n\n"
    "Examples:\n"
    "  bondify sintered.kiln | analyze elastic --table\n"
    "  bondify --method necks sintered.kiln | analyze elastic --table\n"
    "  analyze elastic --bond-law neck bonded.kiln | jq .young_modulus\n"
    "  analyze select --density 0.79 sintered.kiln | bondify --method necks |\n"
    "      analyze elastic --model voxel --voxels 4,6 --table\n"
    "  analyze select --density 0.79 sintered.kiln | analyze voxel --voxels 5 -o body.npy\n"
    "  analyze elastic --model voxel --image body.npy --young-modulus 400GPa --poisson-ratio 0.23";

const std::vector<Column> elastic_network_columns{{"material", "material", ""},
                                                  {"relative_density", "relative density", ""},
                                                  {"young_modulus", "Young's modulus", "Pa"},
                                                  {"poisson_ratio", "Poisson's ratio", ""},
                                                  {"anisotropy", "anisotropy", ""},
                                                  {"affine_young_modulus", "affine bound", "Pa"},
                                                  {"bound", "isotropic bound", "Pa"},
                                                  {"bond_law", "bond law", ""},
                                                  {"iterations", "iterations", ""}};

const std::vector<Column> elastic_voxel_columns{{"material", "material", ""},
                                                  {"relative_density", "relative density", ""},
                                                {"union_fraction", "union", ""},
                                                {"young_modulus", "Young's modulus", "Pa"},
                                                {"extrapolation_error", "+-", "Pa"},
                                                {"poisson_ratio", "Poisson's ratio", ""},
                                                {"poisson_ratio_error", "+-", ""},
                                                {"anisotropy", "anisotropy", ""},
                                                {"iterations", "iterations", ""}};

Json averages_json(const mechanics::Mat6& stiffness) {
    const mechanics::IsotropicAverage average = mechanics::isotropic_average(stiffness);
    const Vec3 axial = mechanics::axial_moduli(stiffness);
    return {{"young_modulus", average.young_modulus},
            {"poisson_ratio", average.poisson_ratio},
            {"shear_modulus", average.shear_modulus},
            {"bulk_modulus", average.bulk_modulus},
            {"anisotropy", average.anisotropy},
            {"axial_moduli", {axial[0], axial[1], axial[2]}},
            {"axial_modulus", axial.mean()},
            {"stiffness", rows_of(stiffness)}};
}

/// Mean of the solids' moduli over the volume of the particles: no mixture of them is stiffer.
physics::IsotropicModuli solid_of(const State& state) {
    physics::IsotropicModuli sum{0.0, 0.0};
    double volume = 0.0;
    for (std::size_t row = 0; row < state.particles.size(); ++row) {
        const Material& material = state.materials[static_cast<std::size_t>(state.particles.material[row])];
        const physics::IsotropicModuli solid =
            physics::isotropic_moduli(physics::required(material.young_modulus, material, "young_modulus"),
                                      physics::required(material.poisson_ratio, material, "poisson_ratio"));
        const double share = std::pow(state.particles.radius[row], 3.0);
        sum.bulk += share * solid.bulk;
        sum.shear += share * solid.shear;
        volume += share;
    }
    return {sum.bulk / volume, sum.shear / volume};
}

/// The stiffness of a network; with the law solid its Poisson's ratio has what the springs leave out.
mechanics::Mat6 stiffness_of(const State& state, const mechanics::Mat6& springs, physics::BondLaw law) {
    if (law != physics::BondLaw::solid) return springs;
    double sum = 0.0;
    for (const std::int32_t row : state.particles.material) {
        const Material& material = state.materials[static_cast<std::size_t>(row)];
        sum += physics::required(material.poisson_ratio, material, "poisson_ratio");
    }
    const double shift = physics::poisson_shift(sum / static_cast<double>(state.particles.size()), relative_density(state));
    return mechanics::with_poisson_ratio(springs, mechanics::isotropic_average(springs).poisson_ratio + shift);
}

Json of_network(const State& state, const mechanics::BondModel& model, double tolerance, const cli::SolverOption& solver) {
    const auto& periodic = state.box.periodic;
    if (!std::all_of(periodic.begin(), periodic.end(), [](bool axis) { return axis; }))
        throw Error(
            "the box is not periodic along all axes, so the state has no elastic tensor; bend tests bodies with free faces");
    mechanics::BondedBody body = mechanics::bonded_body(state, model);
    const mechanics::ElasticTensor tensor =
        mechanics::elastic_tensor(std::move(body.network), state.box.volume(), tolerance, solver.stop(), solver.solver());
    Json result{{"format", "dem-elastic"},
                {"version", io::format_version},
                {"model", "network"},
                {"relative_density", relative_density(state)},
                {"bond_law", physics::name_of(*body.model.law)},
                {"bond_shear", body.model.shear ? Json(physics::name_of(*body.model.shear)) : Json()}};
    result.update(averages_json(stiffness_of(state, tensor.stiffness, *body.model.law)));
    result.update(Json{{"affine", rows_of(tensor.affine)},
                       {"affine_young_modulus", mechanics::isotropic_average(tensor.affine).young_modulus},
                       {"iterations", tensor.iterations},
                       {"residual", tensor.residual},
                       {"converged", tensor.converged},
                       {"fragments", body.fragments},
                       {"fragment_particles", body.fragment_particles},
                       {"rattlers", body.rattlers},
                       {"negligible_bonds", body.negligible_bonds}});
    const physics::IsotropicModuli solid = solid_of(state);
    const double density = result["relative_density"];
    result["bound"] = analysis::young_bound(solid, density);
    result["warnings"] = Json::array();
    if (const auto sentence = analysis::above_bound_warning(result["young_modulus"], solid, density))
        result["warnings"].push_back(*sentence);
    return result;
}

Json of_voxels(const std::vector<voxel::OnGrid>& grids, double density, voxel::Order order) {
    const Limits limits(grids, order);
    Json list = Json::array();
    std::vector<double> young, poisson, axial;
    for (const voxel::OnGrid& grid : grids) {
        Json each = grid_json(grid);
        const Json averages = averages_json(grid.found.tensor);
        for (const char* key : {"young_modulus", "poisson_ratio", "axial_modulus"}) each[key] = averages[key];
        young.push_back(each["young_modulus"]);
        poisson.push_back(each["poisson_ratio"]);
        axial.push_back(each["axial_modulus"]);
        list.push_back(std::move(each));
    }
    const mechanics::Mat6 stiffness = limits.tensor();
    if (!(stiffness.selfadjointView<Eigen::Lower>().ldlt().vectorD().minCoeff() > 0.0))
        throw Error("the grids are too coarse for this state: extrapolated, some strain meets no resistance");
    Json result{{"format", "dem-elastic"}, {"version", io::format_version}, {"model", "voxel"}, {"relative_density", density}};
    result.update(averages_json(stiffness));
    result.update(Json{{"extrapolation_error", limits.of(young).error},
                       {"poisson_ratio_error", limits.of(poisson).error},
                       {"axial_modulus_error", limits.of(axial).error}});
    result.update(solves_json(grids));
    result["grids"] = std::move(list);
    return result;
}

}  // namespace

int elastic(int argc, char** argv) {
    cli::Common common;
    bool table = false;
    double young = 0.0, poisson = 0.0;
    VoxelOptions options;
    mechanics::BondModel model;
    CLI::App app{"Finds the elastic tensor of every state, a periodic cell under six strains, or of an image.", "analyze elastic"};
    app.footer(elastic_footer);
    add_table(app, table);
    options.add_to(app, "springs between the particles, by --bond-law", "Unbalanced force over load");
    cli::add_bond_model(app, model);
    cli::SolverOption solver;
    solver.add_to(app);
    cli::add_quantity(app, "--young-modulus", young, io::Dimension::pressure, "With --image: Young's modulus of the solid");
    cli::add_number(app, "--poisson-ratio", poisson, {-0.999, 0.499}, "With --image: Poisson's ratio of the solid")
        ->default_str("");
    cli::MaterialOption material;
    material.add_to(app);
    common.add_to(app, true, false);
    cli::parse(app, argc, argv, common);
    options.check(app, {"--bond-law", "--bond-shear", "--solver"}, {"--young-modulus", "--poisson-ratio"}, common);
    if (!options.image.empty() && app.count("--material") > 0)
        throw CLI::ValidationError("--material",
                                   "has no meaning with --image, whose solid has --young-modulus and --poisson-ratio");
    if (!options.image.empty() && !(young > 0.0)) throw CLI::ValidationError("--young-modulus", "is not greater than 0");

    solver.begin(common);
    Report report(common, table, options.model == Model::voxel ? elastic_voxel_columns : elastic_network_columns);
    bool converged = true;
    const auto add = [&](Json result, const Json& name) {
        result["material"] = name;
        converged = converged && result["converged"].get<bool>();
        report.add(std::move(result));
    };
    cli::Progress progress("analyze elastic", common);
    const Watch watch{cli::stop_requested, [&](double fraction) { progress.show(fraction, "voxels"); }};
    if (!options.image.empty()) {
        const voxel::OnGrid found = solve_image("analyze elastic", options, voxel::solid(young, poisson), common, watch);
        add(of_voxels({found}, found.union_fraction, voxel::Order::first), nullptr);
    } else {
        io::Input input(common.files, cli::stop_requested);
        material.warn_by([&](const std::string& sentence) {
            if (!common.quiet) cli::warn("analyze elastic", sentence);
        });
        material.needed_for({physics::Use::elasticity});
        cli::for_each_state(input, material, [&](const State& state, const std::string& place) {
            if (options.model == Model::network) {
                Json result = of_network(state, model, options.tolerance, solver);
                for (const Json& warning : result["warnings"])
                    if (!common.quiet) cli::warn("analyze elastic", place + ": " + warning.get<std::string>());
                add(std::move(result), io::material_names(state));
                return true;
            }
            add(of_voxels(solve_state("analyze elastic", options, state, voxel::elastic_phases(state), common, watch),
                          relative_density(state), order_of(state)),
                io::material_names(state));
            return true;
        });
    }
    progress.clear();
    report.finish();
    return converged ? cli::done : cli::not_converged;
}

}  // namespace kiln::analyze
