"""mutants.py: valid streams, each spoilt in one to three places, the same for the same seed."""
import json
import random
import re
import struct

NUMBER = re.compile(rb"(?<=[:\[,])-?[0-9][0-9.eE+-]*")
STRANGE_NUMBERS = [b"NaN", b"-Infinity", b"1e999", b"1e308", b"-1", b"0", b"-0.0", b"1e-320", b"0.5", b"255", b"65536",
                   b"2147483648", b"4294967296", b"9223372036854775807", b"1e18", b"null", b"true", b'"1"', b"[]", b"{}"]
STRANGE_VALUES = [None, True, -1, 0, 3, 1e300, "", "x", [], [1, 2, 3], {}, {"type": "f8", "shape": [2 ** 31 - 1], "data": []}]
FACTORS = [-1, 0.5, 0.9, 1.1, 2, 10, 1e-6, 1e6, 1e-100, 1e100]
STRANGE_DOUBLES = [float("nan"), float("inf"), -float("inf"), 0.0, -0.0, -1.0, 1e300, 1e-310, 5e-8]


def header_length(stream):
    """Bytes of the first line, its end included."""
    end = stream.find(b"\n")
    return len(stream) if end < 0 else end + 1


def with_number(stream, chance):
    """One number of the header is another, or none."""
    found = list(NUMBER.finditer(stream, 0, header_length(stream)))
    if not found:
        return stream
    place = chance.choice(found)
    return stream[:place.start()] + chance.choice(STRANGE_NUMBERS) + stream[place.end():]


def with_bytes(stream, chance):
    """A few bytes are others."""
    spoilt = bytearray(stream)
    for _ in range(chance.randint(1, 8)):
        spoilt[chance.randrange(len(spoilt))] = chance.randrange(256)
    return bytes(spoilt)


def with_bit(stream, chance):
    """One bit is the other."""
    spoilt = bytearray(stream)
    spoilt[chance.randrange(len(spoilt))] ^= 1 << chance.randrange(8)
    return bytes(spoilt)


def with_double(stream, chance):
    """Eight bytes of the payload, where a number may stand, are another number."""
    start = header_length(stream)
    if len(stream) - start < 8:
        return with_number(stream, chance)
    place = start + 8 * chance.randrange((len(stream) - start) // 8)
    return stream[:place] + struct.pack("<d", chance.choice(STRANGE_DOUBLES)) + stream[place + 8:]


def scaled(stream, chance):
    """One number, of the payload where there is one, is multiplied: such mutants are often taken."""
    start = header_length(stream)
    factor = chance.choice(FACTORS)
    if len(stream) - start >= 8:
        place = start + 8 * chance.randrange((len(stream) - start) // 8)
        value = factor * struct.unpack_from("<d", stream, place)[0]
        return stream[:place] + struct.pack("<d", value) + stream[place + 8:]
    found = [each for each in NUMBER.finditer(stream) if re.search(rb"[.e]", each[0])]
    if not found:
        return stream
    place = chance.choice(found)
    try:
        return stream[:place.start()] + repr(factor * float(place[0])).encode() + stream[place.end():]
    except ValueError:  # what other changes made of it is no number
        return stream


def cut(stream, chance):
    """The end is missing."""
    return stream[:chance.randrange(len(stream))]


def with_slice(stream, chance):
    """A piece is missing, or stands twice."""
    start = chance.randrange(len(stream))
    end = min(len(stream), start + chance.randint(1, 200))
    return stream[:start] + stream[end:] if chance.random() < 0.5 else stream[:end] + stream[start:]


def objects_of(value):
    """All objects and lists inside a JSON value, itself included."""
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else []
    return ([value] if inner else []) + [each for part in inner for each in objects_of(part)]


def with_key(stream, chance):
    """A key or value of the header is missing, has another value, or has another name."""
    start = header_length(stream)
    try:
        header = json.loads(stream[:start])
    except ValueError:  # spoilt already
        return with_number(stream, chance)
    holder = chance.choice(objects_of(header) or [{"x": 0}])
    key = chance.choice(list(holder) if isinstance(holder, dict) else range(len(holder)))
    change = chance.randrange(3)
    if change == 0:
        del holder[key]
    elif change == 1 or isinstance(holder, list):
        holder[key] = chance.choice(STRANGE_VALUES)
    else:
        holder[key + "x"] = holder.pop(key)
    line = json.dumps(header, separators=(",", ":")).encode()
    return line + b" " * max(0, start - len(line) - 1) + b"\n" + stream[start:]


CHANGES = 4 * [scaled] + 2 * [with_number, with_key, with_double] + [with_bytes, with_bit, cut, with_slice]


def mutant(stream, seed):
    """The stream, spoilt in one to three places."""
    chance = random.Random(seed)
    for _ in range(chance.choice([1, 1, 1, 2, 3])):
        if stream:
            stream = chance.choice(CHANGES)(stream, chance)
    return stream
