"""mutate.py: feeds mutants of valid streams to the four programs; each run must end in order: see check()."""
import argparse
import collections
import io
import json
import os
import re
import resource
import subprocess
import sys
import time

import numpy

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "workflows", "post"))
import kiln  # noqa: E402  (the path comes first)
from mutants import mutant  # noqa: E402

LONGEST = 20.0  # s of a run; the longest here takes a tenth of a second where the machine is idle
MEMORY = 1 << 30  # bytes of address space; the streams have 2 to 20 kB
SENTENCE = re.compile(r"^(sinter|bondify|bend|analyze)( [a-z]+)?: [^\x00-\x1f]+$")
# What may have no value: fits and means of too few things, what a state does not hold.
NULLS = {"standard_error", "confidence_interval", "covariance", "standard_errors", "confidence_intervals", "r_squared", "aicc",
         "aic", "rank", "aicc_difference", "confidence", "prediction", "relative_density", "mean_diameter", "mean_length",
         "mean_overlap_ratio",
         "tensile_strength", "shear_strength", "temperature", "limited_percent", "calibrated_to",
         "dense_modulus_error", "dense_modulus_interval"}
FINITE = {"particles": ("position", "radius"), "bonds": ("radius", "length", "volume", "force", "moment", "normal_force")}


def program(name):
    """A program's path: that in the environment, as in the other tests, or the one in the folder BIN."""
    return os.environ.get(name.upper(), os.path.join(os.environ.get("BIN", os.path.join(ROOT, "build", "bin")), name))


def commands(kind):
    """The runs that streams of a kind are fed to."""
    sinter = [program("sinter"), "--temperature", "1200C", "--to-density", "0.58"]
    bend = [program("bend"), "--cycles", "1", "--points", "3"]
    analyze = [program("analyze")]
    state = [sinter, [*sinter, "--text"], [*sinter, "--boundary", "free"], [program("bondify")], [program("bondify"), "--text"],
             [*analyze, "density"], [*analyze, "info"], [*analyze, "select", "--density", "0.5,0.7"]]
    to_failure = [program("bend"), "--tensile-strength", "500MPa", "--until", "0.9"]
    bonded = [bend, to_failure, [*analyze, "bonds"], [*analyze, "elastic"], *state]
    slope = [*analyze, "modulus"]
    curve = [slope, [*slope, "--table"], [*slope, "--branch", "loading"], [*analyze, "info"]]
    modulus = [[*analyze, "fit", "--law", "all"], [*analyze, "fit"]]
    return {"green": state, "bonded": bonded, "curve": curve, "modulus": modulus}[kind]


def run(command, given, **options):
    return subprocess.run(command, input=given, capture_output=True, check=False, timeout=LONGEST, **options)


def seeds():
    """Valid streams by kind, as text and binary."""
    def made(command, given=b""):
        return subprocess.run(command, input=given, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True).stdout

    packing = ["-n", "40", "--aspect", "4:1:1", "--method", "affine", "--compact-to", "0.55", "--seed", "2"]
    green = made([program("sinter"), "green", *packing])
    bonded = made([program("bondify"), "-q"], green)
    curve = made([program("bend"), "-q", "--cycles", "1", "--points", "4"], bonded)
    modulus = made([program("analyze"), "modulus"], curve)
    points = b"".join(modulus.replace(b'"relative_density":0.5', b'"relative_density":0.%d' % digit) for digit in (5, 6, 7, 8))
    text = [made([program("analyze"), "select", "--index", "1", "--text"], stream) for stream in (green, bonded)]
    return [("green", green), ("green", text[0]), ("bonded", bonded), ("bonded", text[1]), ("curve", curve), ("modulus", points)]


def refuse_constant(name):
    raise ValueError(f"{name} in the output")


def check_values(value, key=""):
    """No JSON value is null but where one may be missing; the history is the input's."""
    if key == "history":
        return
    if value is None and key not in NULLS:
        raise ValueError(f"{key} is null")
    inner = value.items() if isinstance(value, dict) else [(key, each) for each in value] if isinstance(value, list) else []
    for name, each in inner:
        check_values(each, key if key in NULLS else name)


def check_output(command, output):
    """Results without NaN, states that Kiln's own reader has no part in reading."""
    if "--table" in command:
        if re.search(rb"\b(nan|inf)\b", output):
            raise ValueError("nan in the table")
        return
    for line in output.splitlines() if output[:1] == b"{" and b'"bytes":' not in output[:output.find(b"\n")] else []:
        document = json.loads(line, parse_constant=refuse_constant)
        if document.get("format", "dem-state") not in ("dem-state", "dem-info"):  # these repeat what the input says
            check_values(document)
    for document in kiln.documents(io.BytesIO(output)):
        for group, arrays in kiln.groups(document).items():
            for name in FINITE[group]:
                if isinstance(arrays.get(name), numpy.ndarray) and not numpy.isfinite(arrays[name]).all():
                    raise ValueError(f"{group}.{name} is not finite")


def limit_memory():
    """Of this process; not of a sanitized build (`make asan` says so), which reserves more and has limits of its own."""
    if "SANITIZED" not in os.environ:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def check(command, given):
    """Status of a run: 0 and 3 with sound output, 1 with one sentence. Throws ValueError for any other end."""
    try:
        ended = run(command, given, preexec_fn=limit_memory)
    except subprocess.TimeoutExpired:
        raise ValueError(f"took longer than {LONGEST} s") from None
    said = [line for line in ended.stderr.decode(errors="replace").splitlines() if ": warning: " not in line]
    if ended.returncode in (0, 3):
        check_output(command, ended.stdout)
        if said:
            raise ValueError(f"said {said}")
    elif ended.returncode == 1:
        if len(said) != 1 or not SENTENCE.match(said[0]):
            raise ValueError(f"said {said}, wanted one sentence")
    else:
        raise ValueError(f"ended with status {ended.returncode}, said {said}")
    return ended.returncode


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=400, help="number of mutants")
    parser.add_argument("--first", type=int, default=0, help="seed of the first mutant; the next has the next")
    parser.add_argument("--keep", default=".", metavar="FOLDER", help="where the mutants go that a program did not stand")
    options = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    os.environ["ASAN_OPTIONS"] = "hard_rss_limit_mb={0}:max_allocation_size_mb={0}".format(MEMORY >> 20)
    valid = seeds()
    ends, faults, slowest = collections.Counter(), 0, 0.0
    for seed in range(options.first, options.first + options.count):
        kind, stream = valid[seed % len(valid)]
        given = mutant(stream, seed)
        command = commands(kind)[seed // len(valid) % len(commands(kind))]
        start = time.monotonic()
        try:
            ends[check(command, given)] += 1
        except (ValueError, kiln.Error) as error:
            faults += 1
            path = os.path.join(options.keep, f"mutant-{seed}")
            with open(path, "wb") as file:
                file.write(given)
            print(f"{' '.join(command)} <{path}: {error}")
        slowest = max(slowest, time.monotonic() - start)
    print(f"{options.count} mutants: {ends[0]} taken, {ends[3]} taken without converging, {ends[1]} refused, {faults} faults, "
          f"slowest {slowest:.1f} s")
    return faults > 0


if __name__ == "__main__":
    sys.exit(main())
