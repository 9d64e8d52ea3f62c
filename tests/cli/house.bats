#!/usr/bin/env bats
# house.bats: habits of the tree that a program can check.
bats_require_minimum_version 1.5.0
load helper.bash

@test "parts use what lies below them, lines are not too long, no path of a machine is named" {
    git -C "$ROOT" rev-parse >/dev/null 2>&1 || skip "this is no checkout"
    run -0 "$PYTHON" "$ROOT/tests/house.py"
    assert_output --regexp "^[0-9]+ files in order$"
}
