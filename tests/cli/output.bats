#!/usr/bin/env bats
# output.bats: what every program promises about what it writes, and how pipes and signals end it. faults.bats has what can go wrong.
load stream_support.bash

@test "a full standard output is one sentence" {
    stage_to_full() { stage "$@" >/dev/full; }
    for name in green "${READERS[@]}"; do
        file=$(input_of "$name")
        if [[ $name == green ]]; then file=; fi
        run -1 --separate-stderr stage_to_full "$name" -q $file
        assert_one_sentence
        assert_regex "$stderr" "standard output: cannot be written: No space left on device"
    done
    run -1 --separate-stderr stage_to_full sinter --help
    assert_one_sentence
}

@test "a failure leaves the file that was there before" {
    echo before >out
    cp out wanted
    for name in "${READERS[@]}"; do
        run -1 stage "$name" "$CONFORMANCE/invalid/binary-radius-zero.dem" "$CONFORMANCE/invalid/no-json.dem" -o out
        cmp out wanted
    done
    run -0 find . -name 'out*'
    assert_output ./out
}

@test "an output in a folder that is not there is a failure before any work" {
    run -1 --separate-stderr timeout 5 "$SINTER" green -n 2000000 -o no/out
    assert_one_sentence
    assert_regex "$stderr" "no/out: cannot be written: No such file or directory"
}

@test "links stay links, devices stay devices" {
    ln -s target link
    "$BONDIFY" -q "$SHARED/green.dem" -o link
    [ -L link ]
    cmp target "$SHARED/bonded.dem"
    "$BONDIFY" -q "$SHARED/green.dem" -o /dev/null
    [ -c /dev/null ]
    "$BONDIFY" -q "$SHARED/green.dem" -o /dev/stdout | cmp - "$SHARED/bonded.dem"
}

@test "a pipe that closes ends a program silently" {
    for _ in {1..20}; do cat "$SHARED/green.dem"; done >many.dem
    closed() {
        "$@" 2>said | head -c 1 >/dev/null
        echo "${PIPESTATUS[0]}"
    }
    run -0 closed "$BONDIFY" -q many.dem
    assert_output 141
    run -0 closed "$SINTER" green -n 5000
    assert_output 141
    run -0 cat said
    assert_output ""
    for name in "${READERS[@]}"; do
        run -0 closed stage "$name" -q "$(input_of "$name")"
        assert_output --regexp "^(0|141)$"
        run -0 cat said
        assert_output ""
    done
}

@test "a signal ends a wait for input silently, with its status and without a file" {
    mkfifo pipe
    exec 7<>pipe
    for name in "${READERS[@]}"; do
        for signal in INT TERM HUP; do
            command_of "$name"
            wait_for_input() { timeout --preserve-status --signal "$signal" 0.3 "${COMMAND[@]}" -q -o out <pipe; }
            run "-$((128 + $(kill -l "$signal")))" wait_for_input
            assert_output ""
            assert_no_file out
        done
    done
    exec 7>&-
}

@test "SIGINT ends sintering after the step; the state it reached is written, and the status is 130" {
    "$SINTER" -v --temperature 900C --tolerance 1e-7 --at-time 100000h "$SHARED/green.dem" -o out 2>steps &
    for _ in {1..100}; do
        if [ -s steps ]; then break; fi
        sleep 0.1
    done
    kill -INT $!
    status=0
    wait $! || status=$?
    assert_equal "$status" 130
    run -0 "$ANALYZE" info out
    assert_equal "$(jq -r .kind <<<"$output")" dem-state
}

@test "binary documents do not go to a terminal; text does" {
    script -qec true /dev/null >/dev/null || skip "no pseudo-terminal here"
    run -1 script -qec "'$BONDIFY' -q '$SHARED/green.dem'" /dev/null
    assert_output --partial "bondify: binary documents do not go to a terminal; use -o FILE, a pipe, or --text"
    run -0 script -qec "'$BONDIFY' -q --text '$CONFORMANCE/valid/minimal.dem'" /dev/null
    assert_output --partial '"format":"dem-state"'
}

@test "names with line ends or control characters cannot forge what is said" {
    name=$'a\nsinter: done\e[2J'
    run -1 --separate-stderr "$BONDIFY" "$name"
    assert_one_sentence
    refute_regex "$stderr" $'\e'
}
