"""fired.py: densities after firings beside measured ones, and how far the kinetics of the model are from those of the furnace.

Only the integral of the diffusion parameter over time, theta, enters the densification of a given packing (master sintering curve:
H. Su & D. L. Johnson, J. Am. Ceram. Soc. 79 (1996) 3211). The history of the hottest firing gives the density against theta;
with it follow the density after any other firing, the firing that gives a wanted density, and the factor by which diffusion would
have to be slower."""
import argparse
import json
import pathlib
import re

import numpy

import kiln
from convert_common import ConvertError, warn
from schedules import ScheduleError, corners
from tables import Table
from units import ZERO_CELSIUS

GAS_CONSTANT = 8.31446261815324  # J/(mol K)
VALID = 0.9  # relative density above which the model, without grain growth, says nothing
POINTS = 4000  # of the quadrature along each part of a schedule


def theta_along(time, kelvin, energy):
    """Times and the integral of exp(-Q/RT)/T up to them, s/K: theta but for a constant of the material."""
    fine = numpy.unique(numpy.concatenate([numpy.linspace(a, b, POINTS) for a, b in zip(time[:-1], time[1:])]))
    hot = numpy.interp(fine, time, kelvin)
    rate = numpy.exp(-energy / (GAS_CONSTANT * hot)) / hot
    return fine, numpy.concatenate([[0.0], numpy.cumsum((rate[1:] + rate[:-1]) / 2 * numpy.diff(fine))])


def master_curve(run, case, schedule, energy):
    """Densities and theta of the steps of a firing that densified the packing."""
    steps = kiln.read(run / case / "history.jsonl")
    fine, theta = theta_along(*corners(schedule), energy)
    density = numpy.array([step["relative_density"] for step in steps])
    reached = numpy.interp([step["time"] for step in steps], fine, theta)
    rising = numpy.concatenate([[True], (numpy.diff(density) > 0) & (numpy.diff(reached) > 0)])
    return density[rising], reached[rising]


def temperature_for(schedule, theta, energy):
    """The highest temperature (K) with which the same programme reaches theta."""
    low, high = 900.0, 2300.0
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if theta_along(*corners(schedule, middle), energy)[1][-1] < theta else (low, middle)
    return (low + high) / 2


def compare(run, schedules, measured):
    """The firings, and the density of the model against the temperature of the firing."""
    peak = {case: corners(schedule)[1].max() for case, schedule in schedules.items()}
    hottest = max(peak, key=peak.get)
    material = kiln.read(run / hottest / "fired.kiln")[0]["materials"][0]
    energy = material["grain_boundary_diffusion"]["activation_energy"]
    density, theta = master_curve(run, hottest, schedules[hottest], energy)
    firings = []
    for case, schedule in sorted(schedules.items(), key=lambda item: peak[item[0]]):
        state = kiln.read(run / case / "density.json")[0]
        entry = {
            "firing": case,
            "schedule": schedule,
            "temperature": peak[case],
            "relative_density": state["relative_density"],
            "measured": measured.get(case),
            "equivalent_temperature": None,
            "slower_by": None
        }
        if entry["measured"] is not None:
            needed = float(numpy.exp(numpy.interp(entry["measured"], density, numpy.log(theta))))
            entry["equivalent_temperature"] = temperature_for(schedule, needed, energy)
            entry["slower_by"] = theta_along(*corners(schedule), energy)[1][-1] / needed
        firings.append(entry)
    grid = numpy.linspace(min(peak.values()) - 100.0, max(peak.values()) + 25.0, 100)
    reached = [theta_along(*corners(schedules[hottest], kelvin), energy)[1][-1] for kelvin in grid]
    curve = numpy.interp(numpy.log(reached), numpy.log(theta), density)
    return {
        "firings": firings,
        "material": material["name"],
        "activation_energy": energy,
        "curve": {
            "temperature": grid.tolist(),
            "relative_density": curve.tolist()
        }
    }


def as_text(result):
    lines = [
        "Relative densities after the firings", "",
        f"{'firing':>8}{'model':>9}{'measured':>10}   {'model reaches the measured one at':>34}   "
        f"{'diffusion should be slower by':>30}"
    ]
    for entry in result["firings"]:
        words = "" if entry["measured"] is None else (
            f"{entry['measured']:10.2f}   {entry['equivalent_temperature'] - ZERO_CELSIUS:32.0f} C"
            f"   {entry['slower_by']:30.1f}")
        lines.append(f"{entry['firing']:>8}{entry['relative_density']:9.3f}{words}" +
                     ("   *" if entry["relative_density"] > VALID else ""))
    known = [entry for entry in result["firings"] if entry["slower_by"]]
    lines += ["", f"* above {VALID}: outside of what the model can say, for it has no grain growth."]
    if len(known) > 1:
        first, last = known[0], known[-1]
        slope = numpy.polyfit([1 / entry["temperature"] for entry in known], [numpy.log(entry["slower_by"]) for entry in known],
                              1)[0]
        apparent = result["activation_energy"] + slope * GAS_CONSTANT
        lines += [
            "",
            f"With the diffusion data of {result['material']} the model sinters {first['slower_by']:.2g} times as fast as measured "
            f"at {first['firing']}, {last['slower_by']:.2g} times at {last['firing']}.",
            f"The measured densities rise {'more slowly' if slope < 0 else 'faster'} with temperature than one activated process "
            f"of {result['activation_energy'] / 1e3:.0f} kJ/mol has it;",
            "read as a master sintering curve of this packing they have an apparent activation energy of "
            f"{apparent / 1e3:.0f} kJ/mol.",
        ]
        if slope < 0 and last["slower_by"] > 1:
            lines += [
                "Densities may be compared with experiments, times and temperatures may not. What the model leaves out acts in",
                "this way: grains grow in the last stage, the powder has agglomerates and a spread of sizes, and surface",
                "diffusion coarsens it on heating."
            ]
    return "\n".join(lines) + "\n"


def read_measured(path):
    table = Table(path)
    return dict(zip(table.texts("firing"), table.values("relative_density").tolist()))


def read_schedule(path):
    found = re.search(r'^schedule *= *"([^"]*)"', path.read_text(encoding="utf-8"), re.MULTILINE)
    if not found:
        raise SystemExit(f"fired.py: {path}: has no schedule")
    return found[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=pathlib.Path, help="folder with FIRING/{fired.kiln,density.json,history.jsonl}")
    parser.add_argument("--firings", nargs="+", type=pathlib.Path, required=True, help="case files with the schedules")
    parser.add_argument("--measured", required=True, help="table of measured densities")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, help="text to write; also as .json")
    given = parser.parse_args()
    warn.name = "fired.py"
    try:
        result = compare(given.run, {path.stem: read_schedule(path) for path in given.firings}, read_measured(given.measured))
    except (ScheduleError, ConvertError) as error:
        raise SystemExit(f"fired.py: {error}") from None
    given.output.with_suffix(".json").write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    given.output.write_text(as_text(result), encoding="utf-8")


if __name__ == "__main__":
    main()
