"""report.py: one page of HTML that shows a run: figures, tables beside the paper's, every command, links to the files."""
import argparse
import base64
import html
import json
import pathlib
import shlex
import sys

import dem_view
import style
import kiln
from convert_common import ConvertError
from figure_modulus import SHAPE, tests_of
from style import GPA

FIGURES = (
    ("states", "The packing before and after",
     "Shaded spheres, at one scale; what sticks out of one face of the periodic box is missing at the other."),
    ("density", "Densification",
     "Relative density against time, with the picked states (Fig. 2 of the paper)."),
    ("bonds", "Bonds", "Distribution of the bond radii at each density (Fig. 4)."),
    ("bend", "Bending", "A slice of the bent bar: every line is a bond, coloured by the force along it (Fig. 5)."),
    ("modulus", "Young's modulus",
     "Moduli with necks of the sintering law and with the paper's bonds, and the literature's curves where they are of the body's "
     "material (Fig. 6). The band of the necks is what their unknown shape makes."),
)
PAGE_SIZE, REST_SIZE = 15_000_000, 1_300_000  # bytes of the page, and of what is neither picture nor state in it: mostly three.js
KINDS = {".png": "image/png", ".svg": "image/svg+xml"}

STYLE = """
:root { --ink: #1c2733; --soft: #5b6b7a; --line: #d5dde4; --accent: #0072b2; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 62rem; padding: 2rem 1.5rem 4rem; color: var(--ink); 
       font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; }
h1 { margin: 0 0 .3rem; font-size: 1.9rem; line-height: 1.2; }
h2 { margin: 2.6rem 0 .8rem; padding-bottom: .3rem; border-bottom: 2px solid var(--line); font-size: 1.25rem; }
p.lead, figcaption, td.soft, p.note { color: var(--soft); }
dl.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(9rem, 1fr)); gap: .8rem; margin: 1.4rem 0 0; }
dl.facts div { padding: .7rem .9rem; border: 1px solid var(--line); border-radius: .4rem; }
dt { color: var(--soft); font-size: .8rem; } dd { margin: 0; font-size: 1.15rem; font-weight: 600; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(26rem, 1fr)); gap: 1.8rem 2rem; }
figure { margin: 0; break-inside: avoid; } figure.wide { grid-column: 1 / -1; max-width: 44rem; }
figure img { display: block; width: 100%; height: auto; }
figure h3 { margin: 0 0 .4rem; font-size: 1rem; } figcaption { margin-top: .4rem; font-size: .85rem; }
table { width: 100%; border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .92rem; break-inside: avoid; }
th, td { padding: .35rem .6rem; border-bottom: 1px solid var(--line); text-align: right; } th { font-weight: 600; }
th:first-child, td:first-child { text-align: left; } tr.first td { border-top: 2px solid var(--line); }
pre { margin: .4rem 0; padding: .6rem .8rem; overflow-x: auto; background: #f3f6f8; border-radius: .3rem; white-space: pre-wrap;
      font: .82rem/1.45 "DejaVu Sans Mono", monospace; overflow-wrap: anywhere; }
a { color: var(--accent); }
@media (max-width: 40rem) { .figures { grid-template-columns: 1fr; } }
@media print {
  @page { margin: 15mm; }
  body { max-width: none; padding: 0; font-size: 10pt; }
  h1 { font-size: 16pt; } h2 { margin-top: 1.2rem; break-after: avoid; }
  dl.facts { grid-template-columns: repeat(5, 1fr); }
  .figures { display: block; } figure, figure.wide { display: inline-block; width: 48%; margin: 0 1% 1rem 0; vertical-align: top; }
  figure.wide { display: block; width: 100%; max-width: none; }
  figure.wide img { width: auto; max-width: 100%; max-height: 12.5cm; }
  section.files { display: none; }
}
"""


def cells(values, tag="td"):
    return "".join(f"<{tag}>{value}</{tag}>" for value in values)


def table(head, rows):
    """rows: (class, values)."""
    body = "".join(f'<tr class="{kind}">{cells(values)}</tr>' if kind else f"<tr>{cells(values)}</tr>" for kind, values in rows)
    return f"<table><thead><tr>{cells(head, 'th')}</tr></thead><tbody>{body}</tbody></table>"


def picture(path):
    data = base64.b64encode(path.read_bytes()).decode()
    return f"data:{KINDS[path.suffix]};base64,{data}"


def figures(run, kind):
    """The figures by name, as HTML."""
    parts = {}
    for name, title, caption in FIGURES:
        path = run / "figures" / f"{name}{kind}"
        wide = ' class="wide"' if name in ("states", "bend") else ""
        said = html.escape(caption)
        parts[name] = (f'<figure{wide}><h3>{title}</h3><img src="{picture(path)}" data-picture="{name}" '
                       f'alt="{html.escape(title)}: {said}"><figcaption>{said}</figcaption></figure>')
    return parts


def density_plot(run, densities):
    """Densification as a plot of dem_view.js: every step of sintering, and those at the densities of the cases marked."""

    def look(chosen, **more):
        text = [f"{step['time']:.4g} s, {step['temperature'] - 273.15:.0f} \u00b0C\n"
                f"relative density {step['relative_density']:.3f}\n"
                f"coordination number {step['coordination_number']:.2f}" for step in chosen]
        x, y = [step["time"] for step in chosen], [step["relative_density"] for step in chosen]
        return {"x": x, "y": y, "text": text, **more}

    steps = kiln.read(run / "history.jsonl")
    picks = [min(steps, key=lambda step: abs(step["relative_density"] - density)) for density in densities]
    return {
        "picture": "density",
        "x": "Time, s",
        "y": "Relative density",
        "height": 330,
        "series": [look(steps, line=True, colour=style.LINE), look(picks, points=True, colour=style.ACCENT)]
    }


def curve(name, density, modulus, **look):
    """A line of moduli, Pa, over relative densities."""
    modulus = [None if value is None else value / GPA for value in modulus]
    text = [f"{name}\nrelative density {x:.3f}\n{y or 0:.1f} GPa" for x, y in zip(density, modulus)]
    return {"name": name, "x": density, "y": modulus, "text": text, **look}


def modulus_plot(fits):
    """Moduli as a plot of dem_view.js; fits: (what lies between the particles, result of analyze fit)."""
    band = fits[0][1]["band"]["relative_density"]
    series = [curve(each["name"], band, each["young_modulus"], line=True, dashes=dashes, colour=style.REFERENCE)
              for each, dashes in zip(fits[0][1].get("references", []), ("8 4", "2 3", "9 3 2 3"))]
    for (name, fit), colour in zip(fits, (style.ACCENT, style.LINE)):
        band, points = fit["band"], fit["points"]
        line = curve(f"fit, {name}", band["relative_density"], band["young_modulus"], line=True, colour=colour)
        if name == "necks":
            for edge, factor in (("low", 1 - SHAPE), ("high", 1 + SHAPE)):
                line[edge] = [factor * value for value in line["y"]]
        series.append(line)
        for test, alike in tests_of(points).items():
            density, modulus = [1 - point["porosity"] for point in alike], [point["young_modulus"] for point in alike]
            series.append(curve(f"{test}, {name}", density, modulus, points=True, colour=colour))
    return {
        "picture": "modulus",
        "x": "Relative density",
        "y": "Young's modulus, GPa",
        "height": 380,
        "low": [None, 0],
        "series": series
    }


def view(run, cases, bent, pictures, plots, size):
    """The packing and its bonds to turn, in place of their picture; the picture alone where three.js or a file is missing.

    size: bytes that it may take; some states and bonds may be left out for it.
    """
    names = ["green.kiln", *(f"{case.name}/necks.kiln" for case in cases), *([f"{bent}/bent.kiln"] if bent else [])]
    try:
        scene = dem_view.Scene(dem_view.read_states(str(run / name) for name in names))
        left = scene.fit(size)
        shown = dem_view.fragment(scene, plots, pictures["states"])
    except (ConvertError, OSError) as error:
        print(f"report.py: warning: pictures only, {error}", file=sys.stderr)
        return pictures["states"]
    bar = f", and the bar at {bent} bent, with the forces in its bonds of Eq. 2\u20134" if bent else ""
    note = f" To keep the page small it holds {left}." if left else ""
    return f'{shown}<p class="note">The green body, the necks at each density{bar}.{note}</p>'


def table2(entries):
    densities = list(dict.fromkeys(entry["relative_density"] for entry in entries))
    rows = []
    for name in dict.fromkeys(entry["quantity"] for entry in entries):
        row = [entry for entry in entries if entry["quantity"] == name]
        title = name if row[0]["unit"] == "-" else f"{name}, {row[0]['unit']}"
        for key in ("run", "paper"):
            rows.append(("first" if key == "run" else "", [
                title if key == "run" else "", "this run" if key == "run" else "paper",
                *(f"{entry[key]:,.{entry['decimals']}f}" for entry in row)
            ]))
        rows.append(("", ["", "deviation", *(f"{100 * entry['deviation']:+.2f} %" for entry in row)]))
    return table(["relative density", "", *(f"{density:.2f}" for density in densities)], rows)


def moduli(tests, fit):
    rows = [("", [
        html.escape(test.get("material") or "–"), f"{test['relative_density']:.3f}", f"{test['young_modulus'] / GPA:.1f}",
        f"{test['slenderness']:.1f}", test["points"],
        html.escape(test.get("bond_law", "–")),
        html.escape(test.get("method", "–"))
    ]) for test in tests]
    errors = fit["standard_errors"]
    numbers = "; ".join(f"{name} = {fit[name] / (GPA if name == 'E0' else 1):.4g}" + (" GPa" if name == "E0" else "") +
                        ("" if error is None else " (not determined)" if name in fit["not_determined"] else
                         f" ± {error / (GPA if name == 'E0' else 1):.2g}")
                        for name, error in errors.items())
    text = (
        f"<p>Law <b>{html.escape(fit['law'])}</b>, E = {html.escape(fit['formula'])} ({html.escape(fit['source'])}): "
        f"{html.escape(numbers)} "
        f"(standard errors), R² = {fit['r_squared']:.4f}, {len(fit['points'])} points.</p>")
    head = ["material", "relative density", "Young's modulus, GPa", "L/h", "points", "bond law", "method"]
    warnings = list(dict.fromkeys(sentence for test in tests for sentence in test["warnings"]))
    return table(head, rows) + text + "".join(f'<p class="note">{html.escape(sentence)}</p>' for sentence in warnings)


def command(entry):
    """A step of the history as it would be typed."""
    words = [*entry["tool"].split(), *map(str, entry.get("arguments", []))]
    if "seed" in entry and "--seed" not in words:
        words += ["--seed", str(entry["seed"])]
    return shlex.join(words)


def provenance(histories):
    """Every different step of all histories, in the order in which they first stand."""
    steps = {}
    for history in histories:
        for entry in history:
            steps.setdefault((command(entry), entry.get("version", "?")), entry)
    versions = sorted({version for _, version in steps})
    lines = "\n".join(text if len(versions) == 1 else f"{text}  # version {version}" for text, version in steps)
    return f"<p>Kiln {html.escape(', '.join(versions))}.</p><pre>{html.escape(lines)}</pre>", list(steps.values())


def files(run):
    rows = []
    for path in sorted(run.rglob("*")):
        name = path.relative_to(run).as_posix()
        if path.is_file() and path.suffix in (".kiln", ".json", ".jsonl", ".csv", ".txt", ".png", ".svg",
                                              ".pdf") and name != "report.html":
            size = path.stat().st_size
            shown = f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{size / 1e3:.1f} kB"
            rows.append(("", [f'<a href="{html.escape(name)}" download>{html.escape(name)}</a>', shown]))
    return table(["file", "size"], rows)


def page(run, kind, bent):
    cases = sorted(path.parent for path in run.glob("*/modulus.json"))
    tests, necks = ([kiln.read(case / name)[0] for case in cases] for name in ("modulus.json", "necks_modulus.json"))
    bonds = [kiln.read(case / "bonds.json")[0] for case in cases]
    fit, necks_fit = (kiln.read(run / name)[0] for name in ("fit.json", "necks_fit.json"))
    entries = json.loads((run / "table2.json").read_text(encoding="utf-8"))
    commands, steps = provenance([test.get("history", []) for test in tests + necks])
    seed = next((step["seed"] for step in steps if "seed" in step), "–")
    worst = max(abs(entry["deviation"]) for entry in entries)
    facts = (("material", html.escape(bonds[0].get("material") or "–")), ("particles", f"{bonds[0]['particles']:,}"),
             ("seed", seed), ("densities", f"{len(cases)}"),
             ("Table 2, worst deviation", f"{100 * worst:.1f} %"),
             ("Young's modulus", f"{necks[0]['young_modulus'] / GPA:.0f} – {necks[-1]['young_modulus'] / GPA:.0f} GPa"))
    pictures = figures(run, kind)
    plots = [
        density_plot(run, [float(case.name) for case in cases]),
        modulus_plot((("necks", necks_fit), ("bonds of Eq. 2\u20134", fit)))
    ]
    turned = view(run, cases, bent, pictures, plots, PAGE_SIZE - sum(map(len, pictures.values())) - REST_SIZE)
    boxes = "".join(f"<div><dt>{html.escape(name)}</dt><dd>{value}</dd></div>" for name, value in facts)
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Stiffness of a sintered ceramic</title><style>{STYLE}</style></head><body>
<h1>Stiffness of a sintered ceramic, from particles</h1>
<p class="lead">A run of Kiln after M. Dosta et al.,
<i>Approximation of mechanical properties of sintered materials with discrete element method</i>, 2017.</p>
<dl class="facts">{boxes}</dl>
<h2>The packing and its bonds</h2>{turned}
<h2>Figures</h2><div class="figures">{"".join(text for name, text in pictures.items() if name != "states")}</div>
<h2>Table 2 of the paper beside this run</h2>{table2(entries)}
<p class="note">Numbers of bonds are scaled to the 99,000 particles of the paper.</p>
<h2>Young's modulus: necks of the sintering law, which fill what the mass fills</h2>{moduli(necks, necks_fit)}
<h2>Young's modulus: bonds of Eq. 2–4 of the paper, which lose volume</h2>{moduli(tests, fit)}
<h2>How it was made</h2><p>Every step that left its mark in the states, with the options that bear on the result:</p>{commands}
<section class="files"><h2>Files</h2>{files(run)}</section>
</body></html>
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=pathlib.Path, help="folder of a run of workflows/paper, figures included")
    parser.add_argument("--figures", choices=tuple(kind[1:] for kind in KINDS), default="png", help="kind of figures to embed")
    parser.add_argument("--bent", help="name of the case whose bent bar is shown")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, help="page to write")
    given = parser.parse_args()
    text = page(given.run, f".{given.figures}", given.bent)
    partial = given.output.with_suffix(".partial")
    partial.write_text(text, encoding="utf-8")
    partial.replace(given.output)


if __name__ == "__main__":
    main()
