#!/usr/bin/env bats
# conductivity.bats: conduction through the necks of a periodic packing as a program.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    "$SINTER" green -n 300 --density 0.43 --seed 3 |
        "$SINTER" -q --temperature 1200C --to-density 0.5,0.6,0.67,0.71,0.79,0.88,0.93 -o sintered.kiln
    "$BONDIFY" -q --method necks sintered.kiln -o necks.kiln
}

setup() { cd "$BATS_FILE_TMPDIR"; }

@test "one line a state, with the bound beside it, never above it, more the denser" {
    run -0 --separate-stderr "$ANALYZE" conductivity --conductivity 30W/m/K necks.kiln
    assert_equal "${#lines[@]}" 7
    jq -se 'all(.format == "dem-conductivity" and .model == "network" and .solid_conductivity == 30 and .boundary_resistance == 0 and
                .converged and .residual <= 1e-8 and .iterations > 0 and (.tensor | length == 3) and .rattlers >= 0 and
                (.conductivity - ([.tensor[0][0], .tensor[1][1], .tensor[2][2]] | add / 3) | fabs) < 1e-9 and
                (.bound - 60 * .relative_density / (3 - .relative_density) | fabs) < 1e-9 and
                .conductivity < .bound and (.at_bound | not))
            and (map(.conductivity) | . == sort)' <<<"$output"
}

@test "what voxels of the same packing conduct, within 5 % where they resolve its necks" {
    # --model voxel, a minute of it.
    run -0 --separate-stderr "$ANALYZE" conductivity --conductivity 1W/m/K necks.kiln
    row=1
    for found in 0.2742 0.3777 0.4505 0.5872 0.7590; do
        near "$(jq -s ".[$row].conductivity" <<<"$output")" "$found" 0.05
        row=$((row + 1))
    done
}

@test "grain boundaries resist, and rule where they resist most" {
    of() { "$ANALYZE" conductivity --conductivity 30W/m/K --boundary-resistance "$1" necks.kiln | jq -s '.[3].conductivity'; }
    plain=$(of 0m2K/W) some=$(of 1e-8m2K/W) most=$(of 1e-2m2K/W) twice=$(of 2e-2m2K/W)
    run -0 jq -n "$plain > 1.05 * $some and $some > 1000 * $most"
    assert_output true
    near "$twice" "$(jq -n "$most / 2")" 1e-4
}

@test "a table, and the same bytes for any number of threads" {
    run -0 --separate-stderr "$ANALYZE" conductivity --conductivity 30W/m/K --table necks.kiln
    assert_equal "${#lines[@]}" 8
    assert_regex "${lines[0]}" "relative density.*conductivity, W/\(m K\).*upper bound"
    for threads in 1 4; do
        OMP_NUM_THREADS=$threads "$ANALYZE" conductivity --conductivity 30W/m/K --threads $threads necks.kiln >$threads.json
    done
    cmp 1.json 4.json
}

@test "bodies with free faces, states without bonds, units and bounds are refused" {
    run -1 --separate-stderr "$ANALYZE" conductivity --conductivity 30W/m/K sintered.kiln
    assert_regex "$stderr" "document 1: the state has no bonds; run bondify first"
    "$SINTER" green -n 100 --density 0.43 | "$SINTER" -q --temperature 1200C --boundary free --to-density 0.6 |
        "$BONDIFY" -q --method necks -o free.kiln
    run -1 --separate-stderr "$ANALYZE" conductivity --conductivity 30W/m/K free.kiln
    assert_regex "$stderr" "document 1: the box is not periodic along all axes"
    run -2 "$ANALYZE" conductivity necks.kiln
    assert_output --partial "--conductivity"
    run -2 "$ANALYZE" conductivity --conductivity 30 necks.kiln
    assert_output --partial "has no unit"
    run -2 "$ANALYZE" conductivity --conductivity 0W/m/K necks.kiln
    run -2 "$ANALYZE" conductivity --conductivity 30W/m/K --boundary-resistance -1m2K/W necks.kiln
    run -2 "$ANALYZE" conductivity --conductivity 30W/m/K --model guess necks.kiln
}
