"""with_material.py: a body with another material: the states of a stream, all of their particles of the material of a JSON file."""
import argparse
import json
import sys

import kiln


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("material", help="JSON of a material, as analyze kinetics --save-material writes it")
    parser.add_argument("state", help="stream of states with one material")
    parser.add_argument("-o", "--output", required=True, help="stream to write")
    given = parser.parse_args()
    with open(given.material, encoding="utf-8") as stream:
        material = json.load(stream)
    states = kiln.read(given.state)
    for state in states:
        if len(state.get("materials", [])) > 1:
            sys.exit(f"with_material.py: {given.state}: has several materials")
        state["materials"] = [material]
    kiln.write(given.output, states)


if __name__ == "__main__":
    main()
