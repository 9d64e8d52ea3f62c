"""dem_state.py: reads and writes streams of dem-state documents, text and binary, as numpy arrays (see docs/dem-state.5)."""
import json
import math

import numpy

ALIGNMENT = 64  # bytes


def groups(document):
    """The two places of a document where arrays live; a result may use the same keys for a number."""
    return {key: document[key] for key in ("particles", "bonds") if isinstance(document.get(key), dict)}


def read(stream):
    """The documents of an open binary file or pipe, one after the other, as dictionaries; arrays are numpy arrays."""
    for line in iter(stream.readline, b""):
        if not line.strip():
            continue
        document = json.loads(line)
        size = document.pop("bytes", 0)
        payload = bytearray(stream.read(size))
        if len(payload) < size:
            raise ValueError(f"{size} bytes belong behind the header, {len(payload)} are there")
        for arrays in groups(document).values():
            for name, spec in arrays.items():
                dtype, shape = "<" + spec["type"], spec["shape"]
                if "data" in spec:
                    array = numpy.array(spec["data"], dtype)
                else:
                    array = numpy.frombuffer(payload, dtype, math.prod(shape), spec["at"])
                arrays[name] = array.reshape(shape)
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


def relative_density(state):
    """Volume of particles and bonds over the volume of the box."""
    solid = 4 / 3 * math.pi * (state["particles"]["radius"] ** 3).sum()
    if "bonds" in state:
        bonds = state["bonds"]
        solid += (bonds["volume"] if "volume" in bonds else math.pi * bonds["radius"] ** 2 * bonds["length"].clip(min=0)).sum()
    return solid / abs(numpy.linalg.det(state["box"]["vectors"]))
