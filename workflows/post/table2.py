"""table2.py: Table 2 of Dosta et al. 2017 beside a run, with the deviation of each number, as text, CSV and JSON."""
import argparse
import csv
import json
import pathlib

import kiln

PARTICLES = 99_000  # of the paper; counts are scaled to as many
DENSITIES = (0.67, 0.71, 0.79, 0.88)
ROWS = (  # what it is, unit, decimals, the paper's numbers
    ("Average diameter", "nm", 2, (57.2, 56.89, 56.26, 55.56)),
    ("Average length", "nm", 2, (23.9, 24.5, 25.46, 26.51)),
    ("Bonds number", "-", 0, (270514, 288655, 321888, 353318)),
)


def run_values(bonds):
    """The three numbers of one state in the paper's units, from a result of `analyze bonds`."""
    return bonds["mean_diameter"] * 1e9, bonds["mean_length"] * 1e9, bonds["count"] * PARTICLES / bonds["particles"]


def entries(results):
    """One dictionary for each of the twelve numbers."""
    columns = [run_values(bonds) for bonds in results]
    return [
        {"quantity": name, "unit": unit, "decimals": decimals, "relative_density": density, "run": column[row],
         "paper": paper, "deviation": column[row] / paper - 1}
        for row, (name, unit, decimals, published) in enumerate(ROWS)
        for density, column, paper in zip(DENSITIES, columns, published)
    ]


def as_text(table, particles):
    """The table for people, 72 columns wide."""
    lines = [f"Table 2 of Dosta et al. 2017 beside this run of {particles:,} particles (bonds scaled to {PARTICLES:,})", ""]
    lines.append(f"{'relative density':32}" + "".join(f"{density:10.2f}" for density in DENSITIES))
    for name, unit, decimals, _ in ROWS:
        row = [entry for entry in table if entry["quantity"] == name]
        title = name if unit == "-" else f"{name}, {unit}"
        for key, label in (("run", "this run"), ("paper", "paper")):
            values = "".join(f"{entry[key]:10,.{decimals}f}" for entry in row)
            lines.append(f"{title if key == 'run' else '':22}{label:10}" + values)
        lines.append(f"{'':22}{'deviation':10}" + "".join(f"{100 * entry['deviation']:+8.2f} %" for entry in row))
    worst = max(abs(entry["deviation"]) for entry in table)
    lines += ["", f"Largest deviation of the {len(table)} numbers: {100 * worst:.2f} %"]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", nargs=len(DENSITIES), help="results of analyze bonds, in the order of the densities")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, help="table to write; also as .csv and .json")
    given = parser.parse_args()
    results = [kiln.read(path)[0] for path in given.results]
    table = entries(results)
    text = as_text(table, results[0]["particles"])
    given.output.with_suffix(".json").write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")
    with open(given.output.with_suffix(".csv"), "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, table[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    given.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
