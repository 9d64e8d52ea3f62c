// options.h: the options of `sinter`, with their defaults, units and checks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/furnace_log.h"
#include "io/json_forward.h"
#include "physics/materials.h"
#include "sintering/sintering.h"

namespace CLI {
class App;
}

namespace kiln::sinter {

enum class SinterMethod { implicit, explicit_steps };

enum class Report { none, viscosity };

struct Options {
    std::vector<double> densities;  // relative, required states
    std::vector<double> times;      // s, required states
    double every = 0.0;             // s, between states; 0: none
    double temperature = 0.0;       // K, of a hold; 0: a schedule is given
    std::string schedule;           // words, or a furnace's log by its name
    io::LogColumns log;             // which of its columns
    sintering::Faces faces = sintering::Faces::as_given;
    std::string fixed, confined;    // axes
    std::vector<double> pressure;   // Pa, one or three
    SinterMethod method = SinterMethod::implicit;
    double mass_scaling = 1e20;
    double tolerance = 3e-4;
    int order = 2;
    physics::ContactConstants constants;
    Report report = Report::none;   // what else to say of each state
    sintering::CoarseningSettings coarsening;
    std::string history;            // file of one JSON line a step
    std::string checkpoint;         // file
    double checkpoint_every = 60.0;  // s of wall time
    bool resume = false;

    void add_to(CLI::App& app);

    /// Checks options against each other, once they are parsed; throws CLI::ValidationError.
    /// Reads the schedule; throws Error for a log that cannot be read.
    void check(const CLI::App& app, const std::string& output);

    /// Arguments that bear on the result, from those of the command line: what a log holds is one.
    Json bearing(Json arguments) const;

    /// Settings of the method for a state at the time `start` (s), where the schedule begins; --at-time is on its own clock.
    sintering::SinteringSettings settings(double start) const;

    /// What the run does with a material.
    std::vector<physics::Use> uses() const;

    /// Time at which the run ends if nothing else ends it, s; infinity for a hold.
    double last_time(double start) const;

   private:
    void add_programme(CLI::App& app);
    void add_boundaries(CLI::App& app);
    void add_method(CLI::App& app);
    void add_coarsening(CLI::App& app);
    void refuse_unused(const CLI::App& app) const;

    std::optional<physics::Schedule> programme_;  // of --schedule
};

}  // namespace kiln::sinter
