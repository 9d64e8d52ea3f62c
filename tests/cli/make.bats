#!/usr/bin/env bats
# make.bats: what is compiled anew, and when.
bats_require_minimum_version 1.5.0
load helper.bash

# Compiles one file into a build folder of the test's own; says what it does.
compile() { make -C "$ROOT" BUILD="$BATS_TEST_TMPDIR/build" "$BATS_TEST_TMPDIR/build/lib/bending/options.o" "$@"; }

@test "another compiler or other flags compile anew, the same ones do not" {
    mkdir "$BATS_TEST_TMPDIR/build"
    touch "$BATS_TEST_TMPDIR/build/packages-present"
    run -0 compile
    assert_output --partial "g++"
    run -0 compile
    refute_output --partial "g++"
    run -0 compile NATIVE=1
    assert_output --partial "-march=native"
    run -0 compile
    assert_output --partial "g++"
    run -0 compile EXTRA=-DSOMETHING
    assert_output --partial "-DSOMETHING"
}
