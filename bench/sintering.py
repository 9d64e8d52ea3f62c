"""sintering.py: sintering's error against its time, and its cost against the number of particles, as JSON lines; -o FIGURE draws both.

error  density at fixed times against a run of tolerance 1e-7, for the implicit method of both orders and the explicit one with
       less and less inertia; 6,000 particles from a loose packing, from one compacted affinely, and of a free cube
size   wall time, peak memory and iterations from a density of 0.58 to 0.70, for 1,000 to --largest particles
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAMS = os.path.join(os.environ.get("BUILD", os.path.join(ROOT, "build")), "bin")
sys.path.insert(0, os.path.join(ROOT, "workflows", "post"))
from dem_state import read, relative_density  # noqa: E402
from style import ACCENT, LINE, REFERENCE, pyplot, save  # noqa: E402

STARTS = {
    "loose": ("--density 0.43", ""),
    "affine": ("--density 0.45 --method affine --compact-to 0.58", ""),
    "free cube": ("--density 0.45 --method affine --compact-to 0.58", "--boundary free"),
}
TIMES = "4s,20s,60s,150s"
TOLERANCES = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6)
REFERENCE_TOLERANCE = 1e-7
SCALINGS = (1e20, 1e19, 1e18)


def say(case, **values):
    print(json.dumps({"bench": "sintering", "case": case, **values}), flush=True)


def run(command):
    """Runs one of the programs; seconds of wall time and peak memory, bytes."""
    start = time.perf_counter()
    process = subprocess.Popen([os.path.join(PROGRAMS, command[0]), *command[1:]])
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{' '.join(command)}: status {os.waitstatus_to_exitcode(status)}")
    return time.perf_counter() - start, usage.ru_maxrss * 1024


def sinter(folder, green, options):
    """Densities at the wanted times, seconds, and the history of a run."""
    states, history = os.path.join(folder, "states.kiln"), os.path.join(folder, "history.jsonl")
    seconds, memory = run(["sinter", "-q", "--temperature", "1200C", *options.split(), "--history", history, "-o", states, green])
    with open(states, "rb") as stream:
        densities = [relative_density(state) for state in read(stream)]
    with open(history, encoding="utf-8") as stream:
        steps = [json.loads(line) for line in stream]
    return densities, seconds, memory, steps


def errors(folder, particles, tightest, lightest):
    rows = []
    for name, (packing, boundary) in STARTS.items():
        green = os.path.join(folder, "green.kiln")
        run(["sinter", "green", "-q", "-n", str(particles), *packing.split(), "--seed", "1", "-o", green])
        options = f"--at-time {TIMES} {boundary}"
        exact = sinter(folder, green, f"{options} --tolerance {REFERENCE_TOLERANCE}")[0]
        methods = [("implicit, second order", f"--tolerance {t}", t) for t in TOLERANCES if t >= tightest]
        methods += [("implicit, first order", f"--order 1 --tolerance {t}", t) for t in TOLERANCES if t >= max(tightest, 1e-4)]
        methods += [("explicit", f"--method explicit --mass-scaling {s}", s) for s in SCALINGS if s >= lightest]
        for method, more, setting in methods:
            densities, seconds, _, steps = sinter(folder, green, f"{options} {more}")
            error = max(abs(a / b - 1.0) for a, b in zip(densities, exact))
            count = len(steps) if method != "explicit" else sum(step["attempts"] for step in steps)
            rows.append({"start": name, "method": method, "setting": setting, "seconds": seconds, "error": error, "steps": count})
            say("error", particles=particles, **rows[-1])
    return rows


def sizes(folder, largest):
    rows = []
    for particles in (1000, 3000, 10000, 30000, 100000, 300000, 1000000):
        if particles > largest:
            break
        green = os.path.join(folder, "green.kiln")
        run(["sinter", "green", "-q", "-n", str(particles), *STARTS["affine"][0].split(), "--seed", "1", "-o", green])
        _, seconds, memory, steps = sinter(folder, green, "--to-density 0.7")
        newton, iterations = (sum(step[key] for step in steps) for key in ("newton", "conjugate_gradients"))
        rows.append({"particles": particles, "seconds": seconds, "peak_bytes": memory, "steps": len(steps), "newton": newton,
                     "conjugate_gradients": iterations, "iterations_per_solve": iterations / newton})
        say("size", **rows[-1])
    return rows


def draw(error_rows, size_rows, path):
    figure, axes = pyplot.subplots(1, len(STARTS) + 1, figsize=(12.0, 3.4))
    styles = {"implicit, second order": (LINE, "o-"), "implicit, first order": (REFERENCE, "s--"), "explicit": (ACCENT, "^-")}
    for axis, start in zip(axes, STARTS):
        for method, (colour, style) in styles.items():
            points = [(row["seconds"], row["error"]) for row in error_rows if (row["start"], row["method"]) == (start, method)]
            axis.loglog(*zip(*points), style, color=colour, label=method, markersize=4)
        axis.set(title=f"{start}, 6,000 particles", xlabel="wall time, s")
    axes[0].set_ylabel("largest relative error of the density")
    axes[0].legend()
    axis = axes[-1]
    counts = [row["particles"] for row in size_rows]
    axis.loglog(counts, [row["seconds"] for row in size_rows], "o-", color=LINE, label="wall time, s", markersize=4)
    axis.loglog(counts, [row["iterations_per_solve"] for row in size_rows], "s-", color=ACCENT, label="iterations a solve", markersize=4)
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
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        size_rows = sizes(folder, given.largest)
        error_rows = errors(folder, given.particles, given.tightest, given.lightest)
    if given.output:
        draw(error_rows, size_rows, given.output)


if __name__ == "__main__":
    main()
