// kinetics_input.cpp: measured curves out of tables, firings out of words, simulated runs out of histories.
#include "tools/analyze/kinetics_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "io/csv.h"
#include "io/files.h"
#include "io/json_values.h"
#include "io/material_io.h"
#include "io/schedule_text.h"
#include "io/state_io.h"
#include "tools/analyze/results.h"
#include "tools/common/each_state.h"
#include "tools/common/tool.h"
#include "tools/common/value_options.h"

namespace kiln::analyze {

using analysis::DensityCurve, analysis::SimulatedRun;

namespace {

constexpr double room_temperature = 298.15;  // K, at which a heating rate begins
constexpr double linear_intercept = 1.56;    // mean diameter over mean intercept length, Mendelson 1969
constexpr double default_size_error = 0.1;   // relative, of a grain size without one

const io::ColumnNames temperature_names{"temperature", "temperatur", "temp", "t$"};
const io::ColumnNames time_names{"time", "zeit"};
const io::ColumnNames density_names{"relative_density", "relative density", "rel. density", "density"};
const std::vector<std::string> change_names{"dL/L", "dl/l", "ΔL/L", "Δl/l"};
const io::ColumnNames shrinkage_names{"shrinkage", "schwindung"};

/// A heating rate out of a heading or an option: "5 K/min", "10\u00b0C/min"; nothing if it is none.
std::optional<double> rate_of(std::string text) {
    std::erase_if(text, [](char c) { return c == '(' || c == ')' || c == '[' || c == ']'; });
    for (const std::string celsius : {"\u00b0C/", "C/"})
        if (const std::size_t at = text.find(celsius); at != std::string::npos) text.replace(at, celsius.size(), "K/");
    try {
        const double rate = io::parse_quantity(text, io::Dimension::heating_rate);
        return rate > 0.0 ? std::optional(rate) : std::nullopt;
    } catch (const TextError&) {
        return std::nullopt;
    }
}

std::string rate_text(double rate) { return cli::number_text(std::round(60e6 * rate) / 1e6) + " K/min"; }

std::string stem_of(const std::string& file) { return std::filesystem::path(file).stem().string(); }


void check_ascending(const std::vector<double>& values, const std::string& what, const io::CsvTable& table) {
    for (std::size_t row = 1; row < values.size(); ++row)
        if (!(values[row] > values[row - 1])) throw Error(table.place(row) + ": the " + what + " does not rise");
}

void check_densities(const std::vector<double>& density, const io::CsvTable& table) {
    for (std::size_t row = 0; row < density.size(); ++row)
        if (!(density[row] > 0.0 && density[row] <= 1.0))
            throw Error(table.place(row) + ": the relative density is " + Json(density[row]).dump() +
                        ", expected more than 0 and at most 1");
}

/// Density out of the relative change of length dL/L0, less what the body expands from room temperature on.
std::vector<double> density_of(const std::vector<double>& change, const std::vector<double>& temperature,
                               const Dilatometer& dilatometer, const io::CsvTable& table, const std::string& file) {
    if (dilatometer.green_density == 0.0)
        throw Error(file + ": holds shrinkage, from which the density follows with --green-density");
    std::vector<double> density;
    for (std::size_t row = 0; row < change.size(); ++row) {
        const double length = 1.0 + change[row] - dilatometer.expansion * (temperature[row] - room_temperature);
        if (!(length > 0.0))
            throw Error(table.place(row) + ": a change of length by " + Json(change[row]).dump() + " leaves nothing");
        density.push_back(dilatometer.green_density / (length * length * length));
    }
    return density;
}

/// The column headed dL/L0 or ΔL/L0, as a number or in %, which is more than a name and a unit.
std::optional<std::vector<double>> change_of_length(const io::CsvTable& table, const std::string& file) {
    std::optional<std::vector<double>> found;
    for (std::size_t column = 0; column < table.columns(); ++column) {
        std::string heading = table.heading(column);
        std::erase(heading, ' ');
        if (std::ranges::none_of(change_names, [&](const std::string& name) { return heading.starts_with(name); })) continue;
        if (found) throw Error(file + ": has several columns of dL/L0");
        found = table.numbers(column);
        if (heading.find('%') != std::string::npos)
            for (double& each : *found) each *= 0.01;
    }
    return found;
}

/// The column of density, or what the columns of shrinkage make of it; nothing if there is none.
std::optional<std::vector<double>> density_column(const io::CsvTable& table, const std::vector<double>& temperature,
                                                  const Dilatometer& dilatometer, const std::string& file) {
    using io::Dimension;
    if (auto density = table.column(density_names, Dimension::fraction)) return density;
    if (const auto change = change_of_length(table, file)) {
        if (change->back() > 0.0)
            throw Error(file + ": the change of length ends at " + Json(change->back()).dump() +
                        ", longer than it began; a shrinkage that counts positive is headed 'shrinkage'");
        return density_of(*change, temperature, dilatometer, table, file);
    }
    if (auto shrinkage = table.column(shrinkage_names, Dimension::fraction)) {
        if (shrinkage->back() < 0.0)
            throw Error(file + ": the shrinkage ends at " + Json(shrinkage->back()).dump() +
                        "; a change of length that counts shrinking negative is headed 'dL/L0'");
        for (double& each : *shrinkage) each = -each;
        return density_of(*shrinkage, temperature, dilatometer, table, file);
    }
    return std::nullopt;
}

/// Rows of a curve under a constant heating rate, K/s, from room temperature, or from the first row if that is colder.
DensityCurve at_rate(const std::string& name, const std::vector<double>& temperature, std::vector<double> density, double rate) {
    const double start = std::min(room_temperature, temperature.front());
    std::vector<double> time;
    for (const double each : temperature) time.push_back((each - start) / rate);
    return {name, physics::Schedule({{0.0, start}, {time.back(), temperature.back()}}), time, std::move(density)};
}

/// Rows of a curve with their own times.
DensityCurve along_table(const std::string& name, const std::vector<double>& time, const std::vector<double>& temperature,
                         std::vector<double> density) {
    std::vector<physics::Schedule::Corner> corners;
    for (std::size_t row = 0; row < time.size(); ++row) corners.push_back({time[row], temperature[row]});
    return {name, physics::Schedule(std::move(corners)), time, std::move(density)};
}

/// "FILE:RATE" or "FILE".
struct Named {
    std::string file;
    std::string rate;
};

Named named(const std::string& text) {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos || !rate_of(text.substr(colon + 1))) return {text, ""};
    return {text.substr(0, colon), text.substr(colon + 1)};
}

/// The columns headed by a heating rate, as curves.
std::vector<MeasuredCurve> rate_columns(const io::CsvTable& table, const std::vector<double>& temperature,
                                        const std::string& file) {
    std::vector<MeasuredCurve> curves;
    for (std::size_t column = 0; column < table.columns(); ++column) {
        const auto rate = rate_of(table.heading(column));
        if (!rate) continue;
        std::vector<double> density = table.numbers(column);
        const std::string name = stem_of(file) + ", " + rate_text(*rate);
        curves.push_back({at_rate(name, temperature, std::move(density), *rate), file + ":" + rate_text(*rate)});
    }
    return curves;
}

}  // namespace

std::vector<MeasuredCurve> read_curves(const std::string& text, const Dilatometer& dilatometer) {
    const auto [file, chosen] = named(text);
    const io::CsvTable table(file);
    const std::vector<double> temperature = table.required(temperature_names, io::Dimension::temperature);
    std::vector<MeasuredCurve> curves;
    if (const auto time = table.column(time_names, io::Dimension::time)) {
        if (!chosen.empty()) throw Error(file + ": has times of its own, which leave no place for the heating rate " + chosen);
        check_ascending(*time, "time", table);
        auto density = density_column(table, temperature, dilatometer, file);
        if (!density) throw Error(file + ": has no column 'relative_density' and none of shrinkage, 'dL/L0'");
        curves.push_back({along_table(stem_of(file), *time, temperature, std::move(*density)), file});
    } else {
        check_ascending(temperature, "temperature", table);
        curves = rate_columns(table, temperature, file);
        if (curves.empty()) {
            auto density = density_column(table, temperature, dilatometer, file);
            if (!density)
                throw Error(file + ": has no column of density or shrinkage, and none headed by a heating rate, '5 K/min'");
            if (chosen.empty()) throw Error(file + ": has neither times nor a heating rate; give that as in " + file + ":5K/min");
            curves.push_back({at_rate(stem_of(file), temperature, std::move(*density), *rate_of(chosen)), file});
        } else if (!chosen.empty()) {
            const std::string wanted = file + ":" + rate_text(*rate_of(chosen));
            std::erase_if(curves, [&](const MeasuredCurve& curve) { return curve.source != wanted; });
            if (curves.empty()) throw Error(file + ": has no column headed " + rate_text(*rate_of(chosen)));
        }
    }
    for (const MeasuredCurve& curve : curves) check_densities(curve.curve.density, table);
    return curves;
}

DensityCurve read_firing(const std::string& text, bool required) {
    const std::size_t mark = text.find('=');
    if (mark == std::string::npos && required)
        throw TextError("'" + text + "' has no density, as in \"25C 10K/min 1200C 1h = 0.79\"");
    const std::string words = text.substr(0, mark);
    const physics::Schedule schedule = io::parse_schedule(words);
    double density = std::nan("");
    if (mark != std::string::npos) density = io::parse_quantity(text.substr(mark + 1), io::Dimension::fraction);
    if (!(std::isnan(density) || (density > 0.0 && density <= 1.0)))
        throw TextError("'" + text + "': a relative density lies between 0 and 1");
    const std::size_t first = words.find_first_not_of(' '), last = words.find_last_not_of(' ');
    return {words.substr(first, last + 1 - first), schedule, {schedule.end()}, {density}};
}

std::vector<analysis::GrainSize> read_grain_sizes(const std::string& file) {
    using io::Dimension;
    const io::CsvTable table(file);
    const std::vector<double> density = table.required(density_names, Dimension::fraction);
    auto diameter = table.column({"grain size", "grain_size", "grain diameter", "grain_diameter", "diameter"}, Dimension::length);
    double factor = 1.0;
    if (!diameter) {
        diameter = table.column({"mean intercept", "mean_intercept", "intercept"}, Dimension::length);
        factor = linear_intercept;
    }
    if (!diameter) throw Error(file + ": has no column 'grain size' and none 'mean intercept'");
    const auto error = table.column({"standard_error", "standard error", "error"}, Dimension::length);
    check_densities(density, table);
    std::vector<analysis::GrainSize> sizes;
    for (std::size_t row = 0; row < density.size(); ++row) {
        const double size = factor * (*diameter)[row];
        if (!(size > 0.0)) throw Error(table.place(row) + ": the grain size is not above zero");
        const double relative = error ? factor * (*error)[row] / size : default_size_error;
        if (!(relative > 0.0)) throw Error(table.place(row) + ": the standard error is not above zero");
        sizes.push_back({density[row], size, relative});
    }
    return sizes;
}

namespace {

/// What a state says of the runs of its history.
struct RunOptions {
    std::string body;      // which runs belong together
    std::string schedule;  // of the last run of sinter; empty if there is none
    bool surface = false;  // it had grains exchange volume by surface diffusion
};

/// Options that may differ between the runs of one body.
constexpr const char* of_one_run[] = {"--schedule", "--temperature", "--to-density", "--at-time",
                                      "--every",    "--material",    "--report",     "--tolerance"};

RunOptions options_of(const State& state) {
    RunOptions options;
    for (const Json& entry : io::history_of(state)) {
        if (!entry.is_object() || !entry.contains("tool") || !entry.contains("arguments") || !entry["arguments"].is_array())
            continue;
        const bool run = entry["tool"] == "sinter";
        options.body += entry["tool"].dump();
        const Json& arguments = entry["arguments"];
        for (std::size_t place = 0; place < arguments.size(); ++place) {
            const Json value = place + 1 < arguments.size() ? arguments[place + 1] : Json();
            if (run && arguments[place] == "--schedule" && value.is_string()) options.schedule = value.get<std::string>();
            if (run && arguments[place] == "--coarsening" && value.is_string())
                options.surface = value.get<std::string>().find("surface") != std::string::npos;
            if (std::ranges::find(of_one_run, arguments[place]) != std::end(of_one_run))
                ++place;  // and its value
            else
                options.body += " " + arguments[place].dump();
        }
        if (entry.contains("seed")) options.body += " seed " + entry["seed"].dump();
    }
    return options;
}

/// The schedule that a run was given in words; nothing for one out of a furnace's log.
std::optional<physics::Schedule> schedule_in_words(const std::string& words, double start) {
    if (words.empty()) return std::nullopt;
    try {
        return io::parse_schedule(words).from(start);
    } catch (const TextError&) {
        return std::nullopt;
    }
}

/// delta_s D_s of a material, which a run with surface diffusion had to have.
std::optional<analysis::Activated> surface_of(const Material& material) {
    const Json json = io::material_json(material);
    if (!json.contains("surface_diffusion")) throw Error("material '" + material.name + "' has no surface_diffusion");
    const Json& surface = json["surface_diffusion"];
    return analysis::Activated{io::number_from(surface["prefactor"], "surface_diffusion.prefactor", 0.0),
                               io::number_from(surface["activation_energy"], "surface_diffusion.activation_energy", 0.0)};
}

/// Collects runs line by line.
class Reader {
   public:
    explicit Reader(const std::optional<Material>& material) : material_(material) {}

    void take(io::Document document) {
        const std::string file = document.place.substr(0, document.place.rfind(", document"));
        if (document.header.contains("particles") || document.header.contains("box") || !document.particles.empty()) {
            finish();
            state_ = io::state_from(std::move(document));
            if (state_->materials.size() > 1) throw Error("has several materials; kinetics are those of one");
            return;
        }
        if (!document.header.contains("duration") || !document.header.contains("relative_density"))
            throw Error("is neither a state nor a line of sinter --history");
        Line line{number_at(document, "time", std::numeric_limits<double>::lowest()), number_at(document, "duration", 0.0),
                  positive_at(document, "temperature"), positive_at(document, "relative_density"), 0.0, std::nullopt};
        const Json& strain = document.header["strain"];
        if (!strain.is_array() || strain.size() != 3) throw Error("strain is not a list of three numbers");
        for (const Json& axis : strain) line.strain += io::number_from(axis, "strain", std::numeric_limits<double>::lowest());
        if (document.header.contains("grains") && lines_.empty())
            grains_ = static_cast<std::size_t>(positive_at(document, "grains"));
        if (document.header.contains("mean_grain_diameter")) line.diameter = positive_at(document, "mean_grain_diameter");
        if (!lines_.empty() && (file != file_ || line.time <= lines_.back().time)) finish();
        file_ = file;
        lines_.push_back(line);
    }

    std::vector<Body> finished() {
        finish();
        return std::move(bodies_);
    }

   private:
    struct Line {
        double time, duration, temperature, density, strain;
        std::optional<double> diameter;
    };

    /// Straight from line to line; at the start on the line through the first two.
    physics::Schedule schedule_of_lines(double start) const {
        double first = lines_.front().temperature;
        if (lines_.size() > 1) {
            const double slope = (lines_[1].temperature - first) / (lines_[1].time - lines_[0].time);
            first = std::max(first - slope * lines_.front().duration, std::min(room_temperature, first));
        }
        std::vector<physics::Schedule::Corner> corners{{start, first}};
        for (const Line& line : lines_) corners.push_back({line.time, line.temperature});
        return physics::Schedule(std::move(corners));
    }

    void finish() {
        if (lines_.empty()) return;
        const RunOptions options = state_ ? options_of(*state_) : RunOptions{"alone " + std::to_string(bodies_.size()), "", false};
        const double start = lines_.front().time - lines_.front().duration;
        const bool named = state_ && !state_->materials.empty() && !io::is_assumed(state_->materials.front());
        if (!named && !material_)
            throw io::PlacedError(file_ +
                                  ": no state before this history names a material; --material NAME or FILE.json says what it is");
        const Material& material = named ? state_->materials.front() : *material_;
        SimulatedRun run{file_,
                         material,
                         options.surface ? surface_of(material) : std::nullopt,
                         schedule_in_words(options.schedule, start).value_or(schedule_of_lines(start)),
                         {start},
                         {lines_.front().density * std::exp(lines_.front().strain)},
                         {}};
        const bool sized = std::ranges::all_of(lines_, [](const Line& line) { return line.diameter.has_value(); });
        if (sized) run.grain_diameter.push_back(*lines_.front().diameter);
        for (const Line& line : lines_) {
            run.time.push_back(line.time);
            run.density.push_back(line.density);
            if (sized) run.grain_diameter.push_back(*line.diameter);
        }
        auto body = std::ranges::find(keys_, options.body);
        if (body == keys_.end()) {
            body = keys_.insert(keys_.end(), options.body);
            bodies_.push_back({file_, std::max(grains_, state_ ? state_->particles.size() : 0), {}});
        }
        bodies_[static_cast<std::size_t>(body - keys_.begin())].runs.push_back(std::move(run));
        lines_.clear();
        state_.reset();
        grains_ = 0;
    }

    const std::optional<Material>& material_;
    std::optional<State> state_;
    std::string file_;
    std::vector<Line> lines_;
    std::size_t grains_ = 0;  // after the first step; the state may have fewer
    std::vector<std::string> keys_;
    std::vector<Body> bodies_;
};

}  // namespace

std::vector<Body> read_bodies(const std::vector<std::string>& files, const std::optional<Material>& material) {
    Reader reader(material);
    io::Input input(files, cli::stop_requested);
    cli::for_each_document(input, [&](io::Document document) { reader.take(std::move(document)); });
    return reader.finished();
}

}  // namespace kiln::analyze
