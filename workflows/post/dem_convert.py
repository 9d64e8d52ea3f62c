"""dem_convert.py: the command dem-convert: which format a file has, and from one to the other."""
import argparse
import decimal
import re
import sys

import convert_lammps
import convert_musen
import convert_text
import dem_state
from convert_common import ConvertError, opened, written

LENGTH = {"m": 0, "mm": -3, "um": -6, "nm": -9}  # powers of ten
TIME = {"s": 0, "ms": -3, "us": -6, "ns": -9}

EXAMPLES = """formats, by the end of the name or --from and --to:
  dem    .kiln .dem; text with .jsonl  states, everything
  vtu    .vtu, or .pvd for a series    for ParaView (written): spheres as vertices, bonds as lines
  data   .data .lmp                    LAMMPS data file, atom style sphere or bpm/sphere, bonds
  dump   .dump .lammpstrj              LAMMPS text dump; bonds as dump local in NAME.bonds.dump
  xyz    .xyz .extxyz                  extended XYZ; without bonds
  csv    .csv                          table of particles, box in remarks; bonds in NAME.bonds.csv
  musen  .txt                          text export of MUSEN (read)
Several states become NAME-0001.data and so on where the format holds one state.

examples:
  dem-convert sintered.kiln sintered.pvd
  dem-convert bonded.kiln bonded.data && lmp -in relax.in &&
      dem-convert --like bonded.kiln relaxed.data - | bend
  dem-convert --time-step 10ns --radius 50nm packing.dump - | bondify | analyze bonds
"""


def quantity(units):

    def parse(text):
        found = re.fullmatch(r"([-+0-9.eE]+)([a-z]+)", text)
        if not found or found[2] not in units:
            raise argparse.ArgumentTypeError(f"'{text}' is not a number with a unit; known here: {', '.join(units)}")
        try:
            value = float(decimal.Decimal(found[1]).scaleb(units[found[2]]))  # 28nm is 2.8e-8 and not its neighbour
        except decimal.InvalidOperation:
            raise argparse.ArgumentTypeError(f"'{text}' is not a number with a unit") from None
        if not value > 0:
            raise argparse.ArgumentTypeError(f"'{text}' is not greater than zero")
        return value

    return parse


def read_dem(path, given):
    with opened(path, "rb") as stream:
        for number, document in enumerate(dem_state.read(stream), start=1):
            if document.get("format", "dem-state") != "dem-state":
                raise ConvertError(f"{path}, document {number}: is {document['format']}, expected a state")
            yield document


def write_dem(path, documents, given):
    with written(path, "wb") as stream:
        for document in documents:
            dem_state.write(stream, document, text=given.text or path.endswith(".jsonl"))


def write_vtu(path, documents, given):
    import convert_vtu  # late: meshio takes longer to load than most conversions take
    convert_vtu.write(path, documents, given)


READERS = {
    "dem": read_dem,
    "data": convert_lammps.read_data,
    "dump": convert_lammps.read_dump,
    "xyz": convert_text.read_xyz,
    "csv": convert_text.read_csv,
    "musen": convert_musen.read_musen
}
WRITERS = {
    "dem": write_dem,
    "vtu": write_vtu,
    "data": convert_lammps.write_data,
    "dump": convert_lammps.write_dump,
    "xyz": convert_text.write_xyz,
    "csv": convert_text.write_csv
}
# The formats that an option has an effect on, as what is read and as what is written.
USED_BY = {
    "text": ((), ("dem", )),
    "bonds": ((), ("vtu", )),
    "units": (("data", "dump"), ("data", "dump")),
    "atom_style": (("data", ), ()),
    "boundary": (("data", "dump"), ()),
    "radius": (("dump", "xyz", "csv"), ()),
    "bond_radius": (("data", ), ()),
    "time_step": (("dump", ), ())
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
    ".txt": "musen"
}


def format_of(path, told, known, option):
    name = told or next((name for ending, name in ENDINGS.items() if path.endswith(ending)), "dem" if path == "-" else None)
    if name is None:
        raise ConvertError(f"{path}: its name does not say its format; give {option} {'|'.join(known)}")
    if name not in known:
        raise ConvertError(f"{path}: {name} is not a format for this side; known: {', '.join(known)}")
    return name


def refuse_unused(parse, given, source, target):
    """Ends the program where an option was given that neither of the two formats uses."""
    for name, (reading, writing) in USED_BY.items():
        if getattr(given, name) in (None, False) or source in reading or target in writing:
            continue
        sides = [f"{side} {' or '.join(formats)}" for side, formats in (("from", reading), ("to", writing)) if formats]
        parse.error(f"--{name.replace('_', '-')} has an effect only {' or '.join(sides)}, and this is from {source} to {target}")


def with_the_rest(documents, given):
    """The states with a line in their history, and what --like has and they do not: materials, contacts, box."""
    like = next(read_dem(given.like, given)) if given.like else {}
    for document in documents:
        for key in ("materials", "contacts", "temperature"):
            if key in like:
                document.setdefault(key, like[key])
        history = document.get("history", like.get("history", []))
        document["history"] = [*history, {"tool": "dem-convert", "version": "0.1.0", "arguments": given.shown}]
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
    parse.add_argument("--bonds",
                       choices=("cut", "ghosts"),
                       help="VTU: leave bonds through periodic faces out, or draw them to ghosts of their particles (default)")
    parse.add_argument("--units",
                       choices=convert_lammps.LENGTHS,
                       help="LAMMPS style of units (default: what the file says, else si)")
    parse.add_argument("--atom-style",
                       choices=convert_lammps.ATOM_COLUMNS,
                       help="of a data file that does not say it (default: sphere)")
    parse.add_argument("--boundary", metavar="ppp", type=boundary, help="p or f for each axis, where the file does not say it")
    parse.add_argument("--radius", type=quantity(LENGTH), help="of all particles, where the file has none, such as 50nm")
    parse.add_argument("--bond-radius", type=quantity(LENGTH), help="of all bonds, where the file has none")
    parse.add_argument("--time-step", type=quantity(TIME), help="of a dump without ITEM: TIME, such as 10ns")
    parse.add_argument("--like",
                       metavar="STATE",
                       help="a dem-state file whose materials, contacts and history hold for what is read")
    parse.add_argument("--version", action="version", version="dem-convert (Kiln) 0.1.0")
    return parse


def boundary(text):
    if not re.fullmatch("[pf]{3}", text):
        raise argparse.ArgumentTypeError(f"'{text}' is not three letters p or f")
    return text


def main():
    parse = parser()
    given = parse.parse_args()
    given.shown = [word for word in sys.argv[1:] if word not in (given.source, given.target, "--text")]
    given.units_given = given.units is not None
    try:
        source = format_of(given.source, given.reads, READERS, "--from")
        target = format_of(given.target, given.writes, WRITERS, "--to")
        refuse_unused(parse, given, source, target)
        given.units, given.bonds = given.units or "si", given.bonds or "ghosts"
        given.atom_style = given.atom_style or "sphere"
        WRITERS[target](given.target, with_the_rest(READERS[source](given.source, given), given), given)
    except BrokenPipeError:
        sys.stderr.close()  # the reader of the pipe has gone
        return 141
    except (ConvertError, ValueError, KeyError, TypeError, IndexError, AttributeError) as error:
        print(f"dem-convert: {error if isinstance(error, ConvertError) else f'{given.source}: cannot be read, {error!r}'}",
              file=sys.stderr)
        return 1
    except OSError as error:
        print(f"dem-convert: {error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
