#!/usr/bin/env bats
# places.bats: every error says which file and which document it is about.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    "$SINTER" green -n 60 --aspect 3:1:1 --text -o green.jsonl
    "$SINTER" --temperature 1200C --to-density 0.6 --text -o fired.jsonl green.jsonl
    "$BONDIFY" --text -o bonded.jsonl fired.jsonl
    cat bonded.jsonl fired.jsonl >half.jsonl
}

setup() { cd "$BATS_FILE_TMPDIR"; }

# One line on stderr, and nothing more than that sentence.
assert_sentence() { assert_equal "$stderr" "$1"; }

@test "bend, analyze elastic and analyze bonds name the document that has no bonds" {
    run -1 --separate-stderr "$BEND" -q half.jsonl
    assert_sentence "bend: half.jsonl, document 2: the state has no bonds; run bondify first"
    run -1 --separate-stderr "$ANALYZE" elastic half.jsonl
    assert_sentence "analyze elastic: half.jsonl, document 2: the state has no bonds; run bondify first"
    run -1 --separate-stderr "$ANALYZE" bonds half.jsonl
    assert_sentence "analyze bonds: half.jsonl, document 2: has no bonds; bondify makes them"
}

@test "what comes through a pipe is named as standard input" {
    run -1 --separate-stderr bash -c 'cat half.jsonl | "$BEND" -q'
    assert_sentence "bend: standard input, document 2: the state has no bonds; run bondify first"
}

@test "sinter names the document of a material that cannot sinter, and of a density that lies behind" {
    jq -c '.materials = [{name: "m", diffusion_parameter: 1e-40}]' green.jsonl >poor.jsonl
    run -1 --separate-stderr "$SINTER" -q --temperature 1200C --to-density 0.5 --text green.jsonl poor.jsonl
    assert_sentence "sinter: poor.jsonl, document 1: material 'm' has no surface_energy, which sintering needs; --material NAME or FILE.json says what it is"
    run -1 --separate-stderr "$SINTER" -q --temperature 1200C --to-density 0.5 --text green.jsonl fired.jsonl
    assert_regex "$stderr" "^sinter: fired.jsonl, document 1: the density 0\.5 "
}

@test "bondify names the document of spheres too close for a bond" {
    jq -c '.particles.position.data[3:6] = (.particles.position.data[0:3] | .[0] += 1e-10)' green.jsonl >close.jsonl
    run -1 --separate-stderr "$BONDIFY" -q --text green.jsonl close.jsonl
    assert_regex "$stderr" "^bondify: close.jsonl, document 1: particles "
}

@test "analyze density, info and select name the document; what is wrong with it is said once" {
    run -1 --separate-stderr "$ANALYZE" density --range 1m --correlation <(jq -c '.box.periodic = [false, false, false]' green.jsonl)
    assert_regex "$stderr" "^analyze density: /dev/fd/[0-9]+, document 1: no particle lies as far inside"
    jq -c '.particles.radius.data[7] = -1' green.jsonl >negative.jsonl
    for subcommand in info density; do
        run -1 --separate-stderr "$ANALYZE" $subcommand green.jsonl negative.jsonl
        assert_regex "$stderr" "^analyze $subcommand: negative.jsonl, document 1: particle [0-9]+ \\(row 7\\) has radius -1"
    done
    jq -c '.time = 5 | .particles.id = {type: "i8", shape: [60], data: [range(100; 160)]}' green.jsonl >others.jsonl
    run -1 --separate-stderr "$ANALYZE" select --interpolate --time 2s green.jsonl others.jsonl
    assert_regex "$stderr" "^analyze select: others.jsonl, document 1: between it and the state before: the states differ"
}

@test "warnings name the document too" {
    run -0 --separate-stderr "$BONDIFY" --text -o /dev/null half.jsonl
    assert_sentence "bondify: warning: half.jsonl, document 1: the bonds that it had are replaced"
}
