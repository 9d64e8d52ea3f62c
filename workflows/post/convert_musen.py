"""convert_musen.py: reads the text export of MUSEN, the program of the paper.

Each line is a row of commands, a number and its values, in SI units. The numbers and their values are those of MUSEN's exporter
(enumeration ETXTCommands, classes CSphere and CBond, enumeration ETPPropertyTypes of its published source, 2020): an object has ID
(0), type (1; 1 sphere, 9 solid bond), geometry (5; a sphere's radius and contact radius, a bond's two IDs, diameter and initial
length), material (23), time of activity (24), and then for each time (2) its coordinates (12) and other values. The scene has a
domain (22), periodic boundaries (28) and materials (32; key, name, and pairs of a property's number and value)."""
import re

import numpy

from convert_common import NUMBER, ConvertError, box_of, clipped, lines, number, warn, whole
from convert_found import Found

SPHERE, BOND = 1, 9
LEFT_OUT = {13: "liquid bonds", 14: "triangles of walls"}  # objects that a dem-state has no place for
ID, TYPE, TIME, GEOMETRY, COORDINATES, FORCE, MATERIAL, ACTIVITY = 0, 1, 2, 5, 12, 20, 23, 24  # commands of objects
DOMAIN, PERIODIC, COMPOUND = 22, 28, 32  # and of the scene
TEMPERATURE = 37
VALUES = {ID: 1, TYPE: 1, TIME: 1, 10: 3, 11: 3, COORDINATES: 3, 15: 3, 16: 3, 17: 3, 18: 1, FORCE: 3, MATERIAL: 1, ACTIVITY: 2,
          31: 4, 36: 9, TEMPERATURE: 1}  # how many each command has
GEOMETRY_VALUES = {SPHERE: 2, BOND: 4}
VECTORS = {15: "velocity", 16: "angular_velocity", FORCE: "force"}
SCENE = set(range(22, 53))  # commands that begin a line of the scene, its geometries, materials and generators
CONSTANTS = {0: ("density", 0.0, 1e6), 7: ("young_modulus", 0.0, 1e15), 10: ("poisson_ratio", -1.0, 0.5),
             11: ("surface_energy", 0.0, 1e6)}  # by number of a property: key of dem-state, and the range of what can be meant


def object_of(words, place):
    """The constant values of an object by command, and the time-dependent ones by time."""
    constant, times, current, at = {}, {}, None, 0
    while at < len(words):
        command = whole(words[at], place)
        count = GEOMETRY_VALUES.get(int(constant.get(TYPE, ["0"])[0])) if command == GEOMETRY else VALUES.get(command)
        if count is None:
            raise ConvertError(f"{place}: the command {command} is not known")
        values = words[at + 1:at + 1 + count]
        if len(values) < count:
            raise ConvertError(f"{place}: the command {command} requires {count} values, {len(values)} are there")
        target = constant if current is None else current
        if command == TIME:
            time = number(values[0], place)
            if time in times:
                raise ConvertError(f"{place}: the time {values[0]} stands twice")
            current = times[time] = {}
        elif command in target:
            raise ConvertError(f"{place}: the command {command} stands twice")
        else:
            target[command] = values
        at += 1 + count
    for command in (TYPE, GEOMETRY):
        if command not in constant:
            raise ConvertError(f"{place}: the object has no {({TYPE: 'type', GEOMETRY: 'geometry'})[command]}")
    return constant, times


def compound_of(words, place):
    """Key, name and constants of a material. Blanks in the name are its own: the properties are the pairs at the end."""
    for first in range(3, len(words) + 1):
        pairs = words[first:]
        if len(pairs) % 2 == 0 and all(re.fullmatch(r"[0-9]{1,2}", each) for each in pairs[0::2]) and \
                all(NUMBER.fullmatch(each) for each in pairs[1::2]) and len(set(pairs[0::2])) == len(pairs) // 2:
            break
    else:
        raise ConvertError(f"{place}: a material has a key, a name and pairs of a property's number and value")
    if any(NUMBER.fullmatch(each) or each in ("nan", "inf", "-nan", "-inf") for each in words[3:first]):
        raise ConvertError(f"{place}: the numbers behind the material {clipped(words[1])} are not pairs of a property and its "
                           "value")
    constants = {}
    for kind, text in zip(pairs[0::2], pairs[1::2]):
        if int(kind) in CONSTANTS:
            key, low, high = CONSTANTS[int(kind)]
            constants[key] = number(text, place)
            if not low <= constants[key] <= high:
                raise ConvertError(f"{place}: {key} is {text}, expected {low:g} to {high:g}")
    return words[1], " ".join(words[2:first]), constants


class Scene:
    """Spheres and bonds as (place, constant, times), materials by key, and the box if the export has one."""

    def __init__(self, path):
        self.path, self.spheres, self.bonds, self.compounds, self.domain, self.periodic = path, [], [], {}, None, None
        for row, line in lines(path):
            words, place = line.split(), f"{path}, line {row}"
            if words:
                self.take(whole(words[0], place), words, place)
        if not self.spheres:
            raise ConvertError(f"{path}: has no spheres")

    def take(self, command, words, place):
        if command == ID:
            kind = whole(words[3], place) if len(words) > 3 and words[2] == str(TYPE) else None
            if kind in LEFT_OUT:
                warn(f"{self.path}: its {LEFT_OUT[kind]} are left out")
            elif kind in GEOMETRY_VALUES:
                (self.spheres if kind == SPHERE else self.bonds).append((place, *object_of(words, place)))
            else:
                raise ConvertError(f"{place}: is no object with an ID and a type that is known")
        elif command == DOMAIN:
            self.domain = self.numbers(words[1:], 6, self.domain, place)
        elif command == PERIODIC:
            values = self.numbers(words[1:], 10, self.periodic, place)
            if any(value not in (0, 1) for value in values[:4]):
                raise ConvertError(f"{place}: the first four values of the command {PERIODIC} are 0 or 1")
            self.periodic = values
        elif command == COMPOUND:
            key, name, constants = compound_of(words, place)
            if key in self.compounds:
                raise ConvertError(f"{place}: the material {clipped(key)} stands twice")
            self.compounds[key] = (name, constants)
        elif command not in SCENE:
            raise ConvertError(f"{place}: the command {command} is not known")

    @staticmethod
    def numbers(words, count, before, place):
        if before is not None or len(words) != count:
            raise ConvertError(f"{place}: the command stands once, with {count} values, {len(words)} are there")
        return [number(word, place) for word in words]

    def box(self):
        """The periodic box, else the domain as a free box; None without both. Across a free axis the domain says no more than the
        particles do."""
        if self.periodic and self.periodic[0]:
            return box_of(self.periodic[4:7], self.periodic[7:], self.periodic[1:4])
        return box_of(self.domain[:3], self.domain[3:], (False, ) * 3) if self.domain else None


def is_there(constant, time, place):
    start, end = (number(value, place) if value != "inf" else numpy.inf for value in constant.get(ACTIVITY, ("0", "inf")))
    return start <= time <= end


def particles_of(present):
    """Arrays of the spheres that are there at a time."""
    places = [place for place, _, _ in present]

    def column(command, values):
        return numpy.array([[number(word, place) for word in each[command]] for place, each in zip(places, values)])

    constants, current = [constant for _, constant, _ in present], [values for _, _, values in present]
    radius = column(GEOMETRY, constants)[:, 0]
    particles = {"id": numpy.array([whole(constant[ID][0], place) for place, constant, _ in present], numpy.int64),
                 "position": column(COORDINATES, current), "radius": radius}
    for command, name in VECTORS.items():
        if all(command in values for values in current):
            particles[name] = column(command, current)
    return particles


def bonds_of(scene, time):
    present = [(place, constant) for place, constant, _ in scene.bonds if is_there(constant, time, place)]
    if not present:
        return None
    ids = [[whole(word, place) for word in constant[GEOMETRY][:2]] for place, constant in present]
    for place, constant in present:
        number(constant[GEOMETRY][3], place)  # its first length, which is not needed
    return {"file": scene.path, "ids": numpy.array(ids, numpy.int64),
            "radius": numpy.array([number(constant[GEOMETRY][2], place) / 2 for place, constant in present])}


def read_musen(path, given):
    scene = Scene(path)
    times = sorted({time for _, _, times in scene.spheres for time in times})
    if not times:
        raise ConvertError(f"{path}: its spheres have no times")
    for time in times:
        present = [(place, constant, times[time]) for place, constant, times in scene.spheres
                   if time in times and is_there(constant, time, place)]
        for place, _, values in present:
            if COORDINATES not in values:
                raise ConvertError(f"{place}: the sphere has no coordinates at time {time}")
        if not present:
            raise ConvertError(f"{path}: no sphere is there at time {time}")
        keys = [constant.get(MATERIAL, ["Undefined"])[0] for _, constant, _ in present]
        every = dict.fromkeys(constant.get(MATERIAL, ["Undefined"])[0] for _, constant, _ in scene.spheres)
        shown = {key: scene.compounds.get(key, (key, {})) for key in every}
        yield Found(f"{path}, time {time}", path, particles_of(present), box=scene.box(), time=time,
                    labels=[shown[key][0] for key in keys],
                    constants=dict(shown.values()), bonds=bonds_of(scene, time), order=[name for name, _ in shown.values()])


def is_musen(path):
    """True if the first line that is not blank looks like a line of such an export: a known command and its number of values."""
    for _, line in lines(path, latin=True):
        words = line.split()
        if words:
            return bool(re.fullmatch(r"0 \d+ 1 \d+( .*)?", " ".join(words)) or
                        re.fullmatch(r"(22( \S+){6}|28 [01] [01] [01] [01]( \S+){6}|29 [01]|30 [01]|32 \S+ \S+( \d+ \S+)*)",
                                     " ".join(words)))
    return False
