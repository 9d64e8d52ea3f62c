#!/usr/bin/env bats
# bare.bats: states that say as little as a state may: no particles, no bonds, no material.
bats_require_minimum_version 1.5.0
load helper

setup() {
    cd "$BATS_TEST_TMPDIR"
    export OMP_NUM_THREADS=1
    box='"box":{"vectors":[[1e-6,0,0],[0,1e-6,0],[0,0,1e-6]]}'
    none='"position":{"type":"f8","shape":[0,3],"data":[]},"radius":{"type":"f8","shape":[0],"data":[]}'
    one='"position":{"type":"f8","shape":[1,3],"data":[5e-7,5e-7,5e-7]},"radius":{"type":"f8","shape":[1],"data":[1e-7]}'
    two='"position":{"type":"f8","shape":[2,3],"data":[4e-7,5e-7,5e-7,5.9e-7,5e-7,5e-7]},"radius":{"type":"f8","shape":[2],"data":[1e-7,1e-7]}'
    no_bonds='"pair":{"type":"i4","shape":[0,2],"data":[]},"radius":{"type":"f8","shape":[0],"data":[]},"length":{"type":"f8","shape":[0],"data":[]}'
    echo "{$box,\"particles\":{$none}}" >empty.jsonl
    echo "{$box,\"particles\":{$none},\"bonds\":{$no_bonds}}" >empty_bonds.jsonl
    echo "{${box%\}},\"periodic\":[false,false,false]},\"particles\":{$none}}" >empty_free.jsonl
    echo "{$box,\"particles\":{$one},\"bonds\":{$no_bonds}}" >lone.jsonl
    echo "{$box,\"particles\":{$two}}" >pair.jsonl
}

# bar: bar.jsonl, bonded particles that name no material.
bar() {
    "$SINTER" green -n 300 --aspect 6:1:1 --compact-to 0.6 --seed 3 --text | jq -c 'del(.materials)' | "$BONDIFY" -q --text |
        jq -c 'del(.materials)' >bar.jsonl
}

# refused PATTERN COMMAND: one sentence that matches, and nothing on standard output.
refused() {
    run -1 --separate-stderr "${@:2}"
    assert_equal "$output" ""
    local said
    said=$(grep -v ': warning: ' <<<"$stderr")
    assert_equal "$(wc -l <<<"$said")" 1
    assert_regex "$said" "$1"
}

@test "a state without particles: every program takes it, or refuses it in a sentence that says so" {
    for state in empty.jsonl empty_bonds.jsonl empty_free.jsonl; do
        for method in implicit explicit; do
            refused "$state, document 1: the state has no particles" "$SINTER" --method $method --temperature 1200C --at-time 10s $state
        done
        for method in exact sweep necks; do
            decrement=(); [ $method = sweep ] && decrement=(--decrement 1nm)
            "$BONDIFY" --method $method "${decrement[@]}" -q --text $state | tee bonded.jsonl | "$ANALYZE" bonds >bonds.json
            run -0 jq -e '.count == 0 and .mean_diameter == null' bonds.json
            run -0 jq -e '.history[-1].summary | .bonds == 0 and .coordination_number == 0' bonded.jsonl
        done
        for method in static dynamic; do refused "no (bonds|particles)" "$BEND" --method $method $state; done
        refused "no (bonds|particles)" "$BEND" --tensile-strength 300MPa $state
        refused "no (bonds|particles)|not periodic" "$ANALYZE" elastic $state
        refused "no particles|not periodic" "$ANALYZE" elastic --model voxel $state
        refused "no (bonds|particles)|not periodic" "$ANALYZE" conductivity --conductivity 30W/m/K $state
        refused "no particles|not periodic" "$ANALYZE" conductivity --model voxel --conductivity 30W/m/K $state
        refused "no particles" "$ANALYZE" voxel --voxels 4 -o image.npy $state
        run -0 jq -e '.particles == 0 and .coordination_number == 0 and .diameter == null' \
            <("$ANALYZE" density --bins 3 --correlation $state)
        run -0 "$ANALYZE" density --table $state
        run -0 jq -e '.particles == 0' <("$ANALYZE" info $state)
        "$ANALYZE" select --index 1 $state | "$ANALYZE" select --time 0s --text >copy.jsonl
        run -0 jq -e '.particles.radius.shape == [0] and .particles.position.shape == [0, 3]' copy.jsonl
    done
    refused "has no bonds" "$ANALYZE" bonds empty.jsonl
    run -0 jq -e ".relative_density == null" <("$ANALYZE" density --measure envelope empty_free.jsonl)
}

@test "a state whose list of bonds is empty: sintered as a packing, analysed, and refused where bonds must carry" {
    for method in implicit explicit; do
        "$SINTER" -q --method $method --temperature 1200C --at-time 10s --material alumina --text lone.jsonl >sintered.jsonl
        run -0 jq -e '.time == 10 and (has("bonds") | not) and .particles.radius.data == [1e-7]' sintered.jsonl
    done
    for method in exact necks; do
        run -0 jq -e '.bonds.pair.shape == [0, 2] and .bonds.radius.data == []' <("$BONDIFY" -q --method $method --text lone.jsonl)
    done
    run -0 jq -e '.count == 0 and .mean_length == null and .bond_volume_fraction == 0' <("$ANALYZE" bonds lone.jsonl)
    run -0 jq -e '.particles == 1 and .bonds == 0' <("$ANALYZE" info lone.jsonl)
    run -0 jq -e '.clusters == 1 and .isolated == 1' <("$ANALYZE" density lone.jsonl)
    for method in static dynamic; do refused "no bonds" "$BEND" --material alumina --method $method lone.jsonl; done
    refused "no bonds" "$BEND" --material alumina --tensile-strength 300MPa lone.jsonl
    refused "no bonds" "$ANALYZE" elastic --material alumina lone.jsonl
    refused "no bonds" "$ANALYZE" conductivity --conductivity 30W/m/K lone.jsonl
    "$ANALYZE" select --index 1 lone.jsonl | "$ANALYZE" select --density 0.004 --text >copy.jsonl 2>/dev/null
    run -0 jq -e '.bonds.pair.shape == [0, 2]' copy.jsonl
}

@test "a state that names no material is asked for it by programs that need constants; others pass it on as it is" {
    asked='names no material; --material NAME or FILE.json says what it is$'
    refused "sinter: pair.jsonl, document 1: $asked" "$SINTER" --temperature 1200C --at-time 1s pair.jsonl
    refused "sinter: pair.jsonl, document 1: $asked" "$SINTER" -q --method explicit --temperature 1200C --at-time 1s pair.jsonl
    run -0 --separate-stderr "$SINTER" --temperature 1200C --at-time 1s --material alumina -o named.kiln pair.jsonl
    assert_equal "$stderr" ""
    "$ANALYZE" select --index 1 --text named.kiln >named.jsonl
    run -0 jq -e '.materials == [{name: "alumina"} + .materials[0]] and (.materials[0] | has("assumed") | not)' named.jsonl
    run -0 --separate-stderr bash -c '"$1" --text -o bonded.jsonl pair.jsonl' - "$BONDIFY"
    assert_equal "$stderr" ""
    for stage in "cat" "$ANALYZE info" "$ANALYZE select -q --index 1 --text"; do
        run -0 jq -e '.materials == []' <($stage bonded.jsonl)
    done
    for stage in "info" "density" "bonds"; do
        run -0 jq -e 'has("material") and .material == null' <("$ANALYZE" $stage bonded.jsonl)
    done
    jq -c '.materials = [{name: "alumina", surface_energy: 1.1, assumed: true}]' pair.jsonl >marked.jsonl # as older programs wrote it
    refused "$asked" "$SINTER" --temperature 1200C --at-time 1s marked.jsonl
    bar
    refused "analyze elastic: bar.jsonl, document 1: $asked" "$ANALYZE" elastic bar.jsonl
    refused "analyze elastic: bar.jsonl, document 1: $asked" "$ANALYZE" elastic --model voxel --voxels 2 bar.jsonl
    refused "bend: bar.jsonl, document 1: $asked" "$BEND" --cycles 1 --points 3 bar.jsonl
    refused "bend: bar.jsonl, document 1: $asked" "$BEND" --tensile-strength 1GPa bar.jsonl
    printf '{"time":1,"duration":1,"temperature":1473,"relative_density":%s,"strain":[0,0,0]}\n' 0.6 0.7 >history.jsonl
    refused "analyze kinetics: history.jsonl.*: no state before this history names a material; --material" \
        "$ANALYZE" kinetics --firing "25C 10K/min 1100C 1h = 0.67" --firing "25C 10K/min 1250C 1h = 0.69" history.jsonl
}

@test "with --material the moduli are that material's" {
    bar
    echo '{"name":"soft","young_modulus":4e10,"poisson_ratio":0.23}' >soft.json
    "$ANALYZE" elastic -q --material alumina -o alumina.json bar.jsonl
    run -0 --separate-stderr "$ANALYZE" elastic --material soft.json -o soft_moduli.json bar.jsonl
    assert_equal "$stderr" ""
    near "$(jq .young_modulus soft_moduli.json)" "$(jq '.young_modulus / 10' alumina.json)" 1e-6
    for material in alumina soft.json; do
        run -0 --separate-stderr "$BEND" --cycles 1 --points 3 --max-deflection 0.05nm --material $material -o ${material%.json}.bent bar.jsonl
        assert_equal "$stderr" ""
    done
    near "$(jq '.curve.force | max' soft.bent)" "$(jq '.curve.force | max / 10' alumina.bent)" 1e-4
}

@test "--material takes the place of a state's materials, one for one" {
    echo '{"name":"glass","density":2500,"surface_energy":0.3,"diffusion_parameter":7.79e-35,"young_modulus":7e10,"poisson_ratio":0.2}' >glass.json
    "$SINTER" -q --temperature 1200C --at-time 1s --material glass.json --text pair.jsonl >glass.jsonl
    run -0 jq -e '.materials == [{name: "glass", density: 2500, surface_energy: 0.3, diffusion_parameter: 7.79e-35, young_modulus: 7e10,
                   poisson_ratio: 0.2}] and .history[0].arguments[-1] == "glass.json"' glass.jsonl
    "$SINTER" green -n 60 --seed 2 --text >green.jsonl
    run -0 jq -e '.materials[0].name == "glass"' \
        <("$SINTER" -q --temperature 1200C --at-time 1s --material glass.json --text green.jsonl)
    refused "green.jsonl, document 1: has 1 materials, and --material names 2" \
        "$SINTER" --temperature 1200C --at-time 1s --material glass.json,alumina green.jsonl
    jq -c '.particles.material = {type: "i4", shape: [2], data: [0, 1]}' pair.jsonl >numbered.jsonl
    refused "has material 1, there are 1" "$SINTER" --temperature 1200C --at-time 1s numbered.jsonl
    run -0 jq -e '[.materials[].name] == ["glass", "alumina"]' \
        <("$SINTER" -q --temperature 1200C --at-time 1s --material glass.json,alumina --text numbered.jsonl)
    jq -c '.materials = [{name: "unknown"}]' pair.jsonl >unknown.jsonl
    refused "unknown.jsonl, document 1: material 'unknown' has no surface_energy, atomic_volume, grain_boundary_diffusion, which sintering needs; --material NAME or FILE.json says what it is$" \
        "$SINTER" --temperature 1200C --at-time 1s unknown.jsonl
    "$SINTER" -q --temperature 1200C --at-time 1s --material alumina -o known.kiln unknown.jsonl
    refused "unobtainium" "$SINTER" --temperature 1200C --at-time 1s --material unobtainium green.jsonl
    run -2 "$ANALYZE" elastic --model voxel --image image.npy --young-modulus 400GPa --poisson-ratio 0.2 --material alumina
    assert_output --partial "--material"
}
