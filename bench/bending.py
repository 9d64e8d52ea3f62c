"""bending.py: bending tests against each other and against the periodic cell, as JSON lines; draws what it finds with -o FIGURE.

method     dynamic against static slope and time, for velocities of the punch and shares of damping
thickness  modulus from bending over that of the periodic cell for bars of growing height, and its limit for a bar without end
size       time and iterations of the whole static test against the number of particles
"""
import argparse
import json
import os
import subprocess
import tempfile
import time

import numpy

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAMS = os.path.join(os.environ.get("BUILD", os.path.join(ROOT, "build")), "bin")
DIAMETER = 100e-9  # m, of the particles before they are pressed
DENSITY = 0.79  # relative
SPAN = 0.8  # of the bar's length
ASPECT = 7  # length over height


def pipe(command, **values):
    """Standard output of a pipe of Kiln's programs, and the seconds it took."""
    start = time.perf_counter()
    environment = {**os.environ, "PATH": PROGRAMS + ":" + os.environ["PATH"]}
    done = subprocess.run(["bash", "-c", "set -o pipefail; " + command.format(**values)], check=True, stdout=subprocess.PIPE,
                          env=environment, text=True)
    return done.stdout, time.perf_counter() - start


def say(case, **values):
    print(json.dumps({"bench": "bending", "case": case, **values}), flush=True)


def make_bar(folder, particles, seed):
    """A bar pressed to its density, with bonds: its file."""
    path = os.path.join(folder, f"bar-{particles}-{seed}.kiln")
    pipe("sinter green -q -n {n} --diameter 100nm --density 0.58 --compact-to {density} --aspect {aspect}:1:1 --seed {seed} "
         "| bondify -q -o {path}", n=particles, density=DENSITY, aspect=ASPECT, seed=seed, path=path)
    return path


def unloading_slope(test):
    """Force over deflection between 5/6 and 1/3 of the peak, in the last unloading, N/m."""
    text = json.dumps(test)
    done = subprocess.run([os.path.join(PROGRAMS, "analyze"), "modulus"], input=text, check=True, stdout=subprocess.PIPE,
                          text=True)
    return json.loads(done.stdout)["slope"]


def elastic_modulus(test, slope, near_field):
    """Modulus of a bar, Pa, from a span between the supports' resultant forces.

    near_field: of a load on a line, after von Karman and Seewald (Timoshenko & Goodier, Theory of Elasticity, bending of a beam
    by a concentrated force): 1 + (2.4 + 1.5 nu) (h/L)^2 - 0.84 (h/L)^3; else Timoshenko's beam, as `analyze modulus`.
    """
    span, height, nu = test["effective_span"], test["height"], test["poisson_ratio"]
    ratio = height / span
    shear = 1 + (2.4 + 1.5 * nu) * ratio**2 - 0.84 * ratio**3 if near_field else 1 + 2.4 * (1 + nu) * ratio**2
    return slope * span**3 / (4 * test["width"] * height**3) * shear


def methods(folder, particles):
    bar = make_bar(folder, particles, 1)
    text, seconds = pipe("bend --cycles 1 {bar}", bar=bar)
    still = unloading_slope(json.loads(text))
    say("method", method="static", particles=particles, slope=still, seconds=seconds)
    usual = None
    for factor, damping in ((1, 0.7), (8, 0.7), (4, 0.7), (2, 0.7), (0.3, 0.7), (1, 0.1), (1, 0.3), (1, 0.9)):
        speed = f"--punch-velocity {usual * factor}m/s" if usual else ""
        text, taken = pipe("bend --method dynamic --cycles 1 --damping {damping} {speed} {bar}", damping=damping, speed=speed,
                           bar=bar)
        test = json.loads(text)
        usual = usual or test["punch_velocity"]
        say("method", method="dynamic", particles=particles, velocity=test["punch_velocity"], velocity_factor=factor,
            damping=damping, slope_error=unloading_slope(test) / still - 1, energy_error=test["energy"]["error"],
            steps=test["steps"], seconds=taken, times_static=taken / seconds)


def thickness(folder, sizes, seeds):
    """One line a bar, then the limits of straight lines in d/h; bars scatter as d/h."""
    found = []
    for particles in sizes:
        for seed in seeds:
            bar = make_bar(folder, particles, seed)
            cell = json.loads(pipe("analyze elastic --tolerance 1e-6 {bar}", bar=bar)[0])["young_modulus"]
            text, seconds = pipe("bend --cycles 1 {bar}", bar=bar)
            test = json.loads(text)
            slope = unloading_slope(test)
            beam, near = (elastic_modulus(test, slope, kind) / cell for kind in (False, True))
            found.append((DIAMETER / test["height"], beam, near))
            say("thickness", particles=particles, seed=seed, particles_across=test["height"] / DIAMETER,
                slenderness=test["span"] / test["height"], cell_modulus=cell, beam_ratio=beam, near_field_ratio=near,
                iterations=test["iterations"], seconds=seconds)
    inverse, beam, near = numpy.array(found).T
    for name, ratio in (("beam", beam), ("near_field", near)):
        (slope, limit), covariance = numpy.polyfit(inverse, ratio, 1, w=1 / inverse, cov=True)
        say("thickness limit", formula=name, limit=limit, standard_error=float(numpy.sqrt(covariance[1, 1])), slope=slope)
    return inverse, near


def draw(inverse, ratio, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(figsize=(5.2, 3.6), layout="constrained")
    slope, limit = numpy.polyfit(inverse, ratio, 1, w=1 / inverse)
    line = numpy.array([0, inverse.max() * 1.05])
    axes.plot(inverse, ratio, "o", label="bars, whole height and width of the box")
    axes.plot(line, limit + slope * line, "-", color="#777777", label=f"straight line, limit {limit:.2f}")
    axes.plot(line, (1 - 0.5 * line) ** 4, "--", color="#bb4444", label="half a diameter less of either")
    axes.set_xlim(0, None)
    axes.set_ylim(0, 1.1)
    axes.set_xlabel("Particle diameter over height of the bar")
    axes.set_ylabel("Modulus from bending over that of the cell")
    axes.legend(frameon=False, loc="lower left")
    figure.savefig(path, dpi=150)


def sizes_of_static(folder, sizes):
    for particles in sizes:
        text, seconds = pipe("bend --cycles 1 {bar}", bar=make_bar(folder, particles, 1))
        test = json.loads(text)
        say("size", particles=test["particles"], bonds=test["bonds"], seconds=seconds, iterations=test["iterations"],
            residual=test["residual"], energy_error=test["energy"]["error"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", default=["method", "thickness", "size"])
    parser.add_argument("-o", "--output", help="figure of the case thickness")
    parser.add_argument("--sizes", default="1000,3000,10000,30000", help="numbers of particles")
    parser.add_argument("--seeds", default="1,2", help="packings of each size, thickness")
    given = parser.parse_args()
    sizes = [int(each) for each in given.sizes.split(",")]
    with tempfile.TemporaryDirectory() as folder:
        if "method" in given.cases:
            methods(folder, 1000)
        if "size" in given.cases:
            sizes_of_static(folder, sizes)
        if "thickness" in given.cases:
            inverse, ratio = thickness(folder, sizes, [int(each) for each in given.seeds.split(",")])
            if given.output:
                draw(inverse, ratio, given.output)


if __name__ == "__main__":
    main()
