"""convert_materials.py: of which materials particles are: by the names or numbers that a file has for them, --material, --like.

A file of another program has labels: names such as Al, or numbers of types. A name stands for itself, a number for the material of
that number in the state of --like, else for type1, type2… What nobody gave a material is of "unknown", which has no constants."""
import json
import math

import numpy

from convert_common import ConvertError, clipped, warn, word

# As lib/physics/materials.cpp has them; tests/convert/test_homes.py compares the two.
ALUMINA = {
    "name": "alumina",
    "density": 3950.0,
    "surface_energy": 1.1,
    "atomic_volume": 8.47e-30,
    "young_modulus": 400e9,
    "poisson_ratio": 0.23,
    "grain_boundary_diffusion": {"prefactor": 1.3e-8, "activation_energy": 475e3}
}
DIHEDRAL = {"name": "alumina-dihedral", "surface_energy": 0.905, "atomic_volume": 2.11e-29,
            "dihedral_angle": 138.0 * math.pi / 180.0,
            "surface_diffusion": {"prefactor": 3e-10 * 0.09, "activation_energy": 313.8e3},
            "boundary_mobility": {"prefactor": 0.01, "activation_energy": 443e3}}
OTHERS = ({"name": "copper", "density": 8960.0, "surface_energy": 1.79, "atomic_volume": 1.18e-29, "young_modulus": 127e9,
           "poisson_ratio": 0.345, "grain_boundary_diffusion": {"prefactor": 5.0e-15, "activation_energy": 104e3}},
          {"name": "nickel", "density": 8908.0, "surface_energy": 2.4, "atomic_volume": 1.09e-29, "young_modulus": 200e9,
           "poisson_ratio": 0.31, "grain_boundary_diffusion": {"prefactor": 3.5e-15, "activation_energy": 115e3}},
          {"name": "silver", "density": 10490.0, "surface_energy": 1.25, "atomic_volume": 1.71e-29,
           "grain_boundary_diffusion": {"prefactor": 4.5e-15, "activation_energy": 90e3}},
          {"name": "zirconia-3y", "density": 6050.0, "surface_energy": 2.21, "atomic_volume": 3.37e-29,
           "dihedral_angle": 2.0 * math.acos(0.5 * 0.73 / 2.21), "young_modulus": 205e9, "poisson_ratio": 0.30})
BUILT_IN = {"alumina": ALUMINA, "alumina-dihedral": {**ALUMINA, **DIHEDRAL}, **{each["name"]: each for each in OTHERS}}
MOST_TYPES = 1000  # more than any file has; a larger number is a mistake


def materials_of(document):
    """The materials of a state; one without any is taken for alumina, and says so."""
    return document.get("materials") or [{**ALUMINA, "assumed": True}]


def named(text):
    """The material that --material gives: a built-in one, or that of a file."""
    if not text.endswith(".json"):
        if text not in BUILT_IN:
            raise ConvertError(f"--material {clipped(text)}: is not built in; there are {', '.join(BUILT_IN)}, or NAME.json of "
                               "your own")
        return BUILT_IN[text]
    try:
        with open(text, encoding="utf-8") as file:
            material = json.load(file)
    except ValueError:
        raise ConvertError(f"--material {text}: is not a JSON file in UTF-8") from None
    if not isinstance(material, dict) or not isinstance(material.get("name"), str):
        raise ConvertError(f"--material {text}: a material is an object with a name")
    return material


def given_materials(options):
    """What --material said: label to material; a list in the order of the types where there are no labels."""
    words = [word for text in options or () for word in text.split(",")]
    labelled = [word.rpartition("=") for word in words]
    if len({mark for _, mark, _ in labelled}) > 1:
        raise ConvertError("--material has a label for each material, as in Al=alumina, or for none")
    if not any(mark for _, mark, _ in labelled):
        return [named(word) for word in words]
    told = {label: named(name) for label, _, name in labelled}
    if len(told) < len(words):
        raise ConvertError("--material says of one label twice what it is")
    return told


def shown_label(found, label):
    """A label as a name: of a numbered type what the file calls it, else type1, or material0 where a file counts from 0."""
    if isinstance(label, str):
        return label
    return found.type_names.get(label, f"{'type' if found.first else 'material'}{label}")


def distinct(labels):
    return list(dict.fromkeys(labels))


def by_like(found, like, like_name):
    """Places of the particles' materials in the list of --like."""
    materials = materials_of(like)
    names = [material["name"] for material in materials]
    if found.labels is None:
        if len(materials) == 1:
            return numpy.zeros(len(found), numpy.int32)
        row = {int(each): k for k, each in enumerate(found.shifted_ids(like))}
        if any(int(each) not in row for each in found.particles["id"]):
            raise ConvertError(f"{found.place}: says nothing of materials, its ids are not those of {like_name}, and there are "
                               f"{len(materials)} materials in it")
        kinds = like["particles"].get("material", numpy.zeros(len(row), numpy.int32))
        return kinds[[row[int(each)] for each in found.particles["id"]]]
    places = {}
    for label in distinct(found.labels):
        name = label if isinstance(label, str) else found.type_names.get(label)
        if name is None:
            if not 0 <= label - found.first < len(materials):
                raise ConvertError(f"{found.place}: has material {label}; {like_name} has {len(materials)}, counted from "
                                   f"{found.first}")
            places[label] = label - found.first
            continue
        same = [k for k, each in enumerate(names) if each == name] or [k for k, each in enumerate(names) if word(each) == name]
        if not same:
            raise ConvertError(f"{found.place}: material '{clipped(name)}' is not one of {like_name}, which has "
                               f"{', '.join(map(clipped, names))}; --material {clipped(name)}=NAME or another state may help")
        places[label] = same[0]
    return numpy.array([places[label] for label in found.labels], numpy.int32)


def by_option(found, told):
    """The materials of --material, and which each particle has."""
    labels = distinct(found.labels) if found.labels is not None else []
    shown = [shown_label(found, label) for label in labels]
    there = ", ".join(map(clipped, shown)) or "none"
    if isinstance(told, list):
        if len(told) == 1 and len(labels) < 2:
            return told, numpy.zeros(len(found), numpy.int32)
        if any(isinstance(label, str) or not 0 <= label - found.first < len(told) for label in labels):
            raise ConvertError(f"{found.place}: has the materials {there}; give --material {clipped(shown[0])}=NAME and so on")
        return told, numpy.array([label - found.first for label in found.labels or ()], numpy.int32)
    for label in told:
        if label not in shown and label not in map(str, labels):
            raise ConvertError(f"{found.place}: has no material '{clipped(label)}'; there are {there}")
    materials, places = [], {}
    for label, name in zip(labels, shown):
        material = told.get(name, told.get(str(label)))
        if material is None:
            raise ConvertError(f"{found.place}: --material says nothing of '{clipped(name)}'")
        if material not in materials:
            materials.append(material)
        places[label] = materials.index(material)
    return materials, numpy.array([places[label] for label in found.labels or ()], numpy.int32)


def in_stream(document, told, path):
    """The materials of a state of a stream in place of which --material names others."""
    old = materials_of(document)
    names = [material["name"] for material in old]
    if isinstance(told, list):
        if len(told) != len(old):
            raise ConvertError(f"{path}: has {len(old)} materials, and --material names {len(told)}")
        return told
    if unknown := [label for label in told if label not in names]:
        raise ConvertError(f"{path}: has no material '{clipped(unknown[0])}'; there are {', '.join(map(clipped, names))}")
    return [told.get(name, material) for name, material in zip(names, old)]


def with_constants(found, label):
    """A material by its name with what the file says of it; a built-in one where the file does not contradict."""
    name, said = shown_label(found, label), found.constants.get(label, {})
    built_in = BUILT_IN.get(name)
    if built_in and all(abs(built_in.get(key, value) - value) <= 1e-9 * abs(value) for key, value in said.items()):
        warn(f"{found.file}: its material {name} is taken for the built-in one")
        return built_in
    return {"name": name, **said}


def by_file(found):
    """Materials as the file names or counts them, and which each particle has."""
    if found.materials:
        if found.labels is None:
            return found.materials, numpy.zeros(len(found), numpy.int32)
        names = [material["name"] for material in found.materials]
        places = {label: names.index(label) if label in names else label for label in distinct(found.labels)}
        wrong = next((label for label, k in places.items() if isinstance(k, str) or not 0 <= k < len(names)), None)
        if wrong is not None:
            raise ConvertError(f"{found.place}: has material {clipped(wrong)}; the file names {', '.join(map(clipped, names))}")
        return found.materials, numpy.array([places[label] for label in found.labels], numpy.int32)
    if not found.labels and not found.types:
        labels, order = ["unknown"], ["unknown"] * len(found)
    elif found.labels and all(isinstance(label, str) for label in found.labels):
        order = found.labels
        found.order.extend(label for label in distinct(order) if label not in found.order)
        labels = found.order  # of all frames so far: the same name keeps its place
    else:
        order = found.labels or []
        last = max([found.types + found.first - 1, *order])
        if min([found.first, *order]) < found.first or last >= MOST_TYPES + found.first:
            raise ConvertError(f"{found.place}: has materials {min(order)} to {last}; expected numbers from {found.first} on")
        labels = list(range(found.first, max(last, found.first) + 1))
    materials = [with_constants(found, label) for label in labels]
    if double := next((m["name"] for m in materials if sum(m["name"] == each["name"] for each in materials) > 1), None):
        raise ConvertError(f"{found.place}: two materials have the name '{clipped(double)}'")
    bare = [clipped(material["name"]) for material in materials if set(material) <= {"name", "density"}]
    if bare:
        warn(f"{found.file}: of its material{'s' if len(bare) > 1 else ''} {', '.join(bare)} no constants"
             f"{' but density' if any('density' in material for material in materials) else ''} are known; --material or --like "
             "lends them")
    return materials, numpy.array([labels.index(label) for label in order], numpy.int32)


def settle(found, like, given):
    """Materials of a state that was found in a file, and the particles' places among them."""
    if given.material:
        return by_option(found, given.materials)
    if like:
        return materials_of(like), by_like(found, like, given.like)
    return by_file(found)
