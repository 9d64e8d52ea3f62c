"""chain.py: what the chain costs against the number of particles, as JSON lines; -o FIGURE draws time and memory.

green     a periodic packing compacted affinely to 0.58
sintered  from 0.58 to 0.70 at 1200 degrees
bonded    the bonds of its contacts
elastic   the tensor of the cell, tolerance 1e-6

Then, for each program, the exponent of a straight line through the logarithms of time and number from 10,000 particles on.
"""
import argparse
import json
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "common"))
from measure import Run, say  # noqa: E402
import numpy  # noqa: E402
from style import ACCENT, LINE, REFERENCE, pyplot, save  # noqa: E402

SIZES = (1000, 3000, 10000, 30000, 100000, 300000, 1000000, 4000000)
STAGES = {"green": ":", "sintered": "o-", "bonded": "^-", "elastic": "s-"}
FROM = 10000  # particles; smaller bodies fit into caches


def chain(folder, particles):
    def path(name):
        return os.path.join(folder, f"{name}.kiln")

    def measured(stage, *command):
        run = Run(command)
        return say("chain", stage, particles=particles, seconds=run.wall, processor_seconds=run.processor,
                   peak_bytes=run.peak_bytes)

    rows = [measured("green", "sinter", "green", "-q", "-n", particles, "--density", 0.45, "--method", "affine",
                     "--compact-to", 0.58, "--seed", 1, "-o", path("green")),
            measured("sintered", "sinter", "-q", "--temperature", "1200C", "--to-density", 0.7, path("green"), "-o", path("dense")),
            measured("bonded", "bondify", "-q", path("dense"), "-o", path("bonded")),
            measured("elastic", "analyze", "elastic", "-q", "--tolerance", 1e-6, path("bonded"), "-o", path("tensor"))]
    for name in ("green", "dense", "bonded"):
        os.remove(path(name))
    return [{**row, "stage": stage} for row, stage in zip(rows, STAGES)]


def exponents(rows):
    for stage in STAGES:
        points = [(row["particles"], row["seconds"]) for row in rows if row["stage"] == stage and row["particles"] >= FROM]
        if len(points) > 1:
            say("chain", "growth", stage=stage, exponent=numpy.polyfit(*numpy.log(numpy.array(points).T), 1)[0])


def draw(rows, path):
    figure, (times, memory) = pyplot.subplots(1, 2, figsize=(8.4, 3.4))
    for (stage, style), colour in zip(STAGES.items(), (REFERENCE, LINE, "tab:green", ACCENT)):
        own = [row for row in rows if row["stage"] == stage]
        counts = [row["particles"] for row in own]
        times.loglog(counts, [row["seconds"] for row in own], style, color=colour, label=stage, markersize=4)
        memory.loglog(counts, [row["peak_bytes"] / 1e9 for row in own], style, color=colour, label=stage, markersize=4)
    counts = numpy.array([min(row["particles"] for row in rows), max(row["particles"] for row in rows)], float)
    last = max(row["seconds"] for row in rows if row["particles"] == counts[1])
    times.loglog(counts, 2 * last * (counts / counts[1]) ** 1.1, "--", color=REFERENCE, linewidth=0.8, label="as $N^{1.1}$")
    times.set(xlabel="particles", ylabel="wall time, s")
    memory.set(xlabel="particles", ylabel="peak memory, GB")
    times.legend()
    save(figure, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", help="picture to write (png, svg or pdf)")
    parser.add_argument("--largest", type=int, default=300000, help="packing; 4,000,000 takes a quarter of an hour")
    parser.add_argument("--only", type=int, metavar="PARTICLES", help="one packing of this size")
    parser.add_argument("--draw", nargs="+", metavar="FILE", help="draw what earlier runs printed, measure nothing")
    given = parser.parse_args()
    if given.draw:
        found = [json.loads(line) for name in given.draw for line in open(name, encoding="utf-8") if line.startswith("{")]
        rows = [{**row, "stage": row["case"]} for row in found if row["case"] in STAGES]
    else:
        rows = []
        for particles in [given.only] if given.only else [size for size in SIZES if size <= given.largest]:
            with tempfile.TemporaryDirectory() as folder:
                rows += chain(folder, particles)
    exponents(rows)
    if given.output:
        draw(rows, given.output)


if __name__ == "__main__":
    main()
