"""ensemble.py: means of every number over the packings of an ensemble, with 95 % confidence intervals, as text, CSV and JSON.

Means and intervals are those of `analyze mean`: mean +- t s/sqrt(n), s the standard deviation of the n packings and t of Student's
distribution with n - 1 degrees of freedom."""
import argparse
import csv
import json
import pathlib

import kiln

CONFIDENCE = 0.95
NUMBERS = (  # heading, unit, factor, file, and how the number is read from it
    ("relative density", "", 1.0, "density", lambda result: result["relative_density"]),
    ("coordination number", "", 1.0, "density", lambda result: result["coordination_number"]),
    ("mean overlap h/2R", "", 1.0, "density", lambda result: result["mean_overlap_ratio"]),
    ("bonds per particle", "", 1.0, "bonds", lambda result: result["count"] / result["particles"]),
    ("mean bond diameter", "nm", 1e9, "bonds", lambda result: result["mean_diameter"]),
    ("mean bond length", "nm", 1e9, "bonds", lambda result: result["mean_length"]),
    ("bond share of solid", "", 1.0, "bonds", lambda result: result["bond_volume_fraction"]),
    ("Young's modulus", "GPa", 1e-9, "modulus", lambda result: result["young_modulus"]),
)


def means(analyze, documents):
    """What `analyze mean` says of documents that have the same numbers."""
    return kiln.run([analyze, "mean"], given=[{"format": "dem-ensemble", "version": 1, **each} for each in documents])[0]


def entry(case, name, unit, said):
    """Mean, standard deviation and interval; the last two are null for a single packing."""
    interval = said["interval"][name] or (None, None)
    return {
        "case": case,
        "quantity": name,
        "unit": unit,
        "packings": said["documents"],
        "mean": said["mean"][name],
        "standard_deviation": said["standard_deviation"][name],
        "lower": interval[0],
        "upper": interval[1]
    }


def entries(run, packings, temperatures, analyze):
    table = []
    for temperature in temperatures:
        results = [{kind: kiln.read(run / packing / temperature / f"{kind}.json")[0] for kind in ("density", "bonds", "modulus")}
                   for packing in packings]
        said = means(analyze,
                     [{name: factor * number(each[kind]) for name, _, factor, kind, number in NUMBERS} for each in results])
        table.extend(entry(temperature, name, unit, said) for name, unit, *_ in NUMBERS)
    fits = [kiln.read(run / packing / "fit.json")[0] for packing in packings]
    names = {name: (1e-9, "GPa") if name == "E0" else (1.0, "") for name in fits[0]["standard_errors"]}
    said = means(analyze, [{name: factor * fit[name] for name, (factor, _) in names.items()} for fit in fits])
    table.extend(entry(f"fit, {fits[0]['law']}", name, unit, said) for name, (_, unit) in names.items())
    return table


def as_text(table, packings, material):
    of = material or "a material that is not named"
    lines = [f"Means of {packings} packings of {of} with their {100 * CONFIDENCE:.0f} % confidence intervals (Student's t)"]
    for case in dict.fromkeys(each["case"] for each in table):
        lines += ["", f"{case:26}{'mean':>12}{'interval':>27}{'deviation':>12}"]
        for each in table:
            if each["case"] != case:
                continue
            name = each["quantity"] + (f", {each['unit']}" if each["unit"] else "")
            interval = "-" if each["lower"] is None else f"{each['lower']:.5g} … {each['upper']:.5g}"
            deviation = "-" if each["standard_deviation"] is None else f"{each['standard_deviation']:.3g}"
            lines.append(f"  {name:24}{each['mean']:12.5g}{interval:>27}{deviation:>12}")
    return "\n".join(lines) + "\n"


def warnings_text(run, packings):
    """What the fits, and so the tests of all packings, warn of, each sentence once."""
    sentences = dict.fromkeys(sentence for packing in packings for sentence in kiln.read(run / packing / "fit.json")[0]["warnings"])
    return "".join(f"\nWarning: {sentence}\n" for sentence in sentences)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run",
                        type=pathlib.Path,
                        help="folder with PACKING/TEMPERATURE/{density,bonds,modulus}.json and PACKING/fit.json")
    parser.add_argument("--packings", nargs="+", required=True)
    parser.add_argument("--temperatures", nargs="+", required=True)
    parser.add_argument("--analyze", default="analyze", help="the program that takes the means")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, help="table to write; also as .csv and .json")
    given = parser.parse_args()
    table = entries(given.run, given.packings, given.temperatures, given.analyze)
    given.output.with_suffix(".json").write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")
    with open(given.output.with_suffix(".csv"), "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, table[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    material = kiln.read(given.run / given.packings[0] / given.temperatures[0] / "density.json")[0]["material"]
    text = as_text(table, len(given.packings), material) + warnings_text(given.run, given.packings)
    given.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
