"""figure_modulus.py: Young's modulus against density with the fit and Knudsen's law (Fig. 6 of Dosta et al. 2017)."""
import numpy

import style
from dem_state import read_file
from style import GPA, pyplot

KNUDSEN = (410e9, 3.95)  # Pa and exponent, usual values for alumina; F. P. Knudsen, J. Am. Ceram. Soc. 45 (1962) 94


def exponential(modulus_of_solid, exponent, density):
    """Knudsen's law, Pa."""
    return modulus_of_solid * numpy.exp(-exponent * (1 - density))


def draw(tests, fit):
    """tests: results of `analyze modulus`; fit: the result of `analyze fit --law knudsen`."""
    figure, axes = pyplot.subplots(figsize=(style.WIDTH, 3.6))
    density = numpy.linspace(0.6, 1.0, 200)
    axes.plot(density, exponential(*KNUDSEN, density) / GPA, color=style.REFERENCE, linestyle=(0, (5, 3)),
              label=f"Knudsen's law for alumina: {KNUDSEN[0] / GPA:.0f} GPa exp(−{KNUDSEN[1]:.2f} P)")
    axes.plot(density, exponential(fit["E0"], fit["b"], density) / GPA, color=style.LINE,
              label=f"fit to this run: {fit['E0'] / GPA:.0f} GPa exp(−{fit['b']:.2f} P)")
    axes.errorbar([test["relative_density"] for test in tests], [test["young_modulus"] / GPA for test in tests],
                  [test["standard_error"] / GPA for test in tests], fmt="o", color=style.ACCENT, markersize=6, capsize=3,
                  label="simulated bending", zorder=3)
    axes.legend(loc="upper left")
    axes.set_xlim(0.6, 1.0)
    axes.set_ylim(0, None)
    axes.set_xlabel("Relative density, 1 − P")
    axes.set_ylabel("Young's modulus, GPa")
    return figure


def main():
    given = style.arguments(__doc__, ("fit", "result of analyze fit"), ("tests", "results of analyze modulus"))
    tests = [test for path in given.tests for test in read_file(path)]
    style.save(draw(tests, read_file(given.fit)[0]), given.output)


if __name__ == "__main__":
    main()
