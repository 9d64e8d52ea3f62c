"""test_homes.py: what Python has of its own beside the library says the same: units, schedules, densities, built-in materials."""
import json
import math
import os
import re
import subprocess
import tempfile
import unittest

import numpy
from in_process import ROOT, convert_common, kiln, program, saved

import convert_materials  # noqa: E402  (in_process says where they are)
import schedules  # noqa: E402
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

    def test_signs_of_units(self):
        """How signs are spelled, as the library spells them."""
        with open(os.path.join(ROOT, "lib", "io", "quantity.cpp"), encoding="utf-8") as file:
            pairs = re.findall(r'\{"([^"]+)", "([^"]*)"\}', file.read())
        told = tuple((sign.encode().decode("unicode_escape") if "\\u" in sign else sign, plain) for sign, plain in pairs)
        self.assertEqual(units.SPELLINGS, told)

    def test_schedules(self):
        """At each step that sinter made the temperature is that of the schedule; what it refuses is refused."""
        with tempfile.TemporaryDirectory() as folder:
            green, history = os.path.join(folder, "green.kiln"), os.path.join(folder, "history.jsonl")
            subprocess.run([program("SINTER"), "green", "-q", "-n", "20", "-o", green], check=True)
            for text in ("25C 10K/min 1150C 10min 20K/min 25C", "RT 600 C/h 1100\u00b0C 0.5h 1 K/s 800K",
                         "900C 1d", "1000 degC 5 min 5C/min 1050C"):
                subprocess.run([program("SINTER"), "-q", "--schedule", text, "--history", history, "-o", os.devnull, green],
                               check=True)
                with open(history, encoding="utf-8") as file:
                    steps = [json.loads(line) for line in file]
                time, kelvin = schedules.corners(text)
                for step in steps:
                    self.assertAlmostEqual(numpy.interp(step["time"], time, kelvin), step["temperature"],
                                           delta=1e-9 * step["temperature"])
                self.assertGreater(len(steps), 1, text)
            for text in ("", "25C", "10K/min 25C", "25C 10K/min", "25C 1200C", "25C 10K/min 10K/min 1200C", "25C -5min",
                         "25C 5 parsec"):
                with self.assertRaises(schedules.ScheduleError, msg=text):
                    schedules.corners(text)
                ended = subprocess.run([program("SINTER"), "-q", "--schedule", text, green], capture_output=True, check=False)
                self.assertEqual(ended.returncode, 2, text)

    def test_density_and_lengths(self):
        """Volumes, relative density and Eq. 4, on bonds that bondify made."""
        with tempfile.TemporaryDirectory() as folder:
            bonded = os.path.join(folder, "bonded.kiln")
            green = subprocess.run([program("SINTER"), "green", "-q", "-n", "60", "--method", "affine", "--compact-to", "0.6"],
                                   capture_output=True, check=True).stdout
            subprocess.run([program("BONDIFY"), "-q", "-o", bonded], input=green, check=True)
            (state, ) = kiln.read(bonded)
            said = json.loads(subprocess.run([program("ANALYZE"), "info", bonded], capture_output=True, check=True).stdout)
            self.assertAlmostEqual(kiln.relative_density(state), said["relative_density"], delta=1e-12)
            bonds = state["bonds"]
            length = convert_common.neck_length(state, bonds["pair"], bonds["image"], bonds["radius"])
            numpy.testing.assert_allclose(length, bonds["length"], rtol=0, atol=1e-20)
            del bonds["volume"]
            bare = saved(os.path.join(folder, "bare.kiln"), state)
            said = json.loads(subprocess.run([program("ANALYZE"), "info", bare], capture_output=True, check=True).stdout)
            self.assertAlmostEqual(kiln.relative_density(state), said["relative_density"], delta=1e-12)

    def test_built_in_materials(self):
        for name, material in convert_materials.BUILT_IN.items():
            made = subprocess.run([program("SINTER"), "green", "-q", "-n", "8", "--material", name, "--text"],
                                  capture_output=True, check=True)
            self.assertEqual(json.loads(made.stdout)["materials"], [material])
        listed = subprocess.run([program("ANALYZE"), "materials"], capture_output=True, check=True).stdout.splitlines()
        self.assertEqual({json.loads(line)["name"] for line in listed}, set(convert_materials.BUILT_IN))


if __name__ == "__main__":
    unittest.main()
