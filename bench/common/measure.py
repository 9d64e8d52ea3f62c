"""measure.py: programs run and measured, and JSON lines, for the scripts of bench."""
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAMS = os.environ.get("PROGRAMS") or os.path.join(os.environ.get("BUILD", os.path.join(ROOT, "build")), "bin")
sys.path.insert(0, os.path.join(ROOT, "workflows", "post"))


# Starts a program and tells what it took. A program begins with the peak memory of who starts it, so a small process has to.
STARTER = """
import os, subprocess, sys, time
start = time.perf_counter()
process = subprocess.Popen(sys.argv[2:])
_, status, usage = os.wait4(process.pid, 0)
wall = time.perf_counter() - start
told = f"{wall} {usage.ru_utime + usage.ru_stime} {usage.ru_maxrss * 1024} {os.waitstatus_to_exitcode(status)}"
os.write(int(sys.argv[1]), told.encode())
"""

silent = False  # nothing is printed as JSON


def say(bench, case, **values):
    """Prints a JSON line and gives its values."""
    if not silent:
        print(json.dumps({"bench": bench, "case": case, **values}), flush=True)
    return values


class Run:
    """A program that has ended: its standard output, wall time and processor time (s), and peak memory (bytes).

    Of several processes under mpirun the processor time is that of all, the peak memory that of the largest.
    """

    def __init__(self, command, environment=None, before=()):
        words = [str(word) for word in command]
        if "/" not in words[0]:
            words[0] = os.path.join(PROGRAMS, words[0])
        ear, mouth = os.pipe()
        process = subprocess.Popen([sys.executable, "-I", "-S", "-c", STARTER, str(mouth), *before, *words],
                                   stdout=subprocess.PIPE, env=environment, pass_fds=(mouth,))
        os.close(mouth)
        self.output = process.communicate()[0]
        with os.fdopen(ear) as told:
            wall, processor, peak, status = told.read().split()
        if status != "0":
            raise SystemExit(f"{' '.join([*before, *words])}: status {status}")
        self.wall, self.processor, self.peak_bytes = float(wall), float(processor), int(peak)

    def document(self):
        return json.loads(self.output)


def run_cases(cases, parser, given):
    """The rows of each case in given.cases. cases: by name, what measures it in a folder, first, and what draws it."""
    if unknown := set(given.cases) - set(cases):
        parser.error(f"no case {', '.join(sorted(unknown))}; there are {', '.join(cases)}")
    found = {}
    for case in given.cases:
        with tempfile.TemporaryDirectory() as folder:
            found[case] = cases[case][0](folder, given)
    return found


def alone():
    """The environment of a run on one thread; mpirun starts as root too, as in a container."""
    return {**os.environ, "OMP_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
