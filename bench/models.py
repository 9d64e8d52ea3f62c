"""models.py: the error of bonds and of moduli against the time they take, as JSON lines; -o FIGURE draws both.

bonds   sweeps with finer and finer decrements against the exact bonds of Eq. 2-4: greatest error of a bond's radius
moduli  a cell's modulus on grids of voxels, alone and extrapolated, and by springs, against finer grids extrapolated
"""
import argparse
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "common"))
from measure import Run, alone, run_cases, say  # noqa: E402
import kiln  # noqa: E402
import numpy  # noqa: E402
from style import ACCENT, LINE, REFERENCE, pyplot, save  # noqa: E402

DECREMENTS = ("1nm", "0.1nm", "0.01nm", "0.001nm", "0.0001nm")
GRIDS = ("3", "4", "6", "8", "4,6", "6,9", "6,9,12")  # voxels a mean radius
FINEST = "8,12,16"


def packed(folder, particles):
    green = os.path.join(folder, "green.kiln")
    Run(["sinter", "green", "-q", "-n", particles, "--density", 0.58, "--compact-to", 0.79, "--seed", 1, "-o", green])
    return green


def bonds(folder, given):
    green, bonded = packed(folder, given.bonds), os.path.join(folder, "bonded.kiln")

    def radii(*options):
        run = Run(["bondify", "-q", *options, green, "-o", bonded], alone())
        with open(bonded, "rb") as stream:
            return run, numpy.asarray(next(iter(kiln.documents(stream)))["bonds"]["radius"])

    run, exact = radii()
    rows = [say("models", "bonds", particles=given.bonds, method="exact", decrement=None, error=0.0, seconds=run.processor)]
    for decrement in DECREMENTS:
        run, found = radii("--method", "sweep", "--decrement", decrement)
        rows.append(say("models", "bonds", particles=given.bonds, method="sweep", decrement=decrement,
                        error=float(numpy.max(numpy.abs(found - exact)) / exact.mean()), seconds=run.processor))
    return rows


def moduli(folder, given):
    necks = os.path.join(folder, "necks.kiln")
    Run(["bondify", "-q", "--method", "necks", packed(folder, given.moduli), "-o", necks])
    exact = Run(["analyze", "elastic", "-q", "--model", "voxel", "--voxels", FINEST, "--tolerance", 1e-3, necks])
    exact = exact.document()["young_modulus"]

    def measured(method, setting, *options):
        run = Run(["analyze", "elastic", "-q", *options, necks], alone())
        return say("models", "moduli", particles=given.moduli, method=method, setting=setting,
                   error=run.document()["young_modulus"] / exact - 1, seconds=run.processor)

    rows = [measured("springs", law, "--bond-law", law) for law in ("solid", "series")]
    for grids in GRIDS:
        rows.append(measured("extrapolated" if "," in grids else "one grid", grids, "--model", "voxel", "--voxels", grids))
    return rows


def draw_points(axes, rows, method, colour, style, label, setting, offset=(4, 4)):
    points = [each for each in rows if each["method"] == method]
    axes.plot([each["seconds"] for each in points], [each["error"] for each in points], style, color=colour, markersize=4,
              label=label)
    for each in points:
        axes.annotate(each[setting], (each["seconds"], each["error"]), xytext=offset, textcoords="offset points", fontsize=7,
                      color=colour, ha="right" if offset[0] < 0 else "left")


def draw_bonds(axes, rows):
    axes.axvline(rows[0]["seconds"], color=ACCENT, label="exact")
    draw_points(axes, rows, "sweep", LINE, "o-", "sweeps, by decrement", "decrement", (-5, -3))
    axes.margins(x=0.18)
    axes.set(xscale="log", yscale="log", title=f"bonds of {rows[0]['particles']:,} particles", xlabel="processor time, s",
             ylabel="greatest error of a radius over their mean")
    axes.legend()


def draw_moduli(axes, rows):
    draw_points(axes, rows, "springs", ACCENT, "s", "springs, by law", "setting")
    draw_points(axes, rows, "one grid", REFERENCE, "^-", "one grid, voxels a radius", "setting", (2, -10))
    draw_points(axes, rows, "extrapolated", LINE, "o-", "grids extrapolated", "setting")
    axes.axhline(0.0, color=REFERENCE, linewidth=0.8, linestyle=":")
    axes.yaxis.set_major_formatter(lambda value, _: f"{100 * value:+.0f} %" if value else "0")
    axes.set(xscale="log", title=f"modulus of {rows[0]['particles']:,} particles", xlabel="processor time, s",
             ylabel=f"off that of {FINEST.replace(',', ', ')} voxels a radius")
    axes.legend()


CASES = {"bonds": (bonds, draw_bonds), "moduli": (moduli, draw_moduli)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", default=list(CASES), help="both unless named")
    parser.add_argument("-o", "--output", help="picture to write (png, svg or pdf)")
    parser.add_argument("--bonds", type=int, default=3000, help="particles of the case bonds")
    parser.add_argument("--moduli", type=int, default=100, help="particles of the case moduli")
    given = parser.parse_args()
    found = run_cases(CASES, parser, given)
    if given.output:
        figure, panels = pyplot.subplots(1, len(found), figsize=(4.6 * len(found), 3.4), squeeze=False)
        for axes, (case, rows) in zip(panels[0], found.items()):
            CASES[case][1](axes, rows)
        save(figure, given.output)


if __name__ == "__main__":
    main()
