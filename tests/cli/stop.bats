#!/usr/bin/env bats
# stop.bats: SIGINT and SIGTERM end a program within a second, wherever it is.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    "$SINTER" green -n 30000 --aspect 4:1:1 --compact-to 0.6 -o green.kiln
    "$BONDIFY" -q -o bonded.kiln green.kiln
}

setup() { cd "$BATS_FILE_TMPDIR"; }

# stopped SIGNAL SECONDS COMMAND...: the command, a signal after that time: its status is that of the signal, and it ends soon.
stopped() {
    local signal=$1 seconds=$2 begin pid status=0
    shift 2
    "$@" 2>words >/dev/null &
    pid=$!
    sleep "$seconds"
    kill -0 "$pid" 2>/dev/null || fail "$* was done before the signal: $(cat words)"
    begin=$(date +%s%N)
    kill -s "$signal" "$pid"
    wait "$pid" || status=$?
    took=$(( ($(date +%s%N) - begin) / 1000000 ))
    assert_equal "$status" "$((128 + $(kill -l "$signal")))"
    # A second on a machine of its own; the tests may share theirs.
    (( took < 1000 * ${STOP_SECONDS:-3} )) || fail "$* took $took ms to end after SIG$signal"
    [ ! -s words ] || fail "$* said: $(cat words)"
}

@test "packing stops" { stopped TERM 0.5 "$SINTER" green -n 300000 -o packed.kiln; [ ! -e packed.kiln ]; }

@test "sintering stops" { stopped INT 0.5 "$SINTER" -q --temperature 1200C --to-density 0.9 --tolerance 1e-6 -o sintered.kiln green.kiln; }

@test "the viscosities of a state stop" {
    stopped TERM 0.5 "$SINTER" -q --temperature 1200C --report viscosity --at-time 1s,2s,3s,4s,5s,6s,7s,8s,9s,10s --tolerance 1e-6 \
        -o viscous.kiln green.kiln
}

@test "shrinking by sweeps stops" { stopped TERM 0.5 "$BONDIFY" -q --method sweep --decrement 0.00001nm -o swept.kiln green.kiln; }

@test "bending stops, static, dynamic and to failure" {
    stopped TERM 0.5 "$BEND" -q --tolerance 1e-10 -o bent.json bonded.kiln
    stopped INT 0.5 "$BEND" -q --method dynamic -o bent.json bonded.kiln
    stopped TERM 0.5 "$BEND" -q --tensile-strength 300MPa -o bent.json bonded.kiln
    [ ! -e bent.json ]
}

@test "an elastic tensor stops" { stopped TERM 0.5 "$ANALYZE" elastic --tolerance 1e-12 bonded.kiln; }
