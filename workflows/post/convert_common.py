"""convert_common.py: what the converters share: errors, files written whole, series of files, states from bare columns."""
import contextlib
import math
import os
import sys

import numpy

LENGTHS = {"si": 1.0, "cgs": 1e-2, "micro": 1e-6, "nano": 1e-9}  # m, the unit of length of a LAMMPS style of units
TIMES = {"si": 1.0, "cgs": 1.0, "micro": 1e-6, "nano": 1e-9}  # s
SMALL, LARGE = ("id", "position", "radius", "material"), ("pair", "image", "radius", "length", "volume")


class ConvertError(Exception):
    """One sentence for the user: file, place, cause."""


def warn(sentence):
    print(f"dem-convert: warning: {sentence}", file=sys.stderr)


@contextlib.contextmanager
def written(path, mode="w"):
    """An open file that appears under its name only when it is whole; "-" is standard output."""
    if path == "-":
        yield sys.stdout if mode == "w" else sys.stdout.buffer
        return
    partial = f"{path}.partial-{os.getpid()}"
    try:
        with open(partial, mode, **({} if "b" in mode else {"encoding": "utf-8", "newline": "\n"})) as stream:
            yield stream
        os.replace(partial, path)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(partial)


@contextlib.contextmanager
def opened(path, mode="r"):
    if path == "-":
        yield sys.stdin if mode == "r" else sys.stdin.buffer
        return
    with open(path, mode, **({} if "b" in mode else {"encoding": "utf-8"})) as stream:
        yield stream


def beside(path, suffix):
    """The name of a companion: run.csv and ".bonds" give run.bonds.csv."""
    stem, kind = os.path.splitext(path)
    return f"{stem}{suffix}{kind}"


def series(path, count):
    """Names for so many states: the path itself for one, numbered ones for more."""
    if count == 1:
        return [path]
    if path == "-":
        raise ConvertError(f"{count} states do not fit into one file of this format on standard output")
    return [beside(path, f"-{number:04d}") for number in range(1, count + 1)]


def number(text, place):
    try:
        value = float(text)
    except ValueError:
        raise ConvertError(f"{place}: '{text}' is not a number") from None
    if not math.isfinite(value):
        raise ConvertError(f"{place}: {text} is not a finite number")
    return value


def whole(text, place):
    try:
        return int(text)
    except ValueError:
        raise ConvertError(f"{place}: '{text}' is not a whole number") from None


def split_columns(group, known):
    """The other arrays of a group as columns of single numbers: name, or name[0], name[1]…, and their values."""
    columns = {}
    for name, values in group.items():
        if name in known:
            continue
        flat = numpy.asarray(values).reshape(len(values), -1)
        if flat.shape[1] == 1:
            columns[name] = flat[:, 0]
        else:
            columns.update({f"{name}[{k}]": flat[:, k] for k in range(flat.shape[1])})
    return columns


def joined_columns(columns):
    """The inverse: name[0], name[1]… become one array with a row for each particle or bond."""
    arrays, parts = {}, {}
    for name, values in columns.items():
        stem, mark, index = name.partition("[")
        if mark and index.endswith("]") and index[:-1].isdigit():
            parts.setdefault(stem, {})[int(index[:-1])] = values
        else:
            arrays[name] = numpy.asarray(values)
    for stem, found in parts.items():
        arrays[stem] = numpy.stack([found[k] for k in sorted(found)], axis=1)
    return arrays


def box_of(low, high, periodic):
    """The box between two corners, m."""
    return {
        "origin": [float(x) for x in low],
        "vectors": numpy.diag(numpy.subtract(high, low)).tolist(),
        "periodic": [bool(p) for p in periodic]
    }


def bounds(box):
    """Lower and upper corner of a state's box, m."""
    low = numpy.array(box.get("origin", (0.0, 0.0, 0.0)))
    return low, low + numpy.diag(box["vectors"])


def periodic_axes(box):
    return [bool(p) for p in box.get("periodic", (True, True, True))]


def free_box(position, radius):
    """A box that just holds a body without periodic faces."""
    return box_of((position - radius[:, None]).min(axis=0), (position + radius[:, None]).max(axis=0), (False, ) * 3)


def state(box, particles, time=0.0):
    """A dem-state document of columns; ids are kept, whatever numbers they are."""
    return {"format": "dem-state", "version": 1, "units": "SI", "time": time, "box": box, "particles": particles}


def particle_arrays(document):
    """Particles with the arrays that may be missing from a stream."""
    particles = dict(document["particles"])
    count = len(particles["radius"])
    particles.setdefault("id", numpy.arange(count, dtype=numpy.int64))
    particles.setdefault("material", numpy.zeros(count, numpy.int32))
    return particles


def bond_arrays(document):
    """Bonds with the arrays that may be missing from a stream; None for a state without bonds."""
    if "bonds" not in document:
        return None
    bonds = dict(document["bonds"])
    bonds.setdefault("image", numpy.zeros((len(bonds["radius"]), 3), numpy.int8))
    bonds.setdefault("volume", math.pi * bonds["radius"]**2 * bonds["length"].clip(min=0))
    return bonds


def nearest_image(document, pair):
    """The image of each pair's second particle that is nearest to its first."""
    low, high = bounds(document["box"])
    position = document["particles"]["position"]
    step = (position[pair[:, 1]] - position[pair[:, 0]]) / (high - low)
    return (-numpy.round(step) * periodic_axes(document["box"])).astype(numpy.int8)


def neck_length(document, pair, image, radius):
    """Length of bonds between the particles' surfaces, m (Eq. 4 of Dosta et al. 2017); zero for one that spheres hide."""
    low, high = bounds(document["box"])
    position, size = document["particles"]["position"], document["particles"]["radius"]
    distance = numpy.linalg.norm(position[pair[:, 1]] + image * (high - low) - position[pair[:, 0]], axis=1)
    caps = [numpy.sqrt(numpy.maximum(size[pair[:, end]]**2 - radius**2, 0.0)) for end in (0, 1)]
    return numpy.maximum(distance - caps[0] - caps[1], 0.0)


def rows_of(ids, wanted, place):
    """Rows of the particles with the wanted ids."""
    row = {int(each): index for index, each in enumerate(ids)}
    try:
        return numpy.array([[row[int(each)] for each in ends] for ends in wanted], numpy.int32).reshape(-1, 2)
    except KeyError as missing:
        raise ConvertError(f"{place}: a bond names particle {missing.args[0]}, which is not there") from None
