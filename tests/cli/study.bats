#!/usr/bin/env bats
# study.bats: a powder of one's own from one file to the whole report, factorial studies, and what is refused before anything runs.
bats_require_minimum_version 1.5.0
load helper.bash

setup() { cd "$BATS_FILE_TMPDIR"; }

study() { make -C "$ROOT/workflows/study" "$@"; }

# column FILE HEADING [FILTER]: the numbers of a column of CSV; FILTER is an expression of Python on a row r.
column() {
    "$PYTHON" -c 'import csv, sys
for r in csv.DictReader(open(sys.argv[1])):
    if eval(sys.argv[3]): print(r[sys.argv[2]])' "$1" "$2" "${3:-True}"
}

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    mkdir mine
    printf 'Size (nm),Volume (%%)\n300,40\n400,60\n' >mine/psd.csv
    printf 'relative_density,young_modulus (GPa)\n0.62,30\n0.68,44\n' >mine/moduli.csv
    printf 'strength (MPa)\n31\n35\n37\n38\n40\n43\n' >mine/strengths.csv
    cat >mine/powder.toml <<'END'
title = "A powder of mine"
particles = 120
[powder]
material = "nickel"
distribution = "file:psd.csv"
density = 0.45
[firing]
schedule = "25C 5K/min 395C"
densities = [0.6, 0.7]
[test]
conductivity = "90W/m/K"
[measured]
moduli = "moduli.csv"
strengths = "strengths.csv"
[vary]
seeds = 2
END
    # A size that gets fully dense, one that hardly sinters, and a green density that no packing has.
    cat >factorial.toml <<'END'
particles = 60
[powder]
material = "copper"
[firing]
schedule = "25C 10K/min 450C"
densities = [0.6]
[vary]
size = ["200nm", "4um"]
density = [0.45, 0.75]
seeds = 2
END
}

@test "one file gives the whole report: tables, figures with their fonts, a page, beside what was measured" {
    run -0 study STUDY=mine
    assert_line "A powder of mine"
    assert_line --regexp "^ +0.6 +0.7 +end$"
    assert_line --regexp "^relative density +0.6 +0.7 +0.7"
    assert_line --regexp "^Young's modulus, cell \(GPa\) +[0-9.]+ ± [0-9.]+ +[0-9.]+ ± [0-9.]+ "
    assert_line --regexp "at 0.620: Young's modulus of the cell [0-9.]+ GPa, measured 30 GPa, [-+][0-9]+ %"
    assert_line --regexp "^Measured strengths: 6 bars, mean 37.33 MPa, Weibull modulus [0-9.]+$"
    cd mine/results
    for name in densification structure modulus conductivity; do
        for kind in svg pdf png; do [ -s "figures/$name.$kind" ] || fail "$name.$kind is missing"; done
        run -1 grep -q "<text" "figures/$name.svg"
        grep -aq FontFile2 "figures/$name.pdf"
    done
    [ ! -e figures/comparison.svg ]
    grep -q "A powder of mine" report.html
    run -1 grep -iqw nan report.md summary.csv curves.csv states.csv
    grep -q "!\[Densification\](figures/densification.svg)" report.md
}

@test "the numbers are those of the stages: shrinkage of the mass, intervals of two packings, neck over particle" {
    cd mine/results
    # A body that keeps its mass: (1 + dL/L0)^3 = rho_0/rho, but for the small differences between the axes.
    paste <(column curves.csv "dL/L0 (%)") <(column curves.csv relative_density) |
        awk '{ e = (1 + $1 / 100) ^ 3 * $2 / 0.45 - 1; if (e < 0) e = -e; if (e > worst) worst = e } END { exit !(NR > 20 && worst < 2e-3) }'
    # Two values a and b: mean (a + b)/2, and Student's interval reaches 6.3531 |a - b| from it.
    read -r a b < <(jq -s -r 'map(.young_modulus) | @tsv' <(head -1 all/1/elastic.json) <(head -1 all/2/elastic.json))
    row="r['state'] == '0.6'"
    near "$(column summary.csv "Young's modulus, cell (GPa)" "$row")" "$(awk -v a="$a" -v b="$b" 'BEGIN { print (a + b) / 2e9 }')" 1e-5
    jq -e --argjson a "$a" --argjson b "$b" '.cases[0].states[0].young_modulus | ((.upper - .mean) / (6.3531 * ($a - $b | fabs)) - 1 | fabs) < 1e-4' study.json
    near "$(column states.csv "neck ratio x/D" "$row and r['seed'] == '1'")" \
        "$(jq -n --slurpfile b <(head -1 all/1/bonds.json) --slurpfile d <(head -1 all/1/density.json) '$b[0].mean_diameter / $d[0].mean_grain_diameter')" 1e-5
    assert_equal "$(column states.csv "temperature (C)" "r['state'] == 'end'")" $'395\n395'
    # The rate integrates to the densification.
    paste <(column curves.csv "time (min)" "r['seed'] == '1'") <(column curves.csv "densification_rate (%/min)" "r['seed'] == '1'") \
        <(column curves.csv relative_density "r['seed'] == '1'") |
        awk 'NR > 1 { sum += ($2 + r) / 2 * ($1 - t) } { t = $1; r = $2; d = $3 } NR == 1 { d0 = $3 } END { e = sum / 100 / (d - d0) - 1; exit !(e < 0.02 && e > -0.02) }'
}

@test "a second call makes nothing; what is measured later changes only the report, and the run's own curve is met" {
    study STUDY=mine SINTER=/none BONDIFY=/none
    # The curve of the first packing as a dilatometer would log it.
    { echo 'Temperature (C);dL/L0 (%)'
      paste -d';' <(column mine/results/curves.csv "temperature (C)" "r['seed'] == '1'") \
          <(column mine/results/curves.csv "dL/L0 (%)" "r['seed'] == '1'"); } >mine/own.csv
    sed -i -e '/^\[measured\]/a dilatometer = "own.csv"' -e 's/^seeds = 2/seeds = [1]/' mine/powder.toml
    run -0 study STUDY=mine text SINTER=/none BONDIFY=/none
    assert_line --regexp "dL/L0 less that of the dilatometer at the same temperature: 0.00[01] in the mean square, [-+]0.00[0-3] at most"
    assert_line --partial "one packing has none"
    # Another test makes only what hangs on it.
    before=$(jq -s '.[0].conductivity' mine/results/all/1/conductivity.json)
    sed -i 's/^conductivity.*/conductivity = "45W\/m\/K"/' mine/powder.toml
    run -0 study STUDY=mine text SINTER=/none BONDIFY=/none
    near "$(column mine/results/states.csv "conductivity (W/m/K)" "r['state'] == '0.6'")" \
        "$(awk -v k="$before" 'BEGIN { print k / 2 }')" 1e-5
}

@test "a dilatometer calibrates the diffusion: a powder's own curve gives back the constants that it was made with" {
    cd "$BATS_TEST_TMPDIR"
    mkdir powder
    { echo 'temperature (C),dL/L0 (%)'
      paste -d, <(column "$BATS_FILE_TMPDIR/mine/results/curves.csv" "temperature (C)" "r['seed'] == '1'") \
          <(column "$BATS_FILE_TMPDIR/mine/results/curves.csv" "dL/L0 (%)" "r['seed'] == '1'"); } >powder/curve.csv
    # Of nickel without its diffusion, on the packing that made the curve.
    cat >powder/powder.toml <<'END'
particles = 120
[powder]
material = "nickel.json"
distribution = "file:psd.csv"
density = 0.45
[firing]
calibrate = true
schedule = "25C 5K/min 395C"
densities = [0.6]
[measured]
dilatometer = ["curve.csv:5K/min"]
END
    cp "$BATS_FILE_TMPDIR/mine/psd.csv" powder
    "$ANALYZE" materials nickel | jq '.material | del(.grain_boundary_diffusion)' >powder/nickel.json
    run -0 study STUDY=powder text
    assert_line --regexp "Calibrated on the dilatometer: delta D_0b .* kJ/mol; relative densities of curve within 0.00[0-4]$"
    assert_line --regexp "dL/L0 less that of the dilatometer at the same temperature: 0.00[0-2] in the mean square"
    near "$(jq .grain_boundary_diffusion.activation_energy powder/results/calibration/material.json)" 115e3 0.02
    near "$(jq .cases[0].states[0].time.mean powder/results/study.json)" \
        "$(column "$BATS_FILE_TMPDIR/mine/results/states.csv" "time (min)" "r['state'] == '0.6' and r['seed'] == '1'" | awk '{ print 60 * $1 }')" 0.01
    # Another heating rate is not compared.
    sed -i 's/5K\/min 395C/20K\/min 395C/' powder/powder.toml
    run -0 study STUDY=powder text
    refute_output --partial "less that of the dilatometer"
    assert_line --partial "Calibrated on the dilatometer"
    { cat powder/powder.toml; printf '[vary]\ndensity = [0.45, 0.5]\n'; } >powder/other.toml
    run -2 study STUDY=powder/other.toml
    assert_line --regexp "\[firing\] calibrate is of one powder, and \[vary\] density makes several"
}

@test "sizes x densities x seeds: a case that fails or gets dense is reported and stops no other; replicates only within a case" {
    run -0 study STUDY=factorial.toml -j2 FORMATS='svg pdf'
    assert_line --regexp "^200nm-0.45$"
    assert_line "200nm-0.75"
    assert_line "  nothing came of it, see below"
    assert_line --regexp "FAILED: sinter green: --density: spheres .* \[200nm-0.75/1, 200nm-0.75/2, 4um-0.75/1, 4um-0.75/2\]$"
    assert_line --regexp "sinter: the body is fully dense at [0-9.]+ s.* \[200nm-0.45/1, 200nm-0.45/2\]$"
    cd factorial-results
    run -0 jq -c '[.cases[] | [.name, (.states | length), (.states[-1].relative_density.packings // 0)]]' study.json
    assert_output '[["200nm-0.45",2,2],["200nm-0.75",0,0],["4um-0.45",1,2],["4um-0.75",0,0]]'
    jq -e '.cases[0].states[-1].relative_density.mean > 0.9999' study.json
    [ -s figures/comparison.svg ] && [ -s figures/comparison.pdf ]
    grep -q "4um-0.45" report.html
    # Again: what failed is not tried again, nor anything else.
    study STUDY="$BATS_FILE_TMPDIR/factorial.toml" FORMATS='svg pdf' SINTER=/none BONDIFY=/none
}

@test "what is wrong with the file is said in one sentence before anything is computed" {
    mkdir -p "$BATS_TEST_TMPDIR/bad"
    cd "$BATS_TEST_TMPDIR"
    refuse() {  # PATTERN, the file on standard input
        cat >bad/powder.toml
        run -2 study STUDY=bad SINTER=/none
        assert_line --regexp "^study: .*bad/powder.toml: $1"
        [ ! -e bad/results/plan.mk ]
    }
    good=$'[powder]\nmaterial = "nickel"\n[firing]\nschedule = "25C 5K/min 425C"\n'
    refuse "\[powder\] has a key 'diamter' that is not known; is diameter meant\?" <<<"${good/nickel\"/nickel\"$'\n'diamter = \"1um\"}"
    refuse "\[powder\] has no material; analyze materials lists" <<<"${good/material = \"nickel\"/}"
    refuse "material silver lacks young_modulus, poisson_ratio for elasticity" <<<"${good/nickel/silver}"
    refuse "material zirconia-3y lacks grain_boundary_diffusion for sintering. .*analyze kinetics" <<<"${good/nickel/zirconia-3y}"
    refuse "material nickel lacks surface_diffusion for coarsening by surface diffusion; boundary_mobility, dihedral_angle for coarsening by boundaries" \
        <<<"$good"'coarsening = "surface,boundary"'
    refuse "analyze materials: material 'unobtainium' is not known" <<<"${good/nickel/unobtainium}"
    refuse "names the file mine.json, which is not in .*bad" <<<"${good/nickel/mine.json}"
    refuse "\[firing\] needs a schedule, or a temperature" <<<"${good/schedule*/}"
    refuse "'5K' of the schedule '25C 5K 425C' is not understood" <<<"${good/5K\/min/5K}"
    refuse "\[vary\] size: write SIZE in the distribution" <<<"${good/nickel\"/nickel\"$'\n'distribution = \"lognormal:1um:1.3\"}"$'[vary]\nsize = ["1um"]'
    refuse "names the file curve.csv, which is not in" <<<"$good"$'[measured]\ndilatometer = "curve.csv"'
    printf 'Temp;dL\n1;2\n' >bad/curve.csv
    refuse ".*curve.csv: a dilatometer's curve has a column 'temperature \(C\)' and one of 'dL/L0" <<<"$good"$'[measured]\ndilatometer = "curve.csv"'
    refuse "is not TOML: " <<<"${good/=/:}"
    run -2 study
    assert_line --partial "say which study: make -C workflows/study STUDY=FOLDER"
    run -2 study STUDY="two words"
    assert_line --partial "'two words' has a blank in it"
    run -2 study STUDY=nowhere
    assert_line --partial "there is no powder.toml in nowhere"
}

@test "what may stand in the tables are options of the programs that they go to" {
    "$PYTHON" -B -c 'import sys
sys.path.insert(0, sys.argv[1])
import study_plan
own = {"material", "densities", "calibrate", "bend", "necks", "conductivity", "boundary-resistance"}
for name in ("POWDER", "FIRING", "TEST"):
    print(name, *("--" + key for key in getattr(study_plan, name) if key not in own))' "$ROOT/workflows/post" >"$BATS_TEST_TMPDIR/keys"
    for pair in "POWDER $SINTER green" "FIRING $SINTER" "TEST $BEND"; do
        help=$(${pair#* } --help)
        for key in $(sed -n "s/^${pair%% *} //p" "$BATS_TEST_TMPDIR/keys"); do grep -q -- "$key " <<<"$help" || fail "${pair#* } has no $key"; done
    done
}

@test "the examples are plans that can be begun" {
    for name in nickel zirconia sizes; do
        "$PYTHON" -B "$ROOT/workflows/post/study_plan.py" "$ROOT/workflows/study/$name/powder.toml" "$BATS_TEST_TMPDIR/$name" --analyze "$ANALYZE"
        [ -s "$BATS_TEST_TMPDIR/$name/plan.mk" ]
    done
    jq -e '.diffusion_parameter == 1e-35 and .name == "3Y zirconia"' "$BATS_TEST_TMPDIR/zirconia/all/material.json"
    assert_equal "$(jq '.cases | length' "$BATS_TEST_TMPDIR/sizes/plan.json")" 9
}
