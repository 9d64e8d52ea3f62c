// options.cpp: the command line of `sinter`.
#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>

#include "io/csv.h"
#include "io/json.h"
#include "tools/common/quantity_options.h"
#include "io/schedule_text.h"
#include "tools/common/value_options.h"

namespace kiln::sinter {

namespace {

using cli::add_choice, cli::add_number, cli::add_quantities, cli::add_quantity, io::Dimension;

constexpr const char* description =
    "Sinters packings of powder particles by the discrete element method.\n\n"
    "Reads states and writes a state at each density or time asked for; with --schedule alone, the state at its end. "
    "`sinter green --help` describes the command that makes green bodies.";

constexpr const char* footer =
    "Times of --at-time are those of the state's own clock, which `analyze info` shows; --schedule and --every begin where that "
    "clock stands.\n\n"
    "Keys of a line of --history, a step each, and of the summary in a state's history:\n"
    "  method                implicit or explicit\n"
    "  time, duration        s, at the end of the step; of the step\n"
    "  temperature           K, at the end of the step\n"
    "  relative_density, coordination_number\n"
    "  mean_overlap_ratio    h/2R, or h/(r1 + r2) of unequal spheres\n"
    "  strain                logarithmic, ln L/L0 of the box along x, y, z since the run began\n"
    "  engineering_strain    dL/L0 of the same, what a dilatometer shows\n"
    "  stress                Pa, along x, y, z, mean over the step, tension positive\n"
    "  attempts              how often the step was tried, with shorter lengths\n"
    "of the implicit method\n"
    "  density_error         estimated, of the density since the run began, relative\n"
    "  newton, conjugate_gradients  iterations; in a summary those of the whole run\n"
    "  imbalance             largest force left over, relative\n"
    "  converged\n"
    "of --coarsening\n"
    "  grains, mean_grain_diameter, mean_intercept (m), diameter_scatter (relative)\n"
    "  neck_coverage         share of a grain's surface that is neck\n"
    "  moved_by_surface, moved_by_boundary  volumes since the run began, m3\n"
    "  vanished_grains, vanished  since the run began; ids of those of the step, lines only\n"
    "  substeps              of the step, lines only\n"
    "of summaries\n"
    "  steps                 of the run\n"
    "  sintering_stress (Pa), bulk_viscosity, shear_viscosity (Pa s)\n"
    "                        with --report viscosity; null where nothing flows\n"
    "  viscosity             3x3, Pa s: stress along one axis per strain rate along another\n"
    "  viscosity_converged\n\n"
    "Examples:\n"
    "  sinter green -n 6000 | sinter --temperature 1200C --to-density 0.67,0.88 -o fired.kiln\n"
    "  sinter --schedule \"25C 10K/min 1150C 10min 20K/min 25C\" -o fired.kiln green.kiln\n"
    "  sinter --schedule furnace.csv --every 30min -o fired.kiln green.kiln\n"
    "  sinter --temperature 1200C --at-time 1min,5min green.kiln | analyze density --table\n"
    "  sinter --temperature 1200C --fix xy --report viscosity --to-density 0.7 -o film.kiln green.kiln\n"
    "  sinter --temperature 1200C --pressure 0MPa,0MPa,10MPa --at-time 1min -o forged.kiln green.kiln\n"
    "  sinter --temperature 1200C --confine xy --pressure 0MPa,0MPa,30MPa --at-time 1min \\\n"
    "      -o pressed.kiln green.kiln\n"
    "  sinter green -n 6000 --distribution lognormal:100nm:1.3 --material alumina-dihedral |\n"
    "      sinter --temperature 1350C --coarsening surface,boundary --to-density 0.7 -o grown.kiln\n"
    "  sinter --temperature 1200C --to-density 0.88 --checkpoint run.kiln --resume -o fired.kiln \\\n"
    "      --history history.jsonl green.kiln";

constexpr double solver_share = 20.0;  // tolerance of a step's motion over that of the run: the density feels its square

void check_list(const std::vector<double>& values, double above, double below, const std::string& option) {
    for (const double value : values)
        if (!(value > above && value < below))
            throw CLI::ValidationError(option + ": " + Json(value).dump() + " is not between " + Json(above).dump() + " and " +
                                       Json(below).dump());
}

}  // namespace

void Options::add_to(CLI::App& app) {
    add_programme(app);
    add_boundaries(app);
    add_method(app);
    add_coarsening(app);
    app.add_option("--history", history, "File for the density history, one JSON line a step")->type_name("FILE");
    app.add_option("--checkpoint", checkpoint, "File from which an interrupted run can be resumed; requires -o FILE")
        ->type_name("FILE");
    add_quantity(app, "--checkpoint-every", checkpoint_every, Dimension::time, "Wall time between checkpoints", "60s");
    app.add_flag("--resume", resume, "Resume the run of --checkpoint FILE if the file is there, else begin with the input");
    app.description(description);
    app.footer(footer);
}

void Options::add_programme(CLI::App& app) {
    add_quantities(app, "--to-density", densities, Dimension::none,
                   "Relative densities at which a state is written, such as 0.67,0.71");
    add_quantities(app, "--at-time", times, Dimension::time, "Times at which a state is written, on the clock of the state");
    add_quantity(app, "--every", every, Dimension::time,
                 "Also write a state after each such interval from the state's time on, until the last density or time");
    auto* hold =
        add_quantity(app, "--temperature", temperature, Dimension::temperature, "Temperature of a hold without end; RT is 25 C");
    app.add_option("--schedule", schedule,
                   "Temperatures, heating rates and hold times, such as \"RT 10C/min 1200C 1h 10C/min RT\", or a table NAME.csv "
                   "of time and "
                   "temperature as furnaces log it, from the state's time on")
        ->type_name("WORDS")
        ->excludes(hold);
    app.add_option("--time-column", log.time, "Heading of the time in the table of --schedule")->type_name("HEADING");
    app.add_option("--temperature-column", log.temperature, "Heading of the temperature there")->type_name("HEADING");
    add_choice(app, "--report", report, {{"viscosity", Report::viscosity}},
               "viscosity: write with each state its sintering stress, bulk and shear viscosity, by imposed strain rates")
        ->default_str("none");
}

void Options::add_boundaries(CLI::App& app) {
    add_choice(app, "--boundary", faces, {{"periodic", sintering::Faces::periodic}, {"free", sintering::Faces::free}},
               "periodic: along all axes; free: a body without periodic faces")
        ->default_str("as the state says");
    app.add_option("--fix", fixed, "Axes along which the box keeps its length, such as xy for a film on a substrate")
        ->type_name("AXES");
    app.add_option("--confine", confined,
                   "Axes along which the box stands in a die that it fills at the start: its walls hold the body and do not pull "
                   "it, such as xy beside --pressure 0MPa,0MPa,30MPa")
        ->type_name("AXES");
    add_quantities(app, "--pressure", pressure, Dimension::pressure,
                   "Pressure on the periodic faces, one for all or three for x,y,z; compression counts positive");
}

void Options::add_method(CLI::App& app) {
    add_choice(app, "--method", method, {{"implicit", SinterMethod::implicit}, {"explicit", SinterMethod::explicit_steps}},
               "implicit: without inertia, second order in time; explicit: with inertia, scaled, as in the paper");
    add_number(app, "--mass-scaling", mass_scaling, {cli::above_zero}, "Mass over the true one; explicit");
    add_number(app, "--tolerance", tolerance, {}, "Relative error of the density over the run to aim at; implicit");
    add_number(app, "--order", order, {1, 2}, "Order in time of the implicit step; 1 is for comparison");
    add_number(app, "--alpha", constants.alpha, {0.0}, "Constant of the sintering force (alpha/beta) pi 2 R* gamma of a contact");
    add_number(app, "--beta", constants.beta, {cli::above_zero},
               "Constant of that force and of the viscosity pi a^4/(2 beta Delta)");
    add_number(app, "--eta", constants.eta, {0.0},
               "Constant of the tangential viscosity eta pi a^2 (2 R*)^2/(2 beta Delta); a^2 = 4 R* h");
}

void Options::add_coarsening(CLI::App& app) {
    app.add_option_function<std::string>(
           "--coarsening",
           [this](const std::string& text) {
               for (std::size_t begin = 0; begin <= text.size();) {
                   const std::size_t end = std::min(text.find(',', begin), text.size());
                   const std::vector<std::string> words{"surface", "boundary"};
                   (cli::choice_from("--coarsening", text.substr(begin, end - begin), words) == 0 ? coarsening.surface
                                                                                                  : coarsening.boundary) = true;
                   begin = end + 1;
               }
           },
           "How grains of one material exchange volume over their necks: surface (diffusion), boundary (migration) or "
           "surface,boundary; implicit")
        ->type_name("WORDS")
        ->default_str("none");
    add_number(app, "--chi", coarsening.chi, {0.0, 1.0},
               "Neck radius over that of the smaller grain from which on the boundary between them is free to migrate");
    add_number(app, "--neck-share", coarsening.neck_share, {0.0, 1.0},
               "Part of a grain's growth that the overlap of its contacts takes up; 0.5: truncated spheres");
    app.add_option_function<std::string>(
           "--neck-growth",
           [this](const std::string& text) { coarsening.neck_growth = cli::choice_from("--neck-growth", text, {"surface"}) == 0; },
           "surface: necks also grow by surface diffusion, without shrinkage; implicit")
        ->type_name("{surface}")
        ->default_str("none");
}

void Options::check(const CLI::App& app, const std::string& output) {
    if (schedule.empty() && temperature == 0.0) throw CLI::ValidationError("one of --temperature and --schedule is required");
    if (densities.empty() && times.empty() && schedule.empty())
        throw CLI::ValidationError("one of --to-density, --at-time and --schedule is required");
    check_list(densities, 0.0, 1.0, "--to-density");
    for (const double time : times)
        if (!(time >= 0.0)) throw CLI::ValidationError("--at-time: a time is not negative");
    if (!(every >= 0.0)) throw CLI::ValidationError("--every: a span of time is not negative");
    check_list({tolerance}, 0.0, 1.0, "--tolerance");
    const std::array<bool, 3> still = cli::axes_from("--fix", fixed), die = cli::axes_from("--confine", confined);
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (still[axis] && die[axis])
            throw CLI::ValidationError(std::string("--fix and --confine both name ") + "xyz"[axis] +
                                       ": a face is held, or held without being pulled");
    if (!(pressure.empty() || pressure.size() == 1 || pressure.size() == 3))
        throw CLI::ValidationError("--pressure: one value or three are required, for x,y,z");
    if (faces == sintering::Faces::free && (!fixed.empty() || !confined.empty() || !pressure.empty()))
        throw CLI::ValidationError(
            "--fix, --confine and --pressure hold or load the faces of a periodic box; with --boundary free there are none");
    if (!checkpoint.empty() && output == "-") throw CLI::ValidationError("--checkpoint requires an output file: -o FILE");
    if (resume && checkpoint.empty()) throw CLI::ValidationError("--resume requires --checkpoint FILE");
    refuse_unused(app);
    if (io::is_csv(schedule))
        programme_ = io::read_schedule(schedule, log);
    else if (!schedule.empty())
        programme_ = cli::parsed("--schedule", [this] { return io::parse_schedule(schedule); });
}

void Options::refuse_unused(const CLI::App& app) const {
    if (checkpoint.empty() && app.count("--checkpoint-every") > 0)
        throw CLI::ValidationError("--checkpoint-every requires --checkpoint FILE");
    for (const char* name : {"--time-column", "--temperature-column"})
        if (!io::is_csv(schedule) && app.count(name) > 0) throw CLI::ValidationError(name, "needs --schedule NAME.csv");
    const bool with_inertia = method == SinterMethod::explicit_steps;
    for (const char* name : {"--coarsening", "--neck-growth"})
        if (with_inertia && app.count(name) > 0)
            throw CLI::ValidationError(name, "needs --method implicit: the explicit one has no grains that change in size");
    if (!coarsening.boundary && app.count("--chi") > 0) throw CLI::ValidationError("--chi", "needs --coarsening boundary");
    if (!coarsening.exchanges() && app.count("--neck-share") > 0)
        throw CLI::ValidationError("--neck-share", "needs --coarsening");
    if (!with_inertia && app.count("--mass-scaling") > 0)
        throw CLI::ValidationError("--mass-scaling", "needs --method explicit");
    for (const char* name : {"--tolerance", "--order"})
        if (with_inertia && app.count(name) > 0) throw CLI::ValidationError(name, "has no meaning with --method explicit");
}

Json Options::bearing(Json arguments) const {
    if (io::is_csv(schedule)) arguments.push_back(std::to_string(std::hash<std::string>{}(io::bytes_of(schedule))));
    return arguments;
}

sintering::SinteringSettings Options::settings(double start) const {
    sintering::SinteringSettings settings;
    settings.schedule = programme_ ? programme_->from(start) : physics::Schedule::hold(temperature);
    settings.constants = constants;
    settings.faces = faces;
    settings.fixed = cli::axes_from("--fix", fixed);
    settings.confined = cli::axes_from("--confine", confined);
    for (std::size_t axis = 0; axis < 3 && !pressure.empty(); ++axis)
        settings.pressure[static_cast<Eigen::Index>(axis)] = pressure[pressure.size() == 1 ? 0 : axis];
    settings.tolerance = tolerance;
    settings.solver_tolerance = std::min(solver_share * tolerance, settings.solver_tolerance);
    settings.second_order = order == 2;
    settings.mass_scaling = mass_scaling;
    settings.coarsening = coarsening;
    return settings;
}

std::vector<physics::Use> Options::uses() const {
    std::vector<physics::Use> all{physics::Use::sintering};
    if (coarsening.surface || coarsening.neck_growth) all.push_back(physics::Use::surface_coarsening);
    if (coarsening.boundary) all.push_back(physics::Use::boundary_coarsening);
    if (method == SinterMethod::explicit_steps) all.push_back(physics::Use::inertia);
    return all;
}

double Options::last_time(double start) const { return settings(start).schedule.end(); }

}  // namespace kiln::sinter
