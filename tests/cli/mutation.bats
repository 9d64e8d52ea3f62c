#!/usr/bin/env bats
# mutation.bats: every program ends in order whatever it is fed: `make mutate COUNT=100000` does more of the same.
bats_require_minimum_version 1.5.0
load helper.bash

@test "sizes, spheres and furnace logs in many manners and spoilt: the right value or a refusal, never else" {
    export PYTHONDONTWRITEBYTECODE=1
    run -0 "$PYTHON" "$ROOT/tests/fuzz/mutate_powders.py" --count 60 --keep "$BATS_TEST_TMPDIR"
    assert_equal "$(grep -c "60 files, .* 0 faults" <<<"$output")" 4
}

@test "streams spoilt in a thousand ways are taken or refused in one sentence, without NaN, crash, hang or too much memory" {
    export PYTHONDONTWRITEBYTECODE=1
    run -0 "$PYTHON" "$ROOT/tests/fuzz/mutate.py" --count 1000 --keep "$BATS_TEST_TMPDIR"
    assert_output --regexp "^1000 mutants: [0-9]{3} taken, [0-9]+ taken without converging, [0-9]{3} refused, 0 faults"
}
