"""measure.py: runs the stage that makes a file, says how long it took, and writes wall and processor time (s) and peak memory (MB)
to FILE.time; the exit status is the stage's."""
import resource
import signal
import subprocess
import sys
import time

KIB = 1024  # bytes; Linux counts memory in KiB


def timed(made, command, **options):
    """Runs a command, with options of Popen; its status, and what it said where stderr is a pipe. Writes the file of times."""
    start = time.monotonic()
    stage = subprocess.Popen(command, text=True, **options)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the stage has it too, and decides
    signal.signal(signal.SIGTERM, lambda number, frame: stage.send_signal(number))
    said = stage.communicate()[1] or ""
    status = stage.returncode
    wall = time.monotonic() - start
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    peak = used.ru_maxrss * KIB / 1e6
    with open(made + ".time", "w", encoding="utf-8") as file:
        file.write(f"{wall:.2f}\t{used.ru_utime + used.ru_stime:.2f}\t{peak:.0f}\n")
    if status == 0:
        print(f"{wall:8.1f} s {peak:6.0f} MB  {made}", file=sys.stderr)
    return status if status >= 0 else 128 - status, said


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: measure.py FILE COMMAND [ARGUMENT…]")
    sys.exit(timed(sys.argv[1], sys.argv[2:])[0])


if __name__ == "__main__":
    main()
