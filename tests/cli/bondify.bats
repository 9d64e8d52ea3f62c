#!/usr/bin/env bats
# bondify.bats: the transition to bonded particles as a program.
bats_require_minimum_version 1.5.0
load helper.bash

setup() { cd "$BATS_TEST_TMPDIR"; }

@test "bondify: two spheres end with radius d/2 and the bond of what they lost" {
    run -0 --separate-stderr "$BONDIFY" --text "$DATA/two_spheres.jsonl"
    near "$(value '.particles.radius.data[0]')" 4.5e-8 1e-14
    near "$(value '.particles.radius.data[1]')" 4.5e-8 1e-14
    near "$(value '.bonds.volume.data[0]')" 2.83790536e-22 1e-8  # 2 (4/3) pi (R^3 - d^3/8)
    assert_equal "$(value '.bonds.pair.data | tostring')" "[0,1]"
    assert_equal "$(value '.history[-1].tool')" bondify
    assert_equal "$(value '.history[-1].summary.bonds')" 1
}

@test "bondify: ids, unknown arrays and unknown keys pass through" {
    run -0 --separate-stderr "$BONDIFY" --text "$DATA/two_spheres.jsonl"
    assert_equal "$(value '.particles.id.data | tostring')" "[17,902]"
    assert_equal "$(value '.particles.charge.data | tostring')" "[1.5,-2.5]"
    assert_equal "$(value '.note')" "centres 90 nm apart"
}

@test "bondify: as many states come out as went in, in their order" {
    "$BONDIFY" -q --text "$DATA/cubic_series.jsonl" >out.jsonl
    assert_equal "$(jq -sc '[.[].time]' out.jsonl)" "[0,100,300]"
    assert_equal "$(jq -sc '[.[].history[-1].summary.pairs]' out.jsonl)" "[0,3,3]"
}

@test "bondify: bonds of a particle with its own images can be read again" {
    "$BONDIFY" -q "$DATA/cubic_series.jsonl" -o bonded.kiln
    run -0 --separate-stderr "$ANALYZE" bonds bonded.kiln
    assert_equal "$(jq -sc '[.[].count]' <<<"$output")" "[0,3,3]"
}

@test "bondify: sweeps come close to the exact result, volume is conserved by both" {
    for method in exact "sweep --decrement 0.01nm"; do
        run -0 --separate-stderr "$BONDIFY" --method $method --text "$DATA/two_spheres.jsonl"
        near "$(value '.bonds.radius.data[0]')" "${first:=$(value '.bonds.radius.data[0]')}" 1e-2
        near "$(value '1 + .history[-1].summary.volume_error')" 1 1e-12
    done
}

@test "bondify: without the caps bonds are thicker" {
    plain=$("$BONDIFY" --text "$DATA/two_spheres.jsonl" | jq '.bonds.radius.data[0]')
    corrected=$("$BONDIFY" --volume cap-corrected --text "$DATA/two_spheres.jsonl" | jq '.bonds.radius.data[0]')
    run -0 jq -n "$corrected > 1.05 * $plain"
    assert_output true
}

@test "bondify: bonds that were there are replaced, with a warning that -q silences" {
    "$BONDIFY" "$DATA/two_spheres.jsonl" -o once.kiln
    run -0 --separate-stderr "$BONDIFY" --text once.kiln
    assert_regex "$stderr" "document 1: the bonds that it had are replaced"
    assert_equal "$(value '.bonds.radius.shape[0]')" 0
    run -0 --separate-stderr "$BONDIFY" -q --text once.kiln
    assert_equal "$stderr" ""
}

@test "bondify: coincident centres are refused with both ids, and no file appears" {
    sed 's/1.9e-7/1e-7/' "$DATA/two_spheres.jsonl" >coincident.jsonl
    run -1 "$BONDIFY" coincident.jsonl -o out.kiln
    assert_output --partial "particles 17 and 902"
    assert [ ! -e out.kiln ]
}

@test "bondify: bonds without room and particles that stop are said" {
    sed -e 's/1.9e-7/1.3e-7/' -e 's/5e-8,5e-8/5e-8,5e-9/' "$DATA/two_spheres.jsonl" >inside.jsonl
    run -0 --separate-stderr "$BONDIFY" --text inside.jsonl
    assert_regex "$stderr" "1 of 1 bonds are clamped"
    assert_regex "$stderr" "1 particles stopped shrinking"
    assert_equal "$(value '.history[-1].summary | [.clamped, .stopped] | tostring')" "[1,1]"
}

@test "bondify --method necks: radii and density stay, every contact has a neck, and the union fills what the mass fills" {
    "$SINTER" green -n 300 --density 0.43 --seed 3 | "$SINTER" --temperature 1200C --to-density 0.5,0.67,0.88 -o sintered.kiln
    "$BONDIFY" --method necks --text sintered.kiln -o necks.jsonl
    for state in 1 2 3; do
        "$ANALYZE" select --index $state --text sintered.kiln >before.jsonl
        "$ANALYZE" select --index $state --text necks.jsonl >after.jsonl
        assert_equal "$(jq -c .particles after.jsonl)" "$(jq -c .particles before.jsonl)"
        for measure in density info; do
            assert_equal "$("$ANALYZE" $measure after.jsonl | jq .relative_density)" "$("$ANALYZE" $measure before.jsonl | jq .relative_density)"
        done
        assert_equal "$("$ANALYZE" density after.jsonl | jq -c '[.coordination_number, .mean_overlap_ratio]')" \
            "$("$ANALYZE" density before.jsonl | jq -c '[.coordination_number, .mean_overlap_ratio]')"
        jq -e '.bonds.volume.data | all(. == 0)' after.jsonl
        jq -e '.bonds.length.data | all(. >= 0)' after.jsonl
        summary=$(jq '.history[-2].summary' after.jsonl)
        near "$(jq .union_fraction <<<"$summary")" "$(jq .solid_fraction <<<"$summary")" 1e-4
        jq -e '.method == "necks" and .necks == "mass" and .neck_factor > 0.9 and .neck_factor < 1.2 and .union_error < 2e-4' <<<"$summary"
    done
}

@test "bondify --method necks --necks law: the law's own necks conserve mass up to 0.71 and lose it above" {
    "$SINTER" green -n 300 --density 0.43 --seed 3 |
        "$SINTER" --temperature 1200C --to-density 0.46,0.5,0.55,0.6,0.67,0.71,0.79,0.88 -o sintered.kiln
    "$BONDIFY" --method necks --necks law --text sintered.kiln | jq -c '.history[-1].summary' >summaries.jsonl
    assert_equal "$(jq -sc 'map(.neck_factor) | unique' summaries.jsonl)" "[1]"
    row=0
    for fraction in 0.460 0.500 0.552 0.603 0.673 0.710 0.777 0.841; do
        found=$(jq -s ".[$row].union_fraction" summaries.jsonl)
        run -0 jq -n "$found - $fraction | fabs < 0.003"
        assert_output true
        row=$((row + 1))
    done
}

@test "bondify --method necks: free bodies and size distributions, the same bytes for any number of threads" {
    "$SINTER" green -n 400 --density 0.43 --distribution lognormal:100nm:1.3 --seed 1 |
        "$SINTER" --temperature 1200C --to-density 0.7 -o sizes.kiln
    "$SINTER" green -n 400 --density 0.43 --seed 1 | "$SINTER" --temperature 1200C --boundary free --to-density 0.6 -o free.kiln
    for threads in 1 4; do
        OMP_NUM_THREADS=$threads "$BONDIFY" --method necks --threads $threads --text sizes.kiln free.kiln >$threads.jsonl
    done
    cmp 1.jsonl 4.jsonl
    jq -se 'length == 2 and (map(.history[-1].summary | (.union_fraction / .solid_fraction - 1) | fabs < 1e-4) | all)' 1.jsonl
}

@test "bondify --method necks: where no factor fills the mass it says so and writes the nearest" {
    sed -e 's/1.9e-7/1.3e-7/' "$DATA/two_spheres.jsonl" >deep.jsonl
    run -0 --separate-stderr "$BONDIFY" --method necks --text deep.jsonl
    assert_regex "$stderr" "document 1: no factor on the necks makes their union with the particles fill"
    jq -e '.history[-1].summary | .neck_factor == 2 and .limited == 1 and .union_fraction < .solid_fraction' <<<"$output"
    run -0 --separate-stderr "$BONDIFY" -q --method necks --text deep.jsonl
    assert_equal "$stderr" ""
}

@test "bondify: the same bytes for any number of threads" {
    "$BONDIFY" -q --threads 1 "$DATA/cubic_series.jsonl" >one.kiln
    "$BONDIFY" -q --threads 4 "$DATA/cubic_series.jsonl" >four.kiln
    cmp one.kiln four.kiln
}

@test "bondify: options out of place are wrong usage" {
    run -2 "$BONDIFY" --decrement 1nm "$DATA/two_spheres.jsonl"
    assert_output --partial "--method sweep"
    run -2 "$BONDIFY" --method sweep --decrement 1 "$DATA/two_spheres.jsonl"
    run -2 "$BONDIFY" --method sweep --decrement 0nm "$DATA/two_spheres.jsonl"
    run -2 "$BONDIFY" --method guess "$DATA/two_spheres.jsonl"
    run -2 "$BONDIFY" --necks law "$DATA/two_spheres.jsonl"
    assert_output --partial "--method necks"
    for option in "--sharing pair" "--volume cylinder" "--decrement 1nm"; do
        run -2 "$BONDIFY" --method necks $option "$DATA/two_spheres.jsonl"
        assert_output --partial "${option%% *}"
    done
    run -0 "$BONDIFY" --help
    assert_output --partial "0.0001nm"
}
