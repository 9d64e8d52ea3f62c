"""dem_state.py: reads and writes streams of dem-state documents, text and binary, as numpy arrays (see docs/dem-state.5)."""
import json
import math

import numpy

ALIGNMENT = 64  # bytes
MOST_KEYS, DEEPEST = 1024, 64  # of an object and of what stands in it; only hostile documents have more
PIECE = 1 << 26  # bytes that are read at once: a header may promise more than there is
TYPES = ("f8", "f4", "i8", "i4", "i2", "i1", "u1")


def groups(document):
    """The places of a document where arrays live; a result may use the same keys for a number."""
    return {key: document[key] for key in ("particles", "bonds", "necks") if isinstance(document.get(key), dict)}


def unrepeated(pairs):
    """An object of JSON; a key that stands twice is refused."""
    keys = dict(pairs)
    if len(pairs) > MOST_KEYS:
        raise ValueError(f"an object has {len(pairs)} keys, more than {MOST_KEYS}")
    if len(keys) < len(pairs):
        names = [key for key, _ in pairs]
        raise ValueError(f"key '{next(key for key in names if names.count(key) > 1)}' stands twice")
    return keys


def refuse_constant(name):
    raise ValueError(f"{name} is no number")


def check_depth(value, left=DEEPEST):
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    if left < 0:
        raise ValueError(f"values stand more than {DEEPEST} levels deep")
    for each in inner:
        if isinstance(each, (dict, list)):
            check_depth(each, left - 1)


def header_of(line):
    try:
        header = json.loads(line, object_pairs_hook=unrepeated, parse_constant=refuse_constant)
    except (json.JSONDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(f"is no line of JSON ({error})") from None
    if not isinstance(header, dict):
        raise ValueError("is not a JSON object")
    check_depth(header, DEEPEST - 1)
    size = header.pop("bytes", 0)
    if not isinstance(size, int) or isinstance(size, bool) or size < 0:
        raise ValueError("bytes is not a number of bytes")
    return header, size


def array_of(name, spec, payload):
    """The array that an object with type, shape, and data or at describes."""
    if not isinstance(spec, dict) or spec.get("type") not in TYPES or ("data" in spec) == ("at" in spec):
        raise ValueError(f"{name} is not an array with type, shape, and data or at")
    dtype, shape = numpy.dtype("<" + spec["type"]), spec.get("shape")
    if not isinstance(shape, list) or not shape or not all(type(n) is int and 0 <= n < 2**31 for n in shape):
        raise ValueError(f"{name}: shape is not a list of sizes")
    count = math.prod(shape)
    if "at" in spec:
        at = spec["at"]
        if type(at) is not int or at < 0 or at + count * dtype.itemsize > len(payload):
            raise ValueError(f"{name} lies beyond the {len(payload)} bytes behind the header")
        return numpy.frombuffer(payload, dtype, count, at).reshape(shape)
    data, kinds = spec["data"], (int, float) if dtype.kind == "f" else (int, )
    if not isinstance(data, list) or len(data) != count or not all(type(value) in kinds for value in data):
        raise ValueError(f"{name}: data is not a list of {count} numbers of type {spec['type']}")
    try:
        array = numpy.array(data, float if dtype.kind == "f" else numpy.int64)
    except OverflowError:
        array = None
    with numpy.errstate(over="ignore"):
        narrow = None if array is None else array.astype(dtype)
    if narrow is None or dtype.kind != "f" and (narrow != array).any() or not numpy.isfinite(narrow).all():
        raise ValueError(f"{name}: a number is beyond the type {spec['type']}")
    return narrow.reshape(shape)


def read(stream):
    """The documents of an open binary file or pipe, one after the other, as dictionaries; arrays are numpy arrays. ValueError for
    what is no such document."""
    for line in iter(stream.readline, b""):
        if not line.strip():
            continue
        document, size = header_of(line)
        payload = bytearray()
        while len(payload) < size and (piece := stream.read(min(size - len(payload), PIECE))):
            payload += piece
        if len(payload) < size:
            raise ValueError(f"{size} bytes belong behind the header, {len(payload)} are there")
        for group, arrays in groups(document).items():
            for name, spec in arrays.items():
                arrays[name] = array_of(f"{group}.{name}", spec, payload)
        yield document


def write(stream, document, text=False):
    """Writes one document to an open binary file or pipe: as a line of text, or with its arrays behind the header."""
    header, payload = dict(document), bytearray()
    for group, arrays in groups(document).items():
        for name, values in arrays.items():
            array = numpy.ascontiguousarray(values)
            spec = {"type": f"{array.dtype.kind}{array.dtype.itemsize}", "shape": array.shape}
            if text:
                spec["data"] = array.ravel().tolist()
            else:
                spec["at"] = len(payload)
                payload += array.astype(array.dtype.newbyteorder("<")).tobytes()
                payload += bytes(-len(payload) % ALIGNMENT)
            header[group] = {**header[group], name: spec}
    if payload:
        header["bytes"] = len(payload)
    line = json.dumps(header, allow_nan=False, separators=(",", ":")).encode()
    if payload:
        line += b" " * (-(len(line) + 1) % ALIGNMENT)
    stream.write(line + b"\n" + payload)


def read_file(path):
    """All documents of a file."""
    with open(path, "rb") as stream:
        return list(read(stream))


def cylinder_volume(radius, length):
    """Volume of bonds that do not say it, m3: of their cylinders."""
    return math.pi * radius**2 * length.clip(min=0)


def relative_density(state):
    """Volume of particles and bonds over the volume of the box."""
    solid = 4 / 3 * math.pi * (state["particles"]["radius"]**3).sum()
    if "bonds" in state:
        bonds = state["bonds"]
        solid += (bonds["volume"] if "volume" in bonds else cylinder_volume(bonds["radius"], bonds["length"])).sum()
    return solid / abs(numpy.linalg.det(state["box"]["vectors"]))
