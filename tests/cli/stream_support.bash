# stream_support.bash: the programs by short names, a state that each can read, and what a refusal looks like.
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
