"""draw.py: green bodies, firings and bars drawn at random, over the options that the programs have."""
import numpy

from trial import Broken

SECOND = {"name": "second", "density": 6000.0, "surface_energy": 0.8, "atomic_volume": 3e-29,
          "grain_boundary_diffusion": {"prefactor": 2e-14, "activation_energy": 450e3},
          "young_modulus": 210e9, "poisson_ratio": 0.3}


def sizes(trial):
    """Options of a size distribution with diameters of tens to hundreds of nanometres."""
    median = round(trial.between(60, 300), 1)
    lognormal = f"{median}nm:{trial.between(1.05, 1.35):.3f}:{median / 2:.1f}nm:{median * 2:.1f}nm"
    bimodal = f"{median}nm:{median * trial.between(1.2, 2.0):.1f}nm:{trial.between(0.2, 0.8):.2f}"
    return [trial.choose(f"--diameter={median}nm", f"--distribution=lognormal:{lognormal}", f"--distribution=bimodal:{bimodal}")]


def packing(trial, most=160, least=30):
    """Options of `sinter green` for a packing of `least` to `most` particles with contacts throughout."""
    number = int(trial.random.integers(least, most + 1))
    aspect = trial.choose("1:1:1", "1:1:1", "2:1:1", "1:2:1.5", "1:1:0.7")
    method = trial.choose(["--method=loose", f"--density={trial.between(0.45, 0.52):.3f}"],
                          ["--method=affine", f"--density={trial.between(0.4, 0.48):.3f}",
                           f"--compact-to={trial.between(0.52, 0.62):.3f}"],
                          ["--method=soft", f"--density={trial.between(0.55, 0.62):.3f}"])
    return [f"--particles={number}", *sizes(trial), f"--aspect={aspect}", *method, f"--seed={trial.random.integers(10**6)}"]


def green(trial, most=160, mixed=0.4, tiny=0.0):
    """A packing, in the share `mixed` of all cases with a second material for some of its particles, and in the share `tiny` one
    of so few particles, 1 to 10, that they touch their own images, or one another twice."""
    few = {"least": 1, "most": 10} if trial.random.uniform() < tiny else {"most": most}
    state, = until_taken(lambda: trial.states("sinter", "green", *packing(trial, **few)), "jammed")
    if trial.random.uniform() < mixed:
        second = {**SECOND, "dihedral_angle": 2.0} if trial.random.uniform() < 0.3 else SECOND
        state["materials"] = [*state["materials"], second]
        rows = trial.random.uniform(size=len(state["particles"]["radius"])) < trial.between(0.1, 0.5)
        state["particles"]["material"] = rows.astype("i4")
    return state


def density_of(state):
    return float(4 / 3 * numpy.pi * (state["particles"]["radius"] ** 3).sum() / numpy.prod(numpy.diag(state["box"]["vectors"])))


def goal(trial, state, least=0.01, most=0.06):
    """A density somewhat above that of a state."""
    return density_of(state) + trial.between(least, most)


def until_taken(make, *refusals):
    """What make() gives, drawn anew as long as a program refuses it in one of these sentences: bodies too loose for what is
    asked of them."""
    for _ in range(20):
        try:
            return make()
        except Broken as broken:
            if not any(refusal in str(broken) for refusal in refusals):
                raise
            said = broken
    raise Broken(f"drawn twenty times, and every time refused: {said}")


def bonded(trial, most=200, tiny=0.0):
    """A packing whose overlaps became bonds."""
    state = green(trial, most, tiny=tiny)
    made, = trial.states("bondify", "--quiet", trial.put("overlapping.kiln", state))
    return made


def cell(trial, most=200, *options):
    """A bonded packing that resists every strain, and its elastic tensor."""
    def make():
        state = bonded(trial, most, tiny=0.2)
        return state, trial.results("analyze", "elastic", *options, trial.put("bonded.kiln", state))[0]

    return until_taken(make, "some strain meets no resistance", "has no bonds")


def bar(trial, most=300, mixed=0.3):
    """A bar that bends, with options of `bend` and its result."""
    def make():
        number = int(trial.random.integers(60, most + 1))
        packed = [f"--particles={number}", *sizes(trial), f"--aspect={trial.between(3, 6):.2f}:1:{trial.between(0.8, 1.2):.2f}",
                  "--method=affine", "--density=0.45", f"--compact-to={trial.between(0.6, 0.75):.3f}",
                  f"--seed={trial.random.integers(10**6)}"]
        state, = trial.states("sinter", "green", *packed)
        if trial.random.uniform() < mixed:
            state["materials"] = [*state["materials"], SECOND]
            state["particles"]["material"] = (trial.random.uniform(size=number) < 0.3).astype("i4")
        state, = trial.states("bondify", "--quiet", trial.put("overlapping.kiln", state))
        options = ["--quiet", f"--bond-law={trial.choose('series', 'solid', 'neck', 'centre')}", "--points=4", "--cycles=1"]
        return state, options, trial.results("bend", *options, trial.put("bar.kiln", state))[0]

    return until_taken(make, "is in pieces", "does not reach its supports", "touches no particle", "does not bend downwards")
