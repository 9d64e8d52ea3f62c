"""kinetics.py: what workflows/kinetics found, as text: energies without a model, constants and deviations with one, and bands."""
import argparse

import kiln

KILO = 1e3


def energies(result):
    """Lines on the activation energy without a model."""
    free = result["model_free"]
    if free is None:
        return ["The curves pass no density twice: no activation energy without a model."]
    lines, master = free["iso_density"], free["master_curve"]
    error = "" if master["standard_error"] is None else f" +- {master['standard_error'] / KILO:.0f}"
    return [
        f"Activation energy without a model, kJ/mol: {lines['activation_energy'] / KILO:.0f} at constant density "
        f"(standard deviation of {len(lines['densities'])} densities {(lines['standard_deviation'] or 0.0) / KILO:.0f}), "
        f"{master['activation_energy'] / KILO:.0f}{error} from the narrowest master curve (jackknife over "
        f"{master['jackknife_over']}; {master['width']:.3f} rms of ln Theta)."
    ]


def largest(curves, held_out, of_runs):
    """The largest deviation of the fitted or the held-out curves, of the fit or of the runs; nothing if there is none."""
    chosen = [curve for curve in curves if curve["held_out"] == held_out and (not of_runs or "run" in curve)]
    found = [curve["run"] if of_runs else curve for curve in chosen]
    return max((each["max"] for each in found if "max" in each), default=None)


def shift(curves):
    """How far the densities moved at most since the runs."""
    return max((curve["run"]["shift"] for curve in curves if "run" in curve), default=None)


def number(value, width, digits):
    return "-".rjust(width) if value is None else f"{value:{width}.{digits}f}"


def body_lines(result):
    """A line for each body: constants, and deviations of its own runs."""
    head = (f"{'body':<28}{'Q, kJ/mol':>11}{'+-':>6}{'delta D_0, m3/s':>17}{'surface, m3/s':>15}"
            f"{'fitted':>9}{'held out':>10}{'since runs':>12}")
    lines = [head]
    for body in result["bodies"]:
        constants, errors, curves = body["constants"], body["standard_errors"], body["curves"]
        with_runs = largest(curves, False, True) is not None
        surface = constants.get("surface_diffusion")
        lines.append(f"{body['label']:<28}{constants['activation_energy'] / KILO:11.0f}"
                     f"{number(errors and errors['activation_energy'] / KILO, 6, 0)}{constants['prefactor']:17.3g}"
                     f"{format(surface['prefactor'], '15.3g') if surface else '-'.rjust(15)}"
                     f"{number(largest(curves, False, with_runs), 9, 4)}{number(largest(curves, True, with_runs), 10, 4)}"
                     f"{number(shift(curves), 12, 5)}")
    return lines


def band_width(result, held_out):
    """The widest place of the band of the curves that are held out, or fitted."""
    names = {curve["name"] for curve in result["curves"] if curve["held_out"] == held_out}
    return max((high - low for band in result["band"] if band["name"] in names
                for low, high in zip(band["minimum"], band["maximum"])), default=0.0)


def held_out_rows(result):
    """The held-out curve beside what was measured: temperature, measured, first body, lowest and highest body."""
    lines = []
    for measured in result["curves"]:
        if not measured["held_out"] or measured["relative_density"] is None:
            continue
        predicted = [next(curve for curve in body["curves"] if curve["name"] == measured["name"]) for body in result["bodies"]]
        lines += ["", f"{measured['name']}, not fitted: runs at the constants found",
                  f"{'temperature, C':>15}{'measured':>10}{'first body':>12}{'lowest':>9}{'highest':>9}"]
        for row, kelvin in enumerate(measured["temperature"]):
            values = [curve.get("run", curve)["relative_density"][row] for curve in predicted]
            lines.append(f"{kelvin - 273.15:15.0f}{measured['relative_density'][row]:10.4f}{values[0]:12.4f}{min(values):9.4f}"
                         f"{max(values):9.4f}")
    return lines


def label(body, prefix):
    """The folder of a body out of the name of its first history."""
    return body["name"].removeprefix(prefix).split("/")[0] if body["name"].startswith(prefix) else body["name"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", nargs="+", help="results of analyze kinetics, TITLE=FOLDER/=FILE each")
    parser.add_argument("-o", "--output", required=True, help="text to write")
    given = parser.parse_args()
    text = []
    for place, entry in enumerate(given.results):
        title, prefix, path = entry.split("=")
        result = kiln.read(path)[0]
        for body in result["bodies"]:
            body["label"] = label(body, prefix)
        if place == 0:
            text += energies(result)
        text += ["", title, *body_lines(result), *held_out_rows(result), "",
                 f"Widest place of the band between the bodies: {band_width(result, False):.4f} fitted, "
                 f"{band_width(result, True):.4f} held out."]
        text += [f"{body['label']}: {warning}" for body in result["bodies"] for warning in body["warnings"]]
    text += ["", "Deviations are the largest of measured less simulated density; where runs were made at the constants found they",
             "are those of the runs, and 'since runs' is how far the last fit moved the densities after them.",
             "A good fit of densities alone is no evidence for coarsening: see docs/kinetics.md."]
    with open(given.output, "w", encoding="utf-8") as stream:
        stream.write("\n".join(text) + "\n")


if __name__ == "__main__":
    main()
