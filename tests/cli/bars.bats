#!/usr/bin/env bats
# bars.bats: a short part of tests/relations/bars.py: random small bars to failure and with friction.
bats_require_minimum_version 1.5.0
load helper.bash

@test "random bars bent to failure balance their energies, and with friction they end with numbers" {
    run -0 "$PYTHON" "$ROOT/tests/relations/bars.py" --failure 14 --friction 6 --seed 5
    assert_output --partial "failure: 14 bars, 0 failed"
    assert_output --partial "friction: 6 bars, 0 failed"
}
