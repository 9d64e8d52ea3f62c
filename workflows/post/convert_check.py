"""convert_check.py: what the programs would refuse does not leave dem-convert (see dem-state.5), and what a format does not hold is
said when it is written."""
import json
import math

import numpy

from convert_common import ConvertError, LARGE, SMALL, bounds, clipped, warn

CONSTANTS = {"density": 0.0, "surface_energy": 0.0, "atomic_volume": 0.0, "diffusion_parameter": 0.0, "dihedral_angle": 0.0,
             "young_modulus": 0.0, "poisson_ratio": -1.0}  # and the smallest value that each may have
KINDS = {"f8", "f4", "i8", "i4", "i2", "i1", "u1"}
OFF_AXIS = 1e-12  # part of a box vector's length that may stick out of its axis


def is_number(value, lowest=-math.inf):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value) and value >= lowest


def check_box(document, place):
    box = document.get("box")
    if not isinstance(box, dict) or "vectors" not in box:
        raise ConvertError(f"{place}: has no box with vectors")
    lists = [box.get("origin", [0, 0, 0]), *(box["vectors"] if isinstance(box["vectors"], list) else [None])]
    if len(lists) != 4 or not all(isinstance(each, list) and len(each) == 3 and all(map(is_number, each)) for each in lists):
        raise ConvertError(f"{place}: the box is not an origin and three vectors of three numbers")
    vectors = numpy.array(box["vectors"], float)
    for axis in range(3):
        if not vectors[axis, axis] > 0:
            raise ConvertError(f"{place}: the box has no length along {'xyz'[axis]}")
        if numpy.linalg.norm(numpy.delete(vectors[axis], axis)) > OFF_AXIS * vectors[axis, axis]:
            raise ConvertError(f"{place}: the box is not orthogonal along x, y and z")
    low, high = bounds(box)
    if not numpy.isfinite([low, high]).all():
        raise ConvertError(f"{place}: the box is beyond the range of numbers")
    periodic = box.get("periodic", [True] * 3)
    if not isinstance(periodic, list) or len(periodic) != 3 or not all(isinstance(axis, bool) for axis in periodic):
        raise ConvertError(f"{place}: box.periodic is not a list of three true or false")


def check_constants(material, where):
    for key, lowest in CONSTANTS.items():
        if key in material and not is_number(material[key], lowest):
            raise ConvertError(f"{where}: {key} is {clipped(material[key])}, not a number from {lowest:g} on")
    diffusion = material.get("grain_boundary_diffusion", {"prefactor": 0, "activation_energy": 0})
    if not isinstance(diffusion, dict) or not all(is_number(diffusion.get(key), 0) for key in ("prefactor", "activation_energy")):
        raise ConvertError(f"{where}: grain_boundary_diffusion needs prefactor and activation_energy")


def check_materials(document, place):
    names = []
    for key in ("materials", "contacts", "history"):
        if not isinstance(document.get(key, []), list):
            raise ConvertError(f"{place}: {key} is not a list")
    for material in document.get("materials", []):
        if not isinstance(material, dict) or not isinstance(material.get("name"), str):
            raise ConvertError(f"{place}: a material is an object with a name")
        if material["name"] in names:
            raise ConvertError(f"{place}: material '{clipped(material['name'])}' stands twice")
        names.append(material["name"])
        check_constants(material, f"{place}: material '{clipped(material['name'])}'")
    for contact in document.get("contacts", []):
        ends = contact.get("materials") if isinstance(contact, dict) else None
        if not isinstance(ends, list) or len(ends) != 2 or not all(name in (names or ["alumina"]) for name in ends):
            raise ConvertError(f"{place}: contacts names a material that is not there")
        for key in ("surface_energy", "diffusion_parameter"):
            if key in contact and not is_number(contact[key], 0):
                raise ConvertError(f"{place}: contact of {clipped(ends)}: {key} is not a number from 0 on")
    return len(names) or 1


# Arrays that are known: type, columns, and whether a state has to have them.
ARRAYS = {
    "particles": {"position": ("f8", 3, True), "radius": ("f8", 1, True), "id": ("i8", 1, False), "material": ("i4", 1, False)},
    "bonds": {"pair": ("i4", 2, True), "image": ("i1", 3, False), "radius": ("f8", 1, True), "length": ("f8", 1, True),
              "volume": ("f8", 1, False)},
    "necks": {"pair": ("i4", 2, True), "image": ("i1", 3, False), "radius": ("f8", 1, True)}
}


def check_arrays(document, place):
    """Shapes and types of all arrays, and that numbers are finite where they have to be."""
    for group, known in ARRAYS.items():
        if group not in document and group != "particles":
            continue
        arrays = document.get(group)
        if not isinstance(arrays, dict):
            raise ConvertError(f"{place}: {group} is not an object of arrays")
        for name, (_, _, required) in known.items():
            if required and name not in arrays:
                raise ConvertError(f"{place}: has no {group}.{name}")
        rows = len(arrays["radius"])
        for name, values in arrays.items():
            kind = values.dtype.str.lstrip("<>|=") if isinstance(values, numpy.ndarray) and values.ndim else None
            if kind not in KINDS:
                raise ConvertError(f"{place}: {group}.{clipped(name)} is not an array of numbers")
            wanted, width, _ = known.get(name, (kind, None, False))
            if kind != wanted:
                raise ConvertError(f"{place}: {group}.{name} has type {kind}, expected {wanted}")
            if len(values) != rows or width and values.shape != ((rows, ) if width == 1 else (rows, width)):
                raise ConvertError(f"{place}: {group}.{clipped(name)} has shape {list(values.shape)}, there are {rows} {group}")
            if width and not numpy.isfinite(values).all():
                raise ConvertError(f"{place}: {group}.{name} is not finite in row {int(numpy.argmin(numpy.isfinite(values)))}")


def check_particles(particles, materials, place):
    ids = particles.get("id", numpy.arange(len(particles["radius"])))
    small = numpy.flatnonzero(~(particles["radius"] > 0))
    if len(small):
        raise ConvertError(f"{place}: particle {ids[small[0]]} has radius {float(particles['radius'][small[0]])!r}, "
                           "expected a positive one")
    values, counts = numpy.unique(ids, return_counts=True)
    if (counts > 1).any():
        raise ConvertError(f"{place}: id {values[counts > 1][0]} stands {counts[counts > 1][0]} times")
    kinds = particles.get("material", numpy.zeros(1, numpy.int32))
    if len(kinds) and (kinds.min() < 0 or kinds.max() >= materials):
        raise ConvertError(f"{place}: a particle has material {kinds[(kinds < 0) | (kinds >= materials)][0]}, there are "
                           f"{materials}")


def check_joints(document, group, place):
    """What bonds and necks have in common: two particles that are there and not one, a radius, and no other of the same ends."""
    bonds, count, what = document[group], len(document["particles"]["radius"]), group.rstrip("s")
    ids = document["particles"].get("id", numpy.arange(count))
    pair = bonds["pair"].astype(numpy.int64)
    image = bonds.get("image", numpy.zeros((len(pair), 3), numpy.int8)).astype(numpy.int64)
    if not len(pair):
        return
    if pair.min() < 0 or pair.max() >= count:
        raise ConvertError(f"{place}: a {what} has particle row {pair[(pair < 0) | (pair >= count)][0]}, there are {count}")

    def shown(row):
        return "-".join(str(each) for each in ids[pair[row]].tolist())

    own = numpy.flatnonzero((pair[:, 0] == pair[:, 1]) & ~image.any(axis=1))
    if len(own):
        raise ConvertError(f"{place}: {what} {own[0]} has particle {ids[pair[own[0], 0]]} at both ends")
    thin = numpy.flatnonzero(bonds["radius"] < 0)
    if len(thin):
        raise ConvertError(f"{place}: {what} {shown(thin[0])} has radius {float(bonds['radius'][thin[0]])!r}, expected none below "
                           "zero")
    if twice := same_bonds(pair, image):
        raise ConvertError(f"{place}: {group} {twice[0]} and {twice[1]} are one: both join {shown(twice[1])} with the same image")


def same_bonds(pair, image):
    """The rows of two bonds that are one, from i to j or from j to i; None if there are none."""
    forward, backward = numpy.column_stack([pair, image]), numpy.column_stack([pair[:, ::-1], -image])
    turned, open_ = numpy.zeros(len(pair), bool), numpy.ones(len(pair), bool)
    for column in range(5):  # the smaller of both ways to write it, in the order of the dictionary
        turned |= open_ & (backward[:, column] < forward[:, column])
        open_ &= backward[:, column] == forward[:, column]
    ends = numpy.where(turned[:, None], backward, forward)
    order = numpy.lexsort(ends.T[::-1])
    same = numpy.flatnonzero((ends[order[1:]] == ends[order[:-1]]).all(axis=1))
    return (int(order[same[0]]), int(order[same[0] + 1])) if len(same) else None


def check(document, place):
    """Refuses a state that the programs would refuse."""
    for key in ("time", "temperature"):
        if key in document and not is_number(document[key], 0.0 if key == "temperature" else -math.inf):
            raise ConvertError(f"{place}: {key} is {clipped(document[key])}, not a number")
    for key, wanted in (("format", "dem-state"), ("version", 1), ("units", "SI")):
        if document.get(key, wanted) != wanted:
            raise ConvertError(f"{place}: has {key} {clipped(document[key])}, expected {wanted}")
    check_box(document, place)
    materials = check_materials(document, place)
    check_arrays(document, place)
    check_particles(document["particles"], materials, place)
    for group in ("bonds", "necks"):
        if group in document:
            check_joints(document, group, place)
    try:
        json.dumps({key: value for key, value in document.items() if key not in ARRAYS}, allow_nan=False,
                   default=lambda value: None)
    except ValueError:
        raise ConvertError(f"{place}: holds a number that is not finite") from None


KEYS = {"format", "version", "units", "box", "particles", "history"}  # what every format holds, or no other program needs


def warn_of_loss(what, document, holds):
    """Says once what of a state a format does not hold. `holds` names keys of the state ("time", "materials", "constants",
    "contacts", "temperature", "bonds"), and "particles" or "bonds" for arrays that nobody here knows."""
    lost = []
    if "constants" not in holds and any(set(material) - {"name", *holds} for material in document.get("materials", [])):
        lost.append("the constants of materials")
    for key in document:
        if key not in KEYS | {"bonds", "materials"} and key not in holds and not (key == "time" and not document["time"]):
            lost.append(key)
    bonds = document.get("bonds")
    if bonds is not None and "bonds" not in holds:
        lost.append("bonds")
    for group, arrays, known in (("particles", document["particles"], SMALL), ("bonds", bonds or {}, LARGE)):
        other = [f"{group}.{name}" for name in arrays if name not in known]
        if other and f"{group}.other" not in holds and (group == "particles" or "bonds" in holds):
            lost.extend(other)
    if lost:
        more = "; --like with the state itself lends what it can when the file is converted back" if what != "VTU" else ""
        warn(f"{what} does not hold {', '.join(map(clipped, lost))}{more}")
