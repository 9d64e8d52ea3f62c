"""of_bondify.py: relations of `bondify`. Its events are exact but for rounding, so results differ by that of a few hundred sums."""
import numpy

from changes import (carried, image_of, lengths, moved_by_boxes, origin, periodic, renumbered, repeated, scaled, turned,
                     with_box)
from draw import green
from trial import near, same, summary

# Rounding of positions (1e-16 of the box) against overlaps (1e-3 of a radius) and shrinking event by event.
ROUNDED = 1e-9


def _options(trial):
    return ["--quiet", f"--sharing={trial.choose('pair', 'particle')}", f"--volume={trial.choose('cylinder', 'cap-corrected')}"]


def _made(trial, state, options, name="green.kiln"):
    return trial.states("bondify", *options, trial.put(name, state))[0]


def _table(state):
    """Bonds as rows of distance, radius, length and volume, over their means, in the order of the ids of their ends and their
    distance; and those ids."""
    particles, bonds = state["particles"], state["bonds"]
    pair = bonds["pair"]
    ids = numpy.sort(particles["id"][pair], axis=1)
    apart = particles["position"][pair[:, 1]] + image_of(state) * lengths(state) - particles["position"][pair[:, 0]]
    columns = numpy.stack([numpy.linalg.norm(apart, axis=1), bonds["radius"], bonds["length"], bonds["volume"]], axis=1)
    order = numpy.lexsort((columns[:, 0], ids[:, 1], ids[:, 0]))
    return ids[order], columns[order]


def _alike(found, wanted, tolerance=ROUNDED):
    """Two states with the same bonds, whatever their order."""
    ids, columns = _table(wanted)
    found_ids, found_columns = _table(found)
    same("ends of bonds", found_ids, ids)
    for k, name in enumerate(("distance", "radius", "length", "volume")):
        near(f"bond {name}", found_columns[:, k], columns[:, k], tolerance)
    by_id = [state["particles"]["radius"][numpy.argsort(state["particles"]["id"])] for state in (found, wanted)]
    near("radius", by_id[0], by_id[1], tolerance)


def bondify_conserves(trial):
    """What spheres lose their bonds have, to 1e-12 of the solid; positions do not move; no two spheres overlap afterwards (by more
    than rounding, 1e-12 of the radius); every overlap became a bond; a plain cylinder holds its volume (1e-9) unless it was
    clamped."""
    state, options = green(trial, 300, tiny=0.3), _options(trial)
    made = _made(trial, state, options)
    cubes = [float((document["particles"]["radius"].astype(numpy.longdouble) ** 3).sum()) for document in (state, made)]
    ball = 4 / 3 * numpy.pi
    near("solid", ball * cubes[1] + made["bonds"]["volume"].sum(), ball * cubes[0], 1e-12)
    near("volume error it tells", summary(made)["volume_error"], 0, 1e-12, 1.0)
    same("positions", made["particles"]["position"], state["particles"]["position"])
    radius, pair = made["particles"]["radius"], made["bonds"]["pair"]
    _, columns = _table(made)
    apart = made["particles"]["position"][pair[:, 1]] + image_of(made) * lengths(made) - made["particles"]["position"][pair[:, 0]]
    left = radius[pair].sum(axis=1) - numpy.linalg.norm(apart, axis=1)
    near("overlap that is left", max(left.max(initial=0.0), 0.0), 0, 1e-12, radius.max())
    before, = trial.results("analyze", "density", "green.kiln")
    near("coordination", 2 * len(pair) / len(radius), before["coordination_number"], 1e-12)
    if "--volume=cylinder" in options and summary(made)["clamped"] == 0:
        cylinder = numpy.pi * columns[:, 1] ** 2 * columns[:, 2]
        near("volume of cylinders", cylinder / columns[:, 3], numpy.ones(len(cylinder)), 1e-9)


def bondify_moved(trial):
    """The same bonds after particles and box were carried elsewhere, particles moved by whole boxes, rows renumbered, axes
    exchanged and mirrored: ROUNDED."""
    state, options = green(trial, 300, tiny=0.3), _options(trial)
    count = len(state["particles"]["radius"])
    other = renumbered(state, trial.random.permutation(count))
    other = turned(other, trial.random.permutation(3), trial.random.choice((-1, 1), 3))
    other = moved_by_boxes(other, trial.random.integers(-60, 61, (count, 3)))
    other = carried(other, lengths(other) * trial.random.uniform(-30, 30, 3))
    _alike(_made(trial, other, options, "moved.kiln"), _made(trial, state, options), 1e-7)  # positions of 100 boxes round more


def bondify_turned(trial):
    """Axes exchanged and mirrored: the same bonds, ROUNDED."""
    state, options = green(trial, 300, tiny=0.3), _options(trial)
    other = turned(state, trial.random.permutation(3), trial.random.choice((-1, 1), 3))
    _alike(_made(trial, other, options, "turned.kiln"), _made(trial, state, options))


def bondify_renumbered(trial):
    """Rows in another order: the same bonds between the same ids, ROUNDED, and particles in the order given."""
    state, options = green(trial, 300, tiny=0.3), _options(trial)
    order = trial.random.permutation(len(state["particles"]["radius"]))
    found, wanted = _made(trial, renumbered(state, order), options, "renumbered.kiln"), _made(trial, state, options)
    same("ids", found["particles"]["id"], wanted["particles"]["id"][order])
    _alike(found, wanted)


def bondify_doubled(trial):
    """All lengths times a power of two: the same digits, whatever the size, from 2^-20 to 2^40 (a bar of kilometres)."""
    state, options, factor = green(trial, 300, tiny=0.3), _options(trial), 2.0 ** trial.random.integers(-20, 41)
    found, wanted = _made(trial, scaled(state, factor), options, "scaled.kiln"), _made(trial, state, options)
    same("radii", found["particles"]["radius"], wanted["particles"]["radius"] * factor)
    for name, power in (("radius", 1), ("length", 1), ("volume", 3)):
        same(f"bond {name}", found["bonds"][name], wanted["bonds"][name] * factor**power)


def bondify_repeated(trial):
    """A cell repeated along the axes has every bond so many times: ROUNDED."""
    state, options = green(trial, 120, tiny=0.3), _options(trial)
    counts = trial.random.integers(1, 4, 3)
    times = int(counts.prod())
    found, wanted = _made(trial, repeated(state, counts), options, "repeated.kiln"), _made(trial, state, options)
    near("radii", found["particles"]["radius"], numpy.tile(wanted["particles"]["radius"], times), ROUNDED)
    for name in ("radius", "length", "volume"):
        near(f"bond {name}", numpy.sort(found["bonds"][name]), numpy.sort(numpy.tile(wanted["bonds"][name], times)), ROUNDED)


def bondify_beside(trial):
    """Two packings far from each other in one box become what each becomes alone (ROUNDED): nothing acts at a distance."""
    options, states = _options(trial), [green(trial, 100, mixed=0.0), green(trial, 100, mixed=0.0)]
    states = [with_box(state, lengths(state), origin(state), (False, False, False)) for state in states]
    alone = [_made(trial, state, options) for state in states]
    gap = 4 * max(state["particles"]["radius"].max() for state in states)
    away = numpy.array([lengths(states[0])[0] + gap, 0, 0])
    second = carried(states[1], away)["particles"]
    second["id"] = second["id"] + len(states[0]["particles"]["id"])
    both = with_box(states[0], lengths(states[0]) + lengths(states[1]) + gap, origin(states[0]), periodic(states[0]))
    both["particles"] = {name: numpy.concatenate([states[0]["particles"][name], second[name]]) for name in second}
    together = _made(trial, both, options, "both.kiln")
    near("radii", together["particles"]["radius"], numpy.concatenate([each["particles"]["radius"] for each in alone]), ROUNDED)
    for name in ("radius", "length", "volume"):
        near(f"bond {name}", together["bonds"][name], numpy.concatenate([each["bonds"][name] for each in alone]), ROUNDED)


def bondify_sweep(trial):
    """Sweeps of finite decrements approach the exact method: radii differ by no more than a particle loses in a sweep, its
    contacts times the decrement, times the few sweeps by which neighbours' ends are delayed (3)."""
    state = green(trial, 100, tiny=0.2)
    sharing = f"--sharing={trial.choose('pair', 'particle')}"
    radius = state["particles"]["radius"].mean()
    decrement = radius * 10 ** trial.between(-5, -3)
    exact = _made(trial, state, ["--quiet", sharing])
    swept = _made(trial, state, ["--quiet", sharing, "--method=sweep", f"--decrement={decrement!r}m"])
    same("bonds", swept["bonds"]["pair"], exact["bonds"]["pair"])
    contacts = numpy.bincount(exact["bonds"]["pair"].ravel()).max(initial=0)
    near("radii", swept["particles"]["radius"], exact["particles"]["radius"], 3 * contacts * decrement, 1.0)


def bondify_necks(trial):
    """Necks leave the particles as they are, their bonds have no volume, and their radii are those of the law within the dihedral
    limit, no narrower than where the spheres meet (ROUNDED); of what is moved, renumbered, turned and mirrored they are the same
    necks, and the volume of their union is the same within four of its standard errors."""
    state, options = green(trial, 200, tiny=0.3), ["--quiet", "--method=necks", "--necks=law"]
    made = _made(trial, state, options)
    for name in ("position", "radius"):
        same(name, made["particles"][name], state["particles"][name])
    ids, columns = _table(made)
    same("volume", columns[:, 3], numpy.zeros(len(columns)))
    pair, radius = made["bonds"]["pair"], state["particles"]["radius"]
    r1, r2 = radius[pair].T
    apart = made["particles"]["position"][pair[:, 1]] + image_of(made) * lengths(made) - made["particles"]["position"][pair[:, 0]]
    d = numpy.linalg.norm(apart, axis=1)
    limit = [numpy.sin(material.get("dihedral_angle", numpy.pi) / 2) for material in state["materials"]]
    kind = state["particles"].get("material", numpy.zeros(len(radius), int))
    most = numpy.minimum(r1, r2) * numpy.array(limit)[kind[pair]].min(axis=1)
    plane = (d + (r1 - r2) * (r1 + r2) / d) / 2
    met = numpy.where((plane <= 0) | (plane >= d), numpy.minimum(r1, r2), numpy.sqrt(numpy.maximum(r1**2 - plane**2, 0)))
    wanted = numpy.maximum(numpy.minimum(numpy.sqrt(4 * r1 * r2 / (r1 + r2) * (r1 + r2 - d).clip(min=0)), most), met)
    near("neck radius", made["bonds"]["radius"], wanted, 1e-7)
    near("length below zero", min(made["bonds"]["length"].min(initial=0.0), 0.0), 0, 1e-12, 1.0)

    count = len(radius)
    other = renumbered(state, trial.random.permutation(count))
    other = turned(other, trial.random.permutation(3), trial.random.choice((-1, 1), 3))
    other = moved_by_boxes(other, trial.random.integers(-20, 21, (count, 3)))
    found = _made(trial, other, options, "moved.kiln")
    found_ids, found_columns = _table(found)
    same("ends of necks", found_ids, ids)
    for k, name in enumerate(("distance", "radius", "length")):
        near(f"neck {name}", found_columns[:, k], columns[:, k], 1e-6)
    told, again = summary(made), summary(found)
    error = 4 * (told["union_error"] + again["union_error"]) + 1e-9
    near("union", again["union_fraction"], told["union_fraction"], error, 1.0)


def bondify_necks_fill(trial):
    """With one factor on all necks the union fills what the mass fills (2e-5), unless as many necks as there can be are at their
    limit; lengths times a power of two give the same digits."""
    state, factor = green(trial, 200), 2.0 ** trial.random.integers(-20, 41)
    options = ["--quiet", "--method=necks"]
    made, larger = _made(trial, state, options), _made(trial, scaled(state, factor), options, "scaled.kiln")
    same("radii of necks", larger["bonds"]["radius"], made["bonds"]["radius"] * factor)
    told = summary(made)
    same("what is told", {**summary(larger), "mean_diameter": 0, "mean_length": 0}, {**told, "mean_diameter": 0, "mean_length": 0})
    if told["neck_factor"] < 2:
        near("union", told["union_fraction"], told["solid_fraction"], 2e-5)
