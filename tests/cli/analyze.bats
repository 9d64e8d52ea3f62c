#!/usr/bin/env bats
# analyze.bats: the numbers that analyze reports, and how it refuses.
bats_require_minimum_version 1.5.0
load helper.bash

setup() { cd "$BATS_TEST_TMPDIR"; }

# A dem-modulus document: relative density, modulus, standard error.
modulus_line() {
    printf '{"format":"dem-modulus","version":1,"young_modulus":%s,"standard_error":%s,"relative_density":%s}\n' "$2" "$3" "$1"
}

@test "analyze: help lists the subcommands, an unknown one is wrong usage" {
    run -0 "$ANALYZE" --help
    for name in info density bonds select modulus fit; do
        assert_output --partial "$name"
    done
    run -2 "$ANALYZE" densty
    assert_output --partial "there is no subcommand 'densty'"
    run -2 "$ANALYZE"
    for name in info density bonds select modulus fit; do
        run -0 "$ANALYZE" "$name" --help
        assert_output --partial "Examples:"
    done
}

@test "analyze info: a document a line, arrays as they came, other kinds too" {
    run -0 "$ANALYZE" info "$DATA/two_spheres.jsonl" "$DATA/bending_test.jsonl"
    assert_equal "${#lines[@]}" 2
    assert_equal "$(jq -r .kind <<<"${lines[0]}")" dem-state
    assert_equal "$(jq -c '[.particles, .bonds, .arrays.particles.charge.shape]' <<<"${lines[0]}")" "[2,null,[2]]"
    assert_equal "$(jq -r .kind <<<"${lines[1]}")" dem-bend
}

@test "analyze density: a cubic packing has its closed form" {
    run -0 "$ANALYZE" density "$DATA/cubic_series.jsonl"
    near "$(jq .relative_density <<<"${lines[0]}")" 0.5235987756 1e-9
    near "$(jq .relative_density <<<"${lines[2]}")" 0.7182424906 1e-9
    near "$(jq .mean_overlap_ratio <<<"${lines[2]}")" 0.1 1e-9
    keys='[.measure, .particles, .coordination_number, .largest_cluster_fraction]'
    assert_equal "$(jq -c "$keys" <<<"${lines[2]}")" '["box",1,6,1]'
}

@test "analyze density: bonds count as solid" {
    "$BONDIFY" -q "$DATA/cubic_series.jsonl" -o bonded.kiln
    run -0 "$ANALYZE" density bonded.kiln
    near "$(jq .relative_density <<<"${lines[2]}")" 0.7182424906 1e-9
    assert_equal "$(jq .coordination_number <<<"${lines[2]}")" 6
}

@test "analyze density: a body too small for an inside says so, a large free one is measured inside" {
    run -0 "$ANALYZE" density "$DATA/two_spheres.jsonl"
    assert_equal "$(value '[.measure, .relative_density] | tostring')" '["none",null]'
    jq -nc '[range(10) as $x | range(10) as $y | range(10) as $z | $x, $y, $z] as $p |
        {box: {vectors: [[99,0,0],[0,99,0],[0,0,99]], periodic: [false,false,false]},
         particles: {position: {type: "f8", shape: [1000,3], data: $p},
                     radius: {type: "f8", shape: [1000], data: [range(1000) | 0.5]}}}' >cube.jsonl
    run -0 "$ANALYZE" density cube.jsonl
    assert_equal "$(value .measure)" inner
    near "$(value .relative_density)" 0.782 0.01  # 8^3 centres in 7^3 cells of density pi/6: counted by centres, faces included
}

@test "analyze bonds: counts, means and a histogram that holds every bond" {
    "$BONDIFY" -q "$DATA/cubic_series.jsonl" -o bonded.kiln
    run -0 "$ANALYZE" bonds --bins 4 bonded.kiln
    assert_equal "$(jq -c '[.count, .mean_diameter, .particles]' <<<"${lines[0]}")" "[0,null,1]"
    assert_equal "$(jq -c '[.count, (.histogram.counts | add), (.histogram.edges | length)]' <<<"${lines[2]}")" "[3,3,5]"
    run -0 jq -s '.[2] | .mean_diameter / 2 / .histogram.edges[4]' <<<"$output"
    near "$output" 1 1e-9
    run -1 "$ANALYZE" bonds "$DATA/cubic_series.jsonl"
    assert_output --partial "document 1: has no bonds"
}

@test "analyze: a table for people has units" {
    "$BONDIFY" -q "$DATA/two_spheres.jsonl" -o bonded.kiln
    run -0 "$ANALYZE" bonds --table bonded.kiln
    assert_line --index 0 --partial "mean diameter, nm"
    assert_equal "${#lines[@]}" 2
}

@test "analyze select: nearest by density, time and place, in the order asked" {
    run -0 --separate-stderr "$ANALYZE" select --density 0.72,0.61,0.72 --text "$DATA/cubic_series.jsonl"
    assert_equal "$(jq -sc '[.[].time]' <<<"$output")" "[300,100,300]"
    run -0 --separate-stderr "$ANALYZE" select --time 2min --text "$DATA/cubic_series.jsonl"
    assert_equal "$(value .time)" 100
    assert_equal "$(value '.history[-1].summary.wanted')" 120
    run -0 --separate-stderr "$ANALYZE" select --index 1 --text "$DATA/cubic_series.jsonl"
    assert_equal "$(value .time)" 0
    assert_equal "$(value '.history[-1].arguments | tostring')" '["--index","1"]'
}

@test "analyze select: far from the wanted density is said, a place beyond the end is refused" {
    run -0 --separate-stderr "$ANALYZE" select --density 0.9 --text "$DATA/cubic_series.jsonl"
    assert_regex "$stderr" "nearest to density 0.9"
    run -1 "$ANALYZE" select --index 4 "$DATA/cubic_series.jsonl"
    assert_output --partial "the stream has 3"
    run -2 "$ANALYZE" select "$DATA/cubic_series.jsonl"
    run -2 "$ANALYZE" select --index 1 --density 0.9 "$DATA/cubic_series.jsonl"
    run -2 "$ANALYZE" select --time 5 "$DATA/cubic_series.jsonl"
}

@test "analyze modulus: a straight unloading has its closed form, loading does not matter" {
    run -0 "$ANALYZE" modulus "$DATA/bending_test.jsonl"
    # S = 1e6 N/m; L^3/(4 b h^3) = 62500; bracket 1 + 2.4 * 1.25 * 0.01 = 1.03
    near "$(value .slope)" 1e6 1e-9
    near "$(value .shear_correction)" 1.03 1e-12
    near "$(value .young_modulus)" 6.4375e10 1e-9
    assert_equal "$(value '[.points, .relative_density, .bond_law, .method] | tostring')" '[4,0.7,"series","static"]'
}

@test "analyze modulus: a document need not have Poisson's ratio, which only the shear correction requires" {
    jq -c 'del(.poisson_ratio)' "$DATA/bending_test.jsonl" >published.jsonl
    run -0 "$ANALYZE" modulus --poisson-ratio 0.25 published.jsonl
    near "$(value .young_modulus)" 6.4375e10 1e-9
    run -0 "$ANALYZE" modulus --shear none published.jsonl
    near "$(value .young_modulus)" 6.25e10 1e-9
    assert_equal "$(value .shear_correction)" 1
    run -1 "$ANALYZE" modulus published.jsonl
    assert_output --partial "document 1: has no poisson_ratio, which the shear correction requires; give --poisson-ratio"
}

@test "analyze modulus: the window, too few points, and no unloading" {
    run -0 "$ANALYZE" modulus --window 1/2:1/3 "$DATA/bending_test.jsonl"
    assert_equal "$(value '[.points, .standard_error] | tostring')" '[2,null]'
    run -1 "$ANALYZE" modulus --window 0.6:0.55 "$DATA/bending_test.jsonl"
    assert_output --partial "document 1: the last unloading has 0 points"
    run -2 "$ANALYZE" modulus --window 1/3:5/6 "$DATA/bending_test.jsonl"
    run -2 --separate-stderr "$ANALYZE" modulus --shear none --poisson-ratio 0.2 "$DATA/bending_test.jsonl"
    assert_equal "$stderr" "analyze modulus: --poisson-ratio: has no meaning with --shear none; see analyze modulus --help"
    jq -c '.curve |= map_values(.[:4])' "$DATA/bending_test.jsonl" >loading.jsonl
    run -1 "$ANALYZE" modulus loading.jsonl
    assert_output --partial "document 1: the curve has no unloading"
    jq -c 'del(.span)' "$DATA/bending_test.jsonl" >short.jsonl
    run -1 "$ANALYZE" modulus short.jsonl
    assert_output --partial "document 1: has no span"
    jq -c '.curve.force[2] = "much"' "$DATA/bending_test.jsonl" >word.jsonl
    run -1 "$ANALYZE" modulus word.jsonl
    assert_output --partial "curve.force, row 2"
}

@test "analyze fit: Knudsen's law through its own points" {
    for density in 1.0 0.9 0.75; do
        modulus_line $density "$(awk -v d=$density 'BEGIN { printf "%.12g", 4e11 * exp(-3.95 * (1 - d)) }')" null
    done >tests.jsonl
    run -0 --separate-stderr "$ANALYZE" fit tests.jsonl
    near "$(value '.["E0"]')" 4e11 1e-9
    near "$(value .b)" 3.95 1e-9
    assert_equal "$(value '[.law, .weighting, .degrees_of_freedom, (.points | length)] | tostring')" '["knudsen","equal",1,3]'
    run -0 "$ANALYZE" fit --table tests.jsonl
    assert_line --index 0 --partial "E0, GPa"
}

@test "analyze fit: weights are the errors, unless one is missing or they are those of rounding" {
    { modulus_line 0.9 2.7e11 1e9; modulus_line 0.8 1.9e11 2e9; modulus_line 0.7 1.2e11 1e9; } >errors.jsonl
    { cat errors.jsonl; modulus_line 0.65 1e11 null; } >missing.jsonl
    { cat errors.jsonl; modulus_line 0.65 1e11 10; } >rounding.jsonl
    for pair in "errors|standard errors" "missing|equal" "rounding|equal"; do
        run -0 --separate-stderr "$ANALYZE" fit "${pair%|*}.jsonl"
        assert_equal "$(value .weighting)" "${pair#*|}"
    done
    run -0 --separate-stderr "$ANALYZE" fit --weights equal errors.jsonl
    assert_equal "$(value .weighting)" equal
    run -1 "$ANALYZE" fit --weights errors missing.jsonl
    assert_output --partial "point 4 has no standard error"
}

@test "analyze fit: as many points as parameters give no errors and a warning, fewer are refused" {
    { modulus_line 0.9 2.7e11 1e9; modulus_line 0.8 1.9e11 2e9; } >two.jsonl
    run -0 --separate-stderr "$ANALYZE" fit two.jsonl
    assert_equal "$(value '[.standard_errors.b, .covariance] | tostring')" '[null,null]'
    assert_equal "$stderr" "analyze fit: warning: knudsen: as many points as parameters, so the standard errors are unknown"
    run -0 --separate-stderr "$ANALYZE" fit --law all two.jsonl
    assert_equal "${stderr_lines[0]}" "analyze fit: warning: knudsen, power, pabst, linear: as many points as parameters, so the standard errors are unknown"
    assert_equal "${#stderr_lines[@]}" 2
    head -1 two.jsonl >one.jsonl
    run -1 "$ANALYZE" fit one.jsonl
    assert_output --partial "only 1 point"
}

@test "analyze fit: laws are ranked only where the points are enough, and what the points do not tell is said" {
    # Knudsen's law with a scatter of its own: four points cannot tell a law of two parameters from one of one.
    for pair in 0.67:111.3 0.71:130.1 0.79:178.2 0.88:255.9; do modulus_line "${pair%:*}" "${pair#*:}e9" null; done >four.jsonl
    run -0 --separate-stderr "$ANALYZE" fit --law all four.jsonl
    assert_equal "$stderr" "analyze fit: warning: the laws are not ranked: by AICc a law of 2 parameters takes 5 points or more to be compared, and there are 4 (knudsen, power, pabst, linear)"
    jq -se 'all(.rank == null and .aicc_difference == null)' <<<"$output"
    assert_equal "$(jq -sc 'map(.law)' <<<"$output")" '["knudsen","coble-kingery","gibson-ashby","power","pabst","linear"]'
    for density in 0.5 0.6 0.7 0.8 0.9 0.95; do
        modulus_line $density "$(awk -v d=$density 'BEGIN { printf "%.12g", 4e11 * exp(-3.95 * (1 - d)) * (1 + 0.004 * sin(100 * d)) }')" null
    done >six.jsonl
    run -0 --separate-stderr "$ANALYZE" fit --law all six.jsonl
    assert_equal "$stderr" ""
    assert_equal "$(jq -sc 'map(.rank)' <<<"$output")" '[1,2,3,4,5,6]'
    jq -se 'map(.aicc) as $a | all(.[]; .aicc_difference == .aicc - $a[0]) and .[0].law == "knudsen" and .[0].not_determined == []' <<<"$output"
    # Three densities much alike: E0 is far from them, and its interval says nothing.
    for pair in 0.60:60 0.61:67 0.62:61; do modulus_line "${pair%:*}" "${pair#*:}e9" null; done >alike.jsonl
    run -0 --separate-stderr "$ANALYZE" fit alike.jsonl
    jq -e '.not_determined == ["E0", "b"] and (.dense_modulus_interval | .[1] - .[0] > 1e12) and .dense_modulus_error > 0' <<<"$output"
    run -0 --separate-stderr "$ANALYZE" fit --table alike.jsonl
    assert_equal "$(grep -o "not determined" <<<"$output" | wc -l)" 2
    run -0 --separate-stderr bash -c 'for x in 1 9; do echo "{\"format\":\"x\",\"a\":$x,\"b\":5.$x,\"material\":\"ice\"}"; done | "$ANALYZE" mean --table'
    assert_regex "${lines[1]}" "ice +a .* not determined$"
    assert_regex "${lines[2]}" "ice +b .* -$"
    run -0 --separate-stderr bash -c 'for x in 1 2; do echo "{\"format\":\"x\",\"a\":10$x,\"b\":$x}"; done | "$ANALYZE" mean'
    jq -e '.not_determined == ["b"] and (.interval.b | length == 2) and .material == null' <<<"$output"
}

@test "every table shows the material, and a test where its Poisson's ratio is from" {
    echo '{"name":"spinel","young_modulus":2.7e11,"poisson_ratio":0.26,"density":3580,"surface_energy":1.0}' >spinel.json
    "$SINTER" green -q -n 300 --method affine --compact-to 0.62 --aspect 6:1:1 --material spinel.json --seed 1 -o green.kiln
    "$BONDIFY" -q green.kiln -o bonded.kiln
    "$BEND" -q --cycles 1 bonded.kiln -o bend.json
    "$BEND" -q --tensile-strength 500MPa bonded.kiln -o broken.json
    "$ANALYZE" modulus bend.json >modulus.json
    jq -e '.material == "spinel" and .poisson_ratio == 0.26 and .poisson_ratio_source == "material spinel"' bend.json
    jq -e '.material == "spinel" and .poisson_ratio == 0.26 and .poisson_ratio_source == "material spinel" and .standard_error == null
           and .confidence_interval == null' modulus.json
    run -0 --separate-stderr "$ANALYZE" modulus --poisson-ratio 0.3 bend.json
    jq -e '.poisson_ratio == 0.3 and .poisson_ratio_source == "--poisson-ratio"' <<<"$output"
    while read -r subcommand input; do
        run -0 --separate-stderr "$ANALYZE" $subcommand --table -q $input
        assert_regex "${lines[0]}" "(^| )material( |$)"
        assert_regex "${lines[1]}" "(^| )spinel( |$)"
    done <<'END'
info bonded.kiln
density green.kiln
bonds bonded.kiln
elastic bonded.kiln
elastic --model voxel --voxels 2 bonded.kiln
conductivity --conductivity 30W/m/K bonded.kiln
conductivity --conductivity 30W/m/K --model voxel --voxels 2 bonded.kiln
modulus bend.json
strength broken.json
fit --law gibson-ashby modulus.json
mean modulus.json
END
    # No curve of alumina over another solid.
    run -0 --separate-stderr "$ANALYZE" fit --law gibson-ashby modulus.json
    jq -e '.material == "spinel" and .references == [] and .points[0].test == "bending"' <<<"$output"
    run -0 --separate-stderr "$ANALYZE" fit --law gibson-ashby <("$ANALYZE" elastic bonded.kiln)
    jq -e '.points[0].test == "cell"' <<<"$output"
    jq -c '.material = "alumina"' modulus.json >alumina.json
    run -0 --separate-stderr "$ANALYZE" fit --law gibson-ashby alumina.json
    jq -e '.references | length == 3' <<<"$output"
    run -0 --separate-stderr "$ANALYZE" fit --law gibson-ashby alumina.json modulus.json
    jq -e '.references == []' <<<"$output"
    assert_equal "$stderr" "analyze fit: warning: the points are not all of one material (alumina, spinel)"
}

@test "analyze fit, modulus: the wrong kind of document is named" {
    { modulus_line 0.9 2.7e11 1e9; cat "$DATA/two_spheres.jsonl"; } >mixed.jsonl
    run -1 "$ANALYZE" fit mixed.jsonl
    assert_output --partial "mixed.jsonl, document 2: is dem-state, fit reads dem-modulus"
    run -1 "$ANALYZE" modulus "$DATA/two_spheres.jsonl"
    assert_output --partial "document 1: is dem-state, modulus reads dem-bend"
}

@test "elastic: a modulus above what any isotropic body of that density has is said, in the result too" {
    "$SINTER" green -q -n 60 --diameter 2um --material copper --method affine --density 0.45 --compact-to 0.58 -o green.kiln
    "$SINTER" -q --temperature 600C --to-density 0.8,0.98 -o sintered.kiln green.kiln
    "$BONDIFY" -q --method necks -o necks.kiln sintered.kiln
    run -0 --separate-stderr "$ANALYZE" elastic necks.kiln
    [[ "$stderr" == *"document 2: E of "*" GPa is above 122"*"Hashin & Shtrikman"* ]]
    assert_equal "$(jq -c '[.bound > .young_modulus, (.warnings | length)]' <<<"$output")" $'[true,0]\n[false,1]'
}
