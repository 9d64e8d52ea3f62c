#!/usr/bin/env bats
# python.bats: the package kiln: streams come back with the same bytes, pipes run as in a shell, errors are the programs' own.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    export PYTHONPATH="$ROOT/python" PYTHONDONTWRITEBYTECODE=1
    cd "$BATS_FILE_TMPDIR"
    "$SINTER" green -n 200 --method affine --compact-to 0.6 --aspect 4:1:1 --seed 3 -o green.kiln
    "$SINTER" -q --temperature 1200C --to-density 0.7,0.8 --history history.jsonl -o sintered.kiln green.kiln
    "$BONDIFY" -q -o bonded.kiln sintered.kiln
    "$BEND" -q bonded.kiln --states bent.kiln -o bend.jsonl
    "$ANALYZE" modulus -q bend.jsonl -o modulus.jsonl
}

setup() { cd "$BATS_FILE_TMPDIR"; }

@test "what the programs wrote and kiln read is written as the same bytes: binary, text, results, histories" {
    "$ANALYZE" select --text --index 1 bent.kiln -o text.jsonl
    "$PYTHON" - <<'END'
import kiln
(state, ) = kiln.read("text.jsonl")
state["materials"][0] |= {"name": 'Al₂O₃ "rein"\t\x7f', "young_modulus": 1234567890123456.8}
state["ähnlich"] = [1e15, -1.5e15, 9007199254740993.0, 1e16, 1e-5, 1e-4, -0.0, 5e-324, 123456789012345678, True, None]
kiln.write("by_hand.jsonl", state)
END
    "$ANALYZE" select --index 1 by_hand.jsonl -o odd.kiln
    "$ANALYZE" select --index 1 --text by_hand.jsonl -o odd.jsonl
    cat green.kiln text.jsonl bend.jsonl odd.kiln >mixed.kiln
    run -0 "$PYTHON" - green.kiln sintered.kiln bonded.kiln bent.kiln bend.jsonl modulus.jsonl history.jsonl text.jsonl odd.kiln odd.jsonl mixed.kiln <<'END'
import sys
import kiln
for path in sys.argv[1:]:
    documents = kiln.read(path)
    kiln.write("again", documents)
    assert open("again", "rb").read() == open(path, "rb").read(), path
    for text in (True, False):  # the other kind has the same arrays
        kiln.write("other", documents, text)
        for one, two in zip(documents, kiln.read("other"), strict=True):
            assert type(one) == type(two) and one.keys() == two.keys()
            for group, arrays in kiln.groups(one).items():
                for name, values in arrays.items():
                    assert (values == two[group][name]).all() and values.dtype == two[group][name].dtype, (path, name)
# The programs spell some numbers with a digit more than Python; without such a number the test would show little.
assert any(document.spelling for path in ("text.jsonl", "odd.jsonl") for document in kiln.read(path))
END
}

@test "states: arrays, box and densities by name; one made by hand goes through the programs" {
    run -0 "$PYTHON" - <<'END'
import numpy
import kiln
state = kiln.read("bonded.kiln")[-1]
told = kiln.run("analyze info bonded.kiln")[-1]
assert isinstance(state, kiln.State) and not isinstance(told, kiln.State)
assert state.position.shape == (200, 3) and state.radius.shape == (200, ) and state.periodic == (True, True, True)
assert abs(state.relative_density - told["relative_density"]) < 1e-12 and state.time == told["time"]
assert (state.lengths == numpy.diag(state["box"]["vectors"])).all() and (state.origin == 0).all()
assert len(state.bonds["radius"]) == told["bonds"] and kiln.read("green.kiln")[0].bonds == {}
table = kiln.records(state.bonds)
assert table.shape == (told["bonds"], ) and table["pair"].shape == (told["bonds"], 2) and table[3]["radius"] == state.bonds["radius"][3]
assert list(kiln.columns(state.particles)) == ["id", "position[0]", "position[1]", "position[2]", "radius", "material"]
state = kiln.read("sintered.kiln")[-1]
state.radius[:] *= 0.5  # in place
halved = kiln.run("analyze info", given=state)[0]
assert abs(8 * halved["relative_density"] / kiln.run("analyze info sintered.kiln")[-1]["relative_density"] - 1) < 1e-12
# Two spheres of 50 nm, 90 nm apart: one contact, overlap h/2R = 0.1.
pair = kiln.State.of([[1e-7, 1e-7, 1e-7], [1.9e-7, 1e-7, 1e-7]], 5e-8, [3e-7] * 3, velocity=numpy.zeros((2, 3)))
(found, ) = kiln.run("analyze density", given=pair)
assert found["coordination_number"] == 1 and abs(found["mean_overlap_ratio"] - 0.1) < 1e-9
assert (kiln.run("analyze select --index 1", given=pair)[0].particles["velocity"] == 0).all()
for wrong in (lambda: kiln.State.of([1e-7] * 3, 1e-8, [1e-6] * 3), lambda: kiln.State.of([[0.0] * 3], 1e-8, [1e-6] * 3, mass=[1, 2]),
              lambda: kiln.write("none", {"particles": {"name": numpy.array(["a"])}}), lambda: kiln.write("none", {"a": float("nan")})):
    try:
        wrong()
    except kiln.Error as error:
        print(error)
END
    assert_output "position has the shape (3,), expected N x 3
mass has the shape (2,), expected a row for each of 1 particles
particles.name: is of the type <U1; a stream holds f8, f4, i8, i4, i2, i1, u1
nan is not a finite number, and text cannot hold it"
    [ ! -e none ]
}

@test "a pipe gives what the shell gives, with progress of each program in the caller's thread" {
    run -0 --separate-stderr "$PYTHON" - <<'END'
import threading
import kiln
steps = []
def heard(step):
    assert threading.current_thread() is threading.main_thread()
    steps.append(step)
found = kiln.run("sinter --temperature 1200C --to-density 0.7,0.8 green.kiln | bondify", ["bend"], kiln.command("analyze modulus", quiet=True),
                 progress=heard, threads=1)
kiln.write("piped.jsonl", found)
assert open("piped.jsonl", "rb").read() == open("modulus.jsonl", "rb").read()
history = kiln.read("history.jsonl")
sinter = [step for step in steps if step.program == "sinter"]
assert [step.step for step in sinter] == list(range(1, len(history) + 1))
assert [step.values["relative_density"] for step in sinter] == [line["relative_density"] for line in history]
assert {step.program for step in steps} >= {"sinter", "bondify"}
assert kiln.run("bend -q", "analyze modulus -q", given=kiln.documents("bonded.kiln")) == found
assert kiln.command("sinter green", "a.toml", particles=20, to_density=[0.7, 0.8], text=True, quiet=False, seed=None) == [
    "sinter", "green", "--particles", "20", "--to-density", "0.7,0.8", "--text", "a.toml"]
END
    run -0 --separate-stderr "$PYTHON" -c 'import kiln; kiln.run("sinter --temperature 1200C --to-density 0.65 green.kiln", progress=True)'
    [[ $stderr =~ ^"sinter: step 1: time "[0-9.]+", ".*"relative density 0.6" ]] || fail "$stderr"
}

@test "errors of programs are kiln.Error with their sentence; nothing is left running" {
    cat >errors.py <<'END'
import os
import time
import kiln
def refused(*commands, **options):
    try:
        kiln.run(*commands, **options)
    except kiln.Error as error:
        print(type(error).__name__, error.program, error.status, error)
        return error
refused("sinter green -n 20 --density 3", "bondify", "analyze bonds")
refused("analyze select --index 7 sintered.kiln | bondify")
refused("sinter green -n 300", "bend --span 3")
refused("analyze density sintered.kiln --table")
refused("no-such-program")
refused("sinter |")
refused("sinter 'green")
error = refused("sinter --schedule '25C 20K/min 900C' --to-density 0.9 green.kiln")
assert len(error.documents) == 1 and error.documents[0].relative_density < 0.61
refused("bash -c 'kill -9 $$'")
# A caller that gives up takes the programs with it.
def stop(step):
    raise KeyboardInterrupt
began = time.monotonic()
try:
    kiln.run("sinter --temperature 1200C --to-density 0.99 green.kiln", "sleep 60", progress=stop)
except KeyboardInterrupt:
    print("stopped")
assert time.monotonic() - began < 30
try:
    print(os.waitpid(-1, os.WNOHANG))
except ChildProcessError:
    print("no child")
END
    run -0 --separate-stderr "$PYTHON" errors.py
    assert_line --index 0 --regexp "^Error sinter 2 sinter green: --density: spheres that do not overlap"
    assert_line --index 1 --regexp "^Error analyze 1 analyze select: there is no state 7"
    assert_line --index 2 --regexp "^Error bend 2 bend: --span: '3' has no unit"
    assert_line --index 3 "Error analyze None analyze: what it wrote, document 1: is no line of JSON (Expecting value: line 1 column 1 (char 0))"
    assert_line --index 4 "Error no-such-program None no-such-program: is not found; build it by make, or name its folder in PATH"
    assert_line --index 5 "Error None None a program is missing in the pipe"
    assert_line --index 6 "Error None None 'sinter 'green': No closing quotation"
    assert_line --index 7 --regexp "^NotConverged sinter 3 sinter: green.kiln, document 1: the schedule ends at a relative density of 0.6"
    assert_line --index 8 "Error bash -9 bash: was ended by SIGKILL"
    assert_line --index 9 "stopped"
    assert_line --index 10 "no child"
    # A warning names the line of the caller.
    [[ $stderr =~ "errors.py:6: ProgramWarning: sinter: warning: green.kiln, document 1: the schedule ends" ]] || fail "$stderr"
}

@test "results and arrays as pandas frames, and one sentence where there is no pandas" {
    cat >frames.py <<'END'
import kiln
tests = kiln.read("modulus.jsonl")
try:
    table = kiln.frame(tests)
except kiln.Error as error:
    print(error)
    raise SystemExit
assert list(table["young_modulus"]) == [test["young_modulus"] for test in tests] and "history" not in table
density = kiln.run("analyze density", given=kiln.read("sintered.kiln"))
assert list(kiln.frame(density)["diameter.by_number.d50"]) == [each["diameter"]["by_number"]["d50"] for each in density]
state = kiln.read("bonded.kiln")[0]
assert (kiln.frame(state.bonds)["pair[1]"] == state.bonds["pair"][:, 1]).all()
END
    if "$PYTHON" -c 'import pandas' 2>/dev/null; then
        run -0 "$PYTHON" frames.py
        assert_output ""
    fi
    mkdir -p without/pandas
    echo 'raise ImportError("hidden")' >without/pandas/__init__.py
    PYTHONPATH="$PWD/without:$PYTHONPATH" run -0 "$PYTHON" frames.py
    assert_output "a frame requires pandas, Debian's python3-pandas; kiln.records() makes tables without it"
}

@test "a file is written whole or not at all; devices, links and the version are what they should be" {
    cp green.kiln kept.kiln
    ln -sf kept.kiln link.kiln
    run -0 "$PYTHON" - <<'END'
import kiln
try:
    kiln.write("kept.kiln", [*kiln.read("sintered.kiln"), {"a": float("inf")}])
except kiln.Error:
    pass
assert kiln.read("kept.kiln")[0]["time"] == 0
kiln.write("link.kiln", kiln.read("sintered.kiln"))
kiln.write("/dev/null", kiln.read("sintered.kiln"))
kiln.write("-", kiln.read("sintered.kiln")[0], text=True)
print(kiln.__version__, flush=True)
END
    [ -L link.kiln ] && [ -c /dev/null ]
    cmp kept.kiln sintered.kiln
    jq -e .box <<<"${lines[0]}"
    assert_line --index 1 "$("$SINTER" --version | sed 's/.*) //')"
    run -0 ls
    refute_output --partial partial
}

@test "every function has types (mypy)" {
    type -P mypy >/dev/null || skip "there is no mypy"
    run -0 mypy --strict --cache-dir "$BATS_TEST_TMPDIR" "$ROOT/python/kiln"
    assert_output --partial "no issues found"
}
