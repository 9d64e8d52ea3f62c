"""of_green.py: relations of `sinter green`."""
import numpy

from changes import lengths
from draw import density_of, packing
from trial import near, same, summary


def green_keeps_its_word(trial):
    """A green body has the particles, the proportions and the density asked for, counted here again (to rounding of sums of n
    terms, 1e-13), ids 0 to n-1, and every centre in the box."""
    options = packing(trial)
    state, = trial.states("sinter", "green", *options)
    asked = dict(option.split("=", 1) for option in options)
    number = int(asked["--particles"])
    wanted = float(asked.get("--compact-to", asked["--density"]))
    same("particles", len(state["particles"]["radius"]), number)
    same("ids", state["particles"]["id"], numpy.arange(number, dtype="i8"))
    near("density", density_of(state), wanted, 1e-13)
    near("density it tells", summary(state)["relative_density"], wanted, 1e-13)
    aspect = numpy.array([float(edge) for edge in asked["--aspect"].split(":")])
    near("edges", lengths(state) / lengths(state)[0], aspect / aspect[0], 1e-14)
    place = state["particles"]["position"] / lengths(state)
    same("centres in the box", bool(((place >= 0) & (place < 1)).all()), True)


def green_doubled(trial):
    """Twice the diameters are twice the packing, to the last bit: a power of two changes no digit, and nothing in packing has a
    length of its own."""
    options = [option for option in packing(trial) if "diameter" not in option and "distribution" not in option]
    median, ratio = trial.between(50, 200), trial.between(1.1, 2)
    kind = trial.choose("monosize", "bimodal", "lognormal")

    def made(factor):
        d = [f"{factor * size!r}nm" for size in (median, median * ratio, median / 2)]
        sizes = {"monosize": [f"--diameter={d[0]}"], "bimodal": [f"--distribution=bimodal:{d[0]}:{d[1]}:0.4"],
                 "lognormal": [f"--distribution=lognormal:{d[0]}:1.2:{d[2]}:{d[1]}"]}[kind]
        return trial.states("sinter", "green", *options, *sizes)[0]

    once, twice = made(1), made(2)
    for name in ("position", "radius"):
        same(name, twice["particles"][name], 2 * once["particles"][name])
    same("box", lengths(twice), 2 * lengths(once))


def green_affine(trial):
    """--compact-to scales the distances of the packing without it, radii and order of particles apart: nearest-image positions
    over the edges of the box are the same to rounding."""
    seed, density, compact = trial.random.integers(10**6), trial.between(0.4, 0.5), trial.between(0.51, 0.7)
    options = ["--particles=80", f"--seed={seed}", f"--density={density:.4f}"]
    loose, = trial.states("sinter", "green", *options)
    pressed, = trial.states("sinter", "green", *options, "--method=affine", f"--compact-to={compact:.4f}")
    near("edges", lengths(pressed), lengths(loose) * (density_of(loose) / density_of(pressed)) ** (1 / 3), 1e-14)
    places = [state["particles"]["position"] / lengths(state) for state in (loose, pressed)]
    near("places in the box", places[1], places[0], 1e-13)
