#!/usr/bin/env bats
# structure.bats: what analyze says of the structure of states: density, contacts, bonds, and states in between.
bats_require_minimum_version 1.5.0
load helper.bash

setup() { cd "$BATS_TEST_TMPDIR"; }

@test "analyze density: sizes, clusters, isolated particles and the texture of contacts" {
    jq -nc '{box: {vectors: [[99,0,0],[0,99,0],[0,0,99]]},
        particles: {position: {type: "f8", shape: [4,3], data: [1,1,1, 1,1,1.9, 1,1,2.8, 50,50,50]},
                    radius: {type: "f8", shape: [4], data: [0.5,0.5,0.5,1]}}}' >row.jsonl
    run -0 "$ANALYZE" density --bins 2 row.jsonl
    assert_equal "$(value '[.clusters, .largest_cluster_fraction, .isolated, .coordination_number] | tostring')" "[2,0.75,1,1]"
    assert_equal "$(value '[.fabric_tensor[2][2], .fabric_tensor[0][0], .fabric_anisotropy] | tostring')" "[1,0,1]"
    assert_equal "$(value '[.diameter.minimum, .diameter.maximum, .diameter.mean, .diameter_histogram.counts] | tostring')" "[1,2,1.25,[0,4]]"
    near "$(value .overlap_ratio.maximum)" 0.1 1e-9
    assert_equal "$(value '.overlap_histogram.counts | add')" 2
}

# The closing of two touching spheres of radius 1/2 by a ball of radius 1: caps, and between them the inner side of a torus.
# V = 2 pi int_0^(1/3) (sqrt(2) - sqrt(1 - z^2))^2 dz + 2 pi (2/3)^2 (3/2 - 2/3)/3 = 1.16908
@test "analyze density: the envelope of one sphere, of two that touch, and of a row without end" {
    sphere() { # BOX PERIODIC POSITIONS
        jq -nc --argjson x "$1" --argjson p "$2" --argjson at "$3" '{box: {vectors: [[$x,0,0],[0,9,0],[0,0,9]], periodic: [$p,false,false]},
            particles: {position: {type: "f8", shape: [($at | length) / 3, 3], data: $at},
                        radius: {type: "f8", shape: [($at | length) / 3], data: [$at[range(0; $at | length; 3)] | 0.5]}}}'
    }
    { sphere 9 false "[4,5,5]"; sphere 9 false "[4,5,5,5,5,5]"; sphere 1 true "[4,5,5]"; } >states.jsonl
    run -0 "$ANALYZE" density --measure envelope --probe-radius 1m states.jsonl
    near "$(jq .relative_density <<<"${lines[0]}")" 1 0.01
    near "$(jq .relative_density <<<"${lines[1]}")" 0.895746 0.01  # (pi/3)/1.16908
    near "$(jq .relative_density <<<"${lines[2]}")" 0.811177 0.03  # the same torus, and the sphere between -1/6 and 1/6; a groove is felt to a sixth of the grid
    assert_equal "$(jq -r '[.measure, .probe_radius] | tostring' <<<"${lines[2]}")" '["envelope",1]'
    run -1 "$ANALYZE" density --measure envelope "$DATA/cubic_series.jsonl"
    assert_output --partial "cubic_series.jsonl, document 1: the state is periodic along all axes"
    run -2 "$ANALYZE" density --measure envelope --probe-radius 0nm "$DATA/two_spheres.jsonl"
}

@test "analyze density, bonds: what a measure or a table does not use is refused" {
    refuse() { run -2 --separate-stderr "$ANALYZE" "${@:2}" "$DATA/two_spheres.jsonl"; assert_equal "$stderr" "analyze $2: $1; see analyze $2 --help"; }
    for measure in auto box inner; do
        refuse "--probe-radius: needs --measure envelope" density --measure $measure --probe-radius 1m
    done
    refuse "--bins: has no meaning with --table, which does not show it" density --bins 5 --table
    refuse "--correlation: has no meaning with --table, which does not show it" density --correlation --table
    refuse "--bins: has no meaning with --table, which does not show it" bonds --table --bins 5
    run -0 "$ANALYZE" density --bins 5 --table=false "$DATA/two_spheres.jsonl"
}

@test "analyze density: g(r) of a cubic lattice stands at its distances, periodic and free, and is 1 where centres lie at random" {
    run -0 "$ANALYZE" density --correlation --range 150nm --shells 15 "$DATA/cubic_series.jsonl"
    # 6 neighbours at 100 nm, 12 at 141 nm, in shells of 10 nm and cells of 1e-21 m3.
    jq -e '[.pair_correlation.g | to_entries[] | select(.value > 0) | .key] == [10, 14]' <<<"${lines[0]}"
    near "$(jq '.pair_correlation.g[10]' <<<"${lines[0]}")" "$(awk 'BEGIN { print 6 / (4.18879 * (1.1 ^ 3 - 1)) }')" 1e-5
    jq -nc '[range(9) as $x | range(9) as $y | range(9) as $z | $x, $y, $z] as $p |
        {box: {vectors: [[99,0,0],[0,99,0],[0,0,99]], periodic: [false,false,false]},
         particles: {position: {type: "f8", shape: [729,3], data: $p}, radius: {type: "f8", shape: [729], data: [range(729) | 0.5]}}}' >cube.jsonl
    run -0 "$ANALYZE" density --correlation --range 1.3m --shells 13 cube.jsonl
    assert_equal "$(value .pair_correlation.centres)" 125
    near "$(value '.pair_correlation.g[10]')" "$(awk 'BEGIN { print 6 / (125 / 5.4 ^ 3 * 4.18879 * (1.1 ^ 3 - 1)) }')" 1e-5
    run -1 "$ANALYZE" density --correlation --range 9m cube.jsonl
    assert_output --partial "cube.jsonl, document 1: no particle lies as far inside"
    "$PYTHON" - >random.jsonl <<'END'
import json, random
random.seed(3)
n = 2000
print(json.dumps({"box": {"vectors": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}, "particles": {
    "position": {"type": "f8", "shape": [n, 3], "data": [random.random() for _ in range(3 * n)]},
    "radius": {"type": "f8", "shape": [n], "data": [1e-3] * n}}}))
END
    run -0 "$ANALYZE" density --correlation --range 0.2m --shells 4 random.jsonl
    jq -e '.pair_correlation.g[1:] | all(. > 0.95 and . < 1.05)' <<<"$output"
}

@test "analyze bonds: forces and stresses of bonds that carry them" {
    "$BONDIFY" -q --text "$DATA/two_spheres.jsonl" | jq -c '.bonds.radius.data = [2] |
        .bonds += {normal_force: {type: "f8", shape: [1], data: [-8]}, moment: {type: "f8", shape: [1,3], data: [0,3,4]}}' >loaded.jsonl
    run -0 "$ANALYZE" bonds loaded.jsonl
    assert_equal "$(value '[.normal_force.mean, .compressed_fraction] | tostring')" "[-8,1]"
    near "$(value .normal_stress.mean)" -0.6366197724 1e-9                   # -8/(4 pi)
    near "$(value .fibre_stress.maximum)" 0.1591549431 1e-9                  # -8/(4 pi) + 4*5/(8 pi)
    run -0 bash -c '"$BONDIFY" -q "$1" | "$ANALYZE" bonds | jq -c "[.normal_force, .fibre_stress]"' - "$DATA/two_spheres.jsonl"
    assert_output "[null,null]"
}

@test "analyze select: linear between two states, particles matched by id, the nearer way through a face" {
    jq -nc '{time: 0, box: {vectors: [[10,0,0],[0,10,0],[0,0,10]]}, particles: {id: {type: "i8", shape: [2], data: [7,8]},
        position: {type: "f8", shape: [2,3], data: [9.5,5,5, 2,2,2]}, radius: {type: "f8", shape: [2], data: [1,1]}}},
        {time: 10, box: {vectors: [[10,0,0],[0,10,0],[0,0,8]]}, particles: {id: {type: "i8", shape: [2], data: [8,7]},
        position: {type: "f8", shape: [2,3], data: [2,2,1.6, 0.5,5,4]}, radius: {type: "f8", shape: [2], data: [1,1.2]}}}' >two.jsonl
    run -0 "$ANALYZE" select --interpolate --time 2.5s --text two.jsonl
    assert_equal "$(value '[.time, .box.vectors[2][2], .particles.id.data] | tostring')" "[2.5,9.5,[7,8]]"
    near "$(value '.particles.position.data[0]')" 9.75 1e-12
    near "$(value '.particles.position.data[2]')" 4.75 1e-12
    near "$(value '.particles.radius.data[0]')" 1.05 1e-12
    run -0 "$ANALYZE" select --interpolate --index 1.5,2 --text two.jsonl
    assert_equal "$(jq -sc '[.[].time]' <<<"$output")" "[5,10]"
    run -0 bash -c '"$ANALYZE" select --interpolate --density 0.0095 two.jsonl | "$ANALYZE" density'
    near "$(value .relative_density)" 0.0095 1e-9
}

@test "analyze select --interpolate: a value outside the stream and unlike particles are refused" {
    run -1 "$ANALYZE" select --interpolate --density 0.9 "$DATA/cubic_series.jsonl"
    assert_output --partial "no two states of the stream have density 0.9 between them"
    jq -c 'if .time == 300 then .particles.id = {type: "i8", shape: [1], data: [5]} else . end' "$DATA/cubic_series.jsonl" >other.jsonl
    run -1 "$ANALYZE" select --interpolate --time 200s other.jsonl
    assert_output --partial "document 3: between it and the state before: the states differ: particle 0 is in one and not in the next"
    run -2 "$ANALYZE" select --index 1.5 "$DATA/cubic_series.jsonl"
}
