#!/usr/bin/env bats
# stream.bats: what every program promises about its command line and what it reads, whatever it computes.
load stream_support.bash

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
units	has units "cgs", expected "SI"
binary-position-nan	particles.position, row 1: is not a finite number
binary-radius-infinite	particles.radius, row 1: is not a finite number
radius-zero	particle 1 \(row 1\) has radius 0.0, expected a positive one
TABLE
}
