// conductivity.cpp: conductivity of periodic states of bonded particles.
#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>

#include "io/state_io.h"
#include "mechanics/conduction.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/report.h"
#include "tools/common/each_state.h"
#include "tools/common/quantity_options.h"
#include "tools/common/value_options.h"

namespace kiln::analyze {

namespace {

constexpr const char* footer =
    "The conductivity may be that of heat or of anything else that flows by a gradient; the result is in proportion to it.\n\n"
    "Keys of a result:\n"
    "  relative_density, coordination_number, iterations, residual, fragments, rattlers\n"
    "  tensor            3x3, W/(m K)\n"
    "  conductivity      W/(m K), a third of its trace\n"
    "  bound             W/(m K), of Hashin & Shtrikman: no isotropic body of that density conducts more\n"
    "  at_bound          true where the network would, and is held at the bound\n"
    "  anisotropy        largest less smallest principal value, over the mean\n\n"
    "Examples:\n"
    "  bondify --method necks sintered.kiln | analyze conductivity --conductivity 30W/m/K --table\n"
    "  bondify --method necks sintered.kiln |\n"
    "      analyze conductivity --conductivity 30W/m/K --boundary-resistance 1e-8m2K/W | jq .conductivity";

const std::vector<Column> columns{{"relative_density", "relative density", ""},
                                  {"conductivity", "conductivity", "W/(m K)"},
                                  {"bound", "upper bound", "W/(m K)"},
                                  {"anisotropy", "anisotropy", ""},
                                  {"coordination_number", "coordination number", ""},
                                  {"iterations", "iterations", ""}};

enum class Model { network };

Json rows_of(const Eigen::Matrix3d& matrix) {
    Json rows = Json::array();
    for (int row = 0; row < 3; ++row) rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2)});
    return rows;
}

Json conductivity_of(const State& state, const mechanics::Conductor& conductor, double tolerance, bool& converged) {
    const double density = relative_density(state);
    const mechanics::Conductivity found = mechanics::conductivity(state, density, conductor, tolerance, cli::stop_requested);
    const Vec3 principal = found.tensor.selfadjointView<Eigen::Lower>().eigenvalues();
    const double mean = found.tensor.trace() / 3.0;
    converged = converged && found.converged;
    return {{"format", "dem-conductivity"},
            {"version", io::format_version},
            {"model", "network"},
            {"relative_density", density},
            {"solid_conductivity", conductor.conductivity},
            {"boundary_resistance", conductor.boundary_resistance},
            {"conductivity", mean},
            {"tensor", rows_of(found.tensor)},
            {"anisotropy", (principal.maxCoeff() - principal.minCoeff()) / mean},
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

}  // namespace

int conductivity(int argc, char** argv) {
    cli::Common common;
    bool table = false;
    double tolerance = 1e-8;
    Model model = Model::network;
    mechanics::Conductor conductor;
    CLI::App app{"Finds the conductivity of every state: a periodic cell of bonded particles under three gradients.",
                 "analyze conductivity"};
    app.footer(footer);
    add_table(app, table);
    cli::add_choice(app, "--model", model, {{"network", Model::network}},
                    "network: necks as conductors between particles, with the bulk that the necks of a particle share");
    cli::add_quantity(app, "--conductivity", conductor.conductivity, io::Dimension::conductivity, "Of the solid")->required();
    cli::add_quantity(app, "--boundary-resistance", conductor.boundary_resistance, io::Dimension::area_resistance,
                      "Of the grain boundary across every neck", "0m2K/W");
    cli::add_number(app, "--tolerance", tolerance, {1e-14, 1e-2}, "Unbalanced flow over what drives it at which a solve ends");
    app.callback([&] {
        if (!(conductor.conductivity > 0.0)) throw CLI::ValidationError("--conductivity", "must be greater than zero");
        if (conductor.boundary_resistance < 0.0)
            throw CLI::ValidationError("--boundary-resistance", "must be zero or more");
    });
    common.add_to(app, true, false);
    cli::parse(app, argc, argv, common);

    io::Input input(common.files, cli::stop_requested);
    Report report(common, table, columns);
    bool converged = true;
    cli::for_each_state(input, [&](const State& state, const std::string&) {
        report.add(conductivity_of(state, conductor, tolerance, converged));
        return true;
    });
    report.finish();
    return converged ? cli::done : cli::not_converged;
}

}  // namespace kiln::analyze
