#!/usr/bin/env bats
# kinetics.bats: activation energies and constants of diffusion from measured curves, what is refused, and the study of them.
bats_require_minimum_version 1.5.0
load helper.bash

ALUMINA="$ROOT/workflows/kinetics/alumina_heating_rates.csv"
SLOW="$DATA/dilatometer_5K.csv" FAST="$DATA/dilatometer_20K.csv"

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    "$SINTER" green -q -n 300 --diameter 300nm --density 0.587 -o green.kiln
    "$SINTER" -q --temperature 1250C --to-density 0.99 --history history.jsonl -o fired.kiln green.kiln
}

setup() { cd "$BATS_FILE_TMPDIR"; }

@test "alumina's curves: the energy without a model, two ways, with errors" {
    run -0 "$ANALYZE" kinetics --curve "$ALUMINA"
    jq -e '.format == "dem-kinetics" and (.curves | length == 3) and (has("bodies") | not)' <<<"$output"
    jq -e '.model_free.iso_density | .activation_energy > 560e3 and .activation_energy < 590e3 and .standard_deviation < 25e3
        and (.densities | length == 11 and all(.curves == 3 and .standard_error > 0))' <<<"$output"
    jq -e '.model_free.master_curve | .activation_energy > 560e3 and .activation_energy < 590e3 and .standard_error > 10e3
        and .jackknife_over == "curves"' <<<"$output"
    run -0 "$ANALYZE" kinetics --curve "$ALUMINA" --hold-out "$ALUMINA:10K/min" --table
    assert_line --regexp "^ *narrowest master curve +2 +572\."
}

@test "a dilatometer's curves with decimal commas give back the constants of the body that they were made with" {
    run -0 "$ANALYZE" kinetics -q --curve "$SLOW" --curve "$FAST" --green-density 0.587 --expansion 8e-6 \
        --save-material fitted.json fired.kiln history.jsonl
    near "$(value .bodies[0].constants.activation_energy)" 520e3 0.01
    # Delta at the reference temperature of both.
    jq -e '.bodies[0] | (.constants.reference_temperature as $t | 2e-8 * (-520e3 / 8.314462618 / $t | exp)) as $made |
        (.constants | .prefactor * (-.activation_energy / 8.314462618 / .reference_temperature | exp)) / $made |
        . > 0.97 and . < 1.03' <<<"$output"
    jq -e '.bodies[0].curves | length == 2 and all(.max < 0.01)' <<<"$output"
    jq -e '.band | length == 2 and all(.minimum == .maximum)' <<<"$output"
    # Without the expansion taken off, it looks like shrinkage that comes late.
    run -0 "$ANALYZE" kinetics -q --curve "$SLOW" --curve "$FAST" --green-density 0.587 fired.kiln history.jsonl
    jq -e '.bodies[0].constants.activation_energy > 560e3' <<<"$output"
}

@test "the fitted material is one of sinter green, and a run of it follows the curves" {
    "$SINTER" green -q -n 300 --diameter 300nm --density 0.587 --material fitted.json -o fitted.kiln
    "$SINTER" -q --schedule "25C 20K/min 1500C" --history fast.jsonl -o fast.kiln fitted.kiln
    run -0 "$ANALYZE" kinetics -q --curve "$SLOW" --hold-out "$FAST" --green-density 0.587 --expansion 8e-6 \
        fired.kiln history.jsonl fast.kiln fast.jsonl
    # Both runs are of one body; the one with the held-out firing is compared with it, and the fit has hardly moved since.
    jq -e '.bodies | length == 1 and .[0].runs == 2' <<<"$output"
    jq -e '.bodies[0].curves[] | select(.held_out) | .run.name == "fast.jsonl" and .run.max < 0.01 and .max < 0.02' <<<"$output"
}

@test "a history alone has the material that is said; a state before it says its own" {
    run -0 --separate-stderr "$ANALYZE" kinetics -q --material alumina --curve "$SLOW" --curve "$FAST" --green-density 0.587 --expansion 8e-6 history.jsonl
    alone=$(value .bodies[0].constants.activation_energy)
    run -0 --separate-stderr "$ANALYZE" kinetics --curve "$SLOW" --curve "$FAST" --green-density 0.587 --expansion 8e-6 \
        fired.kiln history.jsonl
    near "$alone" "$(value .bodies[0].constants.activation_energy)" 1e-3
    assert_equal "$stderr" "analyze kinetics: warning: history.jsonl: 300 grains are few: constants fitted to them miss for others by up to 0.04 in density; 10,000 and three seeds are enough"
}

@test "firings with one density each are fitted, others are foretold" {
    run -0 "$ANALYZE" kinetics -q --firing "25C 10K/min 1100C 1h = 0.65" --firing "25C 10K/min 1250C 1h = 78%" \
        --predict "25C 10K/min 1200C 1h = 0.73" --predict "25C 5K/min 1150C" fired.kiln history.jsonl
    jq -e '.model_free == null and (.bodies[0].curves | map(.relative_density[0]) |
        (.[0] - 0.65 | fabs) < 1e-6 and (.[1] - 0.78 | fabs) < 1e-6 and .[2] > 0.68 and .[2] < 0.76 and .[3] < 0.68)' <<<"$output"
    jq -e '.bodies[0].degrees_of_freedom == 0 and .bodies[0].standard_errors == null' <<<"$output"
}

@test "what the curves lack is said" {
    printf 'temperature (C),density\n1100,0.6\n1200,0.65\n' >bare.csv
    run -1 "$ANALYZE" kinetics --curve bare.csv
    assert_output "analyze kinetics: bare.csv: has neither times nor a heating rate; give that as in bare.csv:5K/min"
    run -1 "$ANALYZE" kinetics --curve "$SLOW"
    assert_output "analyze kinetics: $SLOW: holds shrinkage, from which the density follows with --green-density"
    printf 'temperature (C),shrinkage\n1100,-0.01\n1200,-0.05\n' >sign.csv
    run -1 "$ANALYZE" kinetics --curve sign.csv:5K/min --green-density 0.6
    assert_output "analyze kinetics: sign.csv: the shrinkage ends at -0.05; a change of length that counts shrinking negative is headed 'dL/L0'"
    printf 'temperature (C),dL/L0\n1100,0.01\n1200,0.05\n' >sign.csv
    run -1 "$ANALYZE" kinetics --curve sign.csv:5K/min --green-density 0.6
    assert_output --partial "longer than it began"
    printf 'temperature (C),density\n1100,0.6\n1200,65\n' >percent.csv
    run -1 "$ANALYZE" kinetics --curve percent.csv:5K/min
    assert_output "analyze kinetics: percent.csv, line 3: the relative density is 65.0, expected more than 0 and at most 1"
    printf 'temperature (C),density\n1200,0.6\n1100,0.65\n' >back.csv
    run -1 "$ANALYZE" kinetics --curve back.csv:5K/min
    assert_output "analyze kinetics: back.csv, line 3: the temperature does not rise"
    run -1 "$ANALYZE" kinetics --curve "$ALUMINA:7K/min"
    assert_output "analyze kinetics: $ALUMINA: has no column headed 7 K/min"
    run -1 "$ANALYZE" kinetics --curve "$ALUMINA:5K/min"
    assert_output "analyze kinetics: no two measured curves pass one density"
    run -1 "$ANALYZE" kinetics --curve "$ALUMINA" --hold-out "$ALUMINA"
    assert_output "analyze kinetics: all curves are held out, and none is left to fit"
}

@test "what is no history, and options without a meaning, are refused" {
    run -1 "$ANALYZE" kinetics --curve "$ALUMINA" "$DATA/bending_test.jsonl"
    assert_output --partial "document 1: is neither a state nor a line of sinter --history"
    run -1 "$ANALYZE" kinetics --curve "$ALUMINA" green.kiln
    assert_output "analyze kinetics: the files hold no history of a run"
    run -2 "$ANALYZE" kinetics
    assert_output "analyze kinetics: one of --curve and --firing is required; see analyze kinetics --help"
    run -2 "$ANALYZE" kinetics --curve "$ALUMINA" --save-material m.json
    assert_output --partial "--save-material: has no meaning without a simulated history"
    run -2 "$ANALYZE" kinetics --firing "25C 10K/min 1100C 1h" fired.kiln history.jsonl
    assert_output --partial "--firing: '25C 10K/min 1100C 1h' has no density"
    run -1 "$ANALYZE" kinetics --firing "25C 10K/min 1100C 1h = 0.65" fired.kiln history.jsonl
    assert_output "analyze kinetics: there are 1 measured points, and 2 constants to find"
}

@test "the study: fits, runs at the constants found, tables and figures" {
    mkdir -p packings
    printf 'particles = 9000\ndiameter = "300nm"\ndensity = 0.587\nseed = 1\n' >packings/one.toml
    study() { make -C "$ROOT/workflows/kinetics" PACKINGS="$PWD/packings" OUT="$PWD/study" COARSENING= N=150 "$@"; }
    run -0 study
    assert_line --partial "Activation energy without a model, kJ/mol: 576 at constant density"
    assert_line --regexp "^one +[0-9]+ +[0-9]+ "
    # The runs at the constants found do what the fit said of them.
    jq -e '.bodies[0].curves | length == 3 and all(.run.shift < 2e-3)' study/plain.json
    [ -s study/figures/plain.png ]
    jq -e '.grain_boundary_diffusion.activation_energy > 1e5' study/plain.material.json
    run -0 study SINTER=false ANALYZE=false
    run -2 study PACKINGS="$PWD/none"
    assert_output --partial "there are no case files *.toml in $PWD/none"
}

@test "the study with coarsening: a family, a fit, runs at the constants found that are compared with what was measured" {
    mkdir -p coarse
    printf 'particles = 300\ndistribution = "lognormal:300nm:1.3"\ndensity = 0.587\nseed = 1\n' >coarse/one.toml
    study() { make -C "$ROOT/workflows/kinetics" PACKINGS="$PWD/coarse" OUT="$PWD/coarsened" FAMILY="0.1 0.5 2" NECK_SHARES= "$@"; }
    run -0 study
    assert_line --partial "With coarsening (surface,boundary)"
    jq -e '.bodies | length == 1 and .[0].coarsening and .[0].runs == 9 and .[0].particles > 250' coarsened/coarse.json
    jq -e '.bodies[0].curves | length == 3 and all(.run.rms < 0.05 and .run.shift < 0.1)' coarsened/coarse.json
    # With one more constant, and for the right reason or not, the densities are met better than without coarsening.
    jq -e -s 'map([.bodies[0].curves[] | select(.held_out | not) | .rms] | add) | .[1] < 0.7 * .[0]' coarsened/plain.json coarsened/coarse.json
    jq -e '.surface_diffusion.prefactor > 0' coarsened/coarse.material.json
    [ -s coarsened/figures/coarse.png ]
    run -0 study SINTER=false ANALYZE=false
    # Grain sizes are fitted with the densities, where the runs say them.
    printf 'relative_density,mean intercept (um)\n0.7,0.26\n0.8,0.32\n' >sizes.csv
    run -0 "$ANALYZE" kinetics -q --curve "$ALUMINA" --hold-out "$ALUMINA:10K/min" --grain-size sizes.csv \
        coarsened/coarse/one/family/{0.1,0.5,2}/{fired.kiln,history.jsonl}
    jq -e '.bodies[0].grain_sizes | length == 2 and (.[0].measured - 1.56 * 0.26e-6 | fabs) < 1e-12 and all(.fitted > 2e-7)' <<<"$output"
    # One run does not say what surface diffusion does.
    run -1 "$ANALYZE" kinetics -q --curve "$ALUMINA" coarsened/coarse/one/family/0.5/{fired.kiln,history.jsonl}
    assert_output --partial "runs with coarsening must differ in the ratio of surface diffusion"
}
