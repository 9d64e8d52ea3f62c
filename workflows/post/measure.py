"""measure.py: runs one stage and writes its wall time, processor time and peak memory to a file; the stage's exit status stays."""
import resource
import signal
import subprocess
import sys
import time

KIB = 1024  # bytes; Linux counts memory in KiB


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: measure.py RECORD COMMAND [ARGUMENT…]")
    record, command = sys.argv[1], sys.argv[2:]
    start = time.monotonic()
    stage = subprocess.Popen(command)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the stage has it too, and decides
    signal.signal(signal.SIGTERM, lambda number, frame: stage.send_signal(number))
    status = stage.wait()
    wall = time.monotonic() - start
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(record, "w", encoding="utf-8") as file:
        file.write(f"{wall:.2f}\t{used.ru_utime + used.ru_stime:.2f}\t{used.ru_maxrss * KIB / 1e6:.0f}\n")
    sys.exit(status if status >= 0 else 128 - status)


if __name__ == "__main__":
    main()
