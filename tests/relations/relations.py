"""relations.py: what must hold whatever the input, tried through the whole programs over random packings and options.

Each relation is a function of a trial in of_*.py; its docstring says what holds and how exactly, and why not more so.
"""
import argparse
import os
import shutil
import sys
import time
import traceback

import of_analyze
import of_bend
import of_bondify
import of_green
import of_sinter
import of_streams
from trial import ROOT, Broken, Trial

RELATIONS = {}
for module in (of_green, of_sinter, of_streams, of_bondify, of_analyze, of_bend):
    for name, function in vars(module).items():
        if callable(function) and function.__module__ == module.__name__ and not name.startswith("_"):
            RELATIONS[name] = function


def tried(name, seed, keep):
    """Whether the relation holds in the trial of this seed; if not, says so and leaves the files."""
    folder = os.path.join(keep, f"{name}-{seed}")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    trial = Trial(name, seed, folder)
    try:
        RELATIONS[name](trial)
    except Exception as error:  # a defect of this script is to be seen as one, but the other trials go on
        said = str(error) if isinstance(error, Broken) else traceback.format_exc()
        with open(os.path.join(folder, "commands.sh"), "w", encoding="utf-8") as file:
            file.write("\n".join(trial.commands) + "\n")
        print(f"FAILED {name}: {said}\n    again: tests/relations/relations.py --only {name} --trials 1 --seed {seed}"
              f"\n    files: {folder}", flush=True)
        return False
    shutil.rmtree(folder)
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--trials", type=int, default=5, metavar="N", help="trials of each relation (5)")
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="seed of the first trial; then S + 1, ... (1)")
    parser.add_argument("--only", action="append", metavar="NAME",
                        help="only relations whose names begin so; may be given several times")
    parser.add_argument("--keep", default=os.path.join(ROOT, "build", "relations"), metavar="FOLDER",
                        help="where the files of what failed stay (build/relations)")
    parser.add_argument("--list", action="store_true", help="print the relations and what they say, and end")
    parser.add_argument("--times", action="store_true", help="print how long the trials of each relation took")
    options = parser.parse_args()
    chosen = [name for name in RELATIONS if name.startswith(tuple(options.only or [""]))]
    for begin in options.only or []:
        if not any(name.startswith(begin) for name in RELATIONS):
            parser.error(f"no relation is called {begin}; --list names them")
    if options.list:
        for name in chosen:
            print(f"{name}: {' '.join(RELATIONS[name].__doc__.split())}")
        return 0
    passed = failed = 0
    for name in chosen:
        start = time.monotonic()
        for seed in range(options.seed, options.seed + options.trials):
            if tried(name, seed, os.path.abspath(options.keep)):
                passed += 1
            else:
                failed += 1
        if options.times:
            print(f"{name}: {(time.monotonic() - start) / options.trials:.2f} s a trial", flush=True)
    print(f"{passed} passed, {failed} failed")
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
