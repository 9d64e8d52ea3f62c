"""figure_modulus.py: Young's modulus against density: fit, band, measurements, literature (Fig. 6 of Dosta et al. 2017)."""
import numpy

import style
from dem_state import read_file
from style import GPA, pyplot

DASHES = ((0, (5, 3)), (0, (1, 1.5)), (0, (6, 2, 1, 2)))


def typeset(formula):
    return formula.replace("-", "\u2212").replace("^2.23", "$^{2.23}$").replace("^2", "\u00b2")


def law_text(fit):
    """The formula with the fitted numbers in it."""
    text = fit["formula"].replace("-", "\u2212").replace("E0", f"{fit['E0'] / GPA:.0f} GPa").replace("^2", "\u00b2").replace(
        "^b", f"^{fit.get('b', 0):.2f}")
    return text.replace("b P", f"{fit.get('b', 0):.2f} P").replace("Pc", f"{fit.get('Pc', 0):.2f}")


def draw(fit):
    """fit: the result of `analyze fit`, which holds points, band, measurements and references."""
    figure, axes = pyplot.subplots(figsize=(style.WIDTH, 3.9))
    band = fit["band"]
    density = numpy.array(band["relative_density"])
    points = fit["points"]
    top = max(point["young_modulus"] for point in points)
    for reference, dashes in zip(fit["references"], DASHES):
        curve = numpy.array([numpy.nan if value is None else value for value in reference["young_modulus"]])
        top = max(top, numpy.nanmax(curve))
        axes.plot(
            density,
            curve / GPA,
            color=style.REFERENCE,
            linewidth=1.2,
            linestyle=dashes,
            label=
            f"{reference['name']}: {typeset(reference['formula'])}"
        )
    if band["confidence"]:
        low, high = numpy.array(band["confidence"]).T / GPA
        axes.fill_between(density, low, high, color=style.LINE, alpha=0.18, linewidth=0, label="95 % confidence of the fit")
    axes.plot(density, numpy.array(band["young_modulus"]) / GPA, color=style.LINE, label=f"fit, {fit['law']}: {law_text(fit)}")
    for found, colour, mark, label in ((points, style.ACCENT, "o", "simulated bending"), (fit.get("data", {}).get("points", []),
                                                                                          "black", "s", "measured")):
        if found:
            error = [(point["standard_error"] or 0.0) / GPA for point in found]
            axes.errorbar([1 - point["porosity"] for point in found], [point["young_modulus"] / GPA for point in found],
                          error,
                          fmt=mark,
                          color=colour,
                          markersize=5.5,
                          capsize=3,
                          label=label,
                          zorder=3)
    axes.legend(loc="upper left", fontsize="small")
    axes.set_xlim(density[0], 1.0)
    axes.set_ylim(0, 1.05 * top / GPA)
    axes.set_xlabel("Relative density, 1 \u2212 P")
    axes.set_ylabel("Young's modulus, GPa")
    return figure


def main():
    given = style.arguments(__doc__, ("fit", "result of analyze fit"))
    style.save(draw(read_file(given.fit)[0]), given.output)


if __name__ == "__main__":
    main()
