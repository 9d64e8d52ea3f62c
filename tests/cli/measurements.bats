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
    assert_output --partial "bar.csv: --span is needed with a table"
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

# All files of tests/data/machines are the same bar of 203.3 GPa, 1350 N/mm, on a span of 40 mm, as machines of several makers export it.
BAR=(--span 40mm --width 4mm --height 3mm)

@test "analyze modulus: exports of machines: reports, rows of units, Weg and Kraft, decimal commas, Latin-1, trailing separators" {
    for file in control instron zwick kraft_weg trailing; do
        run -0 --separate-stderr "$ANALYZE" modulus "${BAR[@]}" "$ROOT/tests/data/machines/$file.csv"
        near "$(value .young_modulus)" 2.03321e11 1e-5
        assert_equal "$(value '[.points, .branch, .turned, .source] | tostring')" "[4,\"unloading\",[],\"$file.csv\"]"
    done
    assert_equal "$(value .columns.force)" "force (N)"
    run -0 "$ANALYZE" modulus "${BAR[@]}" "$ROOT/tests/data/machines/zwick.csv"
    assert_equal "$(value '.columns | tostring')" '{"force":"Standardkraft (N)","deflection":"Verformung (mm)"}'
}

@test "analyze modulus: UTF-16, sep=, tabs, .txt, and files that are no text" {
    local zwick=$ROOT/tests/data/machines/zwick.csv
    iconv -f latin1 -t utf16 "$zwick" >utf16.csv
    { printf 'sep=;\r\n'; cat "$zwick"; } >sep.csv
    tr ';' '\t' <"$zwick" >tabs.txt
    sed 's/^s;N;mm/s;mN;\xb5m/' "$zwick" | awk -F ';' -v OFS=';' 'NR > 2 { $2 = $2 * 1000 ",0"; gsub(",", ".", $3); $3 = sprintf("%.3f", $3 * 1000); gsub("[.]", ",", $3) } 1' >small.csv
    for file in utf16.csv sep.csv tabs.txt small.csv; do
        run -0 "$ANALYZE" modulus "${BAR[@]}" "$file"
        near "$(value .young_modulus)" 2.03321e11 1e-4
    done
    gzip <"$zwick" >zwick.csv.gz
    for line in "zwick.csv.gz|is compressed (gzip); unpack it first" "book.csv|is a workbook or an archive (zip), no text"; do
        printf 'PK\003\004\024' >book.csv
        run -1 "$ANALYZE" modulus "${BAR[@]}" "${line%%|*}"
        assert_output --partial "${line%%|*}: ${line#*|}"
        assert_equal "${#lines[@]}" 1
    done
}

@test "analyze modulus: compression counted negative, and positions that fall, are turned and named" {
    cp "$ROOT/tests/data/machines/negative.csv" both.csv
    awk -F , -v OFS=, 'NR > 1 { $2 = -$2 } 1' both.csv >deflection.csv
    awk -F , -v OFS=, 'NR > 1 { $1 = 0 - $1 } 1' both.csv >force.csv
    awk -F , -v OFS=, 'NR > 1 { $1 = sprintf("%.6f", 120 + $1) } 1' both.csv >position.csv
    for line in "both|force and deflection" "deflection|deflection" "force|force" "position|force and deflection"; do
        run -0 --separate-stderr "$ANALYZE" modulus "${BAR[@]}" "${line%|*}.csv"
        near "$(value .young_modulus)" 2.03321e11 1e-5
        assert_equal "$(value '.turned | join(" and ")')" "${line#*|}"
        assert_equal "$stderr" "analyze modulus: warning: ${line%|*}.csv: compression counts negative: the sign of ${line#*|} is turned"
        run -0 --separate-stderr "$ANALYZE" modulus -q "${BAR[@]}" "${line%|*}.csv"
        assert_equal "$stderr" ""
    done
}

@test "analyze modulus: what is not clear is refused with the headings and the options that choose" {
    run -1 "$ANALYZE" modulus "${BAR[@]}" "$ROOT/tests/data/machines/thousands.csv"
    assert_output --partial "thousands.csv, line 3: '10,000' has a comma and '0.000' in line 2 a point"
    awk -F , -v OFS=, 'NR == 1 { print "Gauge 1 (mm),Gauge 2 (mm),Cell (N)"; next } { print 2 * $1, $1, $2 }' "$ROOT/tests/data/machines/control.csv" >two.csv
    run -1 "$ANALYZE" modulus "${BAR[@]}" two.csv
    assert_output --partial "two.csv: has no column 'force'; its headings are 'Gauge 1 (mm)', 'Gauge 2 (mm)', 'Cell (N)', of which --force-column may name one"
    run -1 "$ANALYZE" modulus "${BAR[@]}" --force-column Cell two.csv
    assert_output --partial "has no column 'deflection'; its headings are 'Gauge 1 (mm)', 'Gauge 2 (mm)', 'Cell (N)', of which --deflection-column may name one"
    run -0 "$ANALYZE" modulus "${BAR[@]}" --force-column cell --deflection-column "Gauge 2 (mm)" two.csv
    near "$(value .young_modulus)" 2.03321e11 1e-5
    assert_equal "$(value .columns.deflection)" "Gauge 2 (mm)"
    sed '1s/Gauge ./Weg/g;1s/Cell/Kraft/' two.csv >twice.csv
    run -1 "$ANALYZE" modulus "${BAR[@]}" twice.csv
    assert_output --partial "twice.csv: the column 'Weg (mm)' stands twice; choose by --deflection-column"
}

@test "analyze modulus: a fracture ends the test, and --branch loading takes the rise before it" {
    for file in fracture_return loading_only; do
        run -1 "$ANALYZE" modulus "${BAR[@]}" "$ROOT/tests/data/machines/$file.csv"
        assert_output --partial "$file.csv: the curve has no unloading before the bar breaks; --branch loading takes the slope of its rise"
        run -0 "$ANALYZE" modulus "${BAR[@]}" --branch loading "$ROOT/tests/data/machines/$file.csv"
        near "$(value .young_modulus)" 2.0332e11 1e-4
        assert_equal "$(value .branch)" loading
    done
    { cat "$ROOT/tests/data/machines/control.csv"; tail -n +2 "$ROOT/tests/data/machines/fracture_return.csv"; } >cycle.csv
    run -0 "$ANALYZE" modulus "${BAR[@]}" cycle.csv
    near "$(value .young_modulus)" 2.03321e11 1e-5
}

@test "analyze modulus: a line that does not fit its points is refused" {
    local control=$ROOT/tests/data/machines/control.csv
    sed '9s/50/32/;10s/40/45/;11s/30/22/;12s/20/30/' "$control" >scattered.csv
    run -1 "$ANALYZE" modulus "${BAR[@]}" scattered.csv
    assert_output --regexp "scattered.csv: a straight line explains only [0-9]+ % of how the force varies in the last unloading; give another --window"
    run -1 "$ANALYZE" modulus "${BAR[@]}" --window 0.9:0.75 "$control"
    assert_output --partial "control.csv: the last unloading has 1 points in the window of forces, expected three or more; give a wider --window"
}

@test "analyze modulus: --plot shows the curve, the points of the fit and its line" {
    run -0 "$ANALYZE" modulus "${BAR[@]}" --plot bar.svg "$ROOT/tests/data/machines/control.csv"
    "$PYTHON" -c 'import sys, xml.dom.minidom; xml.dom.minidom.parse("bar.svg")'
    run -0 grep -c '<circle' bar.svg
    assert_output 5 # four points and that of the legend
    run -0 cat bar.svg
    assert_output --partial "control.csv: last unloading, E = 203.3 GPa"
    assert_output --partial "Deflection, um"
    run -1 "$ANALYZE" modulus "${BAR[@]}" --plot bar.svg "$ROOT/tests/data/machines/control.csv" "$ROOT/tests/data/machines/zwick.csv"
    assert_output --partial "zwick.csv: --plot shows one test, and this is the second"
    run -2 "$ANALYZE" modulus "${BAR[@]}" --plot one.svg -o one.svg "$ROOT/tests/data/machines/control.csv"
}

# A bar that breaks at 60 N without an unloading: 1350 N/mm and 100 MPa, 3 F L/(2 b h^2), as a German machine exports it.
fracture() {
    awk 'BEGIN { srand(7); print "Pr\xfcfer;M\xfcller\nVorkraft;2,0;N\n\nPr\xfcfzeit;Standardkraft;Verformung\ns;N;mm"
        for (i = 0; i <= 240; ++i) {
            f = i <= 200 ? 0.3 * i : 0.4; x = (i <= 200 ? f / 1350 : 60 / 1350 * (1 + 0.05 * (i - 200) / 40)) + 2e-5 * (rand() - 0.5)
            line = sprintf("%.2f;%.3f;%.6f", i / 10, f + 0.05 * (rand() - 0.5), x); gsub(/[.]/, ",", line); print line "\r" } }'
}

@test "analyze modulus, strength: a fracture test with decimal commas and a row of units gives back modulus and strength within 1 %" {
    fracture >bar.csv
    run -0 --separate-stderr "$ANALYZE" modulus "${BAR[@]}" --branch loading bar.csv
    near "$(value .young_modulus)" 2.03321e11 0.01
    run -0 --separate-stderr "$ANALYZE" strength "${BAR[@]}" bar.csv
    near "$(value .mean_strength)" 100e6 0.01
    assert_equal "$(value '[.bars, .weibull_modulus, .strengths[0].columns.force, .strengths[0].fall_recorded] | tostring')" '[1,null,"Standardkraft (N)",true]'
    assert_equal "$stderr" "analyze strength: warning: Weibull's parameters need 5 bars or more, these are 1"
    run -0 "$ANALYZE" strength "${BAR[@]}" --inner-span 20mm -q bar.csv
    near "$(value .mean_strength)" 50e6 0.01
}

@test "analyze strength: a bar that was unloaded did not break; a record that ends under load is said" {
    run -1 "$ANALYZE" strength "${BAR[@]}" "$ROOT/tests/data/machines/control.csv"
    assert_output --partial "control.csv: the bar was unloaded and did not break"
    head -8 "$ROOT/tests/data/machines/control.csv" >ends.csv
    run -0 --separate-stderr "$ANALYZE" strength "${BAR[@]}" ends.csv
    near "$(value .mean_strength)" 100e6 1e-9
    assert_equal "$(value '.strengths[0].fall_recorded')" false
    assert_equal "${stderr_lines[0]}" "analyze strength: warning: ends.csv: the record ends under load; the bar is taken to break at its largest force"
    run -1 "$ANALYZE" strength --span 40mm --width 4mm ends.csv
    assert_output --partial "ends.csv: --height is needed with a table"
    run -2 "$ANALYZE" strength "${BAR[@]}" --inner-span 40mm ends.csv
    assert_output --partial "--inner-span: is not shorter than --span"
}

@test "analyze strength: tables with a row for each bar, by strength or by force and sizes" {
    # Strengths at the quantiles (i - 0.5)/10 of m = 10, s0 = 400 MPa.
    awk 'BEGIN { print "sample;Biegefestigkeit [N/mm\xb2]"
        for (i = 1; i <= 10; ++i) { line = sprintf("B%d;%.6f", i, 400 * (-log(1 - (i - 0.5) / 10)) ^ 0.1); sub(/[.]/, ",", line); print line } }' >strengths.csv
    awk -F ';' 'NR == 1 { print "force (N),width (mm),height (mm)"; next } { sub(/,/, ".", $2); b = 3.9 + 0.02 * NR; h = 3.1 - 0.01 * NR
        printf "%.6f,%.2f,%.2f\n", $2 * 2 * b * h * h / 3 / 40, b, h }' strengths.csv >bars.csv
    run -0 "$ANALYZE" strength strengths.csv
    whole=$output
    near "$(value .characteristic_strength)" 399.97e6 1e-3
    assert_equal "$(value '[.bars, .strengths[3].source] | tostring')" '[10,"strengths.csv, line 5"]'
    jq -e '.confidence_intervals | .weibull_modulus[0] < 10 and 10 < .weibull_modulus[1] and .characteristic_strength[0] < 4e8 and 4e8 < .characteristic_strength[1]' <<<"$output"
    jq -e '(.unbiased_weibull_modulus / .weibull_modulus - .unbiasing_factor | fabs < 1e-12) and (.unbiasing_factor - 0.859 | fabs < 0.006)' <<<"$output"
    run -0 "$ANALYZE" strength --span 40mm bars.csv
    for key in .weibull_modulus .characteristic_strength; do near "$(value $key)" "$(jq $key <<<"$whole")" 1e-5; done
    run -0 "$ANALYZE" strength --table strengths.csv
    assert_line --index 0 --regexp "bars  mean strength, MPa .* Weibull modulus .* characteristic strength, MPa"
    run -1 "$ANALYZE" strength bars.csv
    assert_output --partial "bars.csv: --span is needed with a table"
}

@test "analyze strength: --plot shows the bars on Weibull's axes" {
    printf 'strength (MPa)\n310\n350\n372\n390\n405\n430\n' >strengths.csv
    run -0 "$ANALYZE" strength --plot weibull.svg strengths.csv
    "$PYTHON" -c 'import xml.dom.minidom; xml.dom.minidom.parse("weibull.svg")'
    run -0 grep -c '<circle' weibull.svg
    assert_output 7 # six bars and that of the legend
    head -4 strengths.csv >three.csv
    run -1 "$ANALYZE" strength -q --plot weibull.svg three.csv
    assert_output "analyze strength: --plot needs 5 bars or more"
}

@test "analyze strength: simulated bars count by what bend found, others are refused" {
    broken() { jq -c --argjson force "$1" '.strength = {peak_force: $force, breaks: 4} | .span = 0.04 | .width = 0.004 | .height = 0.003' "$DATA/bending_test.jsonl"; }
    for force in 50 54 57 60 62 66; do broken $force; done >bars.jsonl
    run -0 "$ANALYZE" strength bars.jsonl
    near "$(value .strengths[3].strength)" 100e6 1e-9
    near "$(value .mean_strength)" 96.944444e6 1e-6
    run -1 "$ANALYZE" strength "$DATA/bending_test.jsonl"
    assert_output --partial "document 1: was not bent until it broke, as bend --tensile-strength does"
    run -1 "$ANALYZE" strength --inner-span 10mm bars.jsonl
    assert_output --partial "document 1: is a test with one point of load, for which --inner-span has no meaning"
    run -1 "$ANALYZE" strength --force-column Kraft bars.jsonl
    assert_output --partial "document 1: is no table, for which --force-column has no meaning"
}

@test "exports of machines in 200 forms, whole and spoilt: the right value, or a refusal in one sentence" {
    export PYTHONDONTWRITEBYTECODE=1
    run -0 "$PYTHON" "$ROOT/tests/fuzz/mutate_tables.py" --count 200 --keep "$BATS_TEST_TMPDIR"
    assert_output --regexp "^200 tables: [0-9]+ whole and right, [0-9]+ spoilt and right, [0-9]+ spoilt and refused, 0 faults$"
}

@test "analyze fit: tables as laboratories keep them: percent, semicolons, E-modulus, names of samples" {
    printf 'porosity,young_modulus (GPa)\n0.002,400\n0.004,396\n0.006,393\n0.009,388\n' >fraction.csv
    printf 'porosity (%%),young_modulus (GPa)\n0.2,400\n0.4,396\n0.6,393\n0.9,388\n' >percent.csv
    printf 'Sample;Porosit\xe4t [%%];E-Modul [kN/mm\xb2]\nA1;0,2;400\nA2;0,4;396\nB1;0,6;393\nB2;0,9;388\n' >german.csv
    printf 'relative_density;E [GPa]\n0,998;400\n0,996;396\n0,994;393\n0,991;388\n' >density.csv
    for file in fraction percent german density; do
        run -0 "$ANALYZE" fit $file.csv
        near "$(value .b)" 4.29780544 1e-6
        near "$(jq .dense_modulus <<<"$output")" 4.0322188e11 1e-6
    done
    jq -e '.dense_modulus == .["E0"] and .dense_modulus_error == .standard_errors["E0"] and .dense_modulus_interval == .confidence_intervals["E0"]' <<<"$output"
}

@test "analyze fit: another unit than percent, and a strength, are refused" {
    printf 'density (g/cm3),young_modulus (GPa)\n0.7,200\n0.8,300\n' >density.csv
    run -1 "$ANALYZE" fit density.csv
    assert_output --partial "density.csv: column 'density (g/cm3)' has the unit 'g/cm3'; known here: %, percent"
    printf 'porosity,modulus of rupture (MPa)\n0.21,200\n0.15,240\n0.1,300\n' >rupture.csv
    run -1 "$ANALYZE" fit rupture.csv
    assert_output --partial "rupture.csv: has no column 'young_modulus'; its headings are 'porosity', 'modulus of rupture (MPa)'"
    printf 'porosity,young_modulus (GPa)\n21,200\n15,240\n10,300\n' >bare.csv
    run -1 "$ANALYZE" fit bare.csv
    assert_output --partial "bare.csv, line 2: the porosity is 21.0, expected 0 or more and less than 1; a heading such as 'porosity (%)'"
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
    jq -e '.material == null and .references == [] and .points[0].test == "measured"' <<<"$output" # nothing says that it is alumina
    run -0 "$ANALYZE" fit --material alumina measured.csv
    near "$(value '.references[0].young_modulus[-1]')" 4.1e11 1e-12
    assert_equal "$(value .material)" alumina
}

@test "analyze fit: laws are compared, the best first, and measurements lie beside" {
    measured >measured.csv
    run -0 "$ANALYZE" fit --law all --data measured.csv measured.csv
    assert_equal "$(jq -r .law <<<"${lines[0]}")" knudsen
    assert_equal "$(jq -sc 'map(.aicc) | . == sort' <<<"$output")" true
    assert_equal "${#lines[@]}" 6
    jq -e '.data | .relative_rms_deviation < 1e-6 and .rms_deviation < 4e5' <<<"${lines[0]}"
    deviation=$(jq '100 * .data.relative_rms_deviation' <<<"${lines[5]}")
    run -0 "$ANALYZE" fit --law all --data measured.csv --table measured.csv
    assert_line --index 0 --regexp "rms deviation of data, [GM]Pa +the same, %$"
    near "$(awk '{ print $NF }' <<<"${lines[6]}")" "$deviation" 0.01
    run -0 "$ANALYZE" fit --law power,pabst --table measured.csv
    assert_line --index 0 --partial "Pc"
    run -2 "$ANALYZE" fit --law knutsen measured.csv
    assert_output --partial "there is no law 'knutsen', only knudsen, spriggs"
    sed '3s/0.90/1.2/' measured.csv >dense.csv
    run -1 "$ANALYZE" fit dense.csv
    assert_output --partial "dense.csv, line 3: the porosity is -0.1999"
}

@test "analyze modulus and strength: short bars of a laboratory are warned of, and blocks refused" {
    unloading >bar.csv
    run -0 --separate-stderr "$ANALYZE" modulus --span 10mm --width 4mm --height 3mm bar.csv
    assert_regex "$stderr" "warning: bar.csv: L/h .span over height. is 3.3, below 4: shear is 21 %"
    jq -e '(.warnings | length) == 1' <<<"$output"
    run -0 --separate-stderr "$ANALYZE" modulus --shear none --span 10mm --width 4mm --height 3mm bar.csv
    assert_regex "$stderr" "E has no factor"
    run -1 --separate-stderr "$ANALYZE" modulus --span 5mm --width 4mm --height 3mm bar.csv
    assert_regex "$stderr" "bar.csv: L/h .span over height. is 1.7: below 2 it is a block"
    run -0 --separate-stderr "$ANALYZE" modulus -q --allow-block --span 5mm --width 4mm --height 3mm bar.csv
    assert_equal "$stderr" ""
    run -0 --separate-stderr "$ANALYZE" modulus "${SIZE[@]}" bar.csv
    assert_equal "$stderr" ""
    jq -e '.warnings == [] and (.slenderness - 10 | fabs < 1e-9)' <<<"$output"
    printf 'force (N),width (mm),height (mm)\n90,4,3\n104,4,12\n' >bars.csv
    run -0 --separate-stderr "$ANALYZE" strength -q --span 40mm bars.csv
    jq -e '.warnings | length == 1 and (.[0] | contains("the strength lies above"))' <<<"$output"
    run -1 --separate-stderr "$ANALYZE" strength --span 20mm bars.csv
    assert_regex "$stderr" "below 2 it is a block"
}

@test "analyze modulus, strength: --material names what a table is of; its Poisson's ratio enters, and the result says where it is from" {
    unloading >bar.csv
    echo '{"name":"zirconia","poisson_ratio":0.31}' >zirconia.json
    run -0 --separate-stderr "$ANALYZE" modulus "${SIZE[@]::6}" bar.csv
    assert_equal "$(value '[.material, .poisson_ratio, .poisson_ratio_source] | tostring')" '[null,0.23,"usual value, no material says it"]'
    run -0 --separate-stderr "$ANALYZE" modulus "${SIZE[@]::6}" --material zirconia.json bar.csv
    assert_equal "$(value '[.material, .poisson_ratio, .poisson_ratio_source] | tostring')" '["zirconia",0.31,"material zirconia"]'
    near "$(value .shear_correction)" 1.03144 1e-9 # 1 + 2.4 * 1.31 * 0.01
    run -0 --separate-stderr "$ANALYZE" modulus --shear none "${SIZE[@]::6}" bar.csv
    assert_equal "$(value '[.poisson_ratio, .poisson_ratio_source] | tostring')" '[null,null]'
    jq -e '.standard_error > 0' <<<"$output" # a measured curve scatters
    printf 'strength (MPa)\n310\n352\n371\n388\n402\n' >strengths.csv
    run -0 --separate-stderr "$ANALYZE" strength --material zirconia.json --table strengths.csv
    assert_regex "${lines[1]}" "^ *zirconia "
    echo '{"format":"dem-bend","version":1}' >bend.json
    run -1 --separate-stderr "$ANALYZE" modulus --material zirconia.json bend.json
    assert_regex "$stderr" "is no table, for which --material has no meaning"
}
