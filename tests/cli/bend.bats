# bend.bats: the command line contract of bend and analyze elastic.
bats_require_minimum_version 1.5.0
load helper

setup_file() {
    load helper
    export BAR="$BATS_FILE_TMPDIR/bar.kiln" TWO="$BATS_FILE_TMPDIR/two.kiln"
    "$SINTER" green -n 800 --diameter 100nm --density 0.58 --compact-to 0.75 --aspect 5:1:1 --seed 3 | "$BONDIFY" -q -o "$BAR"
    cat "$BAR" "$BAR" >"$TWO"
}

# lattice NX NY NZ: a text state of touching spheres 100 nm apart with a bond of 50 nm between neighbours; the box is not periodic.
lattice() {
    "$PYTHON" - "$@" <<'PROGRAM'
import json, sys
n = [int(word) for word in sys.argv[1:4]]
places = [(x, y, z) for x in range(n[0]) for y in range(n[1]) for z in range(n[2])]
row = {place: i for i, place in enumerate(places)}
pairs = [[row[p], row[q]] for p in places for k in range(3) if (q := tuple(c + (a == k) for a, c in enumerate(p))) in row]
flat = lambda rows: [value for each in rows for value in each]
array = lambda kind, data, *shape: {"type": kind, "shape": list(shape), "data": data}
N, M = len(places), len(pairs)
print(json.dumps({
    "format": "dem-state", "version": 1, "units": "SI",
    "box": {"origin": [0, 0, 0], "vectors": [[n[0] * 1e-7, 0, 0], [0, n[1] * 1e-7, 0], [0, 0, n[2] * 1e-7]], "periodic": [False] * 3},
    "materials": [{"name": "alumina", "young_modulus": 4e11, "poisson_ratio": 0.23}],
    "particles": {"position": array("f8", [1e-7 * (c + 0.5) for c in flat(places)], N, 3), "radius": array("f8", [5e-8] * N, N)},
    "bonds": {"pair": array("i4", flat(pairs), M, 2), "radius": array("f8", [2.5e-8] * M, M), "length": array("f8", [1.34e-8] * M, M)}}))
PROGRAM
}

@test "a result has the keys of the format, one line a state" {
    run -0 --separate-stderr "$BEND" --cycles 2 --points 4 "$TWO"
    assert_equal "${#lines[@]}" 2
    assert_equal "${lines[0]}" "${lines[1]}"
    jq -e '.format == "dem-bend" and .version == 1 and .method == "static" and .bond_law == "series" and .young_modulus == 4e11
           and .poisson_ratio == 0.23 and .dropped_bonds > 0 and .rattlers >= 0 and .fragments >= 0 and .residual <= 1e-6
           and .iterations > 0 and .energy.error < 0.01 and (.curve | .deflection, .punch, .force | length == 17)
           and (.history | length) == 3 and .history[2].tool == "bend"' <<<"${lines[0]}"
    near "$(jq .span <<<"${lines[0]}")" "$(jq '0.8 * .length' <<<"${lines[0]}")" 1e-12
    near "$(jq '.curve.deflection | max' <<<"${lines[0]}")" "$(jq '.height / 1000' <<<"${lines[0]}")" 1e-5
    near "$(jq .relative_density <<<"${lines[0]}")" 0.75 1e-6
}

@test "--max-force is the greatest force, and unloading ends at zero" {
    run -0 --separate-stderr "$BEND" --max-force 200nN --span 1.2um --punch-radius 0.5um "$BAR"
    near "$(jq '.curve.force | max' <<<"$output")" 2e-7 1e-12
    near "$(jq .span <<<"$output")" 1.2e-6 1e-12
    near "$(jq .punch_radius <<<"$output")" 5e-7 1e-12
    assert_equal "$(jq -c '.curve | [.force[-1], .deflection[-1]]' <<<"$output")" "[0,0]"
}

@test "--method dynamic: the same document with its energies and steps; its options need it" {
    lattice 14 3 3 >"$BATS_TEST_TMPDIR/lattice.json"
    jq -c '.materials[0].density = 3950' "$BATS_TEST_TMPDIR/lattice.json" >"$BATS_TEST_TMPDIR/heavy.json"
    run -0 --separate-stderr "$BEND" --method dynamic --cycles 1 --punch-velocity 0.05m/s --damping 0.5 "$BATS_TEST_TMPDIR/heavy.json"
    jq -e '.method == "dynamic" and .punch_velocity == 0.05 and .damping == 0.5 and .mass_scaling == 1 and .steps > 1000 and .time_step > 0
           and .energy.damping > 0 and .energy.work > 0 and .energy.error < 0.01 and .bonds == 285' <<<"$output"
    run -0 bash -c '"$ANALYZE" modulus <<<"$1" | jq -e ".method == \"dynamic\""' - "$output"
    run -1 "$BEND" --method dynamic "$BATS_TEST_TMPDIR/lattice.json"
    assert_output --partial "has no density"
    run -2 "$BEND" --punch-velocity 1m/s "$BAR"
    assert_output --partial "needs --method dynamic"
    run -2 "$BEND" --method dynamic --punch-velocity 1 "$BAR"
    assert_output --partial "has no unit"
    run -2 "$BEND" --method dynamic --damping 1 "$BAR"
}

@test "necks: auto takes the law solid, bonds of Eq. 2-4 the law series, and results say which and keep the density of the mass" {
    cd "$BATS_TEST_TMPDIR"
    "$SINTER" green -n 300 --density 0.43 --aspect 4:1:1 --seed 3 | "$SINTER" --temperature 1200C --to-density 0.67 -o sintered.kiln
    "$BONDIFY" --method necks sintered.kiln -o necks.kiln
    "$BONDIFY" sintered.kiln -o bonds.kiln
    for tool in "$BEND --cycles 1" "$ANALYZE elastic"; do
        run -0 --separate-stderr $tool necks.kiln
        jq -e '.bond_law == "solid" and .bond_shear == null and (.relative_density - 0.67 | fabs) < 1e-6' <<<"$output"
        solid=$output
        run -0 --separate-stderr $tool --bond-law solid necks.kiln
        assert_equal "$(jq -c '[.young_modulus, .curve, .stiffness]' <<<"$output")" "$(jq -c '[.young_modulus, .curve, .stiffness]' <<<"$solid")"
        run -0 --separate-stderr $tool --bond-law series --bond-shear timoshenko necks.kiln
        jq -e '.bond_law == "series" and .bond_shear == "timoshenko"' <<<"$output"
        run -0 --separate-stderr $tool bonds.kiln
        jq -e '.bond_law == "series" and .bond_shear == "section" and (.relative_density - 0.67 | fabs) < 1e-6' <<<"$output"
        run -1 --separate-stderr $tool --bond-shear section necks.kiln
        assert_regex "$stderr" "document 1: the bonds are necks, and the law solid for them has a shear of its own"
        run -2 --separate-stderr $tool --bond-law solid --bond-shear section necks.kiln
        assert_regex "$stderr" "bond-shear: has no meaning with --bond-law solid"
    done
    # A deformed bar of necks is one of necks again.
    "$BEND" --cycles 1 --states bent.kiln necks.kiln -o bent.json
    run -0 --separate-stderr "$BEND" --cycles 1 bent.kiln
    jq -e '.bond_law == "solid"' <<<"$output"
    run -0 --separate-stderr "$BEND" --cycles 1 --method dynamic necks.kiln
    jq -e '.bond_law == "solid" and .energy.error < 0.01' <<<"$output"
}

@test "--friction: less is stored than the punch works, the supports thrust, and unloading does not retrace loading" {
    run -0 --separate-stderr "$BEND" --friction 0.3 --cycles 1 --points 12 "$BAR"
    jq -e '.method == "static" and .friction == 0.3 and .energy.friction > 0 and .energy.error < 0.01 and .horizontal_reaction > 0
           and .converged and .curve.punch[13] > 1.001 * .curve.punch[11]' <<<"$output"
    run -0 --separate-stderr "$BEND" --cycles 1 "$BAR"
    jq -e '.friction == 0 and .energy.friction == 0 and .horizontal_reaction == 0 and .curve.punch[7] == .curve.punch[5]' <<<"$output"
    run -2 "$BEND" --friction -0.1 "$BAR"
}

@test "a strength of the bonds: the bar is loaded until it fails, and --states shows what broke" {
    run -0 --separate-stderr "$BEND" --tensile-strength 500MPa --shear-strength 1GPa --states "$BATS_TEST_TMPDIR/broken.kiln" --text "$BAR"
    jq -e '.strength | .bending_strength >= .first_break and .breaks > 1 and .tensile_strength == 5e8 and .until == 0.1' <<<"$output"
    jq -e '.energy | .work > .bonds + .contacts and .dissipated > 0 and .error < 0.02' <<<"$output"
    jq -e .converged <<<"$output"
    near "$(jq .strength.bending_strength <<<"$output")" "$(jq '1.5 * .strength.peak_force * .span / (.width * .height * .height)' <<<"$output")" 1e-12
    near "$(jq .strength.peak_force <<<"$output")" "$(jq '.curve.force | max' <<<"$output")" 1e-12
    assert_equal "$(jq '.bonds.broken.data | max' "$BATS_TEST_TMPDIR/broken.kiln")" "$(jq .strength.breaks <<<"$output")"
    run -2 "$BEND" --tensile-strength 500 "$BAR"
    assert_output --partial "has no unit"
    run -2 "$BEND" --tensile-strength 500MPa --method dynamic "$BAR"
    run -2 "$BEND" --tensile-strength 500MPa --cycles 2 "$BAR"
    assert_output --partial "no meaning"
    run -2 "$BEND" --tensile-strength 500MPa --friction 0.1 "$BAR"
    assert_output --partial "rollers"
    run -2 "$BEND" --until 0.5 "$BAR"
    assert_output --partial "needs --tensile-strength, --shear-strength or --calibrate-to"
}

@test "neck is stiffer than series, series than centre" {
    for law in neck series centre; do
        "$BEND" --bond-law $law --max-deflection 0.1nm "$BAR" | jq '.curve.force | max'
    done >"$BATS_TEST_TMPDIR/forces"
    run -0 sort -g -r -c "$BATS_TEST_TMPDIR/forces"
}

@test "the same bytes for any number of threads" {
    "$BEND" --threads 1 --states "$BATS_TEST_TMPDIR/one.kiln" "$BAR" -o "$BATS_TEST_TMPDIR/one.json"
    "$BEND" --threads 3 --states "$BATS_TEST_TMPDIR/three.kiln" "$BAR" -o "$BATS_TEST_TMPDIR/three.json"
    sed -i 's/"--states","[^"]*"//' "$BATS_TEST_TMPDIR"/*.json
    run -0 cmp "$BATS_TEST_TMPDIR/one.json" "$BATS_TEST_TMPDIR/three.json"
}

@test "--states is a state with the forces in its bonds, which other tools read" {
    "$BEND" --states "$BATS_TEST_TMPDIR/bent.kiln" --text "$BAR" -o "$BATS_TEST_TMPDIR/result.json"
    run -0 jq -e '.bonds as $b | ($b.pair.shape[0]) as $m | $b.force.shape == [$m, 3] and $b.moment.shape == [$m, 3]
                  and $b.normal_force.shape == [$m] and .particles.displacement.shape == .particles.position.shape' "$BATS_TEST_TMPDIR/bent.kiln"
    run -0 "$ANALYZE" bonds "$BATS_TEST_TMPDIR/bent.kiln"
}

@test "the bent bar feeds analyze modulus" {
    run -0 bash -c '"$BEND" "$BAR" | "$ANALYZE" modulus | jq -e ".young_modulus > 2e10 and .young_modulus < 4e11"'
}

@test "analyze elastic: a tensor per state, below its affine bound" {
    run -0 --separate-stderr "$ANALYZE" elastic "$TWO"
    assert_equal "${#lines[@]}" 2
    jq -e '.format == "dem-elastic" and .bond_law == "series" and (.stiffness | length == 6) and .young_modulus < .affine_young_modulus
           and .young_modulus > 5e10 and .poisson_ratio > 0 and .poisson_ratio < 0.4 and .anisotropy >= 0' <<<"${lines[0]}"
    run -1 bash -c '"$0" elastic < <("$1")' "$ANALYZE" false
}

@test "a state without bonds, a span too long, cylinders that meet nothing: one sentence, status 1, no output" {
    lattice 20 3 3 >"$BATS_TEST_TMPDIR/lattice.json"
    run -1 bash -c '"$SINTER" green -n 50 --density 0.4 | "$BEND" -o "$1"' - "$BATS_TEST_TMPDIR/none.json"
    assert_output --partial "run bondify first"
    assert [ ! -e "$BATS_TEST_TMPDIR/none.json" ]
    run -1 "$BEND" --span 2um "$BATS_TEST_TMPDIR/lattice.json"
    assert_output --partial "not shorter than the bar"
    run -1 "$BEND" --punch-radius 1nm --span 1.5um "$BATS_TEST_TMPDIR/lattice.json"
    assert_output --partial "touches no particle"
}

@test "a bar in two pieces is refused" {
    # Nine particles in a slice: the bonds from the thirteenth slice to the next one get no radius.
    lattice 20 3 3 | jq -c '.bonds |= (.pair.data as $p | .radius.data |= [range(length) as $i |
        if ($p[2 * $i] / 9 | floor) == 12 and $p[2 * $i + 1] - $p[2 * $i] == 9 then 0 else .[$i] end])' >"$BATS_TEST_TMPDIR/cut.json"
    run -1 "$BEND" "$BATS_TEST_TMPDIR/cut.json"
    assert_output --partial "the bar is in pieces"
}

@test "wrong usage: units, contradictions, bounds" {
    run -2 "$BEND" --span 8 "$BAR"
    assert_output --partial "has no unit"
    run -2 "$BEND" --span 8N "$BAR"
    run -2 "$BEND" --span -1um "$BAR"
    assert_output --partial "greater than zero"
    run -2 "$BEND" --max-force 1uN --max-deflection 1nm "$BAR"
    run -2 "$BEND" --bond-law glue "$BAR"
    run -2 "$BEND" --cycles 0 "$BAR"
    run -2 --separate-stderr "$BEND" --text "$BAR"
    assert_equal "$stderr" "bend: --text: needs --states; what is written without it is text always; see bend --help"
    run -2 --separate-stderr "$BEND" --method dynamic --tolerance 1e-7 "$BAR"
    assert_equal "$stderr" "bend: --tolerance: has no meaning with --method dynamic; see bend --help"
    run -0 "$BEND" --help
    assert_output --partial "analyze modulus"
}

@test "a punch so fast that the bar leaves a support is one sentence" {
    run -1 --separate-stderr "$BEND" --method dynamic --punch-velocity 100m/s --cycles 1 "$BAR"
    assert_output ''
    assert_regex "$stderr" "punch-velocity.* is too fast"
}

@test "-q: no warnings, whatever they are about" {
    run -0 --separate-stderr "$BEND" --cycles 1 "$DATA/bend/dynamic_slope.kiln"
    assert_regex "$stderr" "document 1: the bar rolls by 0.3"
    jq -e '.roll > 0.3' <<<"$output"
    run -3 --separate-stderr "$BEND" --cycles 1 --tolerance 1e-14 "$BAR"
    assert_regex "$stderr" "unbalanced"
    for options in "--cycles 1 $DATA/bend/dynamic_slope.kiln" "--cycles 1 --tolerance 1e-14 $BAR"; do
        "$BEND" -q $options >"$BATS_TEST_TMPDIR/result.json" 2>"$BATS_TEST_TMPDIR/words" || true
        assert [ -s "$BATS_TEST_TMPDIR/result.json" ]
        assert [ ! -s "$BATS_TEST_TMPDIR/words" ]
    done
}

@test "friction keeps tolerances down to 1e-12, and finer ones are refused" {
    run -0 --separate-stderr "$BEND" -q --friction 0.3 --cycles 1 --tolerance 1e-12 "$DATA/bend/friction_nonfinite.kiln"
    jq -e '.converged and .residual <= 1e-12 and .energy.error < 0.02' <<<"$output"
    run -2 "$BEND" --friction 0.3 --tolerance 1e-13 "$BAR"
    assert_output --partial "at least 1e-12 with --friction"
}

@test "bars that lost their balance of energy or their curve: both are there" {
    run -0 --separate-stderr "$BEND" --tensile-strength 300MPa "$DATA/bend/strength_energy_small.kiln"
    jq -e '.energy | .work > 0 and .error < 5e-3' <<<"$output"
    run -0 --separate-stderr "$BEND" -q --shear-strength 4445.34MPa "$DATA/bend/no_punch_force.kiln"
    jq -e '.strength.breaks > 5 and (.curve.force | length) == .strength.breaks + 2 and .energy.error < 5e-3' <<<"$output"
}

@test "a bar that friction wedges on one support has its curve, and a warning" {
    "$SINTER" green -q -n 31 --density 0.5 --method affine --compact-to 0.625 --aspect 4.53:1:1 --seed 513636 | "$BONDIFY" -q -o "$BATS_TEST_TMPDIR/wedged.kiln"
    run -0 --separate-stderr "$BEND" --cycles 1 --bond-law neck --friction 0.3 "$BATS_TEST_TMPDIR/wedged.kiln"
    assert_regex "$stderr" "lies on one support only"
    jq -e '.effective_span == .span and (.curve.force | length) == 13' <<<"$output"
}

@test "short bars: a warning below L/h 4 that stays in every result, a refusal below 2 unless it is asked for" {
    cd "$BATS_TEST_TMPDIR"
    for aspect in 1 4 6; do
        "$SINTER" green -q -n 200 --density 0.43 --method affine --compact-to 0.7 --aspect $aspect:1:1 --seed 2 | "$BONDIFY" -q -o $aspect.kiln
    done
    run -1 --separate-stderr "$BEND" --cycles 1 1.kiln
    assert_output ""
    assert_regex "$stderr" "^bend: 1.kiln, document 1: L/h .span over height. is 0.8: below 2 it is a block.*--aspect 6:1:1.*--allow-block$"
    run -0 --separate-stderr "$BEND" --cycles 1 --allow-block 1.kiln
    echo "$output" >block.json
    run -0 --separate-stderr "$ANALYZE" modulus block.json # it was asked for
    assert_equal "$stderr" ""
    jq -e '(.warnings[0] | startswith("L/h (span over height) is 0.8, below 4")) and (.slenderness * 10 | round == 8)' <<<"$output"
    run -0 --separate-stderr "$BEND" --cycles 1 4.kiln
    assert_regex "$stderr" "warning: 4.kiln, document 1: L/h .* is 3.2, below 4: shear is 22 %.*factor 1.29"
    jq -e '(.warnings | length) == 1 and (.slenderness * 10 | round == 32)' <<<"$output"
    echo "$output" >short.json
    run -0 --separate-stderr "$ANALYZE" modulus short.json # said once
    assert_equal "$stderr" ""
    jq -e '.warnings | length == 1' <<<"$output"
    run -0 --separate-stderr "$ANALYZE" fit --law gibson-ashby <<<"$output"
    jq -e '.warnings | length == 1 and (.[0] | contains("below 4"))' <<<"$output"
    run -0 --separate-stderr "$ANALYZE" modulus --table short.json
    assert_regex "$output" " L/h .*[^0-9]3[.][12]"
    run -1 --separate-stderr "$ANALYZE" modulus --height 2um short.json
    assert_regex "$stderr" "short.json, document 1: L/h .*below 2"
    run -0 --separate-stderr "$BEND" --cycles 1 6.kiln
    assert_equal "$stderr" ""
    jq -e '.warnings == [] and .slenderness > 4.5' <<<"$output"
    # Strengths come from a beam formula too.
    run -0 --separate-stderr bash -c '"$0" -q --tensile-strength 500MPa 4.kiln | "$1" strength -q' "$BEND" "$ANALYZE"
    jq -e '.warnings[0] | contains("below 4")' <<<"$output"
}

@test "--calibrate-to: the bonds get the strength with which the bar breaks as the measured one, and with it it does" {
    cd "$BATS_TEST_TMPDIR"
    run -0 --separate-stderr "$BEND" --calibrate-to 60MPa "$BAR"
    jq -e '.converged and (.strength | .calibrated_to == 6e7 and .tests >= 1 and .breaks >= 1 and .shear_strength == null
           and .tensile_strength > 6e7 and (.bending_strength / 6e7 - 1 | fabs) <= 2e-3)' <<<"$output"
    strength=$(jq .strength.tensile_strength <<<"$output")
    run -0 --separate-stderr "$BEND" --tensile-strength "${strength}Pa" "$BAR"
    near "$(jq .strength.bending_strength <<<"$output")" 6e7 2e-3
    jq -e '.strength | .calibrated_to == null and .tests == 1' <<<"$output"
    run -2 --separate-stderr "$BEND" --calibrate-to 60MPa --tensile-strength 1GPa "$BAR"
    run -2 --separate-stderr "$BEND" --calibrate-to 60 "$BAR"
    assert_regex "$stderr" "has no unit"
    run -2 --separate-stderr "$BEND" --calibrate-to 60MPa --method dynamic "$BAR"
    run -2 --separate-stderr "$BEND" --calibrate-to 0MPa "$BAR"
    assert_regex "$stderr" "greater than zero"
}
