// chart.cpp: axes, curves and points as SVG.
#include "io/chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace kiln::io {

namespace {

// Of the picture and the field in it, px.
constexpr double width = 560.0, height = 380.0, left = 72.0, right = 20.0, top = 40.0, bottom = 52.0;
constexpr double margin = 0.04;     // of the range of values, left free on both sides
constexpr double tick_length = 5.0;  // px
constexpr double line_height = 17.0;  // px, of the legend
constexpr int usual_ticks = 8;

/// With so many decimals, and no negative zero.
std::string decimals(double value, int digits) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    const std::string shown = text;
    return shown.find_first_of("123456789") == std::string::npos && shown.starts_with('-') ? shown.substr(1) : shown;
}

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
    return result;
}

/// One of the two directions: its values and where they lie in the picture, px.
struct Axis {
    double lower, upper;
    double start, end;

    [[nodiscard]] double at(double value) const { return start + (end - start) * (value - lower) / (upper - lower); }
};

Axis axis_over(const Chart& chart, std::vector<double> ChartSeries::* values, double start, double end) {
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (const ChartSeries& series : chart.series)
        for (const double value : series.*values) {
            lower = std::min(lower, value);
            upper = std::max(upper, value);
        }
    const double free = margin * (upper - lower);
    return {lower - free, upper + free, start, end};
}

std::string tag_text(double x, double y, const std::string& anchor, const std::string& text, const std::string& more = "") {
    return "<text x=\"" + decimals(x, 1) + "\" y=\"" + decimals(y, 1) + "\" text-anchor=\"" + anchor + "\"" + more + ">" +
           escaped(text) + "</text>\n";
}

std::string tag_line(double x1, double y1, double x2, double y2) {
    return "<path d=\"M" + decimals(x1, 1) + " " + decimals(y1, 1) + "L" + decimals(x2, 1) + " " + decimals(y2, 1) + "\"/>\n";
}

/// Points of a curve, of which those are left out that lie where the one before does.
std::string curve_of(const ChartSeries& series, const Axis& x, const Axis& y) {
    std::string path, before;
    for (std::size_t point = 0; point < series.x.size(); ++point) {
        const std::string here = decimals(x.at(series.x[point]), 1) + " " + decimals(y.at(series.y[point]), 1);
        if (here == before) continue;
        path += (path.empty() ? "M" : "L") + here;
        before = here;
    }
    return path;
}

std::string series_tag(const ChartSeries& series, const Axis& x, const Axis& y) {
    if (!series.dots)
        return "<path d=\"" + curve_of(series, x, y) + "\" fill=\"none\" stroke=\"" + series.colour + "\" stroke-width=\"1.6\"/>\n";
    std::string dots = "<g fill=\"" + series.colour + "\">\n", before;
    for (std::size_t point = 0; point < series.x.size(); ++point) {
        const std::string here =
            "cx=\"" + decimals(x.at(series.x[point]), 1) + "\" cy=\"" + decimals(y.at(series.y[point]), 1) + "\"";
        if (here != before) dots += "<circle " + here + " r=\"3\"/>\n";
        before = here;
    }
    return dots + "</g>\n";
}

std::string axes_tag(const Chart& chart, const Axis& x, const Axis& y) {
    std::string lines =
        tag_line(left, top, left, height - bottom) + tag_line(left, height - bottom, width - right, height - bottom);
    std::string labels;
    for (const ChartTick& tick : chart.x_ticks.empty() ? round_ticks(x.lower, x.upper) : chart.x_ticks) {
        if (tick.at < x.lower || tick.at > x.upper) continue;
        lines += tag_line(x.at(tick.at), height - bottom, x.at(tick.at), height - bottom + tick_length);
        labels += tag_text(x.at(tick.at), height - bottom + 20.0, "middle", tick.label);
    }
    for (const ChartTick& tick : chart.y_ticks.empty() ? round_ticks(y.lower, y.upper) : chart.y_ticks) {
        if (tick.at < y.lower || tick.at > y.upper) continue;
        lines += tag_line(left - tick_length, y.at(tick.at), left, y.at(tick.at));
        labels += tag_text(left - 9.0, y.at(tick.at) + 4.0, "end", tick.label);
    }
    const double middle_x = 0.5 * (left + width - right), middle_y = 0.5 * (top + height - bottom);
    labels += tag_text(middle_x, height - 12.0, "middle", chart.x_label);
    labels += tag_text(16.0, middle_y, "middle", chart.y_label,
                       " transform=\"rotate(-90 16.0 " + decimals(middle_y, 1) + ")\"");
    labels += tag_text(middle_x, 24.0, "middle", chart.title);
    return "<g stroke=\"black\" fill=\"none\">\n" + lines + "</g>\n" + labels;
}

/// In the upper left corner, where curves that rise leave room.
std::string legend_tag(const Chart& chart) {
    std::string tags;
    double y = top + 10.0;
    for (const ChartSeries& series : chart.series) {
        if (series.label.empty()) continue;
        tags += series.dots ? "<circle cx=\"" + decimals(left + 24.0, 1) + "\" cy=\"" + decimals(y, 1) + "\" r=\"3\" fill=\"" +
                                  series.colour + "\"/>\n"
                            : "<g stroke=\"" + series.colour + "\" stroke-width=\"1.6\">" +
                                  tag_line(left + 14.0, y, left + 34.0, y) + "</g>\n";
        tags += tag_text(left + 42.0, y + 4.0, "start", series.label);
        y += line_height;
    }
    return tags;
}

}  // namespace

std::vector<ChartTick> round_ticks(double lower, double upper) {
    const double rough = (upper - lower) / usual_ticks;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    const double step = power * (rough <= power ? 1.0 : rough <= 2.0 * power ? 2.0 : rough <= 5.0 * power ? 5.0 : 10.0);
    const int digits = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
    std::vector<ChartTick> ticks;
    for (double number = std::ceil(lower / step); number * step <= upper; number += 1.0)
        ticks.push_back({number * step, decimals(number * step, digits)});
    return ticks;
}

std::string svg_of(const Chart& chart) {
    const Axis x = axis_over(chart, &ChartSeries::x, left, width - right);
    const Axis y = axis_over(chart, &ChartSeries::y, height - bottom, top);
    const std::string size = decimals(width, 0) + "\" height=\"" + decimals(height, 0);
    std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + size +
                      "\" font-family=\"sans-serif\" font-size=\"12\">\n"
                      "<rect width=\"" +
                      size + "\" fill=\"white\"/>\n";
    svg += axes_tag(chart, x, y);
    for (const ChartSeries& series : chart.series) svg += series_tag(series, x, y);
    return svg + legend_tag(chart) + "</svg>\n";
}

}  // namespace kiln::io
