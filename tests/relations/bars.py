#!/usr/bin/env python3
"""bars.py: bends random small bars until they fail, and others with friction, and asks of each that its energies balance.

    bars.py --failure 300 --friction 100 --seed 1

Of a bar bent to failure: the curve is there, the work of the punch is positive and at most the largest force times the way it
went, and energy.error is at most 5e-3. Of a bar with friction, at a tolerance drawn from 1e-4 to 1e-12: a document without
NaN, with status 0, or with status 3 and a residual that is next to nothing. Packings that jam, or whose largest piece does not
reach from support to support, are no bars, and others are drawn in their place. What fails is printed as the commands that
repeat it.
"""
import argparse
import json
import os
import random
import subprocess
import sys

LARGEST_ERROR = 5e-3  # of the energy balance of a bar bent to failure, over the most that was stored
LARGEST_RESIDUAL = 1e-9  # of a bar with friction whose tolerance was not met
NO_BAR = ("the bar is in pieces", "the bar does not reach its supports", "touches no particle")


def program(name):
    return os.environ.get(name.upper(), os.path.join(os.environ.get("BUILD", "build"), "bin", name))


def packing(dice):
    """Commands that make a bar of 10 to 1,500 particles pressed to a density of 0.62 to 0.72."""
    green = [program("sinter"), "green", "-q", "-n", str(int(10 * 150 ** dice.random())), "--density", "0.5", "--method", "affine",
             "--compact-to", f"{dice.uniform(0.62, 0.72):.3f}", "--aspect", f"{dice.uniform(3, 5):.2f}:1:1",
             "--seed", str(dice.randrange(1, 10**6))]
    if dice.random() < 0.5:
        green += ["--distribution", "lognormal:100nm:1.3:50nm:200nm"]
    return [green, [program("bondify"), "-q"]]


def to_failure(dice):
    tensile, shear = (f"{dice.uniform(200, 2000):.0f}MPa" for _ in range(2))
    kinds = [["--tensile-strength", tensile], ["--shear-strength", shear],
             ["--tensile-strength", tensile, "--shear-strength", shear]]
    return dice.choice(kinds)


def with_friction(dice):
    tolerance = dice.choice(["1e-4", "1e-6", "1e-8", "1e-9", "1e-10", "1e-11", "1e-12"])
    return ["--friction", f"{dice.uniform(0.05, 0.6):.2f}", "--cycles", "1", "--tolerance", tolerance]


def piped(commands):
    """Output, words and status of the last of commands in a row; None if the first ones fail."""
    data = b""
    for command in commands:
        run = subprocess.run(command, input=data, capture_output=True)
        data = run.stdout
        if run.returncode != 0 and command is not commands[-1]:
            return None, run.stderr.decode(), run.returncode
    return data, run.stderr.decode(), run.returncode


def faults_of_failure(result, status):
    energy, curve = result["energy"], result["curve"]
    if status != 0:
        yield f"status {status}"
    if not energy["error"] <= LARGEST_ERROR:
        yield f"energy.error {energy['error']:.3g}"
    way = sum(abs(b - a) for a, b in zip(curve["punch"], curve["punch"][1:]))
    if not 0.0 < energy["work"] <= max(curve["force"]) * way:
        yield f"work {energy['work']:.3g} J"
    if len(curve["force"]) < 2 + (result["strength"]["breaks"] > 0):
        yield "no curve"


def faults_of_friction(result, status):
    if status not in (0, 3) or result["converged"] != (status == 0):
        yield f"status {status}"
    if status == 3 and not result["residual"] <= LARGEST_RESIDUAL:
        yield f"residual {result['residual']:.3g}"


def sweep(kind, count, dice, draw, faults_of):
    """Tries so many bars; the number of those that fail."""
    bad, tried, unmet, worst = 0, 0, 0, 0.0
    while tried < count:
        law = ["--bond-law", dice.choice(["series", "solid", "neck", "centre"])]
        commands = packing(dice) + [[program("bend"), *law, *draw(dice)]]
        output, words, status = piped(commands)
        if output is None or status == 1 and any(each in words for each in NO_BAR):
            continue
        tried += 1
        try:
            result = json.loads(output, parse_constant=lambda name: sys.exit(f"bars.py: {name} in a document"))
            faults = list(faults_of(result, status))
            worst, unmet = max(worst, result["energy"]["error"]), unmet + (status == 3)
        except (TypeError, ValueError):
            faults = [f"no document: {words.strip()}"]
        if faults:
            bad += 1
            print("; ".join(faults) + ":\n   ", " | ".join(" ".join(command) for command in commands), flush=True)
    print(f"{kind}: {tried} bars, {bad} failed, largest energy.error {worst:.2g}, {unmet} with status 3")
    return bad


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--failure", type=int, default=300, help="bars to bend to failure")
    parser.add_argument("--friction", type=int, default=100, help="bars to bend with friction")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    bad = sweep("failure", options.failure, random.Random(options.seed), to_failure, faults_of_failure)
    bad += sweep("friction", options.friction, random.Random(options.seed + 1), with_friction, faults_of_friction)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
