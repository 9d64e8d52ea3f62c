#!/usr/bin/env bats
# furnace.bats: furnaces as they are, with cold spans, holds and coarse powders; slow materials; what sinter says of them.
bats_require_minimum_version 1.5.0
load helper

setup() {
    cd "$BATS_TEST_TMPDIR"
    export OMP_NUM_THREADS=1
    "$SINTER" green -n 300 --density 0.5 --seed 4 -o green.kiln
}

last() { "$ANALYZE" info "$1" | tail -1 | jq ".last_step.summary$2"; }
density() { "$ANALYZE" density "$1" | jq -s ".[$2].relative_density"; }

# slow FRACTION: the green body with one particle in seven of a material of this diffusion parameter.
slow() {
    "$SINTER" green -n 300 --density 0.5 --seed 1 --text | jq -c --argjson delta "$1" '
        .materials += [.materials[0] | .name = "slow" | .diffusion_parameter = $delta | del(.grain_boundary_diffusion)]
        | .particles.material = {type: "i4", shape: .particles.radius.shape, data: [range(.particles.radius.shape[0]) | if . % 7 == 0 then 1 else 0 end]}'
}

@test "a hold too cold to move anything, and powder too coarse, give the input back to rounding" {
    run -0 --separate-stderr "$SINTER" --temperature 300C --at-time 1h -o held.kiln green.kiln
    assert_equal "$stderr" ""
    near "$(density held.kiln 0)" "$(density green.kiln 0)" 1e-12
    run -0 jq -e '.time == 3600' <("$ANALYZE" info held.kiln)
    "$SINTER" green -n 300 --density 0.5 --seed 4 --diameter 20mm -o coarse.kiln
    run -0 "$SINTER" --temperature 1200C --at-time 1h -o after.kiln coarse.kiln
    near "$(density after.kiln 0)" "$(density coarse.kiln 0)" 1e-14
}

@test "a whole schedule state by state: nothing below 400 C, a density that never falls, and the same end as at once" {
    "$SINTER" --schedule "25C 10K/min 1150C 10min 20K/min 25C" --every 10min -o all.kiln green.kiln
    run -0 jq -se 'map(.relative_density) | . == sort and length == 18' <("$ANALYZE" density all.kiln)
    near "$(density all.kiln 2)" "$(density green.kiln 0)" 1e-12
    "$SINTER" --schedule "25C 10K/min 1150C 10min 20K/min 25C" -o once.kiln green.kiln
    near "$(density all.kiln -1)" "$(density once.kiln 0)" 2e-3
}

@test "a hold written as a schedule ends as the same hold by its time" {
    "$SINTER" --schedule "1182.4C 131.439069s" -o schedule.kiln green.kiln
    "$SINTER" --temperature 1182.4C --at-time 131.439069s -o hold.kiln green.kiln
    near "$(density schedule.kiln 0)" "$(density hold.kiln 0)" 1e-9
}

@test "a schedule in the words of a laboratory is the same schedule" {
    "$SINTER" --schedule "25C 10K/min 1150C 10min 20K/min 25C" --text -o plain.jsonl green.kiln
    "$SINTER" --schedule "RT 10C/min 1150°C 10 min 1200 C/h RT" --text -o spoken.jsonl green.kiln
    run -0 cmp <(jq -c .particles spoken.jsonl) <(jq -c .particles plain.jsonl)
    "$SINTER" --temperature 1200°C --at-time 250000us,0.00001d --text -o hold.jsonl green.kiln
    run -0 jq -se "map(.time * 1000 | round) == [250, 864]" hold.jsonl
    run -2 "$SINTER" --schedule "25C 10k/min 1150C" green.kiln
    assert_output --partial "a rate [K/s, K/min, K/h, C/s, C/min, C/h] or the time of a hold [s, ms, us, min, h, d]"
    run -2 "$SINTER" --temperature 1200F --at-time 1s green.kiln
    assert_output --partial "known here: K, C"
}

@test "spheres that only just touch sinter; a packing without any contact warns" {
    touching='{"format":"dem-state","version":1,"units":"SI","box":{"origin":[0,0,0],"vectors":[[1.414213562373096e-7,0,0],[0,1.414213562373096e-7,0],[0,0,1.414213562373096e-7]],"periodic":[true,true,true]},"particles":{"position":{"type":"f8","shape":[4,3],"data":[0,0,0,7.07106781186548e-8,7.07106781186548e-8,0,7.07106781186548e-8,0,7.07106781186548e-8,0,7.07106781186548e-8,7.07106781186548e-8]},"radius":{"type":"f8","shape":[4],"data":[5e-8,5e-8,5e-8,5e-8]}}}'
    run -0 --separate-stderr "$SINTER" --temperature 1200C --at-time 10s --material alumina -o fcc.kiln <<<"$touching"
    assert_equal "$stderr" ""
    near "$(density fcc.kiln 0)" 0.860176 1e-4  # 0.74048/(1 - s)^3, s^3 = 0.84375 Delta gamma t/R^4
    run -0 --separate-stderr "$SINTER" --material alumina --temperature 1200C --at-time 70s -o apart.kiln <<<"${touching//5e-8/4.9e-8}"
    assert_regex "$stderr" "no particles touch"
}

@test "slow materials come to the rigid limit whatever their number, say so, and none takes long" {
    slow 0 | "$SINTER" --temperature 1200C --at-time 20s -o rigid.kiln
    for delta in 1e-40 1e-42 1e-60 1e-80; do
        slow "$delta" >slow.jsonl
        run -0 --separate-stderr timeout 60 "$SINTER" --temperature 1200C --at-time 20s -o slow.kiln slow.jsonl
        near "$(density slow.kiln 0)" "$(density rigid.kiln 0)" 1e-3
        [ "$delta" = 1e-40 ] || assert_regex "$stderr" "alumina and slow diffuse .* and count as rigid"
    done
    run -0 jq -e '.converged and .imbalance < 0.01' <(last slow.kiln)
}

@test "--report viscosity: converged is written, symmetric and positive; the stress is the same at any temperature" {
    slow 1e-40 | "$SINTER" --temperature 1200C --at-time 20s --report viscosity -o slow.kiln
    run -0 jq -e '.viscosity_converged and .bulk_viscosity > 0 and .shear_viscosity > 0
                  and (.viscosity | . as $v | [range(3) | . as $i | range(3) | ($v[$i][.] - $v[.][$i]) / $v[0][0] | fabs] | max) < 1e-12' <(last slow.kiln)
    "$SINTER" --schedule "25C 10K/min 1100C 10K/min 800C" --report viscosity -o warm.kiln green.kiln
    run -0 --separate-stderr "$SINTER" --schedule "25C 10K/min 1100C 10K/min 25C" --report viscosity -o cold.kiln green.kiln
    assert_regex "$stderr" "nothing flows that could be measured"
    near "$(last cold.kiln .sintering_stress)" "$(last warm.kiln .sintering_stress)" 1e-6
    slow 0 | "$SINTER" --temperature 1200C --at-time 20s --report viscosity -o rigid.kiln 2>said
    run -0 jq -e '.bulk_viscosity == null and .viscosity_converged' <(last rigid.kiln)
    assert_regex "$(cat said)" "span the box, which does not flow"
}

@test "SIGTERM is obeyed in the middle of a step, and the state before it is written" {
    "$SINTER" green -n 20000 --density 0.43 --seed 5 -o large.kiln
    "$SINTER" --temperature 1200C --to-density 0.9 --tolerance 1e-6 -o out.kiln large.kiln & pid=$!
    sleep 1
    kill -TERM "$pid"
    status=0
    timeout 20 tail --pid="$pid" -f /dev/null
    wait "$pid" || status=$?
    assert_equal "$status" 143
    run -0 jq -e '.particles == 20000' <("$ANALYZE" info out.kiln)
}
