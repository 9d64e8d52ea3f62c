"""figure_study.py: the figures of a study, each as svg, pdf and png: densification, structure, Young's modulus, conductivity, and
where several cases are there, one that compares them. Fonts are in the files: glyphs as paths in svg, TrueType in pdf."""
import argparse
import itertools
import json
import pathlib

import numpy

import style
import units
from figure_modulus import SHAPE
from style import GPA, NM, pyplot
from units import ZERO_CELSIUS

BEYOND = 0.92  # relative density above which pores are closed and grains grow, which the model does not have
MANY = 12  # cases; more are not told apart by colours in one legend
MARKS = "os^Dv<>p"

pyplot.rcParams.update({"svg.fonttype": "path", "pdf.fonttype": 42})


def colours_of(cases):
    if len(cases) <= 1:
        return [style.LINE]
    if len(cases) <= len(style.SERIES):
        return list(style.SERIES[:len(cases)])
    return [pyplot.get_cmap("viridis")(0.9 * k / (len(cases) - 1)) for k in range(len(cases))]


def means_of(case, key, factor=1.0):
    """Densities, means and half intervals of the states that have a quantity."""
    rows = [row for row in case["states"] if key in row]
    density = numpy.array([row["relative_density"]["mean"] for row in rows])
    mean = numpy.array([row[key]["mean"] for row in rows]) * factor
    half = [0.0 if row[key]["lower"] is None else (row[key]["upper"] - row[key]["lower"]) / 2 * factor for row in rows]
    return density, mean, numpy.array(half)


def curves(axes, cases, colours, x, y, name=True):
    """Every packing as a line; x, y: functions of a curve."""
    for case, colour in zip(cases, colours):
        for k, each in enumerate(case["curves"]):
            label = (case["name"] if len(cases) > 1 else "simulated") if name and k == 0 else None
            axes.plot(x(each), y(each), color=colour, linewidth=1.2, alpha=0.85, label=label)


def array(key, factor=1.0, shift=0.0):
    return lambda curve: numpy.array(curve[key]) * factor + shift


def shade_beyond(axes, cases):
    """Marks where the model says little."""
    top = max((row["relative_density"]["mean"] for case in cases for row in case["states"]), default=0)
    right = axes.get_xlim()[1]
    if top > BEYOND and right > BEYOND:
        axes.axvspan(BEYOND, right, color=style.REFERENCE, alpha=0.12, linewidth=0, zorder=0)
        axes.annotate("pores closed", (BEYOND, 0.02), (3, 0), xycoords=("data", "axes fraction"), textcoords="offset points",
                      rotation=90, va="bottom", fontsize="x-small", color=style.REFERENCE)
        axes.set_xlim(right=right)


def finish(axes, cases, quantity):
    """What a figure of a quantity against density ends with."""
    shade_beyond(axes, cases)
    axes.set(xlabel="Relative density", ylabel=quantity)
    axes.set_ylim(bottom=0)
    if len(cases) <= MANY:
        axes.legend(fontsize="small", loc="upper left")


def legend(axes, cases):
    if 1 < len(cases) <= MANY:
        axes.legend(fontsize="small" if len(cases) <= 4 else "xx-small", loc="best")


def densification(cases, _, colours):
    """Density, its rate and the shrinkage against time and temperature."""
    heated = any(numpy.ptp(curve["temperature"]) > 1 for case in cases for curve in case["curves"])
    figure, ((first, second), (third, fourth)) = pyplot.subplots(2, 2, figsize=(7.2, 5.6))
    minutes, celsius = array("time", 1 / 60), array("temperature", 1.0, -ZERO_CELSIUS)
    density, shrinkage, rate = array("relative_density"), array("shrinkage", 100), array("rate", 6000)
    curves(first, cases, colours, minutes, density)
    first.set(xlabel="Time, min", ylabel="Relative density")
    legend(first, cases)
    if heated:
        curve = max((curve for case in cases for curve in case["curves"]), key=lambda curve: curve["time"][-1])
        hot = first.twinx()
        hot.plot(minutes(curve), celsius(curve), color=style.REFERENCE, linewidth=0.8, linestyle="--")
        hot.set_ylabel("Temperature, °C (dashed)", color=style.REFERENCE)
        hot.spines["right"].set_visible(True)
        curves(second, cases, colours, celsius, density)
        second.set(xlabel="Temperature, °C", ylabel="Relative density")
    else:
        curves(second, cases, colours, density, array("coordination_number"))
        second.set(xlabel="Relative density", ylabel="Coordination number")
    across, word = (celsius, "Temperature, °C") if heated else (density, "Relative density")
    curves(third, cases, colours, across, rate)
    third.set(xlabel=word, ylabel="Densification, %/min")
    if not heated:
        third.set_yscale("log")
    across, word = (celsius, "Temperature, °C") if heated else (minutes, "Time, min")
    curves(fourth, cases, colours, across, shrinkage)
    fourth.set(xlabel=word, ylabel="dL/L$_0$, %")
    curve = next((case["dilatometer"] for case in cases if "dilatometer" in case), None)
    if curve and heated:
        for axes, key, factor in ((second, "relative_density", 1.0), (fourth, "shrinkage", 100.0)):
            if key in curve:
                values = numpy.array(curve[key]) * factor
                axes.plot(curve["temperature"], values, "o", color="black", markersize=3, label="measured")
                axes.legend(fontsize="small")
    return figure


def structure(cases, _, colours):
    """Contacts, necks and grains against density."""
    grown = any("grain_diameter" in curve for case in cases for curve in case["curves"])
    figure, panels = pyplot.subplots(1, 3 if grown else 2, figsize=(8.6 if grown else 6.4, 3.1))
    curves(panels[0], cases, colours, array("relative_density"), array("coordination_number"), name=False)
    for key, axes, word, factor in (("coordination_number", panels[0], "Coordination number", 1.0),
                                    ("neck_ratio", panels[1], "Neck ratio x/D", 1.0),
                                    ("grain_diameter", panels[-1], "Mean grain diameter, nm", 1 / NM))[:3 if grown else 2]:
        for case, colour, mark in zip(cases, colours, itertools.cycle(MARKS)):
            density, mean, half = means_of(case, key, factor)
            axes.errorbar(density, mean, half, fmt=mark, color=colour, markersize=4, capsize=2,
                          linestyle="-" if axes is panels[1] else "", linewidth=1.0, label=case["name"])
        axes.set(xlabel="Relative density", ylabel=word)
    if grown:
        curves(panels[2], cases, colours, array("relative_density"), array("grain_diameter", 1 / NM), name=False)
    for axes in panels:
        shade_beyond(axes, cases)
    legend(panels[1], cases)
    return figure


def modulus(cases, measured, colours):
    figure, axes = pyplot.subplots(figsize=(style.WIDTH, 3.9))
    several = len(cases) > 1
    for case, colour, mark in zip(cases, colours, itertools.cycle(MARKS)):
        density, mean, half = means_of(case, "young_modulus", 1 / GPA)
        if not several and len(density) > 1:
            axes.fill_between(density, (1 - SHAPE) * mean, (1 + SHAPE) * mean, color=colour, alpha=0.15, linewidth=0,
                              label=f"shape of the neck, ±{100 * SHAPE:.0f} %")
        axes.errorbar(density, mean, half, fmt=mark + "-", color=colour, markersize=5, capsize=3, linewidth=1.2,
                      label=case["name"] if several else "periodic cell")
        density, mean, half = means_of(case, "bending_modulus", 1 / GPA)
        if len(density):
            axes.errorbar(density, mean, half, fmt=mark, color=colour if several else style.ACCENT, markerfacecolor="white",
                          markersize=5, capsize=3, label=None if several else "bar in bending")
    points = measured.get("moduli", [])
    if points:
        axes.plot([point["relative_density"] for point in points], [point["young_modulus"] / GPA for point in points], "s",
                  color="black", label="measured")
    finish(axes, cases, "Young's modulus, GPa")
    return figure


def conductivity(cases, _, colours):
    figure, axes = pyplot.subplots(figsize=(style.WIDTH, 3.6))
    for case, colour, mark in zip(cases, colours, itertools.cycle(MARKS)):
        density, mean, half = means_of(case, "conductivity")
        axes.errorbar(density, mean, half, fmt=mark + "-", color=colour, markersize=5, capsize=3, linewidth=1.2,
                      label=case["name"] if len(cases) > 1 else "necks of the packing")
    bounds = sorted((row["relative_density"]["mean"], row["conductivity_bound"]) for case in cases for row in case["states"]
                    if "conductivity_bound" in row)
    axes.plot(*zip(*bounds), color=style.REFERENCE, linestyle="--", linewidth=1.0, label="Hashin\u2013Shtrikman bound")
    finish(axes, cases, "Conductivity, W/(m K)")
    return figure


# ---- the figure that compares cases ----------------------------------------------------------------------------------------------
def place_of(key, text):
    """The number on the axis that a varied value stands for, and the axis' unit; None for a word."""
    for dimension, factor, shift, unit in (("length", 1e9, 0.0, "nm"), ("temperature", 1.0, -ZERO_CELSIUS, "°C")):
        value = units.quantity(text, dimension)
        if value is not None:
            return (value + shift) * factor, unit
    try:
        return float(text), ""
    except ValueError:
        return None, ""


NAMES = {"size": "Size", "temperature": "Temperature", "density": "Green density", "material": "Material", "schedule": "Firing"}


def axis_of(cases, key):
    """Places of the cases along an axis, its label, and the words at its places where they are no numbers."""
    texts = [case["varied"][key] for case in cases]
    places = [place_of(key, text) for text in texts]
    name = NAMES[key]
    if any(place is None for place, _ in places):
        words = list(dict.fromkeys(texts))
        return [words.index(text) for text in texts], name, words
    unit = places[0][1]
    return [place for place, _ in places], f"{name}, {unit}" if unit else name, None


def comparison(cases, _, colours):
    """What each case ends with, against one of the things that vary, a line for each value of the others."""
    keys = list(cases[0]["varied"])
    along = next((key for key in ("temperature", "size", "density") if key in keys), keys[0])
    others = [key for key in keys if key != along]
    places, word, ticks = axis_of(cases, along)
    groups = list(dict.fromkeys(tuple(case["varied"][key] for key in others) for case in cases))
    ends = [case["states"][-1] if case["states"] else {} for case in cases]
    panels = []
    if numpy.ptp([end["relative_density"]["mean"] for end in ends if end] or [0]) > 1e-3:
        panels.append(("relative_density", "Relative density at the end", 1.0))
    else:
        panels.append(("time", "Time to the last state, min", 1 / 60))
    panels.append(("young_modulus", "Young's modulus at the end, GPa", 1 / GPA))
    figure, axes_list = pyplot.subplots(1, 2, figsize=(7.4, 3.4))
    for axes, (key, heading, factor) in zip(axes_list, panels):
        for group, colour, mark in zip(groups, colours_of(groups), itertools.cycle(MARKS)):
            rows = sorted(((place, end[key]) for place, case, end in zip(places, cases, ends)
                           if tuple(case["varied"][each] for each in others) == group and key in end), key=lambda row: row[0])
            if rows:
                mean = [entry["mean"] * factor for _, entry in rows]
                half = [0.0 if entry["lower"] is None else (entry["upper"] - entry["lower"]) / 2 * factor for _, entry in rows]
                axes.errorbar([place for place, _ in rows], mean, half, fmt=mark + "-", color=colour, markersize=5, capsize=3,
                              linewidth=1.2, label=", ".join(f"{NAMES[each]} {value}" for each, value in zip(others, group)))
        axes.set(xlabel=word, ylabel=heading)
        if along == "size" and not ticks and max(places) > 4 * min(places):
            axes.set_xscale("log")
        if ticks:
            axes.set_xticks(range(len(ticks)), ticks, rotation=20)
    if others:
        axes_list[0].legend(fontsize="small")
    if panels[0][0] == "time":
        axes_list[0].set_yscale("log")
    axes_list[1].set_ylim(bottom=0)
    return figure


def has(key):
    return lambda cases: any(key in row for case in cases for row in case["states"])


FIGURES = {  # name: what draws it, and whether there is something to draw
    "densification": (densification, lambda cases: any(case["curves"] for case in cases)),
    "structure": (structure, has("neck_ratio")),
    "modulus": (modulus, has("young_modulus")),
    "conductivity": (conductivity, has("conductivity")),
    "comparison": (comparison, lambda cases: len(cases) > 1 and any(case["states"] for case in cases)),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", type=pathlib.Path, help="study.json")
    parser.add_argument("--formats", nargs="+", default=["svg", "pdf", "png"])
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, help="folder of the figures")
    given = parser.parse_args()
    study = json.loads(given.study.read_text(encoding="utf-8"))
    cases = study["cases"]
    given.output.mkdir(parents=True, exist_ok=True)
    for name, (draw, worth) in FIGURES.items():
        for kind in given.formats:
            path = given.output / f"{name}.{kind}"
            if worth(cases):
                figure = draw(cases, study["measured"], colours_of(cases))
                style.save(figure, str(path))
                pyplot.close(figure)
            else:
                path.unlink(missing_ok=True)


if __name__ == "__main__":
    main()
