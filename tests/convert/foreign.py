"""foreign.py: small packings as other programs write them, each with a random choice of what a format allows and, in most cases,
one fault of which is known what it has to lead to: other values, or a refusal. Nothing here knows dem-convert's code: the numbers
are decimal texts, and what they have to become in SI units is reckoned from these texts.

A case has the files, the options, the states that are right (None: it has to be refused), and whether it has to be taken."""
import base64
import copy
import dataclasses
import decimal
import math
import re
import struct
import zlib

NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")
STRANGE = ["nan", "inf", "-inf", "1e999", "0x10", "1_0", "1d-3", "\uff11", "wide", "--1", "1.2.3", "1e", "+", ".", "1,5", "0",
           "-0.0", "1e-3",
           "+0.25", "2.", ".5", "1E0", "99999999999999999999"]
LENGTH = {"si": 0, "cgs": -2, "micro": -6, "nano": -9}  # powers of ten of m
TIME = {"si": 0, "cgs": 0, "micro": -6, "nano": -9}


@dataclasses.dataclass
class Case:
    files: dict  # name to bytes; the first one is converted
    options: list
    right: dict  # what has to come out, or None
    what: str  # the fault, for reports
    sound: bool = False  # has to be taken


def si(text, power=0):
    """The number of a text times a power of ten; NaN for what is no number."""
    if not NUMBER.fullmatch(text):
        return math.nan
    value = float(decimal.Decimal(text).scaleb(power))
    return value if math.isfinite(value) else math.nan


def digits(chance, low, high):
    return f"{chance.uniform(low, high):.{chance.choice([2, 3, 5])}f}"


class Packing:
    """Rows of particles and bonds as texts by column, and the box."""

    def __init__(self, chance):
        count = chance.randint(2, 6)
        ids = chance.sample(range(1, 40), count)
        self.low, self.high = ["-1", "0", "0.5"], ["9", "8.25", "12"]
        self.periodic = [chance.random() < 0.5 for _ in range(3)]
        self.time = digits(chance, 0, 9)
        self.particles = [{"id": str(name), "x": digits(chance, 0, 8), "y": digits(chance, 1, 7), "z": digits(chance, 1, 10),
                           "r": digits(chance, 0.2, 0.6), "kind": str(chance.randint(1, 2)), "vx": digits(chance, -3, 3)}
                          for name in ids]
        pairs = [(a, b) for k, a in enumerate(ids) for b in ids[k + 1:]]
        self.bonds = [{"id1": str(a), "id2": str(b), "radius": digits(chance, 0.05, 0.15), "length": digits(chance, 0.01, 0.2)}
                      for a, b in chance.sample(pairs, min(len(pairs), 3))]


class Table:
    """Columns of texts that a fault can spoil."""

    def __init__(self, columns, rows):
        self.columns, self.rows = list(columns), [[row[name] for name in columns] for row in rows]

    def spoil(self, chance, counted):
        """Spoils one thing. Returns what it was, and True where only a refusal is right."""
        row, k = chance.randrange(len(self.rows)), chance.randrange(len(self.columns))
        fault = chance.choice(["token"] * 6 + ["sign", "drop token", "more", "drop row", "twice", "swap"])
        where = f"{fault} {self.columns[k]}"
        if fault == "token":
            self.rows[row][k] = chance.choice(STRANGE)
            where += f" {self.rows[row][k]}"
        elif fault == "sign":
            self.rows[row][k] = "-" + self.rows[row][k].lstrip("-")
        elif fault == "drop token":
            del self.rows[row][k]
            return where, True
        elif fault == "more":
            self.rows[row].insert(k, self.rows[row][k])
            return where, True
        elif fault == "drop row":
            del self.rows[row]
            return where, counted
        elif fault == "twice":
            self.rows.insert(row, list(self.rows[row]))
            return where, counted
        else:
            chance.shuffle(self.rows)
        return where, False

    def column(self, name):
        return [row[self.columns.index(name)] for row in self.rows] if name in self.columns else None

    def lines(self, separator=" "):
        return [separator.join(row) for row in self.rows]


def whole(texts):
    """Whole numbers; None if one of the texts is none."""
    values = [si(text) for text in texts]
    return [int(value) for value in values] if all(value == math.floor(value) for value in values if value == value) and \
        not any(map(math.isnan, values)) and all(abs(value) < 2**63 for value in values) else None


def right_of(table, power, names=None, half=False, first_id=0, others=(), bonds=None, bond_power=0, box=None, periodic=None,
             time=0.0, types=None):
    """What has to come out of a table of particles and one of bonds; None where that has to be refused."""
    position = [[si(text, power) for text in place] for place in zip(*(table.column(axis) for axis in "xyz"))]
    radius = [si(text, power) / (2 if half else 1) for text in table.column("r")]
    ids = whole(table.column("id")) if "id" in table.columns else list(range(first_id, first_id + len(radius)))
    numbers = [*radius, *(each for place in position for each in place),
               *(si(text) for name in others for text in table.column(name))]
    if ids is None or len(set(ids)) < len(ids) or any(map(math.isnan, numbers)) or min(radius, default=1) <= 0:
        return None
    right = {"position": position, "radius": radius, "id": ids, "box": box, "periodic": periodic, "time": time}
    if "kind" in table.columns:
        kinds = whole(table.column("kind")) if names is None or types else table.column("kind")
        if kinds is None or types and not all(1 <= kind <= types
                                              for kind in kinds) or not types and names is None and min(kinds) < 0:
            return None
        right["material"] = [names.get(kind, kind) if names else kind for kind in kinds]
    if bonds is not None:
        ends = [whole(bonds.column(name)) for name in ("id1", "id2")]
        sizes = [[si(text, bond_power) for text in bonds.column(name)] for name in ("radius", "length")]
        if None in ends or any(math.isnan(value) for each in sizes for value in each) or min(sizes[0], default=0) < 0:
            return None
        pairs = [tuple(sorted(pair)) for pair in zip(*ends)]
        if any(a == b or a not in ids or b not in ids for a, b in pairs) or len(set(pairs)) < len(pairs):
            return None
        right["bonds"] = [[*pair, *size] for pair, size in zip(zip(*ends), zip(*sizes))]
    return right


def box_of(low, high, power):
    values = [[si(text, power) for text in corner] for corner in (low, high)]
    return values if not any(math.isnan(value) for corner in values for value in corner) and all(a < b for a,
                                                                                                 b in zip(*values)) else None


def encoded(chance, text, fault):
    """The bytes of a text; another way to end lines, a mark, blank lines at the end. With fault, what may well be refused."""
    text += chance.choice(["", "", "\n", "\n\n  \n"])
    data = text.replace("\n", chance.choice(["\n", "\n", "\r\n", "\r"])).encode()
    if fault:
        return chance.choice([data.decode().encode("utf-16"), b"\xef\xbb\xbf" + data, data + b"\xe9\xff",
                              data[:20] + b"\0" + data[20:]])
    return b"\xef\xbb\xbf" + data if chance.random() < 0.1 else data


def spoilt_number(chance, text):
    return chance.choice([*STRANGE, "-" + text])


# ---- LAMMPS ---------------------------------------------------------------------------------------------------------------------
STYLES = {"sphere": ["id", "kind", "d", "density", "x", "y", "z"],
          "bpm/sphere": ["id", "molecule", "kind", "d", "density", "x", "y", "z"],
          "hybrid sphere bond": ["id", "kind", "x", "y", "z", "d", "density", "molecule"]}


def data(chance):
    packing = Packing(chance)
    bonded = chance.random() < 0.5
    style = chance.choice(["bpm/sphere", "hybrid sphere bond"] if bonded else ["sphere", "bpm/sphere"])
    for row in packing.particles:
        row.update(d=row["r"], density="3.9", molecule="1")
    atoms = Table(STYLES[style], packing.particles)
    bonds = Table(["number", "type", "id1", "id2"],
                  [{**bond, "number": str(k + 1), "type": "1"} for k, bond in enumerate(packing.bonds)])
    announced, units, what, refuse = [len(atoms.rows), 2, len(bonds.rows)], chance.choice(list(LENGTH)), "none", False
    limits = [[a, b, f"{axis}lo", f"{axis}hi"] for a, b, axis in zip(packing.low, packing.high, "xyz")]
    title, options = f"LAMMPS data file via write_data, version 2 Aug 2023, timestep = 5, units = {units}", []
    fault = chance.choice(["none"] * 3 + ["atoms"] * 5 + ["bonds"] * 2 + ["count", "limits", "limits", "section", "units",
                                                                          "encoding", "header", "style"])
    if fault == "atoms":
        what, refuse = atoms.spoil(chance, True)
    elif fault == "bonds" and bonded:
        what, refuse = bonds.spoil(chance, True)
    elif fault == "count":
        what, k = "count", chance.choice([0, 0, 2] if bonded else [0])
        announced[k], refuse = announced[k] + chance.choice([-1, 1]), True
    elif fault == "limits":
        what, row = "limits", chance.randrange(3)
        if chance.random() < 0.3:
            del limits[row]
            refuse = True
        else:
            limits[row][chance.randrange(2)] = spoilt_number(chance, limits[row][1])
    elif fault == "units":
        what = "units"
        if chance.random() < 0.5:
            title, refuse = title.replace(f"= {units}", "= " + chance.choice(["real", "metal", "lj", "electron", "furlong"])), True
        else:
            title = "my packing"
            options = ["--units", units]
    head = f"{announced[0]} atoms\n{announced[1]} atom types\n" + (f"{announced[2]} bonds\n1 bond types\n3 extra bond per atom\n"
                                                                   if bonded else "")
    if fault == "header":
        what, refuse = "header", True
        head = chance.choice([head.replace("atoms", "atmos", 1), head.replace(f"{announced[0]} atoms\n", ""),
                              "a second title\n" + head,
                              head + f"{announced[0]} atoms\n"])
    blank = chance.choice(["\n", "\n\n"])
    section = f"Atoms # {style}" if fault != "style" else chance.choice(["Atoms # full", "Atoms # hybrid", "Atoms # sphere bpm"])
    refuse = refuse or fault == "style"
    parts = [f"{section}\n{blank}" + "".join(f"{line}{chance.choice(['', '', ' # grain'])}\n" for line in atoms.lines())]
    if bonded:
        parts.append(f"Bonds\n{blank}" + "".join(f"{line} # radius {si(bond['radius'], LENGTH[units])!r} length "
                                                 f"{si(bond['length'], LENGTH[units])!r}\n"
                                                 for line, bond in zip(bonds.lines(), packing.bonds + packing.bonds[-1:])))
        if what.startswith(("swap", "drop row", "twice")) and fault == "bonds":  # the remarks stay where they are
            sizes = [packing.bonds[min(k, len(packing.bonds) - 1)] for k in range(len(bonds.rows))]
        else:
            sizes = packing.bonds
        for row, size in zip(bonds.rows, sizes):
            row += [size["radius"], size["length"]]
        bonds.columns += ["radius", "length"]
    if chance.random() < 0.3:
        parts.append(f"Velocities\n{blank}" + "".join(f"{row[0]} 0 0 0 0 0 0\n" for row in atoms.rows if row))
    if fault == "section":
        what, refuse = "section", True
        parts = chance.choice([parts[1:], parts + parts[:1], ["A title of two\n" + parts[0], *parts[1:]]])
        refuse = refuse and parts != []
    chance.shuffle(parts)
    text = f"{title}\n\n{head}{blank}" + "".join(" ".join(limit) + "\n" for limit in limits) + "\n" + "\n".join(parts)
    right = None
    if not refuse:
        atoms.columns[atoms.columns.index("d")] = "r"
        if bonded and any(len(row) != 6 for row in bonds.rows):
            refuse = True
        else:
            ends = box_of([limit[0] for limit in limits], [limit[1] for limit in limits], LENGTH[units])
            numbers = whole(bonds.column("number")) if bonded else []
            kinds = whole(bonds.column("type")) if bonded else []
            if ends and numbers is not None and kinds is not None:
                right = right_of(atoms, LENGTH[units], {}, half=True, others=("density", ), bonds=bonds if bonded else None,
                                 bond_power=LENGTH[units], box=ends, types=2)
    return Case({"a.data": encoded(chance, text, fault == "encoding")}, options, right, f"data {fault} {what}", fault == "none")


def frame(kind, table, count, packing, units, what, limits):
    order = [("ITEM: TIMESTEP\n5\n", "step"), (f"ITEM: NUMBER OF {kind}\n{count + what.get('count', 0)}\n", "count"),
             (f"ITEM: BOX BOUNDS {' '.join('pp' if axis else 'ff' for axis in packing.periodic)}\n" + "".join(" ".join(limit) + "\n"
                                                                                                              for limit in limits),
              "box"),
             (f"ITEM: {kind} {' '.join(table.columns)}\n" + "".join(f"{line}\n" for line in table.lines()), "table")]
    head = f"ITEM: UNITS\n{what.get('units', units)}\nITEM: TIME\n{packing.time}\n"
    return head + "".join(text for text, name in order if name != what.get("left out"))


def dump(chance):
    packing, units = Packing(chance), chance.choice(list(LENGTH))
    names = chance.choice([["id", "kind", "x", "y", "z", "r"], ["id", "element", "x", "y", "z", "r", "vx"],
                           ["id", "kind", "x", "y", "z", "r", "element"]])
    for row in packing.particles:
        row["element"] = {"1": "Al", "2": "Zr"}[row["kind"]]
    chance.shuffle(names)
    atoms, bonded = Table(names, packing.particles), chance.random() < 0.4
    bonds = Table(["id1", "id2", "radius", "length"], packing.bonds)
    diameter, unwrapped = chance.random() < 0.3, chance.choice(["", "u"])
    limits, what, refuse = [[a, b] for a, b in zip(packing.low, packing.high)], {}, False
    fault = chance.choice(["none"] * 3 + ["atoms"] * 6 + ["bonds"] * 2 + ["count", "limits", "left out", "units", "encoding",
                                                                          "names", "tilt"])
    said = fault
    if fault == "atoms":
        said, refuse = atoms.spoil(chance, True)
    elif fault == "bonds" and bonded:
        said, refuse = bonds.spoil(chance, True)
    elif fault == "count":
        what, refuse = {"count": chance.choice([-1, 1])}, True
    elif fault == "limits":
        limits[chance.randrange(3)][chance.randrange(2)] = spoilt_number(chance, "3")
    elif fault == "left out":
        what, refuse = {"left out": chance.choice(["step", "count", "box", "table"])}, True
    elif fault == "units":
        what, refuse = {"units": chance.choice(["real", "metal", "lj", "Micro", ""])}, True
    elif fault == "tilt":
        limits, refuse = [[a, b, chance.choice(["0", "0.5"])] for a, b in limits], True
    shown = copy.deepcopy(atoms)
    titles = {"kind": "type", "r": "diameter" if diameter else "radius", **{axis: axis + unwrapped for axis in "xyz"}}
    shown.columns = [titles.get(name, name) for name in names]
    if fault == "names":
        k = chance.randrange(len(names))
        refuse = names[k] in ("x", "y", "z", "r")
        shown.columns[k] = chance.choice([shown.columns[k - 1], "c_1"]) if refuse else shown.columns[k - 1]
        refuse = True
    bonds_shown = copy.deepcopy(bonds)
    bonds_shown.columns = ["batom1", "batom2", "radius", "length"]
    files = {"a.dump": encoded(chance, frame("ATOMS", shown, len(packing.particles), packing, units, what, limits),
                               fault == "encoding")}
    if bonded:
        text = frame(chance.choice(["ENTRIES", "BONDS"]), bonds_shown, len(packing.bonds), packing, units, {}, [["0", "1"]] * 3)
        files["a.bonds.dump"] = text.encode()
    right = None
    ends = None if refuse else box_of([limit[0] for limit in limits], [limit[1] for limit in limits], LENGTH[units])
    if ends:
        table = copy.deepcopy(atoms)
        if "element" in names and not ("kind" in names and differs(table)):
            if "kind" in names and whole(table.column("kind")) is None:
                return Case(files, [], None, f"dump {said}")
            place = table.columns.index("element")
            if "kind" in names:
                table.columns[table.columns.index("kind")] = "other"
            table.columns[place], labels = "kind", {}
        else:
            labels = None
        others = [name for name in ("vx", ) if name in names]
        right = right_of(table, LENGTH[units], labels, half=diameter, others=others, bonds=bonds if bonded else None,
                         bond_power=LENGTH[units],
                         box=ends, periodic=packing.periodic, time=si(packing.time, TIME[units]))
        if right and labels is None and "kind" in names and min(right["material"]) < 1:
            right = None
    return Case(files, [], right, f"dump {said}", fault == "none")


def differs(table):
    """True if types tell more apart than elements do."""
    kinds = whole(table.column("kind"))
    return kinds is not None and len(set(zip(kinds, table.column("element")))) != len(set(table.column("element")))


# ---- extended XYZ ---------------------------------------------------------------------------------------------------------------
def xyz(chance):
    packing, units = Packing(chance), chance.choice(list(LENGTH))
    for row in packing.particles:
        row["kind"] = {"1": "Al", "2": "Zr"}[row["kind"]]
    groups = [["kind"], ["x", "y", "z"], ["r"], ["id"], ["vx"]]
    groups = groups[:3] + chance.sample(groups[3:], chance.randint(0, 2))
    chance.shuffle(groups)
    table = Table([name for group in groups for name in group], packing.particles)
    title = {"kind": chance.choice(["species:S:1", "element:S:1"]), "x": chance.choice(["pos:R:3", "Pos:R:3", "position:R:3"]),
             "r": chance.choice(["radius:R:1", "Radius:R:1"]), "id": "id:I:1", "vx": "vx:R:1"}
    properties = ":".join(title[group[0]] for group in groups)
    sides = [str(decimal.Decimal(b) - decimal.Decimal(a)) for a, b in zip(packing.low, packing.high)]
    lattice = [sides[0], "0", "0", "0", sides[1], "0", "0.0", "0", sides[2]]
    pbc = chance.choice([" ".join, "".join])([chance.choice([("T", "F"), ("1", "0"), ("t", "f")])[0 if axis else 1]
                                              for axis in packing.periodic])
    count, what, refuse, options, periodic = len(table.rows), "none", False, ["--units", units], packing.periodic
    fault = chance.choice(["none"] * 3 + ["rows"] * 6 + ["count", "lattice", "lattice", "pbc", "properties", "properties",
                                                         "left out", "blank", "encoding"])
    if fault == "rows":
        what, refuse = table.spoil(chance, True)
    elif fault == "count":
        count, refuse = count + chance.choice([-1, 1, 1000]), True
    elif fault == "lattice":
        k = chance.randrange(9)
        lattice[k] = spoilt_number(chance, lattice[k])
    elif fault == "pbc":
        pbc, refuse = chance.choice(["T T", "yes no no", "2 1 1", "TTFF", "", "T,T,F"]), True
    elif fault == "properties":
        broken = [properties.replace("R:3", "R:2"), properties.replace(":R", ":X"), properties + ":", properties + ":x:R:1",
                  properties.replace(":1", ":"),
                  properties.replace("R:3", "S:3"), properties.replace("adius:R", "adius:S"), properties.replace("S:1", "R:1")]
        properties, refuse = chance.choice(broken), True
    words = [f'Lattice="{" ".join(lattice)}"', f'Origin="{" ".join(packing.low)}"', f'pbc="{pbc}"', f"Properties={properties}",
             f"Time={packing.time}"]
    chance.shuffle(words)
    comment = " ".join(words) + chance.choice(["", " it's a packing", " step=5"])
    free = False
    if fault == "left out":
        name = chance.choice(["Lattice", "Properties", "pbc"])
        comment = re.sub(rf'{name}=("[^"]*"|\S+)', "", comment)
        refuse, periodic = name != "pbc", [True] * 3
    lines = table.lines(chance.choice([" ", "  ", "\t"]))
    if fault == "blank":
        lines.insert(chance.randrange(1, len(lines)), "")
        refuse = True
    text = f"{count}\n{comment}\n" + "".join(f"{line}\n" for line in lines)
    right, times = None, chance.randint(1, 3) if fault == "none" else 1
    if not refuse:
        values = [si(each, LENGTH[units]) for each in lattice]
        low = [si(each, LENGTH[units]) for each in packing.low]
        sound = not any(map(math.isnan, values)) and not any(values[k] for k in range(9) if k % 4) and all(values[k] > 0
                                                                                                           for k in (0, 4, 8))
        if sound:
            right = right_of(table, LENGTH[units], {}, others=[name for name in ("vx", ) if name in table.columns],
                             periodic=periodic,
                             box=[low, [a + values[4 * k] for k, a in enumerate(low)]] if not free else None,
                             time=si(packing.time, TIME[units]))
    data_ = encoded(chance, chance.choice(["", "\n"]).join([text] * times), fault == "encoding")
    return Case({"a.xyz": data_}, options, right, f"xyz {fault} {what}", fault == "none")


# ---- tables ---------------------------------------------------------------------------------------------------------------------
UNIT = {"m": 0, "cm": -2, "mm": -3, "um": -6, "\u00b5m": -6, "nm": -9}


def headings(chance, columns, unit, bare=False):
    shape = chance.choice(["{} ({})", "{} [{}]", "{}/{}", "{}({})"])
    capital = chance.choice([str, str.upper, str.capitalize])
    named = {"r": chance.choice(["radius", "r", "Radius"]), "kind": "material"}
    return [shape.format(capital(named.get(name, name)), unit) if name in "xyzr" and not bare else
            ("vx (m/s)" if name == "vx" else named.get(name, name)) for name in columns]


def csv(chance):
    packing, unit = Packing(chance), chance.choice(list(UNIT))
    columns = ["id", "x", "y", "z", "r"] + chance.sample(["kind", "vx"], chance.randint(0, 2))
    chance.shuffle(columns)
    table, bonded = Table(columns, packing.particles), chance.random() < 0.4
    bonds = Table(["id1", "id2", "radius", "length"], packing.bonds)
    heads, what, refuse, power, options = headings(chance, columns, unit), "none", False, UNIT[unit], []
    fault = chance.choice(["none"] * 3 + ["rows"] * 6 + ["bonds"] * 2 + ["unit", "unit", "heading", "comma", "encoding", "blank"])
    separator = chance.choice([",", ";", "\t"]) if fault != "comma" else chance.choice([";", "\t"])
    if fault == "rows":
        what, refuse = table.spoil(chance, False)
    elif fault == "bonds" and bonded:
        what, refuse = bonds.spoil(chance, False)
    elif fault == "unit":
        k = chance.choice([k for k, name in enumerate(columns) if name in "xyzr"])
        old = heads[k]
        heads[k] = chance.choice([old.replace(unit, "furlong"), old.replace(unit, "s"), re.sub(r"\W.*", "", old),
                                  old.replace(unit, "Mm"), ""])
        refuse = heads[k] != old
    elif fault == "heading":
        k = chance.choice([k for k, name in enumerate(columns) if name in "xyz"])
        heads[k], refuse = chance.choice([heads[k - 1],
                                          heads[k].lower().replace("x", "q").replace("y", "q").replace("z", "q")]), True
    right_table = copy.deepcopy(table)
    shown = copy.deepcopy(table)
    if fault == "comma":
        what = chance.choice(["all", "all", "mixed"])
        for row in shown.rows:
            for k, cell in enumerate(row):
                if what == "all" or k == columns.index("x"):
                    row[k] = cell.replace(".", ",")
        refuse = what == "mixed"
    elif any("," in cell for row in table.rows for cell in row):  # with a point elsewhere it is not known which is decimal
        refuse = True
    lines = shown.lines(separator)
    if fault == "blank":
        lines.insert(chance.randrange(len(lines) + 1), chance.choice(["", "  ", separator]))
    text = separator.join(heads) + "\n" + "".join(f"{line}\n" for line in lines)
    if chance.random() < 0.3:
        text = chance.choice(["# from the microscope, time 5 min, box of glass\n", f"Sample{separator}bar 7\n\n"]) + text
    files = {"a.csv": encoded(chance, text, fault == "encoding")}
    if bonded:
        files["a.bonds.csv"] = ("id1,id2,radius (um),length (um)\n" + "".join(f"{line}\n" for line in bonds.lines(","))).encode()
        refuse = refuse or any("," in cell for row in bonds.rows for cell in row)
    right = None
    if not refuse:
        labels = {} if "kind" in columns and not any(NUMBER.fullmatch(cell) for cell in right_table.column("kind")) else None
        right = right_of(right_table, power, labels, others=[name for name in ("vx", ) if name in columns], bonds=bonds if bonded
                         else None,
                         bond_power=-6, periodic=[False] * 3)
    return Case(files, options, right, f"csv {fault} {what}", fault == "none")


def xyzr(chance):
    """Lists of spheres parted by blanks: with --columns, with YADE's heading, with a heading of their own."""
    packing = Packing(chance)
    columns = chance.choice([["x", "y", "z", "r"], ["id", "x", "y", "z", "r"], ["r", "z", "y", "x"]])
    table, how, what, refuse, half = Table(columns, packing.particles), chance.choice(["columns", "units", "yade",
                                                                                       "heading"]), "none", False, False
    unit = chance.choice(list(UNIT))
    power, head, options = UNIT[unit], "", []
    fault = chance.choice(["none"] * 3 + ["rows"] * 6 + ["names", "units", "blank", "encoding"])
    if fault == "rows":
        what, refuse = table.spoil(chance, False)
    if how == "columns":
        half = chance.random() < 0.5
        options = ["--columns",
                   ",".join(f"{'d' if half and name == 'r' else name} ({unit})" if name != "id" else name for name in columns)]
    elif how == "units":
        style = chance.choice(list(LENGTH))
        power, options = LENGTH[style], ["--columns", ",".join(columns), "--units", style]
    elif how == "yade":
        style = chance.choice([None, *LENGTH])
        power, head, options = LENGTH.get(style, 0), f"#format {'_'.join(columns)}\n", ["--units", style] if style else []
    else:
        head = " ".join(headings(chance, columns, unit)) + "\n"
        head = head if "/" not in head else " ".join(f"{name} ({unit})" if name != "id" else name for name in columns) + "\n"
    named = how in ("columns", "units")
    if fault == "names":
        refuse = True
        if named:
            options[1] = chance.choice([options[1] + ",q", options[1].replace("x", "q"), options[1].replace("z", "y")])
        else:
            head = head.replace("x", "q", 1).replace("X", "q", 1)
    elif fault == "units":
        refuse = True
        if named:
            options = options[:2]
            options[1] = options[1].replace(unit, "s") if how == "columns" else options[1]
        else:
            head = ""
    if any("," in cell for row in table.rows for cell in row):
        refuse = True
    lines = table.lines(chance.choice([" ", "\t", "   "]))
    if fault == "blank":
        lines.insert(chance.randrange(len(lines) + 1), "")
    text = head + "".join(f"{line}\n" for line in lines)
    right = None if refuse else right_of(table, power, half=half, periodic=[False] * 3)
    name = chance.choice(["a.txt", "a.dat", "a.xyzr"])
    return Case({name: encoded(chance, text, fault == "encoding")}, options, right, f"xyzr {how} {fault} {what}", fault == "none")


# ---- MUSEN ----------------------------------------------------------------------------------------------------------------------
def musen(chance):
    packing = Packing(chance)
    spheres, bonds = Table(["id", "x", "y", "z", "r"], packing.particles), Table(["id1", "id2", "radius", "length"], packing.bonds)
    bonded, what, refuse = chance.random() < 0.6, "none", False
    fault = chance.choice(["none"] * 3 + ["spheres"] * 6 + ["bonds"] * 2 + ["box", "material", "command", "encoding", "blank",
                                                                            "wall"])
    if fault == "spheres":
        what, refuse = spheres.spoil(chance, False)
    elif fault == "bonds" and bonded:
        what, refuse = bonds.spoil(chance, False)
    lines = []
    keys = {"1": "A1", "2": "B2"}
    kinds = {row["id"]: keys[row["kind"]] for row in packing.particles}
    if not refuse:
        for k, row in enumerate(spheres.rows):
            name, x, y, z, r = row
            key = kinds.get(name, "A1")
            lines.append(f"0 {name} 1 1 5 {r} {r} 23 {key} 24 0 1e+300 2 {packing.time} 12 {x} {y} {z} 15 0 0 0 37 300")
        for k, row in enumerate(bonds.rows if bonded else []):
            diameter = row[2]
            lines.append(f"0 {1000 + k} 1 9 5 {row[0]} {row[1]} {diameter} {row[3]} 23 A1 24 0 1e+300 2 {packing.time} 20 0 0 0")
    else:  # a value too few or too many: the commands behind it are others
        lines = [f"0 1 1 1 5 {' '.join(row)} 23 A1 24 0 1e+300 2 0 12 1 1" for row in spheres.rows or [["1"]]]
    domain = ["22", *packing.low, *packing.high]
    flags = "1" if any(packing.periodic) else "0"
    periodic = ["28", flags, *("1" if axis else "0" for axis in packing.periodic), *packing.low, *packing.high]
    materials = ["32 A1 Al 0 4000 7 4e+11", "32 B2 Zr oxide 0 6000 10 0.3"]
    if fault == "box":
        which = chance.choice([domain, periodic])
        if chance.random() < 0.4:
            which.pop()
            refuse = True
        else:
            k = chance.randrange(1, len(which))
            which[k] = spoilt_number(chance, which[k])
    elif fault == "material":
        materials[0], refuse = chance.choice(["32 A1 Al 0", "32 A1 Al 0 nan", "32 A1", "32 A1 Al 7 -4e11", "32 A1 Al 10 0.9",
                                              "32 A1 Al 0 1 0 2"]), True
    elif fault == "command":
        lines[0], refuse = chance.choice([lines[0].replace(" 12 ", " 99 "), lines[0].replace(" 1 1 5 ", " 1 7 5 "),
                                          lines[0] + " 12 1 1 1",
                                          lines[0].replace(" 5 ", " "), lines[0].replace(" 12 ", " 12 1 ")]), True
    elif fault == "wall":
        lines.insert(0, "0 900 1 14 5  23 A1 24 0 1e+300 2 0 12 1 1 0")
    text_lines = lines + [" ".join(domain), " ".join(periodic), "29 0", *materials, "33 A1 B2 200 0.5 201 0.4"]
    if fault == "blank":
        text_lines.insert(chance.randrange(1, len(text_lines)), "")
    right = None
    ends = box_of(periodic[5:8], periodic[8:11], 0) if any(packing.periodic) else box_of(domain[1:4], domain[4:7], 0)
    every = [*domain[1:], *periodic[1:]]
    if not refuse and ends and not any(math.isnan(si(each)) for each in every) and all(si(each) in (0, 1)
                                                                                       for each in periodic[1:5]):
        on = si(periodic[1]) == 1
        told = [si(each) == 1 for each in periodic[2:5]] if on else [False] * 3
        ends = box_of(periodic[5:8], periodic[8:11], 0) if on else box_of(domain[1:4], domain[4:7], 0)
        half = copy.deepcopy(bonds)
        for row in half.rows:  # a bond has a diameter
            row[2] = str(decimal.Decimal(row[2]) / 2) if NUMBER.fullmatch(row[2]) else row[2]
        right = right_of(spheres, 0, bonds=half if bonded and half.rows else None, box=ends, periodic=told,
                         time=si(packing.time)) if ends else None
        if right:
            right["material"] = [{"A1": "Al", "B2": "Zr oxide"}[kinds.get(row[0], "A1")] for row in spheres.rows]
            for each in right.get("bonds", ()):
                each[3] = None  # its length follows from the places of the spheres
    return Case({"a.txt": encoded(chance, "\n".join(text_lines) + "\n", fault == "encoding")}, ["--from", "musen"], right,
                f"musen {fault} {what}",
                fault == "none")


# ---- VTU ------------------------------------------------------------------------------------------------------------------------
class VtuArray:
    """A DataArray in one of the ways of the format: text, base64, appended; packed by zlib or not."""

    def __init__(self, chance, name, kind, values, width=1):
        self.name, self.kind, self.values, self.width = name, kind, values, width

    def packed(self, order, size, compress):
        code = {"Float64": "d", "Float32": "f", "Int64": "q", "Int32": "i", "UInt8": "B"}[self.kind]
        raw = struct.pack(f"{order}{len(self.values)}{code}", *self.values)
        if not compress:
            return struct.pack(f"{order}{size}", len(raw)), raw
        parts = [raw[:len(raw) // 2 // 8 * 8], raw[len(raw) // 2 // 8 * 8:]] if len(raw) >= 32 and len(raw) // 2 % 8 == 0 else [raw]
        done = [zlib.compress(part) for part in parts]
        head = [len(done), len(parts[0]), 0 if len(parts[-1]) == len(parts[0]) else len(parts[-1]), *map(len, done)]
        return struct.pack(f"{order}{len(head)}{size}", *head), b"".join(done)


def vtu(chance):
    packing = Packing(chance)
    style = chance.choice(list(LENGTH))
    power, rows = LENGTH[style], [row for row in packing.particles]
    order, size, compress = chance.choice("<>"), chance.choice("IQ"), chance.random() < 0.5
    form = chance.choice(["ascii", "binary", "appended base64", "appended raw"])
    name = chance.choice(["radius", "Radius", "radii", "diameter"])
    places = [float(row[axis]) for row in rows for axis in "xyz"]
    points = VtuArray(chance, "Points", "Float64", places, 3)
    data_ = [VtuArray(chance, name, "Float64", [float(row["r"]) for row in rows]),
             VtuArray(chance, "id", "Int64", [int(row["id"]) for row in rows])]
    bonded = chance.random() < 0.5
    bonds = packing.bonds if bonded else []
    at = {row["id"]: k for k, row in enumerate(rows)}
    ends = [at[bond[end]] for bond in bonds for end in ("id1", "id2")]
    vertices = bonded or chance.random() < 0.5
    count = len(rows) if vertices else 0
    cells = [VtuArray(chance, "connectivity", "Int64", [*range(count), *ends]),
             VtuArray(chance, "offsets", "Int64", [*range(1, count + 1), *(count + 2 * (k + 1) for k in range(len(bonds)))]),
             VtuArray(chance, "types", "UInt8", [1] * count + [3] * len(bonds))]
    cell_data = [VtuArray(chance, title, "Float64", [math.nan] * count + [float(bond[key]) for bond in bonds])
                 for title, key in (("bond_radius", "radius"), ("length", "length"))] if bonded else []
    counts, options, refuse = [len(rows), count + len(bonds)], ["--units", style], False
    fault = chance.choice(["none"] * 3 + ["value"] * 3 + ["count", "missing", "cells", "width", "damage", "cut", "tag", "twice",
                                                          "word"])
    if fault == "value":
        array = chance.choice([points, *data_])
        k = chance.randrange(len(array.values))
        array.values[k] = chance.choice([-1, 0, 7, 5]) if array.kind == "Int64" else chance.choice([-1.0, 0.0, math.nan, math.inf,
                                                                                                    2.5])
    elif fault == "count":
        k = chance.randrange(2)
        counts[k], refuse = counts[k] + chance.choice([-1, 1]), True
    elif fault == "cells" and cells[0].values:
        array = chance.choice(cells)
        array.values[-1], refuse = 99, True
    elif fault == "width":
        points.width, refuse = chance.choice([1, 2, 4]), True
    arrays = {"Points": [points], "PointData": data_, "Cells": cells, "CellData": cell_data}
    if fault == "missing":
        where = chance.choice(["Points", "Cells", "PointData"])
        arrays[where] = arrays[where][1:]
        refuse = True
    elif fault == "twice":
        arrays["PointData"], refuse = data_ + data_[:1], True
    appended, texts = bytearray(), []
    spoil_word = fault == "word" and form == "ascii"
    for section, list_ in arrays.items():
        inner = ""
        for array in list_:
            width = f' NumberOfComponents="{array.width}"' if array.width > 1 or chance.random() < 0.3 else ""
            head = f'<DataArray type="{array.kind}" Name="{array.name}"{width}'
            if form == "ascii":
                words = [repr(value) for value in array.values]
                if spoil_word and section in ("Points", "PointData") and words:
                    words[chance.randrange(len(words))] = chance.choice(["wide", "1_0", "0x10", "1,5", "1d3"])
                    spoil_word, refuse = False, True
                inner += f'{head} format="ascii">{" ".join(words)}</DataArray>\n'
                continue
            first, second = array.packed(order, size, compress)
            encoded_ = base64.b64encode(first) + base64.b64encode(second) if compress else base64.b64encode(first + second)
            if form == "binary":
                inner += f'{head} format="binary">{encoded_.decode()}</DataArray>\n'
            else:
                inner += f'{head} format="appended" offset="{len(appended)}"/>\n'
                appended += first + second if form.endswith("raw") else encoded_
        texts.append(f"<{section}>\n{inner}</{section}>\n")
    packer = ' compressor="vtkZLibDataCompressor"' if compress and form != "ascii" else ""
    head = (f'<VTKFile type="UnstructuredGrid" version="1.0" byte_order="{"LittleEndian" if order == "<" else "BigEndian"}" '
            f'header_type="UInt{32 if size == "I" else 64}"{packer}>\n')
    piece = f'<Piece NumberOfPoints="{counts[0]}" NumberOfCells="{counts[1]}">'
    body = f'{head}<UnstructuredGrid>{piece}\n{"".join(texts)}</Piece></UnstructuredGrid>\n'
    raw = body.encode()
    if form.startswith("appended"):
        raw += f'<AppendedData encoding="{form.split()[1]}">\n_'.encode() + bytes(appended) + b"\n</AppendedData>\n"
    raw += b"</VTKFile>\n"
    if fault == "damage" and packer:
        raw = damaged(chance, raw)
        right_too = True
    elif fault == "cut":
        raw, refuse = raw[:chance.randrange(len(raw) - 20)], True
    elif fault == "tag":
        raw, refuse = raw.replace(*chance.choice([(b"UnstructuredGrid>", b"PolyData>"), (b"</Piece>", b""), (b"<Cells>", b"<Cell>"),
                                                  (b"Points>", b"Point>")])), True
    right_too = fault == "damage"
    right = None
    ids = data_[1].values
    half = 2 if name == "diameter" else 1
    radius = [value / half for value in data_[0].values]
    if not refuse and len(set(ids)) == len(ids) and all(map(math.isfinite, [*places, *radius, *points.values])) and min(radius) > 0:
        def scale(value):
            return value / 10.0**-power
        where = [scale(value) for value in points.values]
        right = {"position": [where[3 * k:3 * k + 3] for k in range(len(rows))], "radius": [scale(value) for value in radius],
                 "id": ids, "box": None,
                 "periodic": [False] * 3, "time": 0.0}
        if bonded:
            right["bonds"] = [[ids[at[bond["id1"]]], ids[at[bond["id2"]]], scale(float(bond["radius"])),
                               scale(float(bond["length"]))] for bond in bonds]
    return Case({"a.vtu": raw}, options, right, f"vtu {form} {fault}", fault == "none" and not right_too)


def damaged(chance, raw):
    """A file in which one byte of what zlib packed is another."""
    places = [match for match in re.finditer(rb">([A-Za-z0-9+/=]{24,})<|_([^<]{24,})\n</App", raw, re.DOTALL)]
    if not places:
        return raw
    place = chance.choice(places)
    k = chance.randrange(place.start() + 20, place.end() - 12) if place.end() - place.start() > 40 else place.start() + 12
    return raw[:k] + bytes([raw[k] ^ 1 if raw[k:k + 1].isalnum() else raw[k]]) + raw[k + 1:]


FORMATS = {"data": data, "dump": dump, "xyz": xyz, "csv": csv, "xyzr": xyzr, "musen": musen, "vtu": vtu}
