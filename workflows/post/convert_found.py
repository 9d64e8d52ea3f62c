"""convert_found.py: what was found in a file of another program, and how a state becomes of it: what the file does not say comes
from the options or from the state of --like, or is refused."""
import dataclasses

import numpy

import convert_materials
import units
import kiln
from convert_common import (ConvertError, clipped, free_box, nearest_image, neck_length, periodic_axes, rows_of, warn)
from convert_check import check, check_box, check_materials


@dataclasses.dataclass
class Found:
    """A state as a file has it, in SI units. NaN in a radius, length or volume is what the file does not say."""
    place: str  # for messages: file and line
    file: str
    particles: dict  # position, radius, id, and other arrays
    box: dict = None  # without the key periodic where the file does not say it
    time: float = 0.0
    labels: list = None  # the particles' materials: names, or numbers
    first: int = 1  # the number of the first type
    types: int = 0  # how many the file announces
    type_names: dict = dataclasses.field(default_factory=dict)  # of numbered types
    constants: dict = dataclasses.field(default_factory=dict)  # of a label: density and so on
    materials: list = None  # in full, where the file holds them
    other: dict = dataclasses.field(default_factory=dict)  # other keys of the state: contacts, temperature
    bonds: dict = None  # ids (M x 2), radius, length, volume, perhaps image (M x 3) with a mask of those that are told
    order: list = dataclasses.field(default_factory=list)  # names of materials by first appearance in all frames
    counts_from_one: bool = False  # LAMMPS knows no id 0: ids of a state that has one were raised

    def __len__(self):
        return len(self.particles["radius"])

    def shifted_ids(self, state):
        """Ids of a state as this file would have them."""
        ids = state["particles"].get("id", numpy.arange(len(state["particles"]["radius"])))
        return ids + raised(ids) if self.counts_from_one else ids


def style_of_units(said, given, file, place):
    """The style of units of a file: what it says or --units, which have to agree; SI units with a warning where neither does."""
    if said is None and given.units is None:
        warn(f"{file}: does not say its units; its numbers are taken for SI units, --units micro and so on say otherwise")
    if said is not None and said not in units.SYSTEMS:
        raise ConvertError(f"{place}: units {clipped(said)} have no length in metres; known here: {', '.join(units.SYSTEMS)}")
    if said and given.units and said != given.units:
        raise ConvertError(f"{place}: --units {given.units} is against what the file says, {said}")
    return said or given.units or "si"


def radius_from(arrays, count, place):
    """The radii, m, of an array radius or diameter, which is taken out; NaN where there is neither."""
    if "radius" in arrays and "diameter" in arrays:
        raise ConvertError(f"{place}: has the columns radius and diameter; leave one out")
    half = 2.0 if "diameter" in arrays else 1.0
    values = arrays.pop("diameter", arrays.pop("radius", numpy.full(count, numpy.nan)))
    if not isinstance(values, numpy.ndarray) or values.shape != (count, ):
        raise ConvertError(f"{place}: the radii are not one number each")
    return values / half


def raised(ids):
    """By how much ids are raised where they are counted from 1."""
    return max(0, 1 - int(numpy.min(ids, initial=1)))


def with_radii(found, given):
    radius = found.particles["radius"]
    missing = numpy.isnan(radius)
    if given.radius is not None:
        if len(radius) and not missing.any():
            raise ConvertError(f"{found.place}: the particles have radii; --radius is for those that have none")
        found.particles["radius"] = numpy.where(missing, given.radius, radius)
    elif missing.any():
        raise ConvertError(f"{found.place}: the particles have no radius and no diameter; give --radius")


def with_box(found, like, given):
    if found.box is None:
        if given.boundary:
            raise ConvertError(f"{found.place}: has no box; --boundary is for one that does not say its periodic axes")
        found.box = free_box(found.particles["position"], found.particles["radius"], found.place)
    if not isinstance(found.box, dict):
        raise ConvertError(f"{found.place}: the box is not an object")
    told = [axis == "p" for axis in given.boundary] if given.boundary else None
    said = found.box.get("periodic")
    if told and said is not None and told != said:
        raise ConvertError(f"{found.place}: --boundary is against what the file says, {''.join('fp'[axis] for axis in said)}")
    if said is None:
        if not told and not like:
            warn(f"{found.file}: does not say which axes are periodic; all are taken for it, --boundary or --like says otherwise")
        found.box["periodic"] = told or (periodic_axes(like["box"]) if like else [True, True, True])
    check_box({"box": found.box}, found.place)


def lent(found, like, document):
    """Radius, length, volume and image of the bonds of --like for those that have the same pair of ids."""
    bonds, other = found.bonds, like.get("bonds")
    missing = any(numpy.isnan(bonds[name]).any() for name in ("radius", "length", "volume"))
    if other is None or not missing and bonds["told"].all():
        return
    ids = found.shifted_ids(like)
    lenders = {}
    for row, (i, j) in enumerate(ids[other["pair"]].tolist()):
        lenders.setdefault((min(i, j), max(i, j)), []).append((row, i > j))
    images = other.get("image", numpy.zeros((len(other["radius"]), 3), numpy.int8)).astype(numpy.int64)
    volume = other.get("volume", kiln.cylinder_volume(other["radius"], other["length"]))
    wanted, seen = bonds["ids"].tolist(), {}
    often = {}
    for i, j in wanted:
        often[min(i, j), max(i, j)] = often.get((min(i, j), max(i, j)), 0) + 1
    for row, (i, j) in enumerate(wanted):
        pair = min(i, j), max(i, j)
        if pair not in lenders:
            continue
        oriented = [(k, images[k] if swapped == (i > j) else -images[k]) for k, swapped in lenders[pair]]
        if len(oriented) == 1:
            lender = oriented[0]
        elif bonds["told"][row]:
            lender = next((each for each in oriented if (each[1] == bonds["image"][row]).all()), None)
        elif often[pair] == len(oriented):  # each of several bonds of one pair goes through another face
            lender = oriented[seen.setdefault(pair, 0)]
            seen[pair] += 1
            bonds["image"][row] = lender[1]
        else:
            lender = None
        for name, values in (("radius", other["radius"]), ("length", other["length"]), ("volume", volume)):
            if lender and numpy.isnan(bonds[name][row]):
                bonds[name][row] = values[lender[0]]


def with_bonds(found, document, like, given):
    """The bonds with all their arrays: what the file does not say comes from --like, --bond-radius or the particles' places."""
    bonds = found.bonds
    count = len(bonds["ids"])
    bonds["pair"] = rows_of(found.particles["id"], bonds["ids"], bonds["file"])
    bonds.setdefault("told", numpy.zeros(count, bool))
    nearest = nearest_image(document, bonds["pair"])
    bonds["image"] = numpy.where(bonds["told"][:, None], bonds["image"], nearest) if "image" in bonds else nearest
    for name in ("radius", "length", "volume"):
        bonds.setdefault(name, numpy.full(count, numpy.nan))
    missing = numpy.isnan(bonds["radius"])
    if given.bond_radius is not None and count and not missing.any():
        raise ConvertError(f"{bonds['file']}: its bonds have radii; --bond-radius is for those that have none")
    if like:
        lent(found, like, document)
        missing = numpy.isnan(bonds["radius"])
    if missing.any():
        if given.bond_radius is None:
            which = "its bonds have" if missing.all() else f"its bond {'-'.join(map(str, bonds['ids'][missing][0].tolist()))} has"
            raise ConvertError(f"{bonds['file']}: {which} no radius; give --bond-radius, or --like with a state of the same bonds")
        bonds["radius"] = numpy.where(missing, given.bond_radius, bonds["radius"])
        given.used.add("bond_radius")
    missing = numpy.isnan(bonds["length"])
    if missing.any():
        bonds["length"] = numpy.where(missing, neck_length(document, bonds["pair"], bonds["image"], bonds["radius"]),
                                      bonds["length"])
    missing = numpy.isnan(bonds["volume"])
    bonds["volume"] = numpy.where(missing, kiln.cylinder_volume(bonds["radius"], bonds["length"]), bonds["volume"])
    if missing.all():
        del bonds["volume"]  # by default that of the cylinder
    arrays = {name: values for name, values in bonds.items() if name not in ("ids", "told", "file", "image")}
    image = bonds["image"]
    far = numpy.flatnonzero(abs(image).max(axis=1, initial=0) > 127)
    if len(far):
        raise ConvertError(f"{bonds['file']}: bond {'-'.join(map(str, bonds['ids'][far[0]].tolist()))} goes through "
                           f"{abs(image[far[0]]).max()} boxes, more than 127")
    document["bonds"] = {"pair": arrays.pop("pair"), "image": image.astype(numpy.int8), **arrays}


def completed(found, like, given):
    """The state, checked."""
    with_radii(found, given)
    with_box(found, like, given)
    found.particles.setdefault("id", numpy.arange(len(found), dtype=numpy.int64))
    check_materials({**found.other, "materials": found.materials or []}, found.place)
    materials, places = convert_materials.settle(found, like, given)
    document = {"format": "dem-state", "version": 1, "units": "SI", "time": found.time, **found.other, "box": found.box,
                "materials": materials}
    document["particles"] = {**found.particles, "material": places.astype(numpy.int32)}
    if found.bonds is not None:
        with_bonds(found, document, like, given)
    check(document, found.place)
    return document
