"""peers.py: our own methods beside their peers on the same input, in one run, each with its error against a converged reference.

elastic    the elastic tensor of a cell: our own solver and PETSc's (GAMG on the same matrix), on one process and on two
bending    a static test by our own solver and by PETSc's, and the explicit method, which moves the bar in time
sintering  implicit steps, and the explicit method with less and less inertia, from the same packing

JSON lines, or a table with --table; -o FIGURE draws error against processor time. Each process has one thread. Without a build by
make PETSC=1 the rows of PETSc are left out, which is said.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "common"))
import measure  # noqa: E402
from measure import PROGRAMS, Run, alone, say  # noqa: E402
import kiln  # noqa: E402
from style import ACCENT, LINE, REFERENCE, pyplot, save  # noqa: E402

TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8)
VELOCITIES = (1, 4)  # of the punch, of the default, which comes first
SINTERING_TOLERANCES = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
SCALINGS = (1e20, 3e19, 1e19)
TIMES = "4s,20s,60s"
OWN = "our own"
MEASURES = {"elastic": "modulus of a cell", "bending": "slope of a bar", "sintering": "density at 4, 20 and 60 s"}
STYLES = {
    OWN: (LINE, "o-"),
    "PETSc, 1 process": (ACCENT, "s-"),
    "PETSc, 2 processes": (ACCENT, "D--"),
    "explicit": (REFERENCE, "^-"),
}


def with_petsc():
    """Whether the programs were built by make PETSC=1; says so if not."""
    words = [os.path.join(PROGRAMS, "bend"), "--solver", "petsc", os.devnull]
    if b"no PETSc" not in subprocess.run(words, stderr=subprocess.PIPE, check=False).stderr:
        return True
    print("peers: this build has no PETSc (make PETSC=1): its rows are left out", file=sys.stderr)
    return False


def solvers(petsc):
    """Names of linear solvers, the options that choose them, what starts their processes, and their number."""
    yield OWN, [], [], 1
    if petsc:
        yield "PETSc, 1 process", ["--solver", "petsc"], [], 1
        if shutil.which("mpirun"):
            yield "PETSc, 2 processes", ["--solver", "petsc"], ["mpirun", "-n", "2", "--oversubscribe"], 2


def row(case, particles, method, setting, error, run, processes=1, **more):
    return say("peers", case, particles=particles, method=method, setting=setting, processes=processes, error=error,
               processor_seconds=run.processor, wall_seconds=run.wall, peak_bytes=run.peak_bytes, **more)


def packed(folder, particles, aspect):
    """A packing of 0.79 with bonds: its file."""
    green, bonded = (os.path.join(folder, f"{name}-{particles}.kiln") for name in ("green", "bonded"))
    Run(["sinter", "green", "-q", "-n", particles, "--density", 0.58, "--compact-to", 0.79, "--aspect", aspect, "--seed",
         1, "-o", green])
    Run(["bondify", "-q", green, "-o", bonded])
    return bonded


def elastic(folder, given, petsc):
    bonded = given.bonded or packed(folder, given.particles, "1:1:1")
    particles = Run(["analyze", "info", bonded]).document()["particles"]
    exact = Run(["analyze", "elastic", "--tolerance", 1e-12, bonded]).document()["young_modulus"]
    rows = []
    for name, options, before, processes in solvers(petsc):
        for tolerance in given.tolerances:
            run = Run(["analyze", "elastic", "--tolerance", tolerance, *options, bonded], alone(), before)
            found = run.document()
            rows.append(row("elastic", particles, name, tolerance, abs(found["young_modulus"] / exact - 1), run, processes,
                            iterations=found["iterations"], residual=found["residual"]))
    return rows


def bending(folder, given, petsc):
    bar = packed(folder, given.bar, "7:1:1")

    def test(*options, before=()):
        """The run, its document, and force over deflection in the last unloading, N/m."""
        run = Run(["bend", "-q", "--cycles", 1, *options, bar], alone(), before)
        done = subprocess.run([os.path.join(PROGRAMS, "analyze"), "modulus"], input=run.output, check=True, stdout=subprocess.PIPE)
        return run, run.document(), json.loads(done.stdout)["slope"]

    exact = test("--tolerance", 1e-10)[2]
    rows = []
    for name, options, before, processes in solvers(petsc):
        for tolerance in given.tolerances:
            run, found, slope = test("--tolerance", tolerance, *options, before=before)
            rows.append(row("bending", given.bar, name, tolerance, abs(slope / exact - 1), run, processes,
                            iterations=found["iterations"]))
    usual = None  # velocity of the punch, m/s
    for factor in VELOCITIES:
        run, found, slope = test("--method", "dynamic", *(["--punch-velocity", f"{usual * factor}m/s"] if usual else []))
        usual = usual or found["punch_velocity"]
        rows.append(row("bending", given.bar, "explicit", factor, abs(slope / exact - 1), run, steps=found["steps"]))
    return rows


def sintering(folder, given, petsc):
    green, states = os.path.join(folder, "green.kiln"), os.path.join(folder, "states.kiln")
    Run(["sinter", "green", "-q", "-n", given.green, "--density", 0.45, "--method", "affine", "--compact-to", 0.58, "--seed", 1,
         "-o", green])

    def densities(*options):
        run = Run(["sinter", "-q", "--temperature", "1200C", "--at-time", TIMES, *options, "-o", states, green], alone())
        with open(states, "rb") as stream:
            return run, [kiln.relative_density(state) for state in kiln.documents(stream)]

    exact = densities("--tolerance", 1e-7)[1]
    rows = []
    settings = [(OWN, tolerance, ("--tolerance", tolerance)) for tolerance in SINTERING_TOLERANCES]
    settings += [("explicit", scaling, ("--method", "explicit", "--mass-scaling", scaling)) for scaling in SCALINGS]
    for method, setting, options in settings:
        run, found = densities(*options)
        error = max(abs(a / b - 1) for a, b in zip(found, exact))
        rows.append(row("sintering", given.green, method, setting, error, run))
    return rows


CASES = {"elastic": elastic, "bending": bending, "sintering": sintering}


def table(rows):
    """The rows of a case for people."""
    lines = [("method", "setting", "error", "processor s", "wall s", "peak GB")]
    for each in rows:
        lines.append((each["method"], f"{each['setting']:g}", f"{each['error']:.1e}", f"{each['processor_seconds']:.2f}",
                      f"{each['wall_seconds']:.2f}", f"{each['peak_bytes'] / 1e9:.3f}"))
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join("  ".join(text.rjust(width) for text, width in zip(line, widths)) for line in lines)


def draw(found, path):
    figure, panels = pyplot.subplots(1, len(found), figsize=(max(4.0 * len(found), 5.6), 3.6), squeeze=False)
    figure.get_layout_engine().set(rect=(0, 0.08, 1, 0.92))  # the legend stands below
    handles = {}
    for axes, (case, rows) in zip(panels[0], found.items()):
        for method, (colour, style) in STYLES.items():
            points = [(each["processor_seconds"], max(each["error"], 1e-15)) for each in rows if each["method"] == method]
            if points:
                handles[method] = axes.loglog(*zip(*points), style, color=colour, label=method, markersize=4)[0]
        axes.set(title=f"{MEASURES[case]}, {rows[0]['particles']:,} particles", xlabel="processor time of all processes, s")
    panels[0][0].set_ylabel("relative error")
    figure.legend(handles=list(handles.values()), loc="lower center", ncol=len(handles))
    save(figure, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", default=list(CASES), help="all of them unless named")
    parser.add_argument("-o", "--output", help="picture to write (png, svg or pdf)")
    parser.add_argument("--table", action="store_true", help="tables instead of JSON lines")
    parser.add_argument("--tolerances", type=lambda text: [float(each) for each in text.split(",")], default=TOLERANCES,
                        metavar="NUMBER,...", help="of the linear solvers")
    parser.add_argument("--particles", type=int, default=10000, help="of the case elastic")
    parser.add_argument("--bonded", metavar="FILE", help="the state of the case elastic, in place of a packing")
    parser.add_argument("--bar", type=int, default=1000, help="particles of the case bending")
    parser.add_argument("--green", type=int, default=1000, help="particles of the case sintering")
    given = parser.parse_args()
    if unknown := set(given.cases) - set(CASES):
        parser.error(f"no case {', '.join(sorted(unknown))}; there are {', '.join(CASES)}")
    measure.silent = given.table
    petsc = with_petsc()
    found = {}
    for case in given.cases:
        with tempfile.TemporaryDirectory() as folder:
            found[case] = CASES[case](folder, given, petsc)
        if given.table:
            print(f"{MEASURES[case]}, {found[case][0]['particles']:,} particles\n{table(found[case])}\n", flush=True)
    if given.output:
        draw(found, given.output)


if __name__ == "__main__":
    main()
