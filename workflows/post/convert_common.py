"""convert_common.py: what the converters share: errors and warnings, files read and written whole, numbers, names, boxes, bonds."""
import contextlib
import gzip
import math
import os
import re
import sys
import zlib

import kiln
import numpy
from kiln.stream import written  # noqa: F401  (the converters have it from here)

import units

SMALL, LARGE = ("id", "position", "radius", "material"), ("pair", "image", "radius", "length", "volume")
# float() knows also 1_0, nan and digits of other scripts.
NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
SIGNS, DIGITS = set("0123456789+-.eE"), set("0123456789-")
PACKED = {b"PK\x03\x04": "a zip archive", b"BZh": "packed by bzip2", b"\xfd7zXZ": "packed by xz",
          b"\x28\xb5\x2f\xfd": "packed by zstd"}


class ConvertError(kiln.Error):
    """One sentence for the user: file, place, cause."""


def placed(sentence):
    """A sentence as it is shown: a pipe has a name."""
    return re.sub(r"^-(?=[:,])", "standard input", str(sentence))


def ended(program, path, work):
    """The exit status of a program that is work(): 0; 1 after the sentence of an error, which is about the path where the system
    names none; 141 where the reader of a pipe has gone."""
    try:
        work()
    except BrokenPipeError:
        sys.stderr.close()
        return 141
    except ConvertError as error:
        print(f"{program}: {placed(error)}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"{program}: {error.filename or path}: {error.strerror or error}", file=sys.stderr)
        return 1
    return 0


class Voice:
    """Where warnings go: once each, to stderr, or nowhere."""

    def __init__(self):
        self.name, self.quiet, self.said = "dem-convert", False, []

    def __call__(self, sentence):
        sentence = placed(sentence)
        if sentence in self.said:
            return
        self.said.append(sentence)
        if not self.quiet:
            print(f"{self.name}: warning: {sentence}", file=sys.stderr)


warn = Voice()


# ---- files ---------------------------------------------------------------------------------------------------------------------
@contextlib.contextmanager
def opened(path):
    """An open binary file to read, unpacked if gzip packed it; "-" is standard input."""
    with contextlib.ExitStack() as stack:
        stream = sys.stdin.buffer if path == "-" else stack.enter_context(open(path, "rb"))
        begin = stream.peek(6)
        for magic, what in PACKED.items():
            if begin.startswith(magic):
                raise ConvertError(f"{path}: is {what}; unpack it first")
        if not begin.startswith(b"\x1f\x8b"):
            yield stream
            return
        try:
            yield stack.enter_context(gzip.open(stream))
        except (EOFError, zlib.error, gzip.BadGzipFile):
            raise ConvertError(f"{path}: is packed by gzip, and damaged") from None


def lines(path, latin=False):
    """The lines of a text file with their numbers from 1. UTF-8, or UTF-16 with its mark; with latin also Windows-1252, with a
    warning."""
    encoding, errors, row = "utf-8", "strict", 0
    with opened(path) as stream:
        for raw in stream:
            if row == 0 and raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
                try:
                    yield from enumerate((raw + stream.read()).decode("utf-16").replace("\r\n", "\n").split("\n"), start=1)
                except UnicodeDecodeError:
                    raise ConvertError(f"{path}: begins as UTF-16 text and is none") from None
                return
            if row == 0 and raw.startswith(b"\xef\xbb\xbf"):
                raw = raw[3:]  # the byte order mark of spreadsheets
            if b"\0" in raw:
                raise ConvertError(f"{path}: is not text (line {row + 1})")
            for part in raw.rstrip(b"\r\n").split(b"\r"):
                row += 1
                try:
                    text = part.decode(encoding, errors)
                except UnicodeDecodeError:
                    if not latin:
                        raise ConvertError(f"{path}: is not UTF-8 text (line {row})") from None
                    warn(f"{path}: is not UTF-8 text (line {row}); read as Windows-1252")
                    encoding, errors = "cp1252", "replace"
                    text = part.decode(encoding, errors)
                yield row, text


def unpacked(path):
    """A name without the ending of gzip."""
    return path[:-3] if path.endswith(".gz") else path


def beside(path, suffix):
    """The name of a companion: run.csv and ".bonds" give run.bonds.csv."""
    plain = unpacked(path)
    stem, kind = os.path.splitext(plain)
    return f"{stem}{suffix}{kind}{path[len(plain):]}"


def companion_of(path, suffix):
    """The companion of a file that is read, packed or not; None if there is none."""
    if path == "-":
        return None
    name = beside(path, suffix)
    return next((each for each in (name, unpacked(name), f"{unpacked(name)}.gz") if os.path.exists(each)), None)


def without_companion(path, suffix):
    """Removes the companion of an older file of that name, which would be read with the new one."""
    old = companion_of(path, suffix)
    if old:
        warn(f"{old} belonged to an older {path} and is removed")
        os.unlink(old)


def series(path, count):
    """Names for so many states: the path itself for one, numbered ones for more."""
    if count == 1:
        return [path]
    if path == "-":
        raise ConvertError(f"{count} states do not fit into one file of this format on standard output")
    return [beside(path, f"-{number:04d}") for number in range(1, count + 1)]


# ---- numbers and names ---------------------------------------------------------------------------------------------------------
def number(text, place, power=0):
    """A finite number, times a power of ten."""
    value = units.shifted(text, power) if NUMBER.fullmatch(text) else math.nan
    if math.isnan(value):
        raise ConvertError(f"{place}: '{clipped(text)}' is not a number")
    if not math.isfinite(value):
        raise ConvertError(f"{place}: {clipped(text)} is not a finite number")
    return value


def whole(text, place):
    """A whole number that 64 bits hold; 12.0 and 1.2e1 are."""
    if NUMBER.fullmatch(text):
        value = int(text) if text.lstrip("+-").isdigit() else float(text)
        if value == int(value if abs(value) < 2**63 else 0) and abs(value) < 2**63:
            return int(value)
    raise ConvertError(f"{place}: '{clipped(text)}' is not a whole number")


def numbers(texts, places, power=0):
    """The numbers of a column, times a power of ten; the place of each text is for messages."""
    if set().union(*texts) <= SIGNS:  # of which float() makes nothing but what number() does
        try:
            values = numpy.array([units.shifted(text, power) for text in texts] if power else list(map(float, texts)), float)
            if numpy.isfinite(values).all():
                return values
        except (ValueError, ArithmeticError):
            pass
    return numpy.array([number(text, place, power) for text, place in zip(texts, places)], float)


def wholes(texts, places):
    """The whole numbers of a column."""
    if set().union(*texts) <= DIGITS:
        try:
            return numpy.array(list(map(int, texts)), numpy.int64)
        except (ValueError, OverflowError):
            pass
    return numpy.array([whole(text, place) for text, place in zip(texts, places)], numpy.int64)


def clipped(text):
    """What a file says, short enough for a sentence on one line."""
    text = "".join(sign if sign.isprintable() else "?" for sign in str(text))
    return text if len(text) <= 60 else text[:57] + "..."


def word(name):
    """A name for a format in which blanks part words, and colons or quotes mean something."""
    return re.sub(r"[\s:\"'=]", "_", name) or "_"


def words_for(names, what):
    """Names as single words; refuses two that would become one, and says what was changed."""
    short = [word(name) for name in names]
    for name, each in zip(names, short):
        if short.count(each) > 1:
            raise ConvertError(f"the {what} '{clipped(name)}' and another one are both written as {each}; rename one")
        if name != each:
            warn(f"the {what} '{clipped(name)}' is written as {each}: the format parts words by blanks and colons")
    return short


# ---- arrays of many columns ----------------------------------------------------------------------------------------------------
def split_columns(group, known):
    """The other arrays of a group as columns of single numbers."""
    return kiln.columns({name: values for name, values in group.items() if name not in known})


def joined_columns(columns):
    """The inverse: name[0], name[1]… become one array with a row for each particle or bond. Other names stay columns."""
    widths = {}
    for name in columns:
        stem, _, index = name.rpartition("[")
        if stem and index[:-1].isdigit() and index.endswith("]"):
            widths.setdefault(stem, set()).add(index[:-1])
    whole_ones = {stem: len(found) for stem, found in widths.items()
                  if stem not in columns and found == {str(k) for k in range(len(found))}}
    arrays = {name: numpy.asarray(values) for name, values in columns.items() if name.rpartition("[")[0] not in whole_ones}
    for stem, width in whole_ones.items():
        arrays[stem] = numpy.stack([columns[f"{stem}[{k}]"] for k in range(width)], axis=1)
    return arrays


# ---- boxes ---------------------------------------------------------------------------------------------------------------------
def box_of(low, high, periodic=None):
    """The box between two corners, m; periodic is None where a file does not say it."""
    box = {"origin": [float(x) for x in low], "vectors": numpy.diag(numpy.subtract(high, low)).tolist()}
    if periodic is not None:
        box["periodic"] = [bool(p) for p in periodic]
    return box


def bounds(box):
    """Lower and upper corner of a state's box, m."""
    low = numpy.array(box.get("origin", (0.0, 0.0, 0.0)), float)
    return low, low + numpy.diag(box["vectors"])


def periodic_axes(box):
    return [bool(p) for p in box.get("periodic", (True, True, True))]


def free_box(position, radius, place):
    """A box that just holds a body without periodic faces."""
    if not len(radius):
        raise ConvertError(f"{place}: has neither a box nor particles")
    return box_of((position - radius[:, None]).min(axis=0), (position + radius[:, None]).max(axis=0), (False, ) * 3)


# ---- particles and bonds -------------------------------------------------------------------------------------------------------
def particle_arrays(document):
    """Particles with the arrays that may be missing from a stream."""
    particles = dict(document["particles"])
    count = len(particles["radius"])
    particles.setdefault("id", numpy.arange(count, dtype=numpy.int64))
    particles.setdefault("material", numpy.zeros(count, numpy.int32))
    return particles


def bond_arrays(document):
    """Bonds with the arrays that may be missing from a stream; None for a state without bonds."""
    if "bonds" not in document:
        return None
    bonds = dict(document["bonds"])
    bonds.setdefault("image", numpy.zeros((len(bonds["radius"]), 3), numpy.int8))
    bonds.setdefault("volume", kiln.cylinder_volume(bonds["radius"], bonds["length"]))
    return bonds


def nearest_image(document, pair):
    """The image of each pair's second particle that is nearest to its first."""
    low, high = bounds(document["box"])
    position = document["particles"]["position"]
    step = (position[pair[:, 1]] - position[pair[:, 0]]) / (high - low)
    return -numpy.round(step).astype(numpy.int64) * periodic_axes(document["box"])


def neck_length(document, pair, image, radius):
    """Length of bonds between the particles' surfaces, m (Eq. 4 of Dosta et al. 2017); zero for one that spheres hide."""
    low, high = bounds(document["box"])
    position, size = document["particles"]["position"], document["particles"]["radius"]
    distance = numpy.linalg.norm(position[pair[:, 1]] + image * (high - low) - position[pair[:, 0]], axis=1)
    caps = [numpy.sqrt(numpy.maximum(size[pair[:, end]]**2 - radius**2, 0.0)) for end in (0, 1)]
    return numpy.maximum(distance - caps[0] - caps[1], 0.0)


def rows_of(ids, wanted, place):
    """Rows of the particles with the wanted ids."""
    wanted = numpy.reshape(wanted, (-1, 2))
    order = numpy.argsort(ids, kind="stable")
    found = numpy.searchsorted(ids, wanted, sorter=order).clip(max=len(ids) - 1)
    if not len(ids) and len(wanted) or len(ids) and (ids[order[found]] != wanted).any():
        missing = wanted[ids[order[found]] != wanted][0] if len(ids) else wanted[0, 0]
        raise ConvertError(f"{place}: a bond names particle {missing}, which is not there")
    return order[found].astype(numpy.int32).reshape(-1, 2) if len(ids) else numpy.zeros((0, 2), numpy.int32)
