#!/usr/bin/env bats
# relations.bats: what must hold whatever the input, a trial or two of each relation; `make relations` does many with other seeds.
bats_require_minimum_version 1.5.0
load helper.bash

# tried TRIALS NAME...: tries the relations whose names begin so.
tried() {
    local trials=$1 only=()
    for name in "${@:2}"; do only+=(--only "$name"); done
    PYTHONDONTWRITEBYTECODE=1 run -0 "$PYTHON" "$ROOT/tests/relations/relations.py" --trials "$trials" --keep "$BATS_TEST_TMPDIR" "${only[@]}"
    assert_output --regexp "^[1-9][0-9]* passed, 0 failed$"
}

@test "green bodies keep their word, scale with their diameters to the last bit, and are compacted affinely" {
    tried 2 green
}

@test "a packing that is moved, renumbered, turned, mirrored, repeated or named otherwise sinters alike" {
    tried 1 sinter_translated sinter_carried sinter_moved sinter_renumbered sinter_turned sinter_repeated sinter_two_names sinter_in_die
}

@test "times of sintering scale with lengths, diffusion and surface energy; the explicit method too" {
    tried 1 sinter_scaled sinter_diffusion sinter_surface sinter_explicit
}

@test "a firing in parts, by time, by density, by schedule, or begun later is the same firing, and mass is kept" {
    tried 1 sinter_in_parts sinter_time_of_density sinter_every sinter_later sinter_schedule sinter_conserves
}

@test "text or binary, file or pipe, joined or apart, one thread or two, interrupted and resumed: the same bytes" {
    tried 1 stream
}

@test "bondify keeps the volume, and makes the same bonds of what is moved, renumbered, turned, scaled, repeated" {
    tried 2 bondify
}

@test "analyze measures the same however a state is written; tensors turn with the axes" {
    tried 2 density bonds elastic select modulus fit
}

@test "a bar that is rewritten, mirrored or scaled bends alike; the work of the punch is stored, spent or lost" {
    tried 1 bend
}
