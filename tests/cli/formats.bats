#!/usr/bin/env bats
# formats.bats: dem-convert and the files of other programs: right, or refused in one sentence. Run in one Python each (tests/convert).
# `make mutate-formats COUNT=5000` does more of the last one.
bats_require_minimum_version 1.5.0
load helper.bash

setup() {
    export PYTHONDONTWRITEBYTECODE=1
    cd "$ROOT/tests/convert"
}

@test "units, styles of units and built-in materials are the same in Python as in the library" {
    "$PYTHON" -m unittest -q test_homes
}

@test "files as users have them give the right values or are refused: units, materials, boxes, titles, encodings, tables" {
    "$PYTHON" -m unittest -q test_cases
}

@test "a packing of two materials, bonded through faces or free, comes back through every format in every style of units, bit by bit" {
    "$PYTHON" -m unittest -q test_differential
}

@test "200 spoilt files of each format give the right values or are refused, and the programs read what comes out" {
    run -0 "$PYTHON" mutate_formats.py --count 200 --keep "$BATS_TEST_TMPDIR"
    assert_line "0 faults"
    assert_equal "$(grep -c ': 200 mutants, ' <<<"$output")" 7
}
