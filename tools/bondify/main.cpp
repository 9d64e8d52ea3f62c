// main.cpp: bondify, overlapping particles to bonded particles, state by state.
#include <CLI/CLI.hpp>
#include <sstream>

#include "tools/common/progress.h"
#include "tools/common/tool.h"
#include "io/files.h"
#include "io/state_io.h"
#include "tools/common/each_state.h"
#include "tools/bondify/options.h"

namespace {

using namespace kiln;

/// A part in percent of a whole; 0 of nothing.
double percent(double part, double whole) { return whole > 0.0 ? 100.0 * part / whole : 0.0; }

double percent(std::size_t part, std::size_t whole) { return percent(static_cast<double>(part), static_cast<double>(whole)); }

/// One sentence for each thing about a state that the user should know.
void report(const bonding::Summary& summary, const bonding::Options& options, const std::string& place) {
    const auto warn = [&place](const auto&... words) {
        std::ostringstream sentence;
        sentence << place << ": ";
        (sentence << ... << words);
        cli::warn("bondify", sentence.str());
    };
    if (summary.pairs == 0) warn("no particles overlap, so there are no bonds");
    if (summary.clamped > 0)
        warn(summary.clamped, " of ", summary.pairs, " bonds are clamped to the radius of their smaller particle, and ",
             percent(summary.lost_volume, summary.bond_volume),
             " % of the volume of all bonds does not fit into them: E is lower by "
             "a fifth to a third of that; --method necks loses none");
    if (summary.stopped > 0)
        warn(summary.stopped, " particles stopped shrinking at ", 100.0 * bonding::min_share, " % of their radius");
    if (options.drop_thin && summary.thin > 0 && options.method != bonding::Method::necks)
        warn(summary.thin, " thin bonds are left out, and ", percent(summary.dropped_volume, summary.bond_volume),
             " % of the volume of all bonds with them");
    if (!summary.fills)
        warn("no factor on the necks makes their union with the particles fill the ", summary.solid_fraction,
             " of the box that the mass fills: with ", summary.neck_factor, " it fills ", summary.union_fraction,
             ", and that is written; ", summary.limited, " of ", summary.pairs, " necks are as thick as they may be");
}

/// What the history of a state says about its necks.
Json necks_json(const bonding::Summary& summary, const bonding::Options& options) {
    return {{"method", "necks"},
            {"necks", options.necks == bonding::Necks::mass ? "mass" : "law"},
            {"pairs", summary.pairs},
            {"bonds", summary.bonds},
            {"mean_diameter", summary.mean_diameter},
            {"mean_length", summary.mean_length},
            {"coordination_number", summary.coordination_number},
            {"neck_factor", summary.neck_factor},
            {"solid_fraction", summary.solid_fraction},
            {"union_fraction", summary.union_fraction},
            {"union_error", summary.union_error},
            {"limited", summary.limited},
            {"limited_percent", percent(summary.limited, summary.pairs)},
            {"thin", summary.thin}};
}

/// What the history of a state says about its transition.
Json summary_json(const bonding::Summary& summary, const bonding::Options& options) {
    return {{"method", options.method == bonding::Method::exact ? "exact" : "sweep"},
            {"sharing", options.sharing == bonding::Sharing::pair ? "pair" : "particle"},
            {"volume", options.volume == physics::BondVolume::cylinder ? "cylinder" : "cap-corrected"},
            {"pairs", summary.pairs},
            {"bonds", summary.bonds},
            {"mean_diameter", summary.mean_diameter},
            {"mean_length", summary.mean_length},
            {"coordination_number", summary.coordination_number},
            {"clamped", summary.clamped},
            {"clamped_percent", percent(summary.clamped, summary.pairs)},
            {"bond_volume", summary.bond_volume},
            {"lost_volume", summary.lost_volume},
            {"lost_percent", percent(summary.lost_volume, summary.bond_volume)},
            {"thin", summary.thin},
            {"dropped_volume", summary.dropped_volume},
            {"dropped_percent", percent(summary.dropped_volume, summary.bond_volume)},
            {"stopped", summary.stopped},
            {"volume_error", summary.volume_error}};
}

int run(int argc, char** argv) {
    cli::Common common;
    bonding::Options options;
    CLI::App app{"", "bondify"};
    bondify::add_options(app, options);
    common.add_to(app);
    cli::parse(app, argc, argv, common);

    io::Input input(common.files, cli::stop_requested);
    io::Output output(common.output, common.text);
    cli::Progress progress("bondify", common);
    cli::for_each_state(input, [&](State state, const std::string& place) {
        if (state.bonds && state.bonds->size() > 0 && !common.quiet)
            cli::warn("bondify", place + ": the bonds that it had are replaced");
        const Watch watch{cli::stop_requested, [&](double done) { progress.show(done, place); }};
        const bonding::Summary summary = bonding::bondify(state, options, watch);
        progress.clear();
        if (!common.quiet) report(summary, options, place);
        const Json json =
            options.method == bonding::Method::necks ? necks_json(summary, options) : summary_json(summary, options);
        progress.detail(json);
        io::append_history(state, cli::history_entry("bondify", app, json));
        output.write(std::move(state));
        return true;
    });
    output.commit();
    return cli::done;
}

}  // namespace

int main(int argc, char** argv) { return kiln::cli::run("bondify", argc, argv, run); }
