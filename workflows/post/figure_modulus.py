"""figure_modulus.py: Young's modulus against density: fits, bands, measurements, literature (Fig. 6 of Dosta et al. 2017)."""
import numpy

import style
from style import GPA, pyplot

DASHES = ((0, (5, 3)), (0, (1, 1.5)), (0, (6, 2, 1, 2)))


def typeset(formula):
    return formula.replace("-", "\u2212").replace("^2.23", "$^{2.23}$").replace("^2", "\u00b2")


def law_text(fit):
    """The formula with the fitted numbers in it."""
    text = fit["formula"].replace("-", "\u2212").replace("E0", f"{fit['E0'] / GPA:.0f} GPa").replace("^2", "\u00b2").replace(
        "^b", f"^{fit.get('b', 0):.2f}")
    return text.replace("b P", f"{fit.get('b', 0):.2f} P").replace("Pc", f"{fit.get('Pc', 0):.2f}")


SHAPE = 0.12  # of the modulus: what the unknown shape of a neck of the same mass makes (docs/theory.md)
BONDS_OF = {"solid": "necks of the sintering law", "series": "bonds of Eq. 2\u20134"}
TESTS = {"bending": "simulated bending", "cell": "periodic cell", "voxels": "finite elements of the cell", "measured": "measured"}


def draw_references(axes, fit, density):
    """The curves of the literature; returns the highest modulus, Pa."""
    top = 0.0
    for reference, dashes in zip(fit.get("references") or (), DASHES):
        curve = numpy.array([numpy.nan if value is None else value for value in reference["young_modulus"]])
        top = max(top, numpy.nanmax(curve))
        axes.plot(density, curve / GPA, color=style.REFERENCE, linewidth=1.2, linestyle=dashes,
                  label=f"{reference['name']}: {typeset(reference['formula'])}")
    return top


def draw_points(axes, points, colour, mark, label):
    error = [(point["standard_error"] or 0.0) / GPA for point in points]
    axes.errorbar([1 - point["porosity"] for point in points], [point["young_modulus"] / GPA for point in points], error, fmt=mark,
                  color=colour, markersize=5.5, capsize=3, label=label, zorder=3)


def tests_of(points):
    """The points by how their moduli were found, in words."""
    found = {}
    for point in points:
        found.setdefault(TESTS.get(point.get("test"), "points"), []).append(point)
    return found


def draw_fit(axes, fit, bonds, colour, mark):
    """bonds: what lies between the particles, as text; empty where all points have the same."""
    band = fit["band"]
    density = numpy.array(band["relative_density"])
    curve = numpy.array(band["young_modulus"])
    necks = bonds == BONDS_OF["solid"]
    if necks:
        axes.fill_between(density, (1 - SHAPE) * curve / GPA, (1 + SHAPE) * curve / GPA, color=colour, alpha=0.15, linewidth=0,
                          label=f"shape of the neck, \u00b1{SHAPE:.0%}".replace("%", " %"))
    elif band["confidence"]:
        low, high = numpy.array(band["confidence"]).T / GPA
        axes.fill_between(density, low, high, color=colour, alpha=0.18, linewidth=0, label="95 % confidence of the fit")
    axes.plot(density, curve / GPA, color=colour, label=f"fit, {fit['law']}: {law_text(fit)}")
    for (test, points), shape in zip(tests_of(fit["points"]).items(), (mark, "D", "v", "s")):
        draw_points(axes, points, colour, shape, f"{test}, {bonds}" if bonds else test)
    return max(numpy.max(curve) * (1 + SHAPE if necks else 1.0), max(point["young_modulus"] for point in fit["points"]))


def bonds_of(fit):
    laws = {point.get("bond_law") for point in fit["points"]}
    return BONDS_OF.get(laws.pop(), "") if len(laws) == 1 else ""


def draw(fits):
    """fits: results of `analyze fit`, which hold points, band, measurements and references."""
    figure, axes = pyplot.subplots(figsize=(style.WIDTH, 3.9))
    density = numpy.array(fits[0]["band"]["relative_density"])
    top = draw_references(axes, fits[0], density)
    for fit, colour, mark in zip(fits, (style.ACCENT, style.LINE), "o^"):
        drawn = draw_fit(axes, fit, bonds_of(fit) if len(fits) > 1 else "", colour, mark)
        top = max(top, drawn)
    measured = fits[0].get("data", {}).get("points", [])
    if measured:
        draw_points(axes, measured, "black", "s", "measured")
    axes.legend(loc="upper left", fontsize="small")
    axes.set_xlim(density[0], 1.0)
    axes.set_ylim(0, 1.05 * top / GPA)
    material = fits[0].get("material")
    axes.set_xlabel(f"Relative density, 1 \u2212 P{f', of {material}' if material else ''}")
    axes.set_ylabel("Young's modulus, GPa")
    return figure


def main():
    given = style.arguments(__doc__, ("fits", "results of analyze fit: one, or those of necks and of bonds of Eq. 2-4"))
    fits = [style.documents(path, "dem-fit", "which analyze fit writes", "band.young_modulus", "points")[0] for path in given.fits]
    style.save(draw(fits), given.output)


if __name__ == "__main__":
    main()
