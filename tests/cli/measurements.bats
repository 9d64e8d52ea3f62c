#!/usr/bin/env bats
# measurements.bats: curves and moduli of experiments, as laboratories write them, through analyze modulus and analyze fit.
bats_require_minimum_version 1.5.0
load helper.bash

setup() { cd "$BATS_TEST_TMPDIR"; }

# A bar of 4 mm x 3 mm on a span of 30 mm: S = 1e6 N/m, L^3/(4 b h^3) = 62500, bracket 1 + 2.4 * 1.25 * 0.01 = 1.03 for nu = 0.25.
SIZE=(--span 30mm --width 4mm --height 3mm --poisson-ratio 0.25)

unloading() { # force in N against deflection in mm, loaded to 60 N and back
    awk 'BEGIN { print "deflection (mm),force (N)"
        for (i = 0; i <= 120; ++i) { x = i <= 60 ? i : 120 - i; printf "%.4f,%.6f\n", x / 1000, x } }'
}

@test "analyze modulus: a file in millimetres and newtons" {
    unloading >bar.csv
    run -0 "$ANALYZE" modulus "${SIZE[@]}" --density 0.79 bar.csv
    near "$(value .slope)" 1e6 1e-9
    near "$(value .young_modulus)" 6.4375e10 1e-9
    assert_equal "$(value '[.points, .relative_density, .method, .source] | tostring')" '[31,0.79,"experiment","bar.csv"]'
    run -0 "$ANALYZE" modulus --shear none "${SIZE[@]::6}" bar.csv
    near "$(value .young_modulus)" 6.25e10 1e-9
    assert_equal "$(value '[.shear_correction, .relative_density] | tostring')" "[1,null]"
}

@test "analyze modulus: micrometres, kilonewtons, semicolons and decimal commas are the same curve" {
    unloading >bar.csv
    awk -F , 'NR == 1 { print "\xef\xbb\xbf# bar 7\nKraft [kN];\"Durchbiegung / \xc2\xb5m\"" }
        NR > 1 { line = sprintf("%.9f;%.4f", $2 / 1000, $1 * 1000); gsub(/\./, ",", line); print line "\r" }' bar.csv >german.csv
    run -0 "$ANALYZE" modulus "${SIZE[@]}" german.csv
    near "$(value .young_modulus)" 6.4375e10 1e-6
}

@test "analyze modulus: the compliance of the machine is taken off" {
    unloading | awk -F , 'NR == 1 { print; next } { printf "%.6f,%s\n", $1 + 0.0005 * $2, $2 }' >soft.csv
    run -0 "$ANALYZE" modulus "${SIZE[@]}" --compliance 0.5um/N soft.csv
    near "$(value .young_modulus)" 6.4375e10 1e-6
    run -0 "$ANALYZE" modulus "${SIZE[@]}" soft.csv
    near "$(value .young_modulus)" 4.291667e10 1e-6 # 1/S is 1.5 um/N
    run -1 "$ANALYZE" modulus "${SIZE[@]}" --compliance 2um/N soft.csv
    assert_output --partial "soft.csv: the force does not grow with the deflection in the last unloading, less --compliance"
}

# A stated 95 % interval holds the modulus in 95 of 100 cases on the average. The count of 100 seeds scatters by 2.2 about that, so 1000 are
# taken, whose share scatters by 0.7 %, and it must lie within three times that.
@test "analyze modulus: noisy curves of known modulus are recovered within the stated 95 % interval in 95 of 100 seeds" {
    unloading >bar.csv
    "$PYTHON" - <<'END'
import random
heading, *rows = open("bar.csv").read().splitlines()
for seed in range(1000):
    random.seed(seed)
    noisy = [(x, float(force) + random.gauss(0, 0.5)) for x, force in (row.split(",") for row in rows)]
    open(f"bar-{seed}.csv", "w").write("\n".join([heading] + [f"{x},{force:.6f}" for x, force in noisy]) + "\n")
END
    run -0 bash -c '"$ANALYZE" modulus "$@" bar-*.csv | jq -s "[.[].confidence_interval | select(.[0] < 6.4375e10 and 6.4375e10 < .[1])] | length"' - "${SIZE[@]}"
    (( output >= 929 && output <= 971 )) || fail "$output of 1000"
}

@test "analyze modulus: what is wrong with a file is said" {
    unloading >bar.csv
    run -1 "$ANALYZE" modulus --width 4mm --height 3mm bar.csv
    assert_output --partial "bar.csv: --span is needed with a CSV"
    sed 's/ (mm)//' bar.csv >unit.csv
    run -1 "$ANALYZE" modulus "${SIZE[@]}" unit.csv
    assert_output --partial "unit.csv: column 'deflection' has no unit; known here: m, cm, mm, um, nm"
    sed 's/(N)/(mm)/' bar.csv >kind.csv
    run -1 "$ANALYZE" modulus "${SIZE[@]}" kind.csv
    assert_output --partial "kind.csv: column 'force (mm)' has the unit 'mm'; known here: N,"
    sed '4s/,.*/,much/' bar.csv >word.csv
    run -1 "$ANALYZE" modulus "${SIZE[@]}" word.csv
    assert_output --partial "word.csv, line 4: 'much' is not a number"
    sed '4s/,.*//' bar.csv >short.csv
    run -1 "$ANALYZE" modulus "${SIZE[@]}" short.csv
    assert_output --partial "short.csv, line 4: has 1 column, the heading has 2"
    run -1 "$ANALYZE" modulus "${SIZE[@]}" none.csv
    assert_output --partial "none.csv: cannot be opened"
    run -2 "$ANALYZE" modulus --span 30 bar.csv
    run -2 "$ANALYZE" modulus --span 0mm bar.csv
}

measured() { # moduli of Knudsen's law, with errors of 1 %
    awk 'BEGIN { print "relative_density,young_modulus (GPa),standard_error (GPa)"
        for (i = 0; i < 8; ++i) { p = 0.05 * (i + 1); e = 410 * exp(-3.95 * p); printf "%.2f,%.6f,%.6f\n", 1 - p, e, e / 100 } }'
}

@test "analyze fit: a table of measurements is fitted, with intervals and a band" {
    measured >measured.csv
    run -0 "$ANALYZE" fit measured.csv
    near "$(value '.["E0"]')" 4.1e11 1e-6
    near "$(value .b)" 3.95 1e-6
    assert_equal "$(value '[.weighting, (.points | length), (.band.relative_density | length)] | tostring')" '["standard errors",8,41]'
    jq -e '.band | [.young_modulus, .confidence, .prediction] | transpose | all(.[2][0] <= .[1][0] and .[1][0] <= .[0] and .[0] <= .[1][1])' <<<"$output"
    jq -e '.confidence_intervals.b | .[0] < 3.95 and 3.95 < .[1]' <<<"$output"
    near "$(value '.references[0].young_modulus[-1]')" 4.1e11 1e-12
}

@test "analyze fit: laws are compared, the best first, and measurements lie beside" {
    measured >measured.csv
    run -0 "$ANALYZE" fit --law all --data measured.csv measured.csv
    assert_equal "$(jq -r .law <<<"${lines[0]}")" knudsen
    assert_equal "$(jq -sc 'map(.aicc) | . == sort' <<<"$output")" true
    assert_equal "${#lines[@]}" 6
    jq -e '.data.rms_deviation < 1e-6' <<<"${lines[0]}"
    deviation=$(jq .data.rms_deviation <<<"${lines[5]}")
    run -0 "$ANALYZE" fit --law all --data measured.csv --table measured.csv
    assert_line --index 0 --regexp "rms deviation of data$"
    near "$(awk '{ print $NF }' <<<"${lines[6]}")" "$deviation" 0.01
    run -0 "$ANALYZE" fit --law power,pabst --table measured.csv
    assert_line --index 0 --partial "Pc"
    run -2 "$ANALYZE" fit --law knutsen measured.csv
    assert_output --partial "there is no law 'knutsen', only knudsen, spriggs"
    sed '3s/0.90/1.2/' measured.csv >dense.csv
    run -1 "$ANALYZE" fit dense.csv
    assert_output --partial "dense.csv, row 2: the porosity is -0.1999"
}
