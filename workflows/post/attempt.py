"""attempt.py: runs a stage of a study as measure.py does, but one that fails does not stop the others: its files are there and
empty, FILE.said holds what it said, and a stage that reads an empty file makes empty files as well. Status 3, done without
converging, is no failure."""
import os
import pathlib
import subprocess
import sys

import measure

OUTPUTS = ("-o", "--output", "--history", "--states", "--save-material")
PASSED_ON = (126, 127, 130, 143)  # the stage is not there, or was stopped: that is no result


def outputs_of(command):
    return [word for option, word in zip(command, command[1:]) if option in OUTPUTS]


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: attempt.py FILE COMMAND [ARGUMENT…]")
    made, command = sys.argv[1], sys.argv[2:]
    outputs = outputs_of(command)
    inputs = [word for word in command[1:] if word not in outputs and word.endswith((".kiln", ".json")) and os.path.isfile(word)]
    empty = any(os.path.getsize(word) == 0 for word in inputs)
    try:
        status, said = (0, "") if empty else measure.timed(made, command, stderr=subprocess.PIPE)
    except OSError as error:
        sys.exit(f"study: {command[0]}: {error.strerror}")
    sys.stderr.write(said)
    pathlib.Path(made + ".said").write_text(said, encoding="utf-8")
    if status in PASSED_ON:
        sys.exit(status)
    if empty or status not in (0, 3):
        for path in outputs:
            open(path, "w", encoding="utf-8").close()
        if not empty:
            print(f"study: {made} could not be made; the other bodies go on", file=sys.stderr)


if __name__ == "__main__":
    main()
