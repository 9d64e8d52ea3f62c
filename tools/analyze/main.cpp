// main.cpp: analyze, numbers out of states and test results; picks the subcommand.
#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <string_view>

#include "tools/common/tool.h"
#include "tools/analyze/analyze.h"

namespace {

using namespace kiln;

struct Subcommand {
    std::string_view name;
    std::string_view purpose;
    int (*run)(int, char**);
};

constexpr std::array subcommands{
    Subcommand{"info", "what each document of a stream holds", analyze::info},
    Subcommand{"density", "density, coordination number, overlaps, clusters, texture and g(r) of states", analyze::density},
    Subcommand{"bonds", "number and sizes of bonds, the distribution of their radii, and the loads they carry", analyze::bonds},
    Subcommand{"select", "the states of a stream nearest to given densities, times or places, or in between", analyze::select},
    Subcommand{"modulus", "Young's modulus from the last unloading of a bending test, simulated or measured", analyze::modulus},
    Subcommand{"strength", "bending strength of bars that broke, and Weibull's distribution of several", analyze::strength},
    Subcommand{"elastic", "elastic tensor of a periodic cell of bonded particles, or of an image", analyze::elastic},
    Subcommand{"conductivity", "conductivity of a periodic cell of bonded particles", analyze::conductivity},
    Subcommand{"voxel", "a state as an image of voxels, for NumPy or ParaView", analyze::voxel},
    Subcommand{"fit", "laws of Young's modulus against porosity through several tests or measurements", analyze::fit},
    Subcommand{"mean", "means of several results, with their intervals of confidence", analyze::mean},
    Subcommand{"kinetics", "activation energies and constants of diffusion from measured curves of density", analyze::kinetics},
    Subcommand{"materials", "the built-in materials with their sources, and what a material lacks", analyze::materials},
};

/// `analyze`, `analyze --help`, or a subcommand that does not exist.
int without_subcommand(int argc, char** argv) {
    CLI::App app{
        "Takes numbers out of states and test results.\n\nWrites one JSON document a line, in SI units, or a table with --table.",
        "analyze"};
    std::string list = "Subcommands (analyze SUBCOMMAND --help says more):\n";
    std::vector<std::string> names;
    for (const Subcommand& each : subcommands) {
        names.emplace_back(each.name);
        list += "  " + names.back() + std::string(14 - names.back().size(), ' ') + std::string(each.purpose) + "\n";
    }
    app.footer(list + "\nExamples:\n"
               "  analyze density --table sintered.kiln\n"
               "  sinter --temperature 1200C --to-density 0.67,0.79 green.kiln | bondify | bend |\n"
               "      analyze modulus | analyze fit");
    cli::add_help(app);
    const auto refuse = [names](const std::string& given) {
        std::string known;
        for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
        return "there is no subcommand '" + given + "', only " + known;
    };
    app.add_option("SUBCOMMAND", "What to do; must come first")->required()->type_name("")->check(refuse);
    cli::parse(app, argc, argv, cli::Common());
    return cli::wrong_usage;
}

}  // namespace

int main(int argc, char** argv) {
    for (const Subcommand& each : subcommands)
        if (argc > 1 && each.name == argv[1]) return cli::run("analyze " + std::string(each.name), argc - 1, argv + 1, each.run);
    return cli::run("analyze", argc, argv, without_subcommand);
}
