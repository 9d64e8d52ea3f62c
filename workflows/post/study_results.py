"""study_results.py: what the bodies of a study gave, as study.json, CSV and text: curves of densification, numbers of each state,
and their means over the packings of a case with 95 % intervals (those of `analyze mean`), beside what was measured.

Only packings of one case are replicates of each other. A state is named for the density that it was asked for, or "end"."""
import argparse
import csv
import json
import pathlib
import re
import shlex
import sys

import kiln
import numpy

from convert_common import ConvertError, warn
from ensemble import CONFIDENCE, means
from tables import Table
from units import ZERO_CELSIUS

SAME = 2e-4  # of relative densities
QUANTITIES = {  # key: heading, unit, factor to that unit
    "relative_density": ("relative density", "", 1.0),
    "time": ("time", "min", 1 / 60),
    "temperature": ("temperature", "C", 1.0),
    "shrinkage": ("dL/L0", "%", 100.0),
    "coordination_number": ("coordination number", "", 1.0),
    "neck_ratio": ("neck ratio x/D", "", 1.0),
    "grain_diameter": ("grain diameter", "nm", 1e9),
    "young_modulus": ("Young's modulus, cell", "GPa", 1e-9),
    "poisson_ratio": ("Poisson's ratio, cell", "", 1.0),
    "bending_modulus": ("Young's modulus, bar", "GPa", 1e-9),
    "bending_strength": ("strength, bar", "MPa", 1e-6),
    "conductivity": ("conductivity", "W/m/K", 1.0),
}
CURVE = {  # of curves.csv
    "time": ("time (min)", 1 / 60, 0.0),
    "temperature": ("temperature (C)", 1.0, -ZERO_CELSIUS),
    "relative_density": ("relative_density", 1.0, 0.0),
    "rate": ("densification_rate (%/min)", 6000.0, 0.0),
    "shrinkage": ("dL/L0 (%)", 100.0, 0.0),
    "coordination_number": ("coordination_number", 1.0, 0.0),
    "grain_diameter": ("grain_diameter (nm)", 1e9, 0.0),
}
NEEDLESS = "sinter green: material"
LENGTH = {"dl/l0", "dl/lo", "dl/l", "strain", "shrinkage", "linear shrinkage"}
DENSITY = {"relative_density", "relative density", "density", "rel. density"}


def curve_of(path):
    """The steps of a history as arrays, and what follows from them; nothing of an empty file."""
    steps = kiln.read(path)
    if not steps:
        return None
    curve = {key: numpy.array([step[key] for step in steps]) for key in
             ("time", "temperature", "relative_density", "coordination_number")}
    strain = numpy.array([step["strain"] for step in steps])  # logarithmic
    curve["shrinkage"] = (numpy.exp(strain) - 1).mean(axis=1)
    if "mean_grain_diameter" in steps[0]:
        curve["grain_diameter"] = numpy.array([step["mean_grain_diameter"] for step in steps])
    rising = numpy.concatenate(([True], numpy.diff(curve["time"]) > 0))
    curve = {key: values[rising] for key, values in curve.items()}
    time, density = curve["time"], curve["relative_density"]
    curve["rate"] = numpy.gradient(density, time) if len(time) > 2 else numpy.zeros(len(time))
    return curve


def label_of(density, asked, last):
    """The name of a state."""
    near = [value for value in asked if abs(value - density) < SAME]
    return f"{near[0]:g}" if near else "end" if last else f"{density:.3f}"


def said_in(path):
    """The sentences of a stage without the files that they name, and whether it failed."""
    kind = "warning" if path.with_suffix("").stat().st_size else "failed"
    for line in path.read_text(encoding="utf-8").splitlines():
        sentence = re.sub(r"\S+\.(?:kiln|jsonl?)(?:, document \d+)?: ", "", line.replace("warning: ", "")).strip()
        if sentence:
            yield kind, sentence


class Body:
    """One packing of a case, fired and tested."""

    def __init__(self, run, name, asked, solid):
        """asked: relative densities; solid: Young's modulus of the dense material, Pa."""
        self.run, self.name, self.doubts = run, name, []
        self.case, self.seed = name.rsplit("/", 1)
        self.curve = curve_of(run / name / "history.jsonl")
        density, bonds, elastic, modulus, conductivity = (
            self.results(f"{kind}.json") for kind in ("density", "bonds", "elastic", "modulus", "conductivity"))
        strength = self.results("strength.json")
        strengths = strength[0].get("strengths", []) if strength else []
        self.states = []
        for k, state in enumerate(density):
            found = {"relative_density": state["relative_density"], "time": state["time"],
                     "coordination_number": state["coordination_number"], "grain_diameter": state["mean_grain_diameter"]}
            found["label"] = label_of(state["relative_density"], asked, k == len(density) - 1)
            if self.curve:
                for key in ("temperature", "shrinkage"):
                    found[key] = float(numpy.interp(state["time"], self.curve["time"], self.curve[key]))
                found["temperature"] -= ZERO_CELSIUS
            if k < len(bonds) and bonds[k]["mean_diameter"]:
                found["neck_ratio"] = bonds[k]["mean_diameter"] / state["mean_grain_diameter"]
            if k < len(elastic) and elastic[k]["young_modulus"] > solid:
                self.doubts.append(f"at a relative density of {state['relative_density']:.3g} the necks are beyond what the law of "
                                   "the modulus holds for: it gives more than the dense solid has, and is left out")
            elif k < len(elastic):
                found.update(young_modulus=elastic[k]["young_modulus"], poisson_ratio=elastic[k]["poisson_ratio"])
            if k < len(modulus):
                found["bending_modulus"] = modulus[k]["young_modulus"]
            if k < len(conductivity):
                found.update(conductivity=conductivity[k]["conductivity"], conductivity_bound=conductivity[k]["bound"])
            if k < len(strengths):
                found["bending_strength"] = strengths[k]["strength"] if isinstance(strengths[k], dict) else strengths[k]
            if self.states and state["time"] - self.states[-1]["time"] <= 1e-6 * state["time"] and found["label"] == "end":
                self.states.pop()  # the end of the firing was asked for, and is written once more where a density was not reached
            self.states.append(found)

    def results(self, name):
        path = self.run / self.name / name
        return kiln.read(path) if path.is_file() else []

    def remarks(self, noise):
        """Sentences of the stages, warnings and errors, without the paths of this run; and whether a stage failed."""
        yield from (("warning", sentence) for sentence in self.doubts)
        for path in sorted((self.run / self.name).glob("*.said")):
            for kind, sentence in said_in(path):
                if not any(word in sentence for word in noise):
                    yield kind, sentence


def summarized(bodies, analyze):
    """Mean and interval of every number of the states of one name, over the bodies of one case."""
    rows = []
    for label in dict.fromkeys(state["label"] for body in bodies for state in body.states):
        states = [state for body in bodies for state in body.states if state["label"] == label]
        row = {"label": label, "packings": len(states)}
        keys_of = {}  # those that the same packings have are one question
        for key in QUANTITIES:
            having = tuple(k for k, state in enumerate(states) if state.get(key) is not None)
            if having:
                keys_of.setdefault(having, []).append(key)
        for having, keys in keys_of.items():
            said = means(shlex.split(analyze)[0], [{key: states[k][key] for key in keys} for k in having])
            for key in keys:
                low, high = said["interval"][key] or (None, None)
                row[key] = {"mean": said["mean"][key], "lower": low, "upper": high, "packings": len(having)}
        bound = [state["conductivity_bound"] for state in states if "conductivity_bound" in state]
        if bound:
            row["conductivity_bound"] = sum(bound) / len(bound)
        rows.append(row)
    return sorted(rows, key=lambda row: (row["label"] == "end", row["relative_density"]["mean"]))


def column_of(table, names):
    return next((name for name in table.names if name.lower() in names), None)


def dilatometer(path):
    """Temperatures (C) with dL/L0 or relative densities of a measured curve."""
    table = Table(path)
    temperature = column_of(table, {"temperature", "temperature pv", "t", "temp", "temp."})
    length, density = column_of(table, LENGTH), column_of(table, DENSITY)
    if temperature is None or (length or density) is None:
        raise ConvertError(f"{path}: a dilatometer's curve has a column 'temperature (C)' and one of 'dL/L0 (%)' or "
                           f"'relative_density', not only {', '.join(table.names)}")
    found = {"temperature": (table.values(temperature) - (ZERO_CELSIUS if table.units[table.index(temperature)] else 0)).tolist()}
    if length:
        values = table.values(length)
        found["shrinkage"] = (-values if "shrinkage" in length.lower() and values.max() > -values.min() else values).tolist()
    if density:
        found["relative_density"] = table.values(density).tolist()
    return found


def measured_of(files):
    """What stands in the tables of a dilatometer and of moduli."""
    found = {}
    if "dilatometer" in files:
        found["dilatometer"] = [{"kelvin_per_second": curve["kelvin_per_second"], **dilatometer(curve["file"])}
                                for curve in files["dilatometer"]]
    if "moduli" in files:
        table = Table(files["moduli"], wanted=("young_modulus",))
        density = column_of(table, DENSITY)
        if density is None:
            raise ConvertError(f"{files['moduli']}: has no column relative_density")
        found["moduli"] = [{"relative_density": x, "young_modulus": y}
                           for x, y in zip(table.values(density).tolist(), table.values("young_modulus").tolist())]
    return found


def curve_for(case, measured):
    """The dilatometer's curve that a case can be compared with: of its heating rate, or of one that nobody stated."""
    for curve in measured.get("dilatometer", []):
        rate = curve["kelvin_per_second"]
        if rate is None or case["kelvin_per_second"] and abs(rate / case["kelvin_per_second"] - 1) < 1e-6:
            return curve
    return None


def compared(cases, measured):
    """Deviations of each case from what was measured."""
    for case in cases:
        rows = [row for row in case["states"] if "young_modulus" in row]
        if "moduli" in measured and len(rows) > 1:
            density = [row["relative_density"]["mean"] for row in rows]
            modulus = [row["young_modulus"]["mean"] for row in rows]
            inside = [point for point in measured["moduli"] if density[0] <= point["relative_density"] <= density[-1]]
            case["moduli_over_measured"] = [
                {"relative_density": point["relative_density"], "measured": point["young_modulus"],
                 "simulated": float(numpy.interp(point["relative_density"], density, modulus))} for point in inside]
        curve = curve_for(case, measured)
        if not curve or not case["curves"]:
            continue
        case["dilatometer"] = curve
        key = "relative_density" if "relative_density" in curve else "shrinkage"
        differences = []
        for temperature, value in zip(curve["temperature"], curve[key]):
            kelvin = temperature + ZERO_CELSIUS
            here = [numpy.interp(kelvin, each["temperature"], each[key]) for each in case["curves"]
                    if each["temperature"][0] <= kelvin <= max(each["temperature"])]
            if here:
                differences.append(float(numpy.mean(here)) - value)
        if differences:
            case["dilatometer_deviation"] = {"quantity": key, "rms": float(numpy.sqrt(numpy.mean(numpy.square(differences)))),
                                             "largest": max(differences, key=abs), "points": len(differences)}


def number(value, factor=1.0):
    return "" if value is None else f"{value * factor:.6g}"


def write_csv(path, head, rows):
    with open(path, "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def with_unit(key):
    heading, unit, _ = QUANTITIES[key]
    return f"{heading} ({unit})" if unit else heading


def write_tables(run, bodies, cases):
    keys = [key for key in CURVE if any(body.curve and key in body.curve for body in bodies)]
    write_csv(run / "curves.csv", ["case", "seed", *(CURVE[key][0] for key in keys)],
              [[body.case, body.seed, *(number(body.curve[key][k] + CURVE[key][2], CURVE[key][1]) for key in keys)]
               for body in bodies if body.curve for k in range(len(body.curve["time"]))])
    keys = [key for key in QUANTITIES if any(key in state for body in bodies for state in body.states)]
    write_csv(run / "states.csv", ["case", "seed", "state", *map(with_unit, keys)],
              [[body.case, body.seed, state["label"], *(number(state.get(key), QUANTITIES[key][2]) for key in keys)]
               for body in bodies for state in body.states])
    write_csv(run / "summary.csv",
              ["case", "state", "packings", *(head for key in keys for head in (with_unit(key), "lower", "upper"))],
              [[case["name"], row["label"], row["packings"],
                *(number(row.get(key, {}).get(which), QUANTITIES[key][2]) for key in keys for which in ("mean", "lower", "upper"))]
               for case in cases for row in case["states"]])


def interval(entry, factor):
    """Mean and half the interval, as text."""
    if entry is None:
        return "-"
    if entry["lower"] is None or entry["upper"] - entry["lower"] < 1e-5 * abs(entry["mean"]):
        return f"{entry['mean'] * factor:.4g}"
    return f"{entry['mean'] * factor:.4g} ± {(entry['upper'] - entry['lower']) / 2 * factor:.2g}"


def case_rows(case):
    """Headings and rows of the table of a case: a line for each quantity, a column for each state."""
    keys = [key for key in QUANTITIES if any(key in row for row in case["states"])]
    head = ["", *(row["label"] for row in case["states"])]
    return head, [[with_unit(key), *(interval(row.get(key), QUANTITIES[key][2]) for row in case["states"])] for key in keys]


def aligned(head, rows):
    widths = [max(len(str(row[k])) for row in [head, *rows]) for k in range(len(head))]
    return ["  ".join([row[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:]))])
            for row in [head, *rows]]


def comparison_lines(case):
    lines = []
    if case.get("constant_diffusion"):
        lines.append("  times are those of the constant diffusion_parameter that the material was given, whatever the temperature")
    for point in case.get("moduli_over_measured", []):
        ratio = point["simulated"] / point["measured"]
        lines.append(f"  at {point['relative_density']:.3f}: Young's modulus of the cell {point['simulated'] / 1e9:.4g} GPa, "
                     f"measured {point['measured'] / 1e9:.4g} GPa, {100 * (ratio - 1):+.0f} %")
    deviation = case.get("dilatometer_deviation")
    if deviation:
        what = "relative density" if deviation["quantity"] == "relative_density" else "dL/L0"
        lines.append(f"  {what} less that of the dilatometer at the same temperature: {deviation['rms']:.3f} in the mean square, "
                     f"{deviation['largest']:+.3f} at most, {deviation['points']} points")
    return lines


def calibration_of(result):
    """The constants that `analyze kinetics` found, and how well they meet the curves."""
    body = result["bodies"][0]
    return {"prefactor": body["constants"]["prefactor"], "activation_energy": body["constants"]["activation_energy"],
            "curves": [{key: curve[key] for key in ("name", "rms", "max")} for curve in body["curves"]]}


def calibration_line(found):
    curves = "; ".join(f"{curve['name']} within {curve['max']:.3f}" for curve in found["curves"])
    return (f"Calibrated on the dilatometer: delta D_0b {found['prefactor']:.3g} m3/s, Q {found['activation_energy'] / 1e3:.4g} "
            f"kJ/mol; relative densities of {curves}")


def as_text(study):
    lines = [study["title"], "=" * len(study["title"])]
    for case in study["cases"]:
        if len(study["cases"]) > 1:
            lines += ["", case["name"]]
        if not case["states"]:
            lines += ["  nothing came of it, see below"]
            continue
        lines += ["", *aligned(*case_rows(case)), *comparison_lines(case)]
    lines += ["", f"Means over the packings of a case, ± half of the {100 * CONFIDENCE:.0f} % interval (Student's t)" +
              ("" if len(study["seeds"]) > 1 else "; one packing has none: [vary] seeds = 3")]
    if study["calibration"]:
        lines.append(calibration_line(study["calibration"]))
    strengths = study["measured"].get("strengths")
    if strengths:
        lines += [f"Measured strengths: {strengths['bars']} bars, mean {strengths['mean_strength'] / 1e6:.4g} MPa" +
                  (f", Weibull modulus {strengths['weibull_modulus']:.3g}" if strengths.get("weibull_modulus") else "")]
    if study["remarks"]:
        lines += ["", "What the programs said"]
        lines += [f"  {'FAILED: ' if each['kind'] == 'failed' else ''}{each['sentence']}  [{', '.join(each['bodies'])}]"
                  for each in study["remarks"]]
    return "\n".join(lines) + "\n"


def remarks_of(bodies, plan):
    """What was said, each sentence once, with the bodies that it was said of."""
    noise = [NEEDLESS]  # what it lacks for what is done with it was said before all this
    if not plan["densities_asked"]:
        noise.append("short of the required")
    found = {}
    for body in bodies:
        for kind, sentence in body.remarks(noise):
            plain = re.sub(r"[0-9][0-9.e+-]*", "#", sentence)  # the numbers differ from packing to packing
            entry = found.setdefault((kind, plain), {"kind": kind, "sentence": sentence, "bodies": []})
            if body.name not in entry["bodies"]:
                entry["bodies"].append(body.name)
    run = bodies[0].run
    others = [(run / "measured_strength.json.said", "measured strengths")] if "strengths" in plan["measured"] else []
    if plan["calibrated"]:
        others += [(path, "calibration") for path in sorted((run / "calibration").glob("*.said"))]
    for path, name in others:
        for kind, sentence in said_in(path) if path.is_file() else ():
            # The run of a calibration is to get dense.
            if not any(word in sentence for word in (NEEDLESS, "fully dense", "above a relative density of 0.9")):
                found[kind, name, sentence] = {"kind": kind, "sentence": sentence, "bodies": [name]}
    return sorted(found.values(), key=lambda each: each["kind"])


def results(run, analyze):
    plan = json.loads((run / "plan.json").read_text(encoding="utf-8"))
    bodies = []
    for case in plan["cases"]:
        asked = [float(value) for value in str(case["firing"].get("to-density", "")).split(",") if value]
        bodies += [Body(run, name, asked, case["young_modulus"]) for name in case["bodies"]]
    cases = []
    for case in plan["cases"]:
        own = [body for body in bodies if body.name in case["bodies"]]
        curves = [{"seed": body.seed, **{key: values.tolist() for key, values in body.curve.items()}} for body in own if body.curve]
        cases.append({**case, "states": summarized(own, analyze), "curves": curves})
    measured = measured_of(plan["measured"])
    strengths = kiln.read(run / "measured_strength.json") if "strengths" in plan["measured"] else []
    if strengths:
        measured["strengths"] = dict(strengths[0])
    fitted = kiln.read(run / "calibration" / "kinetics.json") if plan["calibrated"] else []
    compared(cases, measured)
    write_tables(run, bodies, cases)
    return {"title": plan["title"], "particles": plan["particles"], "seeds": plan["seeds"], "cases": cases, "measured": measured,
            "calibration": calibration_of(fitted[0]) if fitted else None, "remarks": remarks_of(bodies, plan)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=pathlib.Path, help="folder with plan.json and the results of each body")
    parser.add_argument("--analyze", default="analyze", help="the program that takes the means")
    given = parser.parse_args()
    warn.name = "study"
    try:
        study = results(given.run, given.analyze)
    except (ConvertError, kiln.Error) as error:
        sys.exit(f"study: {error}")
    (given.run / "study.json").write_text(json.dumps(study, indent=1) + "\n", encoding="utf-8")
    (given.run / "report.txt").write_text(as_text(study), encoding="utf-8")


if __name__ == "__main__":
    main()
