"""firings.py: runs of `sinter` drawn at random, and what two of them that should be alike may differ by.

Firings are short, a few thousandths of density, at a tolerance of 1e-6: where a change of the input only puts floating-point sums
into another order, what is different then comes of the solves, and of single contacts that form a little sooner or later. Over a
whole firing packings branch, and small ones differ by far more than the tolerance (docs/sintering.md).
"""
import json

import numpy

from changes import lengths, offsets
from draw import density_of, green, until_taken
from trial import near, summary

# What the first steps of two runs of one packing with sums in another order may differ by, in density: solves end at 1e-8 of a
# step's motion, and 1.5e-8 was the most in 50 pairs of runs.
FIRST = 2e-7
# The same in the end, a few dozen steps later. Half of all pairs of runs differ by less than 1e-11, but where a contact forms
# sooner or later by up to 1e-3; and of positions, in radii: of half of the particles, and of one that such a contact holds.
REORDERED, PLACES, PLACE = 1e-3, 2e-3, 0.2
# Viscosities and stresses are solved to 1e-4. They are compared at the beginning, before contacts can form.
SOLVED = 1e-3
# What two runs with other steps may differ by, in tolerances of the run: each is allowed one over a whole firing.
STEPS = 3.0


class Firing:
    """Options of `sinter` apart from the times and densities wanted: temperature, faces of the box, constants of the contact."""

    def __init__(self, trial, tolerance=1e-4, faces=True):
        self.tolerance = tolerance
        self.options = [f"--temperature={trial.between(1100, 1300):.1f}C", f"--tolerance={tolerance}"]
        self.fixed, self.confined, self.pressure = "", "", (0.0, 0.0, 0.0)
        kind = trial.choose("free axes", "free axes", "fixed", "loaded", "no faces") if faces else "free axes"
        self.boundary = "free" if kind == "no faces" else None
        if kind == "fixed":
            self.fixed = trial.choose("x", "y", "z", "xy", "yz", "xz")
        if kind == "loaded":
            self.pressure = tuple(float(trial.choose(0.0, 1e6, 5e6, 2e7)) for _ in range(3))
        if trial.random.uniform() < 0.3:
            self.options += [f"--alpha={trial.between(3, 5):.3f}", f"--eta={trial.choose(0.001, 0.1, 1)}"]

    def arguments(self, *wanted):
        faces = [f"--boundary={self.boundary}"] if self.boundary else []
        if self.fixed:
            faces.append(f"--fix={self.fixed}")
        if self.confined:
            faces.append(f"--confine={self.confined}")
        if any(self.pressure):
            faces.append("--pressure=" + ",".join(f"{value!r}Pa" for value in self.pressure))
        return [*self.options, *faces, *wanted]

    def turned(self, axes):
        """The same along other axes: new axis k is old axis axes[k]."""
        other = object.__new__(Firing)
        other.__dict__.update(self.__dict__)
        other.fixed, other.confined = ("".join("xyz"[k] for k in range(3) if "xyz"[axes[k]] in names)
                                       for names in (self.fixed, self.confined))
        other.pressure = tuple(self.pressure[k] for k in axes)
        return other


def fired(trial, firing, state, *wanted, name="green.kiln", statuses=(0,)):
    """What `sinter` makes of a state."""
    return trial.states("sinter", *firing.arguments(*wanted), trial.put(name, state), statuses=statuses)


def alike(found, wanted, tolerance=REORDERED):
    """Breaks unless these are states of the same particles after the same time, densities to a tolerance."""
    near("time", found["time"], wanted["time"], 1e-12)
    near("density after a step", found["first"]["relative_density"], wanted["first"]["relative_density"], FIRST)
    near("density", density_of(found), density_of(wanted), tolerance)
    near("edges", lengths(found), lengths(wanted), tolerance)
    apart = numpy.linalg.norm(offsets(found, wanted), axis=1) / wanted["particles"]["radius"].mean()
    near("median of offsets, in radii", numpy.median(apart), 0, PLACES, 1.0)
    near("offset of a particle, in radii", apart.max(), 0, PLACE, 1.0)


def drawn_firing(trial, tolerance=1e-6, gain=(0.001, 0.005), most=160, mixed=0.4, faces=True, free=True):
    """A packing, a firing and the time, s, that it takes to become somewhat denser. A packing that is too loose for that is drawn
    anew."""
    def make():
        state, firing = green(trial, most, mixed=mixed), Firing(trial, tolerance, faces)
        if not free:
            firing.boundary = None
        reached, = fired(trial, firing, state, f"--to-density={density_of(state) + trial.between(*gain)!r}")
        return state, firing, reached["time"]

    return until_taken(make, "cannot be reached", "has shrunk into itself")


def held(trial, firing, state, time, *more, name="changed.kiln"):
    """A state fired to a time, s, with what the history says of the first step as `first`."""
    until = [f"--at-time={float(time)!r}s"] if time is not None else []
    end, = fired(trial, firing, state, *until, "--history=history.jsonl", *more, name=name)
    end["first"] = json.loads(trial.bytes_of("history.jsonl").split(b"\n", 1)[0])
    return end


def told_at_first(trial, firing, state, time):
    """What is told of a state, viscosities among it, after a millionth of a time, s."""
    return summary(held(trial, firing, state, 1e-6 * time, "--report=viscosity"))


def stress_unit(said):
    """A stress (Pa) that others are compared with: the sintering stress, and a hundredth of a usual one where no contacts reach
    through."""
    return max(said["sintering_stress"], 1e4)


def viscosity_unit(said, time):
    """The same for viscosities, Pa s, of a packing that became denser in a time, s."""
    return max(numpy.abs(said["viscosity"]).max(), stress_unit(said) * time)
