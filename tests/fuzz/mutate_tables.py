"""mutate_tables.py: exports of testing machines in many forms, whole and spoilt, through analyze: the right value, or a refusal in
one sentence, and nothing else.

A whole export must give the right value. A spoilt one lacks a piece, or has one twice, or says something that cannot be: it may
give the right value still, or be refused.
"""
import argparse
import collections
import gzip
import json
import math
import os
import random
import re
import subprocess
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
ANALYZE = os.environ.get("ANALYZE", os.path.join(os.environ.get("BIN", os.path.join(ROOT, "build", "bin")), "analyze"))
LONGEST = 10.0  # s of a run
NEAR = 0.01  # of the right value
SENTENCE = re.compile(r"^analyze [a-z]+: [^\x00-\x1f]{1,500}\n$")

# The bar: 4 mm x 3 mm on a span of 40 mm; 1350 N/mm are 200 GPa without shear; 60 N are 100 MPa.
STIFFNESS, PEAK = 1350e3, 60.0  # N/m, N
BAR = ["--span", "40mm", "--width", "4mm", "--height", "3mm"]
MODULUS, STRENGTH = 200e9, 100e6  # Pa
SOLID, EXPONENT = 410e9, 3.95  # Pa, -: the law of the tables of moduli

LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "\u00b5m": 1e-6, "nm": 1e-9}
FORCES = {"N": 1.0, "kN": 1e3, "mN": 1e-3}
TIMES = {"s": 1.0, "min": 60.0}
PRESSURES = {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9, "kN/mm2": 1e9}
FRACTIONS = {"": 1.0, "-": 1.0, "%": 1e-2}
DEFLECTION_NAMES = ("Deflection", "displacement", "Extension", "Weg", "Verformung", "DURCHBIEGUNG", "Stroke", "Standardweg")
FORCE_NAMES = ("Force", "load", "Kraft", "Standardkraft", "Pr\u00fcfkraft", "FORCE")
TIME_NAMES = ("Time", "Pr\u00fcfzeit", "Zeit", "t")
REPORTS = (("Specimen label", "bar 7"), ("Pr\u00fcfer", "M\u00fcller"), ("Anvil height", "3.11", "mm"), ("Width", "4"),
           ("Date", "24.12.2025"), ("Remark",), ("Test rate", "0.5", "mm/min", "", ""), ("Results of the test",))


class Column:
    """A heading, its unit and the SI values of a column, or words."""

    def __init__(self, name, unit, factor, values, offset=0.0):
        self.name, self.unit, self.factor, self.values, self.offset = name, unit, factor, values, offset

    def cells(self, digits, mark):
        return [value if isinstance(value, str) else f"{value / self.factor + self.offset:.{digits}g}".replace(".", mark)
                for value in self.values]


def one_of(dice, table):
    unit = dice.choice(list(table))
    return unit, table[unit]


def curve_columns(dice, broken):
    """Deflection and force of a test with one unloading, or to fracture and back; with others beside them."""
    points = dice.randint(60, 120)
    rising = [PEAK * k / points for k in range(points + 1)]
    force = rising + ([0.6 - 0.5 * k / 20 for k in range(21)] if broken else rising[-2::-1])
    deflection = [value / STIFFNESS for value in rising]
    deflection += [1.02 * deflection[-1] * (1 - k / 20) for k in range(21)] if broken else deflection[-2::-1]
    rate = dice.choice((1, 1, 1, -1))
    if dice.random() < 0.3:
        force = [-value for value in force]
    columns = [Column(dice.choice(DEFLECTION_NAMES), *one_of(dice, LENGTHS), [rate * value for value in deflection]),
               Column(dice.choice(FORCE_NAMES), *one_of(dice, FORCES), force)]
    if dice.random() < 0.6:
        columns.append(Column(dice.choice(TIME_NAMES), *one_of(dice, TIMES), [0.1 * k for k in range(len(force))]))
    if dice.random() < 0.3:
        columns.append(Column("Remark", "", 1.0, [dice.choice(("", "ok", "2nd, of lot")) for _ in force]))
    if dice.random() < 0.2:
        columns.append(Column("Channel 4", "V", 1.0, [0.5 + 0.25 * (k % 3) for k in range(len(force))]))
    return columns


def modulus_columns(dice):
    """A table of moduli against porosity, or relative density."""
    porosity = [0.02 + 0.04 * k for k in range(dice.randint(4, 9))]
    modulus = [SOLID * math.exp(-EXPONENT * each) for each in porosity]
    dense = dice.random() < 0.5
    name = dice.choice(("relative_density", "Relative density") if dense else ("Porosity", "Porosit\u00e4t"))
    columns = [Column(name, *one_of(dice, FRACTIONS), [1 - each for each in porosity] if dense else porosity),
               Column(dice.choice(("E", "E-modulus", "young_modulus", "Young's modulus", "E-Modul")), *one_of(dice, PRESSURES),
                      modulus)]
    if dice.random() < 0.5:
        columns.append(Column("Sample", "", 1.0, [f"A{k}" for k in range(len(modulus))]))
    if dice.random() < 0.3:
        columns.append(Column("modulus of rupture", "MPa", 1e6, [3e8 for _ in modulus]))
    return columns


def heading_of(dice, column, form):
    if not column.unit:
        return column.name
    return {"()": f"{column.name} ({column.unit})", "[]": f"{column.name} [{column.unit}]",
            "/": f"{column.name} / {column.unit}"}[form]


class Export:
    """A table as a machine writes it: lines of cells, and how these become bytes."""

    def __init__(self, dice, columns):
        dice.shuffle(columns)
        self.separator = dice.choice(";,\t")
        self.mark = dice.choice(".,")
        self.quoted = dice.random() < 0.3 or (self.mark == "," and self.separator == ",")
        self.trailing = dice.random() < 0.2
        self.stated = dice.random() < 0.1
        self.line_end = dice.choice(("\n", "\n", "\r\n", "\r"))
        self.encoding = dice.choice(("utf-8", "utf-8", "utf-8-sig", "latin1", "utf-16", "utf-16-le", "utf-16-be"))
        self.heading = dice.choice(("()", "[]", "/", "row", "(row)"))
        names = [each.name if "row" in self.heading else heading_of(dice, each, self.heading) for each in columns]
        self.lines = [list(report) for report in dice.sample(REPORTS, dice.choice((0, 0, 3, 5)))]
        self.first = len(self.lines)  # of the table
        self.lines.append(names)
        if "row" in self.heading:
            self.lines.append([f"({each.unit})" if each.unit and "(" in self.heading else each.unit for each in columns])
        self.body = len(self.lines)
        self.lines += zip(*(each.cells(dice.randint(9, 12), self.mark) for each in columns))
        self.lines = [list(line) for line in self.lines]
        for _ in range(dice.choice((0, 0, 1, 4))):
            self.lines.insert(dice.randint(self.body, len(self.lines)), dice.choice(([""], ["# paused"])))

    def cell(self, text):
        need = self.quoted or self.separator in text
        return f'"{text}"' if need and text else text

    def to_bytes(self):
        lines = [self.separator.join(map(self.cell, line)) + (self.separator if self.trailing and len(line) > 1 else "")
                 for line in self.lines]
        if self.stated:
            lines.insert(0, "sep=" + self.separator)
        return (self.line_end.join(lines) + self.line_end).encode(self.encoding)


def drop_cell(dice, export):
    del dice.choice(export.lines[export.first:])[0]


def empty_cell(dice, export):
    line = dice.choice(export.lines[export.body:])
    line[dice.randrange(len(line))] = ""


def word_for_number(dice, export):
    line = dice.choice(export.lines[export.body:])
    line[dice.randrange(len(line))] = dice.choice(("x", "nan", "---", "overflow", "1..2", "1e999", "12 3"))


def drop_lines(dice, export):
    at = export.body + dice.randrange(len(export.lines) - export.body) * 2 // 5  # not those of the largest force
    del export.lines[at:at + dice.randint(1, 3)]


def repeat_line(dice, export):
    at = dice.randrange(export.body, len(export.lines))
    export.lines.insert(at, list(export.lines[at]))


def drop_heading(dice, export):
    del export.lines[export.first]


def rename_heading(dice, export):
    names = export.lines[export.first]
    names[dice.randrange(len(names))] = dice.choice(("", "value", "Kanal 1", "Rate (mm/min)", "3"))


def repeat_column(dice, export):
    column = dice.randrange(len(export.lines[export.first]))
    for line in export.lines[export.first:]:
        if column < len(line):
            line.append(line[column])


def drop_column(dice, export):
    column = dice.randrange(len(export.lines[export.first]))
    for line in export.lines[export.first:]:
        del line[column:column + 1]


def drop_unit(dice, export):
    row = export.lines[export.first + ("row" in export.heading)]
    at = dice.randrange(len(row))
    row[at] = re.sub(r" ?[(\[/].*", "", row[at]) if "row" not in export.heading else ""


def wrong_unit(dice, export):
    row = export.lines[export.first + ("row" in export.heading)]
    at = dice.randrange(len(row))
    row[at] = re.sub(r"[(\[/ ].*", "", row[at]) + dice.choice((" (lbf)", " (V)", " (inch)", " (MM)", " (mmm)"))


def thousands(dice, export):
    """Marks of thousands, as spreadsheets add them to large numbers."""
    comma = "," if export.mark == "." else "."
    for line in export.lines[export.body:]:
        for at, cell in enumerate(line):
            line[at] = re.sub(r"^(-?\d{1,3})(\d{3})(?=\D|$)", rf"\1{comma}\2", cell)


def mixed_marks(dice, export):
    line = dice.choice(export.lines[export.body:])
    line[:] = [cell.translate(str.maketrans(".,", ",.")) for cell in line]


def second_table(dice, export):
    export.lines += [list(line) for line in export.lines[export.first:]]


def trailer(dice, export):
    export.lines.append(dice.choice((["Maximum", "60"], ["Mean", "1", "2"], ["end of file"], ["Mean"] + export.lines[-1][1:])))


SPOILERS = (drop_cell, empty_cell, word_for_number, drop_lines, repeat_line, drop_heading, rename_heading, repeat_column,
            drop_column, drop_unit, wrong_unit, thousands, mixed_marks, second_table, trailer)


def spoilt_bytes(dice, data):
    """The bytes cut at a line, compressed, or with one that no text has."""
    kind = dice.choice(("as they are", "as they are", "as they are", "gzip", "control", "empty"))
    if kind == "gzip":
        return gzip.compress(data, mtime=0)
    if kind == "control":
        at = dice.randrange(len(data) // 2) * 2
        return data[:at] + dice.choice((b"\x00\x01", b"\x07\x00", b"\x81\x81")) + data[at:]
    return b"" if kind == "empty" else data


def mutant(seed):
    """What to run, the bytes of the table, the right values by key, and whether it is spoilt."""
    dice = random.Random(seed)
    kind = dice.choice(("cycle", "cycle", "fracture", "strength", "fit"))
    columns = modulus_columns(dice) if kind == "fit" else curve_columns(dice, kind != "cycle")
    export = Export(dice, columns)
    spoilers = dice.sample(SPOILERS, dice.choice((0, 0, 1, 1, 2)))
    for spoiler in spoilers:
        try:
            spoiler(dice, export)
        except IndexError:  # another one took what this would spoil
            pass
    data = export.to_bytes()
    if spoilers:
        data = spoilt_bytes(dice, data)
    slope = ["modulus", *BAR, "--shear", "none"]
    command = {"cycle": slope, "fracture": [*slope, "--branch", "loading"], "strength": ["strength", *BAR], "fit": ["fit"]}[kind]
    right = {"strength": {"mean_strength": STRENGTH}, "fit": {"dense_modulus": SOLID, "b": EXPONENT}}
    return command, data, right.get(kind, {"young_modulus": MODULUS}), bool(spoilers)


def check(command, path, right, spoilt):
    """'right' or 'refused'. Throws ValueError for any other end."""
    ended = subprocess.run([ANALYZE, *command, "-q", path], capture_output=True, check=False, timeout=LONGEST)
    said = ended.stderr.decode(errors="replace")
    if ended.returncode == 0:
        found = json.loads(ended.stdout)
        for key, value in right.items():
            if not abs(found[key] - value) < NEAR * value:
                raise ValueError(f"{key} is {found[key]:.6g}, not {value:.6g}")
        return "right"
    if ended.returncode != 1 or not SENTENCE.match(said) or os.path.basename(path) not in said:
        raise ValueError(f"ended with status {ended.returncode}, said {said[:500]!r}")
    if not spoilt:
        raise ValueError(f"is whole and refused: {said.strip()}")
    return "refused"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200, help="number of exports")
    parser.add_argument("--first", type=int, default=0, help="seed of the first; the next has the next")
    parser.add_argument("--keep", default=".", metavar="FOLDER", help="where those go that analyze took wrongly")
    options = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    ends, faults = collections.Counter(), 0
    for seed in range(options.first, options.first + options.count):
        command, data, right, spoilt = mutant(seed)
        path = os.path.join(options.keep, f"table-{seed}.csv")
        with open(path, "wb") as file:
            file.write(data)
        try:
            ends[check(command, path, right, spoilt), spoilt] += 1
            os.remove(path)
        except ValueError as error:
            faults += 1
            print(f"analyze {' '.join(command)} {path}: {error}")
    print(f"{options.count} tables: {ends['right', False]} whole and right, {ends['right', True]} spoilt and right, "
          f"{ends['refused', True]} spoilt and refused, {faults} faults")
    return faults > 0


if __name__ == "__main__":
    sys.exit(main())
