"""trial.py: one trial of a relation: its random numbers, its folder, the programs it runs and how two results are compared."""
import io
import json
import os
import shlex
import subprocess
import sys
import zlib

import numpy

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path.insert(0, os.path.join(ROOT, "workflows", "post"))
import kiln  # noqa: E402  (the path comes first)

LONGEST = 120.0  # s of a run; those here take a second at most where the machine is idle


class Broken(Exception):
    """A relation that does not hold, or a program that ended otherwise than it should."""


def program(name):
    """A program's path: that in the environment, as in the other tests, or the one of the build."""
    return os.environ.get(name.upper(), os.path.join(ROOT, os.environ.get("BUILD", "build"), "bin", name))


class Trial:
    """What a relation works with. All that is random comes from `random`, so a name and a seed give the same trial again."""

    def __init__(self, name, seed, folder):
        self.random = numpy.random.default_rng([zlib.crc32(name.encode()), seed])
        self.folder = folder
        self.commands = []

    def path(self, name):
        return os.path.join(self.folder, name)

    def put(self, name, *documents, text=False):
        """Writes documents to a file of the trial's folder; its name, which programs run in that folder understand."""
        with open(self.path(name), "wb") as file:
            for document in documents:
                kiln.write(file, document, text)
        return name

    def get(self, name):
        """The documents of a file in the folder."""
        return kiln.read(self.path(name))

    def bytes_of(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def run(self, name, *arguments, given=b"", statuses=(0,), threads=1):
        """Runs a program in the folder. Returns its standard output; another status than those named breaks the relation."""
        command = [program(name), *map(str, arguments)]
        self.commands.append(f"OMP_NUM_THREADS={threads} ${name.upper()} {shlex.join(command[1:])}")
        try:
            ended = subprocess.run(command, input=given, capture_output=True, check=False, cwd=self.folder, timeout=LONGEST,
                                   env={**os.environ, "OMP_NUM_THREADS": str(threads)})
        except subprocess.TimeoutExpired:
            raise Broken(f"{self.commands[-1]}: took longer than {LONGEST} s") from None
        if ended.returncode not in statuses:
            raise Broken(f"{self.commands[-1]}: status {ended.returncode}, {ended.stderr.decode(errors='replace').strip()}")
        self.status, self.said = ended.returncode, ended.stderr.decode(errors="replace")
        return ended.stdout

    def states(self, name, *arguments, **options):
        """The documents that a program writes to standard output."""
        return list(kiln.documents(io.BytesIO(self.run(name, *arguments, **options))))

    def results(self, name, *arguments, **options):
        """The JSON documents that a program writes, one a line."""
        return [json.loads(line) for line in self.run(name, *arguments, **options).splitlines()]

    def choose(self, *values):
        return values[self.random.integers(len(values))]

    def between(self, low, high):
        return float(self.random.uniform(low, high))


def summary(document):
    """What the last program that worked on a state says of it."""
    return document["history"][-1]["summary"]


def near(what, found, wanted, tolerance, scale=None):
    """Breaks unless found is within tolerance of wanted, relative to the largest of wanted or to a given scale."""
    found, wanted = numpy.asarray(found, float), numpy.asarray(wanted, float)
    if found.shape != wanted.shape:
        raise Broken(f"{what}: {found.shape} values, {wanted.shape} wanted")
    if not (numpy.isfinite(found).all() and numpy.isfinite(wanted).all()):
        raise Broken(f"{what}: not finite")
    if found.size == 0:
        return
    scale = numpy.abs(wanted).max() if scale is None else scale
    off = numpy.abs(found - wanted).max()
    if not off <= tolerance * scale:
        worst = numpy.unravel_index(numpy.abs(found - wanted).argmax(), found.shape)
        place = f" {list(map(int, worst))}" if worst else ""
        raise Broken(f"{what}{place}: {found[worst]:.12g} for {wanted[worst]:.12g}, off by {off / scale if scale else off:.2g} of "
                     f"{scale:.3g}; at most {tolerance:.2g} is granted")


def same(what, found, wanted):
    """Breaks unless two values, or all bytes, are the same."""
    if isinstance(found, numpy.ndarray):
        if found.shape != wanted.shape or found.tobytes() != wanted.tobytes():
            off = numpy.abs(found - wanted).max() if found.shape == wanted.shape else "other shapes"
            raise Broken(f"{what}: not the same, off by {off}")
    elif found != wanted:
        shown = [repr(value) if len(repr(value)) < 60 else f"{len(repr(value))} characters" for value in (found, wanted)]
        raise Broken(f"{what}: {shown[0]}, not {shown[1]}")
