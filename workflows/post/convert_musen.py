"""convert_musen.py: reads the text export of MUSEN, the program of the paper.

Each line is a row of commands, a number and its values, in SI units. The numbers and their values are those of MUSEN's exporter
(enumeration ETXTCommands, classes CSphere and CBond of its published source, 2020): an object has ID (0), type (1; 1 sphere, 9
solid bond), geometry (5; a sphere's radius and contact radius, a bond's two IDs, diameter and initial length), material (23),
time of activity (24), and then for each time (2) its coordinates (12) and other values. The scene has a domain (22) and
periodic boundaries (28)."""
import numpy

from convert_common import ConvertError, box_of, free_box, nearest_image, neck_length, number, opened, rows_of, state, whole

SPHERE, BOND = 1, 9
ID, TYPE, TIME, GEOMETRY, COORDINATES, FORCE, DOMAIN, MATERIAL, ACTIVITY, PERIODIC = 0, 1, 2, 5, 12, 20, 22, 23, 24, 28
TEMPERATURE = 37
VALUES = {
    ID: 1,
    TYPE: 1,
    TIME: 1,
    10: 3,
    11: 3,
    COORDINATES: 3,
    15: 3,
    16: 3,
    17: 3,
    18: 1,
    FORCE: 3,
    MATERIAL: 1,
    ACTIVITY: 2,
    31: 4,
    36: 9,
    TEMPERATURE: 1
}
GEOMETRY_VALUES = {SPHERE: 2, BOND: 4, 13: 4, 14: 9}  # also liquid bonds and triangles of walls, which are left out
VECTORS = {15: "velocity", 16: "angular_velocity", FORCE: "force"}


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
        if command == TIME:
            current = times.setdefault(number(values[0], place), {})
        else:
            (constant if current is None else current)[command] = values
        at += 1 + count
    for command in (ID, TYPE, GEOMETRY):
        if command not in constant:
            raise ConvertError(f"{place}: the object has no {({ID: 'ID', TYPE: 'type', GEOMETRY: 'geometry'})[command]}")
    return constant, times


def scan(path):
    """Spheres and bonds as (place, constant, times), and the box if the export has one."""
    spheres, bonds, domain, periodic = [], [], None, None
    with opened(path) as stream:
        for row, line in enumerate(stream, start=1):
            words, place = line.split(), f"{path}, line {row}"
            if not words:
                continue
            command = whole(words[0], place)
            if command == ID:
                constant, times = object_of(words, place)
                {SPHERE: spheres, BOND: bonds}.get(whole(constant[TYPE][0], place), []).append((place, constant, times))
            elif command == DOMAIN:
                domain = [number(word, place) for word in words[1:7]]
            elif command == PERIODIC and whole(words[1], place):
                periodic = [word == "1" for word in words[2:5]], [number(word, place) for word in words[5:11]]
    if not spheres:
        raise ConvertError(f"{path}: has no spheres")
    return spheres, bonds, domain, periodic


def is_there(constant, time):
    start, end = (float(value) for value in constant.get(ACTIVITY, ("0", "inf")))
    return start <= time <= end


def read_musen(path, given):
    spheres, bonds, domain, periodic = scan(path)
    names = list(dict.fromkeys(constant.get(MATERIAL, ["Undefined"])[0] for _, constant, _ in spheres))
    for time in sorted({time for _, _, times in spheres for time in times}):
        present = [(place, constant, times[time]) for place, constant, times in spheres
                   if time in times and is_there(constant, time)]
        for place, _, values in present:
            if COORDINATES not in values:
                raise ConvertError(f"{place}: the sphere has no coordinates at time {time}")
        position = numpy.array([[number(word, place) for word in values[COORDINATES]] for place, _, values in present])
        radius = numpy.array([number(constant[GEOMETRY][0], place) for place, constant, _ in present])
        particles = {
            "id": numpy.array([whole(constant[ID][0], place) for place, constant, _ in present], numpy.int64),
            "position": position,
            "radius": radius,
            "material": numpy.array([names.index(constant.get(MATERIAL, ["Undefined"])[0]) for _, constant, _ in present],
                                    numpy.int32)
        }
        for command, name in VECTORS.items():
            if all(command in values for _, _, values in present):
                particles[name] = numpy.array([[number(word, place) for word in values[command]] for place, _, values in present])
        if periodic:  # across a free axis the domain says no more than the particles do
            box = box_of(periodic[1][:3], periodic[1][3:], periodic[0])
        elif domain:
            box = box_of(domain[:3], domain[3:], (False, ) * 3)
        else:
            box = free_box(position, radius)
        document = state(box, particles, time)
        if not given.like:
            document["materials"] = [{"name": name} for name in names]
        present = [(place, constant) for place, constant, _ in bonds if is_there(constant, time)]
        if present:
            pair = rows_of(particles["id"],
                           [[whole(word, place) for word in constant[GEOMETRY][:2]] for place, constant in present], path)
            image = nearest_image(document, pair)
            size = numpy.array([number(constant[GEOMETRY][2], place) / 2 for place, constant in present])
            document["bonds"] = {"pair": pair, "image": image, "radius": size, "length": neck_length(document, pair, image, size)}
        yield document
