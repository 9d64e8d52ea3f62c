"""dem_convert.py: the command dem-convert: which format a file has, and from one to the other."""
import argparse
import re
import sys

import convert_csv
import convert_data
import convert_dump
import convert_materials
import convert_musen
import convert_vtu
import convert_xyz
import kiln
import units
from convert_check import check
from convert_common import ConvertError, clipped, ended, opened, unpacked, warn, written
from convert_found import completed
from kiln.stream import documents_in

EXAMPLES = """formats, by the end of the name or --from and --to:
  dem    .kiln .dem; text with .jsonl  states, everything
  vtu    .vtu, or .pvd for a series    for ParaView: spheres as vertices, bonds as lines
  data   .data .lmp                    LAMMPS data file, styles sphere, bpm/sphere, hybrid; bonds
  dump   .dump .lammpstrj              LAMMPS text dump; bonds as dump local in NAME.bonds.dump
  xyz    .xyz .extxyz                  extended XYZ; without bonds
  csv    .csv .tsv .dat .xyzr          table of particles, box in remarks; bonds in NAME.bonds.csv;
                                       also lists x y z r that blanks part
  musen  .txt                          text export of MUSEN (read); another .txt is a table
Several states become NAME-0001.data and so on where a format holds one state. NAME.gz is read too.
What a format does not hold is said in a warning when it is written, and what is taken for granted
when it is read.

materials: a file of another program has names (Al, glass) or numbers of types, and no constants.
--like takes materials from a state, by name, or by number where there are only numbers; --material
gives them, NAME being alumina, alumina-dihedral or a file NAME.json. Without either they keep their
names and have no constants: density and bonds can be counted, nothing can be bent.

examples:
  dem-convert sintered.kiln sintered.pvd
  dem-convert bonded.kiln bonded.data && lmp -in relax.in &&
      dem-convert --like bonded.kiln relaxed.data - | bend
  dem-convert --time-step 10ns --radius 50nm packing.dump - | bondify | analyze bonds
  dem-convert --material alumina --columns "x (um),y (um),z (um),d (um)" tomography.txt spheres.kiln
  dem-convert --material Al=alumina,Zr=zirconia.json --units nano mixed.xyz mixed.kiln
"""


def quantity(dimension):

    def parse(text):
        value = units.quantity(text, dimension)
        if value is None:
            raise argparse.ArgumentTypeError(f"'{text}' is not a number with a unit; known here: {units.known(dimension)}")
        if not 0 < value < float("inf"):
            raise argparse.ArgumentTypeError(f"'{text}' is not greater than zero")
        return value

    return parse


def documents_of(path):
    """The documents of a stream of states."""
    with opened(path) as stream:
        number, documents = 0, documents_in(stream)
        while True:
            number += 1
            try:
                document = next(documents, None)
            except kiln.Error as error:
                raise ConvertError(f"{path}, document {number}: {error}") from None
            if document is None:
                return
            if document.get("format", "dem-state") != "dem-state":
                raise ConvertError(f"{path}, document {number}: is {clipped(document['format'])}, expected a state")
            check(document, f"{path}, document {number}")
            yield document


def read_dem(path, given):
    for document in documents_of(path):
        if given.material:
            document["materials"] = convert_materials.in_stream(document, given.materials, path)
            check(document, path)
        elif not document.get("materials") and not given.like and given.foreign:
            raise ConvertError(f"{path}: names no material; --material NAME or FILE.json says what it is")
        yield document


def write_dem(path, documents, given):
    text = given.text or path.endswith(".jsonl")
    with written(path, "wb") as stream:
        for document in documents:
            try:
                kiln.write(stream, document, text)
            except kiln.Error:
                raise ConvertError("an array holds what is not a finite number, which text cannot; write it as .kiln") from None


READERS = {
    "dem": read_dem,
    "vtu": convert_vtu.read,
    "data": convert_data.read_data,
    "dump": convert_dump.read_dump,
    "xyz": convert_xyz.read_xyz,
    "csv": convert_csv.read_csv,
    "musen": convert_musen.read_musen
}
WRITERS = {
    "dem": write_dem,
    "vtu": convert_vtu.write,
    "data": convert_data.write_data,
    "dump": convert_dump.write_dump,
    "xyz": convert_xyz.write_xyz,
    "csv": convert_csv.write_csv
}
FOREIGN = tuple(name for name in READERS if name != "dem")
# The formats that an option has an effect on, as what is read and as what is written.
USED_BY = {
    "text": ((), ("dem", )),
    "bonds": ((), ("vtu", )),
    "units": (("data", "dump", "xyz", "csv", "vtu"), ("data", "dump", "xyz")),
    "atom_style": (("data", ), ()),
    "boundary": (FOREIGN, ()),
    "radius": (FOREIGN, ()),
    "bond_radius": (("data", "dump", "csv", "vtu"), ()),
    "columns": (("csv", ), ()),
    "bond_columns": (("dump", "csv"), ()),
    "time_step": (("data", "dump"), ())
}
ENDINGS = {
    ".kiln": "dem",
    ".dem": "dem",
    ".jsonl": "dem",
    ".json": "dem",
    ".vtu": "vtu",
    ".pvd": "vtu",
    ".data": "data",
    ".lmp": "data",
    ".dump": "dump",
    ".lammpstrj": "dump",
    ".xyz": "xyz",
    ".extxyz": "xyz",
    ".csv": "csv",
    ".tsv": "csv",
    ".dat": "csv",
    ".xyzr": "csv",
    ".txt": "musen"
}


def format_of(path, told, known, option):
    ending = unpacked(path) if known is READERS else path
    name = told or next((name for end, name in ENDINGS.items() if ending.endswith(end)), "dem" if path == "-" else None)
    if name is None:
        raise ConvertError(f"{path}: its name does not say its format; give {option} {'|'.join(known)}")
    if name == "musen" and not told and known is READERS and not convert_musen.is_musen(path):
        return "csv"
    if name not in known:
        raise ConvertError(f"{path}: {name} is not a format for this side; known: {', '.join(known)}")
    return name


def sides_of(option):
    """Where an option has an effect, in words."""
    reading, writing = USED_BY[option]
    reading = ("another format than dem", ) if reading == FOREIGN else reading
    return " or ".join(f"{side} {' or '.join(formats)}" for side, formats in (("from", reading), ("to", writing)) if formats)


def refuse_unused(parse, given, source, target):
    """Ends the program where an option was given that neither of the two formats uses."""
    for name, (reading, writing) in USED_BY.items():
        if getattr(given, name) in (None, False) or source in reading or target in writing:
            continue
        parse.error(f"--{name.replace('_', '-')} has an effect only {sides_of(name)}, and this is from {source} to {target}")
    if given.like and given.material:
        parse.error("--like and --material both say of what the particles are; give one of them")
    if given.units and source in USED_BY["units"][0] and target in USED_BY["units"][1]:
        parse.error(f"--units is for one side, and both {source} and {target} have units; convert by way of a .kiln")


def states(path, reader, given):
    """The states of a file, completed by --like and the other options, and checked."""
    given.used = set()
    given.materials = convert_materials.given_materials(given.material)
    like = next(documents_of(given.like), None) if given.like else None
    if given.like and like is None:
        raise ConvertError(f"{given.like}: holds no state")
    count = 0
    for count, found in enumerate(READERS[reader](path, given), start=1):
        if reader == "dem":
            for key in ("materials", "contacts", "temperature") if like else ():
                if key in like:
                    found.setdefault(key, like[key])
            check(found, path)
            yield found
            continue
        document = completed(found, like, given)
        for key in ("contacts", "temperature", "history") if like else ():
            if key in like:
                document.setdefault(key, like[key])
        check(document, path)
        yield document
    if not count:
        raise ConvertError(f"{path}: holds no state")
    if given.bond_radius is not None and "bond_radius" not in given.used:
        raise ConvertError(f"{path}: has no bonds; --bond-radius is for bonds without one")


def with_history(documents, given):
    for document in documents:
        step = {"tool": "dem-convert", "version": kiln.__version__, "arguments": given.shown}
        document["history"] = [*document.get("history", []), step]
        yield document


def parser():
    parse = argparse.ArgumentParser(prog="dem-convert",
                                    description="Converts states into the formats of neighbouring programs and back.",
                                    epilog=EXAMPLES,
                                    formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("source", metavar="FROM", help="file to read; - is standard input")
    parse.add_argument("target", metavar="TO", help="file to write, whole or not at all; - is standard output")
    parse.add_argument("--from", dest="reads", choices=READERS, help="format of FROM")
    parse.add_argument("--to", dest="writes", choices=WRITERS, help="format of TO")
    parse.add_argument("--text", action="store_true", help="write text documents (JSON lines) instead of binary ones")
    parse.add_argument("-q", "--quiet", action="store_true", help="no warnings")
    parse.add_argument("--bonds",
                       choices=("cut", "ghosts"),
                       help="VTU: leave bonds through periodic faces out, or draw them to ghosts of their particles (default)")
    parse.add_argument("--units",
                       choices=units.SYSTEMS,
                       help="style of units, as LAMMPS has them, of what is read and does not say it, or of what is written "
                       "(default: si); nano is nm, ns, ag")
    parse.add_argument("--atom-style",
                       metavar="STYLE",
                       help="of a data file, whatever it says: sphere, bpm/sphere, \"hybrid sphere bond\" (default: what it says, "
                            "else sphere)")
    parse.add_argument("--boundary", metavar="ppp", type=boundary, help="p or f for each axis, where the file does not say it")
    parse.add_argument("--radius", type=quantity("length"), help="of particles for which the file has none, such as 50nm")
    parse.add_argument("--bond-radius", type=quantity("length"), help="of bonds for which the file has none, such as 28nm")
    parse.add_argument("--columns",
                       metavar="NAMES",
                       type=name_list,
                       help="of a table, in their order, with units: \"x (um),y (um),z (um),r (um)\"; d is a diameter, _ leaves "
                            "one out")
    parse.add_argument("--bond-columns", metavar="NAMES", type=name_list,
                       help="of the bonds beside a dump or a table: _,batom1,batom2,_")
    parse.add_argument("--time-step", type=quantity("time"), help="of a dump or data file that says only steps, such as 10ns")
    parse.add_argument("--like",
                       metavar="STATE",
                       help="a dem-state file that lends what is read and has not: materials, contacts, periodic axes, history; "
                            "radius, "
                       "length and volume of bonds by pair of ids")
    parse.add_argument("--material",
                       action="append",
                       metavar="[LABEL=]NAME,...",
                       help="materials of the particles that the file calls LABEL, or of its types in their order: alumina, or "
                       "Al=alumina,Zr=zirconia.json")
    parse.add_argument("--version", action="version", version=f"dem-convert (Kiln) {kiln.__version__}")
    return parse


def boundary(text):
    if not re.fullmatch("[pf]{3}", text):
        raise argparse.ArgumentTypeError(f"'{text}' is not three letters p or f")
    return text


def name_list(text):
    names = [name.strip() for name in text.split(",")]
    return names


def main(arguments=None):
    parse = parser()
    given = parse.parse_args(arguments)
    words = sys.argv[1:] if arguments is None else arguments
    given.shown = [word for word in words if word not in (given.source, given.target, "--text", "-q", "--quiet")]
    warn.quiet, warn.said = given.quiet, []
    return ended("dem-convert", given.source, lambda: convert(parse, given))


def convert(parse, given):
    source = format_of(given.source, given.reads, READERS, "--from")
    target = format_of(given.target, given.writes, WRITERS, "--to")
    refuse_unused(parse, given, source, target)
    given.foreign = target != "dem"
    documents = with_history(states(given.source, source, given), given)
    WRITERS[target](given.target, documents, given)


if __name__ == "__main__":
    sys.exit(main())
