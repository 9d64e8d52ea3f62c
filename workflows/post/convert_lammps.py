"""convert_lammps.py: LAMMPS data files (atom styles sphere and bpm/sphere, bonds) and text dumps, of particles and of bonds.

A data file knows neither periodic axes nor the size of a bond. The first line, which LAMMPS skips, says units, boundary and time;
behind each bond stands a remark with its radius, length, volume (m, m3) and periodic image."""
import os
import re

import numpy

from convert_common import (ConvertError, LENGTHS, SMALL, LARGE, TIMES, beside, bond_arrays, bounds, box_of, joined_columns,
                            nearest_image, neck_length, number, opened, particle_arrays, periodic_axes, rows_of, series,
                            split_columns, state, warn, whole, written)

ATOM_COLUMNS = {  # of the styles that know a diameter
    "sphere": ("id", "type", "diameter", "density", "x", "y", "z"),
    "bpm/sphere": ("id", "molecule", "type", "diameter", "density", "x", "y", "z"),
    "hybrid sphere bond": ("id", "type", "x", "y", "z", "diameter", "density", "molecule"),
}
DEFAULT_DENSITY = 3950.0  # kg/m3, alumina


# ---- data files ----------------------------------------------------------------------------------------------------------------
def write_data_file(stream, document, given):
    particles, bonds = particle_arrays(document), bond_arrays(document)
    length, units = LENGTHS[given.units], given.units
    low, high = bounds(document["box"])
    ids = particles["id"] + (1 if particles["id"].min(initial=1) < 1 else 0)  # LAMMPS counts from 1
    if ids.min(initial=1) < 1:
        raise ConvertError("a particle has a negative id, which LAMMPS does not know")
    materials = document.get("materials") or [{}]
    density = [material.get("density", DEFAULT_DENSITY) for material in materials]
    boundary = " ".join("p" if axis else "f" for axis in periodic_axes(document["box"]))
    stream.write(f"# by dem-convert: units {units}, boundary {boundary}, time {document.get('time', 0.0)!r} s\n\n")
    stream.write(f"{len(ids)} atoms\n{len(materials)} atom types\n")
    if bonds is not None:
        own = int((bonds["pair"][:, 0] == bonds["pair"][:, 1]).sum())
        if own:
            raise ConvertError(f"{own} bonds join a particle with its own periodic image, which LAMMPS does not know")
        most = numpy.bincount(bonds["pair"].ravel(), minlength=1).max(initial=1)
        stream.write(f"{len(bonds['radius'])} bonds\n1 bond types\n{most} extra bond per atom\n")
    stream.write("\n")
    for axis, name in enumerate("xyz"):
        stream.write(f"{low[axis] / length!r} {high[axis] / length!r} {name}lo {name}hi\n")
    style = "sphere" if bonds is None else "bpm/sphere"
    stream.write(f"\nAtoms # {style}\n\n")
    molecule = "" if bonds is None else "1 "
    for each, kind, radius, place in zip(ids, particles["material"], particles["radius"] / length, particles["position"] / length):
        x, y, z = (float(value) for value in place)
        stream.write(f"{each} {molecule}{kind + 1} {float(2 * radius)!r} {density[kind]!r} {x!r} {y!r} {z!r}\n")
    if bonds is not None:
        stream.write("\nBonds\n\n")
        for row, (i, j) in enumerate(bonds["pair"]):
            size = " ".join(f"{name} {float(bonds[name][row])!r}" for name in ("radius", "length", "volume"))
            image = " ".join(str(int(shift)) for shift in bonds["image"][row])
            stream.write(f"{row + 1} 1 {ids[i]} {ids[j]} # {size} image {image}\n")


def write_data(path, documents, given):
    documents = list(documents)
    for name, document in zip(series(path, len(documents)), documents):
        with written(name) as stream:
            write_data_file(stream, document, given)


def sections_of(lines, path):
    """The header's numbers and, for each section, its style and its lines as (place, words, remark)."""
    counts, limits, sections, current = {}, {}, {}, None
    for row, line in enumerate(lines[1:], start=2):
        text, _, remark = line.partition("#")
        words, place = text.split(), f"{path}, line {row}"
        if not words:
            continue
        if words[0][0].isalpha():
            current = (remark.strip(), [])
            sections[" ".join(words)] = current
        elif current is not None:
            current[1].append((place, words, remark))
        elif len(words) >= 4 and words[2].endswith("lo"):
            limits[words[2][0]] = (number(words[0], place), number(words[1], place))
        elif len(words) == 6 and words[3:] == ["xy", "xz", "yz"] and any(number(word, place) for word in words[:3]):
            raise ConvertError(f"{place}: the box is tilted, which a dem-state is not")
        else:
            counts[" ".join(words[1:])] = words[0]
    for axis in "xyz":
        if axis not in limits:
            raise ConvertError(f"{path}: has no line '{axis}lo {axis}hi'")
    if "Atoms" not in sections:
        raise ConvertError(f"{path}: has no section Atoms")
    if len(sections["Atoms"][1]) != whole(counts.get("atoms", "0"), path):
        raise ConvertError(f"{path}: {counts.get('atoms', 0)} atoms are announced, {len(sections['Atoms'][1])} are there")
    return limits, sections


def bonds_of_section(document, rows, ids, path, given):
    """The bonds of a data file; what the remarks behind them do not say comes from --bond-radius and the particles' places."""
    pair = rows_of(ids, [(whole(words[2], place), whole(words[3], place)) for place, words, _ in rows], path)
    told = [dict(re.findall(r"(radius|length|volume)\s+(\S+)", remark)) for _, _, remark in rows]
    images = [re.search(r"image\s+(-?\d+)\s+(-?\d+)\s+(-?\d+)", remark) for _, _, remark in rows]
    bonds = {"pair": pair, "image": nearest_image(document, pair)}
    for row, image in enumerate(images):
        if image:
            bonds["image"][row] = [int(shift) for shift in image.groups()]
    for name in ("radius", "length", "volume"):
        if all(name in each for each in told):
            bonds[name] = numpy.array([number(each[name], place) for each, (place, _, _) in zip(told, rows)])
    if "radius" not in bonds:
        if given.bond_radius is None:
            raise ConvertError(f"{path}: its bonds have no radius; give --bond-radius")
        bonds["radius"] = numpy.full(len(pair), given.bond_radius)
    if "length" not in bonds:
        bonds["length"] = neck_length(document, pair, bonds["image"], bonds["radius"])
    return bonds


def read_data(path, given):
    with opened(path) as stream:
        lines = stream.read().splitlines()
    if not lines:
        raise ConvertError(f"{path}: is empty")
    limits, sections = sections_of(lines, path)
    head = lines[0]
    units = given.units if given.units_given else (re.search(r"units (\w+)", head) or [None, given.units])[1]
    if units not in LENGTHS:
        raise ConvertError(f"{path}: units {units} have no length in metres; known here: {', '.join(LENGTHS)}")
    length = LENGTHS[units]
    style, rows = sections["Atoms"]
    style = style or given.atom_style
    if style not in ATOM_COLUMNS:
        raise ConvertError(f"{path}: atom style '{style}' has no diameters here; known: {', '.join(ATOM_COLUMNS)}")
    names = ATOM_COLUMNS[style]
    for place, words, _ in rows:
        if len(words) not in (len(names), len(names) + 3):
            raise ConvertError(f"{place}: has {len(words)} columns, atom style {style} has {len(names)} and perhaps 3 image flags")
    column = {name: [words[k] for _, words, _ in rows] for k, name in enumerate(names)}
    value = {
        name: numpy.array([number(text, rows[k][0]) for k, text in enumerate(column[name])])
        for name in ("x", "y", "z", "diameter")
    }
    boundary = re.search(r"boundary (\w) (\w) (\w)", head)
    periodic = [axis == "p" for axis in (given.boundary or (boundary.groups() if boundary else "ppp"))]
    low, high = zip(*(limits[axis] for axis in "xyz"))
    ids = numpy.array([whole(text, rows[k][0]) for k, text in enumerate(column["id"])], numpy.int64)
    document = state(
        box_of(numpy.multiply(low, length), numpy.multiply(high, length), periodic), {
            "id": ids,
            "position": length * numpy.column_stack([value[axis] for axis in "xyz"]),
            "radius": length * value["diameter"] / 2,
            "material": numpy.array([whole(text, rows[k][0]) - 1 for k, text in enumerate(column["type"])], numpy.int32)
        }, float((re.search(r"time (\S+) s", head) or (0, 0.0))[1]))
    if "Bonds" in sections:
        document["bonds"] = bonds_of_section(document, sections["Bonds"][1], ids, path, given)
    yield document


# ---- dumps ---------------------------------------------------------------------------------------------------------------------
def write_frame(stream, document, frame, kind, names, columns):
    low, high = bounds(document["box"])
    flags = " ".join("pp" if axis else "ff" for axis in periodic_axes(document["box"]))
    stream.write(f"ITEM: TIME\n{document.get('time', 0.0)!r}\nITEM: TIMESTEP\n{frame}\nITEM: NUMBER OF {kind}\n{len(columns[0])}\n")
    stream.write(f"ITEM: BOX BOUNDS {flags}\n" + "".join(f"{a!r} {b!r}\n" for a, b in zip(low.tolist(), high.tolist())))
    stream.write(f"ITEM: {kind} {' '.join(names)}\n")
    for row in zip(*(column.tolist() for column in columns)):
        stream.write(" ".join(map(repr, row)) + "\n")


def write_dump(path, documents, given):
    """Particles into the dump, bonds of states that have them into a dump local beside it."""
    if given.units != "si":
        raise ConvertError("a dump is written in SI units; leave --units away")
    documents = list(documents)
    with written(path) as stream:
        for frame, document in enumerate(documents):
            particles = particle_arrays(document)
            other = split_columns(particles, SMALL)
            names = ["id", "type", "x", "y", "z", "radius", *other]
            write_frame(
                stream, document, frame, "ATOMS", names,
                [particles["id"], particles["material"] + 1, *particles["position"].T, particles["radius"], *other.values()])
    if not any("bonds" in document for document in documents):
        return
    if path == "-":
        warn("the bonds are left out; a dump on standard output holds particles only")
        return
    with written(beside(path, ".bonds")) as stream:
        for frame, document in enumerate(documents):
            bonds, ids = bond_arrays(document), particle_arrays(document)["id"]
            if bonds is None:
                continue
            other = split_columns(bonds, LARGE)
            names = ["batom1", "batom2", "ix", "iy", "iz", "radius", "length", "volume", *other]
            write_frame(
                stream, document, frame, "ENTRIES", names,
                [*ids[bonds["pair"]].T, *bonds["image"].T, bonds["radius"], bonds["length"], bonds["volume"], *other.values()])


def frames(path):
    """Each frame of a dump: a dictionary of items (the words behind the item's name, its lines), and the place for messages."""
    with opened(path) as stream:
        items, place, name = {}, None, None
        for row, line in enumerate(stream, start=1):
            if line.startswith("ITEM:"):
                words = line[5:].split()
                key = next((" ".join(words[:n])
                            for n in (3, 2, 1) if " ".join(words[:n]) in ("TIME", "TIMESTEP", "UNITS", "NUMBER OF ATOMS",
                                                                          "NUMBER OF ENTRIES", "BOX BOUNDS", "ATOMS", "ENTRIES")),
                           words[0])
                if key in items:
                    yield items, place
                    items = {}
                if not items:
                    place = f"{path}, line {row}"
                name = key
                items[name] = (words[len(key.split()):], [], row)
            elif name is None:
                raise ConvertError(f"{path}, line {row}: is no dump, expected 'ITEM:'")
            else:
                items[name][1].append(line.split())
        if items:
            yield items, place


def table_of(items, kind, path, place):
    """The columns of a frame by name, and the box; checks what was announced."""
    for wanted in (kind, f"NUMBER OF {kind}", "BOX BOUNDS"):
        if wanted not in items:
            raise ConvertError(f"{place}: the frame has no 'ITEM: {wanted}'")
    names, rows, first = items[kind]
    count = whole(items[f"NUMBER OF {kind}"][1][0][0], place)
    if len(rows) != count:
        raise ConvertError(f"{place}: {count} {kind.lower()} are announced, {len(rows)} are there")
    for row, words in enumerate(rows, start=first + 1):
        if len(words) != len(names):
            raise ConvertError(f"{path}, line {row}: has {len(words)} columns, expected {len(names)}")
    columns = {}
    for k, name in enumerate(names):
        try:
            columns[name] = numpy.array([float(words[k]) for words in rows])
        except ValueError:
            continue  # words, such as the symbols of elements
    return columns


def time_of(items, given, place):
    if "TIME" in items:
        return number(items["TIME"][1][0][0], place) * TIMES[given.units]
    return whole(items["TIMESTEP"][1][0][0], place) * (given.time_step or 0.0) if "TIMESTEP" in items else 0.0


def read_dump(path, given):
    companion = beside(path, ".bonds") if path != "-" else ""
    bonded = frames(companion) if os.path.exists(companion) else iter(())
    length = LENGTHS[given.units]
    for items, place in frames(path):
        columns = table_of(items, "ATOMS", path, place)
        flags, rows, _ = items["BOX BOUNDS"]
        if "xy" in flags or len(rows) != 3 or any(len(row) != 2 for row in rows):
            raise ConvertError(f"{place}: the box is not orthogonal")
        low, high = (length * numpy.array([number(row[end], place) for row in rows]) for end in (0, 1))
        position = positions_of(columns, low, high, length, place)
        size = columns.pop("radius", None)
        size = columns.pop("diameter", numpy.full(len(position), numpy.nan)) / 2 if size is None else size
        radius = length * size if given.radius is None else numpy.full(len(position), given.radius)
        if not (radius > 0).all():
            raise ConvertError(f"{place}: the atoms have no radius and no diameter; give --radius")
        periodic = [flag.startswith("p") for flag in (flags if len(flags) == 3 else given.boundary or "ppp")]
        ids = columns.pop("id", numpy.arange(1, len(position) + 1)).astype(numpy.int64)
        material = columns.pop("type", numpy.ones(len(position))).astype(numpy.int32) - 1
        document = state(box_of(low, high, periodic), {
            "id": ids,
            "position": position,
            "radius": radius,
            "material": material,
            **joined_columns(columns)
        }, time_of(items, given, place))
        if frame := next(bonded, None):
            add_bonds(document, table_of(frame[0], "ENTRIES", companion, frame[1]), ids, companion)
        yield document


def positions_of(columns, low, high, length, place):
    """Places of the atoms, m, from wrapped, unwrapped or scaled columns."""
    for names, scaled in (("x", "y", "z"), False), (("xu", "yu", "zu"), False), (("xs", "ys", "zs"), True), (("xsu", "ysu", "zsu"),
                                                                                                             True):
        if all(name in columns for name in names):
            place_ = numpy.column_stack([columns.pop(name) for name in names])
            return low + place_ * (high - low) if scaled else length * place_
    raise ConvertError(f"{place}: the atoms have no columns x, y, z")


def add_bonds(document, columns, ids, place):
    pair = rows_of(ids, numpy.column_stack([columns.pop("batom1"), columns.pop("batom2")]), place)
    image = numpy.column_stack([columns.pop(name) for name in ("ix", "iy", "iz")]).astype(numpy.int8)
    document["bonds"] = {"pair": pair, "image": image, **joined_columns(columns)}
