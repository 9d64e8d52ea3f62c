"""keys.py: the keys that the programs write are those that their --help explains, in both directions, and jq can say them.

A help explains keys in paragraphs that begin with "Keys of": a line of two blanks, keys with commas between them, then what they
are; keys of objects in them stand in braces, {mean, minimum}. Prints what differs; status 1 if anything does. Runs in an empty
folder with the programs of SINTER, BONDIFY, BEND and ANALYZE, or by their names."""
import json
import os
import re
import subprocess
import sys

PROGRAMS = {name: os.environ.get(name.upper(), name) for name in ("sinter", "bondify", "bend", "analyze")}
WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
# dem-state(5) explains these, in every document.
COMMON = {"format", "version", "units", "history"}
# Objects whose keys are names of other things: constants of materials, arrays, numbers of other documents.
FOREIGN = {"material", "materials", "arrays", "last_step", "box", "value", "missing", "correlation"}
# Explained keys that need runs with coarsening, of minutes: tests/cli/kinetics.bats has them.
UNSAMPLED = {"analyze kinetics": {"grain_sizes", "run", "surface_diffusion"}}

# Commands of the samples; the first word names the program whose help is meant, "> FILE" keeps the output.
SETUP = r"""
sinter green -q -n 250 --density 0.5 --aspect 6:1:1 --distribution lognormal:100nm:1.2 --material alumina-dihedral -o green.kiln
sinter -q --temperature 1200C --to-density 0.6,0.7 --report viscosity --history plain.jsonl -o sintered.kiln green.kiln
sinter -q --temperature 1200C --coarsening surface,boundary --to-density 0.55 --history coarse.jsonl -o coarse.kiln green.kiln
sinter --method explicit --mass-scaling 1e22 --material alumina --temperature 1200C --to-density 0.51 -o explicit.kiln green.kiln
bondify -q -o bonded.kiln sintered.kiln
bondify -q --method necks -o necks.kiln sintered.kiln
bend -q --cycles 1 --states bent.kiln -o bend.json bonded.kiln
bend -q --tensile-strength 500MPa -o broken.json bonded.kiln
analyze select -q --index 2 --text -o one.jsonl bonded.kiln
analyze modulus -q -o modulus.json bend.json
"""
TABLES = {
    "bar7.csv": "deflection (mm),force (N)\n0,0\n0.01,-20\n0.02,-40\n0.03,-60\n0.025,-50\n0.02,-40\n0.015,-30\n0.01,-20\n",
    "broken.csv": "deflection (mm),force (N)\n0,0\n0.01,20\n0.02,40\n0.03,60\n0.03,1\n",
    "strengths.csv": "strength (MPa)\n310\n352\n371\n388\n402\n431\n",
    "measured.csv": "relative_density,young_modulus (GPa)\n0.60,80\n0.65,98\n0.70,121\n0.79,180\n0.88,262\n",
    "rates.csv": "temperature (C),5 K/min,20 K/min\n1000,0.510,0.505\n1050,0.530,0.520\n1100,0.570,0.550\n1150,0.64,0.61\n",
    "spheres.csv": "x (um),y (um),z (um),diameter (um)\n1,5,5,2\n2.9,5,5,2\n5,5,5,3\n",
}
SIZE = "--span 40mm --width 4mm --height 3mm"
SAMPLES = {  # program and subcommand: commands whose documents are looked at
    "sinter": ["cat plain.jsonl", "cat coarse.jsonl", "summary explicit.kiln", "summary sintered.kiln", "summary coarse.kiln"],
    "sinter green": ["summary green.kiln", "sinter green -q --spheres spheres.csv --box 10um:10um:10um --text | summary -"],
    "bondify": ["summary bonded.kiln", "summary necks.kiln"],
    "bend": ["cat bend.json", "cat broken.json", "bend -q --method dynamic --cycles 1 --mass-scaling 100 one.jsonl"],
    "analyze info": ["analyze info bonded.kiln bend.json coarse.kiln"],
    "analyze density": ["analyze density --bins 3 --correlation coarse.kiln", "analyze density --measure envelope bent.kiln"],
    "analyze bonds": ["analyze bonds bonded.kiln bent.kiln"],
    "analyze modulus": ["cat modulus.json", f"analyze modulus -q {SIZE} bar7.csv"],
    "analyze strength": [f"analyze strength -q {SIZE} broken.csv", "analyze strength -q strengths.csv",
                         "analyze strength -q broken.json"],
    "analyze elastic": ["analyze elastic bonded.kiln", "analyze elastic --model voxel --voxels 2,3 one.jsonl"],
    "analyze conductivity": ["analyze conductivity --conductivity 30W/m/K necks.kiln",
                             "analyze conductivity --conductivity 30W/m/K --model voxel --voxels 2,3 one.jsonl"],
    "analyze fit": ["analyze fit -q --material alumina --law all --data measured.csv measured.csv",
                    "analyze fit -q --weights equal modulus.json"],
    "analyze mean": ["analyze mean modulus.json"],
    "analyze kinetics": ["analyze kinetics -q --curve rates.csv sintered.kiln plain.jsonl"],
    "analyze materials": ["analyze materials alumina"],
}
# Objects of a result whose keys are names: numbers of other documents, parameters of laws, constants of materials.
NAMED = {"analyze mean": {"mean", "standard_deviation", "standard_error", "interval"},
         "analyze fit": {"standard_errors", "confidence_intervals"}, "analyze materials": {"constants"}}


def shell(command):
    """What a command line writes; `summary FILE` gives the summaries of the last step of each state."""
    for name, path in PROGRAMS.items():
        command = re.sub(rf"(^|\| ){name} ", rf"\1'{path}' ", command)
    command = re.sub(r"summary (\S+)", rf"'{PROGRAMS['analyze']}' info \1 | jq -c .last_step.summary", command)
    done = subprocess.run(["bash", "-o", "pipefail", "-c", command], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise SystemExit(f"keys.py: '{command}' failed: {done.stderr}")
    return done.stdout


def written_keys(value, named, found):
    """Adds all keys of a document, those of its objects too; named: keys of objects whose own keys are names of something."""
    if isinstance(value, dict):
        for key, inner in value.items():
            found.add(key)
            if key in named and isinstance(inner, dict):
                written_keys(list(inner.values()), named, found)
            elif key not in FOREIGN and key != "history":
                written_keys(inner, named, found)
    elif isinstance(value, list):
        for inner in value:
            written_keys(inner, named, found)


def without_brackets(text):
    """The text without what stands in round brackets, units and remarks."""
    while True:
        shorter = re.sub(r" ?\([^()]*\)", "", text)
        if shorter == text:
            return text
        text = shorter


def documented_keys(text):
    """The keys that a help explains."""
    found = set()
    for paragraph in re.findall(r"^Keys of[^\n]*\n(.*?)(?:\n\n|\Z)", text, re.DOTALL | re.MULTILINE):
        paragraph = without_brackets(paragraph)
        for entry in re.findall(r"^  (\w+(?:, \w+)*)(?=$|  | \{|  \{)", paragraph, re.MULTILINE):
            found.update(entry.split(", "))
        for braces in re.findall(r"\{([^{}]*)\}", paragraph):
            found.update(word.strip() for word in braces.split(",") if WORD.fullmatch(word.strip()))
    return found


def sayable(key):
    """Whether jq takes .key; it reads .E0 as a number, so fits have dense_modulus too."""
    return bool(WORD.fullmatch(key)) and (key == "E0" or not re.fullmatch(r"[eE]\d+", key))


def main():
    for name, text in TABLES.items():
        with open(name, "w", encoding="utf-8") as file:
            file.write(text)
    for command in SETUP.strip().splitlines():
        shell(command)
    faults = []
    for name, commands in SAMPLES.items():
        program, *subcommand = name.split()
        help_text = subprocess.run([PROGRAMS[program], *subcommand, "--help"], capture_output=True, text=True, check=True).stdout
        documented, written = documented_keys(help_text), set()
        for command in commands:
            for line in shell(command).splitlines():
                written_keys(json.loads(line), NAMED.get(name, set()), written)
        faults += [f"{name} writes {key}, and its help does not explain it" for key in sorted(written - documented - COMMON)]
        unwritten = documented - written - COMMON - UNSAMPLED.get(name, set())
        faults += [f"{name} --help explains {key}, which is not written" for key in sorted(unwritten)]
        faults += [f"{name} writes '{key}', which jq cannot say" for key in sorted(written) if not sayable(key)]
    print("\n".join(faults) or f"{len(SAMPLES)} helps explain what is written")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
