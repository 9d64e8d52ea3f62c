#!/usr/bin/env bats
# green.bats: the command line of `sinter green`: what it writes, what it records, what it refuses.
bats_require_minimum_version 1.5.0
load helper.bash

setup() { cd "$BATS_TEST_TMPDIR"; }

# value FILE FILTER: a number from the last text state of a file.
value() { jq -s "last | $2" "$1"; }

@test "green: a text state holds box, material and as many particles as were asked for" {
    run -0 "$SINTER" green -n 200 --diameter 50nm --density 0.4 --aspect 4:1:1 --text -o body
    assert_output ""
    [ "$(wc -l <body)" = 1 ]
    [ "$(jq -r '.format + " " + .units' body)" = "dem-state SI" ]
    [ "$(jq -c '.box.periodic' body)" = "[true,true,true]" ]
    [ "$(jq '.particles.position.data | length' body)" = 600 ]
    [ "$(jq '.particles.id.data == [range(200)]' body)" = true ]
    [ "$(jq -r '.materials[0].name' body)" = alumina ]
    near "$(value body '.particles.radius.data[17]')" 25e-9 1e-12
    near "$(value body '.box.vectors[0][0] / .box.vectors[1][1]')" 4 1e-12
    near "$(value body '200 * 3.141592653589793 / 6 * 125e-24 / (.box.vectors[0][0] * .box.vectors[1][1] * .box.vectors[2][2])')" 0.4 1e-12
}

@test "green: the history says how the body was made and what its contacts are" {
    run -0 "$SINTER" green -n 2000 --seed 5 --text -o body
    [ "$(jq -c '.history[0] | [.tool, .seed, .summary.method, .summary.seed]' body)" = '["sinter green",5,"loose",5]' ]
    near "$(value body .history[0].summary.relative_density)" 0.43 1e-12
    near "$(value body .history[0].summary.coordination_number)" 1.72 0.08
    near "$(value body .history[0].summary.mean_overlap_ratio)" 0.0067 0.08
    run -0 "$SINTER" green -n 200 --text -o unseeded
    [ "$(jq '.history[0].seed' unseeded)" = 1 ]
}

@test "green: the same bytes again and for any number of threads, others for another seed" {
    "$SINTER" green -n 9000 --threads 1 >one
    "$SINTER" green -n 9000 --threads 2 >two
    cmp one two
    "$SINTER" green -n 9000 --threads 1 --seed 2 >other
    run -1 cmp -s one other
}

@test "green: every method and every distribution" {
    "$SINTER" green -n 300 --method affine --compact-to 0.58 --text -o affine
    near "$(value affine .history[0].summary.relative_density)" 0.58 1e-12
    "$SINTER" green -n 300 --compact-to 0.58 --text -o compacted
    [ "$(value compacted .history[0].summary.method)" = '"affine"' ]
    run -0 cmp <(jq -c .particles compacted) <(jq -c .particles affine)
    "$SINTER" green -n 300 --method soft --mean-overlap 0.03 --density 0.5 --text -o soft
    near "$(value soft .history[0].summary.mean_overlap_ratio)" 0.0285 0.06
    "$SINTER" green -n 300 --distribution lognormal:100nm:1.4:50nm:200nm --text -o lognormal
    [ "$(value lognormal '.particles.radius.data | min >= 25e-9 and max <= 100e-9 and min < 0.8 * max')" = true ]
    "$SINTER" green -n 300 --distribution bimodal:200nm:50nm:0.1 --text -o bimodal
    [ "$(value bimodal '.particles.radius.data | map(select(. > 50e-9)) | length')" = 30 ]
    printf '100nm\n0.12um\n' >diameters
    "$SINTER" green -n 10 --distribution file:diameters --text -o listed
    [ "$(value listed '.particles.radius.data | map(select(. > 55e-9)) | length')" = 5 ]
    "$SINTER" green --distribution file:diameters --text -o as_many
    [ "$(value as_many '.particles.radius.data | length')" = 2 ]
}

@test "green: a material from a file, and options from a config file" {
    echo '{"name":"zirconia","density":6050}' >zirconia.json
    printf 'particles = 7\ndensity = 0.3\n' >options.toml
    "$SINTER" green --config options.toml --material zirconia.json --text -o body
    [ "$(value body .materials[0].density)" = 6050 ]
    [ "$(value body '.particles.radius.data | length')" = 7 ]
    near "$(value body .history[0].summary.relative_density)" 0.3 1e-12
    echo 'partikles = 7' >options.toml
    run -2 "$SINTER" green --config options.toml
}

@test "quantities, single and in lists: the units of an option are in its help, and its errors name it" {
    run -0 "$SINTER" green --help
    assert_output --partial "[m, cm, mm, um, nm]"
    run -2 "$SINTER" green --diameter 5
    assert_output --partial "--diameter: '5' has no unit"
    run -2 "$SINTER" green --aspect 4:1cm:1
    assert_output --partial "--aspect: '1cm' has a unit"
    run -2 "$SINTER" --temperature 1200C --at-time 1h,2
    assert_output --partial "--at-time: '2' has no unit"
    run -2 "$SINTER" --schedule "25C 1200C"
    assert_output --partial "--schedule: '1200C' stands where"
}

@test "green: wrong usage is one sentence and status 2" {
    local words
    for words in "-n 0" "-n -3" "-n many" "--density 0" "--density 0.75" "--method soft --density 1" "--diameter 100" "--diameter 0nm" \
        "--method hard" "--method affine" "--method loose --compact-to 0.6" "--compact-to 0.4" "--aspect 1:2" "--aspect 1:2:0" "--aspect 1:2:3:4" "--swell -0.1" \
        "--mean-overlap 0.1" "--distribution normal:1nm:2" "--distribution lognormal:100nm:0.9" "--distribution lognormal:100:1.4" \
        "--distribution lognormal:100nm:1.2:300nm:400nm" "--distribution bimodal:1nm:2nm:1.5" \
        "--distribution bimodal:1nm:2nm:0.5 --diameter 1nm" "file.dem"; do
        # shellcheck disable=SC2086
        run -2 --separate-stderr "$SINTER" green $words --text
        assert_equal "$output" ""
        assert_equal "${#stderr_lines[@]}" 1
    done
}

@test "green: what cannot be done is one sentence, status 1, and no file" {
    run -1 --separate-stderr "$SINTER" green -n 100 --density 0.73 -o body
    [[ $stderr == *"can be reached"* ]]
    [ ! -e body ]
    run -1 "$SINTER" green --distribution file:missing -o body
    assert_output --partial "missing"
    run -1 "$SINTER" green --material unobtainium -o body
    assert_output --partial "unobtainium"
    [ ! -e body ]
}

@test "green: help has units, defaults and a pipe" {
    run -0 "$SINTER" green --help
    assert_output --partial "[m, cm, mm, um, nm]"
    assert_output --partial "99000"
    assert_output --partial "| sinter"
}

@test "green: progress of -v is JSON lines" {
    run -0 --separate-stderr "$SINTER" green -n 500 -v -o body
    jq -e '.largest_overlap_ratio >= .mean_overlap_ratio' <<<"$stderr" >/dev/null
}
