#!/usr/bin/env bats
# determinism.bats: the same bytes from every program, with each of its methods, for any number of threads and in every run.
bats_require_minimum_version 1.5.0
load helper.bash

@test "one, two and four threads write the same bytes from green body to fitted law" {
    for threads in 1 2 4; do "$ROOT/tests/chain.sh" "$BATS_TEST_TMPDIR/$threads" "$threads"; done
    cd "$BATS_TEST_TMPDIR"
    run -0 ls 1
    assert_equal "${#lines[@]}" 19
    diff -r 1 2
    diff -r 1 4
}
