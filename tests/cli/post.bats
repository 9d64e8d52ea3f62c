#!/usr/bin/env bats
# post.bats: the Python reader and writer of dem-state streams agree with the programs, bit by bit.
bats_require_minimum_version 1.5.0
load helper.bash

setup() {
    export PYTHONPATH="$ROOT/workflows/post" PYTHONDONTWRITEBYTECODE=1
    cd "$BATS_TEST_TMPDIR"
    cat >copy.py <<'END'
import sys
import kiln
for document in kiln.documents(sys.stdin.buffer):
    kiln.write(sys.stdout.buffer, document, text="--text" in sys.argv)
END
    cat >random_state.py <<'END'
import sys
import numpy
import kiln
random = numpy.random.default_rng(7)
for count, bonds in ((1, 0), (50, 80)):
    kiln.write(sys.stdout.buffer, {
        "format": "dem-state", "version": 1, "units": "SI", "time": 0.1, "note": "überall",
        "box": {"origin": [0, 0, 0], "vectors": [[1e-6, 0, 0], [0, 1e-6, 0], [0, 0, 1e-6]], "periodic": [True, False, True]},
        "particles": {"position": random.random((count, 3)) * 1e-6, "radius": 1e-9 + random.random(count) * 1e-8,
                      "flag": random.integers(0, 255, count, numpy.uint8), "tensor": random.random((count, 3, 3), numpy.float32)},
        "bonds": {"pair": numpy.array([[k % count, (k + 1 + k // count) % count] for k in range(bonds)], numpy.int32).reshape(-1, 2),
                  "radius": random.random(bonds) * 1e-9,
                  "length": random.random(bonds) * 1e-9}})
END
}

@test "what Python writes, binary or text, the programs read as the same state" {
    "$PYTHON" random_state.py >states.kiln
    "$PYTHON" copy.py --text <states.kiln >states.jsonl
    "$ANALYZE" select --index 1,2 <states.kiln >from_binary.kiln
    "$ANALYZE" select --index 1,2 <states.jsonl >from_text.kiln
    cmp from_binary.kiln from_text.kiln
}

@test "what the programs write, Python reads and writes back byte for byte" {
    "$PYTHON" random_state.py | "$ANALYZE" select --index 1,2 >states.kiln
    "$PYTHON" random_state.py | "$ANALYZE" select --index 1,2 --text >states.jsonl
    "$ANALYZE" select --index 1,2 <states.kiln >expected.kiln
    "$PYTHON" copy.py <states.kiln | "$ANALYZE" select --index 1,2 >from_binary.kiln
    "$PYTHON" copy.py <states.jsonl | "$ANALYZE" select --index 1,2 >from_text.kiln
    cmp expected.kiln from_binary.kiln
    cmp expected.kiln from_text.kiln
}

@test "arrays keep values, types and shapes" {
    "$PYTHON" random_state.py | "$ANALYZE" select --index 2 >state.kiln
    run -0 "$PYTHON" - <<'END'
import numpy
import kiln
(state,) = kiln.read("state.kiln")
particles, bonds = state["particles"], state["bonds"]
print(particles["id"].dtype, particles["position"].shape, bonds["image"].dtype)
print(particles["tensor"].dtype, particles["tensor"].shape)
print(state["note"], numpy.array_equal(particles["id"], numpy.arange(50)), particles["radius"].min() > 0)
END
    assert_line "int64 (50, 3) int8"
    assert_line "float32 (50, 3, 3)"
    assert_line "überall True True"
}

@test "a binary document starts its payload and its arrays at multiples of 64 bytes" {
    "$PYTHON" random_state.py >states.kiln
    run -0 "$PYTHON" -c '
import json
with open("states.kiln", "rb") as stream:
    while line := stream.readline():
        header = json.loads(line)
        print(len(line) % 64, stream.seek(header["bytes"], 1) % 64,
              {spec["at"] % 64 for group in ("particles", "bonds") for spec in header[group].values()})'
    assert_output $'0 0 {0}\n0 0 {0}'
}

@test "a mixed stream of states and results is read in order" {
    "$PYTHON" random_state.py >mixed.kiln
    echo '{"format":"dem-bend","version":1,"particles":50}' >>mixed.kiln
    "$PYTHON" random_state.py | "$PYTHON" copy.py --text >>mixed.kiln
    run -0 "$PYTHON" -c '
import kiln
for document in kiln.read("mixed.kiln"):
    print(document["format"], document["particles"] if document["format"] == "dem-bend" else len(document["particles"]["radius"]))'
    assert_output $'dem-state 1\ndem-state 50\ndem-bend 50\ndem-state 1\ndem-state 50'
}

@test "a truncated stream is an error that says how much was wanted" {
    "$PYTHON" random_state.py >states.kiln
    head -c 2000 states.kiln >short.kiln
    run -1 --separate-stderr "$PYTHON" copy.py <short.kiln
    [[ $stderr == *"bytes belong behind the header, "*" are there"* ]]
}
