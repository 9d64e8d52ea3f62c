#!/usr/bin/env bats
# stream.bats: what every program promises about its command line, its streams, its files and its end, whatever it computes.
bats_require_minimum_version 1.5.0
load helper.bash

CONFORMANCE="$BATS_TEST_DIRNAME/../data/conformance"
READERS=(sinter bondify bend density bonds info)

# COMMAND: the program that a test calls by a short name, with the options without which it does nothing.
command_of() {
    case $1 in
    green) COMMAND=("$SINTER" green -n 200) ;;
    sinter) COMMAND=("$SINTER" --temperature 1200C --to-density 0.6) ;;
    bondify) COMMAND=("$BONDIFY") ;;
    bend) COMMAND=("$BEND" --cycles 1) ;;
    *) COMMAND=("$ANALYZE" "$1") ;;
    esac
}

stage() {
    command_of "$1"
    "${COMMAND[@]}" "${@:2}"
}

# What a stage can read, so that it fails for the reason of the test only.
input_of() {
    case $1 in
    bend | bonds) echo "$SHARED/bonded.dem" ;;
    *) echo "$SHARED/green.dem" ;;
    esac
}

setup_file() {
    export SHARED=$BATS_FILE_TMPDIR OMP_NUM_THREADS=1  # threads that wait for each other are slow where others work too
    "$SINTER" green -n 200 --aspect 4:1:1 --method affine --compact-to 0.55 --seed 4 -o "$SHARED/green.dem"
    "$BONDIFY" -q "$SHARED/green.dem" -o "$SHARED/bonded.dem"
}

setup() {
    cd "$BATS_TEST_TMPDIR"
}

# One sentence on standard error, from this program, and nothing on standard output.
assert_one_sentence() {
    assert_equal "${#stderr_lines[@]}" 1
    assert_equal "$output" ""
    assert_regex "$stderr" "^(sinter|bondify|bend|analyze)( [a-z]+)?: .+"
}

# No file of that name, and none beside it that was meant to become it.
assert_no_file() {
    run -0 find . -name "$1*"
    assert_output ""
}

@test "help ends with 0 and names units and an example with a pipe" {
    for name in green sinter bondify bend; do
        run -0 --separate-stderr stage "$name" --help
        assert_output --regexp "\[.*(nm|K).*\]"
        assert_output --regexp "(sinter|bondify|bend).* \| "
        assert_equal "$stderr" ""
    done
    run -0 "$ANALYZE" --help
    assert_output --partial "SI units"
    assert_output --partial "| analyze fit"
}

@test "the version is said by every program" {
    for name in SINTER BONDIFY BEND ANALYZE; do
        run -0 "${!name}" --version
        assert_output --regexp "^${name,,} \(Kiln\) [0-9]+\.[0-9]+\.[0-9]+$"
    done
}

@test "an option that does not exist is wrong usage, in one sentence that names it" {
    for name in green "${READERS[@]}"; do
        run -2 --separate-stderr stage "$name" --no-such-option
        assert_one_sentence
        assert_regex "$stderr" "--no-such-option"
        assert_regex "$stderr" "--help$"
    done
}

@test "a quantity without its unit, or with another, is wrong usage and the units are listed" {
    for option in "green --diameter" "bondify --method sweep --decrement" "bend --span"; do
        for value in 100 100s 100NM 0x10nm nan inf 1e999nm; do
            run -2 --separate-stderr stage $option "$value"
            assert_one_sentence
            assert_regex "$stderr" "'$value' (has no unit.*m, cm, mm, um, nm|is )"
        done
    done
    for value in 1200 1200c -300C 0K; do
        run -2 --separate-stderr "$SINTER" --to-density 0.6 --temperature "$value" "$SHARED/green.dem"
        assert_one_sentence
    done
}

@test "a config file gives what options give, and the command line is stronger" {
    printf 'method = "sweep"\ndecrement = "0.01nm"\n' >bondify.toml
    "$BONDIFY" -q --method sweep --decrement 0.01nm "$SHARED/green.dem" -o options.dem
    "$BONDIFY" -q --config bondify.toml "$SHARED/green.dem" -o config.dem
    cmp options.dem config.dem
    printf 'seed = 7\ndensity = 0.4\n' >green.toml
    "$SINTER" green -n 100 --seed 8 --density 0.4 -o options.dem
    "$SINTER" green -n 100 --config green.toml --seed 8 -o config.dem
    cmp options.dem config.dem
}

@test "a config file with an unknown key or a wrong value is wrong usage; one that is not there is a failure" {
    echo 'densty = 0.4' >unknown.toml
    echo 'threads = "many"' >value.toml
    for name in green "${READERS[@]}"; do
        run -2 --separate-stderr stage "$name" --config unknown.toml
        assert_one_sentence
        assert_regex "$stderr" "densty"
        run -2 --separate-stderr stage "$name" --config value.toml
        assert_one_sentence
        run -1 --separate-stderr stage "$name" --config absent.toml
        assert_one_sentence
        assert_regex "$stderr" "absent.toml"
    done
}

@test "a file that is not there, a folder and an empty stream are failures with the name" {
    for name in "${READERS[@]}"; do
        run -1 --separate-stderr stage "$name" absent.dem -o out
        assert_one_sentence
        assert_regex "$stderr" "absent.dem: cannot be opened: No such file or directory"
        run -1 --separate-stderr stage "$name" . -o out
        assert_one_sentence
        run -1 --separate-stderr stage "$name" /dev/null -o out
        assert_one_sentence
        assert_regex "$stderr" "/dev/null: holds no document"
        assert_no_file out
    done
}

@test "standard input is read without a name and as -" {
    "$BONDIFY" -q <"$SHARED/green.dem" | cmp - "$SHARED/bonded.dem"
    "$BONDIFY" -q - <"$SHARED/green.dem" | cmp - "$SHARED/bonded.dem"
    cat "$SHARED/bonded.dem" "$SHARED/bonded.dem" "$SHARED/bonded.dem" >three.dem
    "$BONDIFY" -q "$SHARED/green.dem" - "$SHARED/green.dem" <"$SHARED/green.dem" | cmp - three.dem
}

@test "a truncated stream is a failure that says how much was wanted, and leaves no file" {
    for name in "${READERS[@]}"; do
        size=$(stat -c %s "$(input_of "$name")")
        for bytes in $((size - 1)) $((size / 2)); do
            head -c "$bytes" "$(input_of "$name")" >cut.dem
            run -1 --separate-stderr stage "$name" cut.dem -o out
            assert_one_sentence
            assert_regex "$stderr" "cut.dem, document 1: is truncated: [0-9]+ bytes belong behind its header, [0-9]+ are there"
            run -1 --separate-stderr stage "$name" -o out < <(cat cut.dem)
            assert_one_sentence
        done
        head -c 100 "$(input_of "$name")" >cut.dem
        run -1 --separate-stderr stage "$name" cut.dem -o out
        assert_one_sentence
        assert_regex "$stderr" "ends inside its header"
        assert_no_file out
    done
}

@test "a document after the first that is cut leaves no file either" {
    cat "$SHARED/green.dem" >two.dem
    head -c 3000 "$SHARED/green.dem" >>two.dem
    run -1 --separate-stderr stage bondify -q two.dem -o out
    assert_one_sentence
    assert_regex "$stderr" "two.dem, document 2: is truncated"
    assert_no_file out
}

@test "unknown version, other units, NaN and infinity are failures that name document, array and row" {
    while IFS=$'\t' read -r file sentence; do
        for name in sinter bondify bend density bonds; do
            run -1 --separate-stderr stage "$name" "$CONFORMANCE/invalid/$file.dem" -o out
            assert_one_sentence
            assert_regex "$stderr" "$file.dem, document 1: $sentence$"
            assert_no_file out
        done
    done <<'TABLE'
version-unknown	has version 2, this program knows version 1
units	has units "cgs", wanted "SI"
binary-position-nan	particles.position, row 1: is not a finite number
binary-radius-infinite	particles.radius, row 1: is not a finite number
radius-zero	particle 1 \(row 1\) has radius 0.0, wanted a positive one
TABLE
}

@test "a full device is one sentence, for -o and for standard output" {
    for name in green "${READERS[@]}"; do
        file=$(input_of "$name")
        if [[ $name == green ]]; then file=; fi
        run -1 --separate-stderr stage "$name" -q $file -o /dev/full
        assert_one_sentence
        assert_regex "$stderr" "/dev/full: cannot be written: No space left on device"
        stage_to_full() { stage "$name" -q $file >/dev/full; }
        run -1 --separate-stderr stage_to_full
        assert_one_sentence
        assert_regex "$stderr" "standard output: cannot be written: No space left on device"
    done
    help_to_full() { "$SINTER" --help >/dev/full; }
    run -1 --separate-stderr help_to_full
    assert_one_sentence
}

@test "a file that may grow no further is one sentence, and what was there before stays" {
    echo before >out
    cp out wanted
    limited() { (ulimit -f 1 && "$SINTER" green -n 2000 -o out); }
    run -1 --separate-stderr limited
    assert_one_sentence
    assert_regex "$stderr" "out: cannot be written: File too large"
    cmp out wanted
    run -0 find . -name 'out*'
    assert_output ./out
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

@test "an output may be the input" {
    cp "$SHARED/green.dem" same.dem
    "$BONDIFY" -q same.dem -o wanted.dem
    "$BONDIFY" -q same.dem -o same.dem
    cmp same.dem wanted.dem
    "$BONDIFY" -q "$SHARED/green.dem" | cmp - wanted.dem
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

@test "two runs with one output leave the whole of one of them" {
    for _ in 1 2 3; do
        "$BONDIFY" -q "$SHARED/green.dem" -o out &
        "$BONDIFY" -q "$SHARED/green.dem" -o out
        wait $!
        cmp out "$SHARED/bonded.dem"
    done
    run -0 find . -name 'out*'
    assert_output ./out
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
    "$SINTER" -v --temperature 900C --at-time 100000h "$SHARED/green.dem" -o out 2>steps &
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
