"""test_cases.py: files as users have them, and the right value of each or the sentence that refuses it: one kind a test, in every
format that has it."""
import gzip
import json
import os
import subprocess
import tempfile
import unittest

import numpy
from in_process import ROOT, convert, converted, packing, program, refused, saved, written

TITLE = "LAMMPS data file via write_data, version 29 Aug 2024, timestep = 1200, units = micro"
BOX = "0 4 xlo xhi\n0 4 ylo yhi\n0 4 zlo zhi\n"
ATOMS = "1 1 1.0 3.95 1.0 2.0 2.0 0 0 0\n2 1 1.0 3.95 1.98 2.0 2.0 0 0 0\n"


def data(title=TITLE, header="2 atoms\n1 atom types\n", box=BOX, style="Atoms # sphere", atoms=ATOMS, more=""):
    return f"{title}\n\n{header}\n{box}\n{style}\n\n{atoms}{more}"


def bonded(bonds, announced=2, title="# by dem-convert: units micro, boundary p p p, time 0.0 s"):
    atoms = "1 1 1 1 3.95 1 2 2\n2 1 1 1 3.95 1.95 2 2\n3 1 1 1 3.95 2.9 2 2\n"
    return data(title, f"3 atoms\n1 atom types\n{announced} bonds\n1 bond types\n", style="Atoms # bpm/sphere", atoms=atoms,
                more=f"\nBonds\n\n{bonds}")


def dump(rows, columns, step=0, flags=" pp pp pp", above="", bounds="0 4\n0 4\n0 4\n", kind="ATOMS"):
    rows = [row for row in rows.split("\n") if row]
    return (f"{above}ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF {kind}\n{len(rows)}\nITEM: BOX BOUNDS{flags}\n{bounds}"
            f"ITEM: {kind} {columns}\n" + "".join(f"{row}\n" for row in rows))


def xyz(comment, rows="Al 1 2 2 0.5\nAl 1.95 2 2 0.5\n"):
    return f"{rows.count(chr(10))}\n{comment}\n{rows}"


LATTICE = 'Lattice="4 0 0 0 4 0 0 0 4" Properties=species:S:1:pos:R:3:radius:R:1'
TABLE = "id,x (um),y (um),z (um),radius (um)\n3,0.5,0.5,0.5,0.5\n0,1.4,0.5,0.5,0.5\n1,2.3,0.5,0.5,0.5\n"
MUSEN = """0 1 1 1 5 0.0005 0.0005 23 KEY 24 0 1e+300 2 0 12 0 0 0.001 15 0 0 0 20 0 0 0 31 1 0 0 0
0 2 1 1 5 0.0005 0.0005 23 KEY 24 0 1e+300 2 0 12 0.0009 0 0.001 15 0 0 0 20 0 0 0 31 1 0 0 0
0 3 1 9 5 1 2 0.0002 0.0009 23 KEY 24 0 1e+300 2 0
22 -0.002 -0.002 -0.002 0.002 0.002 0.002
28 0 0 0 0 0 0 0 0 0 0
32 KEY Lead glass 0 2500 2 1e+40 7 5e+10 8 5e+07 9 5e+07 10 0.22
"""


class Cases(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def file(self, name, text):
        return written(os.path.join(self.folder, name), text)

    def one(self, name, text, *options):
        (state, ), self.warnings = converted(self.file(name, text), *options)
        return state

    def no(self, name, text, *options, says):
        self.assertIn(says, refused(self.file(name, text), *options))

    def near(self, found, wanted):
        numpy.testing.assert_allclose(found, wanted, rtol=1e-14)

    # ---- units -----------------------------------------------------------------------------------------------------------------
    def test_units_that_a_file_says(self):
        """As LAMMPS writes them, as people do; styles without metres, and --units against the file, are refused in all formats."""
        for title in (TITLE, TITLE.replace(" =", ""), "a box, units micro"):
            state = self.one("a.data", data(title))
            self.near(state["particles"]["radius"], [5e-7, 5e-7])
            self.near(state["box"]["vectors"][0][0], 4e-6)
            self.near(state["materials"][0]["density"], 3950.0)
        for style in ("real", "lj", "metal", "electron"):
            self.no("a.data", data(TITLE.replace("micro", style)), says=f"units {style} have no length in metres")
            self.no("a.dump", dump("1 1 1 2 2 0.5", "id type x y z radius", above=f"ITEM: UNITS\n{style}\n"),
                    says="no length in metres")
        self.no("a.data", data(), "--units", "si", says="--units si is against what the file says, micro")
        rows, columns = "1 1 1 2 2 0.5\n2 1 1.98 2 2 0.5", "id type x y z radius"
        two = (dump(rows, columns, 100, above="ITEM: UNITS\nmicro\nITEM: TIME\n2.5\n") + dump(rows, columns, 200,
                                                                                              above="ITEM: TIME\n5.0\n"))
        states, _ = converted(self.file("a.dump", two))  # LAMMPS says the units once
        self.near([state["time"] for state in states], [2.5e-6, 5e-6])
        for state in states:
            self.near(state["box"]["vectors"][2][2], 4e-6)
            self.near(state["particles"]["position"][1], [1.98e-6, 2e-6, 2e-6])
        self.no("a.dump", two, "--units", "nano", says="--units nano is against what the file says, micro")
        self.no("a.xyz", xyz(LATTICE + " Units=micro"), "--units", "nano", says="--units nano is against what the file says, micro")

    def test_units_by_option(self):
        """--units holds for every format that has numbers without units; what a file says or cannot need is refused."""
        length = {"si": 1.0, "cgs": 1e-2, "micro": 1e-6, "nano": 1e-9}
        for style, metre in length.items():
            inputs = (("a.xyz", xyz(LATTICE)), ("a.data", data("a title")), ("a.csv", "x,y,z,r\n1,2,2,0.5\n1.95,2,2,0.5\n"),
                      ("a.dump", dump("1 1 1 2 2 0.5\n2 1 1.98 2 2 0.5", "id type x y z radius")))
            for name, text in inputs:
                state = self.one(name, text, "--units", style)
                self.near(state["particles"]["radius"], [0.5 * metre] * 2)
                self.near(state["particles"]["position"][0], [1 * metre, 2 * metre, 2 * metre])
                self.assertFalse([each for each in self.warnings if "does not say its units" in each])
        self.no("a.csv", TABLE, "--units", "nano", says="all columns have units")
        self.no("a.txt", MUSEN, "--units", "nano", says="has an effect only")
        for name, text in inputs[:2] + inputs[3:]:
            self.one(name, text)
            self.assertTrue([each for each in self.warnings if "does not say its units" in each], name)
        self.no(*inputs[2], says="column 'x' has no unit of length; known here: m, cm, mm, um, nm")

    def test_every_column_of_a_dump_has_its_unit(self):
        """Velocities, forces, moments, masses, stresses: all columns that LAMMPS has a unit for."""
        columns = "id type x y z radius vx omegax fx tqx mass pressure xs ix c_1[1]"
        state = self.one("a.dump", dump("1 1 1 2 2 0.5 3 4 5 6 7 8 0.25 1 9.5", columns, above="ITEM: UNITS\nmicro\n"))
        particles = state["particles"]
        self.near([particles[name][0] for name in ("vx", "omegax", "fx", "tqx", "mass", "pressure", "ix", "c_1[1]")],
                  [3.0, 4e6, 5e-9, 6e-15, 7e-15, 8e3, 1, 9.5])
        self.assertTrue([each for each in self.warnings if "the unit of the column c_1[1] is not known" in each])
        self.assertNotIn("xs", particles)

    def test_density_is_written_in_the_units_of_the_file(self):
        source = saved(os.path.join(self.folder, "state.kiln"), packing())
        for style, shown in (("si", "2500.0"), ("micro", "2.5000"), ("cgs", "2.5000"), ("nano", "0.0025000")):
            target = os.path.join(self.folder, "out.data")
            self.assertEqual(convert("--units", style, source, target)[0], 0)
            with open(target, encoding="utf-8") as file:
                row = next(line for line in file.read().split("\n\n") if line.startswith("8 1 1 ")).split("\n")[0].split()
            self.assertEqual(float(row[4]), float(shown), style)
        bare = packing()
        del bare["materials"][1]["density"]
        source = saved(os.path.join(self.folder, "bare.kiln"), bare)
        status, _, error = convert(source, os.path.join(self.folder, "bare.data"))
        self.assertEqual((status, "material 'steel' has no density" in error), (1, True))

    def test_units_of_tables(self):
        """Every column with a unit is converted, in all manners of writing it; an unknown one is refused on any column."""
        bonds = "id1,id2,radius (um),length (nm),volume (um3),normal_force (kN)\n0,1,0.1,100,0.00314159,2\n"
        for heading in ("x (um),y [um],z/um,radius_um", "X (um),Y (um),Z (um),Radius (\u00b5m)",
                        "x [\u03bcm],y [um],z [um],r [um]"):
            self.file("g.bonds.csv", bonds)
            state = self.one("g.csv", f"id,{heading},velocity (mm/s),T (C)\n0,0.5,0.5,0.5,0.5,3,20\n1,1.6,0.5,0.5,0.5,-3,20\n")
            self.near(state["particles"]["radius"], [5e-7, 5e-7])
            self.near(state["particles"]["velocity"], [3e-3, -3e-3])
            self.near(state["particles"]["T"], [293.15, 293.15])
            self.near([state["bonds"][name][0] for name in ("radius", "length", "volume", "normal_force")],
                      [1e-7, 1e-7, 3.14159e-21, 2e3])
        self.no("g.csv", "x (um),y (um),z (um),r (um),velocity (furlong/s)\n1,1,1,1,1\n", says="has the unit 'furlong/s'")
        self.no("g.csv", "x (um),y (um),z (um),r (um),phase (a)\n1,1,1,1,1\n", says="has the unit 'a'")
        self.no("g.csv", "x (um),y (um),z (s),r (um)\n1,1,1,1\n", says="column 'z' has the unit 's', which is none of length")
        self.file("g.bonds.csv", "id1,id2,radius (um),volume (um2)\n0,1,0.1,1\n")
        self.no("g.csv", TABLE, says="which is none of volume")
        self.file("g.bonds.csv", "id1,id2,radius (um),volume\n0,1,0.1,1\n")
        self.no("g.csv", TABLE, says="column 'volume' has no unit of volume")

    # ---- materials -------------------------------------------------------------------------------------------------------------
    def test_materials_are_matched_by_name(self):
        """By the names of elements and species in every format; a name that is not there is refused."""
        like = packing(bonded=False)
        like["materials"] = [{"name": "Al", "young_modulus": 4e11}, {"name": "Zr", "young_modulus": 2e11}]
        del like["contacts"]
        source = saved(os.path.join(self.folder, "like.kiln"), like)
        inputs = (("a.dump", dump("1 Zr 1 2 2 0.5\n2 Al 1.95 2 2 0.5", "id element x y z radius")),
                  ("a.xyz", xyz(LATTICE, "Zr 1 2 2 0.5\nAl 1.95 2 2 0.5\n")),
                  ("a.csv", "x (m),y (m),z (m),r (m),material\n1,2,2,0.5,Zr\n1.95,2,2,0.5,Al\n"),
                  ("a.data", data(header="2 atoms\n2 atom types\n", more="\nAtom Type Labels\n\n1 Zr\n2 Al\n",
                                  atoms="1 Zr 1 3.95 1 2 2\n2 2 1 6 1.95 2 2\n")),
                  ("a.txt", MUSEN.replace(" 23 KEY", " 23 Zr", 1).replace("23 KEY", "23 A").replace("KEY Lead glass", "A Al")))
        for name, text in inputs:
            state = self.one(name, text, "--like", source)
            self.assertEqual(state["particles"]["material"].tolist(), [1, 0], name)
            self.assertEqual([material.get("young_modulus") for material in state["materials"]], [4e11, 2e11], name)
            self.no(name, text.replace("Zr", "Ti"), "--like", source, says="material 'Ti' is not one of")
            state = self.one(name, text)  # without --like they keep their names
            self.assertEqual([state["materials"][kind]["name"] for kind in state["particles"]["material"]], ["Zr", "Al"], name)
            self.assertTrue([each for each in self.warnings if "no constants" in each], name)
            state = self.one(name, text, "--material", "Zr=alumina", "--material", "Al=alumina-dihedral")
            self.assertEqual([state["materials"][kind]["name"] for kind in state["particles"]["material"]],
                             ["alumina", "alumina-dihedral"])
            self.no(name, text, "--material", "Zr=alumina", says="--material says nothing of 'Al'")
            self.no(name, text, "--material", "alumina", says="give --material")
            self.one(name, text, "--material", "Zr=alumina,Al=alumina-dihedral")

    def test_materials_by_number(self):
        """Types are counted as --like has them; without it they are type1 and type2 with the densities of the file."""
        atoms = "1 2 1.0 3.95 1.0 2.0 2.0\n2 1 1.0 5.68 1.98 2.0 2.0\n"
        text = data(header="2 atoms\n2 atom types\n", atoms=atoms)
        state = self.one("d.data", text)
        self.assertEqual(state["materials"], [{"name": "type1", "density": 5680.0}, {"name": "type2", "density": 3950.0}])
        self.assertEqual(state["particles"]["material"].tolist(), [1, 0])
        labelled = text.replace("Atoms #", "Atom Type Labels\n\n1 zirconia\n2 alumina\n\nAtoms #")
        state = self.one("d.data", labelled)
        self.assertEqual([material["name"] for material in state["materials"]], ["zirconia", "alumina"])
        self.assertEqual(state["materials"][1]["young_modulus"], 400e9)  # built in, and of that density
        like = saved(os.path.join(self.folder, "like.kiln"), packing())
        self.assertEqual(self.one("d.data", text, "--like", like)["materials"][0]["name"], "lead glass")
        state = self.one("d.data", text, "--material", "alumina,alumina-dihedral")  # in the order of the types
        self.assertEqual([material["name"] for material in state["materials"]], ["alumina", "alumina-dihedral"])
        self.assertEqual(state["particles"]["material"].tolist(), [1, 0])
        self.no("d.data", text, "--material", "alumina", says="give --material")
        self.no("d.data", data(header="2 atoms\n3 atom types\n", atoms=atoms.replace("1 2", "1 3", 1)), "--like", like,
                says="has material 3")
        self.no("d.data", data(atoms=atoms), says="has type 2; the header announces 1 atom types")
        state = self.one("d.dump", dump("1 2 1 2 2 0.5\n2 1 1.98 2 2 0.5", "id type x y z radius"))
        self.assertEqual([material["name"] for material in state["materials"]], ["type1", "type2"])
        state = self.one("d.xyz",
                         xyz('Lattice="4 0 0 0 4 0 0 0 4" Properties=type:I:1:pos:R:3:Radius:R:1', "2 1 2 2 0.5\n1 1.95 2 2 0.5\n"))
        self.assertEqual([state["materials"][kind]["name"] for kind in state["particles"]["material"]], ["type2", "type1"])
        self.assertEqual(state["particles"]["radius"].tolist(), [0.5, 0.5])

    def test_nothing_is_alumina_by_default(self):
        for name, text in (("a.csv", TABLE), ("a.txt", "#format x_y_z_r\n0.5\t0.5\t0.5\t0.5\n"),
                           ("a.dump", dump("1 1 2 2 0.5", "id x y z radius")),
                           ("a.xyz", xyz('Lattice="4 0 0 0 4 0 0 0 4" Properties=pos:R:3:radius:R:1', "1 2 2 0.5\n"))):
            self.assertEqual(self.one(name, text)["materials"], [{"name": "unknown"}], name)
            self.assertTrue([each for each in self.warnings if "unknown" in each and "--material" in each], name)
            self.assertEqual(self.one(name, text, "--material", "alumina")["materials"][0]["young_modulus"], 400e9, name)
        glass = self.file("glass.json", json.dumps({"name": "glass", "density": 2500.0}))
        self.assertEqual(self.one("a.csv", TABLE, "--material", glass)["materials"][0]["density"], 2500.0)
        self.no("a.csv", TABLE, "--material", "granite", says="granite: is not built in")
        self.no("a.csv", TABLE, "--material", "alumina", "--like", "x.kiln", says="")

    def test_numbers_of_materials_from_by_first_appearance_or_lists(self):
        """Kiln's own round trip through XYZ does not swap two materials, and CSV keeps their list."""
        state = packing()
        state["particles"]["material"] = state["particles"]["material"][::-1].copy()  # the second one comes first
        source = saved(os.path.join(self.folder, "state.kiln"), state)
        for name in ("xyz", "csv", "dump", "data"):
            target = os.path.join(self.folder, f"back.{name}")
            self.assertEqual(convert(source, target)[2], "")
            (back, ), _ = converted(target, "--like", source)
            numpy.testing.assert_array_equal(back["particles"]["material"], state["particles"]["material"], err_msg=name)

    # ---- radii, boxes, periodic axes -------------------------------------------------------------------------------------------
    def test_radius_is_for_what_has_none(self):
        inputs = (("a.dump", dump("1 1 1 2 2\n2 1 1.98 2 2", "id type x y z"), dump("1 1 1 2 2 0.5", "id type x y z radius")),
                  ("a.xyz", xyz("step=5 it's a comment", "Al 1 2 2\nAl 1.95 2 2\n"), xyz(LATTICE)),
                  ("a.csv", "x (m),y (m),z (m)\n1,2,2\n1.95,2,2\n", TABLE))
        for name, without, given in inputs:
            self.near(self.one(name, without, "--radius", "100nm")["particles"]["radius"], [1e-7, 1e-7])
            self.no(name, without, says="give --radius")
            self.no(name, given, "--radius", "100nm", says="the particles have radii")
        self.no("a.data", data(), "--radius", "100nm", says="the particles have radii")
        for name, value in (("a.dump", dump("1 1 1 2 2 0", "id type x y z radius")), ("a.xyz", xyz(LATTICE, "Al 1 2 2 -0.5\n")),
                            ("a.csv", TABLE.replace("0.5,0.5,0.5,0.5", "0.5,0.5,0.5,0")),
                            ("a.data", data(atoms=ATOMS.replace("1 1 1.0", "1 1 0.0"))),
                            ("a.txt", MUSEN.replace("5 0.0005", "5 0", 1))):
            self.no(name, value, says="positive one")

    def test_boxes_and_flags(self):
        for pbc, wanted in (("1 1 0", [True, True, False]), ("T T F", [True, True, False]), ("TTF", [True, True, False]),
                            ("True False true", [True, False, True]), ("0 0 0", [False] * 3)):
            self.assertEqual(self.one("a.xyz", xyz(f'{LATTICE} pbc="{pbc}"'))["box"]["periodic"], wanted, pbc)
        for pbc in ("T T", "yes yes no", "2 1 1", "TTFF", ""):
            self.no("a.xyz", xyz(f'{LATTICE} pbc="{pbc}"'), says="is not three of T and F")
        for name, text in (("a.data", data(box=BOX.replace("0 4 ylo", "4 4 ylo"))),
                           ("a.data", data(box=BOX.replace("0 4 ylo", "5 4 ylo"))),
                           ("a.dump", dump("1 1 1 2 2 0.5", "id type x y z radius", bounds="0 4\n4 4\n0 4\n")),
                           ("a.xyz", xyz(LATTICE.replace("0 4 0", "0 0 0")))):
            self.no(name, text, says="the box has no length along")
        tilted = dump("1 1 1 2 2 0.5", "id type x y z radius", flags=" xy xz yz pp pp ff", bounds="0 4 0\n0 4 0.0\n0 4 0\n")
        self.assertEqual(self.one("a.dump", tilted)["box"]["periodic"], [True, True, False])
        self.no("a.dump", tilted.replace("0.0", "0.1"), says="tilted")
        self.one("a.data", data(box=BOX + "0 0 0.0 xy xz yz\n"))
        self.no("a.data", data(box=BOX + "0 0.1 0.0 xy xz yz\n"), says="tilted")

    def test_periodic_axes_that_a_file_does_not_say(self):
        free = saved(os.path.join(self.folder, "free.kiln"), packing((False, False, False)))
        for name, text in (("a.data", data()), ("a.dump", dump("1 1 1 2 2 0.5", "id type x y z radius", flags=""))):
            self.assertEqual(self.one(name, text)["box"]["periodic"], [True] * 3)
            self.assertTrue([each for each in self.warnings if "which axes are periodic" in each])
            self.assertEqual(self.one(name, text, "--like", free)["box"]["periodic"], [False] * 3)
            self.assertEqual(self.one(name, text, "--boundary", "pfp")["box"]["periodic"], [True, False, True])
        self.no("a.dump", dump("1 1 1 2 2 0.5", "id type x y z radius"), "--boundary", "fff", says="--boundary is against")
        self.no("a.dump", dump("1 1 1 2 2 0.5", "id type x y z radius", flags=" pp qq pp"), says="is not three of")

    def test_words_of_titles_are_no_keys(self):
        self.assertEqual(self.one("y.data", data("boundary f f f, after time 1000 s, units si"))["box"]["periodic"], [True] * 3)
        self.assertEqual(self.one("y.data", data("boundary f f f, after time 1000 s, units si"))["time"], 0.0)
        for remark in ("# time 5 min", "# box of glass", "# materials from the shelf", "# time", "# a time 5 s"):
            state = self.one("y.csv", f"{remark}\n{TABLE}")
            self.assertEqual((state["time"], state["box"]["periodic"]), (0.0, [False] * 3), remark)
        self.no("y.csv", f"# box {{\"origin\": 1\n{TABLE}", says="is not JSON")
        self.no("y.csv", f"# box {{\"origin\": 1}}\n{TABLE}", says="box")

    # ---- data files ------------------------------------------------------------------------------------------------------------
    def test_atom_styles(self):
        text = data(header="3 atoms\n1 atom types\n2 bonds\n1 bond types\n", style="Atoms # hybrid",
                    atoms="1 1 1 2 2 1 3.95 1 0 0 0\n3 1 2.9 2 2 1 3.95 1 0 0 0\n2 1 1.95 2 2 1 3.95 1 0 0 0\n",
                    more="\nBonds\n\n1 1 1 2\n2 1 2 3\n")
        self.no("c.data", text, "--bond-radius", "200nm", says="--atom-style")
        state = self.one("c.data", text, "--atom-style", "hybrid sphere bond", "--bond-radius", "200nm")
        self.near(state["particles"]["position"][:, 0], [1e-6, 2.9e-6, 1.95e-6])
        self.assertEqual(state["bonds"]["pair"].tolist(), [[0, 2], [2, 1]])
        self.near(state["bonds"]["radius"], [2e-7, 2e-7])
        self.no("c.data", data(atoms=ATOMS.replace(" 0 0 0", "", 1)), says="in all lines")

    def test_sections_and_counts(self):
        self.no("d.data", "two grains\n made with a script, second title\n\n" + data().split("\n", 1)[1],
                says="line 2: 'made with a script, second title' is no section")
        self.no("d.data", bonded("1 1 1 2 # radius 2e-07 length 1e-07 volume 1e-20 image 0 0 0\n"),
                says="2 bonds are announced, 1 are there")
        self.no("d.data", data(header="3 atoms\n1 atom types\n"), says="3 atoms are announced, 2 are there")
        self.no("d.data", data(atoms=ATOMS.replace("2 1 1.0", "1 1 1.0")), says="id 1 stands twice, first in line")
        self.no("d.data", data(atoms=ATOMS.replace("2 1 1.0", "1.6 1 1.0")), says="'1.6' is not a whole number")
        self.one("d.data", data(more="\nVelocities\n\n1 0 0 0 0 0 0\n2 0 0 0 0 0 0\n\nfix_7\n\n1 2\n"))
        self.assertTrue([each for each in self.warnings if "'fix_7' is not known and left out" in each])

    def test_remarks_of_bonds(self):
        """Only what is missing is filled; a bond that stands twice is refused with both of its rows."""
        remark = "# radius 2e-07 length 1e-07 volume 1.2566e-20 image 0 0 0"
        partial = bonded(f"1 1 1 2 {remark}\n2 1 2 3\n")
        self.no("c.data", partial, says="its bond 2-3 has no radius")
        state = self.one("c.data", partial, "--bond-radius", "100nm")
        self.near(state["bonds"]["radius"], [2e-7, 1e-7])
        self.near(state["bonds"]["length"], [1e-7, 0.95e-6 - 2 * (0.25 - 0.01)**0.5 * 1e-6] if 0.95 > 2 * 0.24**0.5
                  else [1e-7, 0.0])
        self.near(state["bonds"]["volume"][0], 1.2566e-20)
        self.no("c.data", bonded(f"1 1 1 2 {remark}\n2 1 2 3 {remark}\n"), "--bond-radius", "100nm", says="its bonds have radii")
        self.no("c.data", bonded(f"1 1 1 2 {remark}\n2 1 2 3 {remark}\n3 1 3 2 {remark}\n", 3),
                says="bonds 1 and 2 are one: both join 3-2 with the same image")
        self.no("c.data", bonded(f"1 1 1 2 {remark}\n2 1 2 2 {remark}\n"), says="has particle 2 at both ends")
        self.no("c.data", bonded(f"1 1 1 2 {remark}\n2 1 2 9 {remark}\n"), says="a bond names particle 9")
        self.no("c.data", data(), "--bond-radius", "100nm", says="has no bonds")

    # ---- dumps -----------------------------------------------------------------------------------------------------------------
    def test_bonds_belong_to_their_step(self):
        columns = "id type x y z radius"
        rows = "1 1 1 2 2 0.5\n2 1 1.95 2 2 0.5\n3 1 2.9 2 2 0.5"
        self.file("j.bonds.dump",
                  dump("1 2 0 0 0 0.1 0.02\n2 3 0 0 0 0.1 0.02", "batom1 batom2 ix iy iz radius length", 0, kind="ENTRIES") +
                  dump("1 2 0 0 0 0.1 0.02", "batom1 batom2 ix iy iz radius length", 20, kind="ENTRIES"))
        frames = "".join(dump(rows, columns, step) for step in (0, 10, 20))
        states, _ = converted(self.file("j.dump", frames), "--time-step", "1us")
        self.assertEqual([len(state["bonds"]["radius"]) if "bonds" in state else None for state in states], [2, None, 1])
        self.assertEqual([state["time"] for state in states], [0, 1e-5, 2e-5])
        self.no("j.dump", "".join(dump(rows, columns, step) for step in (0, 10)), says="has bonds of step 20, which")
        self.no("j.dump", frames.replace("ITEM: TIMESTEP\n10\n", ""), says="has no 'ITEM: TIMESTEP'")
        self.no("j.dump", frames.replace("\n10\n", "\n0\n"), says="the step 0 stands twice")

    def test_bonds_as_lammps_writes_them(self):
        rows = "2 1 1.95 2 2 0.5\n1 1 1 2 2 0.5"
        bonds = self.file("j.bonds.dump", dump("1 1 1 2 0.95", "index c_1[1] c_1[2] c_1[3] c_2[1]", kind="ENTRIES"))
        text = dump(rows, "id type x y z radius")
        self.no("j.dump", text, says="index, c_1[1], c_1[2], c_1[3], c_2[1]; --bond-columns names them")
        options = ("--bond-columns", "_,_,batom1,batom2,_")
        self.no("j.dump", text, *options, says="its bonds have no radius; give --bond-radius")
        state = self.one("j.dump", text, *options, "--bond-radius", "10cm")
        self.assertEqual(state["bonds"]["pair"].tolist(), [[1, 0]])
        self.assertEqual(state["bonds"]["image"].tolist(), [[0, 0, 0]])
        self.near(state["bonds"]["length"], [max(0.0, 0.95 - 2 * (0.25 - 0.01)**0.5)])
        written(bonds, dump("1 2 -1 0 0 0.1 0.2", "batom1 batom2 ix iy iz radius length", kind="BONDS"))  # dump_modify label BONDS
        self.assertEqual(self.one("j.dump", text)["bonds"]["image"].tolist(), [[-1, 0, 0]])
        written(bonds, dump("1 2", "batom1 batom2", kind="ENTRIES"))  # nearest: through the face
        state = self.one("j.dump", dump("1 1 0.2 2 2 0.5\n2 1 3.9 2 2 0.5", "id type x y z radius"), "--bond-radius", "10cm")
        self.assertEqual(state["bonds"]["image"].tolist(), [[-1, 0, 0]])

    # ---- XYZ -------------------------------------------------------------------------------------------------------------------
    def test_frames_of_xyz(self):
        three = "\n".join(xyz(f"{LATTICE} Time={time}") for time in range(3))
        states, _ = converted(self.file("i.xyz", three))
        self.assertEqual([state["time"] for state in states], [0, 1, 2])
        for text in ("", "\n\n"):
            self.no("i.xyz", text, says="is empty")
        self.no("i.xyz", "3" + xyz(LATTICE)[1:], says="3 particles are announced, 2 are there")
        self.no("i.xyz", "2\n" + LATTICE + "\nAl 1 2 2 0.5\n\nAl 1.95 2 2 0.5\n", says="2 particles are announced, 1 are there")
        self.no("i.xyz", xyz('Lattice="4 0 0 0 4 0 0 0 4'), says="")

    # ---- tables ----------------------------------------------------------------------------------------------------------------
    def test_encodings(self):
        self.file("f.bonds.csv", "id1,id2,radius (um),length (um)\n3,0,0.1,0.02\n0,1,0.1,0.02\n")
        wanted = self.one("f.csv", TABLE)
        micro = TABLE.replace("(um)", "(\u00b5m)")
        for text in (b"\xef\xbb\xbf" + TABLE.encode(), TABLE.replace("\n", "\r\n").encode(), TABLE.replace("\n", "\r").encode(),
                     TABLE.encode("utf-16"),
                     micro.encode(), micro.encode("latin-1"), gzip.compress(TABLE.encode())):
            state = self.one("f.csv", text)
            for group in ("particles", "bonds"):
                for name, values in wanted[group].items():
                    numpy.testing.assert_array_equal(state[group][name], values)
        self.one("f.csv", micro.encode("latin-1"))
        self.assertTrue([each for each in self.warnings if "is not UTF-8 text (line 1)" in each])
        for name, text in (("a.data", data().replace("0 0 0\n", "0 0 0 # \u00b5\n")),
                           ("a.dump", dump("1 \u00b5 1 2 2 0.5", "id element x y z radius")),
                           ("a.xyz", xyz(LATTICE).replace("Al", "\u00c4l")), ("a.txt", MUSEN.replace("Lead", "L\u00e4d"))):
            error = refused(self.file(name, text.encode("latin-1")))
            self.assertRegex(error, r"is not UTF-8 text \(line \d+\)$")
            self.assertLess(len(error), 250)
            state = self.one(name, text)
            again = self.one(name + ".gz", gzip.compress(text.encode()))
            numpy.testing.assert_array_equal(state["particles"]["position"], again["particles"]["position"])
            self.no(name + ".gz", gzip.compress(text.encode())[:-9], says="packed by gzip, and damaged")
        self.no("a.csv", b"PK\x03\x04" + bytes(90), says="is a zip archive; unpack it first")
        self.no("a.csv", b"x (m),y (m)\0", says="is not text (line 1)")

    def test_manners_of_tables(self):
        near = [[5e-7, 5e-7, 5e-7], [1.45e-6, 5e-7, 5e-7]]
        for text in ("x [um],y [um],z [um],radius [um]\n0.5,0.5,0.5,0.5\n1.45,0.5,0.5,0.5\n",
                     "# id,x (um),y (um),z (um),radius (um)\n1,0.5,0.5,0.5,0.5\n2,1.45,0.5,0.5,0.5\n",
                     "id;x (um);y (um);z (um);diameter (um)\n1;0,5;0,5;0,5;1,0\n2;1,45;0,5;0,5;1,0\n",
                     "x (um)\ty (um)\tz (um)\tr (um)\n0,5\t0,5\t0,5\t0,5\n1,45\t0,5\t0,5\t0,5\n",
                     '"x (um)","y (um)","z (um)","r (um)"\n"0,5","0,5","0,5","0,5"\n"1,45","0,5","0,5","0,5"\n',
                     "x (um),y (um),z (um),r (um),\n0.5,0.5,0.5,0.5,\n1.45,0.5,0.5,0.5,\n",
                     "sep=;\nx (um);y (um);z (um);r (um);sample\n0.5;0.5;0.5;0.5;A1\n1.45;0.5;0.5;0.5;A2\n",
                     "x,y,z,r\n(um),(um),(um),(um)\n0.5,0.5,0.5,0.5\n1.45,0.5,0.5,0.5\n",
                     "x (um) y (um) z (um) radius (um)\n0.5 0.5 0.5 0.5\n1.45 0.5 0.5 0.5\n",
                     "Sample;bar 7;\nVoxel size;0,5;um\n\nlabel;x (um);y (um);z (um);r "
                     "(um)\na;0,5;0,5;0,5;0,5\nb;1,45;0,5;0,5;0,5\n"):
            state = self.one("g.csv", text)
            self.near(state["particles"]["position"], near)
            self.near(state["particles"]["radius"], [5e-7, 5e-7])
        self.assertTrue([each for each in self.warnings if "above the heading in line 4 is left out" in each])
        self.no("g.csv", "x (um),y (um),z (um),r (um),r (um)\n1,1,1,1,2\n", says="the column 'radius' stands twice")
        self.no("g.csv", "x (um),y (um),z (um),r (um),R [um]\n1,1,1,1,2\n", says="the column 'radius' stands twice")
        self.no("g.csv", "x (um);y (um);z (um);r (um)\n1;1;1;1.5\n1;1;10,000;1\n", says="which of them is decimal is not known")
        self.no("g.csv", "x (um),y (um),z (um),r (um)\n1,1,1,1\n1,1,1\n", says="line 3: has 3 columns, expected 4")
        self.no("g.csv", "x (um),y (um),z (um),r (um)\n1,1,1,wide\n", says="line 2: 'wide' is not a number")
        self.no("g.csv", "id,x (um),y (um),z (um),r (um)\n1.6,1,1,1,1\n", says="'1.6' is not a whole number")
        self.no("g.csv", "id,x (um),y (um),z (um),r (um)\n1,1,1,1,1\n1,2,1,1,1\n", says="id 1 stands 2 times")
        self.no("g.csv", "a,b\n1,2\n", says="has no column x, only a, b; --columns names them")
        self.no("g.csv", "a,b\nc,d\n", says="has no column x, only a, b; --columns names them")

    def test_lists_of_spheres(self):
        """x y z r and x y z d, as packing programs and tomography write them, by blanks, with --columns or a heading; MUSEN's
        export is known by its content, not by the end of its name."""
        state = self.one("v.txt", "#format x_y_z_r\n0.5\t0.5\t0.5\t0.5\n1.45\t0.5\t0.5\t0.5\n")
        self.assertEqual(state["particles"]["position"].tolist(), [[0.5, 0.5, 0.5], [1.45, 0.5, 0.5]])
        self.assertTrue([each for each in self.warnings if "taken for metres, --units" in each])
        self.near(self.one("v.txt", "#format x_y_z_r\n0.5\t0.5\t0.5\t0.5\n", "--units", "nano")["particles"]["radius"], [5e-10])
        state = self.one("v.txt", "#format x_y_z_r_matId\n0.5 0.5 0.5 0.5 1\n1.45 0.5 0.5 0.5 0\n")
        self.assertEqual([state["materials"][kind]["name"] for kind in state["particles"]["material"]], ["material1", "material0"])
        for name in ("v.txt", "v.dat", "v.csv", "v.xyzr"):
            for columns, options, radius in (("x (um),y (um),z (um),r (um)", (), 5e-7), ("x,y,z,d", ("--units", "micro"), 2.5e-7),
                                             ("_,y (um),x (um),z (um),d (mm)", (), 2.5e-4)):
                rows = "0.7 0.6 0.8 0.5\n1.45 0.5 0.5 0.5\n"
                rows = "".join(f"{'9 ' if columns.startswith('_') else ''}{row}\n" for row in rows.split("\n") if row)
                state = self.one(name, rows, "--columns", columns, *options)
                self.near(state["particles"]["radius"], [radius] * 2)
                self.near(state["particles"]["position"][0], [6e-7, 7e-7, 8e-7] if columns.startswith("_") else [7e-7, 6e-7, 8e-7])
                self.assertEqual(state["box"]["periodic"], [False] * 3)
        self.no("v.txt", "0.5 0.5 0.5 0.5\n", says="has 4 columns without headings; --columns names them")
        self.no("v.txt", "0.5 0.5 0.5 0.5\n", "--columns", "x,y,z,r", says="column 'x' has no unit of length")
        self.no("v.txt", "0.5 0.5 0.5 0.5\n", "--columns", "x (m),y (m),z (m)", says="has 4 columns, expected 3")
        self.assertEqual(self.one("v.txt", MUSEN)["materials"][0]["name"], "Lead glass")

    # ---- MUSEN -----------------------------------------------------------------------------------------------------------------
    def test_walls_and_properties_of_musen(self):
        state = self.one("b.txt", MUSEN)
        self.assertEqual(state["materials"],
                         [{"name": "Lead glass", "density": 2500.0, "young_modulus": 5e10, "poisson_ratio": 0.22}])
        wall = "0 0 1 14 5  23 KEY 24 0 1e+300 2 0 12 0.001 0.001 0 15 0 0 0 16 0 0 0 18 0 20 0 0 0 31 0.002 0 0 0\n"
        other = self.one("b.txt", wall + MUSEN)
        self.assertTrue([each for each in self.warnings if "triangles of walls are left out" in each])
        for group in ("particles", "bonds"):
            for name, values in state[group].items():
                numpy.testing.assert_array_equal(other[group][name], values)
        self.no("b.txt", MUSEN.replace("10 0.22", "10 3950"), says="poisson_ratio is 3950, expected")

    # ---- names, images ---------------------------------------------------------------------------------------------------------
    def test_names_with_blanks_and_colons(self):
        text = ("id,x (um),y (um),z (um),radius (um),coordination number,phase: a\n"
                "1,0.5,0.5,0.5,0.5,6,1.5\n2,1.45,0.5,0.5,0.5,4,2.5\n")
        for ending in ("xyz", "dump"):
            source, target = self.file("k.csv", text), os.path.join(self.folder, f"k.{ending}")
            status, warnings, _ = convert(source, target)
            self.assertEqual(status, 0)
            self.assertTrue([each for each in warnings if "written as coordination_number" in each])
            (state, ), _ = converted(target)
            self.assertEqual(state["particles"]["coordination_number"].tolist(), [6, 4])
            self.assertEqual(state["particles"]["phase__a"].tolist(), [1.5, 2.5])

    def test_images_too_far(self):
        box = '# box {"origin": [0,0,0], "vectors": [[4e-6,0,0],[0,4e-6,0],[0,0,4e-6]], "periodic": [true,true,true]}\n'
        table = box + "id,x (um),y (um),z (um),radius (um)\n0,1,2,2,0.5\n1,1202.0,2,2,0.5\n"
        self.file("s.bonds.csv", "id1,id2,image_x,image_y,image_z,radius (um),length (um)\n0,1,-300,0,0,0.1,0.02\n")
        self.no("s.csv", table, says="bond 0-1 goes through 300 boxes, more than 127")
        self.file("s.bonds.csv", "id1,id2,radius (um),length (um)\n0,1,0.1,0.02\n")
        self.no("s.csv", table, says="bond 0-1 goes through 300 boxes, more than 127")  # the nearest image
        self.file("s.bonds.csv", "id1,id2,image_x,image_y,radius (um),length (um)\n0,1,0,0,0.1,0.02\n")
        self.no("s.csv", table, says="has not all of the columns image_x, image_y, image_z")

    def test_a_companion_of_an_older_file_is_not_read(self):
        for ending in ("csv", "dump"):
            target = os.path.join(self.folder, f"t.{ending}")
            convert(saved(os.path.join(self.folder, "a.kiln"), packing()), target)
            _, warnings, _ = convert(saved(os.path.join(self.folder, "b.kiln"), packing(bonded=False)), target)
            self.assertTrue([each for each in warnings if "belonged to an older" in each], ending)
            self.assertNotIn("bonds", converted(target)[0][0], ending)

    # ---- streams ---------------------------------------------------------------------------------------------------------------
    def test_what_the_programs_refuse_is_refused(self):
        """Also from a stream: nothing leaves that the programs do not read."""
        def text(**changes):
            document = {"box": {"vectors": [[4, 0, 0], [0, 4, 0], [0, 0, 4]]},
                        "particles": {"position": {"type": "f8", "shape": [2, 3], "data": [1, 1, 1, 2.5, 1, 1]},
                                      "radius": {"type": "f8", "shape": [2], "data": [1, 0.75]}}, **changes}
            return json.dumps(document) + "\n"
        self.one("ok.jsonl", text())
        ids = {"particles": {"position": {"type": "f8", "shape": [1, 3], "data": [1, 1, 1]},
                             "radius": {"type": "f8", "shape": [1], "data": [1]},
                             "id": {"type": "i8", "shape": [1], "data": [1.6]}}}
        for changes, says in (({"units": "cgs"}, "has units cgs"), ({"box": {"vectors": 1}}, "box"),
                              ({"materials": [{}]}, "a material"),
                              ({"time": "x"}, "time is x"), ({"version": 2}, "has version 2"),
                              (ids, "data is not a list of 1 numbers of type i8"),
                              ({"particles": {}}, "has no particles.position"),
                              ({"format": "dem-bend"}, "is dem-bend, expected a state")):
            self.no("bad.jsonl", text(**changes), says=says)
        necks = {"necks": {"pair": {"type": "i4", "shape": [1, 2], "data": [0, 1]},
                           "radius": {"type": "f8", "shape": [1], "data": [0.25]}}}
        self.one("ok.jsonl", text(**necks))
        ok, xyz = (os.path.join(self.folder, name) for name in ("ok.jsonl", "ok.xyz"))
        status, _, error = convert(ok, xyz)
        self.assertEqual(status, 1)
        self.assertRegex(error, "ok.jsonl: names no material; --material NAME or FILE.json says what it is$")
        _, warnings, _ = convert("--material", "alumina", ok, xyz)
        self.assertTrue([each for each in warnings if "does not hold the constants of materials, necks" in each])
        necks["necks"]["pair"]["data"] = [0, 2]
        self.no("bad.jsonl", text(**necks), says="a neck has particle row 2, there are 2")
        self.no("bad.jsonl", "{", says="document 1: is no line of JSON")
        self.no("bad.jsonl", '{"a":1,"a":2}\n', says="key 'a' stands twice")


class Conformance(unittest.TestCase):
    """The documents that every program has to take, or to refuse (tests/data/conformance): dem-convert does, too."""

    def documents(self, kind):
        folder = os.path.join(ROOT, "tests", "data", "conformance", kind)
        return sorted(os.path.join(folder, name) for name in os.listdir(folder))

    def test_valid(self):
        with tempfile.TemporaryDirectory() as folder:
            for path in self.documents("valid"):
                target = os.path.join(folder, os.path.basename(path) + ".kiln")
                status, _, error = convert(path, target)
                self.assertEqual((status, error), (0, ""), path)
                ended = subprocess.run([program("ANALYZE"), "info", target], capture_output=True, check=False)
                self.assertEqual((ended.returncode, ended.stderr), (0, b""), path)

    def test_invalid(self):
        with tempfile.TemporaryDirectory() as folder:
            for path in self.documents("invalid"):
                target = os.path.join(folder, "out.kiln")
                status, _, error = convert(path, target)
                if status == 0:  # what is left of it after reading has to be sound
                    ended = subprocess.run([program("ANALYZE"), "info", target], capture_output=True, check=False)
                    self.assertEqual((ended.returncode, ended.stderr), (0, b""), path)
                else:
                    self.assertRegex(error, r"^dem-convert: [^\n]{1,600}$", path)


if __name__ == "__main__":
    unittest.main()
