"""bending.py: bending tests against each other and against the periodic cell, as JSON lines; -o FIGURE draws a panel for each case.

size        time, peak memory and iterations of a whole static test against the number of particles
slenderness the same against span over height, 10,000 particles
tolerance   error of the bending slope and of the cell's modulus against time, for tolerances of the solver, 10,000 particles
method      dynamic against static slope and time, for velocities of the punch and shares of damping, 1,000 particles
thickness   modulus from bending over that of the periodic cell for bars of growing height, and its limit for a bar without end
"""
import argparse
import json
import os
import subprocess
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "common"))
import measure  # noqa: E402
from measure import PROGRAMS, Run, run_cases  # noqa: E402
from style import ACCENT, LINE, REFERENCE, pyplot, save  # noqa: E402

DIAMETER = 100e-9  # m, of the particles before they are pressed
DENSITY = 0.79  # relative
ASPECT = 7  # length over height; the span is 0.8 of the length
SIZES = (1000, 3000, 10000, 30000, 100000, 300000, 1000000)
ASPECTS = (4, 6.25, 12.5, 25, 50)
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
VELOCITIES = (8, 4, 2, 1, 0.5)  # of the default
DAMPINGS = (0.1, 0.3, 0.9)  # beside the default of 0.7


def say(case, **values):
    return measure.say("bending", case, **values)


def make_bar(folder, particles, seed=1, aspect=ASPECT, packing="--density 0.58", bonding=""):
    """A bar pressed to its density, with bonds: its file."""
    green, bar = (os.path.join(folder, f"{name}.kiln") for name in ("green", f"bar-{particles}-{seed}-{aspect}"))
    Run(["sinter", "green", "-q", "-n", particles, "--diameter", "100nm", *packing.split(), "--compact-to", DENSITY,
         "--aspect", f"{aspect}:1:1", "--seed", seed, "-o", green])
    Run(["bondify", "-q", *bonding.split(), green, "-o", bar])
    return bar


def quick_bar(folder, particles, aspect=ASPECT):
    """Pressed without letting its particles give way to each other, for cases in which the packing does not matter."""
    return make_bar(folder, particles, 1, aspect, "--density 0.45 --method affine")


def bend(bar, *options):
    """The document of a test with one cycle, its seconds and its peak memory."""
    run = Run(["bend", "-q", "--cycles", 1, *options, bar])
    return run.document(), run.wall, run.peak_bytes


def unloading_slope(test):
    """Force over deflection between 5/6 and 1/3 of the peak, in the last unloading, N/m."""
    done = subprocess.run([os.path.join(PROGRAMS, "analyze"), "modulus"], input=json.dumps(test), check=True,
                          stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout)["slope"]


def cost(case, bar):
    test, seconds, memory = bend(bar)
    return say(case, particles=test["particles"], bonds=test["bonds"], slenderness=test["span"] / test["height"],
               seconds=seconds, peak_bytes=memory, iterations=test["iterations"], residual=test["residual"],
               energy_error=test["energy"]["error"])


def sizes(folder, given):
    return [cost("size", quick_bar(folder, particles)) for particles in SIZES if particles <= given.largest]


def slenderness(folder, given):
    return [cost("slenderness", quick_bar(folder, 10000, aspect)) for aspect in ASPECTS]


def tolerances(folder, given):
    bar = quick_bar(folder, 10000)
    exact_slope = unloading_slope(bend(bar, "--tolerance", 1e-10)[0])
    exact_modulus = Run(["analyze", "elastic", "--tolerance", 1e-11, bar]).document()["young_modulus"]
    rows = []
    for tolerance in TOLERANCES:
        test, seconds, _ = bend(bar, "--tolerance", tolerance)
        rows.append(say("tolerance", of="bending", tolerance=tolerance, error=abs(unloading_slope(test) / exact_slope - 1),
                        seconds=seconds, iterations=test["iterations"]))
        run = Run(["analyze", "elastic", "--tolerance", tolerance, bar])
        cell = run.document()
        rows.append(say("tolerance", of="cell", tolerance=tolerance, error=abs(cell["young_modulus"] / exact_modulus - 1),
                        seconds=run.wall, iterations=cell["iterations"]))
    return rows


def methods(folder, given):
    bar = make_bar(folder, 1000)
    test, still_seconds, _ = bend(bar)
    still = unloading_slope(test)
    say("method", method="static", particles=1000, slope=still, seconds=still_seconds)
    usual = bend(bar, "--method", "dynamic", "--damping", 0.99)[0]["punch_velocity"]
    rows = []
    for factor, damping in [(factor, 0.7) for factor in VELOCITIES] + [(1, damping) for damping in DAMPINGS]:
        test, seconds, _ = bend(bar, "--method", "dynamic", "--damping", damping, "--punch-velocity", f"{usual * factor}m/s")
        rows.append(say("method", method="dynamic", particles=1000, velocity=test["punch_velocity"], velocity_factor=factor,
                        damping=damping, slope_error=unloading_slope(test) / still - 1, energy_error=test["energy"]["error"],
                        steps=test["steps"], seconds=seconds, times_static=seconds / still_seconds))
    return rows


def elastic_modulus(test, near_field):
    """Modulus of a bar, Pa, from a span between the supports' resultant forces.

    near_field: of a load on a line, after von Karman and Seewald (Timoshenko & Goodier, Theory of Elasticity, bending of a beam
    by a concentrated force): 1 + (2.4 + 1.5 nu) (h/L)^2 - 0.84 (h/L)^3; else Timoshenko's beam, as `analyze modulus`.
    """
    span, height, nu = test["effective_span"], test["height"], test["poisson_ratio"]
    ratio = height / span
    shear = 1 + (2.4 + 1.5 * nu) * ratio**2 - 0.84 * ratio**3 if near_field else 1 + 2.4 * (1 + nu) * ratio**2
    return unloading_slope(test) * span**3 / (4 * test["width"] * height**3) * shear


def thickness(folder, given):
    """One line a bar, then the limits of straight lines in d/h; bars scatter as d/h."""
    rows = []
    for particles in (int(each) for each in given.sizes.split(",")):
        for seed in (int(each) for each in given.seeds.split(",")):
            bar = make_bar(folder, particles, seed, bonding=given.bonding)
            cell = Run(["analyze", "elastic", "--tolerance", 1e-6, bar]).document()["young_modulus"]
            test, seconds, _ = bend(bar)
            beam, near = (elastic_modulus(test, kind) / cell for kind in (False, True))
            rows.append(say("thickness", particles=particles, seed=seed, diameter_over_height=DIAMETER / test["height"],
                            slenderness=test["span"] / test["height"], cell_modulus=cell, beam_ratio=beam,
                            near_field_ratio=near, iterations=test["iterations"], seconds=seconds))
    for formula in ("beam", "near_field"):
        slope, limit, error = line_to_zero(rows, f"{formula}_ratio")
        say("thickness limit", formula=formula, limit=limit, standard_error=error, slope=slope)
    return rows


def line_to_zero(rows, key):
    """Slope, limit and its standard error of a straight line in d/h through a ratio; no error for less than four bars."""
    inverse, ratio = (numpy.array([row[name] for row in rows]) for name in ("diameter_over_height", key))
    if len(rows) < 4:
        return *numpy.polyfit(inverse, ratio, 1, w=1 / inverse), None
    (slope, limit), covariance = numpy.polyfit(inverse, ratio, 1, w=1 / inverse, cov=True)
    return slope, limit, float(numpy.sqrt(covariance[1, 1]))


def draw_cost(axes, rows, key, label):
    places = [row[key] for row in rows]
    axes.loglog(places, [row["seconds"] for row in rows], "o-", color=LINE, label="wall time, s", markersize=4)
    axes.loglog(places, [row["iterations"] for row in rows], "s-", color=ACCENT, label="iterations, all forces", markersize=4)
    axes.loglog(places, [row["peak_bytes"] / 1e9 for row in rows], "^-", color=REFERENCE, label="peak memory, GB", markersize=4)
    if max(places) < 100:
        axes.set_xticks(places, [f"{place:.3g}" for place in places])
        axes.minorticks_off()
    axes.set_xlabel(label)
    axes.legend()


def draw_tolerances(axes, rows):
    for of, colour in (("bending", LINE), ("cell", ACCENT)):
        points = [(row["seconds"], max(row["error"], 1e-16)) for row in rows if row["of"] == of]
        axes.loglog(*zip(*points), "o-", color=colour, label={"bending": "slope of bending", "cell": "modulus of the cell"}[of],
                    markersize=4)
    axes.set(xlabel="wall time, s", ylabel="relative error")
    axes.legend()


def draw_methods(axes, rows):
    by_velocity = [row for row in rows if row["damping"] == 0.7]
    by_damping = [row for row in rows if row["damping"] != 0.7]
    for points, colour, key, label in ((by_velocity, LINE, "velocity_factor", "velocity of the punch, 1 by default"),
                                       (by_damping, ACCENT, "damping", "damping, 0.7 by default")):
        axes.loglog([row["seconds"] for row in points], [abs(row["slope_error"]) for row in points], "o", color=colour, label=label,
                    markersize=4)
        for row in points:
            axes.annotate(f"{row[key]:g}", (row["seconds"], abs(row["slope_error"])), xytext=(3, 3), textcoords="offset points",
                          fontsize=7, color=colour)
    axes.set(xlabel="wall time, s", ylabel="error of the slope, against static")
    axes.legend(loc="lower left")


def draw_thickness(axes, rows):
    slope, limit, _ = line_to_zero(rows, "near_field_ratio")
    inverse = numpy.array([row["diameter_over_height"] for row in rows])
    line = numpy.array([0, inverse.max() * 1.05])
    axes.plot(inverse, [row["near_field_ratio"] for row in rows], "o", color=LINE, label="whole height and width of the box")
    axes.plot(line, limit + slope * line, "-", color=REFERENCE, label=f"straight line, limit {limit:.2f}")
    axes.plot(line, (1 - 0.5 * line) ** 4, "--", color=ACCENT, label="half a diameter less of either")
    axes.set(xlim=(0, None), ylim=(0, 1.1), xlabel="particle diameter over height of the bar",
             ylabel="modulus over that of the cell")
    axes.legend(loc="lower left")


CASES = {
    "size": (sizes, lambda axes, rows: draw_cost(axes, rows, "particles", "particles")),
    "slenderness": (slenderness, lambda axes, rows: draw_cost(axes, rows, "slenderness", "span over height")),
    "tolerance": (tolerances, draw_tolerances),
    "method": (methods, draw_methods),
    "thickness": (thickness, draw_thickness),
}


def draw(found, path):
    across = min(len(found), 3)
    down = -(-len(found) // across)
    figure, panels = pyplot.subplots(down, across, figsize=(4.6 * across, 3.4 * down), squeeze=False)
    for axes in panels.flat[len(found):]:
        axes.set_visible(False)
    for axes, (case, rows) in zip(panels.flat, found.items()):
        CASES[case][1](axes, rows)
    save(figure, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", default=list(CASES), help="all of them unless named")
    parser.add_argument("-o", "--output", help="picture to write (png, svg or pdf)")
    parser.add_argument("--largest", type=int, default=SIZES[-1], help="bar of the case size, particles; the largest takes 10 GB")
    parser.add_argument("--sizes", default="2000,8000,30000,60000", help="particles of the bars of the case thickness")
    parser.add_argument("--seeds", default="1,2", help="packings of each of those sizes")
    parser.add_argument("--bonding", default="", help="options of bondify in the case thickness, as in '--bonding=--method=necks'")
    given = parser.parse_args()
    found = run_cases(CASES, parser, given)
    if given.output:
        draw(found, given.output)


if __name__ == "__main__":
    main()
