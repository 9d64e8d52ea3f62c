"""mutate_powders.py: tables of sizes, lists of diameters and spheres, and logs of furnaces, in many manners and spoilt, through
sinter: the value that they were made from, or a refusal in one sentence, and nothing else.

A file in one of the manners of manner() has to give its value. One that is spoilt may be refused instead.
"""
import argparse
import collections
import json
import math
import os
import random
import re
import subprocess
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SINTER = os.environ.get("SINTER", os.path.join(os.environ.get("BIN", os.path.join(ROOT, "build", "bin")), "sinter"))
LONGEST = 20.0  # s of a run
SENTENCE = re.compile(r"^sinter( green)?: [^\x00-\x1f]{1,600}\n$")
LENGTHS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "\u00b5m": 1e-6, "nm": 1e-9}
TIMES = {"s": 1.0, "min": 60.0, "h": 3600.0}
CELSIUS = ("C", "\u00b0C", "degC")


class Table:
    """Headings, their units, and rows of texts: what becomes a file."""

    def __init__(self, names, units, rows):
        self.names, self.units, self.rows = names, units, rows

    def text(self, chance):
        """In one of the manners of exports."""
        separator = chance.choice([",", ";", "\t", " "])
        if separator == " " and any(" " in name for name in self.names):
            separator = "\t"
        mark = "," if separator in ";\t" and chance.random() < 0.4 else "."
        brackets = chance.choice(["()", "[]"])
        headings = [f"{name} {brackets[0]}{unit}{brackets[1]}" if unit else name for name, unit in zip(self.names, self.units)]
        lines = [separator.join(headings)]
        if all(self.units) and separator != " " and chance.random() < 0.25:
            lines = [separator.join(self.names), separator.join(self.units)]
        lines += [separator.join(cell.replace(".", mark) for cell in row) for row in self.rows]
        for _ in range(chance.choice([0, 0, 1, 2])):
            lines.insert(chance.randrange(len(lines) + 1), chance.choice(["", "# measured on Monday"]))
        return lines


def number(value):
    return f"{value:.12g}"


def swapped(table, chance):
    """The columns in another order."""
    order = list(range(len(table.names)))
    chance.shuffle(order)
    return Table([table.names[k] for k in order], [table.units[k] for k in order], [[row[k] for k in order] for row in table.rows])


def sizes(chance):
    """A distribution by number or volume: its file, and its medians by number and by volume, m."""
    count = chance.randint(3, 12)
    edges = sorted(chance.uniform(50e-9, 900e-9) for _ in range(count))
    weights = [chance.uniform(0.5, 3.0) for _ in range(count)]
    cumulative = chance.random() < 0.5
    if cumulative:
        weights[0] = 0.0
    total = sum(weights)
    shares = [weight / total for weight in weights]
    by, power = chance.choice([("Volume", 3), ("Mass", 3), ("Number", 0)])
    unit = chance.choice(list(LENGTHS))
    percent = chance.random() < 0.7
    kind = chance.choice(["Cumulative ", "Undersize "]) if cumulative else ""
    values = [sum(shares[:k + 1]) for k in range(count)] if cumulative else shares
    rows = [[number(edge / LENGTHS[unit]), number(value * (100 if percent else 1))] for edge, value in zip(edges, values)]
    if chance.random() < 0.3:
        rows.reverse()
    table = Table(["Size", kind + by], [unit, "%" if percent else ""], rows)
    pieces = [(edges[max(k - 1, 0)] if cumulative else edges[k], edges[k], shares[k]) for k in range(count) if shares[k] > 0]
    return table, ("sizes", [median(pieces, 0 - power), median(pieces, 3 - power)])


def median(pieces, power):
    """Of shares spread over ln d in each piece and weighted by d^power: by 4000 steps a piece."""
    samples = []
    for low, high, share in pieces:
        steps = 1 if low == high else 4000
        for step in range(steps):
            diameter = low * (high / low) ** ((step + 0.5) / steps)
            samples.append((diameter, share / steps * diameter ** power))
    half, passed = 0.5 * sum(weight for _, weight in samples), 0.0
    for diameter, weight in sorted(samples):
        passed += weight
        if passed >= half:
            return diameter
    raise ValueError("no median")


def diameters(chance):
    """A list of diameters with a unit each, or a heading; its diameters, m."""
    values = [chance.uniform(50e-9, 500e-9) for _ in range(chance.randint(2, 12))]
    if chance.random() < 0.3:
        unit = chance.choice(list(LENGTHS))
        return Table(["Diameter"], [unit], [[number(value / LENGTHS[unit])] for value in values]), ("list", sorted(values))
    lines = []
    for value in values:
        unit = chance.choice(list(LENGTHS))
        lines.append(number(value / LENGTHS[unit]) + chance.choice(["", " "]) + unit)
    return lines, ("list", sorted(values))


def spheres(chance):
    """A list of spheres that do not touch, on a coarse lattice; x, y, z and radius, m."""
    found = []
    for k in range(chance.randint(1, 8)):
        place = [3e-6 * (k >> axis & 1) + chance.uniform(-2e-7, 2e-7) for axis in range(3)]
        found.append([*place, chance.uniform(1e-7, 9e-7)])
    unit = chance.choice(list(LENGTHS))
    diameter = chance.random() < 0.5
    rows = [[number(value / LENGTHS[unit]) for value in (*one[:3], one[3] * (2 if diameter else 1))] for one in found]
    names = ["x", "y", "z", chance.choice(["diameter", "d"] if diameter else ["radius", "r", "R"])]
    table = Table(names, [unit] * 4, rows)
    if chance.random() < 0.3:
        table = Table(["id", *names], ["", *table.units], [[str(7 + k), *row] for k, row in enumerate(rows)])
    return table, ("spheres", found)


def log(chance):
    """A furnace's log; times, s, and temperatures, K."""
    times = [0.0]
    for _ in range(chance.randint(2, 10)):
        times.append(times[-1] + chance.randint(1, 50) * 60.0)
    celsius = [float(chance.randint(20, 1400)) for _ in times]
    unit = chance.choice(list(TIMES))
    kelvin = chance.random() < 0.3
    start = chance.choice([0.0, 600.0])
    if chance.random() < 0.25:
        cells, unit = [f"{int(t) // 3600:02d}:{int(t) // 60 % 60:02d}:{int(t) % 60:02d}" for t in times], ""
    else:
        cells = [number((t + start) / TIMES[unit]) for t in times]
    rows = [[cell, number(value + (273.15 if kelvin else 0.0))] for cell, value in zip(cells, celsius)]
    if chance.random() < 0.4:
        rows = [[*row, number(chance.uniform(0, 100))] for row in rows]
    names = [chance.choice(["Time", "time", "Zeit"]), chance.choice(["Temperature", "Temp.", "T", "Temperatur"]), "Power"]
    units = [unit, "K" if kelvin else chance.choice(CELSIUS), "%"]
    table = Table(names[:len(rows[0])], units[:len(rows[0])], rows)
    return table, ("log", list(zip(times, [value + 273.15 for value in celsius])))


def without_unit(table, chance):
    units = list(table.units)
    units[chance.randrange(len(units))] = ""
    return Table(table.names, units, table.rows)


def with_other_unit(table, chance):
    units = list(table.units)
    units[chance.randrange(len(units))] = chance.choice(["N", "furlong", "MPa", "mol"])
    return Table(table.names, units, table.rows)


def with_cell(table, chance):
    """One cell is empty, a word, or has a sign that it cannot have; or it is missing."""
    rows = [list(row) for row in table.rows]
    row = chance.randrange(len(rows))
    column = chance.randrange(len(rows[row]))
    names = [name.lower() for name in table.names]
    free = ("x", "y", "z", "id", "power")  # which may have any sign, or are not read
    if names[column] in free or (names[column] in ("time", "zeit") and row == 0):
        column = next(k for k, name in enumerate(names) if name not in (*free, "time", "zeit"))
    change = chance.choice(["n/a", "sensor", "1e999", "-"] + (["", None] if len(names) > 1 else []))
    if change is None:
        del rows[row][column]
    else:
        rows[row][column] = "-" + rows[row][column] if change == "-" else change
    return Table(table.names, table.units, rows)


def without_row(table, chance):
    """A row less: classes no longer make up all; the ends of a curve are missing."""
    rows = list(table.rows)
    del rows[chance.choice([0, -1])]
    return Table(table.names, table.units, rows)


def with_column_twice(table, chance):
    column = chance.randrange(len(table.names))
    return Table([*table.names, table.names[column]], [*table.units, table.units[column]],
                 [[*row, row[column]] for row in table.rows])


def without_heading(lines, chance):
    return lines[1:]


def with_thousands(table, chance):
    rows = [list(row) for row in table.rows]
    rows[chance.randrange(len(rows))][0] = "1,000.5"
    return Table(table.names, table.units, rows)


def spoilt(kind, table, chance):
    """A table that lacks something or says what cannot be."""
    changes = [without_unit, with_other_unit, with_cell, with_column_twice, with_thousands]
    if kind == "sizes":
        changes.append(without_row)
    return chance.choice(changes)(table, chance)


def encoded(lines, chance):
    """The bytes of a file."""
    text = chance.choice(["\n", "\r\n", "\n"]).join(lines) + chance.choice(["\n", ""])
    coding = chance.choice(["utf-8", "utf-8", "utf-8-sig", "utf-16", "latin-1"])
    return text.encode(coding)


# Two spheres, too coarse to move.
BODY = ('{"box":{"vectors":[[10,0,0],[0,10,0],[0,0,10]]},'
        '"particles":{"position":{"type":"f8","shape":[2,3],"data":[4,5,5,5.99,5,5]},'
        '"radius":{"type":"f8","shape":[2],"data":[1,1]}}}\n')


def found_value(kind, path, truth):
    """What sinter makes of the file, in the form of its truth; None for a refusal."""
    if kind == "log":
        times = sorted({0.5 * (a[0] + b[0]) for a, b in zip(truth, truth[1:])})
        command = [SINTER, "-q", "--schedule", path, "--at-time", ",".join(f"{t}s" for t in times), "--material", "alumina",
                   "--text"]
    elif kind == "spheres":
        command = [SINTER, "green", "-q", "--spheres", path, "--text"]
    else:
        command = [SINTER, "green", "-q", "--density", "0.1", "--distribution", f"file:{path}", "--text"]
        command += ["-n", "20"] if kind == "sizes" else []
    ended = subprocess.run(command, input=BODY, capture_output=True, check=False, text=True, timeout=LONGEST)
    if ended.returncode == 1:
        if not SENTENCE.match(ended.stderr):
            raise ValueError(f"said {ended.stderr!r}")
        return None
    if ended.returncode != 0:
        raise ValueError(f"ended with status {ended.returncode}, said {ended.stderr!r}")
    states = [json.loads(line) for line in ended.stdout.splitlines()]
    if kind == "log":
        return [(state["time"], state["temperature"]) for state in states]
    particles = states[0]["particles"]
    radii = particles["radius"]["data"]
    if kind == "spheres":
        places = particles["position"]["data"]
        return [[*places[3 * k:3 * k + 3], radius] for k, radius in enumerate(radii)]
    if kind == "list":
        return sorted(2 * radius for radius in radii)
    asked = states[0]["history"][0]["summary"]["diameters"]["asked"]
    return [asked["by_number"]["d50"], asked["by_volume"]["d50"]]


def same(kind, found, truth):
    if kind == "log":
        middles = [(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])) for a, b in zip(truth, truth[1:])]
        return len(found) == len(middles) and all(
            math.isclose(f[0], m[0], rel_tol=1e-9) and math.isclose(f[1], m[1], rel_tol=1e-6) for f, m in zip(found, middles))
    if kind == "sizes":
        return all(math.isclose(f, t, rel_tol=1e-3) for f, t in zip(found, truth))
    flat = [list(one) if isinstance(one, list) else [one] for one in (found, truth)] if kind == "list" else \
        [[value for one in each for value in one] for each in (found, truth)]
    return len(flat[0]) == len(flat[1]) and all(math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-18) for a, b in zip(*flat))


def trial(make, seed, folder):
    """One file: how it ended, and what is wrong with that; nothing wrong is an empty text."""
    chance = random.Random(f"{make.__name__} {seed}")
    made, (kind, truth) = make(chance)
    spoil = chance.random() < 0.5
    if isinstance(made, Table):
        if kind != "list":
            made = swapped(made, chance)
        if spoil:
            made = spoilt(kind, made, chance)
        lines = made.text(chance)
        if spoil and chance.random() < 0.1:
            lines = without_heading(lines, chance)
    else:
        lines = list(made)
        if spoil:
            wrong = ["12", "nm", "-5nm", "0um", "5s", "1e999m", "5 nm 7", "1,000nm", "x"]
            lines[chance.randrange(len(lines))] = chance.choice(wrong)
    path = os.path.join(folder, "spoilt.csv")
    with open(path, "wb") as file:
        file.write(encoded(lines, chance))
    try:
        found = found_value(kind, path, truth)
    except (ValueError, subprocess.TimeoutExpired) as error:
        return "fault", str(error), path
    if found is None:
        return ("refused", "", path) if spoil else ("fault", "a file with nothing wrong was refused", path)
    if not same(kind, found, truth):
        return "fault", f"gave {found}, not {truth}", path
    return "right", "", path


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200, help="files of each kind")
    parser.add_argument("--first", type=int, default=0, help="seed of the first file; the next has the next")
    parser.add_argument("--keep", default=".", metavar="FOLDER", help="where the files go that were misread")
    options = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    faults = 0
    for make in (sizes, diameters, spheres, log):
        ends = collections.Counter()
        with tempfile.TemporaryDirectory() as folder:
            for seed in range(options.first, options.first + options.count):
                end, problem, path = trial(make, seed, folder)
                ends[end] += 1
                if end == "fault":
                    faults += 1
                    kept = os.path.join(options.keep, f"{make.__name__}-{seed}.csv")
                    os.replace(path, kept)
                    print(f"{kept}: {problem}")
        print(f"{make.__name__}: {options.count} files, {ends['right']} right, {ends['refused']} refused, {ends['fault']} faults")
    return faults > 0


if __name__ == "__main__":
    sys.exit(main())
