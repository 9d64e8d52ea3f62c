// furnace_log.cpp: columns of time and temperature, times of the clock, and what cannot be a firing.
#include "io/furnace_log.h"

#include <charconv>
#include <chrono>
#include <optional>
#include <vector>

#include "core/types.h"
#include "io/csv.h"

namespace kiln::io {

namespace {

constexpr double coldest = 200.0;  // K; what is colder was not in K
constexpr double hottest = 4000.0;  // K
constexpr double day = 86400.0;    // s

const ColumnNames letter{"t$"};  // of both, once no word is found; their units tell them apart
const ColumnNames time_names{"time", "elapsed time", "elapsed", "run time", "runtime", "timestamp", "time stamp", "date time",
                             "datetime", "zeit", "laufzeit", "uhrzeit", "temps", "tiempo", "tempo"};
const ColumnNames temperature_names{"temperature",
                                    "temp",
                                    "temp.",
                                    "temperatur",
                                    "t ist",
                                    "furnace temperature",
                                    "sample temperature",
                                    "actual temperature",
                                    "measured temperature",
                                    "oven temperature",
                                    "ist-temperatur",
                                    "isttemperatur",
                                    "ofentemperatur",
                                    "probentemperatur",
                                    "pv",
                                    "actual",
                                    "ist",
                                    "istwert"};

/// Takes digits from the front of a text, at most so many; nothing where there is none.
std::optional<int> digits(std::string_view& text, std::size_t most) {
    const std::size_t count = std::min(text.find_first_not_of("0123456789"), text.size());
    if (count == 0 || count > most) return std::nullopt;
    int number = 0;
    std::from_chars(text.data(), text.data() + count, number);
    text.remove_prefix(count);
    return number;
}

bool takes(std::string_view& text, std::string_view sign) {
    if (!text.starts_with(sign)) return false;
    text.remove_prefix(sign.size());
    return true;
}

/// Days since 1970 of "2026-11-25" or "25.11.2026", taken from the front of a text; nothing for another form, such as 11/25/26,
/// whose first number may be a month or a day.
std::optional<double> date_from(std::string_view& text) {
    std::string_view rest = text;
    std::optional<int> year, month, date;
    if (const auto first = digits(rest, 4); first && takes(rest, "-")) {
        year = first;
        month = digits(rest, 2);
        if (takes(rest, "-")) date = digits(rest, 2);
    } else if (first && takes(rest, ".")) {
        date = first;
        month = digits(rest, 2);
        if (takes(rest, ".")) year = digits(rest, 4);
    }
    if (!year || !month || !date) return std::nullopt;
    const std::chrono::year_month_day calendar{std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                               std::chrono::day(static_cast<unsigned>(*date))};
    if (!calendar.ok()) return std::nullopt;
    text = rest;
    return static_cast<double>(std::chrono::sys_days(calendar).time_since_epoch().count());
}

/// Seconds of "10:03", "10:03:22" or "123:03:22.5", elapsed hours included, with the days of a date before it.
std::optional<double> clock_from(std::string_view text) {
    double seconds = 0.0;
    if (const auto days = date_from(text)) {
        seconds = day * *days;
        if (!takes(text, "T") && !takes(text, " ")) return std::nullopt;
        while (takes(text, " ")) continue;
    }
    const auto hours = digits(text, 6);
    if (!hours || !takes(text, ":")) return std::nullopt;
    const auto minutes = digits(text, 2);
    if (!minutes || *minutes > 59) return std::nullopt;
    seconds += 3600.0 * *hours + 60.0 * *minutes;
    if (takes(text, ":")) {
        const auto rest = number_in(text, true);
        if (!rest || !(*rest >= 0.0 && *rest < 60.0)) return std::nullopt;
        return seconds + *rest;
    }
    return text.empty() ? std::optional(seconds) : std::nullopt;
}

/// Times of the column, s; also where they are those of a clock.
std::vector<double> times_of(const CsvTable& table, std::size_t column) {
    const bool clock = table.unit(column).empty() || !scale_of(table.unit(column), Dimension::time);
    if (!clock || table.cell(0, column).find(':') == std::string_view::npos) return table.values(column, Dimension::time);
    const auto date = table.find({"date", "datum"}, Dimension::none);
    std::vector<double> times;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        std::string text(table.cell(row, column));
        if (date && *date != column) text = std::string(table.cell(row, *date)) + " " + text;
        const auto time = clock_from(text);
        if (!time)
            throw Error(table.place(row) + ": " + excerpt(text) +
                        " is no time; known here: 10:03:22, 2026-11-25 10:03:22, 25.11.2026 10:03:22, or numbers with a unit");
        times.push_back(*time);
    }
    return times;
}

std::size_t time_column(const CsvTable& table, const std::string& chosen) {
    const ColumnChoice choice{"--time-column", chosen};
    for (const ColumnNames& names : {time_names, ColumnNames{"date", "datum"}, letter})
        if (const auto found = table.find(names, Dimension::time, choice)) return *found;
    return table.get(time_names, Dimension::time, choice);
}

std::size_t temperature_column(const CsvTable& table, const std::string& chosen) {
    const ColumnChoice choice{"--temperature-column", chosen};
    for (const ColumnNames& names : {temperature_names, letter})
        if (const auto found = table.find(names, Dimension::temperature, choice)) return *found;
    return table.get(temperature_names, Dimension::temperature, choice);
}

}  // namespace

physics::Schedule read_schedule(const std::string& file, const LogColumns& columns) {
    const CsvTable table(file);
    const std::vector<double> times = times_of(table, time_column(table, columns.time));
    const std::size_t column = temperature_column(table, columns.temperature);
    const std::vector<double> temperatures = table.values(column, Dimension::temperature);
    if (times.size() < 2) throw Error(file + ": has one row, which is no schedule; --temperature holds one temperature");
    std::vector<physics::Schedule::Corner> corners;
    for (std::size_t row = 0; row < times.size(); ++row) {
        const std::string given = excerpt(table.cell(row, column)) + " " + table.unit(column);
        if (temperatures[row] < coldest) throw Error(table.place(row) + ": " + given + " is colder than any furnace; see the unit");
        if (temperatures[row] > hottest) throw Error(table.place(row) + ": " + given + " is hotter than any furnace; see the unit");
        if (row > 0 && times[row] < times[row - 1]) throw Error(table.place(row) + ": the time goes back");
        const bool held = corners.size() > 1 && temperatures[row] == corners.back().temperature &&
                          temperatures[row] == corners[corners.size() - 2].temperature;
        if (held) corners.pop_back();
        corners.push_back({times[row] - times[0], temperatures[row]});
    }
    if (!(corners.back().time > 0.0)) throw Error(file + ": all rows have the same time");
    return physics::Schedule(std::move(corners));
}

}  // namespace kiln::io
