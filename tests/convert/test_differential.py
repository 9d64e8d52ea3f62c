"""test_differential.py: the same packing through every format and back, in every style of units: equal, to the last bit, where the
format holds it, and a warning where it does not."""
import itertools
import tempfile
import unittest

import numpy
from in_process import GLASS, STEEL, convert, converted, kiln, packing, saved

BODIES = {"periodic": (True, True, True), "free": (False, False, False), "film": (True, True, False)}
# What each format holds of: temperature, contacts, constants of materials, bonds, arrays that nobody knows of particles and bonds.
HOLDS = {
    "jsonl": {"temperature", "contacts", "constants", "bonds", "particles", "of bonds", "history"},
    "csv": {"temperature", "contacts", "constants", "bonds", "particles", "of bonds"},
    "dump": {"bonds", "particles", "of bonds"},
    "data": {"bonds"},
    "xyz": {"particles"},
    "vtu": {"bonds", "particles", "of bonds"},
}
STYLES = {"dump": ("si", "cgs", "micro", "nano"), "data": ("si", "cgs", "micro", "nano"), "xyz": ("si", "cgs", "micro", "nano")}
OPTIONS = [(name, style) for name in HOLDS for style in STYLES.get(name, (None, ))]


def same_arrays(case, back, state, names, group):
    for name in names:
        values = state[group][name]
        got = back[group][name]
        numpy.testing.assert_array_equal(numpy.reshape(got, numpy.shape(values)), values, err_msg=f"{case}: {group}.{name}")


class Differential(unittest.TestCase):

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return f"{self.folder.name}/{name}"

    def compare(self, case, name, back, state, like):
        holds = HOLDS[name]
        self.assertEqual(back["time"], state["time"], case)
        for key in ("origin", "vectors", "periodic"):
            self.assertEqual(back["box"][key], state["box"][key], f"{case}: box.{key}")
        named = [back["materials"][kind]["name"] for kind in back["particles"]["material"]]
        names = [state["materials"][kind]["name"] for kind in state["particles"]["material"]]
        if like or "constants" in holds:
            self.assertEqual(back["materials"], state["materials"], case)
            self.assertEqual(named, names, case)
            self.assertEqual(back["contacts"], state["contacts"], case)
            self.assertEqual(back["temperature"], state["temperature"], case)
        elif name in ("xyz", "dump"):  # in which blanks part words
            self.assertEqual(named, [each.replace(" ", "_") for each in names], case)
        elif name == "vtu":
            self.assertEqual(named, [f"material{kind}" for kind in state["particles"]["material"]], case)
        else:
            self.assertEqual(named, names, case)
        other = ("velocity", "grain_number", "fabric") if "particles" in holds else ()
        same_arrays(case, back, state, ("id", "position", "radius", *other), "particles")
        self.assertEqual("bonds" in back, "bonds" in holds and "bonds" in state, case)
        if "bonds" in back:
            other = ("force", "broken") if "of bonds" in holds else ()
            same_arrays(case, back, state, ("pair", "image", "radius", "length", "volume", *other), "bonds")

    def test_every_format_in_every_style_of_units(self):
        for (name, style), (body, periodic), bonded in itertools.product(OPTIONS, BODIES.items(), (True, False)):
            for like in (False, True):
                case = f"{name} {style} {body} {'bonded' if bonded else 'bare'} {'like' if like else ''}"
                state = packing(periodic, bonded)
                source, target = saved(self.path("state.kiln"), state), self.path(f"file.{name}")
                status, warnings, error = convert(*(("--units", style) if style else ()), source, target)
                self.assertEqual((status, error), (0, ""), case)
                self.check_warnings(case, name, bonded, warnings)
                (back, ), _ = converted(target, *(("--like", source) if like else ()))
                self.compare(case, name, back, state, like)

    def check_warnings(self, case, name, bonded, warnings):
        """All that is lost, and nothing else, stands in one warning."""
        lost = [each for each in warnings if "does not hold" in each]
        words = {"temperature": "temperature", "contacts": "contacts", "constants": "the constants of materials"}
        wanted = [word for key, word in words.items() if key not in HOLDS[name]]
        wanted += [] if "bonds" in HOLDS[name] or not bonded else ["bonds"]
        wanted += [] if "particles" in HOLDS[name] else ["particles.velocity", "particles.grain_number", "particles.fabric"]
        wanted += [] if "of bonds" in HOLDS[name] or "bonds" not in HOLDS[name] or not bonded else ["bonds.force", "bonds.broken"]
        self.assertEqual(len(lost), 1 if wanted else 0, f"{case}: {warnings}")
        if wanted:
            said = lost[0].split("does not hold ")[1].split(";")[0].split(", ")
            self.assertEqual(sorted(said), sorted(wanted), case)

    def test_numbers_in_the_file_are_those_of_the_style(self):
        """micro is um, us, pg: 2.5 g/cm3 is 2.5; nano is nm, ns, ag: 0.0025."""
        state = packing()
        source = saved(self.path("state.kiln"), state)
        for style, length, density, speed, force in (("si", 1.0, 2500.0, 1.0, 1.0), ("cgs", 1e-2, 2.5, 1e-2, 1e-5),
                                                     ("micro", 1e-6, 2.5, 1.0, 1e-9), ("nano", 1e-9, 2.5e-3, 1.0, 1e-12)):
            convert("--units", style, source, self.path("file.data"))
            with open(self.path("file.data"), encoding="utf-8") as file:
                rows = [line.split() for line in file]
            atom = next(row for row in rows if row and row[0] == "8" and len(row) == 8)  # id 7, raised by 1
            numpy.testing.assert_allclose([float(atom[3]), float(atom[4]), float(atom[5])],
                                          [2 * state["particles"]["radius"][0] / length, density,
                                           state["particles"]["position"][0, 0] / length], rtol=1e-15)
            convert("--units", style, source, self.path("file.dump"))
            with open(self.path("file.dump"), encoding="utf-8") as file:
                lines = file.read().split("\n")
            names = next(line for line in lines if line.startswith("ITEM: ATOMS")).split()[2:]
            row = dict(zip(names, next(line for line in lines if line.startswith("7 1 lead_glass")).split()))
            numpy.testing.assert_allclose([float(row["x"]), float(row["velocity[1]"]), float(row["fabric[4]"])],
                                          [state["particles"]["position"][0, 0] / length,
                                           state["particles"]["velocity"][0, 1] / speed,
                                           state["particles"]["fabric"][0, 1, 1]], rtol=1e-15)
            with open(self.path("file.bonds.dump"), encoding="utf-8") as file:
                lines = file.read().split("\n")
            names = next(line for line in lines if line.startswith("ITEM: ENTRIES")).split()[2:]
            row = dict(zip(names, lines[lines.index("ITEM: ENTRIES " + " ".join(names)) + 1].split()))
            numpy.testing.assert_allclose([float(row["volume"]), float(row["force[2]"])],
                                          [state["bonds"]["volume"][0] / length**3, state["bonds"]["force"][0, 2] / force],
                                          rtol=1e-15)

    def test_nothing_in_it(self):
        """No particles, or no bonds in a list of bonds, comes back as that."""
        empty = packing()
        empty["particles"] = {name: values[:0] for name, values in empty["particles"].items()}
        empty["bonds"] = {name: values[:0] for name, values in empty["bonds"].items()}
        loose = packing()
        loose["bonds"] = {name: values[:0] for name, values in loose["bonds"].items()}
        for (name, style), (what, state) in itertools.product(OPTIONS, (("no particles", empty), ("no bonds", loose))):
            source, target = saved(self.path("state.kiln"), state), self.path(f"file.{name}")
            status, _, error = convert(*(("--units", style) if style else ()), source, target)
            self.assertEqual((status, error), (0, ""), f"{name} {what}")
            (back, ), _ = converted(target, "--like", source)
            self.assertEqual(len(back["particles"]["radius"]), len(state["particles"]["radius"]), f"{name} {what}")
            if "bonds" in HOLDS[name]:
                self.assertEqual(len(back["bonds"]["radius"]), 0, f"{name} {what}")

    def test_series(self):
        """Several states of one body, the second with bonds, in one file or in numbered ones."""
        states = [packing(bonded=False), packing(), packing(seed=2)]
        for row, state in enumerate(states):
            state["time"] = 0.5 + row
        source = saved(self.path("states.kiln"), *states)
        for name, style in (("jsonl", None), ("dump", "micro"), ("xyz", "nano"), ("pvd", None)):
            status, _, error = convert(*(("--units", style) if style else ()), source, self.path(f"many.{name}"))
            self.assertEqual((status, error), (0, ""), name)
            back, _ = converted(self.path(f"many.{name}"), "--like", source)
            self.assertEqual(len(back), 3, name)
            for one, state in zip(back, states):
                self.compare(name, "vtu" if name == "pvd" else name, one, state, True)
        for name in ("data", "csv"):
            status, _, error = convert(source, self.path(f"many.{name}"))
            self.assertEqual((status, error), (0, ""), name)
            for row, state in enumerate(states, start=1):
                (back, ), _ = converted(self.path(f"many-{row:04d}.{name}"), "--like", source)
                self.compare(name, name, back, state, True)

    def test_by_way_of_all_formats(self):
        """From each format into the next one, with --like: what all of them hold is still there at the end."""
        state = packing(BODIES["film"])
        first = saved(self.path("state.kiln"), state)
        source, likes = first, ("--like", first)
        for step, (name, style) in enumerate((("data", "nano"), ("csv", None), ("dump", "cgs"), ("vtu", None), ("data", "micro"),
                                              ("jsonl", None))):
            between, target = self.path(f"step{step}.kiln"), self.path(f"step{step}.{name}")
            for arguments in ((*likes, source, between) if source != first else (source, between),
                              (*(("--units", style) if style else ()), between, target)):
                status, _, error = convert(*arguments)
                self.assertEqual((status, error), (0, ""), name)
            source = target
        (back, ) = kiln.read(source)
        self.compare("chain", "data", back, state, True)

    def test_without_a_title_the_state_itself_lends_the_rest(self):
        """As LAMMPS' write_data leaves it: no remarks, rows in another order, periodic flags and sizes of bonds from --like."""
        for body, periodic in BODIES.items():
            state = packing(periodic)
            source = saved(self.path("state.kiln"), state)
            convert("--units", "micro", source, self.path("file.data"))
            with open(self.path("file.data"), encoding="utf-8") as file:
                lines = [line.partition("#")[0].rstrip() for line in file][1:]
            begin, end = lines.index("Atoms") + 2, lines.index("Bonds") - 1
            lines[begin:end] = lines[begin:end][::-1]
            text = "LAMMPS data file via write_data, version 29 Aug 2024, timestep = 7, units = micro\n" + "\n".join(lines) + "\n"
            with open(self.path("relaxed.data"), "w", encoding="utf-8") as file:
                file.write(text)
            (back, ), _ = converted(self.path("relaxed.data"), "--like", source, "--time-step", "2us", "--atom-style", "bpm/sphere")
            self.assertEqual(back["time"], 14e-6)
            self.assertEqual(back["box"]["periodic"], list(periodic), body)
            order = [back["particles"]["id"].tolist().index(each) for each in (state["particles"]["id"] + 1).tolist()]
            numpy.testing.assert_array_equal(back["particles"]["position"][order], state["particles"]["position"])
            numpy.testing.assert_array_equal(back["particles"]["material"][order], state["particles"]["material"])
            for name in ("image", "radius", "length", "volume"):
                numpy.testing.assert_array_equal(back["bonds"][name], state["bonds"][name], err_msg=f"{body} {name}")
            self.assertEqual([material["name"] for material in back["materials"]], [GLASS["name"], STEEL["name"]])


if __name__ == "__main__":
    unittest.main()
