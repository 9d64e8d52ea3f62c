#!/usr/bin/env bats
# fired.bats: firings by schedules beside measured densities, and the arithmetic of master sintering curves.
bats_require_minimum_version 1.5.0
load helper.bash

setup() { cd "$BATS_FILE_TMPDIR"; }

fired() {
    make -C "$ROOT/workflows/fired" N=200 OUT="$PWD/fired" GREEN='-n 200 --method affine --compact-to 0.55 --seed 1' "$@"
}

@test "the paper's firings: a table that says where the kinetics disagree, and a figure" {
    run -0 fired
    assert_line --regexp "^ +1100C +0\.[0-9]+ +0\.67 +[0-9]+ C +[0-9.]+"
    assert_line --regexp "^ +1250C +1\.000 +0\.88 .* \*$"
    assert_line --regexp "^With the diffusion data of alumina the model sinters [0-9.]+ times as fast as measured at 1100C, "
    assert_output --partial "rise more slowly with temperature"
    # Hotter firings end denser, and the same programme reaches each measured density at a lower temperature than the furnace did.
    jq -e '[.firings[].relative_density * 1e6 | round] | . == sort' fired/fired.json
    jq -e '.firings | all(.slower_by > 1 and .equivalent_temperature < .temperature)' fired/fired.json
    [ -s fired/figures/fired.png ]
}

@test "the master curve of the hottest firing foretells the coolest one" {
    density=$(jq '.firings[0].relative_density' fired/fired.json)
    run -0 jq --argjson t 1373.15 '.curve as $c | [range($c.temperature | length - 1)] |
        map(select($c.temperature[.] <= $t and $t < $c.temperature[. + 1])) | $c.relative_density[.[0]], $c.relative_density[.[0] + 1]' fired/fired.json
    awk -v d="$density" -v low="${lines[0]}" -v high="${lines[1]}" 'BEGIN { exit !(low - 0.01 <= d && d <= high + 0.01) }' ||
        fail "$density is not between ${lines[0]} and ${lines[1]}"
}

@test "a temperature that was sought reaches what it was sought for, holds and rates as written" {
    run -0 env PYTHONDONTWRITEBYTECODE=1 "$PYTHON" - "$ROOT/workflows/post" <<'END'
import sys
sys.path.insert(0, sys.argv[1])
from fired import temperature_for, theta_along
from schedules import corners
time, kelvin = corners("25C 10K/min 1200C 1h 10K/min 25C")
print(time.tolist(), (kelvin - 273.15).round(9).tolist())
theta = theta_along(time, kelvin, 475e3)[1][-1]
print(round(temperature_for("25C 10K/min 1000C 1h 10K/min 25C", theta, 475e3) - 273.15, 6))
hold = theta_along(*corners("1200C 1h"), 475e3)[1][-1]
print(1.0 < theta / hold < 1.2)  # heating and cooling at 10 K/min add a few minutes to the hold
END
    assert_output $'[0.0, 7050.0, 10650.0, 17700.0] [25.0, 1200.0, 1200.0, 25.0]\n1200.0\nTrue'
}

@test "measured densities are read as a spreadsheet writes them; another schedule or table is refused in one sentence" {
    printf '\xef\xbb\xbffiring;relative_density (%%)\n1100C;67,0\n1200C;79,0\n' >german.csv
    fire() { env PYTHONDONTWRITEBYTECODE=1 "$PYTHON" "$ROOT/workflows/post/fired.py" fired --firings "$ROOT"/workflows/fired/firings/*.toml -o other.txt "$@"; }
    fire --measured german.csv
    run -0 jq -c '[.firings[] | .measured]' other.json
    assert_output '[0.67,null,0.79,null]'
    printf 'firing,density\n1100C,0.67\n' >without.csv
    run -1 fire --measured without.csv
    assert_output "fired.py: without.csv: has no column relative_density, only firing, density"
}

@test "two firings calibrate the diffusion, and foretell the other two better than the published constants do" {
    jq -e '.bodies[0].curves | length == 4 and (map(select(.held_out | not)) | length == 2 and all(.max < 1e-4))
        and (map(select(.held_out)) | length == 2 and all(.max < 0.04))' fired/calibrated.json
    jq -e '.grain_boundary_diffusion.activation_energy < 300e3' fired/calibrated.material.json
    run -0 cat fired/calibrated.txt
    assert_line --regexp "^ +0\.67 +0\.670\* 25C 10K/min 1100C"
    assert_line --regexp "^ +0\.79 +0\.[78][0-9]+  25C 10K/min 1200C"
}

@test "a second call makes nothing" {
    fired SINTER=false ANALYZE=false
}
