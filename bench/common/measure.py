"""measure.py: programs run and measured, and JSON lines, for the scripts of bench."""
import json
import os
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAMS = os.environ.get("PROGRAMS") or os.path.join(os.environ.get("BUILD", os.path.join(ROOT, "build")), "bin")
sys.path.insert(0, os.path.join(ROOT, "workflows", "post"))


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
        start = time.perf_counter()
        words = [str(word) for word in command]
        if "/" not in words[0]:
            words[0] = os.path.join(PROGRAMS, words[0])
        process = subprocess.Popen([*before, *words], stdout=subprocess.PIPE, env=environment)
        self.output = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            raise SystemExit(f"{' '.join([*before, *words])}: status {process.returncode}")
        self.wall = time.perf_counter() - start
        self.processor = usage.ru_utime + usage.ru_stime
        self.peak_bytes = usage.ru_maxrss * 1024

    def document(self):
        return json.loads(self.output)


def alone():
    """The environment of a run on one thread; mpirun starts as root too, as in a container."""
    return {**os.environ, "OMP_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
