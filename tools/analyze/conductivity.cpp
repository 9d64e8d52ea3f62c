// conductivity.cpp: conductivity of periodic states of bonded particles.
#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>

#include "io/material_io.h"
#include "io/state_io.h"
#include "mechanics/conduction.h"
#include "physics/conduction.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/report.h"
#include "tools/analyze/voxel_options.h"
#include "tools/common/each_state.h"
#include "tools/common/quantity_options.h"

namespace kiln::analyze {

namespace {

constexpr const char* conductivity_footer =
    "The conductivity may be that of heat or of anything else that flows by a gradient; the result is in proportion to it.\n\n"
    "Keys of a result:\n"
    "  material          names in one text; null of an image, and where the state does not say\n"
    "  model, relative_density, iterations, residual, converged\n"
    "  solid_conductivity, boundary_resistance  as the options say, W/(m K) and m2 K/W\n"
    "  tensor            3x3, W/(m K)\n"
    "  conductivity      W/(m K), a third of its trace\n"
    "  bound             W/(m K), of Hashin & Shtrikman: no isotropic body of that density conducts more\n"
    "  anisotropy        largest less smallest principal value, over the mean\n"
    "of a network also\n"
    "  coordination_number, fragments, rattlers, negligible_bonds\n"
    "  at_bound          true where the network would, and is held at the bound\n"
    "of voxels also\n"
    "  extrapolation_error  W/(m K), of conductivity\n"
    "  union_fraction    of the box, by spheres and bonds together\n"
    "  grids             what each gave {voxels (a mean radius), count, union_fraction, loose_fraction,\n"
    "                    iterations, residual, conductivity}\n\n"
    "Examples:\n"
    "  bondify --method necks sintered.kiln | analyze conductivity --conductivity 30W/m/K --table\n"
    "  bondify --method necks sintered.kiln |\n"
    "      analyze conductivity --conductivity 30W/m/K --boundary-resistance 1e-8m2K/W | jq .conductivity\n"
    "  analyze select --density 0.79 sintered.kiln | bondify --method necks |\n"
    "      analyze conductivity --model voxel --voxels 4,6 --conductivity 30W/m/K";

const std::vector<Column> conductivity_network_columns{{"material", "material", ""},
                                                  {"relative_density", "relative density", ""},
                                                       {"conductivity", "conductivity", "W/(m K)"},
                                                       {"bound", "upper bound", "W/(m K)"},
                                                       {"anisotropy", "anisotropy", ""},
                                                       {"coordination_number", "coordination number", ""},
                                                       {"iterations", "iterations", ""}};

const std::vector<Column> conductivity_voxel_columns{{"material", "material", ""},
                                                  {"relative_density", "relative density", ""},
                                                     {"union_fraction", "union", ""},
                                                     {"conductivity", "conductivity", "W/(m K)"},
                                                     {"extrapolation_error", "+-", "W/(m K)"},
                                                     {"bound", "upper bound", "W/(m K)"},
                                                     {"anisotropy", "anisotropy", ""},
                                                     {"iterations", "iterations", ""}};

double anisotropy_of(const Eigen::Matrix3d& tensor) {
    const Vec3 principal = tensor.selfadjointView<Eigen::Lower>().eigenvalues();
    return 3.0 * (principal.maxCoeff() - principal.minCoeff()) / tensor.trace();
}

Json of_network(const State& state, const mechanics::Conductor& conductor, double tolerance) {
    const double density = relative_density(state);
    const mechanics::Conductivity found = mechanics::conductivity(state, density, conductor, tolerance, cli::stop_requested);
    return {{"format", "dem-conductivity"},
            {"version", io::format_version},
            {"model", "network"},
            {"relative_density", density},
            {"solid_conductivity", conductor.conductivity},
            {"boundary_resistance", conductor.boundary_resistance},
            {"conductivity", found.tensor.trace() / 3.0},
            {"tensor", rows_of(found.tensor)},
            {"anisotropy", anisotropy_of(found.tensor)},
            {"bound", found.bound},
            {"at_bound", found.at_bound},
            {"coordination_number", found.coordination_number},
            {"iterations", found.iterations},
            {"residual", found.residual},
            {"converged", found.converged},
            {"fragments", found.fragments},
            {"rattlers", found.rattlers},
            {"negligible_bonds", found.negligible_bonds}};
}

Json of_voxels(const std::vector<voxel::OnGrid>& grids, double density, double conductivity, voxel::Order order) {
    const Limits limits(grids, order);
    Json list = Json::array();
    std::vector<double> values;
    for (const voxel::OnGrid& grid : grids) {
        values.push_back(grid.found.tensor.trace() / 3.0);
        list.push_back(grid_json(grid));
        list.back()["conductivity"] = values.back();
    }
    const Eigen::Matrix3d tensor = limits.tensor();
    const Limit limit = limits.of(values);
    Json result{{"format", "dem-conductivity"},
                {"version", io::format_version},
                {"model", "voxel"},
                {"relative_density", density},
                {"solid_conductivity", conductivity},
                {"conductivity", limit.value},
                {"extrapolation_error", limit.error},
                {"tensor", rows_of(tensor)},
                {"anisotropy", anisotropy_of(tensor)},
                {"bound", conductivity * physics::conductivity_bound(density)}};
    result.update(solves_json(grids));
    result["grids"] = std::move(list);
    return result;
}

}  // namespace

int conductivity(int argc, char** argv) {
    cli::Common common;
    bool table = false;
    VoxelOptions options;
    mechanics::Conductor conductor;
    CLI::App app{"Finds the conductivity of every state, a periodic cell under three gradients, or of an image.",
                 "analyze conductivity"};
    app.footer(conductivity_footer);
    add_table(app, table);
    options.add_to(app, "necks as conductors between particles, with the bulk that the necks of a particle share",
                   "Unbalanced flow over what drives it");
    cli::add_quantity(app, "--conductivity", conductor.conductivity, io::Dimension::conductivity, "Of the solid")->required();
    cli::add_quantity(app, "--boundary-resistance", conductor.boundary_resistance, io::Dimension::area_resistance,
                      "Of the grain boundary across every neck", "0m2K/W");
    app.callback([&] {
        if (!(conductor.conductivity > 0.0)) throw CLI::ValidationError("--conductivity", "must be greater than zero");
        if (conductor.boundary_resistance < 0.0)
            throw CLI::ValidationError("--boundary-resistance", "must be zero or more");
    });
    common.add_to(app, true, false);
    cli::parse(app, argc, argv, common);
    options.check(app, {"--boundary-resistance"}, {}, common);

    Report report(common, table, options.model == Model::voxel ? conductivity_voxel_columns : conductivity_network_columns);
    bool converged = true;
    const auto add = [&](Json result, const Json& material) {
        result["material"] = material;
        converged = converged && result["converged"].get<bool>();
        report.add(std::move(result));
    };
    cli::Progress progress("analyze conductivity", common);
    const Watch watch{cli::stop_requested, [&](double fraction) { progress.show(fraction, "voxels"); }};
    const double solid = conductor.conductivity;
    if (!options.image.empty()) {
        const voxel::OnGrid found = solve_image("analyze conductivity", options, voxel::Conductor{solid}, common, watch);
        add(of_voxels({found}, found.union_fraction, solid, voxel::Order::first), nullptr);
    } else {
        io::Input input(common.files, cli::stop_requested);
        cli::for_each_state(input, [&](const State& state, const std::string&) {
            if (options.model == Model::network) {
                add(of_network(state, conductor, options.tolerance), io::material_names(state));
                return true;
            }
            add(of_voxels(
                solve_state("analyze conductivity", options, state, voxel::conducting_phases(state, solid), common, watch),
                relative_density(state), solid, order_of(state)),
                io::material_names(state));
            return true;
        });
    }
    progress.clear();
    report.finish();
    return converged ? cli::done : cli::not_converged;
}

}  // namespace kiln::analyze
