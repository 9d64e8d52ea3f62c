"""sintering.py: sintering's error against its time, and its cost against the number of particles, as JSON lines.

-o FIGURE draws both.

error   density at fixed times against a run of tolerance 1e-7, for the implicit method of both orders and the explicit one with
        less and less inertia; 6,000 particles from a loose packing, from one compacted affinely, and of a free cube; one thread
factor  processor time of the explicit method over that of the fastest implicit run with no larger error
size    wall time, peak memory and iterations from a density of 0.58 to 0.70, for 1,000 to --largest particles
"""
import argparse
import json
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "common"))
import measure  # noqa: E402
from measure import Run, alone  # noqa: E402
import kiln  # noqa: E402
from style import ACCENT, LINE, REFERENCE, pyplot, save  # noqa: E402

STARTS = {
    "loose": ("--density 0.43", ""),
    "affine": ("--density 0.45 --method affine --compact-to 0.58", ""),
    "free cube": ("--density 0.45 --method affine --compact-to 0.58", "--boundary free"),
}
TIMES = "4s,20s,60s"
TOLERANCES = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6)
REFERENCE_TOLERANCE = 1e-7
TIGHTEST_FIRST_ORDER = 3e-4  # its steps grow as one over the tolerance: 1,600 at this one
SCALINGS = (1e20, 1e19, 1e18)


def say(case, **values):
    return measure.say("sintering", case, **values)


def sinter(folder, green, options, environment=None):
    """Densities at the wanted states, the run, and its history."""
    states, history = os.path.join(folder, "states.kiln"), os.path.join(folder, "history.jsonl")
    run = Run(["sinter", "-q", "--temperature", "1200C", *options.split(), "--history", history, "-o", states, green], environment)
    with open(states, "rb") as stream:
        densities = [kiln.relative_density(state) for state in kiln.documents(stream)]
    with open(history, encoding="utf-8") as stream:
        steps = [json.loads(line) for line in stream]
    return densities, run, steps


def factors(rows):
    """For each explicit run the fastest implicit one of the same start that is as accurate."""
    for row in rows:
        if row["method"] != "explicit":
            continue
        rivals = [rival for rival in rows if rival["start"] == row["start"] and rival["error"] <= row["error"]
                  and rival["method"] == "implicit, second order"]
        if rivals:
            best = min(rivals, key=lambda rival: rival["seconds"])
            say("factor", start=row["start"], mass_scaling=row["setting"], error=row["error"], tolerance=best["setting"],
                implicit_error=best["error"], factor=row["seconds"] / best["seconds"])


def errors(folder, starts, particles, tightest, lightest):
    rows = []
    for name in starts:
        packing, boundary = STARTS[name]
        green = os.path.join(folder, "green.kiln")
        Run(["sinter", "green", "-q", "-n", particles, *packing.split(), "--seed", 1, "-o", green])
        options = f"--at-time {TIMES} {boundary}"
        exact = sinter(folder, green, f"{options} --tolerance {REFERENCE_TOLERANCE}", alone())[0]
        methods = [("implicit, second order", f"--tolerance {t}", t) for t in TOLERANCES if t >= tightest]
        methods += [("implicit, first order", f"--order 1 --tolerance {t}", t) 
                    for t in TOLERANCES if t >= max(tightest, TIGHTEST_FIRST_ORDER)]
        methods += [("explicit", f"--method explicit --mass-scaling {s}", s) for s in SCALINGS if s >= lightest]
        for method, more, setting in methods:
            densities, run, steps = sinter(folder, green, f"{options} {more}", alone())
            error = max(abs(a / b - 1.0) for a, b in zip(densities, exact))
            count = len(steps) if method != "explicit" else sum(step["attempts"] for step in steps)
            rows.append({"particles": particles, "start": name, "method": method, "setting": setting,
                         "seconds": run.processor,
                         "error": error, "steps": count})
            say("error", **rows[-1])
    factors(rows)
    return rows


def sizes(folder, largest):
    rows = []
    for particles in (1000, 3000, 10000, 30000, 100000, 300000, 1000000):
        if particles > largest:
            break
        green = os.path.join(folder, "green.kiln")
        Run(["sinter", "green", "-q", "-n", particles, *STARTS["affine"][0].split(), "--seed", 1, "-o", green])
        _, run, steps = sinter(folder, green, "--to-density 0.7")
        newton, iterations = (sum(step[key] for step in steps) for key in ("newton", "conjugate_gradients"))
        rows.append({"particles": particles, "seconds": run.wall, "peak_bytes": run.peak_bytes, "steps": len(steps),
                     "newton": newton, "conjugate_gradients": iterations, "iterations_per_solve": iterations / newton})
        say("size", **rows[-1])
    return rows


def draw(error_rows, size_rows, path):
    starts = [start for start in STARTS if any(row["start"] == start for row in error_rows)]
    figure, axes = pyplot.subplots(1, len(starts) + 1, figsize=(3.0 * len(starts) + 3.0, 3.6), squeeze=False)
    figure.get_layout_engine().set(rect=(0, 0.08, 1, 0.92))  # the legend of the methods stands below
    axes = axes[0]
    styles = {"implicit, second order": (LINE, "o-"), "implicit, first order": (REFERENCE, "s--"), "explicit": (ACCENT, "^-")}
    for axis, start in zip(axes, starts):
        for method, (colour, style) in styles.items():
            points = [(row["seconds"], row["error"]) for row in error_rows if (row["start"], row["method"]) == (start, method)]
            axis.loglog(*zip(*points), style, color=colour, label=method, markersize=4)
        axis.set(title=f"{start}, {error_rows[0]['particles']:,} particles", xlabel="processor time, s")
    axes[0].set_ylabel("largest relative error of the density")
    if starts:
        figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncol=len(styles))
    axis = axes[-1]
    counts = [row["particles"] for row in size_rows]
    axis.loglog(counts, [row["seconds"] for row in size_rows], "o-", color=LINE, label="wall time, s", markersize=4)
    iterations = [row["iterations_per_solve"] for row in size_rows]
    axis.loglog(counts, iterations, "s-", color=ACCENT, label="iterations a solve", markersize=4)
    axis.loglog(counts, [1e-4 * count for count in counts], ":", color=REFERENCE, label="proportional to N")
    axis.set(title="0.58 to 0.70", xlabel="particles")
    axis.legend()
    save(figure, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", help="picture to write (png, svg or pdf)")
    parser.add_argument("-n", "--particles", type=int, default=6000, help="of the runs for the error")
    parser.add_argument("--tightest", type=float, default=1e-6, help="tolerance")
    parser.add_argument("--lightest", type=float, default=1e18, help="mass scaling")
    parser.add_argument("--largest", type=int, default=1000000, help="packing")
    parser.add_argument("--only", choices=("error", "size"), help="half of the measurements")
    parser.add_argument("--start", action="append", choices=STARTS, help="of the error; all three unless told, may be repeated")
    parser.add_argument("--draw", nargs="+", metavar="FILE", help="compare and draw what earlier runs printed, measure nothing")
    given = parser.parse_args()
    if given.draw:
        rows = [json.loads(line) for name in given.draw for line in open(name, encoding="utf-8") if line.startswith("{")]
        error_rows = [row for row in rows if row["case"] == "error"]
        factors(error_rows)
        draw(error_rows, [row for row in rows if row["case"] == "size"], given.output)
        return
    with tempfile.TemporaryDirectory() as folder:
        size_rows = sizes(folder, given.largest) if given.only != "error" else []
        error_rows = []
        if given.only != "size":
            error_rows = errors(folder, given.start or STARTS, given.particles, given.tightest, given.lightest)
    if given.output:
        draw(error_rows, size_rows, given.output)


if __name__ == "__main__":
    main()
