// chart.h: a picture of curves and points as SVG.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace kiln::io {

struct ChartSeries {
    std::string label;   // for the legend; empty: not in it
    std::string colour;  // "#0072b2"
    bool dots;           // a dot for each point, else a line through all
    std::vector<double> x, y;
};

struct ChartTick {
    double at;
    std::string label;
};

struct Chart {
    std::string title, x_label, y_label;
    std::vector<ChartSeries> series;  // the first lies lowest
    std::vector<ChartTick> x_ticks, y_ticks;  // empty: at round numbers
};

/// Colours of the figures of workflows/post, which stay apart in grey and for colour-blind readers.
inline constexpr const char *chart_grey = "#707070", *chart_blue = "#0072b2", *chart_red = "#d55e00";

/// Ticks at multiples of 1, 2 or 5 times a power of ten between two values.
std::vector<ChartTick> round_ticks(double lower, double upper);

/// The picture as the text of an SVG file. The series have finite values, as many of x as of y, and two different ones of each in
/// all.
std::string svg_of(const Chart& chart);

}  // namespace kiln::io
