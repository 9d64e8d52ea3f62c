// measured_test.cpp: which columns of a machine's export are force and deflection, and their signs.
#include "tools/analyze/measured_test.h"

#include <algorithm>
#include <span>

#include "analysis/line_fit.h"
#include "analysis/slenderness.h"
#include "core/types.h"
#include "io/files.h"
#include "tools/analyze/results.h"
#include "tools/common/quantity_options.h"

namespace kiln::analyze {

namespace {

/// Turns values that are compression counted negative: the largest is so. Whether it did.
bool turn_negative(std::vector<double>& values) {
    const auto [least, most] = std::ranges::minmax(values);
    if (-least <= most) return false;
    for (double& value : values) value = 0.0 - value;  // and not -value: no zero is to be negative
    return true;
}

/// Turns a deflection that falls while the force grows to its largest: a position of the machine, or compression counted negative.
bool turn_falling(std::vector<double>& deflection, const std::vector<double>& force) {
    auto rising = static_cast<std::size_t>(std::distance(force.begin(), std::ranges::max_element(force))) + 1;
    if (rising < 3) rising = force.size();
    if (!(analysis::fit_line(std::span(force).first(rising), std::span(deflection).first(rising)).slope < 0.0)) return false;
    for (double& value : deflection) value = 0.0 - value;
    return true;
}

}  // namespace

const io::ColumnNames force_names{"force",       "load",           "kraft",         "standardkraft",   "pr\u00fcfkraft",
                                  "pruefkraft",  "flexure load",   "flexural load", "compressive load"};
const io::ColumnNames gauge_names{"deflection", "displacement", "durchbiegung", "verformung", "deformation"};
const io::ColumnNames travel_names{"extension", "flexure extension", "compressive extension", "stroke",       "travel", "crosshead",
                                   "punch",     "position",          "weg",                   "standardweg",  "traversenweg"};

void ColumnOptions::add_to(CLI::App& app) {
    app.add_option("--force-column", force, "Heading of the force in a table, where it is not clear; case and unit may be left out")
        ->type_name("HEADING");
    app.add_option("--deflection-column", deflection, "Heading of the deflection in a table, where it is not clear")
        ->type_name("HEADING");
}

void ColumnOptions::refuse_with_documents() const {
    if (!force.empty()) throw Error("is no table, for which --force-column has no meaning");
    if (!deflection.empty()) throw Error("is no table, for which --deflection-column has no meaning");
}

void add_optional(CLI::App& app, const std::string& name, std::optional<double>& target, io::Dimension dimension,
                  const std::string& help) {
    const std::string known = io::known_units(dimension);
    app.add_option_function<std::string>(
           name,
           [&target, name, dimension](const std::string& text) {
               target = cli::parsed(name, [&] { return io::parse_quantity(text, dimension); });
               if (!(*target > 0.0)) throw CLI::ValidationError(name, "must be greater than zero");
           },
           help + (known.empty() ? "" : " [" + known + "]"))
        ->type_name(known.empty() ? "NUMBER" : "QUANTITY");
}

void BarOptions::add_to(CLI::App& app) {
    add_optional(app, "--span", span, io::Dimension::length, "Distance between the supports");
    add_optional(app, "--width", width, io::Dimension::length, "Width of the bar");
    add_optional(app, "--height", height, io::Dimension::length, "Height of the bar, along the load");
    app.add_flag("--allow-block", allow_block,
                 "Also take tests whose span L is below twice the height h, for which the formulas of beams do not hold. Below "
                 "L/h = 4 there is a warning, which the result keeps");
}

double BarOptions::size(const io::Document& document, const std::string& key) const {
    const std::optional<double>& given = key == "span" ? span : key == "width" ? width : height;
    if (given) return *given;
    if (is_measured(document) && !document.header.contains(key)) throw Error("--" + key + " is needed with a table");
    return positive_at(document, key);
}

void BarOptions::refuse_block(const io::Document& document) const {
    const bool allowed_there = document.header.contains("slenderness") && !span && !height;
    if (!allow_block && !allowed_there) analysis::refuse_block(size(document, "span"), size(document, "height"), "--allow-block");
}

std::vector<std::string> BarOptions::warnings(const io::Document& document) const {
    std::vector<std::string> sentences = warnings_at(document);
    if (span || height) std::erase_if(sentences, analysis::is_short_bar_warning);
    return sentences;
}

std::optional<std::string> BarOptions::short_bar_warning(const io::Document& document,
                                                         std::optional<double> shear_correction) const {
    if (std::ranges::any_of(warnings(document), analysis::is_short_bar_warning)) return std::nullopt;
    return analysis::short_bar_warning(size(document, "span"), size(document, "height"), shear_correction);
}

Curve curve_of(const io::Document& document) {
    Curve curve{numbers_at(document, "curve", "deflection"), numbers_at(document, "curve", "punch"),
                numbers_at(document, "curve", "force")};
    const std::size_t points = curve.force.size();
    if (curve.deflection.size() != points || curve.punch.size() != points)
        throw Error("curve has " + std::to_string(curve.deflection.size()) + " deflections, " +
                    std::to_string(curve.punch.size()) + " punch positions and " + std::to_string(points) + " forces");
    return curve;
}

io::Document measured_test(const io::CsvTable& table, const std::string& file, const ColumnOptions& options,
                           bool needs_deflection) {
    using io::Dimension;
    const std::size_t force_column = table.get(force_names, Dimension::force, {"--force-column", options.force});
    std::vector<double> force = table.values(force_column, Dimension::force);
    Json columns{{"force", table.heading(force_column)}}, turned = Json::array();
    Json curve = Json::object();
    if (turn_negative(force)) turned.push_back("force");

    const io::ColumnChoice choice{"--deflection-column", options.deflection};
    auto gauge = table.find(gauge_names, Dimension::length, choice);
    if (!gauge) gauge = table.find(travel_names, Dimension::length, choice);
    if (!gauge && needs_deflection) table.get(gauge_names, Dimension::length, choice);
    if (gauge) {
        std::vector<double> deflection = table.values(*gauge, Dimension::length);
        columns["deflection"] = table.heading(*gauge);
        if (turn_falling(deflection, force)) turned.push_back("deflection");
        curve["deflection"] = deflection;
        auto punch = table.column({"punch", "travel", "crosshead"}, Dimension::length);
        if (punch) turn_falling(*punch, force);
        curve["punch"] = punch ? std::move(*punch) : std::move(deflection);
    }
    curve["force"] = std::move(force);

    io::Document document;
    document.place = file;
    document.header = {{"format", "dem-bend"}, {"method", "experiment"}, {"curve", curve}, {"columns", columns},
                       {"turned", turned}};
    return document;
}

bool is_measured(const io::Document& document) {
    return document.header.contains("method") && document.header["method"] == "experiment";
}

std::string turned_sentence(const io::Document& document) {
    const Json& turned = document.header["turned"];
    std::string names;
    for (const Json& name : turned) names += (names.empty() ? "" : " and ") + name.get<std::string>();
    return document.place + ": compression counts negative: the sign of " + names + " is turned";
}

void write_plot(const std::string& file, const std::string& svg) {
    if (file.empty()) return;
    io::Output output(file, true);
    output.write_text(svg);
    output.commit();
}

}  // namespace kiln::analyze
