"""of_sinter.py: relations of `sinter`. firings.py says what FIRST, REORDERED and SOLVED are."""
import copy
import json

import numpy

from changes import carried, lengths, moved_by_boxes, renumbered, repeated, scaled, translated, turned, with_materials
from draw import density_of
from firings import (FIRST, REORDERED, SOLVED, STEPS, alike, drawn_firing, fired, held, stress_unit, told_at_first,
                     viscosity_unit)
from trial import Broken, near, same, summary


def sinter_translated(trial):
    """Particles of a periodic box all moved alike sinter alike: REORDERED."""
    state, firing, time = drawn_firing(trial, free=False)
    other = translated(state, lengths(state) * trial.random.uniform(-1.5, 1.5, 3))
    alike(held(trial, firing, other, time), held(trial, firing, state, time, name="green.kiln"))


def sinter_carried(trial):
    """Particles and box moved together, up to a hundred boxes away, sinter alike: REORDERED."""
    state, firing, time = drawn_firing(trial)
    shift = lengths(state) * trial.random.uniform(-1, 1, 3) * trial.choose(1, 100)
    found = held(trial, firing, carried(state, shift), time)
    alike(carried(found, -shift), held(trial, firing, state, time, name="green.kiln"))


def sinter_moved_by_boxes(trial):
    """Each particle of a periodic box moved by some whole boxes is the same packing: REORDERED."""
    state, firing, time = drawn_firing(trial, free=False)
    boxes = trial.random.integers(-100, 101, (len(state["particles"]["radius"]), 3))
    alike(held(trial, firing, moved_by_boxes(state, boxes), time), held(trial, firing, state, time, name="green.kiln"))


def sinter_renumbered(trial):
    """Particles in another order sinter alike and come back in that order: REORDERED."""
    state, firing, time = drawn_firing(trial)
    order = trial.random.permutation(len(state["particles"]["radius"]))
    wanted = held(trial, firing, state, time, name="green.kiln")
    found = held(trial, firing, renumbered(state, order), time)
    for name in ("id", "radius", "material"):
        same(name, found["particles"][name], wanted["particles"][name][order])
    alike(found, wanted)


def sinter_turned(trial):
    """Axes exchanged and mirrored, those of --fix and --pressure with them: the same, turned (REORDERED), stresses and viscosities
    too (SOLVED)."""
    state, firing, time = drawn_firing(trial)
    axes, signs = trial.random.permutation(3), trial.random.choice((-1, 1), 3)
    wanted = held(trial, firing, state, time, name="green.kiln")
    alike(held(trial, firing.turned(axes), turned(state, axes, signs), time), turned(wanted, axes, signs))
    if firing.boundary:
        return
    there = told_at_first(trial, firing, state, time)
    here = told_at_first(trial, firing.turned(axes), turned(state, axes, signs), time)
    near("stress", here["stress"], numpy.array(there["stress"])[axes], SOLVED, stress_unit(there))
    wanted = numpy.array(there["viscosity"])[numpy.ix_(axes, axes)]
    near("viscosity", here["viscosity"], wanted, SOLVED, viscosity_unit(there, time))


def sinter_repeated(trial):
    """A periodic cell two or three times in a row is the same material: density after a time (REORDERED), coordination, stresses
    and viscosities (SOLVED)."""
    state, firing, time = drawn_firing(trial, most=80, free=False)
    counts = numpy.roll((trial.choose(2, 3), 1, 1), trial.random.integers(3))
    wanted = held(trial, firing, state, time, name="green.kiln")
    found = held(trial, firing, repeated(state, counts), time)
    near("density after a step", found["first"]["relative_density"], wanted["first"]["relative_density"], FIRST)
    near("density", density_of(found), density_of(wanted), REORDERED)
    near("edges", lengths(found), lengths(wanted) * counts, REORDERED)
    here, there = told_at_first(trial, firing, repeated(state, counts), time), told_at_first(trial, firing, state, time)
    near("coordination", here["coordination_number"], there["coordination_number"], 1e-12)
    near("stress", here["stress"], there["stress"], SOLVED, stress_unit(there))
    near("viscosity", here["viscosity"], there["viscosity"], SOLVED, viscosity_unit(there, time))
    near("sintering stress", here["sintering_stress"], there["sintering_stress"], SOLVED, stress_unit(there))


def sinter_in_die(trial):
    """In a die a body is never past a wall nor pulled by one, and where it is pressed it is at the wall: in every step, to SOLVED
    of the stresses. Turned, mirrored, repeated or enlarged it does the same (REORDERED)."""
    connected = 0.0
    while connected < 3.0:  # contacts a particle; in looser packings an axis that no contacts reach through hands its load on
        state, firing, time = drawn_firing(trial, most=80, mixed=0.0, faces=False, free=False)
        connected = held(trial, firing, state, time)["first"]["coordination_number"]
    firing.confined = trial.choose("x", "y", "z", "xy", "yz", "xz")
    firing.pressure = tuple(0.0 if "xyz"[k] in firing.confined else 10 ** trial.between(6, 8) for k in range(3))
    wanted = held(trial, firing, state, time, name="green.kiln")
    before, walls = numpy.zeros(3), ["xyz".index(axis) for axis in firing.confined]
    for line in trial.bytes_of("history.jsonl").splitlines():
        step = json.loads(line)
        strain, stress = numpy.array(step["strain"]), numpy.array(step["stress"])
        unit = max(*firing.pressure, 1e5)
        for axis in walls:
            if strain[axis] > 1e-12 or stress[axis] > SOLVED * unit:
                raise Broken(f"past the wall or pulled by it: strain {strain[axis]}, stress {stress[axis]} Pa")
            if strain[axis] < before[axis] - 1e-9 and stress[axis] < -SOLVED * unit:
                raise Broken(f"pressed by {stress[axis]} Pa where it leaves the wall, at a strain of {strain[axis]}")
        before = strain
    axes, signs = trial.random.permutation(3), trial.random.choice((-1, 1), 3)
    alike(held(trial, firing.turned(axes), turned(state, axes, signs), time), turned(wanted, axes, signs))
    counts = numpy.roll((2, 1, 1), trial.random.integers(3))
    found = held(trial, firing, repeated(state, counts), time)
    near("edges", lengths(found), lengths(wanted) * counts, REORDERED)
    firing.pressure = tuple(value / 16 for value in firing.pressure)
    found = scaled(held(trial, firing, scaled(state, 16), time * 16**4), 1 / 16)
    found["time"] /= 16**4
    alike(found, wanted)


def sinter_scaled(trial):
    """All lengths times k take k^4 times as long under 1/k of the pressure (Herring 1950): REORDERED, for k from 1e-2 to 1e4. The
    sintering stress is 1/k, viscosities k^3 of what they were (SOLVED)."""
    state, firing, time = drawn_firing(trial)
    factor = trial.choose(2.0 ** trial.random.integers(-6, 13), 10 ** trial.between(-2, 4))
    wanted = held(trial, firing, state, time, name="green.kiln")
    there = None if firing.boundary else told_at_first(trial, firing, state, time)
    firing.pressure = tuple(value / factor for value in firing.pressure)
    found = scaled(held(trial, firing, scaled(state, factor), time * factor**4), 1 / factor)
    found["time"] /= factor**4
    alike(found, wanted)
    if there is None:
        return
    here = told_at_first(trial, firing, scaled(state, factor), time * factor**4)
    near("sintering stress", here["sintering_stress"] * factor, there["sintering_stress"], SOLVED, stress_unit(there))
    near("viscosity", numpy.array(here["viscosity"]) / factor**3, there["viscosity"], SOLVED, viscosity_unit(there, time))


def _with_each_material(state, change):
    changed = copy.deepcopy(state)
    for material in changed["materials"]:
        change(material)
    return changed


def sinter_diffusion(trial):
    """Diffusion k times as fast in every material takes 1/k of the time, from 1e-9 to 1e9: REORDERED."""
    state, firing, time = drawn_firing(trial)
    factor = 10 ** trial.between(-9, 9)

    def faster(material):
        material["grain_boundary_diffusion"]["prefactor"] *= factor

    found = held(trial, firing, _with_each_material(state, faster), time / factor)
    found["time"] *= factor
    alike(found, held(trial, firing, state, time, name="green.kiln"))


def sinter_surface_energy(trial):
    """Surface energy k times as large, and pressure too, is k times the speed (REORDERED) and the stress (SOLVED), for k from 1e-4
    to 1e4."""
    state, firing, time = drawn_firing(trial)
    factor = 10 ** trial.between(-4, 4)

    def stronger(material):
        material["surface_energy"] *= factor

    wanted = held(trial, firing, state, time, name="green.kiln")
    there = None if firing.boundary else told_at_first(trial, firing, state, time)
    firing.pressure = tuple(value * factor for value in firing.pressure)
    found = held(trial, firing, _with_each_material(state, stronger), time / factor)
    found["time"] *= factor
    alike(found, wanted)
    if there is None:
        return
    here = told_at_first(trial, firing, _with_each_material(state, stronger), time / factor)
    near("stress", numpy.array(here["stress"]) / factor, there["stress"], SOLVED, stress_unit(there))


def sinter_in_parts(trial):
    """Fired to a density and on to another, or for two times one after the other, as in one run: other steps, so STEPS
    tolerances. The densities asked for are met to the 1e-6 that --to-density grants itself."""
    state, firing, _ = drawn_firing(trial, tolerance=1e-4)
    densities = [density_of(state) + gain for gain in (trial.between(0.002, 0.004), trial.between(0.006, 0.01))]
    first, last = fired(trial, firing, state, "--to-density=" + ",".join(map(repr, densities)))
    middle, = fired(trial, firing, state, f"--to-density={densities[0]!r}", name="start.kiln")
    end, = fired(trial, firing, middle, f"--to-density={densities[1]!r}", name="middle.kiln")
    for found, wanted in ((first, densities[0]), (middle, densities[0]), (last, densities[1]), (end, densities[1])):
        near("density asked for", density_of(found), wanted, 2e-6)
    rate = (densities[1] - densities[0]) / (last["time"] - first["time"])
    near("time, as a density", (end["time"] - last["time"]) * rate, 0, STEPS * firing.tolerance, 1.0)
    by_time = held(trial, firing, held(trial, firing, state, first["time"]), last["time"])
    near("density after two times", density_of(by_time), densities[1], STEPS * firing.tolerance)


def sinter_time_of_density(trial):
    """At the time at which --to-density says it is reached, --at-time has that density: only the last steps differ, so within the
    tolerance."""
    state, firing, _ = drawn_firing(trial, tolerance=1e-4)
    wanted, = fired(trial, firing, state, f"--to-density={density_of(state) + trial.between(0.002, 0.02)!r}")
    near("density", density_of(held(trial, firing, state, wanted["time"])), density_of(wanted), firing.tolerance)


def sinter_every(trial):
    """--every T writes the states of --at-time T,2T,3T: the same steps and the same bytes."""
    state, firing, time = drawn_firing(trial)
    span = float(f"{time / 3:.3g}")
    listed = fired(trial, firing, state, f"--at-time={span!r}s,{2 * span!r}s,{3 * span!r}s")
    every = fired(trial, firing, state, f"--every={span!r}s", f"--at-time={3 * span!r}s")
    same("number of states", len(every), 3)
    for found, wanted in zip(every, listed):
        near("time", found["time"], wanted["time"], 1e-12)
        same("positions", found["particles"]["position"], wanted["particles"]["position"])


def sinter_later(trial):
    """The time of the input counts on: a state that is older by T is fired to a time later by T alike. Times round at 1e-16 of T,
    which is as long as the run, or a thousand or a million times: REORDERED."""
    state, firing, time = drawn_firing(trial)
    earlier = trial.choose(1, 1e3, 1e6) * trial.between(0.5, 2) * time
    found = held(trial, firing, {**state, "time": earlier}, earlier + time)
    found["time"] = time
    alike(found, held(trial, firing, state, time, name="green.kiln"))


def sinter_schedule(trial):
    """A schedule that only holds is --temperature and --at-time: REORDERED."""
    state, firing, time = drawn_firing(trial)
    wanted = held(trial, firing, state, time, name="green.kiln")
    firing.options[0] = f"--schedule={firing.options[0].split('=')[1]} {time!r}s"
    alike(held(trial, firing, state, None), wanted)


def sinter_two_names(trial):
    """One material under two names, at random for each particle, and their contact stated as what the materials give anyway:
    REORDERED."""
    state, firing, time = drawn_firing(trial, mixed=0.0)
    alumina = state["materials"][0]
    twins = with_materials(state, [{**alumina, "name": "b"}, {**alumina, "name": "a"}],
                           trial.random.integers(0, 2, len(state["particles"]["radius"])))
    if trial.random.uniform() < 0.5:
        twins["contacts"] = [{"materials": ["a", "b"], "surface_energy": alumina["surface_energy"]}]
    alike(held(trial, firing, twins, time), held(trial, firing, state, time, name="green.kiln"))


def sinter_conserves(trial):
    """Particles, radii, materials and unknown arrays come back as they were, bit by bit; the density told is that of spheres in
    the box (1e-12); stresses are the pressure given on loaded axes and none on free ones that contacts reach through (SOLVED);
    viscosities are symmetric, and no strain rate gives work (1e-4, as they are solved)."""
    state, firing, time = drawn_firing(trial, free=False)
    state["particles"]["colour"] = trial.random.integers(0, 255, (len(state["particles"]["radius"]), 2)).astype("u1")
    found = held(trial, firing, state, time, "--report=viscosity")
    for name in ("id", "radius", "material", "colour"):
        same(name, found["particles"][name], state["particles"][name])
    said = summary(found)
    near("density", said["relative_density"], density_of(found), 1e-12)
    viscosity = numpy.array(said["viscosity"])
    scale = numpy.abs(viscosity).max()
    # An axis that no chain of contacts reaches through follows the others, which then bear its pressure.
    through = numpy.diag(viscosity).min() > 1e-3 * scale
    for axis in range(3):
        if "xyz"[axis] not in firing.fixed and through:
            near(f"stress along {'xyz'[axis]}", said["stress"][axis], -firing.pressure[axis], SOLVED,
                 max(said["sintering_stress"], max(firing.pressure)))
    near("symmetry of the viscosity", viscosity, viscosity.T, 1e-4)
    same("work of every strain rate", bool(numpy.linalg.eigvalsh(viscosity).min() > -1e-4 * scale), True)


def sinter_explicit(trial):
    """The explicit method, its mass scaled by k^5 for lengths k times as large as relaxation times ask, obeys the same scaling;
    turned axes turn the result. Sums alone differ, over a thousand steps: 1e-8."""
    state, firing, time = drawn_firing(trial, tolerance=1e-4, gain=(0.0005, 0.001), most=60, mixed=0.0)
    explicit = [option for option in firing.options if not option.startswith("--tolerance")] + ["--method=explicit"]
    firing.options = [*explicit, "--mass-scaling=1e24"]
    steps = summary(held(trial, firing, state, time))["steps"]
    mass = 1e24 * (steps / 1000) ** 2  # for about a thousand steps, whose length goes with the root of the mass
    firing.options = [*explicit, f"--mass-scaling={mass!r}"]
    wanted = held(trial, firing, state, time, name="green.kiln")
    axes, signs = trial.random.permutation(3), trial.random.choice((-1, 1), 3)
    alike(held(trial, firing.turned(axes), turned(state, axes, signs), time), turned(wanted, axes, signs), 1e-8)
    factor = 2.0 ** trial.random.integers(-2, 3)
    firing.options = [*explicit, f"--mass-scaling={mass * factor**5!r}"]
    firing.pressure = tuple(value / factor for value in firing.pressure)
    found = scaled(held(trial, firing, scaled(state, factor), time * factor**4), 1 / factor)
    found["time"] /= factor**4
    alike(found, wanted, 1e-8)
