#!/usr/bin/env bats
# ensemble.bats: packings x temperatures by Make and by Snakemake: the same numbers, and means with intervals as written by hand.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    mkdir packings temperatures
    for seed in 1 2; do printf 'particles = 150\nmethod = "affine"\ncompact-to = 0.6\naspect = "4:1:1"\nseed = %s\n' $seed >packings/$seed.toml; done
    for pair in 1100C:0.67 1250C:0.8; do
        printf 'temperature = "%s"\nto-density = "%s"\n' "${pair%:*}" "${pair#*:}" >"temperatures/${pair%:*}.toml"
    done
}

setup() { cd "$BATS_FILE_TMPDIR"; }

ensemble() { make -C "$ROOT/workflows/ensemble" PACKINGS="$PWD/packings" TEMPERATURES="$PWD/temperatures" OUT="$PWD/made" "$@"; }

@test "an ensemble by Make: a mean and an interval for every number and for the fit" {
    run -0 ensemble -j2
    assert_output --partial "Means of 2 packings with their 95 % confidence intervals"
    run -0 jq -c '[length, (map(.case) | unique)]' made/summary.json
    assert_output '[18,["1100C","1250C","fit, knudsen"]]'
    # Two values a and b: mean (a + b)/2, s = |a - b|/sqrt(2), t = 12.7062 for one degree of freedom: the interval reaches 6.3531 |a - b|.
    read -r a b < <(jq -s -r "map(.mean_length) | @tsv" made/[12]/1250C/bonds.json)
    run -0 jq -c '.[] | select(.case == "1250C" and .quantity == "mean bond length")' made/summary.json
    near "$(jq .mean <<<"$output")" "$(awk -v a="$a" -v b="$b" 'BEGIN { print 1e9 * (a + b) / 2 }')" 1e-5
    near "$(jq '.upper - .mean' <<<"$output")" "$(awk -v a="$a" -v b="$b" 'BEGIN { d = a - b; print 6.3531 * 1e9 * (d < 0 ? -d : d) }')" 1e-4
    jq -e '.points | length == 4' made/fit.json
}

@test "the factor of the intervals is Student's" {
    run -0 env PYTHONDONTWRITEBYTECODE=1 "$PYTHON" -c '
import sys
sys.path.insert(0, sys.argv[1])
from ensemble import student_factor
print(*(f"{student_factor(freedom):.3f}" for freedom in (1, 2, 4, 9, 30)))' "$ROOT/workflows/post"
    assert_output "12.706 4.303 2.776 2.262 2.042"
}

@test "a second call makes nothing, a changed case only what depends on it" {
    ensemble SINTER=false BONDIFY=false BEND=false
    cp -rp made packings temperatures "$BATS_TEST_TMPDIR"
    cd "$BATS_TEST_TMPDIR"
    touch temperatures/1250C.toml
    run -2 ensemble SINTER=false
    assert_output --partial "1250C/sintered.kiln] Error 1"
    refute_output --partial "1100C"
    run -2 ensemble PACKINGS="$PWD/none"
    assert_output --partial "there are no case files *.toml in $PWD/none"
}

@test "Snakemake has the same rules and makes the same numbers, on two cores" {
    type -P snakemake >/dev/null || skip "there is no snakemake"
    local options=(-s "$ROOT/workflows/ensemble/Snakefile" --config out="$PWD/snake" packings="$PWD/packings" temperatures="$PWD/temperatures"
        bin="$(dirname "$ANALYZE")")
    run -0 snakemake -n --quiet --profile "$ROOT/workflows/ensemble/slurm" "${options[@]}"
    assert_line --regexp "^sinter +4 "
    assert_line --regexp "^total +32 "
    snakemake -c2 -q all --scheduler greedy "${options[@]}"
    cmp snake/summary.json made/summary.json
    cmp snake/fit.json made/fit.json
}
