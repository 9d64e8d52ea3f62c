"""convert_csv.py: tables of particles and of bonds: CSV both ways, and lists x y z r of other programs, parted by blanks (read)."""
import csv
import json
import re

import numpy

import units
from convert_common import (ConvertError, LARGE, SMALL, beside, bond_arrays, clipped, companion_of, joined_columns, number,
                            particle_arrays, periodic_axes, series, split_columns, wholes, without_companion, written)
from convert_check import warn_of_loss
from convert_found import Found, radius_from
from tables import Table

KEYS = ("box", "materials", "contacts", "temperature")  # of a state, which stand as JSON in remarks
SI_UNIT = {"length": "m", "volume": "m3", "velocity": "m/s", "angular_velocity": "rad/s", "mass": "kg", "mass_density": "kg/m3",
           "force": "N", "moment": "N m", "pressure": "Pa"}


# ---- written -------------------------------------------------------------------------------------------------------------------
def heading(name):
    unit = SI_UNIT.get(units.DIMENSION.get(units.stem(name)))
    return f"{name} ({unit})" if unit else name


def write_table(stream, columns):
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(map(heading, columns))
    writer.writerows(zip(*(numpy.asarray(column).tolist() for column in columns.values())))


def checked_names(names):
    """Names of columns that the reader would take for something else are refused."""
    for name in names:
        if name.strip() != name or not name or re.search(r"[()\[\]\n#]", units.stem(name)):
            raise ConvertError(f"the array '{clipped(name)}' cannot be the heading of a table; rename it")


def write_csv(path, documents, given):
    """A table of particles for each state, box, time and materials in remarks above it, and a table of bonds beside it."""
    documents = list(documents)
    for name, document in zip(series(path, len(documents)), documents):
        particles, bonds = particle_arrays(document), bond_arrays(document)
        x, y, z = particles["position"].T
        holds = {*KEYS, "time", "constants", "particles.other", *(() if name == "-" else ("bonds", "bonds.other"))}
        warn_of_loss("a table of particles on standard output" if name == "-" else "CSV", document, holds)
        other = split_columns(particles, SMALL)
        checked_names(other)
        with written(name) as stream:
            stream.write(f"# time {document.get('time', 0.0)!r} s\n")
            for key in KEYS:
                if key in document:
                    value = {**document[key], "periodic": periodic_axes(document["box"])} if key == "box" else document[key]
                    stream.write(f"# {key} {json.dumps(value)}\n")
            write_table(
                stream, {
                    "id": particles["id"],
                    "x": x,
                    "y": y,
                    "z": z,
                    "radius": particles["radius"],
                    "material": particles["material"],
                    **other
                })
        if bonds is None or name == "-":
            without_companion(name, ".bonds")
            continue
        other = split_columns(bonds, LARGE)
        checked_names(other)
        with written(beside(name, ".bonds")) as stream:
            ends, image = particles["id"][bonds["pair"]].T, bonds["image"].T
            write_table(
                stream, {
                    "id1": ends[0],
                    "id2": ends[1],
                    **{f"image_{axis}": image[k] for k, axis in enumerate("xyz")},
                    **{each: bonds[each] for each in ("radius", "length", "volume")},
                    **other
                })


# ---- read ----------------------------------------------------------------------------------------------------------------------
def keys_of(remarks, path):
    """Keys of a state from the remarks that dem-convert writes; other remarks are words."""
    keys = {}
    for remark in remarks:
        if found := re.fullmatch(r"time (\S+) s", remark):
            keys["time"] = number(found[1], path)
        name, _, text = remark.partition(" ")
        if name not in KEYS or not re.match(r"[\[{]|[-+.0-9]+[0-9.eE+-]*$", text.strip()):
            continue
        try:
            keys[name] = json.loads(text)
        except ValueError:
            raise ConvertError(f"{path}: the remark '# {name} …' is not JSON") from None
    return keys


def whole_column(table, name):
    return wholes(table.texts(name), table.places)


def radii(table, system):
    """Radii, m, of a column radius or diameter; NaN where there is none."""
    columns = {name: table.values(name, system) for name in ("radius", "diameter") if name in table.names}
    return radius_from(columns, len(table.rows), table.path)


def read_csv(path, given):
    table, system = Table(path, given.columns, ("x", "y", "z")), given.units
    for name in ("x", "y", "z"):
        if name not in table.names:
            raise ConvertError(f"{path}: has no column {name}, only {', '.join(map(clipped, table.names))}; --columns names them "
                               "in their order")
    if system and all(unit or units.DIMENSION.get(units.stem(name)) in (None, "number") for name,
                      unit in zip(table.names, table.units)):
        raise ConvertError(f"{path}: all columns have units; --units is for those that have none")
    keys = keys_of(table.remarks, path)
    particles = {"position": numpy.column_stack([table.values(name, system) for name in ("x", "y", "z")]),
                 "radius": radii(table, system)}
    if "id" in table.names:
        particles["id"] = whole_column(table, "id")
    labels = None
    if "material" in table.names:
        labels = table.texts("material")
        if not table.is_text("material"):
            labels = wholes(labels, table.places).tolist()
    other = table.others(("x", "y", "z", "radius", "diameter", "id", "material"), system)
    particles.update(joined_columns(other))
    found = Found(path, path, particles, box=keys.pop("box", None), time=keys.pop("time", 0.0), labels=labels, first=0,
                  materials=keys.pop("materials", None), other=keys)
    companion = companion_of(path, ".bonds")
    if companion:
        found.bonds = bonds_of(Table(companion, given.bond_columns, ("id1", "id2")), system)
    elif given.bond_columns:
        raise ConvertError(f"{path}: has no table of bonds beside it; --bond-columns is for its columns")
    yield found


def bonds_of(table, system):
    for name in ("id1", "id2"):
        if name not in table.names:
            raise ConvertError(f"{table.path}: has no column {name}, only {', '.join(map(clipped, table.names))}; --bond-columns "
                               "names them in "
                               "their order")
    bonds = {"file": table.path, "ids": numpy.column_stack([whole_column(table, name) for name in ("id1", "id2")]),
             "radius": radii(table, system)}
    images = [f"image_{axis}" for axis in "xyz"]
    if any(name in table.names for name in images):
        if not all(name in table.names for name in images):
            raise ConvertError(f"{table.path}: has not all of the columns {', '.join(images)}")
        bonds["image"] = numpy.column_stack([whole_column(table, name) for name in images])
        bonds["told"] = numpy.ones(len(table.rows), bool)
    for name in ("length", "volume"):
        if name in table.names:
            bonds[name] = table.values(name, system)
    other = table.others(("id1", "id2", *images, "radius", "diameter", "length", "volume"), system)
    return {**bonds, **joined_columns(other)}
