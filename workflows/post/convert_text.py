"""convert_text.py: extended XYZ, CSV (both ways) and the text export of MUSEN (read)."""
import csv
import json
import os
import re
import shlex

import numpy

from convert_common import (ConvertError, LARGE, SMALL, beside, bond_arrays, bounds, box_of, free_box, joined_columns,
                            nearest_image, neck_length, number, opened, particle_arrays, periodic_axes, rows_of, series,
                            split_columns, state, warn, whole, written)

CSV_LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}


# ---- extended XYZ --------------------------------------------------------------------------------------------------------------
def write_xyz(path, documents, given):
    bonds = False
    with written(path) as stream:
        for document in documents:
            particles, bonds = particle_arrays(document), bonds or "bonds" in document
            low, high = bounds(document["box"])
            materials = [material.get("name", "X") for material in document.get("materials") or [{"name": "alumina"}]]
            arrays = {
                name: numpy.asarray(values).reshape(len(particles["radius"]), -1)
                for name, values in particles.items() if name not in ("position", "material")
            }
            properties = "".join(f":{name}:{'I' if values.dtype.kind in 'iu' else 'R'}:{values.shape[1]}"
                                 for name, values in arrays.items())
            lattice = " ".join(repr(float(value)) for value in numpy.diag(high - low).ravel())
            stream.write(f"{len(particles['radius'])}\n")
            stream.write(f'Lattice="{lattice}" Origin="{" ".join(map(repr, low.tolist()))}" '
                         f'pbc="{" ".join("T" if axis else "F" for axis in periodic_axes(document["box"]))}" '
                         f'Time={document.get("time", 0.0)!r} Properties=species:S:1:pos:R:3{properties}\n')
            for row, (kind, place) in enumerate(zip(particles["material"], particles["position"].tolist())):
                values = [value for array in arrays.values() for value in array[row].tolist()]
                stream.write(" ".join([materials[kind].replace(" ", "_"), *map(repr, place), *map(repr, values)]) + "\n")
    if bonds:
        warn("extended XYZ holds no bonds; they are left out")


def xyz_columns(properties, rows, place):
    """Arrays by name from the lines of a frame."""
    words = properties.split(":")
    arrays, first = {}, 0
    for name, kind, width in zip(words[0::3], words[1::3], map(int, words[2::3])):
        cells = [row[first:first + width] for row in rows]
        try:
            convert = {"R": float, "I": int, "S": str, "L": lambda text: text.upper().startswith("T")}[kind]
            values = numpy.array([[convert(cell) for cell in each] for each in cells])
        except (KeyError, ValueError):
            raise ConvertError(f"{place}: the column {name} does not hold what Properties says") from None
        arrays[name] = values[:, 0] if width == 1 else values
        first += width
    return arrays


def read_xyz(path, given):
    with opened(path) as stream:
        row = 0
        while (head := stream.readline()).strip():
            place = f"{path}, line {row + 1}"
            count, comment = whole(head.strip(), place), stream.readline()
            rows = [stream.readline().split() for _ in range(count)]
            row += count + 2
            if rows and not rows[-1]:
                raise ConvertError(f"{place}: {count} particles are announced, fewer are there")
            words = dict(word.partition("=")[::2] for word in shlex.split(comment))
            keys = {key.lower(): value for key, value in words.items()}
            arrays = xyz_columns(keys.get("properties", "species:S:1:pos:R:3"), rows, place)
            species = arrays.pop("species", numpy.zeros(count))
            position = arrays.pop("pos")
            radius = arrays.pop("radius", None) if given.radius is None else numpy.full(count, given.radius)
            if radius is None:
                raise ConvertError(f"{place}: the particles have no radius; give --radius")
            document = state(xyz_box(keys, position, radius, place), {
                "position": position,
                "radius": radius
            }, float(keys.get("time", 0.0)))
            names = list(dict.fromkeys(species.tolist()))
            document["particles"]["material"] = numpy.array([names.index(each) for each in species.tolist()], numpy.int32)
            if species.dtype.kind == "U" and not given.like:
                document["materials"] = [{"name": name} for name in names]
            document["particles"].update({name: values for name, values in arrays.items() if values.dtype.kind in "fiu"})
            yield document


def xyz_box(keys, position, radius, place):
    if "lattice" not in keys:
        return free_box(position, radius)
    vectors = numpy.array([number(text, place) for text in keys["lattice"].split()]).reshape(3, 3)
    if (vectors != numpy.diag(numpy.diag(vectors))).any():
        raise ConvertError(f"{place}: the box is not orthogonal along x, y and z")
    low = numpy.array([number(text, place) for text in keys.get("origin", "0 0 0").split()])
    periodic = [flag.upper().startswith("T") for flag in keys.get("pbc", "T T T").split()]
    return box_of(low, low + numpy.diag(vectors), periodic)


# ---- CSV -----------------------------------------------------------------------------------------------------------------------
def write_table(stream, columns):
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(numpy.asarray(column).tolist() for column in columns.values())))


def write_csv(path, documents, given):
    """A table of particles for each state, box and time in remarks above it, and a table of bonds beside it."""
    documents = list(documents)
    for name, document in zip(series(path, len(documents)), documents):
        particles, bonds = particle_arrays(document), bond_arrays(document)
        x, y, z = particles["position"].T
        with written(name) as stream:
            stream.write(f"# time {document.get('time', 0.0)!r} s\n# box {json.dumps(document['box'])}\n")
            write_table(
                stream, {
                    "id": particles["id"],
                    "x (m)": x,
                    "y (m)": y,
                    "z (m)": z,
                    "radius (m)": particles["radius"],
                    "material": particles["material"],
                    **split_columns(particles, SMALL)
                })
        if bonds is None:
            continue
        if name == "-":
            warn("the bonds are left out; CSV on standard output holds particles only")
            continue
        with written(beside(name, ".bonds")) as stream:
            ends, image = particles["id"][bonds["pair"]].T, bonds["image"].T
            write_table(
                stream, {
                    "id1": ends[0],
                    "id2": ends[1],
                    "image_x": image[0],
                    "image_y": image[1],
                    "image_z": image[2],
                    "radius (m)": bonds["radius"],
                    "length (m)": bonds["length"],
                    "volume (m3)": bonds["volume"],
                    **split_columns(bonds, LARGE)
                })


def read_table(path):
    """Columns by name in SI units, and the remarks above them."""
    remarks, columns = [], None
    with opened(path) as stream:
        for row, line in enumerate(stream, start=1):
            if line.startswith("#"):
                remarks.append(line[1:].strip())
                continue
            cells = next(csv.reader([line], delimiter=";" if ";" in line else ","), [])
            if not cells:
                continue
            if columns is None:
                headings, columns = [cell.strip() for cell in cells], [[] for _ in cells]
                continue
            if len(cells) != len(columns):
                raise ConvertError(f"{path}, line {row}: has {len(cells)} columns, the heading has {len(columns)}")
            for column, cell in zip(columns, cells):
                column.append(number(cell.strip(), f"{path}, line {row}"))
    if not columns or not columns[0]:
        raise ConvertError(f"{path}: has no rows")
    table = {}
    for heading, values in zip(headings, columns):
        name, unit = re.fullmatch(r"(.*?)\s*(?:[(\[](.*?)[)\]])?", heading).groups() if "(" in heading else (heading, None)
        table[name] = numpy.array(values) * (CSV_LENGTHS.get(unit, 1.0) if unit else 1.0)
        if name in ("x", "y", "z", "radius", "diameter", "length") and unit not in CSV_LENGTHS:
            raise ConvertError(
                f"{path}: column '{heading}' has no unit of length; known here: {', '.join(CSV_LENGTHS)}, as in 'x (mm)'")
    return table, remarks


def read_csv(path, given):
    columns, remarks = read_table(path)
    for name in ("x", "y", "z"):
        if name not in columns:
            raise ConvertError(f"{path}: has no column {name}")
    position = numpy.column_stack([columns.pop(name) for name in ("x", "y", "z")])
    radius = columns.pop("radius", None)
    radius = columns.pop("diameter", numpy.full(len(position), numpy.nan)) / 2 if radius is None else radius
    radius = radius if given.radius is None else numpy.full(len(position), given.radius)
    if not (radius > 0).all():
        raise ConvertError(f"{path}: the particles have no radius; give --radius")
    told = dict(remark.split(" ", 1) for remark in remarks if " " in remark)
    box = json.loads(told["box"]) if "box" in told else free_box(position, radius)
    particles = {"position": position, "radius": radius}
    for name, kind in (("id", numpy.int64), ("material", numpy.int32)):
        if name in columns:
            particles[name] = columns.pop(name).astype(kind)
    document = state(box, {**particles, **joined_columns(columns)}, float(told.get("time", "0").split()[0]))
    companion = beside(path, ".bonds") if path != "-" else ""
    if os.path.exists(companion):
        bonds, _ = read_table(companion)
        ids = particle_arrays(document)["id"]
        pair = rows_of(ids, numpy.column_stack([bonds.pop("id1"), bonds.pop("id2")]), companion)
        images = [bonds.pop(f"image_{axis}", None) for axis in "xyz"]
        image = nearest_image(document, pair) if images[0] is None else numpy.column_stack(images).astype(numpy.int8)
        document["bonds"] = {"pair": pair, "image": image, **joined_columns(bonds)}
        if "length" not in bonds:
            document["bonds"]["length"] = neck_length(document, pair, image, bonds["radius"])
    yield document
