"""of_analyze.py: relations of `analyze`: what a state measures does not depend on how it is written down."""
import json

import numpy

from changes import (carried, lengths, moved_by_boxes, origin, periodic, renumbered, repeated, scaled, swapped,
                     translated, turned, with_box)
from draw import bonded, cell, density_of, green
from trial import near, same

# Sums of a few hundred terms in another order.
ROUNDED = 1e-11
# The elastic solves end at 1e-8 of the load; an energy has the square of that, but a single entry of the tensor has it itself.
SOLVED = 3e-7
VOIGT = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
SCALARS = ("relative_density", "coordination_number", "mean_overlap_ratio", "clusters", "largest_cluster_fraction", "isolated",
           "particles")


def _measured(trial, state, *options, name="state.kiln"):
    return trial.results("analyze", "density", *options, trial.put(name, state))[0]


def _same_scalars(found, wanted, tolerance=ROUNDED):
    """Overlaps are a distance over a sum of radii less 1, so they round as numbers of size 1 do."""
    for key in SCALARS:
        near(key, found[key], wanted[key], tolerance, max(1.0, wanted[key]))


def _elastic(trial, state, *options, name="changed.kiln"):
    return trial.results("analyze", "elastic", *options, trial.put(name, state))[0]


def _scattered(trial, state):
    """Another way to write the same periodic state: rows and bonds in another order, bonds the other way round, particles in
    other boxes, the whole elsewhere."""
    count = len(state["particles"]["radius"])
    if "bonds" in state:
        bonds = len(state["bonds"]["pair"])
        state = swapped(state, trial.random.permutation(bonds), trial.random.random(bonds) < 0.5)
    state = moved_by_boxes(renumbered(state, trial.random.permutation(count)), trial.random.integers(-20, 21, (count, 3)))
    return carried(state, lengths(state) * trial.random.uniform(-3, 3, 3))


def density_rewritten(trial):
    """Density, contacts, clusters, texture and g(r) are those of the packing, however it is written: ROUNDED (1e-9 of overlaps,
    which positions twenty boxes away round to)."""
    state = trial.choose(green, bonded)(trial, tiny=0.2)
    options = ["--correlation", "--shells=20", "--bins=5"]
    wanted, found = _measured(trial, state, *options), _measured(trial, _scattered(trial, state), *options, name="other.kiln")
    _same_scalars(found, wanted, 1e-9)
    near("fabric", found["fabric_tensor"], wanted["fabric_tensor"], 1e-9)
    for key in ("distance", "g"):
        near(key, found["pair_correlation"][key], wanted["pair_correlation"][key], 1e-9)
    same("diameters", found["diameter_histogram"]["counts"], wanted["diameter_histogram"]["counts"])


def density_turned(trial):
    """Axes exchanged and mirrored turn the fabric tensor with them and leave all else: ROUNDED."""
    state = trial.choose(green, bonded)(trial, tiny=0.2)
    axes, signs = trial.random.permutation(3), trial.random.choice((-1, 1), 3)
    wanted, found = _measured(trial, state), _measured(trial, turned(state, axes, signs), name="turned.kiln")
    _same_scalars(found, wanted)
    near("anisotropy", found["fabric_anisotropy"], wanted["fabric_anisotropy"], ROUNDED)
    fabric = numpy.array(wanted["fabric_tensor"])[numpy.ix_(axes, axes)] * numpy.outer(signs, signs)
    near("fabric", found["fabric_tensor"], fabric, ROUNDED)


def density_repeated(trial):
    """A cell repeated has the same density, coordination, overlaps, texture and g(r) (ROUNDED), and as many particles."""
    state = trial.choose(green, bonded)(trial, 80, tiny=0.2)
    counts = trial.random.integers(1, 4, 3)
    options = ["--correlation", "--shells=20"]
    wanted, found = _measured(trial, state, *options), _measured(trial, repeated(state, counts), *options, name="repeated.kiln")
    for key in ("relative_density", "coordination_number", "mean_overlap_ratio", "fabric_tensor"):
        near(key, found[key], wanted[key], ROUNDED, numpy.maximum(1.0, wanted[key]).max())
    if wanted["overlap_ratio"]:
        near("overlaps", found["overlap_ratio"]["standard_deviation"], wanted["overlap_ratio"]["standard_deviation"], ROUNDED, 1.0)
    near("g", found["pair_correlation"]["g"], wanted["pair_correlation"]["g"], ROUNDED)
    for key in ("particles", "isolated"):
        same(key, found[key], wanted[key] * int(counts.prod()))


def density_scaled(trial):
    """Ratios do not change with the unit of length, lengths do (ROUNDED): factors from 1e-3 to 1e9."""
    state, factor = trial.choose(green, bonded)(trial, tiny=0.2), 10 ** trial.between(-3, 9)
    options = ["--correlation", "--shells=20"]
    wanted, found = _measured(trial, state, *options), _measured(trial, scaled(state, factor), *options, name="scaled.kiln")
    _same_scalars(found, wanted)
    near("fabric", found["fabric_tensor"], wanted["fabric_tensor"], ROUNDED)
    near("diameter", found["diameter"]["mean"] / factor, wanted["diameter"]["mean"], ROUNDED)
    near("distance", numpy.array(found["pair_correlation"]["distance"]) / factor, wanted["pair_correlation"]["distance"], ROUNDED)


def density_counted(trial):
    """Density, coordination, overlaps, isolated particles and texture counted here, pair by pair over the 27 boxes about: 1e-9.
    Boxes are at least as long as the largest diameter, so no farther image can touch."""
    state = green(trial, 100)
    found = _measured(trial, state)
    place, radius, edges = state["particles"]["position"], state["particles"]["radius"], lengths(state)
    cells = numpy.array(list(numpy.ndindex(3, 3, 3))) - 1
    apart = place[None, :, None] + cells * edges - place[:, None, None]
    distance = numpy.linalg.norm(apart, axis=-1)
    reach = (radius[:, None] + radius)[..., None]
    touch = (distance < reach) & (distance > 0)
    near("density", found["relative_density"], density_of(state), 1e-12)
    near("coordination", found["coordination_number"], touch.sum() / len(radius), 1e-12)
    near("overlap", found["mean_overlap_ratio"], (1 - distance / reach)[touch].mean(), 1e-9)
    same("isolated", found["isolated"], int((~touch.any(axis=(1, 2))).sum()))
    normal = apart[touch] / distance[touch][:, None]
    near("fabric", found["fabric_tensor"], normal.T @ normal / len(normal), 1e-9)


def density_of_a_free_body(trial):
    """Inner density of a body with free axes: carried elsewhere, turned, renumbered, scaled (1e-9); the envelope's (2 %, as its
    grid lies otherwise). Cut from a periodic packing, the body's inner density is that of the packing but for the few particles
    at its faces."""
    state, = trial.states("sinter", "green", "--particles=400", "--density=0.5", f"--seed={trial.random.integers(10**6)}")
    free = (False, trial.choose(True, False), trial.choose(True, False))
    state = with_box(state, lengths(state), origin(state), free)
    axes, signs = trial.random.permutation(3), trial.random.choice((-1, 1), 3)
    factor = 10 ** trial.between(-2, 5)
    other = carried(turned(renumbered(state, trial.random.permutation(400)), axes, signs), lengths(state)[axes] * 3.7)
    other = scaled(other, factor)
    wanted, found = _measured(trial, state), _measured(trial, other, name="other.kiln")
    same("measure", (found["measure"], wanted["measure"]), ("inner", "inner"))
    near("inner density", found["relative_density"], wanted["relative_density"], 1e-9)
    near("inner density of a cut packing", wanted["relative_density"], 0.5, 0.15)
    both = [_measured(trial, each, "--measure=envelope", name="free.kiln")["relative_density"] for each in (state, other)]
    near("density in the envelope", both[1], both[0], 0.02)


def bonds_counted(trial):
    """`analyze bonds` counts what the arrays hold: number, mean diameter and length, share of the solid, density, all of its radii
    in the histogram (ROUNDED)."""
    state = bonded(trial)
    found, = trial.results("analyze", "bonds", "--bins=7", trial.put("bonded.kiln", _scattered(trial, state)))
    bonds, solid = state["bonds"], 4 / 3 * numpy.pi * (state["particles"]["radius"] ** 3).sum()
    same("count", found["count"], len(bonds["radius"]))
    near("mean diameter", found["mean_diameter"], 2 * bonds["radius"].mean(), ROUNDED)
    near("mean length", found["mean_length"], bonds["length"].mean(), ROUNDED)
    near("share of the solid", found["bond_volume_fraction"], bonds["volume"].sum() / (solid + bonds["volume"].sum()), ROUNDED)
    near("density", found["relative_density"], (solid + bonds["volume"].sum()) / lengths(state).prod(), ROUNDED)
    same("last edge", found["histogram"]["edges"][-1], bonds["radius"].max())
    counts, _ = numpy.histogram(bonds["radius"], found["histogram"]["edges"])
    same("histogram", found["histogram"]["counts"], counts.tolist())


def elastic_rewritten(trial):
    """The elastic tensor is that of the cell, however it is written: order of particles and bonds, bonds the other way round,
    particles in other boxes: SOLVED."""
    law = f"--bond-law={trial.choose('series', 'solid', 'neck', 'centre')}"
    state, wanted = cell(trial, 200, law)
    found = _elastic(trial, _scattered(trial, state), law)
    near("stiffness", found["stiffness"], wanted["stiffness"], SOLVED)
    near("affine", found["affine"], wanted["affine"], 1e-9)
    for key in ("fragments", "fragment_particles", "rattlers", "negligible_bonds"):
        same(key, found[key], wanted[key])


def elastic_turned(trial):
    """Axes exchanged and mirrored turn the tensor with them: C_ijkl becomes the one of the old axes, with a sign for each mirrored
    index: SOLVED."""
    axes, signs = trial.random.permutation(3), trial.random.choice((-1, 1), 3)
    shear = f"--bond-shear={trial.choose('section', 'timoshenko')}"
    state, wanted = cell(trial, 200, shear)
    found = _elastic(trial, turned(state, axes, signs), shear)
    place = {pair: k for k, (i, j) in enumerate(VOIGT) for pair in ((i, j), (j, i))}
    old = [place[axes[i], axes[j]] for i, j in VOIGT]
    sign = numpy.array([signs[i] * signs[j] for i, j in VOIGT])
    for key in ("stiffness", "affine"):
        near(key, found[key], numpy.array(wanted[key])[numpy.ix_(old, old)] * numpy.outer(sign, sign), SOLVED)
    for key in ("young_modulus", "poisson_ratio"):
        near(key, found[key], wanted[key], SOLVED)


def elastic_repeated(trial):
    """A cell repeated has the same tensor: SOLVED."""
    state, wanted = cell(trial, 80)
    found = _elastic(trial, repeated(state, trial.random.permutation((1, trial.choose(1, 2), trial.choose(2, 3)))))
    near("stiffness", found["stiffness"], wanted["stiffness"], SOLVED)
    near("density", found["relative_density"], wanted["relative_density"], ROUNDED)


def elastic_scaled(trial):
    """Lengths times k leave the tensor, moduli of all materials times m multiply it (SOLVED), from 1e-6 to 1e6."""
    factor, stiffer = 10 ** trial.between(-6, 6), 10 ** trial.between(-6, 6)
    state, wanted = cell(trial)
    larger = scaled(state, factor)
    larger["materials"] = [{**material, "young_modulus": material["young_modulus"] * stiffer} for material in state["materials"]]
    near("stiffness", numpy.array(_elastic(trial, larger)["stiffness"]) / stiffer, wanted["stiffness"], SOLVED)


def elastic_bounds(trial):
    """The tensor is symmetric (SOLVED), takes energy for every strain and no more than particles that follow the strain, its affine
    bound (1e-9 of the largest)."""
    _, found = cell(trial, 200, f"--bond-law={trial.choose('series', 'solid', 'neck', 'centre')}")
    stiffness, affine = numpy.array(found["stiffness"]), numpy.array(found["affine"])
    near("symmetry", stiffness, stiffness.T, SOLVED)
    scale = numpy.abs(affine).max()
    same("no strain gives energy", bool(numpy.linalg.eigvalsh(stiffness).min() > -1e-9 * scale), True)
    same("no strain takes more than the affine one", bool(numpy.linalg.eigvalsh(affine - stiffness).min() > -1e-9 * scale), True)


def select_nearest(trial):
    """Of states in any order the one nearest to a density or a time, as it was given, radii and positions bit by bit; between a
    state and its translated image --interpolate is on the line at the share asked for (1e-9)."""
    state = green(trial, 60, mixed=0.0)
    states = []
    for time in trial.random.permutation(5):
        edges = lengths(state) * (1 + 0.01 * int(time))
        states.append({**with_box(state, edges, origin(state), periodic(state)), "time": float(time)})
    stream = trial.put("stream.kiln", *states)
    wanted = trial.between(-1, 5)
    chosen, = trial.states("analyze", "select", "--quiet", f"--time={wanted!r}s" if wanted >= 0 else "--time=0s", stream)
    nearest = min((each["time"] for each in states), key=lambda time: abs(time - max(wanted, 0.0)))
    same("time", chosen["time"], nearest)
    same("positions", chosen["particles"]["position"], state["particles"]["position"])
    goal = density_of(state) / (1 + 0.01 * trial.between(0.2, 3.8)) ** 3
    chosen, = trial.states("analyze", "select", "--quiet", f"--density={goal!r}", stream)
    best = min(states, key=lambda each: abs(density_of(each) - goal))
    same("nearest density", density_of(chosen), density_of(best))
    shift = lengths(state) * trial.random.uniform(-0.4, 0.4, 3)
    later = {**renumbered(translated(state, shift), trial.random.permutation(len(state["particles"]["radius"]))), "time": 10.0}
    early = {**state, "time": 0.0}
    share = trial.between(0.05, 0.95)
    between, = trial.states("analyze", "select", "--interpolate", f"--time={10 * share!r}s", trial.put("two.kiln", early, later))
    apart = between["particles"]["position"] - state["particles"]["position"] - share * shift
    near("place between", apart - numpy.round(apart / lengths(state)) * lengths(state), 0 * apart, 1e-9, lengths(state).min())


def modulus_scaled(trial):
    """Forces times k multiply Young's modulus by k; lengths of bar, span and curve times k with forces times k^2 leave it (1e-12).
    The curve twice over is the same test."""
    loads = numpy.linspace(0, 1, 30)
    path = numpy.concatenate([loads, loads[::-1]])
    slack = trial.between(0, 0.1)
    curve = {"deflection": path * 1e-9 + slack * 1e-9 * path**2 + 1e-13 * trial.random.standard_normal(60),
             "punch": path * 1.1e-9, "force": path * 1e-6}
    bar = {"relative_density": 0.8, "span": 6e-6, "width": 1e-6, "height": 1e-6, "poisson_ratio": 0.23}

    def measured(force, length):
        document = {"format": "dem-bend", "version": 1, "units": "SI", "bond_law": "series", "method": "static",
                    **{key: value * (length if value < 1e-3 else 1) for key, value in bar.items()},
                    "curve": {key: list(map(float, values * (force if key == "force" else length)))
                              for key, values in curve.items()}}
        with open(trial.path("curve.json"), "w", encoding="utf-8") as file:
            json.dump(document, file)
        return trial.results("analyze", "modulus", "curve.json")[0]

    wanted, stiffer, factor = measured(1, 1), 10 ** trial.between(-6, 6), 10 ** trial.between(-3, 3)
    near("modulus of larger forces", measured(stiffer, 1)["young_modulus"] / stiffer, wanted["young_modulus"], 1e-12)
    near("modulus of a larger bar", measured(factor**2, factor)["young_modulus"], wanted["young_modulus"], 1e-12)


def fit_scaled(trial):
    """Moduli times k multiply E0 and its error and leave the exponent, whatever the order of the points (1e-7: fits end where
    they no longer change)."""
    law, b = trial.choose("knudsen", "coble-kingery", "gibson-ashby"), trial.between(2, 5)
    porosity = trial.random.uniform(0.05, 0.4, 8)
    moduli = 400e9 * numpy.exp(-b * porosity) * (1 + 0.02 * trial.random.standard_normal(8))

    def fitted(order, factor):
        with open(trial.path("points.jsonl"), "w", encoding="utf-8") as file:
            for k in order:
                json.dump({"format": "dem-modulus", "relative_density": 1 - porosity[k], "young_modulus": moduli[k] * factor}, file)
                file.write("\n")
        return trial.results("analyze", "fit", f"--law={law}", "points.jsonl")[0]

    factor = 10 ** trial.between(-3, 3)
    wanted, found = fitted(range(8), 1.0), fitted(trial.random.permutation(8), factor)
    same("keys", found.keys(), wanted.keys())
    near("E0", found["E0"] / factor, wanted["E0"], 1e-7)
    near("r squared", found["r_squared"], wanted["r_squared"], 1e-7)
    if "b" in wanted:
        near("b", found["b"], wanted["b"], 1e-7)


