#!/usr/bin/env bats
# keys.bats: what the helps and manual pages explain is what the programs write.
bats_require_minimum_version 1.5.0
load helper.bash

setup() {
    export ROOT
    cd "$BATS_TEST_TMPDIR"
    export OMP_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=1
}

@test "every key that is written stands in the help of its program, every key that a help explains is written, and jq can say all" {
    run -0 "$PYTHON" "$ROOT/tests/keys.py"
    assert_output --regexp "^[0-9]+ helps explain what is written$"
}

@test "the manual page of analyze has every subcommand, and the pages the keys" {
    "$ROOT/docs/help-to-man.sh" "$ANALYZE" >analyze.1
    for name in $("$ANALYZE" --help | sed -nE '/^Subcommands/,/^$/ s/^  ([a-z]+) {2,}.*/\1/p'); do
        run -0 grep -x ".SH ANALYZE ${name^^}" analyze.1
    done
    run -0 grep -F "unbiased_weibull_modulus" analyze.1
    run -0 bash -c '"$ROOT/docs/help-to-man.sh" "$SINTER" | grep -F engineering_strain'
    run -0 bash -c '"$ROOT/docs/help-to-man.sh" "$BEND" | grep -F bending_strength'
}

@test "engineering strain is that of a dilatometer, and a density has its temperature" {
    "$SINTER" green -q -n 200 --density 0.5 --seed 1 -o green.kiln
    "$SINTER" -q --temperature 1200C --to-density 0.7 --history history.jsonl -o sintered.kiln green.kiln
    length() { "$ANALYZE" info "$1" | jq '.box.vectors[0][0]'; }
    run -0 jq -s '.[-1].engineering_strain[0]' history.jsonl
    near "$output" "$(awk -v a="$(length green.kiln)" -v b="$(length sintered.kiln)" 'BEGIN { printf "%.12g", b / a - 1 }')" 1e-9
    run -0 jq -se 'all(.[]; .engineering_strain[2] > .strain[2] and .strain[2] < 0)' history.jsonl
    run -0 jq -e '.temperature == 1473.15' <("$ANALYZE" density sintered.kiln)
    run -0 jq -e 'has("temperature") and .temperature == null' <("$ANALYZE" density green.kiln)
    run -0 "$ANALYZE" density --table sintered.kiln
    assert_line --index 0 --partial "temperature, K"
}

@test "what bonds cannot hold is said in percent of their volume, with what it does to E" {
    "$SINTER" green -q -n 400 --density 0.5 --distribution lognormal:100nm:1.5 --seed 3 | "$SINTER" -q --temperature 1200C --to-density 0.7 -o wide.kiln
    run -0 --separate-stderr "$BONDIFY" --text wide.kiln
    assert_regex "$stderr" " bonds are clamped to the radius of their smaller particle, and [0-9.]+ % of the volume of all bonds does not fit into them: E is lower by a fifth to a third of that"
    jq -e '.history[-1].summary | .clamped_percent == 100 * .clamped / .pairs and .lost_percent == 100 * .lost_volume / .bond_volume
           and .lost_percent > 5 and .lost_percent < 40' <<<"$output"
    near "$(jq '.history[-1].summary.bond_volume' <<<"$output")" "$(jq '.bonds.volume.data | add' <<<"$output")" 1e-9
    "$ANALYZE" bonds <<<"$output" >bonds.json
    assert_equal "$(jq '.lost_percent' bonds.json)" "$(jq '.history[-1].summary.lost_percent' <<<"$output")"
    run -0 bash -c '"$BONDIFY" -q wide.kiln | "$ANALYZE" bonds --table'
    assert_line --index 0 --regexp "clamped, % +volume lost, %$"
}
