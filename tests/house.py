"""house.py: habits of the tree that a program can check: what may use what, lengths of lines, absolute paths."""
import os
import re
import subprocess
import sys

LONGEST_LINE = 132  # characters
# Which parts a part may include, besides itself: those on the floors below it.
GROUND = ["lib/core"]
FIRST = GROUND + ["lib/physics", "lib/linalg", "lib/bonding"]
SECOND = FIRST + ["lib/sintering", "lib/mechanics", "lib/voxel", "lib/analysis", "lib/io"]
LIBRARY = SECOND + ["lib/bending", "lib/packing"]
PETSC = ["lib/petsc", "tools/ranks"]  # compiled with PETSC=1 only, so nobody else may know PETSc or MPI
BELOW = {
    "lib/core": [],
    "lib/physics": GROUND,
    "lib/linalg": GROUND,
    "lib/bonding": GROUND + ["lib/physics"],
    "lib/sintering": FIRST,
    "lib/mechanics": FIRST,
    "lib/voxel": FIRST,
    "lib/analysis": FIRST,
    "lib/io": FIRST,
    "lib/petsc": FIRST + ["lib/mechanics"],
    "lib/bending": SECOND,
    "lib/packing": SECOND,
    "tools/common": LIBRARY,
    "tools/ranks": LIBRARY + ["lib/petsc", "tools/common"],
    "tools/sinter": LIBRARY + ["tools/common"],
    "tools/bondify": LIBRARY + ["tools/common"],
    "tools/bend": LIBRARY + ["tools/common"],
    "tools/analyze": LIBRARY + ["tools/common"],
    "tests/unit": LIBRARY + ["tests/physics"],
    "tests/physics": LIBRARY,
    "bench": LIBRARY,
}
TEXT = (".cpp", ".h", ".py", ".js", ".html", ".bats", ".bash", ".sh", ".mk", ".md", ".5", "Makefile", "Snakefile")
MACHINE_PATH = re.compile(r"(?<![\w.$])/(home|root|work|mnt|srv)/")
BARE_APPROX = re.compile(r"\bApprox\(")  # of doctest: it accepts any two numbers far below one
OF_PETSC = re.compile(r"#include <(petsc|mpi)")
INCLUDE = re.compile(r'#include "([^"]+)"')


def part_of(path):
    """lib/io of lib/io/files.h; nothing for a file elsewhere."""
    first, second = (path.split("/") + [""])[:2]
    part = first if first in BELOW else f"{first}/{second}"
    return part if part in BELOW else None


def included_part(path, name):
    """The part that an included file belongs to; a bare name is a file of the same folder."""
    if "/" not in name:
        return part_of(path)
    return part_of(name) or part_of("lib/" + name)


def faults_of(path):
    """Sentences on one file."""
    with open(path, encoding="utf-8") as file:
        lines = file.read().split("\n")
    for number, line in enumerate(lines, 1):
        # A row of a table cannot be broken, and a filter of jq in a Bats assertion has no good place for it.
        excused = line.startswith("|") or path.endswith(".bats")
        if len(line) > LONGEST_LINE and not excused:
            yield f"{path}:{number}: has {len(line)} characters, more than {LONGEST_LINE}"
        if MACHINE_PATH.search(line) and path != "tests/house.py":
            yield f"{path}:{number}: names a path of some machine"
        if BARE_APPROX.search(line) and path != "tests/physics/relative.h":
            yield f"{path}:{number}: compares by doctest's Approx; relative() of tests/physics/relative.h holds for any size"
        include = INCLUDE.match(line)
        part = part_of(path)
        if OF_PETSC.match(line) and part not in PETSC:
            yield f"{path}:{number}: only {' and '.join(PETSC)} may include {line.split()[1]}"
        if include and part:
            used = included_part(path, include[1])
            if used is None or used != part and used not in BELOW[part]:
                yield f"{path}:{number}: {part} may not include {include[1]}"


def main():
    os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, capture_output=True, check=True, text=True).stdout.split("\n")
    files = [path for path in listed if path.endswith(TEXT) and os.path.exists(path)]
    faults = [fault for path in files for fault in faults_of(path)]
    print("\n".join(faults) or f"{len(files)} files in order")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
