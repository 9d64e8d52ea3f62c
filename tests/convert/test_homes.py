"""test_homes.py: what Python has of its own beside the library says the same: units, built-in materials."""
import json
import math
import os
import re
import subprocess
import unittest

from in_process import ROOT

import convert_materials  # noqa: E402  (in_process says where they are)
import units  # noqa: E402


def units_of_the_library():
    """Factor, divisor and offset by dimension and name, from the table of lib/io/quantity.cpp."""
    with open(os.path.join(ROOT, "lib", "io", "quantity.cpp"), encoding="utf-8") as file:
        text = file.read()
    words = {"zero_celsius": units.ZERO_CELSIUS, "std::numbers::pi": math.pi}
    table = {}
    for dimension, name, numbers in re.findall(r'\{Dimension::(\w+), "([^"]+)", ([^}]*)\}', text):
        values = [words[each] if each in words else float(each) for each in numbers.split(", ")]
        table.setdefault(dimension, {})[name] = (*values, *(1.0, 0.0)[len(values) - 1:])
    assert sum(map(len, table.values())) > 40, "the table of units was not found"
    return table


class Homes(unittest.TestCase):

    def test_one_table_of_units(self):
        library = units_of_the_library()
        for dimension, names in library.items():
            for name, scale in names.items():
                self.assertEqual(units.scale_of(name, dimension), scale, f"{dimension} {name}")
        for dimension, names in units.TABLE.items():
            self.assertEqual(sorted(set(names) - set(library[dimension])), [], dimension)

    def test_styles_of_lammps(self):
        """By the units of mass, length and time of each style: kg/m3, N, Pa, m/s, N m that one unit is."""
        columns = ("density", "fx", "pressure", "vx", "torque")
        for style, wanted in (("cgs", (3, -5, -1, -2, -7)), ("micro", (3, -9, 3, 0, -15)), ("nano", (6, -12, 6, 0, -21))):
            self.assertEqual(tuple(units.power(style, name) for name in columns), wanted)
        for text in ("1", "0.1", "123.456e-7", "4.9406564584124654e-324", "1.7976931348623157e308"):
            for power in (-21, -6, 0, 3):
                value = float(text)
                self.assertEqual(units.shifted(units.shown(value, power), power), value)

    def test_built_in_materials(self):
        program = os.environ.get("SINTER", os.path.join(ROOT, "build", "bin", "sinter"))
        for name, material in convert_materials.BUILT_IN.items():
            made = subprocess.run([program, "green", "-q", "-n", "8", "--material", name, "--text"],
                                  capture_output=True, check=True)
            self.assertEqual(json.loads(made.stdout)["materials"], [material])


if __name__ == "__main__":
    unittest.main()
