"""convert_data.py: LAMMPS data files: atoms of a style with diameters, bonds, both ways.

A data file knows neither periodic axes nor the size of a bond. What dem-convert writes says units, boundary and time in the first
line, which LAMMPS skips; the names of materials stand in remarks of the header, and behind each bond a remark with its radius,
length and volume (m, m3) and its periodic image. LAMMPS itself writes only the units and the step into the first line."""
import re

import numpy

import units
from convert_common import (ConvertError, bond_arrays, bounds, box_of, clipped, lines, number, numbers, particle_arrays,
                            periodic_axes, series, warn, whole, wholes, written)
from convert_check import warn_of_loss
from convert_found import Found, raised, style_of_units
from convert_materials import materials_of

ATOM_COLUMNS = {  # of the styles that know a diameter
    "sphere": ("id", "type", "diameter", "density", "x", "y", "z"),
    "bpm/sphere": ("id", "molecule", "type", "diameter", "density", "x", "y", "z"),
}
ATOM_COLUMNS["granular"] = ATOM_COLUMNS["sphere"]  # as LIGGGHTS calls it
HYBRID = {"sphere": ("diameter", "density"), "granular": ("diameter", "density"), "bpm/sphere": ("molecule", "diameter", "density"),
          "bond": ("molecule", ), "angle": ("molecule", ), "molecular": ("molecule", ), "atomic": ()}
HEADER = {"atoms", "bonds", "angles", "dihedrals", "impropers", "atom types", "bond types", "angle types", "dihedral types",
          "improper types", "extra bond per atom", "extra angle per atom", "extra dihedral per atom", "extra improper per atom",
          "extra special per atom", "bond per atom", "ellipsoids", "lines", "triangles", "bodies"}
KINDS = ("Atom", "Bond", "Angle", "Dihedral", "Improper")
SECTIONS = {"Atoms", "Velocities", "Masses", "Ellipsoids", "Lines", "Triangles", "Bodies", "Bonds", "Angles", "Dihedrals",
            "Impropers",
            "Pair Coeffs", "PairIJ Coeffs", *(f"{kind} Type Labels" for kind in KINDS), *(f"{kind} Coeffs" for kind in KINDS)}
BOND_REMARK = re.compile(r"(radius|length|volume) (\S+)|(image) (\S+) (\S+) (\S+)")


# ---- written -------------------------------------------------------------------------------------------------------------------
def densities(document):
    """The density of each material, kg/m3, which LAMMPS needs."""
    for material in materials_of(document):
        if "density" not in material:
            raise ConvertError(f"material '{clipped(material['name'])}' has no density, which a LAMMPS data file needs; --material "
                               "or --like "
                               "lends it")
        yield material["density"]


def write_header(stream, document, system, particles, bonds, ids):
    low, high = bounds(document["box"])
    by = units.SYSTEMS[system][1]
    boundary = " ".join("p" if axis else "f" for axis in periodic_axes(document["box"]))
    stream.write(f"# by dem-convert: units {system}, boundary {boundary}, time {document.get('time', 0.0)!r} s, "
                 f"ids raised by {raised(particles['id'])}\n\n")
    materials = materials_of(document)
    for row, material in enumerate(materials, start=1):
        stream.write(f"# material {row} is {material['name'] if material['name'].isprintable() else ascii(material['name'])}\n")
    stream.write(f"{len(ids)} atoms\n{len(materials)} atom types\n")
    if bonds is not None:
        most = numpy.bincount(bonds["pair"].ravel(), minlength=1).max(initial=1)
        stream.write(f"{len(bonds['radius'])} bonds\n1 bond types\n{most} extra bond per atom\n")
    stream.write("\n")
    for axis, name in enumerate("xyz"):
        stream.write(f"{units.shown(low[axis], by)} {units.shown(high[axis], by)} {name}lo {name}hi\n")


def write_data_file(stream, document, system):
    particles, bonds = particle_arrays(document), bond_arrays(document)
    length, mass = units.SYSTEMS[system][1], units.power(system, "density")
    ids = particles["id"] + raised(particles["id"])
    density = [units.shown(value, mass) for value in densities(document)]
    if bonds is not None:
        own = int((bonds["pair"][:, 0] == bonds["pair"][:, 1]).sum())
        if own:
            raise ConvertError(f"{own} bonds join a particle with its own periodic image, which LAMMPS does not know")
    write_header(stream, document, system, particles, bonds, ids)
    if len(ids):
        stream.write(f"\nAtoms # {'sphere' if bonds is None else 'bpm/sphere'}\n\n")
    molecule = "" if bonds is None else "1 "
    for each, kind, radius, place in zip(ids, particles["material"], particles["radius"], particles["position"].tolist()):
        x, y, z = (units.shown(value, length) for value in place)
        stream.write(f"{each} {molecule}{kind + 1} {units.shown(2 * radius, length)} {density[kind]} {x} {y} {z}\n")
    if bonds is not None and len(bonds["radius"]):
        stream.write("\nBonds\n\n")
        for row, (i, j) in enumerate(bonds["pair"]):
            size = " ".join(f"{name} {float(bonds[name][row])!r}" for name in ("radius", "length", "volume"))
            image = " ".join(str(int(shift)) for shift in bonds["image"][row])
            stream.write(f"{row + 1} 1 {ids[i]} {ids[j]} # {size} image {image}\n")


def write_data(path, documents, given):
    documents = list(documents)
    for name, document in zip(series(path, len(documents)), documents):
        warn_of_loss("a LAMMPS data file", document, {"time", "density", "bonds"})
        with written(name) as stream:
            write_data_file(stream, document, given.units or "si")


# ---- read ----------------------------------------------------------------------------------------------------------------------
def title_of(head, path, given):
    """What the first line says: style of units, periodic axes, time, step, by how much ids were raised. Words are no keys unless
    LAMMPS or dem-convert wrote them; only units are looked for in any title."""
    ours, theirs = head.startswith("# by dem-convert:"), head.startswith("LAMMPS data file via write_data")
    styles = "|".join((*units.SYSTEMS, *units.WITHOUT_METRES))
    named = re.findall(rf"\bunits\s*=?\s*({styles if not theirs and not ours else '[a-z]+'})\b", head)
    said = named[0] if named else None
    if len(set(named)) > 1:
        raise ConvertError(f"{path}, line 1: names several styles of units")
    style = style_of_units(said, given, path, f"{path}, line 1")
    boundary = re.search(r"boundary ([pf]) ([pf]) ([pf]),", head) if ours else None
    time = re.search(r"time (\S+) s\b", head) if ours else None
    step = re.search(r"timestep = (\d+)", head) if theirs else None
    shift = re.search(r"ids raised by (\d+)$", head.strip()) if ours else None
    if ours and not (boundary and time and said):
        raise ConvertError(f"{path}, line 1: begins as dem-convert writes it and does not end so")
    seconds = number(time[1], f"{path}, line 1") if time else 0.0
    if given.time_step and not time:
        if not step:
            raise ConvertError(f"{path}: does not say its step; --time-step has nothing to count")
        seconds = units.times(given.time_step, int(step[1]))
    elif given.time_step:
        raise ConvertError(f"{path}: says its time; --time-step is for one that says a step")
    periodic = [axis == "p" for axis in boundary.groups()] if boundary else None
    return style, periodic, seconds, int(shift[1]) if shift else 0


class Parts:
    """The header's counts and limits, and the lines of each section as (place, words, remark)."""

    def __init__(self, rows, path):
        self.path, self.counts, self.limits, self.sections, self.remarks = path, {}, {}, {}, []
        current, blank_before = None, False
        for at, (row, line) in enumerate(rows):
            text, _, remark = line.partition("#")
            words, place = text.split(), f"{path}, line {row}"
            if not words:
                if remark and current is None:
                    self.remarks.append((place, remark.strip()))
            elif words[0][0].isalpha():
                blank_after = at + 1 < len(rows) and not rows[at + 1][1].partition("#")[0].strip()
                current = self.begin(" ".join(words), remark.strip(), place, blank_before and blank_after)
            elif current is not None:
                current.append((place, words, remark.strip()))
            else:
                self.take(words, place)
            blank_before = not words

    def begin(self, name, remark, place, alone):
        if name not in SECTIONS and not (alone and "Atoms" in self.sections):
            raise ConvertError(f"{place}: '{clipped(name)}' is no section of a data file; only the first line is a title")
        if name not in SECTIONS:
            warn(f"{place}: the section '{clipped(name)}' is not known and left out")
        if name in self.sections:
            raise ConvertError(f"{place}: the section {name} stands twice")
        self.sections[name] = (remark, [])
        return self.sections[name][1]

    def take(self, words, place):
        """A line of the header."""
        axis = words[2][0] if len(words) == 4 else ""
        name = " ".join(words[1:])
        if len(words) == 4 and axis in "xyz" and words[2:] == [f"{axis}lo", f"{axis}hi"]:
            if axis in self.limits:
                raise ConvertError(f"{place}: {axis}lo {axis}hi stands twice")
            self.limits[axis] = (words[:2], place)
        elif len(words) == 6 and words[3:] == ["xy", "xz", "yz"]:
            if any(number(word, place) for word in words[:3]):
                raise ConvertError(f"{place}: the box is tilted, which a dem-state is not")
        elif name in HEADER:
            if name in self.counts:
                raise ConvertError(f"{place}: the number of {name} stands twice")
            self.counts[name] = whole(words[0], place)
        else:
            raise ConvertError(f"{place}: '{clipped(' '.join(words))}' is no line of a header")

    def rows(self, section, what):
        """The lines of a section, as many as the header announces."""
        found = self.sections.get(section, ("", []))[1]
        count = self.counts.get(what, 0)
        if len(found) != count:
            raise ConvertError(f"{self.path}: {count} {what} are announced, {len(found)} are there")
        return found


def columns_of(style, path):
    """The names of the columns of an atom style; None for one without diameters."""
    if style in ATOM_COLUMNS:
        return ATOM_COLUMNS[style]
    first, *parts = style.split() or [""]
    names = ["id", "type", "x", "y", "z"]
    for part in parts:
        if part not in HYBRID:
            return None
        names += [name for name in HYBRID[part] if name not in names]
    return tuple(names) if first == "hybrid" and "diameter" in names else None


def atoms_of(parts, path, given):
    """The columns of the section Atoms as texts, and the places of its lines."""
    rows = parts.rows("Atoms", "atoms")
    style = given.atom_style or parts.sections.get("Atoms", ("", []))[0] or "sphere"
    names = columns_of(style, path)
    if names is None:
        raise ConvertError(f"{path}: atom style '{clipped(style)}' does not say where its diameters are; --atom-style does, as "
                           f"{', '.join(ATOM_COLUMNS)} or, for example, hybrid sphere bond")
    if any(len(words) not in (len(names), len(names) + 3) or len(words) != len(rows[0][1]) for _, words, _ in rows):
        place, words, _ = next(each for each in rows if len(each[1]) not in (len(names), len(names) + 3)
                               or len(each[1]) != len(rows[0][1]))
        raise ConvertError(f"{place}: has {len(words)} columns, atom style {style} has {len(names)} and perhaps 3 image flags, in "
                           "all lines")
    for place, words, _ in rows:
        for flag in words[len(names):]:
            whole(flag, place)
    return {name: [words[k] for _, words, _ in rows] for k, name in enumerate(names)}, [place for place, _, _ in rows]


def type_labels(parts, path):
    """Names of types: of the section that LAMMPS has for them, or of dem-convert's remarks."""
    names = {}
    for place, words, _ in parts.sections.get("Atom Type Labels", ("", []))[1]:
        if len(words) != 2 or whole(words[0], place) in names:
            raise ConvertError(f"{place}: is not a number of a type and its label, once each")
        names[whole(words[0], place)] = words[1]
    for place, remark in parts.remarks:
        if found := re.fullmatch(r"material (\d+) is (.+)", remark):
            names[int(found[1])] = found[2]
    return names


def types_of(texts, places, names, count):
    """Numbers of types from numbers or labels."""
    labels = {name: number for number, name in names.items()}
    kinds = []
    for text, place in zip(texts, places):
        kind = labels[text] if text in labels else whole(text, place)
        if not 1 <= kind <= count:
            raise ConvertError(f"{place}: has type {kind}; the header announces {count} atom types")
        kinds.append(kind)
    return kinds


def bonds_of(parts, path, shift):
    """The bonds with what the remarks behind them say; NaN where they say nothing."""
    rows = parts.rows("Bonds", "bonds")
    bonds = {name: numpy.full(len(rows), numpy.nan) for name in ("radius", "length", "volume")}
    bonds.update(file=path, ids=numpy.zeros((len(rows), 2), numpy.int64), image=numpy.zeros((len(rows), 3), numpy.int64),
                 told=numpy.zeros(len(rows), bool))
    for row, (place, words, remark) in enumerate(rows):
        if len(words) != 4:
            raise ConvertError(f"{place}: has {len(words)} columns, a bond has 4: its number, its type and two atoms")
        whole(words[0], place), whole(words[1], place)
        bonds["ids"][row] = [whole(word, place) - shift for word in words[2:]]
        if not re.match(r"(radius|length|volume|image)\b", remark):
            continue
        if BOND_REMARK.sub("", remark).strip():
            raise ConvertError(f"{place}: the remark '{clipped(remark)}' is not radius, length, volume and image of a bond")
        for name, text, image, *shifts in BOND_REMARK.findall(remark):
            if image:
                bonds["image"][row], bonds["told"][row] = [whole(each, place) for each in shifts], True
            else:
                bonds[name][row] = number(text, place)
    return bonds


def read_data(path, given):
    rows = list(lines(path))
    if not rows or not any(line.strip() for _, line in rows):
        raise ConvertError(f"{path}: is empty")
    system, periodic, time, shift = title_of(rows[0][1], path, given)
    parts = Parts(rows[1:], path)
    for axis in "xyz":
        if axis not in parts.limits:
            raise ConvertError(f"{path}: has no line '{axis}lo {axis}hi'")
    if "atoms" not in parts.counts:
        raise ConvertError(f"{path}: does not announce the number of atoms")
    if "Atoms" not in parts.sections and parts.counts["atoms"]:
        raise ConvertError(f"{path}: has no section Atoms")
    column, places = atoms_of(parts, path, given)
    length = units.SYSTEMS[system][1]
    low, high = zip(*([number(text, place, length) for text in texts] for texts, place in (parts.limits[axis] for axis in "xyz")))
    value = {name: numbers(column[name], places, units.power(system, name))
             for name in ("x", "y", "z", "diameter", "density")}
    small = numpy.flatnonzero(~(value["diameter"] > 0))
    if len(small):
        raise ConvertError(f"{places[small[0]]}: the diameter is {column['diameter'][small[0]]}, expected a positive one")
    ids = wholes(column["id"], places) - shift
    seen = {}
    for each, place in zip(ids.tolist(), places):
        if each in seen:
            raise ConvertError(f"{place}: id {each + shift} stands twice, first in {seen[each].rpartition(', ')[2]}")
        seen[each] = place
    names = type_labels(parts, path)
    kinds = types_of(column["type"], places, names, parts.counts.get("atom types", 0))
    found = Found(path, path,
                  {"id": ids, "position": numpy.column_stack([value[axis] for axis in "xyz"]), "radius": value["diameter"] / 2},
                  box=box_of(low, high, periodic), time=time, labels=kinds, types=parts.counts.get("atom types", 0),
                  type_names=names,
                  counts_from_one=not shift)
    of_types = {kind: numpy.unique(value["density"][numpy.equal(kinds, kind)]) for kind in set(kinds)}
    if any(len(each) > 1 for each in of_types.values()):
        warn(f"{path}: atoms of one type differ in density; it is kept for each particle")
        found.particles["density"] = value["density"]
    found.constants = {kind: {"density": float(each[0])} for kind, each in of_types.items() if len(each) == 1}
    if "bonds" in parts.counts or "Bonds" in parts.sections:
        found.bonds = bonds_of(parts, path, shift)
    yield found
