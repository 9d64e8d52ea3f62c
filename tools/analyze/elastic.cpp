// elastic.cpp: elastic tensor of periodic states of bonded particles.
#include <CLI/CLI.hpp>
#include <algorithm>

#include "tools/common/bond_model.h"
#include "tools/common/value_options.h"
#include "io/state_io.h"
#include "mechanics/elastic_tensor.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/report.h"
#include "tools/common/each_state.h"

namespace kiln::analyze {

namespace {

constexpr const char* footer =
    "Keys of a result:\n"
    "  relative_density, bond_law, iterations, residual, fragments, rattlers\n"
    "  stiffness       6x6, Pa; xx, yy, zz, yz, xz, xy, engineering shear\n"
    "  young_modulus (Pa), poisson_ratio  of its isotropic (Voigt) average\n"
    "  anisotropy      0 for an isotropic tensor (Ranganathan & Ostoja-Starzewski 2008)\n"
    "  affine          the stiffness of particles that follow the strain: an upper bound\n\n"
    "Examples:\n"
    "  bondify sintered.kiln | analyze elastic --table\n"
    "  bondify --method necks sintered.kiln | analyze elastic --table\n"
    "  analyze elastic --bond-law neck bonded.kiln | jq .young_modulus";

const std::vector<Column> columns{{"relative_density", "relative density", ""},
                                  {"young_modulus", "Young's modulus", "Pa"},
                                  {"poisson_ratio", "Poisson's ratio", ""},
                                  {"anisotropy", "anisotropy", ""},
                                  {"affine_young_modulus", "affine bound", "Pa"},
                                  {"bond_law", "bond law", ""},
                                  {"iterations", "iterations", ""}};

Json rows_of(const mechanics::Mat6& matrix) {
    Json rows = Json::array();
    for (int row = 0; row < 6; ++row) rows.push_back(std::vector<double>(matrix.row(row).begin(), matrix.row(row).end()));
    return rows;
}

Json elastic_of(const State& state, const mechanics::BondModel& model, double tolerance, bool& converged) {
    const auto& periodic = state.box.periodic;
    if (!std::all_of(periodic.begin(), periodic.end(), [](bool axis) { return axis; }))
        throw Error(
            "the box is not periodic along all axes, so the state has no elastic tensor; bend tests bodies with free faces");
    const mechanics::BondedBody body = mechanics::bonded_body(state, model);
    const mechanics::ElasticTensor tensor =
        mechanics::elastic_tensor(body.network, state.box.volume(), tolerance, cli::stop_requested);
    const mechanics::IsotropicAverage average = mechanics::isotropic_average(tensor.stiffness);
    const mechanics::IsotropicAverage affine = mechanics::isotropic_average(tensor.affine);
    converged = converged && tensor.converged;
    return {{"format", "dem-elastic"},
            {"version", io::format_version},
            {"relative_density", relative_density(state)},
            {"bond_law", physics::name_of(*body.model.law)},
            {"bond_shear", body.model.shear ? Json(physics::name_of(*body.model.shear)) : Json()},
            {"young_modulus", average.young_modulus},
            {"poisson_ratio", average.poisson_ratio},
            {"shear_modulus", average.shear_modulus},
            {"bulk_modulus", average.bulk_modulus},
            {"anisotropy", average.anisotropy},
            {"stiffness", rows_of(tensor.stiffness)},
            {"affine", rows_of(tensor.affine)},
            {"affine_young_modulus", affine.young_modulus},
            {"iterations", tensor.iterations},
            {"residual", tensor.residual},
            {"converged", tensor.converged},
            {"fragments", body.fragments},
            {"fragment_particles", body.fragment_particles},
            {"rattlers", body.rattlers},
            {"negligible_bonds", body.negligible_bonds}};
}

}  // namespace

int elastic(int argc, char** argv) {
    cli::Common common;
    bool table = false;
    double tolerance = 1e-8;
    mechanics::BondModel model;
    CLI::App app{"Finds the elastic tensor of every state: a periodic cell of bonded particles under six strains.",
                 "analyze elastic"};
    app.footer(footer);
    add_table(app, table);
    cli::add_bond_model(app, model);
    cli::add_number(app, "--tolerance", tolerance, {1e-14, 1e-2}, "Unbalanced force over load at which a solve ends");
    common.add_to(app, true, false);
    cli::parse(app, argc, argv, common);

    io::Input input(common.files, cli::stop_requested);
    Report report(common, table, columns);
    bool converged = true;
    cli::for_each_state(input, [&](const State& state, const std::string&) {
        report.add(elastic_of(state, model, tolerance, converged));
        return true;
    });
    report.finish();
    return converged ? cli::done : cli::not_converged;
}

}  // namespace kiln::analyze
