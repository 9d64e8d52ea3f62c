"""figure_kinetics.py: measured densities against temperature, the fitted curves, what was held out, and the band between bodies."""
import numpy

import style
from style import pyplot

ZERO_CELSIUS = 273.15  # K


def short(name):
    """The heating rate of "alumina, 5 K/min"; another name as it is."""
    return name.rsplit(", ", 1)[-1]


def celsius(values):
    return numpy.array(values) - ZERO_CELSIUS


def draw_curve(axes, measured, band, colour):
    """One firing: points, line and band; what was held out is dashed, with open points."""
    held_out = measured["held_out"]
    label = short(measured["name"]) + (", not fitted" if held_out else "")
    if band is not None:
        axes.fill_between(celsius(band["temperature"]), band["minimum"], band["maximum"], color=colour, alpha=0.18, linewidth=0)
        axes.plot(celsius(band["temperature"]), band["relative_density"], color=colour, linestyle="--" if held_out else "-")
    density = measured["relative_density"]
    if density is not None:
        axes.plot(celsius(measured["temperature"]), density, "o", color=colour, markersize=4.5,
                  markerfacecolor="white" if held_out else colour, label=label, zorder=3)


def draw_deviation(axes, measured, curve, colour):
    """How far the curve of the first body lies below the measured densities."""
    off = numpy.array(measured["relative_density"]) - numpy.array(curve["relative_density"])
    axes.plot(celsius(measured["temperature"]), off, "o--" if measured["held_out"] else "o-", color=colour, markersize=3,
              linewidth=0.9, markerfacecolor="white" if measured["held_out"] else colour)


def draw(result):
    """result: a dem-kinetics document."""
    curves = sorted((curve for curve in result["curves"] if len(curve["time"]) > 1), key=lambda curve: -curve["time"][-1])
    bands = {band["name"]: band for band in result.get("band", [])}
    fitted = {curve["name"]: curve for curve in result["bodies"][0]["curves"]} if "bodies" in result else {}
    rows = 2 if fitted else 1
    figure, axes = pyplot.subplots(rows, 1, figsize=(style.WIDTH, 4.6 if fitted else 3.6), sharex=True, squeeze=False,
                                   height_ratios=[3, 1][:rows])
    colours = [style.SERIES[place * (len(style.SERIES) - 1) // max(len(curves) - 1, 1)] for place in range(len(curves))]
    for curve, colour in zip(curves, colours):
        draw_curve(axes[0, 0], curve, bands.get(curve["name"]), colour)
        if curve["name"] in fitted and curve["relative_density"] is not None:
            draw_deviation(axes[1, 0], curve, fitted[curve["name"]], colour)
    axes[0, 0].legend(loc="upper left")
    axes[0, 0].set_ylabel("Relative density")
    if fitted:
        axes[1, 0].axhline(0.0, color=style.REFERENCE, linewidth=0.8)
        axes[1, 0].set_ylabel("Measured\nless curve")
    axes[-1, 0].set_xlabel("Temperature, \u00b0C")
    return figure


def main():
    given = style.arguments(__doc__, ("result", "JSON of analyze kinetics"))
    style.save(draw(style.documents(given.result, "dem-kinetics", "which analyze kinetics writes", "curves")[0]), given.output)


if __name__ == "__main__":
    main()
