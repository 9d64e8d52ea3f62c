"""convert_dump.py: LAMMPS text dumps, of particles and, as dump local in a file beside it, of bonds."""
import re

import numpy

import units
from convert_common import (ConvertError, LARGE, SMALL, beside, bond_arrays, bounds, box_of, clipped, companion_of, joined_columns,
                            lines, number, numbers, particle_arrays, periodic_axes, split_columns, warn, whole, wholes,
                            without_companion, words_for, written)
from convert_check import warn_of_loss
from convert_found import Found, radius_from, style_of_units
from convert_materials import materials_of

ONE_LINE = ("UNITS", "TIME", "TIMESTEP")
SKIPPED = ("", "-", "_")  # names by which --bond-columns leaves a column out
WHOLE = ("id", "type", "mol", "ix", "iy", "iz", "batom1", "batom2", "btype", "index")  # columns of whole numbers
PLACES = (("", False), ("u", False), ("s", True), ("su", True))  # x, xu, xs, xsu: as it is, unwrapped, scaled, both


# ---- written -------------------------------------------------------------------------------------------------------------------
def write_frame(stream, document, step, kind, columns, system):
    low, high = bounds(document["box"])
    _, length, time = units.SYSTEMS[system]
    flags = " ".join("pp" if axis else "ff" for axis in periodic_axes(document["box"]))
    stream.write(f"ITEM: UNITS\n{system}\nITEM: TIME\n{units.shown(document.get('time', 0.0), time)}\nITEM: TIMESTEP\n{step}\n"
                 f"ITEM: NUMBER OF {kind}\n{len(next(iter(columns.values())))}\nITEM: BOX BOUNDS {flags}\n")
    stream.write("".join(f"{units.shown(a, length)} {units.shown(b, length)}\n" for a, b in zip(low.tolist(), high.tolist())))
    texts = []
    for name, column in columns.items():
        by = 0 if system == "si" else units.power(system, name)
        values = column if isinstance(column, list) else column.tolist()
        texts.append(values if values and isinstance(values[0], str) else
                     [units.shown(each, by or 0) if isinstance(each, float) else str(each) for each in values])
        if by is None and values and isinstance(values[0], float):
            warn(f"the unit of {clipped(name)} is not known; its numbers are written as they are")
    stream.write(f"ITEM: {kind} {' '.join(words_for(columns, 'array'))}\n")
    for row in zip(*texts):
        stream.write(" ".join(row) + "\n")


def particle_columns(document):
    particles = particle_arrays(document)
    names = words_for([material["name"] for material in materials_of(document)], "material")
    x, y, z = particles["position"].T
    columns = {"id": particles["id"], "type": particles["material"] + 1, "element": [names[kind] for kind in particles["material"]],
               "x": x, "y": y, "z": z, "radius": particles["radius"]}
    return with_others(columns, split_columns(particles, SMALL))


def bond_columns(document):
    bonds, ids = bond_arrays(document), particle_arrays(document)["id"]
    first, second = ids[bonds["pair"]].T
    ix, iy, iz = bonds["image"].T
    columns = {"batom1": first, "batom2": second, "ix": ix, "iy": iy, "iz": iz, **{name: bonds[name] for name in LARGE[2:]}}
    return with_others(columns, split_columns(bonds, LARGE))


def with_others(columns, other):
    if clash := {*columns, "diameter", *(f"{axis}{end}" for axis in "xyz" for end, _ in PLACES)} & set(other):
        raise ConvertError(f"an array has the name {clash.pop()}, which means something else in a dump; rename it")
    return {**columns, **other}


def write_dump(path, documents, given):
    """Particles into the dump, bonds of states that have them into a dump local beside it."""
    documents, system = list(documents), given.units or "si"
    with written(path) as stream:
        for step, document in enumerate(documents):
            warn_of_loss("a dump on standard output" if path == "-" else "a dump", document,
                         {"time", "particles.other", *(() if path == "-" else ("bonds", "bonds.other"))})
            write_frame(stream, document, step, "ATOMS", particle_columns(document), system)
    if path == "-" or not any("bonds" in document for document in documents):
        without_companion(path, ".bonds")
        return
    with written(beside(path, ".bonds")) as stream:
        for step, document in enumerate(documents):
            if "bonds" in document:
                write_frame(stream, document, step, "ENTRIES", bond_columns(document), system)


# ---- read ----------------------------------------------------------------------------------------------------------------------
class Frame:
    """One frame: the words behind each item's name and its lines as (row, words)."""

    def __init__(self, path):
        self.path, self.items, self.place = path, {}, None

    def begin(self, row, text):
        """The lines of the item that begins here."""
        key, words = self.key_of(text)
        if key is None or key in self.items:
            raise ConvertError(f"{self.path}, line {row}: 'ITEM: {clipped(text)}' "
                               f"{'is not known here' if key is None else 'stands twice'}")
        self.place = self.place or f"{self.path}, line {row}"
        self.items[key] = (words, [], row)
        return self.items[key][1]

    def key_of(self, text):
        """COUNT of NUMBER OF ATOMS, TABLE of ATOMS once that was announced, else the item's name; and the words behind it."""
        words = text.split()
        if words[:2] == ["NUMBER", "OF"] and len(words) == 3:
            return "COUNT", words[2:]
        if words[:2] == ["BOX", "BOUNDS"]:
            return "BOX BOUNDS", words[2:]
        if text in ONE_LINE:
            return text, []
        if words and "COUNT" in self.items and words[0] == self.items["COUNT"][0][0]:
            return "TABLE", words[1:]
        return None, []

    def line(self, name):
        """The single line of an item, as text."""
        _, rows, row = self.items[name]
        if len(rows) != 1 or len(rows[0][1]) != 1:
            raise ConvertError(f"{self.path}, line {row}: one line with one word belongs below, {len(rows)} lines are there")
        return rows[0][1][0], f"{self.path}, line {rows[0][0]}"

    def step(self):
        if "TIMESTEP" not in self.items:
            raise ConvertError(f"{self.place}: the frame has no 'ITEM: TIMESTEP'")
        return whole(*self.line("TIMESTEP"))


def frames(path):
    """The frames of a dump. One begins at its step, or at the units or the time above it."""
    frame, rows = Frame(path), None
    for row, line in lines(path):
        if line.startswith("ITEM:"):
            text = line[5:].strip()
            if "TABLE" in frame.items:
                yield frame
                frame = Frame(path)
            rows = frame.begin(row, text)
        elif line.strip():
            if rows is None:
                raise ConvertError(f"{path}, line {row}: is no dump, expected 'ITEM:'")
            rows.append((row, line.split()))
    if not frame.items:
        raise ConvertError(f"{path}: is empty")
    yield frame


def columns_of(frame, kinds, names=None):
    """The columns of a frame by name as lists of texts, and the places of their lines; checks what was announced."""
    for item in ("COUNT", "BOX BOUNDS", "TABLE"):
        if item not in frame.items:
            shown = {"COUNT": f"NUMBER OF {kinds[0]}", "TABLE": kinds[0]}.get(item, item)
            raise ConvertError(f"{frame.place}: the frame has no 'ITEM: {shown}'")
    kind = frame.items["COUNT"][0][0]
    if (kinds[0] == "ATOMS") != (kind == "ATOMS"):
        raise ConvertError(f"{frame.place}: is a dump of {kind.lower()}, expected {kinds[0].lower()}")
    headings, rows, _ = frame.items["TABLE"]
    count = whole(*frame.line("COUNT"))
    if len(rows) != count:
        raise ConvertError(f"{frame.place}: {count} {kind.lower()} are announced, {len(rows)} are there")
    if names:
        if len(names) != len(headings):
            raise ConvertError(f"{frame.place}: has {len(headings)} columns, {', '.join(map(clipped, headings))}; --bond-columns "
                               "names "
                               f"{len(names)}")
        headings = names
    for k, name in enumerate(headings):
        if name in headings[:k] and name not in SKIPPED:
            raise ConvertError(f"{frame.place}: the column '{clipped(name)}' stands twice")
    for row, words in rows:
        if len(words) != len(headings):
            raise ConvertError(f"{frame.path}, line {row}: has {len(words)} columns, expected {len(headings)}")
    return ({name: [words[k] for _, words in rows] for k, name in enumerate(headings) if name not in SKIPPED},
            [f"{frame.path}, line {row}" for row, _ in rows])


def values_of(name, texts, places, system):
    """The numbers of a column in SI units; None for a column of words."""
    if name in WHOLE:
        return wholes(texts, places)
    if texts and name not in units.DIMENSION and not any(re.match(r"[-+]?\.?[0-9]", text) for text in texts):
        return None
    power = units.power(system, name)
    if power is None and system != "si" and places:
        warn(f"{places[0].rpartition(', line')[0]}: the unit of the column {clipped(name)} is not known; its numbers are left as "
             "they are")
    values = numbers(texts, places, power or 0)
    integer = bool(texts) and power in (None, 0) and name not in units.DIMENSION and all(re.fullmatch(r"[-+]?[0-9]{1,18}", text)
                                                                                         for text in texts)
    return numpy.array([int(text) for text in texts], numpy.int64) if integer else values


def box_from(frame, length):
    """The box, m, with the periodic axes where the frame says them."""
    flags, rows, row = frame.items["BOX BOUNDS"]
    place = f"{frame.path}, line {row}"
    if len(rows) != 3 or "abc" in flags:
        raise ConvertError(f"{place}: the box is not orthogonal, or has {len(rows)} lines of 3")
    tilted = flags[:3] == ["xy", "xz", "yz"]
    flags = flags[3:] if tilted else flags
    for at, words in rows:
        if len(words) != 3 if tilted else len(words) != 2:
            raise ConvertError(f"{frame.path}, line {at}: has {len(words)} numbers, expected {3 if tilted else 2}")
        if tilted and number(words[2], f"{frame.path}, line {at}"):
            raise ConvertError(f"{frame.path}, line {at}: the box is tilted, which a dem-state is not")
    if flags and (len(flags) != 3 or not all(re.fullmatch(r"pp|[fsm]{2}", flag) for flag in flags)):
        raise ConvertError(f"{place}: '{clipped(' '.join(flags))}' is not three of pp, ff, ss, mm, fs, fm")
    low, high = ([number(words[end], f"{frame.path}, line {at}", length) for at, words in rows] for end in (0, 1))
    return box_of(low, high, [flag == "pp" for flag in flags] if flags else None)


def positions_of(columns, places, box, system, place):
    """Places of the atoms, m, from wrapped, unwrapped or scaled columns, and takes them out of the columns."""
    low, high = bounds(box)
    found = []
    for k, axis in enumerate("xyz"):
        name, scaled = next(((axis + end, scaled) for end, scaled in PLACES if axis + end in columns), (None, False))
        if name is None:
            raise ConvertError(f"{place}: the atoms have no columns x, y, z, only {', '.join(map(clipped, columns))}")
        values = values_of(name, columns[name], places, system)
        if values is None:
            raise ConvertError(f"{place}: the column {name} holds no numbers")
        found.append(low[k] + values * (high[k] - low[k]) if scaled else values)
    for name in [axis + end for axis in "xyz" for end, _ in PLACES]:
        columns.pop(name, None)
    return numpy.column_stack(found)


def labels_of(columns, places):
    """What the particles are of: names of elements, unless these tell fewer apart than the types do."""
    kinds, names = columns.pop("type", None), columns.pop("element", None)
    types = wholes(kinds, places).tolist() if kinds is not None else None
    if names is not None and (types is None or len(set(zip(types, names))) == len(set(names))):
        return names
    return types


class Bonded:
    """The bonds in the file beside a dump, by step."""

    def __init__(self, path, given):
        self.path, self.given, self.frames, self.used = companion_of(path, ".bonds"), given, {}, set()
        system = None
        for frame in frames(self.path) if self.path else ():
            system = system_of(frame, system, given, self.path)
            if frame.step() in self.frames:
                raise ConvertError(f"{frame.place}: the step {frame.step()} stands twice")
            self.frames[frame.step()] = frame, system
        if given.bond_columns and not self.path:
            raise ConvertError(f"{path}: has no dump of bonds beside it; --bond-columns is for its columns")

    def of(self, step):
        """The bonds of a step; None if there are none."""
        if step not in self.frames:
            return None
        self.used.add(step)
        frame, system = self.frames[step]
        columns, places = columns_of(frame, ("ENTRIES", "BONDS"), self.given.bond_columns)
        if "batom1" not in columns or "batom2" not in columns:
            raise ConvertError(f"{frame.place}: which columns are the atoms of a bond is not known: "
                               f"{', '.join(map(clipped, columns))}; "
                               "--bond-columns names them in their order, such as _,_,batom1,batom2,_")
        values = {name: values_of(name, texts, places, system) for name, texts in columns.items()}
        bonds = {"file": frame.place, "ids": numpy.column_stack([values.pop("batom1"), values.pop("batom2")]).reshape(-1, 2)}
        images = [values.pop(name, None) for name in ("ix", "iy", "iz")]
        if any(each is not None for each in images):
            if any(each is None for each in images):
                raise ConvertError(f"{frame.place}: has not all of the columns ix, iy, iz")
            bonds["image"], bonds["told"] = numpy.column_stack(images).reshape(-1, 3), numpy.ones(len(places), bool)
        other = {name: each for name, each in values.items() if each is not None}
        if left := [clipped(name) for name, each in values.items() if each is None]:
            warn(f"{self.path}: the columns {', '.join(left)} hold words and are left out")
        other["radius"] = radius_from(other, len(places), frame.place)
        return {**bonds, **joined_columns(other)}

    def end(self, path):
        left = [step for step in self.frames if step not in self.used]
        if left:
            raise ConvertError(f"{self.path}: has bonds of step {left[0]}, which {path} has not")


def system_of(frame, before, given, path):
    """The style of units of a frame: what it or an earlier frame says, else --units."""
    said, place = frame.line("UNITS") if "UNITS" in frame.items else (before, path)
    return style_of_units(said, given, path, place)


def time_of(frame, system, given, path):
    if "TIME" in frame.items:
        if given.time_step:
            raise ConvertError(f"{path}: says its times; --time-step is for one that says only steps")
        return number(*frame.line("TIME"), units.SYSTEMS[system][2])
    if frame.step() and not given.time_step:
        warn(f"{path}: says steps and no times; all are taken to be at 0 s, --time-step says how long a step is")
    return units.times(given.time_step or 0.0, frame.step())


def read_dump(path, given):
    bonded, system, order, steps = Bonded(path, given), None, [], set()
    for frame in frames(path):
        system = system_of(frame, system, given, path)
        columns, places = columns_of(frame, ("ATOMS", ))
        box = box_from(frame, units.SYSTEMS[system][1])
        if frame.step() in steps:
            raise ConvertError(f"{frame.place}: the step {frame.step()} stands twice")
        steps.add(frame.step())
        position = positions_of(columns, places, box, system, frame.place)
        labels = labels_of(columns, places)
        values = {name: values_of(name, texts, places, system) for name, texts in columns.items()}
        particles = {"position": position, "radius": radius_from(values, len(places), frame.place),
                     "id": values.pop("id", numpy.arange(1, len(places) + 1, dtype=numpy.int64))}
        if left := [clipped(name) for name, each in values.items() if each is None]:
            warn(f"{path}: the columns {', '.join(left)} hold words and are left out")
        particles.update(joined_columns({name: each for name, each in values.items() if each is not None}))
        yield Found(frame.place, path, particles, box=box, time=time_of(frame, system, given, path), labels=labels, order=order,
                    bonds=bonded.of(frame.step()))
    bonded.end(path)
