"""tables.py: the one reader of tables with headings: CSV as laboratories and spreadsheets write it, and lists parted by blanks.

Columns are parted by semicolons, tabs, commas or blanks, whichever the heading has first in this order. A heading is a name and
perhaps a unit: "x (um)", "X [µm]", "x/um", "radius_um"; in the line below it, units may stand alone. With commas in numbers they
are decimal commas, unless another number has a point. Lines that begin with # are remarks; the last one above the numbers may be
the heading (numpy.savetxt). Other lines above the heading are the report of an instrument and are left out."""
import csv
import re

import units
from convert_common import NUMBER, ConvertError, clipped, lines, numbers, warn

SAME = {"r": "radius", "rad": "radius", "radii": "radius", "d": "diameter", "dia": "diameter", "matid": "material",
        "type": "material",
        "identifier": "id"}
PLAIN = set(units.DIMENSION) | set(SAME)  # names that are read in capitals too
DECIMAL_COMMA = re.compile(r"[-+]?[0-9]+,[0-9]+(?:[eE][-+]?[0-9]+)?|[-+]?,[0-9]+")
HEADINGS_BY_BLANKS = re.compile(r"\S+(?:\s*[(\[][^)\]]*[)\]])?")
YADE = re.compile(r"format\s+(\S+)")
SKIPPED = ("", "-", "_")  # names by which --columns leaves a column out
EXTENT = ("x", "y", "z", "radius", "diameter")


def separator_of(line):
    for sign in ";\t":
        if sign in line:
            return sign
    parts = line.split()
    if len(parts) > 1 and all(DECIMAL_COMMA.fullmatch(part) or NUMBER.fullmatch(part) for part in parts):
        return " "
    return "," if "," in line else " "


def cells_of(line, separator, place):
    if separator == " ":
        return line.split()
    try:
        (cells,) = csv.reader([line], delimiter=separator, strict=True)
    except (csv.Error, ValueError):
        raise ConvertError(f"{place}: a quotation mark is open or out of place") from None
    return [cell.strip() for cell in cells]


def headings_of(line, separator, place):
    """The headings of a line; blanks part them only outside of brackets."""
    return HEADINGS_BY_BLANKS.findall(line) if separator == " " else cells_of(line, separator, place)


def name_and_unit(heading):
    """The name and the unit of a heading; None for one without a unit."""
    found = re.fullmatch(r"(.*?)\s*(?:\(([^()]*)\)|\[(?![0-9]+\])([^\[\]]*)\])", heading)
    found = found and (None, found[1], found[2] if found[2] is not None else found[3])
    if not found:
        found = re.fullmatch(r"(.*?)\s*/\s*(\S+)|([a-zA-Z ]+)_([^_]+)", heading)
        if found:
            name, unit = (found[1], found[2]) if found[2] else (found[3], found[4])
            dimension = units.DIMENSION.get(SAME.get(name.lower(), name.lower()))
            found = (None, name, unit) if dimension and units.scale_of(unit, dimension) else None
    name, unit = (found[1], found[2]) if found else (heading, None)
    name = name.strip()
    plain = SAME.get(name.lower(), name.lower())
    return (plain if units.stem(name).lower() in PLAIN else name), unit


class Table:
    """Columns of a file by name, as texts with the lines they stand in."""

    def __init__(self, path, columns=None, wanted=()):
        """columns: names in place of those of the file. wanted: names that the heading has; other lines above it are a report."""
        self.path, self.remarks, self.names, self.units, self.rows, self.at = path, [], None, None, [], []
        self.yade = False  # a list of the program of that name, which has SI units
        self.wanted, self.separator, self.above = set(wanted), None, None
        self.told = bool(columns)
        if columns:
            self.take_headings([name.strip() for name in columns])
        for row, line in lines(path, latin=True):
            if line.startswith("#"):
                self.remarks.append(line[1:].strip())
            elif row == 1 and re.fullmatch(r"sep=.", line.strip()):
                self.separator = line.strip()[-1]  # what a spreadsheet says to another one
            elif line.strip(" \t;,"):
                self.take(line, row)
        if self.names is None:
            self.refuse_headings()
        self.turn_decimal_commas()

    def take(self, line, row):
        """A line that is neither blank nor a remark."""
        place, separator = f"{self.path}, line {row}", self.separator or separator_of(line)
        if self.names is None and not self.begins_here(line, separator, place):
            self.take_heading_line(headings_of(line, separator, place), separator, row)
            return
        self.separator = separator
        cells = cells_of(line, separator, place)
        if not self.rows and self.told and not any(map(self.is_number, cells)):
            return  # headings, in place of which --columns holds
        if not self.rows and self.are_units(cells):
            self.units = [unit or (None if cell in SKIPPED else cell.strip("()[]")) for unit, cell in zip(self.units, cells)]
            return
        while len(cells) > len(self.names) and not cells[-1]:
            cells.pop()
        if len(cells) != len(self.names):
            raise ConvertError(f"{place}: has {len(cells)} columns, expected {len(self.names)}: "
                               f"{', '.join(clipped(name) for name in self.names)}")
        self.rows.append(cells)
        self.at.append(row)

    def take_heading_line(self, headings, separator, row):
        if not self.wanted <= {name_and_unit(heading)[0] for heading in headings}:
            self.above = self.above or headings
            return
        if self.above:
            warn(f"{self.path}: what stands above the heading in line {row} is left out")
        self.take_headings(headings)
        self.separator = separator

    def refuse_headings(self):
        if self.above is None:
            raise ConvertError(f"{self.path}: is empty")
        names = [name_and_unit(heading)[0] for heading in self.above]
        missing = sorted(self.wanted - set(names))[0]
        raise ConvertError(f"{self.path}: has no column {missing}, only {', '.join(map(clipped, names))}; --columns names them in "
                           "their "
                           "order")

    @staticmethod
    def is_number(cell):
        return bool(NUMBER.fullmatch(cell) or DECIMAL_COMMA.fullmatch(cell))

    def begins_here(self, line, separator, place):
        """True if the numbers begin without a heading, after a remark that is one."""
        cells = line.split() if separator == " " else cells_of(line, separator, place)
        plain = all(self.is_number(cell) for cell in cells if cell) and any(cells)
        named = {name_and_unit(heading)[0] for heading in headings_of(line, separator, place)}
        if not plain and self.wanted <= named:
            return False
        for remark in reversed(self.remarks):
            yade = YADE.fullmatch(remark)
            headings = yade[1].split("_") if yade else headings_of(remark.replace('"', ""), separator, self.path)
            known = {name_and_unit(heading)[0] for heading in headings}
            if len(headings) == len(cells) and self.wanted and self.wanted <= known:
                self.take_headings(headings)
                self.yade = yade is not None
                return True
        if not plain:
            return False
        if self.above:
            self.refuse_headings()
        raise ConvertError(f"{self.path}: has {len(cells)} columns without headings; --columns names them, such as "
                           "--columns \"x (um),y (um),z (um),radius (um)\", and _ for one to leave out")

    def take_headings(self, headings):
        while len(headings) > 1 and not headings[-1]:
            headings.pop()
        self.names, self.units = map(list, zip(*map(name_and_unit, headings)))
        for k, name in enumerate(self.names):
            if name not in SKIPPED and name in self.names[:k]:
                raise ConvertError(f"{self.path}: the column '{clipped(name)}' stands twice")

    def are_units(self, cells):
        """True for a line of units below the heading."""
        plain = [cell.strip("()[]") for cell in cells]
        return (len(cells) == len(self.names) and any(plain) and
                all(cell in SKIPPED or units.scale_of(cell) for cell in plain) and not any(map(self.is_number, cells)))

    def turn_decimal_commas(self):
        comma = next(((at, cell) for at, row in zip(self.at, self.rows) for cell in row if "," in cell and cell[-1].isdigit()),
                     None)
        if comma is None:
            return
        point = next(((at, cell) for at, row in zip(self.at, self.rows) for cell in row if "." in cell and NUMBER.fullmatch(cell)),
                     None)
        if point:
            raise ConvertError(f"{self.path}, line {comma[0]}: '{clipped(comma[1])}' has a comma and line {point[0]} has a point, "
                               f"'{clipped(point[1])}'; which of them is decimal is not known")
        self.rows = [[cell.replace(",", ".") if DECIMAL_COMMA.fullmatch(cell) else cell for cell in row] for row in self.rows]

    @property
    def places(self):
        """The place of each row, for messages."""
        return [f"{self.path}, line {row}" for row in self.at]

    def index(self, name):
        if name not in self.names:
            raise ConvertError(f"{self.path}: has no column {name}, only {', '.join(map(clipped, self.names))}")
        return self.names.index(name)

    def texts(self, name):
        k = self.index(name)
        return [row[k] for row in self.rows]

    def is_text(self, name):
        texts = self.texts(name)
        return bool(texts) and not any(NUMBER.fullmatch(text) for text in texts)

    def values(self, name, system=None):
        """The numbers of a column in SI units. A unit that is missing where one has to be comes from the style of units."""
        unit, dimension, power = self.units[self.index(name)], units.DIMENSION.get(units.stem(name)), 0
        if unit:
            scale = units.scale_of(unit, dimension if dimension in units.TABLE or dimension in units.COLUMNS_ONLY else None)
            if scale is None:
                raise ConvertError(f"{self.path}: column '{clipped(name)}' has the unit '{clipped(unit)}'" +
                                   (f", which is none of {dimension.replace('_', ' ')}; known here: {units.known(dimension)}"
                                    if dimension else ", which is not known here"))
        elif dimension not in (None, "number"):
            if system:
                power = units.power(system, name)
            elif self.yade:
                warn(f"{self.path}: does not say its units; its numbers are taken for metres, --units micro and so on say "
                     "otherwise")
            elif units.stem(name) in (*EXTENT, "length", "volume"):
                raise ConvertError(f"{self.path}: column '{clipped(name)}' has no unit of {dimension}; known here: "
                                   f"{units.known(dimension)}, as in '{name} ({list(units.TABLE[dimension])[0]})'; --units is for "
                                   "all columns")
            else:
                warn(f"{self.path}: column '{clipped(name)}' has no unit; its numbers are taken to be in SI units")
        values = numbers(self.texts(name), self.places, power)
        return values * scale[0] / scale[1] + scale[2] if unit else values

    def others(self, known, system=None):
        """All columns of numbers beside the known ones, by name."""
        columns = {}
        for name in self.names:
            if name in known or name in SKIPPED:
                continue
            if self.is_text(name) and units.stem(name) not in units.DIMENSION:
                warn(f"{self.path}: the column '{clipped(name)}' holds no numbers and is left out")
            else:
                columns[name] = self.values(name, system)
        return columns
