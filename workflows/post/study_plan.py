"""study_plan.py: reads the file of a study, powder.toml, and writes what the Makefile of workflows/study makes: the options of each
body and the list of bodies. Everything that is wrong with the file is said here, before anything is computed."""
import argparse
import difflib
import hashlib
import itertools
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tomllib

import schedules
import study_results
import units
from convert_common import ConvertError

STEPS = (0.6, 0.7, 0.8, 0.9)  # relative densities of the states of a firing, where the file names none
GUESS = {"prefactor": 1e-8, "activation_energy": 500e3}  # m3/s, J/mol: where a calibration begins if the material has none
HOT = "3000C"  # where the run of a calibration would end if its body did not get dense before
ROOM = 0.02  # relative density by which the first of them has to lie above the green body
# What stands in powder.toml, table by table. Keys of [powder] and [firing] are options of sinter green and sinter besides.
POWDER = ("material", "density", "diameter", "distribution", "sizes-by", "shares", "columns", "length-unit", "method", "compact-to",
          "swell", "damping", "mean-overlap", "aspect")
FIRING = ("calibrate", "temperature", "schedule", "time-column", "temperature-column", "densities", "coarsening", "chi",
          "neck-share", "neck-growth", "fix", "confine", "pressure", "tolerance", "alpha", "beta", "eta")
TEST = ("bend", "span", "punch-radius", "max-deflection", "max-force", "cycles", "friction", "tensile-strength", "shear-strength",
        "bond-law", "conductivity", "boundary-resistance", "necks")
MEASURED = ("dilatometer", "expansion", "moduli", "strengths", "span", "width", "height")
VARY = ("size", "temperature", "material", "density", "schedule", "seeds")
TOP = ("title", "particles", "seed", "seeds", "powder", "firing", "test", "measured", "vary")
SIZE = re.compile(r"\bSIZE\b")


class PlanError(ValueError):
    """One sentence on what is wrong in the file."""


def known(table, names, where):
    """The table, with - for _ in its keys; a key that is none of the names is refused with the one that it may stand for."""
    if not isinstance(table, dict):
        raise PlanError(f"{where} is not a table")
    table = {key.replace("_", "-"): value for key, value in table.items()}
    for key in table:
        if key not in names:
            near = difflib.get_close_matches(key, names, 1)
            raise PlanError(f"{where} has a key '{key}' that is not known; " +
                            (f"is {near[0]} meant?" if near else f"the keys are {', '.join(names)}"))
    return table


def one_or_more(value):
    return value if isinstance(value, list) else [value]


def listed(value, where):
    if not isinstance(value, list) or not value:
        raise PlanError(f"{where} is not a list")
    return value


def number(value, where, lowest=0.0):
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not value > lowest:
        raise PlanError(f"{where} is {value!r}, not a number above {lowest:g}")
    return value


class Study:
    """What the file says, checked; paths are taken from the folder that it stands in."""

    def __init__(self, path, analyze):
        """analyze: the program that knows the materials."""
        self.path, self.folder, self.analyze = path, path.parent, analyze
        try:
            with open(path, "rb") as stream:
                said = tomllib.load(stream)
        except tomllib.TOMLDecodeError as error:
            raise PlanError(f"is not TOML: {error}") from None
        said = known(said, TOP, "the file")
        self.title = said.get("title") or (path.parent.name if path.stem == "powder" else path.stem)
        self.particles = number(said.get("particles", 1000), "particles")
        self.powder = known(said.get("powder", {}), POWDER, "[powder]")
        self.firing = known(said.get("firing", {}), FIRING, "[firing]")
        self.test = known(said.get("test", {}), TEST, "[test]")
        self.measured = known(said.get("measured", {}), MEASURED, "[measured]")
        self.vary = known(said.get("vary", {}), VARY, "[vary]")
        self.seeds = self.vary.pop("seeds", said.get("seeds", 1))
        if isinstance(self.seeds, int):
            self.seeds = list(range(said.get("seed", 1), said.get("seed", 1) + self.seeds))
        listed(self.seeds, "[vary] seeds, a number or a list of them,")
        for key, values in self.vary.items():
            listed(values, f"[vary] {key}")
        self.check()

    def file(self, name):
        """The absolute path of a file that the study names."""
        path = self.folder / name
        if not path.is_file():
            raise PlanError(f"names the file {name}, which is not in {self.folder}")
        return str(path.resolve())

    def check(self):
        if "material" not in self.powder and "material" not in self.vary:
            raise PlanError("[powder] has no material; analyze materials lists those that are built in, or name a file NAME.json")
        if ("temperature" in self.firing) == ("schedule" in self.firing) and "schedule" not in self.vary:
            raise PlanError("[firing] needs a schedule, or a temperature with densities to reach there")
        if "temperature" in self.firing and "densities" not in self.firing:
            raise PlanError("[firing] has a temperature and no end: give densities, or a schedule")
        if "size" in self.vary and "distribution" in self.powder and not SIZE.search(str(self.powder["distribution"])):
            raise PlanError('[vary] size: write SIZE in the distribution where it belongs, as in "lognormal:SIZE:1.4"')
        for value in listed(self.firing.get("densities", list(STEPS)), "[firing] densities"):
            if number(value, "a value of [firing] densities") >= 1:
                raise PlanError(f"[firing] densities has {value}; a relative density lies below 1")
        for key in ("moduli", "strengths"):
            if key in self.measured:
                self.measured[key] = self.file(self.measured[key])
        if "dilatometer" in self.measured:
            self.measured["dilatometer"] = [self.curve(name) for name in one_or_more(self.measured["dilatometer"])]
        self.check_calibration()
        try:
            study_results.measured_of(self.measured)
        except ConvertError as error:
            raise PlanError(str(error)) from None

    def curve(self, name):
        """File and heating rate of a dilatometer's curve, written FILE or FILE:RATE."""
        path, _, rate = name.rpartition(":")
        if not path or units.quantity(rate, "heating_rate") is None:
            path, rate = name, ""
        return {"file": self.file(path), "rate": rate, "kelvin_per_second": units.quantity(rate, "heating_rate")}

    def check_calibration(self):
        if not self.firing.get("calibrate"):
            return
        if "dilatometer" not in self.measured:
            raise PlanError("[firing] calibrate needs a dilatometer's curve, [measured] dilatometer")
        for key in ("size", "density", "material"):
            if key in self.vary:
                raise PlanError(f"[firing] calibrate is of one powder, and [vary] {key} makes several")
        if "coarsening" in self.firing or "neck-growth" in self.firing:
            raise PlanError("[firing] calibrate is without coarsening; workflows/kinetics calibrates that")

    def material(self, name, output):
        """What --material gets: a built-in name, or a file; a table with `from` becomes a file."""
        if isinstance(name, dict):
            base = name.get("from")
            if not base:
                raise PlanError('[powder] material: a table needs from = "NAME", the material that it begins with')
            try:
                found = json.loads(run_analyze(self.analyze, base if not base.endswith(".json") else self.file(base)))["material"]
            except subprocess.CalledProcessError as error:
                raise PlanError(error.stderr.strip()) from None
            text = json.dumps({**found, "name": f"{base}, changed", **{k: v for k, v in name.items() if k != "from"}}, indent=1)
            write(output / "material.json", text + "\n")
            return str(output / "material.json")
        return self.file(name) if name.endswith(".json") else name

    def cases(self):
        """Name and values of each case: all combinations of what varies."""
        keys = list(self.vary)
        for values in itertools.product(*self.vary.values()):
            case = dict(zip(keys, values))
            yield "-".join(re.sub(r"[^\w.+]+", "_", shown(value)) for value in values) or "all", case

    def green(self, case, seed, material):
        options = {key: value for key, value in self.powder.items() if key not in ("material", )}
        if "size" in case:
            if "distribution" in options:
                options["distribution"] = SIZE.sub(case["size"], options["distribution"])
            else:
                options["diameter"] = case["size"]
        if "density" in case:
            options["density"] = case["density"]
        if str(options.get("distribution", "")).startswith("file:"):
            options["distribution"] = "file:" + self.file(options["distribution"][5:])
        if self.bends():
            options.setdefault("aspect", "6:1:1")
        return {"particles": self.particles, **options, "material": material, "seed": seed}

    def firing_of(self, case, start):
        """Options of sinter; start: the relative density of the green body."""
        options = {key: value for key, value in self.firing.items() if key not in ("densities", "calibrate")}
        densities = [value for value in self.firing.get("densities", STEPS) if value > start + ROOM or "densities" in self.firing]
        if "schedule" in case:
            options["schedule"] = case["schedule"]
            options.pop("temperature", None)
        schedule = options.get("schedule")
        if "temperature" in case and schedule:
            options["schedule"] = schedule = hottest(schedule, case["temperature"])
        elif "temperature" in case:
            options["temperature"] = case["temperature"]
        if schedule and schedule.endswith(".csv"):
            options["schedule"] = self.file(schedule)
        elif schedule:
            # The state at the end, which a firing that reaches its densities does not write.
            options["at-time"] = f"{float(schedules.corners(schedule)[0][-1])!r}s"
        if densities and not (schedule and schedule.endswith(".csv") and "densities" not in self.firing):
            options["to-density"] = ",".join(f"{value:g}" for value in densities)
        if isinstance(options.get("coarsening"), list):
            options["coarsening"] = ",".join(options["coarsening"])
        return options

    def bends(self):
        return bool(self.test.get("bend", any(key in self.test for key in ("span", "tensile-strength", "max-force", "cycles"))))


def shown(value):
    if isinstance(value, dict):
        return value.get("name", value.get("from", "material"))
    return f"{value:g}" if isinstance(value, float) else str(value)


def hottest(schedule, temperature):
    """The schedule with another highest temperature."""
    words = schedules.words_of(schedule)
    values = [schedules.temperature_of(word) for word in words]
    top = max(value for value in values if value is not None)
    if units.quantity(temperature, "temperature") is None:
        raise PlanError(f"[vary] temperature has '{temperature}', which is no temperature such as 1200C")
    return " ".join(temperature if value == top else word for word, value in zip(words, values))


def heating_rate(schedule):
    """The first heating rate of a schedule in words, K/s; None where there is none."""
    words = schedules.words_of(schedule) if not schedule.endswith(".csv") else []
    return next((rate for rate in (units.quantity(word, "heating_rate") for word in words) if rate), None)


def run_analyze(analyze, name):
    return subprocess.run([*shlex.split(analyze), "materials", name], capture_output=True, text=True, check=True).stdout


def check_material(study, material):
    """Refuses a material that lacks what the study does with it, all of it in one sentence."""
    try:
        said = json.loads(run_analyze(study.analyze, material))
    except subprocess.CalledProcessError as error:
        raise PlanError(error.stderr.strip()) from None
    uses = ["sintering", "elasticity"]
    coarsening = str(study.firing.get("coarsening", ""))
    if "surface" in coarsening or "neck-growth" in study.firing:
        uses.append("coarsening by surface diffusion")
    if "boundary" in coarsening:
        uses.append("coarsening by boundaries")
    missing = [f"{', '.join(said['missing'][use])} for {use}" for use in uses if said["missing"][use]]
    if missing:
        raise PlanError(f"material {said['name']} lacks {'; '.join(missing)}" +
                        (f". {said['about']}" if said["about"] else "; docs/materials.md says what the keys are"))
    for remark in said["remarks"]:
        print(f"study: warning: {remark}", file=sys.stderr)
    return said


def toml(options, remarks):
    lines = [f"# {remark}" for remark in remarks]
    return "\n".join(lines + [f"{key} = {json.dumps(value)}" for key, value in options.items()]) + "\n"


def write(path, text):
    """Writes a file only where it says something else, so that make sees no change where there is none."""
    if path.is_file() and path.read_text(encoding="utf-8") == text:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def fingerprints(options):
    """A line for each file that options name: what is in it, so that another content is another set of options."""
    for value in options.values():
        name = str(value).removeprefix("file:")
        if os.path.isabs(name) and os.path.isfile(name):
            yield f"{name}: {hashlib.sha256(pathlib.Path(name).read_bytes()).hexdigest()}"


def quoted(words):
    """Words for a recipe of make."""
    return " ".join(shlex.quote(word) for word in words).replace("$", "$$").replace("#", "\\#")


def options_of(table, names):
    return [word for name in names if name in table for word in (f"--{name}", str(table[name]))]


def calibration(study, material, output):
    """Writes what a calibration begins with, a material and the options of its run; the material that comes of it, and the words of
    `analyze kinetics`."""
    said = json.loads(run_analyze(study.analyze, material))["material"]
    said.setdefault("grain_boundary_diffusion", GUESS)
    said.pop("diffusion_parameter", None)
    folder = output / "calibration"
    write(folder / "guess.json", json.dumps(said, indent=1) + "\n")
    check_material(study, str(folder / "guess.json"))
    green = {**study.green({}, study.seeds[0], str(folder / "guess.json")), "aspect": "1:1:1"}
    write(folder / "green.toml", toml(green, fingerprints(green)))
    rate = study.measured["dilatometer"][0]["rate"] or "10K/min"
    write(folder / "sinter.toml", toml({"schedule": f"25C {rate} {HOT}"}, ()))
    words = []
    for curve in study.measured["dilatometer"]:
        words += ["--curve", curve["file"] + (":" + curve["rate"] if curve["rate"] else "")]
    if "shrinkage" in study_results.dilatometer(study.measured["dilatometer"][0]["file"]):
        words += ["--green-density", str(study.powder.get("compact-to", study.powder.get("density", 0.43)))]
    return str(output / "calibration" / "material.json"), words + options_of(study.measured, ("expansion", ))


def plan(path, output, analyze):
    study = Study(path, analyze)
    bodies, cases = [], []
    start = study.powder.get("compact-to", study.powder.get("density", 0.43))
    kinetics = []
    for name, case in study.cases():
        folder = output / name
        material = study.material(case.get("material", study.powder.get("material")), folder)
        if study.firing.get("calibrate"):
            calibrated, kinetics = calibration(study, material, output)
            solid = check_material(study, str(output / "calibration" / "guess.json"))["material"]
            material = calibrated
        else:
            solid = check_material(study, material)["material"]
        firing = study.firing_of(case, case.get("density", start))
        for seed in study.seeds:
            body = f"{name}/{seed}"
            green = study.green(case, seed, material)
            write(output / body / "green.toml", toml(green, fingerprints(green)))
            write(output / body / "sinter.toml", toml(firing, fingerprints(firing)))
            bodies.append(body)
        cases.append({"name": name, "varied": {key: shown(value) for key, value in case.items()}, "firing": firing,
                      "kelvin_per_second": heating_rate(firing.get("schedule", "")),
                      "young_modulus": solid["young_modulus"], "constant_diffusion": "diffusion_parameter" in solid,
                      "bodies": [f"{name}/{seed}" for seed in study.seeds]})
    bending = options_of(study.test, ("span", "punch-radius", "max-deflection", "max-force", "cycles", "friction",
                                      "tensile-strength", "shear-strength", "bond-law"))
    conduction = options_of(study.test, ("conductivity", "boundary-resistance"))
    strength = options_of(study.measured, ("span", "width", "height"))
    moduli = [study.measured["moduli"]] if "moduli" in study.measured else []
    lines = [f"CASES := {' '.join(bodies)}", f"BONDING := --method necks --necks {study.test.get('necks', 'mass')}",
             f"BENT := {'yes' if study.bends() else ''}", f"TO_FAILURE := {'yes' if 'tensile-strength' in study.test else ''}",
             f"BENDING := {quoted(bending)}", f"CONDUCTION := {quoted(conduction)}",
             f"STRENGTHS := {quoted([study.measured['strengths']]) if 'strengths' in study.measured else ''}",
             f"STRENGTH := {quoted(strength)}",
             f"KINETICS := {quoted(kinetics)}",
             f"MEASURED := {quoted([*(curve['file'] for curve in study.measured.get('dilatometer', [])), *moduli])}"]
    write(output / "plan.mk", "\n".join(lines) + "\n")
    told = {"title": study.title, "file": str(path), "particles": study.particles, "seeds": study.seeds, "cases": cases,
            "measured": study.measured, "calibrated": bool(kinetics), "densities_asked": "densities" in study.firing}
    write(output / "plan.json", json.dumps(told, indent=1) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=pathlib.Path, help="powder.toml")
    parser.add_argument("output", type=pathlib.Path, help="folder of the results")
    parser.add_argument("--analyze", default="analyze", help="the program that knows the materials")
    given = parser.parse_args()
    try:
        plan(given.file, given.output, given.analyze)
    except OSError as error:
        sys.exit(f"study: {error.filename}: {error.strerror}")
    except (PlanError, schedules.ScheduleError) as error:
        sys.exit(f"study: {given.file}: {error}")


if __name__ == "__main__":
    main()
