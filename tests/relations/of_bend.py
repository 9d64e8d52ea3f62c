"""of_bend.py: relations of `bend`.

Equilibria end at an unbalanced force of 1e-6 of the contact forces (--tolerance). Hertz contacts that come to touch or not by that
much, and the bracketing of forces, leave less than SOLVED of the greatest force or deflection.
"""
import numpy

from changes import carried, moved_by_boxes, renumbered, scaled, swapped, turned, with_materials
from draw import bar, until_taken
from trial import Broken, near, same

SOLVED = 2e-5
# The force of a break is found to a stress within 1e-3.
BROKEN = 3e-3


def _bent(trial, state, options, name="changed.kiln"):
    return trial.results("bend", *options, trial.put(name, state))[0]


def _alike(found, wanted, force=1.0, length=1.0, tolerance=SOLVED):
    """Two curves, the one found in units so many times as large."""
    for key, unit in (("deflection", length), ("punch", length), ("force", force)):
        near(key, numpy.array(found["curve"][key]) / unit, wanted["curve"][key], tolerance)
    for key in ("particles", "bonds", "fragments", "rattlers", "dropped_bonds"):
        same(key, found[key], wanted[key])
    for key in ("span", "effective_span", "width", "height"):
        near(key, found[key] / length, wanted[key], tolerance)
    for key in ("bonds", "contacts"):
        near(f"energy of {key}", found["energy"][key] / force / length, wanted["energy"][key], 10 * tolerance,
             wanted["energy"]["bonds"] + wanted["energy"]["contacts"])


def bend_rewritten(trial):
    """The same bar, however it is written: particles and bonds in another order, bonds the other way round, particles in other
    boxes, the whole elsewhere: SOLVED."""
    state, options, wanted = bar(trial)
    count, bonds = len(state["particles"]["radius"]), len(state["bonds"]["pair"])
    other = swapped(state, trial.random.permutation(bonds), trial.random.random(bonds) < 0.5)
    other = renumbered(other, trial.random.permutation(count))
    if trial.choose(True, False):
        other = moved_by_boxes(other, trial.random.integers(-20, 21, (count, 3)))
    other = carried(other, numpy.diag(state["box"]["vectors"]) * trial.random.uniform(-3, 3, 3))
    _alike(_bent(trial, other, options), wanted)


def bend_mirrored(trial):
    """The mirror image of a bar along its length or its width bends alike: SOLVED."""
    state, options, wanted = bar(trial)
    signs = trial.choose((-1, 1, 1), (1, -1, 1), (-1, -1, 1))
    _alike(_bent(trial, turned(state, range(3), signs), options), wanted)


def bend_scaled(trial):
    """Lengths times k, moduli times m: forces times m k^2, deflections times k (SOLVED); k from 1e-3 to 1e6, m from 1e-6 to 1e6."""
    state, options, wanted = bar(trial)
    factor, stiffer = 10 ** trial.between(-3, 6), 10 ** trial.between(-6, 6)
    other = scaled(state, factor)
    other["materials"] = [{**material, "young_modulus": material["young_modulus"] * stiffer} for material in state["materials"]]
    _alike(_bent(trial, other, options), wanted, stiffer * factor**2, factor)


def bend_to_a_force(trial):
    """--max-force with the force that a deflection took bends to that deflection, in one cycle or several alike: SOLVED."""
    state, options, wanted = bar(trial)
    force, most = max(wanted["curve"]["force"]), max(wanted["curve"]["deflection"])
    near("deflection", most, 1e-3 * wanted["height"], 2e-6)
    found = _bent(trial, state, [*options, f"--max-force={force!r}N"])
    _alike(found, wanted)
    options[-1] = "--cycles=3"
    thrice = _bent(trial, state, options)["curve"]
    for key in ("deflection", "force"):
        once = wanted["curve"][key]
        near(f"{key} of three cycles", thrice[key], once + once[1:] + once[1:], SOLVED)


def bend_works(trial):
    """The work of the punch is what is stored (1e-3 with 20 levels of force, fewer levels cost their square), force and travel rise
    together and unloading retraces loading. The bent bar written by --states carries the forces told: every particle that nothing
    presses is in balance (1e-4 of the greatest bond force), and together they bear the punch."""
    state, options, _ = bar(trial)
    options[-2] = "--points=20"
    wanted = _bent(trial, state, options)
    found = _bent(trial, state, [*options, "--states=bent.kiln"])
    same("result beside --states", found["curve"], wanted["curve"])
    curve = {key: numpy.array(values) for key, values in wanted["curve"].items()}
    peak = int(curve["force"].argmax())
    near("work", wanted["energy"]["error"], 0, 1e-3, 1.0)
    rise = [curve[key][: peak + 1] for key in ("force", "punch", "deflection")]
    same("rising", [bool((numpy.diff(values) > 0).all()) for values in rise[:2]], [True, True])
    same("unloading retraces loading", list(wanted["curve"]["force"][peak:]), list(wanted["curve"]["force"][peak::-1]))
    bent, = trial.get("bent.kiln")
    net = numpy.zeros((len(bent["particles"]["radius"]), 3))
    numpy.add.at(net, bent["bonds"]["pair"][:, 0], bent["bonds"]["force"])
    numpy.add.at(net, bent["bonds"]["pair"][:, 1], -bent["bonds"]["force"])
    scale = numpy.linalg.norm(bent["bonds"]["force"], axis=1).max()
    loaded = numpy.linalg.norm(net, axis=1) > 1e-4 * scale
    near("sum of all forces", net.sum(axis=0), numpy.zeros(3), 1e-4, scale)
    # Bonds hold up what the punch presses down; gaps that close press both their sides as well.
    held = numpy.abs(net[:, 2]).sum() / 2
    same("what bonds hold and what the punch presses", bool(held >= 0.999 * max(wanted["curve"]["force"])), True)
    if wanted["closed_gaps"] == 0:
        near("the same", held, max(wanted["curve"]["force"]), 1e-3)
    if not 3 <= loaded.sum() <= 3 * len(net) // 4:
        raise Broken(f"{loaded.sum()} of {len(net)} particles are pressed by something")


def bend_two_names(trial):
    """One material under two names bends alike: SOLVED."""
    state, options, wanted = bar(trial, mixed=0.0)
    material = state["materials"][0]
    twins = with_materials(state, [{**material, "name": "b"}, {**material, "name": "a"}],
                           trial.random.integers(0, 2, len(state["particles"]["radius"])))
    _alike(_bent(trial, twins, options), wanted)


def bend_to_failure(trial):
    """Strengths and moduli times m, lengths times k, give m times the bending strength in as many breaks; so does the mirror image
    (BROKEN). Work less what breaks took is stored: energy.error at most 5e-3, and work is at most the greatest force times the
    way of the punch."""
    state, options, _ = bar(trial, 200, mixed=0.0)
    options = options[:2]
    tensile, shear = trial.choose((300, None), (None, 400), (500, 800))
    factor, stiffer = 10 ** trial.between(-2, 2), 10 ** trial.between(-2, 2)

    def strength(times):
        return [f"--{name}-strength={value * times!r}MPa" for name, value in (("tensile", tensile), ("shear", shear)) if value]

    wanted = _bent(trial, state, [*options, *strength(1)], "bar.kiln")
    curve, energy = wanted["curve"], wanted["energy"]
    near("energy error", energy["error"], 0, 5e-3, 1.0)
    most = max(curve["force"]) * max(curve["punch"])
    same(f"work {energy['work']:.3g} J between nothing and {most:.3g} J", bool(0 < energy["work"] <= 1.001 * most), True)
    other = scaled(turned(state, range(3), trial.choose((-1, 1, 1), (1, -1, 1))), factor)
    other["materials"] = [{**state["materials"][0], "young_modulus": state["materials"][0]["young_modulus"] * stiffer}]
    found = _bent(trial, other, [*options, *strength(stiffer)])
    near("strength", found["strength"]["bending_strength"] / stiffer, wanted["strength"]["bending_strength"], BROKEN)
    near("first break", found["strength"]["first_break"] / stiffer, wanted["strength"]["first_break"], BROKEN)


def bend_with_friction(trial):
    """With friction: finite, the mirror image alike (1e-3, as slip depends on where steps end), the work done is what is stored or
    lost (5e-2 with 12 levels of force), and friction gives no energy."""
    def make():
        state, options, _ = bar(trial, 100)
        options[-2:] = ["--points=12", "--cycles=1", f"--friction={trial.between(0.05, 0.6):.3f}"]
        return state, options, _bent(trial, state, options, "bar.kiln")

    state, options, wanted = until_taken(make, "does not bend downwards")
    near("energy error", wanted["energy"]["error"], 0, 5e-2, 1.0)
    _alike(_bent(trial, turned(state, range(3), trial.choose((-1, 1, 1), (1, -1, 1))), options), wanted, tolerance=1e-3)
    same("something is lost", wanted["energy"]["friction"] >= 0, True)


