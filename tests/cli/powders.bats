#!/usr/bin/env bats
# powders.bats: powders as they are measured: tables of laser diffraction, lists of diameters and of spheres; logs of furnaces.
bats_require_minimum_version 1.5.0
load helper

setup() { cd "$BATS_TEST_TMPDIR"; }

# powder NAME OPTIONS: a text body NAME of loose spheres.
powder() { "$SINTER" green --density 0.3 --text -o "$1" "${@:2}" 2>"$1.said"; }

# volume_below FILE DIAMETER: the part of the spheres' volume that lies below it.
volume_below() { jq "[.particles.radius.data[] | {d: (2 * .), v: (. * . * .)}] | (map(select(.d < $2).v) | add // 0) / (map(.v) | add)" "$1"; }

@test "a table of percent by volume becomes the number of particles that has this volume" {
    printf 'Size (um),Volume (%%)\n0.1,5\n0.2,30\n0.5,65\n' >psd.csv
    powder body -n 4000 --distribution file:psd.csv
    near "$(volume_below body 0.15e-6)" 0.05 0.02
    near "$(volume_below body 0.3e-6)" 0.35 0.02
    run -0 jq -e '.history[0].summary.diameters | [.asked.by_volume.d50, .made.by_volume.d50, .made.by_number.d50, .made.minimum]
                  | map(. * 1e9 | round) == [500, 500, 100, 100]' body
    assert_regex "$(cat body.said)" "diameters by volume: D10 200 nm \(asked for 200 nm\), D50 500 nm \(asked for 500 nm\)"
    refute [ "$(grep -c warning body.said)" -gt 0 ]
}

@test "a cumulative curve, and D10, D50 and D90, come back by volume from the body, as analyze density sees it" {
    printf 'Durchmesser;Durchgang Masse\n\xb5m;%%\n0,1;0,0\n0,2;30,0\n0,5;80,0\n1,0;100,0\n' >sieve.csv  # in Latin-1
    powder curve -n 5000 --distribution file:sieve.csv
    near "$(volume_below curve 0.2e-6)" 0.3 0.02
    near "$(volume_below curve 0.5e-6)" 0.8 0.02
    near "$("$ANALYZE" density curve | jq .diameter.by_volume.d50)" 0.28854e-6 0.03  # 0.2 um 2.5^0.4
    powder percentiles -n 5000 --distribution percentiles:0.2um:0.3um:0.6um
    for each in 0.2:0.1 0.3:0.5 0.6:0.9; do near "$(volume_below percentiles "${each%:*}e-6")" "${each#*:}" 0.04; done
    run -0 jq -e '.diameter | .by_number.d50 < .by_volume.d50 and .by_volume.d10 > 1.9e-7 and .by_volume.d90 < 6.2e-7' \
        <("$ANALYZE" density percentiles)
}

@test "a sorted list is drawn from by the seed, all over" {
    seq 55 5 1050 | sed 's/$/nm/' >sorted.txt
    for seed in 1 2; do powder list$seed -n 50 --seed $seed --distribution file:sorted.txt; done
    run -0 jq -e '.particles.radius.data | (add / length * 2) as $mean | $mean > 450e-9 and $mean < 660e-9 and (unique | length) == 50' list1
    run -1 cmp -s <(jq -c '.particles.radius.data | sort' list1) <(jq -c '.particles.radius.data | sort' list2)
    powder all --distribution file:sorted.txt
    run -0 jq -e '.particles.radius.data | length == 200 and (unique | length) == 200' all
    printf '0.35\xc2\xb5m\n0.85\xce\xbcm\n' >micro.txt
    powder micro --distribution file:micro.txt
    run -0 jq -e '.particles.radius.data | sort == [1.75e-7, 4.25e-7]' micro
}

@test "lognormal and bimodal sizes by volume; too few particles for the tail are warned of" {
    powder log -n 5000 --distribution lognormal:200nm:1.3 --sizes-by volume
    near "$(volume_below log 200e-9)" 0.5 0.08
    powder two -n 900 --distribution bimodal:200nm:100nm:0.5 --sizes-by mass
    near "$(volume_below two 150e-9)" 0.5 1e-9
    powder few -n 20 --distribution lognormal:200nm:2.2 --sizes-by volume
    assert_regex "$(cat few.said)" "warning: half of the volume lies below .*, not below the 200 nm of the distribution"
}

@test "what a table does not say is asked for, by the option that says it" {
    printf 'Size (um),Share (%%)\n0.1,40\n0.2,60\n' >plain.csv
    run -1 "$SINTER" green -n 10 --distribution file:plain.csv -o body
    assert_output --partial "plain.csv: column 'Share (%)' does not say what it counts; --sizes-by number, volume or mass does"
    powder body -n 100 --distribution file:plain.csv --sizes-by number
    run -0 jq -e '[.particles.radius.data[] | select(. < 7e-8)] | length == 40' body
    printf '0.1 3 40\n0.2 4 60\n' >bare.txt
    powder named -n 100 --distribution file:bare.txt --columns size,-,number --length-unit um
    run -0 cmp <(jq -c .particles named) <(jq -c .particles body)
    for words in "--distribution monosize --sizes-by volume" "--shares class" "--columns size,share" "--length-unit um" \
        "--distribution file:plain.csv --length-unit parsec" "--distribution percentiles:3nm:2nm:1nm" "--periodic xyz" "--box 1um:1um:1um"; do
        # shellcheck disable=SC2086
        run -2 "$SINTER" green -n 10 $words -o body
    done
}

@test "spheres of another program are a body as they are, with their overlap, in a free box or a periodic one" {
    printf '#format x_y_z_r\n0.5\t0.5\t0.5\t0.5\n1.45\t0.5\t0.5\t0.5\n' >yade.txt
    run -1 "$SINTER" green --spheres yade.txt -o body
    assert_output --partial "yade.txt: column 'x' has no unit; --length-unit names it"
    run -0 --separate-stderr "$SINTER" green --spheres yade.txt --length-unit um --text -o free
    assert_equal "$stderr" "sinter green: 2 spheres, 1.0 contacts each, overlap h/(r1 + r2) 0.05 in the mean and 0.05 at most"
    run -0 jq -e '.box.periodic == [false, false, false] and (.box.vectors[0][0] - 1.95e-6 | fabs) < 1e-18
                  and .materials[0].name == "alumina" and .particles.id.data == [0, 1]
                  and (.history[0].summary | .contacts == 1 and (.mean_overlap_ratio - 0.05 | fabs) < 1e-12)' free
    printf 'x (um) y (um) z (um) d (um)\n-1 0 0 2\n1 0 0 2\n' >touching.txt
    run -0 --separate-stderr "$SINTER" green --spheres touching.txt --box 4um:2um:2um --origin=-2um:-1um:-1um --periodic xyz --swell 0.01 \
        --material alumina-dihedral --text -o cell
    near "$(jq '.history[0].summary.largest_overlap_ratio' cell)" 0.00990099 1e-5
    near "$(jq '.box.vectors[0][0]' cell)" 3.960396e-6 1e-6
    run -0 jq -e '.history[0].summary | .coordination_number == 6 and .measure == "box"' cell
    "$SINTER" --temperature 1200C --at-time 10s cell | "$ANALYZE" density >after
    run -0 jq -e '.relative_density > 0.5' after
    printf 'x (um),y (um),z (um),r (um)\n0,0,0,1\n5,0,0,1\n' >apart.csv
    run -0 "$SINTER" green --spheres apart.csv -o apart.kiln
    assert_output --partial "warning: no spheres touch; --swell brings them together"
}

@test "spheres that are no body are refused with what would help" {
    refused() {
        printf '%b' "$1" >spheres.csv
        run -1 "$SINTER" green --spheres spheres.csv "${@:3}" -o body
        assert_output --partial "$2"
        [ ! -e body ]
    }
    head='x (um),y (um),z (um),r (um)\n'
    refused "${head}0,0,0,1\n0,0,0,1\n" "spheres.csv: sphere 0 and sphere 1 lie at one place"
    refused "${head}0,0,0,1\n0.2,0,0,0.1\n" "lie one inside the other"
    refused "${head}0,0,0,1\n0,0,0,0\n" "spheres.csv, line 3: the radius '0' is not above zero"
    refused "${head}0,0,0,1\n3,0,0,1\n" "the centre of sphere 1 has x = 3e-06 m" --box 2um:2um:2um
    refused "x,y,z\n0,0,0\n" "neither a radius nor a diameter" --length-unit um
    refused "${head}0,0,0,1\n" "--length-unit gives one more" --length-unit nm
    for words in "-n 5" "--density 0.4" "--distribution monosize" "--seed 3" "--method soft" "--aspect 1:1:1" "--periodic xyz" \
        "--origin 0m:0m:0m" "--periodic xw --box 1m:1m:1m" "--box 1:1:1"; do
        # shellcheck disable=SC2086
        run -2 "$SINTER" green --spheres spheres.csv $words -o body
    done
}

@test "a furnace's log is a schedule, the same as the words for it" {
    "$SINTER" green -n 200 --density 0.5 --seed 4 -o green.kiln
    {
        printf 'Zeit;T Soll;T Ist\nmin;\xc2\xb0C;\xc2\xb0C\n'
        for minute in $(seq 0 113); do printf '%d,0;0;%s\n' "$minute" "$((minute < 113 ? 25 + 10 * minute : 1150))"; done
        for minute in $(seq 114 124); do printf '%d,0;0;1150\n' "$minute"; done
    } >log.csv
    "$SINTER" --tolerance 1e-4 --schedule log.csv --text -o logged.jsonl green.kiln
    "$SINTER" --tolerance 1e-4 --schedule "25C 10C/min 1145C 5C/min 1150C 11min" --text -o spoken.jsonl green.kiln
    near "$("$ANALYZE" density logged.jsonl | jq .relative_density)" "$("$ANALYZE" density spoken.jsonl | jq .relative_density)" 3e-4
    run -0 jq -e '.time == 7440 and .temperature == 1423.15' logged.jsonl
    printf 'time (s),T (C)\n0,25\n100,900\n90,1000\n' >back.csv
    run -1 "$SINTER" --schedule back.csv green.kiln
    assert_output --partial "back.csv, line 4: the time goes back"
    printf 'time (s),T\n0,25\n100,900\n' >bare.csv
    run -1 "$SINTER" --schedule bare.csv green.kiln
    assert_output --partial "bare.csv: column 'T' has no unit; known here: K, C"
    run -2 "$SINTER" --schedule "25C 1min" --time-column t green.kiln
    assert_output --partial "--time-column"
}

@test "a run by a furnace's log is resumed, but not by another log of the same name" {
    "$SINTER" green -n 300 --density 0.5 --seed 4 -o green.kiln
    printf 'time (min),T (C)\n0,25\n60,1200\n90,1200\n' >log.csv
    "$SINTER" --schedule log.csv --checkpoint run.kiln --checkpoint-every 0s -o fired.kiln green.kiln & pid=$!
    for try in $(seq 200); do [ ! -s run.kiln ] || break; sleep 0.02; done
    kill -KILL $pid; wait $pid || true
    [ -s run.kiln ] || skip "the run was over before its first checkpoint could be seen"
    printf 'time (min),T (C)\n0,25\n60,1250\n90,1200\n' >log.csv
    run -1 "$SINTER" --schedule log.csv --checkpoint run.kiln --resume -o fired.kiln green.kiln
    assert_output --partial "run.kiln"
}
