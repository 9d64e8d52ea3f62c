"""convert_xyz.py: extended XYZ. The second line of a frame says box, time and columns as key=value; plain XYZ has words there."""
import re

import numpy

import units
from convert_common import (ConvertError, bounds, box_of, clipped, lines, number, numbers, particle_arrays, periodic_axes, warn,
                            whole, wholes, words_for, written)
from convert_check import warn_of_loss
from convert_found import Found, radius_from, style_of_units
from convert_materials import materials_of

PAIR = re.compile(r"([^\s=\"]+)=(?:\"([^\"]*)\"|\{([^}]*)\}|(\S+))")
SAME = {"position": "pos", "positions": "pos", "element": "species", "radii": "radius", "d": "diameter"}
FLAGS = {"1": True, "t": True, "true": True, "0": False, "f": False, "false": False}


# ---- written -------------------------------------------------------------------------------------------------------------------
def write_xyz(path, documents, given):
    system = given.units or "si"
    power = units.SYSTEMS[system][1]
    with written(path) as stream:
        for document in documents:
            warn_of_loss("extended XYZ", document, {"time", "particles.other"})
            particles = particle_arrays(document)
            low, high = bounds(document["box"])
            species = words_for([material["name"] for material in materials_of(document)], "material")
            other = {name: values for name, values in particles.items() if name not in ("position", "material")}
            names = dict(zip(other, words_for(other, "array")))
            if clash := {"pos", "species"} & set(names.values()):
                raise ConvertError(f"an array has the name {clash.pop()}, which means something else in XYZ; rename it")
            arrays, properties = [], ""
            for name, values in other.items():
                values = numpy.asarray(values).reshape(len(values), int(numpy.prod(values.shape[1:])))
                integer = values.dtype.kind in "iu"
                by = 0 if integer else units.power(system, name) or 0
                arrays.append([[str(each) if integer else units.shown(each, by) for each in row] for row in values.tolist()])
                properties += f":{names[name]}:{'I' if integer else 'R'}:{values.shape[1]}"
            lattice = " ".join(units.shown(value, power) for value in numpy.diag(high - low).ravel())
            stream.write(f"{len(particles['radius'])}\n")
            stream.write(f'Lattice="{lattice}" Origin="{" ".join(units.shown(value, power) for value in low)}" '
                         f'pbc="{" ".join("T" if axis else "F" for axis in periodic_axes(document["box"]))}" '
                         f'Time={units.shown(document.get("time", 0.0), units.SYSTEMS[system][2])} Units={system} '
                         f'Properties=species:S:1:pos:R:3{properties}\n')
            for row, (kind, place) in enumerate(zip(particles["material"], particles["position"].tolist())):
                values = [text for array in arrays for text in array[row]]
                stream.write(" ".join([species[kind], *(units.shown(each, power) for each in place), *values]) + "\n")


# ---- read ----------------------------------------------------------------------------------------------------------------------
def columns_of(properties, place):
    """Name, kind and width of the columns that Properties announces."""
    words = properties.split(":")
    if len(words) % 3:
        raise ConvertError(f"{place}: Properties is not a list of name:kind:width")
    columns = []
    for name, kind, width in zip(words[0::3], words[1::3], words[2::3]):
        plain = SAME.get(name.lower(), name.lower())
        name = plain if plain in units.DIMENSION or plain in ("pos", "species", "type") else name
        if kind not in "RISL" or len(kind) != 1 or not 0 < whole(width, place) < 1000:
            raise ConvertError(f"{place}: Properties has {clipped(name)}:{clipped(kind)}:{clipped(width)}; a kind is one of R, I, "
                               "S, L")
        if name in [each[0] for each in columns]:
            raise ConvertError(f"{place}: the column '{clipped(name)}' stands twice")
        columns.append((name, kind, int(width)))
    return columns


def array_of(column, cells, places, system):
    """The values of a column: numbers in SI units, or words."""
    name, kind, width = column
    measured = name == "pos" or units.DIMENSION.get(name, "number") != "number"
    if kind == "S":
        return [" ".join(each) for each in cells]
    if kind == "L":
        if any(cell.lower() not in FLAGS for each in cells for cell in each):
            raise ConvertError(f"{places[0]}: the column {clipped(name)} does not hold T and F")
        values = numpy.array([[FLAGS[cell.lower()] for cell in each] for each in cells], numpy.uint8)
    elif kind == "I" and not measured:
        values = wholes([cell for each in cells for cell in each], [place for place in places for _ in range(width)])
    else:
        power = units.power(system, "x" if name == "pos" else name)
        if power is None and system != "si":
            warn(f"{places[0].rpartition(', line')[0]}: the unit of the column {clipped(name)} is not known; its numbers are left "
                 "as they are")
        values = numbers([cell for each in cells for cell in each], [place for place in places for _ in range(width)], power or 0)
    values = values.reshape(len(cells), width)
    return values[:, 0] if width == 1 else values


def arrays_of(properties, rows, place, path, system):
    columns = columns_of(properties, place)
    wide = sum(width for _, _, width in columns)
    for row, words in rows:
        if len(words) != wide:
            raise ConvertError(f"{path}, line {row}: has {len(words)} columns, expected {wide}")
    arrays, first, places = {}, 0, [f"{path}, line {row}" for row, _ in rows] or [place]
    for column in columns:
        arrays[column[0]] = array_of(column, [words[first:first + column[2]] for _, words in rows], places, system)
        first += column[2]
    return arrays


def frames(path):
    """Each frame as the place of its first line, the comment, and its rows as (line, words). Blank lines may part frames."""
    rest = lines(path)
    for row, head in rest:
        if not head.strip():
            continue
        place = f"{path}, line {row}"
        count = whole(head.strip(), place)
        if count < 0:
            raise ConvertError(f"{place}: {count} particles are announced")
        comment = next(rest, (row, None))[1]
        rows = []
        while len(rows) < count:
            at, line = next(rest, (0, ""))
            if not line.strip():
                raise ConvertError(f"{place}: {count} particles are announced, {len(rows)} are there")
            rows.append((at, line.split()))
        if comment is None:
            raise ConvertError(f"{place}: the frame has no second line")
        yield place, comment, rows


def periodic_of(text, place):
    words = text.split() if len(text.split()) > 1 else list(text)
    if len(words) != 3 or not all(each.lower() in FLAGS for each in words):
        raise ConvertError(f"{place}: pbc=\"{clipped(text)}\" is not three of T and F")
    return [FLAGS[each.lower()] for each in words]


def box_from(keys, place, power):
    """The box, m; None for a free body without one."""
    for key in ("origin", "pbc"):
        if key in keys and "lattice" not in keys:
            raise ConvertError(f"{place}: has {key} without Lattice")
    if "lattice" not in keys:
        return None
    values = [number(text, place, power) for text in keys["lattice"].split()]
    low = numpy.array([number(text, place, power) for text in keys.get("origin", "0 0 0").split()])
    if len(values) != 9 or len(low) != 3:
        raise ConvertError(f"{place}: Lattice has {len(values)} numbers and Origin {len(low)}, expected 9 and 3")
    vectors = numpy.reshape(values, (3, 3))
    if (vectors != numpy.diag(numpy.diag(vectors))).any():
        raise ConvertError(f"{place}: the box is not orthogonal along x, y and z")
    box = box_of(low, low, periodic_of(keys.get("pbc", "T T T"), place))
    return {**box, "vectors": vectors.tolist()}


def keys_of(comment, place):
    keys = {}
    for name, *values in PAIR.findall(comment):
        if name.lower() in keys:
            raise ConvertError(f"{place}: {clipped(name)} stands twice")
        keys[name.lower()] = next((value for value in values if value), "")
    for name in ("lattice", "properties", "origin", "pbc"):
        if re.search(rf"(?i)(?<![^\s]){name}\b", comment) and name not in keys:
            raise ConvertError(f"{place}: {name} is not followed by = and a value")
    return keys


def read_xyz(path, given):
    order, empty = [], True
    for place, comment, rows in frames(path):
        empty = False
        keys = keys_of(comment, place)
        system = style_of_units(keys.get("units"), given, path, place)
        arrays = arrays_of(keys.get("properties", "species:S:1:pos:R:3"), rows, place, path, system)
        position = arrays.pop("pos", None)
        if not isinstance(position, numpy.ndarray) or position.shape != (len(rows), 3):
            raise ConvertError(f"{place}: Properties has no pos:R:3")
        particles = {"position": position, "radius": radius_from(arrays, len(rows), place)}
        labels, kinds = arrays.pop("species", None), arrays.pop("type", None)
        if isinstance(kinds, numpy.ndarray) and (kinds.ndim > 1 or kinds.dtype.kind not in "iu"):
            raise ConvertError(f"{place}: the column type is not one of whole numbers")
        if labels is None and kinds is not None:
            labels = kinds if isinstance(kinds, list) else kinds.tolist()
        if isinstance(labels, numpy.ndarray):
            raise ConvertError(f"{place}: the column species is not one of words")
        if "id" in arrays and (not isinstance(arrays["id"], numpy.ndarray) or arrays["id"].shape != (len(rows), ) or
                               arrays["id"].dtype.kind not in "iu"):
            raise ConvertError(f"{place}: the column id is not one of whole numbers")
        particles.update({name: values for name, values in arrays.items() if isinstance(values, numpy.ndarray)})
        if left := [clipped(name) for name, values in arrays.items() if isinstance(values, list)]:
            warn(f"{path}: the columns {', '.join(left)} hold words and are left out")
        box = box_from(keys, place, units.SYSTEMS[system][1])
        if box is None:
            warn(f"{path}: has no Lattice; its particles are taken for a free body")
        time = number(keys.get("time", "0"), place, units.SYSTEMS[system][2])
        yield Found(place, path, particles, box=box, time=time, labels=labels, order=order)
    if empty:
        raise ConvertError(f"{path}: is empty")
