"""mutate_formats.py: feeds spoilt files of other programs to dem-convert: each has to give the right state or be refused in one
sentence; what has no fault has to be taken. What comes out goes to `analyze info` at the end, which has to read all of it."""
import argparse
import collections
import os
import random
import subprocess
import sys
import tempfile

import numpy
from foreign import FORMATS
from in_process import convert, kiln, program

TIGHT = 1e-12  # relative; of sums and differences of the box
UNKNOWN = {}  # what has to come out of a file of which any bytes are others


def difference(state, right):
    """What is not as it has to be, or None."""
    particles = state["particles"]
    order = numpy.argsort(particles["id"], kind="stable")
    wanted = numpy.argsort(right["id"], kind="stable")
    if len(order) != len(wanted):
        return f"{len(order)} particles, not {len(wanted)}"
    if particles["id"][order].tolist() != numpy.array(right["id"], int)[wanted].tolist():
        return f"ids {particles['id'].tolist()}, not {right['id']}"
    for name in ("position", "radius"):
        if not numpy.allclose(particles[name][order], numpy.array(right[name])[wanted], rtol=TIGHT, atol=0):
            return f"{name} {particles[name][order].tolist()}, not {numpy.array(right[name])[wanted].tolist()}"
    if "material" in right:
        names = [state["materials"][kind]["name"] for kind in particles["material"]]
        told = [name if isinstance(name, str) else (f"type{name}", f"material{name}") for name in right["material"]]
        if any(name != each and name not in each for name, each in zip(names, told)):
            return f"materials {names}, not {right['material']}"
    box, low = state["box"], numpy.array(state["box"]["origin"])
    if right["box"]:
        high = low + numpy.diag(box["vectors"])
        if not numpy.allclose([low, high], right["box"], rtol=TIGHT, atol=TIGHT * numpy.abs(right["box"]).max()):
            return f"box {[low.tolist(), high.tolist()]}, not {right['box']}"
    if right["periodic"] is not None and box["periodic"] != right["periodic"]:
        return f"periodic {box['periodic']}, not {right['periodic']}"
    if not numpy.isclose(state["time"], right["time"], rtol=TIGHT, atol=0):
        return f"time {state['time']}, not {right['time']}"
    return difference_of_bonds(state, right)


def difference_of_bonds(state, right):
    bonds = state.get("bonds")
    if ("bonds" in right) != (bonds is not None):
        return f"bonds {bonds is not None}"
    if bonds is None:
        return None
    ids = state["particles"]["id"]
    found = sorted([*sorted(ids[pair].tolist()), radius, length] for pair, radius,
                   length in zip(bonds["pair"], bonds["radius"], bonds["length"]))
    wanted = sorted([*sorted(each[:2]), *each[2:]] for each in right["bonds"])
    if len(found) != len(wanted):
        return f"{len(found)} bonds, not {len(wanted)}"
    for one, other in zip(found, wanted):
        if one[:2] != other[:2] or any(b is not None and not numpy.isclose(a, b, rtol=TIGHT, atol=0) for a,
                                       b in zip(one[2:], other[2:])):
            return f"bonds {found}, not {wanted}"
    return None


PIECES = [b" ", b"\n", b"-", b"e", b".", b"9", b'"', b"#", b"=", b"/", b"ITEM: ", b"nan", b"\xc2\xb5", b"\0", b"[", b"("]


def with_bytes(chance, content):
    """One to three places are others. What has to come out is not known; it has to be a sound state, or a sentence."""
    spoilt = bytearray(content)
    for _ in range(chance.choice([1, 1, 2, 3])):
        k = chance.randrange(len(spoilt) + 1)
        start = max(0, k - chance.choice([1, 5, 60]))
        change = chance.randrange(4)
        if change == 0:
            spoilt[k:k + 1] = bytes([chance.randrange(256)])
        elif change == 1:
            del spoilt[start:k]
        elif change == 2:
            spoilt[k:k] = spoilt[start:k]
        else:
            spoilt[k:k] = chance.choice(PIECES)
    return bytes(spoilt)


def case_of(name, seed):
    """A case of a format; of every fourth one bytes are others too, and nothing is known of what has to come out."""
    chance = random.Random(f"{name} {seed}")
    case = FORMATS[name](chance)
    if seed % 4 == 3:
        case.files = {each: with_bytes(chance, content) for each, content in case.files.items()}
        case.right, case.sound, case.what = UNKNOWN, False, f"{case.what}, bytes"
    return case


def outcome(case, folder):
    """taken or refused; ValueError for any other end."""
    for name in os.listdir(folder):
        os.unlink(os.path.join(folder, name))
    for name, content in case.files.items():
        with open(os.path.join(folder, name), "wb") as file:
            file.write(content)
    source, target = os.path.join(folder, next(iter(case.files))), os.path.join(folder, "out.kiln")
    status, _, error = convert("-q", *case.options, source, target)
    if status:
        if status != 1 or "\n" in error or not error.startswith("dem-convert: ") or len(error) > 1000:
            raise ValueError(f"status {status}, said {error!r}")
        if case.sound:
            raise ValueError(f"is sound and was refused: {error}")
        return "refused", None
    states = kiln.read(target)
    if case.right is None:
        raise ValueError("was taken, and had to be refused")
    for state in states if case.right is not UNKNOWN else ():
        if wrong := difference(state, case.right):
            raise ValueError(f"gives {wrong}")
    with open(target, "rb") as file:
        return "taken", file.read()


def readable(stream, count):
    """Feeds all that was written to `analyze info`."""
    ended = subprocess.run([program("ANALYZE"), "info"], input=stream, capture_output=True, check=False)
    if ended.returncode or ended.stdout.count(b"\n") < count:
        raise SystemExit(f"analyze info does not read what dem-convert wrote: {ended.stderr.decode()}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200, help="mutants of each format")
    parser.add_argument("--first", type=int, default=0, help="seed of the first one")
    parser.add_argument("--formats", nargs="*", choices=FORMATS, default=list(FORMATS))
    parser.add_argument("--keep", metavar="FOLDER", help="where the files go that had another end")
    given = parser.parse_args()
    faults = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in given.formats:
            ends, stream, states = collections.Counter(), [], 0
            for seed in range(given.first, given.first + given.count):
                case = case_of(name, seed)
                try:
                    end, written = outcome(case, folder)
                    ends[end] += 1
                    if written:
                        stream.append(written)
                        states += 1
                except Exception as error:  # whatever it is, it is no sentence
                    faults += 1
                    print(f"{name} {seed} ({case.what}) {' '.join(case.options)}: {type(error).__name__} {error}")
                    if given.keep:
                        for each, content in case.files.items():
                            with open(os.path.join(given.keep, f"{name}-{seed}-{each}"), "wb") as file:
                                file.write(content)
            readable(b"".join(stream), states)
            print(f"{name}: {given.count} mutants, {ends['taken']} right, {ends['refused']} refused")
    print(f"{faults} faults")
    return faults > 0


if __name__ == "__main__":
    sys.exit(main())
