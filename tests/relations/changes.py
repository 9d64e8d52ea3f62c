"""changes.py: states changed in ways whose effect is known: moved, renumbered, turned, repeated, scaled."""
import copy

import numpy

from trial import kiln

VECTORS = {"position", "displacement", "rotation", "force", "moment"}  # arrays of three components


def lengths(document):
    """Edges of the box, m."""
    return numpy.diag(numpy.array(document["box"]["vectors"], float))


def origin(document):
    return numpy.array(document["box"].get("origin", (0.0, 0.0, 0.0)), float)


def periodic(document):
    return numpy.array(document["box"].get("periodic", (True, True, True)))


def with_box(document, edges, start, is_periodic):
    """A copy in another box, m."""
    changed = copy.deepcopy(document)
    changed["box"] = {**document["box"], "vectors": numpy.diag(edges).tolist(), "origin": list(map(float, start)),
                      "periodic": [bool(axis) for axis in is_periodic]}
    return changed


def translated(document, shift):
    """All particles moved, m, and the box left where it is: along periodic axes the same packing."""
    changed = copy.deepcopy(document)
    changed["particles"]["position"] = document["particles"]["position"] + shift
    return changed


def carried(document, shift):
    """Particles and box moved together, m: the same body elsewhere."""
    return translated(with_box(document, lengths(document), origin(document) + shift, periodic(document)), shift)


def moved_by_boxes(document, boxes):
    """Each particle moved by so many whole boxes, whole numbers Nx3; bonds join the same images as before."""
    changed = translated(document, boxes * lengths(document))
    if "bonds" in document:
        pair = document["bonds"]["pair"]
        changed["bonds"]["image"] = (image_of(document) + boxes[pair[:, 0]] - boxes[pair[:, 1]]).astype("i1")
    return changed


def image_of(document):
    bonds = document["bonds"]
    return bonds["image"].astype(int) if "image" in bonds else numpy.zeros((len(bonds["pair"]), 3), int)


def renumbered(document, order):
    """Rows in another order; every particle keeps its id."""
    changed = copy.deepcopy(document)
    for name, values in document["particles"].items():
        changed["particles"][name] = values[order]
    if "bonds" in document:
        changed["bonds"]["pair"] = numpy.argsort(order)[document["bonds"]["pair"]].astype("i4")
    return changed


def swapped(document, order, which):
    """Bonds in another order, those of `which` from their second particle to their first."""
    changed = copy.deepcopy(document)
    bonds = changed["bonds"]
    bonds["image"] = image_of(document).astype("i1")
    bonds["pair"][which] = bonds["pair"][which][:, ::-1]
    bonds["image"][which] *= -1
    for name, values in bonds.items():
        bonds[name] = values[order]
    return changed


def turned(document, axes, signs):
    """New axis k is old axis axes[k], seen the other way round where signs[k] is -1: the 48 symmetries of a box."""
    axes, signs = list(axes), numpy.array(signs)
    edges, start = lengths(document)[axes], origin(document)[axes]
    changed = with_box(document, edges, numpy.where(signs > 0, start, -(start + edges)), periodic(document)[axes])
    for arrays in kiln.groups(changed).values():
        for name in VECTORS & arrays.keys():
            arrays[name] = numpy.ascontiguousarray(arrays[name][:, axes] * signs)
    if "bonds" in document:
        changed["bonds"]["image"] = (image_of(document)[:, axes] * signs).astype("i1")
    return changed


def repeated(document, counts):
    """A periodic state counts[k] times along axis k, as one state; ids are new."""
    counts = numpy.array(counts)
    cells = numpy.array(list(numpy.ndindex(*counts)))
    number = len(document["particles"]["radius"])
    changed = with_box(document, lengths(document) * counts, origin(document), periodic(document))
    particles = changed["particles"]
    for name, values in document["particles"].items():
        particles[name] = numpy.concatenate([values] * len(cells))
    particles["position"] = particles["position"] + numpy.repeat(cells * lengths(document), number, axis=0)
    particles["id"] = numpy.arange(number * len(cells), dtype="i8")
    if "bonds" in document:
        bonds, image = changed["bonds"], image_of(document)
        for name, values in document["bonds"].items():
            bonds[name] = numpy.concatenate([values] * len(cells))
        target = numpy.concatenate([cell + image for cell in cells])
        home = target % counts
        rows = numpy.ravel_multi_index(home.T, counts) * number
        first = numpy.repeat(numpy.arange(len(cells)) * number, len(image))
        bonds["pair"] = (bonds["pair"] + numpy.stack([first, rows], axis=1)).astype("i4")
        bonds["image"] = (target // counts).astype("i1")
    return changed


def scaled(document, factor):
    """All lengths times a factor, about the origin of coordinates."""
    changed = with_box(document, lengths(document) * factor, origin(document) * factor, periodic(document))
    powers = {"position": 1, "radius": 1, "length": 1, "volume": 3}
    for arrays in kiln.groups(changed).values():
        for name in powers.keys() & arrays.keys():
            arrays[name] = arrays[name] * factor ** powers[name]
    return changed


def with_materials(document, materials, rows):
    """Of other materials, row by row."""
    changed = copy.deepcopy(document)
    changed["materials"] = materials
    changed["particles"]["material"] = numpy.asarray(rows, "i4")
    return changed


def offsets(found, wanted):
    """Differences of positions along the shortest way round the box, m, less their median along periodic axes, where
    a body has no place of its own and loose clusters drift; rows by id."""
    by_id = [document["particles"]["position"][numpy.argsort(document["particles"]["id"])] for document in (found, wanted)]
    apart = by_id[0] - by_id[1]
    edges, around = lengths(wanted), periodic(wanted)
    apart -= numpy.where(around, numpy.round((apart - apart[0]) / edges) * edges, 0.0)
    return apart - numpy.where(around, numpy.median(apart, axis=0), 0.0)
