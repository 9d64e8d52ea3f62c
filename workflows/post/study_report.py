"""study_report.py: one page of HTML that shows a study: the states to turn, figures, a table a case, what was measured, what the
programs said, every command, links to the files. Beside it the same as Markdown, report.md."""
import argparse
import html
import json
import pathlib
import sys

import dem_view
import kiln
import report
from convert_common import ConvertError
from figure_study import BEYOND
from study_results import calibration_line, case_rows, comparison_lines

TITLES = {
    "densification": ("Densification", "Every line is a packing. The rate is that of the relative density."),
    "structure": ("Structure", "Contacts a particle, and the diameter of the necks over that of the particles; means over the "
                  "packings with 95 % intervals. Necks are widened until they hold the mass that the overlaps have twice."),
    "modulus": ("Young's modulus", "Of the periodic cell, mean over the packings with 95 % interval, and of bars in bending where "
                "they were tested. What the unknown shape of a neck makes is not in the intervals."),
    "conductivity": ("Conductivity", "Through the same necks, with the bound that no isotropic body passes."),
    "comparison": ("The cases compared", "The last state of each case, mean over its packings with 95 % interval."),
}


def picture(path, name):
    title, caption = TITLES[name]
    wide = ' class="wide"' if name in ("densification", "comparison") else ""
    return (f'<figure{wide}><h3>{title}</h3><img src="{report.picture(path)}" data-picture="{name}" '
            f'alt="{html.escape(title)}"><figcaption>{html.escape(caption)}</figcaption></figure>')


def view(run, study, size):
    """The states of the first body that has some, to turn; nothing where three.js is not there."""
    for case in study["cases"]:
        for name in case["bodies"]:
            paths = [run / name / part for part in ("green.kiln", "bonded.kiln")]
            if not all(path.is_file() and path.stat().st_size for path in paths):
                continue
            try:
                scene = dem_view.Scene(dem_view.read_states(map(str, paths)))
                left = scene.fit(size)
                shown = dem_view.fragment(scene)
            except (ConvertError, OSError) as error:
                print(f"study: warning: the page has no states to turn, {error}", file=sys.stderr)
                return ""
            note = f"{name}: the green body, then the necks at each state." + (f" The page holds {left}." if left else "")
            return f'<h2>The packing</h2>{shown}<p class="note">{html.escape(note)}</p>'
    return ""


def dense(case):
    return any(row["relative_density"]["mean"] > BEYOND for row in case["states"])


def notes(case):
    """Sentences on a case, plain text."""
    lines = [line.strip() for line in comparison_lines(case)]
    if dense(case):
        lines.append(f"States above a relative density of {BEYOND} lie beyond the model: pores are closed there and grains grow.")
    return lines


def case_section(case, alone):
    title = "" if alone else f"<h3>{html.escape(case['name'])}</h3>"
    if not case["states"]:
        return title + "<p>Nothing came of this case; what the programs said is below.</p>"
    head, rows = case_rows(case)
    body = report.table(map(html.escape, head), [("", map(html.escape, row)) for row in rows])
    return title + body + "".join(f'<p class="note">{html.escape(line)}</p>' for line in notes(case))


def remarks(study):
    items = "".join(f"<li>{'<b>failed:</b> ' if each['kind'] == 'failed' else ''}{html.escape(each['sentence'])} "
                    f"<span class=\"note\">({html.escape(', '.join(each['bodies']))})</span></li>" for each in study["remarks"])
    return f"<h2>What the programs said</h2><ul>{items}</ul>" if items else ""


def strengths(study):
    found = study["measured"].get("strengths")
    if not found:
        return ""
    words = f"{found['bars']} bars, mean {found['mean_strength'] / 1e6:.4g} MPa"
    if found.get("weibull_modulus"):
        words += f", Weibull modulus {found['weibull_modulus']:.3g}, characteristic strength " \
                 f"{found['characteristic_strength'] / 1e6:.4g} MPa"
    return words


def histories(run, study):
    for case in study["cases"]:
        for name in case["bodies"]:
            path = run / name / "elastic.json"
            source = run / name / "bonded.kiln"
            if path.is_file() and source.is_file() and source.stat().st_size:
                yield next(iter(kiln.documents(source))).get("history", [])


def page(run, study):
    figures = {name: run / "figures" / f"{name}.svg" for name in TITLES}
    pictures = "".join(picture(path, name) for name, path in figures.items() if path.is_file())
    several = len(study["cases"]) > 1
    facts = (("particles a packing", f"{study['particles']:,}"), ("packings a case", len(study["seeds"])),
             ("cases", len(study["cases"])), ("cases without a result", sum(1 for case in study["cases"] if not case["states"])))
    boxes = "".join(f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in facts)
    sections = "".join(case_section(case, not several) for case in study["cases"])
    measured = f"<p>Measured strengths: {html.escape(strengths(study))}.</p>" if strengths(study) else ""
    if study["calibration"]:
        measured = f"<p>{html.escape(calibration_line(study['calibration']))}.</p>" + measured
    commands = report.provenance(list(histories(run, study)))[0]
    turned = view(run, study, report.PAGE_SIZE - len(pictures) - report.REST_SIZE)
    interval = "" if len(study["seeds"]) > 1 else " One packing has no interval."
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{html.escape(study['title'])}</title><style>{report.STYLE}</style></head><body>
<h1>{html.escape(study['title'])}</h1>
<dl class="facts">{boxes}</dl>
{turned}
<h2>Figures</h2><div class="figures">{pictures}</div>
<h2>Numbers</h2><p>Means over the packings of a case, ± half of the 95 % interval.{interval} A column for each state, named for the
relative density that was asked for, or "end".</p>{sections}{measured}
{remarks(study)}
<h2>How it was made</h2>{commands}
<section class="files"><h2>Files</h2><details><summary>all of them</summary>{report.files(run)}</details></section>
</body></html>
"""


def markdown(run, study):
    lines = [f"# {study['title']}", "", f"{study['particles']:,} particles a packing, {len(study['seeds'])} packings a case, "
             f"{len(study['cases'])} case{'s' if len(study['cases']) > 1 else ''}."]
    for name, (title, caption) in TITLES.items():
        if (run / "figures" / f"{name}.svg").is_file():
            lines += ["", f"## {title}", "", f"![{title}](figures/{name}.svg)", "", caption]
    lines += ["", "## Numbers", "", "Means over the packings of a case, ± half of the 95 % interval."]
    for case in study["cases"]:
        if len(study["cases"]) > 1:
            lines += ["", f"### {case['name']}"]
        if not case["states"]:
            lines += ["", "Nothing came of this case."]
            continue
        head, rows = case_rows(case)
        lines += ["", "| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(row) + " |" for row in rows)]
        lines += [text for note in notes(case) for text in ("", note)]
    if study["calibration"]:
        lines += ["", calibration_line(study["calibration"]) + "."]
    if strengths(study):
        lines += ["", f"Measured strengths: {strengths(study)}."]
    if study["remarks"]:
        lines += ["", "## What the programs said", ""]
        lines += [f"- {'**failed:** ' if each['kind'] == 'failed' else ''}{each['sentence']} ({', '.join(each['bodies'])})"
                  for each in study["remarks"]]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=pathlib.Path, help="folder of a study, figures included")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, help="page to write")
    given = parser.parse_args()
    study = json.loads((given.run / "study.json").read_text(encoding="utf-8"))
    (given.run / "report.md").write_text(markdown(given.run, study), encoding="utf-8")
    partial = given.output.with_suffix(".partial")
    partial.write_text(page(given.run, study), encoding="utf-8")
    partial.replace(given.output)


if __name__ == "__main__":
    main()
