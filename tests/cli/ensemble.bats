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
    assert_output --partial "Warning: L/h (span over height) is 3.2, below 4"
    assert_output --partial "Means of 2 packings of alumina with their 95 % confidence intervals"
    run -0 jq -c '[length, (map(.case) | unique)]' made/summary.json
    assert_output '[18,["1100C","1250C","fit, knudsen"]]'
    # Two values a and b: mean (a + b)/2, s = |a - b|/sqrt(2), t = 12.7062 for one degree of freedom: the interval reaches 6.3531 |a - b|.
    read -r a b < <(jq -s -r "map(.mean_length) | @tsv" made/[12]/1250C/bonds.json)
    run -0 jq -c '.[] | select(.case == "1250C" and .quantity == "mean bond length")' made/summary.json
    near "$(jq .mean <<<"$output")" "$(awk -v a="$a" -v b="$b" 'BEGIN { print 1e9 * (a + b) / 2 }')" 1e-5
    near "$(jq '.upper - .mean' <<<"$output")" "$(awk -v a="$a" -v b="$b" 'BEGIN { d = a - b; print 6.3531 * 1e9 * (d < 0 ? -d : d) }')" 1e-4
    jq -e '.points | length == 4' made/fit.json
}

@test "analyze mean: the intervals are Student's, of what all results have, and states are refused" {
    for n in 2 3 5 10 31; do
        seq 1 $n | sed 's/.*/{"format":"test","version":1,"a":&,"b":-1,"name":"x","only":[&]}/' >results.jsonl
        run -0 bash -c '"$ANALYZE" mean results.jsonl | jq -r "[.documents, .mean.a, .mean.b, ((.interval.a[1] - .mean.a) / .standard_error.a), (.mean | length)] | @tsv"'
        read -r documents mean other factor length <<<"$output"
        near "$mean" "$(awk -v n=$n 'BEGIN { print (n + 1) / 2 }')" 1e-14
        assert_equal "$documents $other $length" "$n -1 2"
        near "$factor" "$(case $n in 2) echo 12.7062047;; 3) echo 4.3026527;; 5) echo 2.7764451;; 10) echo 2.2621572;; 31) echo 2.0422725;; esac)" 1e-7
    done
    run -0 bash -c 'head -1 results.jsonl | "$ANALYZE" mean | jq -c "[.mean.a, .standard_deviation.a, .interval.a]"'
    assert_output '[1,null,null]'
    run -0 bash -c 'head -3 results.jsonl | "$ANALYZE" mean --table'
    assert_line --regexp '^ *- +a +3 +2 +-0.48414 +4.4841 +1 +not determined$'
    run -1 "$ANALYZE" mean "$DATA/two_spheres.jsonl"
    assert_output --partial "document 1: is a state, analyze mean reads results"
    run -1 "$ANALYZE" mean /dev/null
    assert_output "analyze mean: /dev/null: holds no document"
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

@test "paths in a case file are those of its folder; packings that differ in more than their seed are no replicates" {
    cd "$BATS_TEST_TMPDIR"
    mkdir packings temperatures
    printf 'Size (nm),Number\n90,10\n110,10\n' >packings/sizes.csv
    printf 'particles = 60\ncompact-to = 0.6\ndistribution = "file:sizes.csv"\nseed = 1\n' >packings/1.toml
    printf 'time (min),temperature (C)\n0,1100\n1,1100\n' >temperatures/furnace.csv
    printf 'schedule = "furnace.csv"\n' >temperatures/log.toml
    ensemble "$PWD/made/1/log/sintered.kiln"
    run -0 jq '.time' <("$ANALYZE" info made/1/log/sintered.kiln)
    assert_output 60
    sed -e 's/seed = 1/seed = 2/' packings/1.toml >packings/2.toml
    ensemble -n >/dev/null
    sed -i 's/0.6/0.61/' packings/2.toml
    run -2 ensemble
    assert_output --partial "differ in more than their seed, so they are no replicates; workflows/study keeps cases apart"
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
