"""in_process.py: dem-convert as a function, and a small state in which everything is that a format may lose."""
import contextlib
import io
import os
import sys

import numpy

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path.insert(0, os.path.join(ROOT, "workflows", "post"))
import convert_common  # noqa: E402  (the path comes first)
import dem_convert  # noqa: E402
import kiln  # noqa: E402

GLASS = {"name": "lead glass", "density": 2500.0, "young_modulus": 7e10, "poisson_ratio": 0.22, "source": "invented"}
STEEL = {"name": "steel", "density": 7850.0, "young_modulus": 2.1e11, "poisson_ratio": 0.3}


def program(name):
    """The path of a program: that in the environment, as in the other tests, or this tree's own."""
    return os.environ.get(name, os.path.join(ROOT, "build", "bin", name.lower()))


def convert(*arguments):
    """Status, warnings and error of a run."""
    said = io.StringIO()
    with contextlib.redirect_stderr(said):
        try:
            status = dem_convert.main([str(each) for each in arguments])
        except SystemExit as stop:  # argparse
            status = stop.code
    errors = [line for line in said.getvalue().splitlines() if ": warning: " not in line]
    return status, list(convert_common.warn.said), "\n".join(errors)


def converted(source, *options):
    """The states that a file becomes, and the warnings; AssertionError with the sentence where it is refused."""
    target = f"{source}.out.kiln"
    status, warnings, error = convert(*options, source, target)
    if status:
        raise AssertionError(error)
    return kiln.read(target), warnings


def refused(source, *options):
    """The sentence by which a file is refused; nothing may be written."""
    target = f"{source}.out.kiln"
    with contextlib.suppress(FileNotFoundError):
        os.unlink(target)
    status, _, error = convert(*options, source, target)
    assert status in (1, 2), f"{source} was taken"
    assert not os.path.exists(target), "a refused file was written"
    return error


def written(path, text):
    with open(path, "wb") as file:
        file.write(text if isinstance(text, bytes) else text.encode())
    return path


def packing(periodic=(True, True, True), bonded=True, seed=1, first_id=0):
    """A state of eight particles of two materials on a bent lattice of 2 x 2 x 2, with bonds between neighbours, some of them
    through periodic faces and two of one pair, and arrays that nobody knows."""
    chance = numpy.random.default_rng(seed)
    lengths = numpy.array([2.1e-6, 2.2e-6, 2.3e-6])
    origin = numpy.array([-1e-6, 0.0, 3.3e-7])
    corners = numpy.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    position = origin + (corners + 0.5) * lengths / 2 + chance.uniform(-5e-8, 5e-8, (8, 3))
    state = {
        "format": "dem-state", "version": 1, "units": "SI", "time": 1234.5678, "temperature": 1473.15,
        "box": {"origin": origin.tolist(), "vectors": numpy.diag(lengths).tolist(), "periodic": list(periodic)},
        "materials": [dict(GLASS), dict(STEEL)],
        "contacts": [{"materials": ["lead glass", "steel"], "surface_energy": 0.5}],
        "particles": {
            "id": numpy.array([7, 3, 12, 0, 5, 44, 9, 1], numpy.int64) + first_id, "position": position,
            "radius": chance.uniform(4e-7, 5.5e-7, 8), "material": numpy.array([0, 1, 1, 0, 0, 1, 0, 1], numpy.int32),
            "velocity": chance.normal(size=(8, 3)), "grain_number": numpy.arange(8, 16, dtype=numpy.int64),
            "fabric": chance.normal(size=(8, 3, 3))
        }
    }
    if bonded:
        pairs, images = [], []
        for axis, step in enumerate((4, 2, 1)):
            for i in range(8):
                if not i & step:
                    pairs.append((i, i | step))
                    images.append((0, 0, 0))
                    if periodic[axis]:  # and the same pair across the face
                        pairs.append((i, i | step))
                        images.append(tuple(-int(k == axis) for k in range(3)))
        count = len(pairs)
        state["bonds"] = {
            "pair": numpy.array(pairs, numpy.int32), "image": numpy.array(images, numpy.int8),
            "radius": chance.uniform(1e-7, 2e-7, count),
            "length": chance.uniform(1e-8, 1e-7, count), "volume": chance.uniform(1e-21, 1e-20, count),
            "force": chance.normal(size=(count, 3)) * 1e-6, "broken": numpy.arange(count, dtype=numpy.int32) % 3
        }
    return state


def saved(path, *states):
    with open(path, "wb") as stream:
        for state in states:
            kiln.write(stream, state)
    return path
