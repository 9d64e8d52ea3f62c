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

# words PICTURE.svg: the texts of a figure, a line each.
words() { grep -oP '(?<=<text)[^>]*>\K[^<]+' "$1"; }

figure() { "$PYTHON" "$ROOT/workflows/post/figure_$1.py" "${@:2}"; }

@test "figures say what they look at: temperatures of the firing, how moduli were found, literature of the material only" {
    echo '{"name":"spinel","young_modulus":2.7e11,"poisson_ratio":0.26,"surface_energy":1.0,"atomic_volume":8.47e-30,"grain_boundary_diffusion":{"prefactor":1.3e-8,"activation_energy":475e3}}' >spinel.json
    "$SINTER" green -q -n 500 --density 0.43 --aspect 6:1:1 --material spinel.json -o green.kiln
    "$SINTER" -q --schedule "25C 10K/min 1000C 1min" --history fired.jsonl -o fired.kiln green.kiln
    "$SINTER" -q --temperature 1200C --to-density 0.7,0.85 --history held.jsonl -o held.kiln green.kiln
    run -0 figure density fired.jsonl fired.kiln -o fired.svg
    run -0 words fired.svg
    assert_line --regexp "^Time at [0-9]+ to 1000 °C, s$"
    run -0 figure density held.jsonl held.kiln -o held.svg
    run -0 words held.svg
    assert_line "Time at 1200 °C, s"
    "$BONDIFY" -q held.kiln -o bonded.kiln
    "$ANALYZE" elastic bonded.kiln >cell.json
    "$BEND" -q --cycles 1 bonded.kiln | "$ANALYZE" modulus -q >bending.json
    "$ANALYZE" fit -q --law gibson-ashby cell.json >fit.json
    run -0 figure modulus fit.json -o cell.svg
    run -0 words cell.svg
    assert_line "periodic cell"
    refute_output --partial "bending"
    refute_output --partial "alumina"
    assert_output --partial "of spinel"
    "$ANALYZE" fit -q --law gibson-ashby cell.json bending.json >fit.json
    run -0 figure modulus fit.json -o both.svg
    run -0 words both.svg
    assert_line "periodic cell"
    assert_line "simulated bending"
    "$ANALYZE" fit -q --law gibson-ashby <(jq -c '.material = "alumina"' bending.json) >fit.json
    run -0 figure modulus fit.json -o alumina.svg
    run -0 words alumina.svg
    assert_output --partial "Knudsen, alumina"
}

@test "a figure of the wrong kind of document is one sentence" {
    "$SINTER" green -q -n 60 --method affine --compact-to 0.6 -o state.kiln
    printf '{"format":"dem-bend","version":1}\n' >bend.json
    : >empty.json
    head -c 300 state.kiln >spoilt.kiln
    for name in modulus kinetics law fired bend bonds density grains states; do
        for file in state.kiln bend.json empty.json spoilt.kiln absent.json; do
            inputs=("$file")
            case $name in
            bend | density) inputs=("$file" "$file") ;;
            states) [[ $file != state.kiln ]] || continue ;;
            esac
            run -1 --separate-stderr figure $name "${inputs[@]}" -o figure.svg
            assert_equal "$output" ""
            assert_equal "${#stderr_lines[@]}" 1
            assert_regex "$stderr" "^figure_$name.py: $file"
            assert [ ! -e figure.svg ]
        done
    done
    run -1 --separate-stderr figure modulus state.kiln -o figure.svg
    assert_equal "$stderr" "figure_modulus.py: state.kiln, document 1: is dem-state, expected dem-fit, which analyze fit writes"
}
