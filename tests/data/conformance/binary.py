#!/usr/bin/env python3
"""binary.py: writes those documents of this folder that hold binary arrays; the others are text and edited by hand."""
import json
import struct
from math import inf, nan
from pathlib import Path

HERE = Path(__file__).parent
BOX = {"vectors": [[4, 0, 0], [0, 4, 0], [0, 0, 4]]}
POSITION = struct.pack("<6d", 1, 1, 1, 2.5, 1, 1)
RADIUS = struct.pack("<2d", 1, 0.75)
TEXT_RADIUS = {"type": "f8", "shape": [2], "data": [1, 0.75]}


def array(kind, shape, at):
    return {"type": kind, "shape": shape, "at": at}


def header(bytes_behind, position=0, radius=64, **more):
    """The line of a document of two particles, padded with blanks to a multiple of 64 bytes."""
    arrays = {"position": array("f8", [2, 3], position), "radius": array("f8", [2], radius), **more}
    line = json.dumps({"box": BOX, "particles": arrays, "bytes": bytes_behind}, separators=(",", ":")).encode()
    return line + b" " * (-(len(line) + 1) % 64) + b"\n"


def payload(position=POSITION, radius=RADIUS):
    return position.ljust(64, b"\0") + radius.ljust(64, b"\0")


def state(position=POSITION, radius=RADIUS):
    return header(128) + payload(position, radius)


def write(name, content):
    (HERE / (name + ".dem")).write_bytes(content)


WHOLE = state()
BEHIND = len(header(128))
MINIMAL = (HERE / "valid/minimal.dem").read_bytes()

write("valid/binary", WHOLE)
write("valid/binary-two-documents", WHOLE + WHOLE)
write("valid/binary-gaps", header(160, position=96, radius=5) + b"x" * 5 + RADIUS + b"x" * 75 + POSITION + b"x" * 16)
write("valid/binary-beside-text", json.dumps(
    {"box": BOX, "particles": {"radius": TEXT_RADIUS, "position": array("f8", [2, 3], 0)}, "bytes": 48}).encode()
    + b"\n" + POSITION)
write("valid/binary-zero-particles", json.dumps(
    {"box": BOX, "particles": {"position": array("f8", [0, 3], 0), "radius": array("f8", [0], 0)}, "bytes": 0}).encode() + b"\n")
write("valid/binary-nan-in-unknown-array",
      header(192, **{"measured": array("f4", [2], 128)}) + payload() + struct.pack("<2f", nan, inf).ljust(64, b"\0"))
write("valid/text-and-binary", MINIMAL + WHOLE + MINIMAL)

write("invalid/binary-position-nan", state(position=struct.pack("<6d", 1, 1, 1, 2.5, nan, 1)))
write("invalid/binary-position-infinite", state(position=struct.pack("<6d", 1, -inf, 1, 2.5, 1, 1)))
write("invalid/binary-radius-nan", state(radius=struct.pack("<2d", nan, 1)))
write("invalid/binary-radius-infinite", state(radius=struct.pack("<2d", 1, inf)))
write("invalid/binary-radius-zero", state(radius=struct.pack("<2d", 1, -0.0)))
write("invalid/binary-cut", WHOLE[:BEHIND + 100])
write("invalid/binary-cut-at-header", WHOLE[:BEHIND])
write("invalid/binary-second-cut", WHOLE + WHOLE[:BEHIND + 1])
write("invalid/binary-beyond", header(128, radius=120) + payload())
write("invalid/binary-at-overflow", header(128, radius=2**64 - 8) + payload())
write("invalid/binary-overlap", header(128, radius=47) + payload())
write("invalid/binary-huge-array", header(2**50, big=array("u1", [2**31 - 1, 2**18], 128)) + payload())
write("invalid/binary-bytes-too-few", header(120) + payload())
