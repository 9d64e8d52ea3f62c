"""calibrated.py: constants of diffusion that a few firings give, and what they say of others, as text."""
import argparse
import json


def as_text(result):
    """result: of analyze kinetics, or None where too few firings were measured."""
    if result is None:
        return ""
    body = result["bodies"][0]
    constants = body["constants"]
    lines = [
        "", "Calibrated on the firings marked *, the others foretold", "", f"{'measured':>8}{'model':>8}  firing"
    ]
    for curve, measured in zip(body["curves"], result["curves"]):
        density = measured["relative_density"]
        lines.append(f"{'' if density is None else format(density[0], '8.2f'):>8}{curve['relative_density'][0]:8.3f}"
                     f"{' ' if curve['held_out'] else '*'} {curve['name']}")
    lines += [
        "", f"delta D_0 = {constants['prefactor']:.3g} m3/s, Q = {constants['activation_energy'] / 1e3:.0f} kJ/mol: an apparent "
        f"energy, in which all hides that the model leaves out."
    ]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("result", help="result of analyze kinetics with --firing and --predict")
    parser.add_argument("-o", "--output", required=True, help="text to write")
    given = parser.parse_args()
    with open(given.result, encoding="utf-8") as stream:
        result = json.load(stream)
    with open(given.output, "w", encoding="utf-8") as stream:
        stream.write(as_text(result))


if __name__ == "__main__":
    main()
