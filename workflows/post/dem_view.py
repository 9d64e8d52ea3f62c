"""dem_view.py: the command dem-view: states as one page of HTML in which they are turned, cut and coloured (see dem_view.js)."""
import argparse
import base64
import decimal
import html
import json
import math
import os
import pathlib
import re
import string
import sys
import zlib

import numpy

import kiln
from convert_common import ConvertError, bounds, ended, particle_arrays, periodic_axes, written
from dem_convert import documents_of

HERE = pathlib.Path(__file__).resolve().parent
THREE = pathlib.Path("/usr/share/javascript/three")  # where Debian's libjs-three puts it
SCRIPTS = ("build/three.min.js", "examples/js/controls/OrbitControls.js")
PAGE_SIZE = "15MB"
PREFIXES = ("a", "f", "p", "n", "\u00b5", "m", "", "k", "M", "G", "T")  # 10^-18 and on
SHOWN_DEFLECTION = 0.15  # of the bar's height; the true one is far too small to see
LEVELS = 255  # of a coloured quantity

# What is known of arrays that may be coloured by: label and unit. Other arrays of one number a row go by their own name.
PARTICLES = {
    "coordination": ("Coordination number", ""),
    "overlap": ("Overlap h/(R\u2081 + R\u2082), mean of its contacts", ""),
    "radius": ("Radius of particle or grain", "m"),
    "displacement": ("Displacement without that of the whole body", "m"),
    "material": ("Material, place in the list", "")
}
BONDS = {
    "radius": ("Radius of bond or neck", "m"),
    "normal_force": ("Normal force: compression < 0 < tension", "N"),
    "tensile_stress": ("Maximum tensile stress", "Pa"),
    "shear_stress": ("Maximum shear stress", "Pa"),
    "broken": ("Place in the order of breaks", "")
}

EXAMPLES = """examples:
  dem-view sintered.kiln -o sintered.html
  dem-view bonded.kiln bent.kiln -o bar.html
  sinter --temperature 1200C --to-density 0.6,0.67 green.kiln | dem-view -o sintered.html
"""


# ---- what a state does not say itself ------------------------------------------------------------------------------------------
def with_ghosts(position, radius, low, size, periodic):
    """Centres with the images that particles in the box may touch, m, and the row that each belongs to."""
    row, reach = numpy.arange(len(radius)), radius.max() + radius
    for axis in numpy.flatnonzero(periodic):
        near_low = position[:, axis] - low[axis] < reach[row]
        near_high = low[axis] + size[axis] - position[:, axis] < reach[row]
        step = numpy.eye(3)[axis] * size[axis]
        position = numpy.concatenate((position, position[near_low] + step, position[near_high] - step))
        row = numpy.concatenate((row, row[near_low], row[near_high]))
    return position, row


def contacts(position, radius, low, size, periodic):
    """Pairs of touching spheres (rows), their overlaps, m, and which of them touch through a periodic face.

    Each sphere looks among those of its own class of size (a factor of two) and below, in cells as wide as two of its class.
    """
    count = len(radius)
    everywhere, row = with_ghosts(position, radius, low, size, periodic)
    sizes = numpy.floor(numpy.log2(radius / radius.min())).astype(int)
    pairs, overlaps, crossing = [numpy.zeros((0, 2), int)], [numpy.zeros(0)], [numpy.zeros(0, bool)]
    for each in numpy.unique(sizes):
        width = 2 * radius[sizes == each].max()
        others = numpy.flatnonzero(sizes[row] <= each)
        cell = numpy.floor((everywhere - everywhere.min(axis=0)) / width).astype(numpy.int64) + 1
        strides = numpy.array([(cell[:, 1].max() + 2) * (cell[:, 2].max() + 2), cell[:, 2].max() + 2, 1])
        key = cell @ strides
        others = others[numpy.argsort(key[others], kind="stable")]
        for part in numpy.array_split(numpy.flatnonzero(sizes == each), 1 + count // 20000):
            for across in (x * strides[0] + y * strides[1] for x in (-1, 0, 1) for y in (-1, 0, 1)):
                first = numpy.searchsorted(key[others], key[part] + across - 1)
                found = numpy.searchsorted(key[others], key[part] + across + 1, "right") - first
                i = numpy.repeat(part, found)
                j = others[numpy.repeat(first - found.cumsum() + found, found) + numpy.arange(found.sum())]
                once = (sizes[row[j]] < each) | (i < row[j])
                i, j = i[once], j[once]
                overlap = radius[i] + radius[row[j]] - numpy.linalg.norm(everywhere[j] - everywhere[i], axis=1)
                touch = overlap > 0
                pairs.append(numpy.stack((i, row[j]), axis=1)[touch])
                overlaps.append(overlap[touch])
                crossing.append(j[touch] >= count)
    return tuple(numpy.concatenate(parts) for parts in (pairs, overlaps, crossing))


def without_rigid_motion(place, displacement):
    """The displacements, m, less the shift and the small rotation of the whole body; place: where the particles were, m."""
    arm, shift = place - place.mean(axis=0), displacement - displacement.mean(axis=0)
    inertia = (arm**2).sum() * numpy.eye(3) - arm.T @ arm
    rotation = numpy.linalg.lstsq(inertia, numpy.cross(arm, shift).sum(axis=0), rcond=None)[0]
    return shift - numpy.cross(rotation, arm)


def bent_positions(particles, height):
    """Centres with the bending exaggerated, m, and the factor, one digit and zeros; height: that of the bar, m."""
    place = particles["position"] - particles["displacement"]
    bending = without_rigid_motion(place, particles["displacement"])
    low, high = numpy.quantile(bending[:, 2], (0.01, 0.99))
    if not high > low:
        return place + bending, 1.0
    factor = SHOWN_DEFLECTION * height / (high - low)
    unit = 10**numpy.floor(numpy.log10(factor))
    factor = max(1.0, unit * numpy.floor(factor / unit))
    return place + factor * bending, factor


# ---- one state -----------------------------------------------------------------------------------------------------------------
class Body:
    """A state as it is drawn: particles inside their box and in an order in which neighbours stand together."""

    def __init__(self, document, known_orders):
        particles = particle_arrays(document)
        self.low, high = bounds(document["box"])
        self.size, self.periodic = high - self.low, numpy.array(periodic_axes(document["box"]))
        position = particles["position"]
        cell = (position - self.low) / self.size
        self.moved = numpy.where(self.periodic, -numpy.floor(cell), 0.0).astype(int)  # box edges, to be inside
        position = position + self.moved * self.size
        ids = particles["id"]
        order = known_orders.setdefault(ids.tobytes(), order_in_space(position))
        self.ids, self.position, self.radius = ids[order], position[order], particles["radius"][order]
        self.place_of = numpy.argsort(order)  # of each row of the document
        self.particles = {
            name: particles[name][order]
            for name in particles if name not in ("id", "position", "radius") and particles[name].ndim == 1
        }
        self.add_pairs(document)
        self.enlarged = 0.0
        if "displacement" in particles and numpy.any(particles["displacement"]):
            bent, self.enlarged = bent_positions(particles, numpy.ptp(position[:, 2]))
            self.position = bent[order]
            place = particles["position"] - particles["displacement"]
            bending = without_rigid_motion(place, particles["displacement"])
            self.particles["displacement"] = numpy.linalg.norm(bending, axis=1)[order]

    def add_pairs(self, document):
        """Bonds of the state; without them its contacts, with the necks of the sintering law. And what they say of particles."""
        count = len(self.radius)
        pair, overlap, crossing = contacts(self.position, self.radius, self.low, self.size, self.periodic)
        if "necks" in document:
            pair, overlap, crossing = self.with_necks(document["necks"], pair, overlap, crossing)
        touching = numpy.bincount(pair.ravel(), minlength=count)
        ratio = overlap / self.radius[pair].sum(axis=1)
        total = sum(numpy.bincount(pair[:, end], ratio, count) for end in (0, 1))
        if ratio.max(initial=0.0) > 1e-6:  # what remains of rounding where bondify has shrunk the spheres
            self.particles["overlap"] = numpy.where(touching > 0, total / numpy.maximum(touching, 1), 0.0)
        self.of_law = "bonds" not in document
        if self.of_law:
            bonds = {"radius": neck_radius(self.radius[pair], overlap)}
        else:
            bonds = {name: values for name, values in document["bonds"].items() if values.ndim == 1}
            pair, crossing = self.drawn_pairs(document["bonds"])
            touching = numpy.bincount(pair.ravel(), minlength=count)
        self.particles["coordination"] = touching
        pair = numpy.sort(pair, axis=1)
        order = numpy.lexsort((pair[:, 1], pair[:, 0]))
        order = order[~crossing[order]]
        self.pair, self.crossing = pair[order], int(crossing.sum())
        self.bonds = {name: values[order] for name, values in bonds.items() if name not in ("volume", "length")}


    def drawn_pairs(self, group):
        """The pairs of bonds or necks, as places in self, and which of them go through a face."""
        rows = group["pair"]
        image = group.get("image", numpy.zeros((len(rows), 3), numpy.int8))
        return self.place_of[rows], (image + self.moved[rows[:, 0]] - self.moved[rows[:, 1]] != 0).any(axis=1)

    def with_necks(self, necks, pair, overlap, crossing):
        """Contacts in which those whose neck the state gives have the overlap that belongs to it, h = a^2/(4 R*)."""
        given, through = self.drawn_pairs(necks)
        name = [numpy.sort(each, axis=1) @ [len(self.radius), 1] for each in (pair, given)]
        others = ~numpy.isin(*name)
        radius = self.radius[given]
        shown = necks["radius"]**2 * radius.sum(axis=1) / (4 * radius.prod(axis=1))
        pairs = ((pair, given), (overlap, shown), (crossing, through))
        return tuple(numpy.concatenate((found[others], known)) for found, known in pairs)


def neck_radius(radius, overlap):
    """a, m, of the sintering law: a^2 = 4 R* h, and no wider than the smaller sphere (Bouvard & McMeeking 1996)."""
    reduced = radius.prod(axis=1) / radius.sum(axis=1)
    return numpy.minimum(numpy.sqrt(4 * reduced * overlap), radius.min(axis=1))


def order_in_space(position):
    """Rows along a curve through all cells of an octree: neighbours get near places, which packs well."""
    low = position.min(axis=0)
    cell = ((position - low) / max(numpy.ptp(position, axis=0).max(), 1e-300) * 65535).astype(numpy.uint64)
    key = numpy.zeros(len(position), numpy.uint64)
    for bit in range(16):
        for axis in range(3):
            key |= ((cell[:, axis] >> numpy.uint64(bit)) & numpy.uint64(1)) << numpy.uint64(3 * bit + axis)
    return numpy.argsort(key, kind="stable")


# ---- numbers into blocks of text -----------------------------------------------------------------------------------------------
class Block(str):
    """Text that stands once in a page, however many states have it."""


def packed(values):
    """Numbers of one type as text: byte planes one after the other, deflated, in base64."""
    planes = numpy.ascontiguousarray(values).reshape(-1).view(numpy.uint8).reshape(-1, values.itemsize).T
    return Block(base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode())


def with_places(value, places):
    """The value with the number of each block in the place of its text; places gets those that are new."""
    if isinstance(value, Block):
        return places.setdefault(value, len(places))
    if isinstance(value, dict):
        return {key: with_places(part, places) for key, part in value.items()}
    return [with_places(part, places) for part in value] if isinstance(value, list) else value


def steps(values):
    """Differences from row to row, column after column; they wrap around as the sums in the page do."""
    return numpy.diff(values, axis=0, prepend=numpy.zeros_like(values[:1])).T


def levels(values, low, high, top=LEVELS, kind=numpy.uint8):
    span = high - low
    return numpy.round((values - low).clip(0, span) / numpy.where(span > 0, span, 1.0) * top).astype(kind)


def scaled(largest, unit):
    """The factor and the unit in which a size has one to three digits before its point: 5e-8 m in nm."""
    if not unit or not largest > 0:
        return 1.0, unit
    power = min(max(math.floor(math.log10(largest) / 3 + 1e-9), -6), 4)
    return 10.0**(-3 * power), PREFIXES[power + 6] + unit


class Quantity:
    """What can be coloured by, over all states: range, unit and kind of scale. Of a signed one the outermost 1 % are cut off."""

    def __init__(self, name, known, arrays):
        self.label, unit = known.get(name, (name.replace("_", " "), ""))
        self.whole = all(values.dtype.kind in "iub" for values in arrays)
        self.low, self.high = min(float(v.min()) for v in arrays), max(float(v.max()) for v in arrays)
        self.cut = name.endswith(("force", "stress", "displacement"))
        if self.cut:
            low = min(float(numpy.quantile(values, 0.005)) for values in arrays)
            high = max(float(numpy.quantile(values, 0.995)) for values in arrays)
            self.low, self.high = (-max(-low, high), max(-low, high)) if low < 0 < high else (low, high)
        elif self.whole and self.high - self.low <= LEVELS:
            self.high = self.low + max(self.high - self.low, 1.0)
        elif self.low >= 0 and not self.whole:
            self.low = 0.0
        self.factor, self.unit = scaled(max(abs(self.low), abs(self.high)), unit)

    def header(self):
        return {
            "label": self.label,
            "unit": self.unit,
            "low": self.low * self.factor,
            "high": self.high * self.factor,
            "whole": self.whole,
            "cut": self.cut,
            "signed": self.low < 0 < self.high
        }


def quantities(known, groups):
    """The quantities of all states by name, the known ones first; those that are equal everywhere are no colour."""
    names = dict.fromkeys([*known, *(name for group in groups for name in group)])
    found = {}
    for name in names:
        arrays = [group[name] for group in groups if len(group.get(name, ()))]
        arrays = [values.astype(float) if values.dtype.kind == "f" else values for values in arrays]
        if arrays and all(numpy.isfinite(values).all() for values in arrays):
            if name in ("radius", "coordination") or min(v.min() for v in arrays) < max(v.max() for v in arrays):
                found[name] = Quantity(name, known, arrays)
    return found


class Scene:
    """The states of a stream as a page holds them. Only packed positions and what is coloured stay in memory, not the documents."""

    def __init__(self, documents):
        self.states, self.groups, orders = [], {"particles": [], "bonds": []}, {}
        for document in documents:
            self.add(document, Body(document, orders))
        if not self.states:
            raise ConvertError("there is no state to show")
        self.factor, self.unit = scaled(4 * max(state["radius_scale"] for state in self.states), "m")
        self.scales = {kind: quantities(known, self.groups[kind]) for kind, known in (("particles", PARTICLES), ("bonds", BONDS))}
        for number, state in enumerate(self.states):
            self.finish(number, state)

    def add(self, document, body):
        low = numpy.minimum(body.low, body.position.min(axis=0))
        high = numpy.maximum(body.low + body.size, body.position.max(axis=0))
        middle, largest = body.low + body.size / 2, float(body.radius.max())
        self.groups["particles"].append({name: small(values) for name, values in {**body.particles, "radius": body.radius}.items()})
        self.groups["bonds"].append({name: small(values) for name, values in body.bonds.items()})
        self.states.append({
            "time": float(document.get("time", 0.0)),
            "density": kiln.relative_density(document) if body.periodic.all() else None,
            "enlarged": float(body.enlarged),
            "low": low - middle,
            "high": high - middle,
            "box": body.size,
            "count": len(body.radius),
            "coordination": float(body.particles["coordination"].mean()),
            "ids": packed(body.ids.astype(numpy.int32)),
            "position": packed(steps(levels(body.position, low, high, 65535, numpy.uint16))),
            "radius": packed(levels(body.radius, 0.0, largest, 65535, numpy.uint16)),
            "radius_scale": largest,
            "bonds": {
                "count": len(body.pair),
                "crossing": body.crossing,
                "word": "neck" if body.of_law else "bond",
                "first": packed(steps(body.pair[:, :1].astype(numpy.int32))),
                "second": packed((body.pair[:, 1] - body.pair[:, 0]).astype(numpy.int32))
            }
        })

    def finish(self, number, state):
        """Lengths in the unit of the page, and the levels of colours, once the ranges of all states are known."""
        for name in ("low", "high", "box"):
            state[name] = (state[name] * self.factor).tolist()
        state["radius_scale"] *= self.factor
        for kind, target in (("particles", state), ("bonds", state["bonds"])):
            arrays = self.groups[kind][number]
            target["colours"] = {
                name: packed(levels(arrays[name].astype(float), scale.low, scale.high))
                for name, scale in self.scales[kind].items() if name in arrays
            }

    def fit(self, size):
        """Leaves out states, evenly, and then bonds, until the page's text is no longer than size bytes; says what it left out."""
        count = len(self.states)
        for every in range(1, count + 1):
            states = [*self.states[:-1:every], self.states[-1]] if count > 1 else self.states
            for keep_bonds in ((True, ) if len(states) > 2 else (True, False)):
                shown = states if keep_bonds else [without_bonds(state) for state in states]
                if sum(len(block) for block in blocks_of(shown)) <= size:
                    self.states = shown
                    left = [] if len(shown) == count else [f"{len(shown)} of {count} states"]
                    left += [] if keep_bonds else ["no bonds"]
                    return " and ".join(left)
        raise ConvertError(f"{self.states[0]['count']:,} particles do not fit; give a larger --size")

    def header(self, plots=()):
        places = {}
        states = with_places(self.states, places)
        scales = {kind: {name: scale.header() for name, scale in found.items()} for kind, found in self.scales.items()}
        return {"unit": self.unit, "quantities": scales, "states": states, "plots": list(plots), "blocks": list(places)}


def without_bonds(state):
    none = packed(numpy.zeros(0, numpy.int32))
    return {**state, "bonds": {**state["bonds"], "count": 0, "first": none, "second": none, "colours": {}}}


def small(values):
    return values.astype(numpy.float32) if values.dtype == numpy.float64 else values


def blocks_of(states):
    places = {}
    with_places(states, places)
    return places


# ---- the page ------------------------------------------------------------------------------------------------------------------
def scripts(folder):
    """three.js and its controls."""
    try:
        return [(folder / name).read_text(encoding="utf-8") for name in SCRIPTS]
    except OSError as error:
        raise ConvertError(f"{error.filename} cannot be read; install Debian's libjs-three, or say by --three where it is") \
            from None


def state_table(states):
    """What a reader without JavaScript sees of the states."""
    rows = "".join(f"<tr><td>{number}</td><td>{'' if state['density'] is None else format(state['density'], '.3f')}</td>"
                   f"<td>{state['time']:.4g}</td><td>{state['count']:,}</td><td>{state['coordination']:.2f}</td></tr>"
                   for number, state in enumerate(states, start=1))
    return ("<p>This view needs JavaScript and WebGL 2. The states in it:</p><table><tr><th>state</th><th>relative density</th>"
            f"<th>time, s</th><th>particles</th><th>coordination number</th></tr>{rows}</table>")


def fragment(scene, plots=(), fallback=None, three=THREE):
    """The view as a part of a page. fallback: what stands in its place, as HTML, where the view cannot be shown."""
    library, controls = (text.replace("</script", "<\\/script") for text in scripts(three))
    header = json.dumps(scene.header(plots), allow_nan=False, separators=(",", ":")).replace("</", "<\\/")
    template = string.Template((HERE / "dem_view.html").read_text(encoding="utf-8"))
    return template.substitute(fallback=fallback or state_table(scene.states),
                               data=header,
                               three=library,
                               controls=controls,
                               view=(HERE / "dem_view.js").read_text(encoding="utf-8"))


def page(scene, title, three=THREE):
    return ('<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
            f'<meta name="viewport" content="width=device-width, initial-scale=1"><title>{html.escape(title)}</title></head>'
            f'<body class="dem-view-page"><h1>{html.escape(title)}</h1>\n{fragment(scene, three=three)}</body></html>\n')


# ---- the command ---------------------------------------------------------------------------------------------------------------
def bytes_of(text):
    found = re.fullmatch(r"([0-9.]+)(kB|MB|GB)", text)
    try:
        size = decimal.Decimal(found[1]) * {"kB": 1000, "MB": 10**6, "GB": 10**9}[found[2]] if found else 0
    except decimal.InvalidOperation:
        size = 0
    if not size > 0:
        raise argparse.ArgumentTypeError(f"'{text}' is not a size greater than zero, such as {PAGE_SIZE}")
    return int(size)


def read_states(paths):
    """The states of the files, checked."""
    for path in paths:
        for number, document in enumerate(documents_of(path), start=1):
            if not len(document["particles"]["radius"]):
                raise ConvertError(f"{path}, document {number}: has no particles")
            yield document


def parser():
    parse = argparse.ArgumentParser(prog="dem-view",
                                    description="Writes a page in which states can be turned, cut and looked into.",
                                    epilog=EXAMPLES,
                                    formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("states", metavar="FILE", nargs="*", default=["-"], help="streams of states; - is standard input (default)")
    parse.add_argument("-o",
                       "--output",
                       metavar="FILE",
                       default="-",
                       help="page to write, whole or not at all; - is standard output (default)")
    parse.add_argument("--title", help="heading of the page (default: names of the files)")
    parse.add_argument("--size",
                       type=bytes_of,
                       default=PAGE_SIZE,
                       help="largest page, such as 40MB; states and then bonds are left out to keep it (default: %(default)s)")
    parse.add_argument("--three",
                       type=pathlib.Path,
                       default=THREE,
                       metavar="FOLDER",
                       help="where three.js is (default: %(default)s)")
    parse.add_argument("--version", action="version", version=f"dem-view (Kiln) {kiln.__version__}")
    return parse


def main():
    given = parser().parse_args()
    return ended("dem-view", given.output, lambda: view(given))


def view(given):
    size = given.size - sum(map(len, scripts(given.three))) - 100_000  # what else stands in a page
    scene = Scene(read_states(given.states))
    left = scene.fit(size)
    if left:
        print(f"dem-view: warning: the page holds {left}, to stay below --size", file=sys.stderr)
    names = ", ".join(os.path.basename(path) for path in given.states if path != "-")
    with written(given.output) as stream:
        stream.write(page(scene, given.title or names or "States", given.three))


if __name__ == "__main__":
    sys.exit(main())
