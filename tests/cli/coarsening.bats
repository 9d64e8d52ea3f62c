#!/usr/bin/env bats
# coarsening.bats: sinter --coarsening as a user runs it: histories, necks of states, resumed runs, threads, refusals, figure.
bats_require_minimum_version 1.5.0
load helper

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    "$SINTER" green -q -n 500 --seed 4 --method affine --density 0.45 --compact-to 0.58 --distribution lognormal:100nm:1.3 \
        --material alumina-dihedral -o green.kiln
    "$SINTER" --temperature 1350C --coarsening surface,boundary --to-density 0.65,0.75 --history history.jsonl -o grown.kiln green.kiln
}

setup() { cd "$BATS_FILE_TMPDIR"; }

@test "grains grow and vanish, their ids in the history; the volume of all stays" {
    run -0 jq -se '(map(.grains) | . == (sort | reverse)) and (last.mean_grain_diameter > 1.1 * first.mean_grain_diameter)
        and (map(.vanished[]) | length == (unique | length))
        and (map(.vanished[]) | length) == last.vanished_grains and last.grains + last.vanished_grains == 500
        and last.moved_by_surface > 0 and last.density_error > 0' history.jsonl
    run -0 "$PYTHON" - <<END
import json, sys
sys.path.insert(0, "$ROOT/workflows/post")
import kiln
green, first, last = kiln.read("green.kiln") + kiln.read("grown.kiln")
solid = [(state["particles"]["radius"] ** 3).sum() for state in (green, first, last)]
assert max(abs(each / solid[0] - 1) for each in solid) < 1e-12
gone = {each for line in open("history.jsonl") for each in json.loads(line)["vanished"]}
assert gone == set(green["particles"]["id"]) - set(last["particles"]["id"])
assert all((state["necks"]["radius"] >= 0).all() and len(state["necks"]["radius"]) > 100 for state in (first, last))
END
}

@test "analyze density shows grain sizes of states and of their last run" {
    run -0 jq -se --slurpfile history history.jsonl \
        '($history | last) as $step | last | .vanished_grains == $step.vanished_grains and .particles == $step.grains
         and (.mean_grain_diameter / $step.mean_grain_diameter - 1 | fabs) < 1e-12
         and (.neck_coverage / $step.neck_coverage - 1 | fabs) < 1e-9
         and .coordination_number == $step.coordination_number' <("$ANALYZE" density grown.kiln)
    run -0 "$ANALYZE" density --table grown.kiln
    assert_output --partial "mean intercept"
}

@test "the same bytes for any number of threads, and for a run that was interrupted" {
    for threads in 2 4; do
        OMP_NUM_THREADS=$threads "$SINTER" --temperature 1350C --coarsening surface,boundary --to-density 0.65,0.75 -o threads.kiln green.kiln
        cmp grown.kiln threads.kiln
    done
    interrupted=0
    while true; do
        code=0
        timeout -s TERM 0.3 "$SINTER" --temperature 1350C --coarsening surface,boundary --to-density 0.65,0.75 --checkpoint run.kiln \
            --resume --history resumed.jsonl -o resumed.kiln green.kiln || code=$?
        ((code == 124)) || break
        ((++interrupted))
    done
    assert_equal "$code" 0
    ((interrupted > 0))
    cmp grown.kiln resumed.kiln
    cmp history.jsonl resumed.jsonl
}

@test "a state with necks goes on as it was, by text as by bytes" {
    "$ANALYZE" select --index 1 grown.kiln >first.kiln
    "$SINTER" --temperature 1350C --to-density 0.65001 -o further.kiln first.kiln
    run -0 jq -se '(.[0].neck_coverage / .[1].neck_coverage - 1 | fabs) < 1e-3 and .[0].coordination_number == .[1].coordination_number
        and .[0].particles == .[1].particles' <("$ANALYZE" density further.kiln) <("$ANALYZE" density first.kiln)
    "$ANALYZE" select --index 1 --text grown.kiln -o text.jsonl
    "$SINTER" --temperature 1350C --to-density 0.7 -o plain.kiln text.jsonl
    run -0 jq -e '.arrays.necks | keys == ["image", "pair", "radius"]' <("$ANALYZE" info plain.kiln)
    "$ANALYZE" select --index 1 grown.kiln | "$SINTER" --temperature 1350C --to-density 0.7 -o bytes.kiln
    cmp <("$ANALYZE" density plain.kiln) <("$ANALYZE" density bytes.kiln)
}

@test "bondify gives the recorded necks to its bonds, analyze select --interpolate blends them" {
    "$ANALYZE" select --index 2 grown.kiln | "$BONDIFY" --method necks --necks law -o bonded.kiln
    run -0 "$PYTHON" - <<END
import sys
sys.path.insert(0, "$ROOT/workflows/post")
import kiln
state, bonded = kiln.read("grown.kiln")[1], kiln.read("bonded.kiln")[0]
key = lambda pair, image: (*pair.tolist(), *image.tolist())
bonds = {key(p, i): r for p, i, r in zip(bonded["bonds"]["pair"], bonded["bonds"]["image"], bonded["bonds"]["radius"])}
necks = [(key(p, i), r) for p, i, r in zip(state["necks"]["pair"], state["necks"]["image"], state["necks"]["radius"]) if r > 0]
radius = state["particles"]["radius"]
for k, r in necks:
    assert abs(bonds[k] / min(r, *radius[list(k[:2])]) - 1) < 1e-12, (k, r)
assert "necks" not in bonded
END
    "$ANALYZE" select --index 1 grown.kiln >first.kiln
    "$SINTER" --temperature 1200C --to-density 0.66 -o second.kiln first.kiln
    run -0 jq -e '.arrays.necks.radius.shape[0] > 100' \
        <(cat first.kiln second.kiln | "$ANALYZE" select --interpolate --density 0.655 | "$ANALYZE" info)
}

@test "grains of one size never coarsen: no necks have a history, and the density is that without" {
    "$SINTER" green -n 300 --density 0.5 --seed 4 --material alumina-dihedral -o equal.kiln
    for way in "" "--coarsening surface,boundary"; do
        # shellcheck disable=SC2086
        "$SINTER" --temperature 1300C $way --at-time 3s -o equal"${#way}".kiln equal.kiln
    done
    run -0 jq -e '.arrays | has("necks") | not' <("$ANALYZE" info equal29.kiln)
    run -0 jq -se '(.[0].relative_density / .[1].relative_density - 1 | fabs) < 1e-4' \
        <("$ANALYZE" density equal0.kiln) <("$ANALYZE" density equal29.kiln)
}

@test "a free body coarsens; --neck-growth alone stiffens necks while nothing shrinks" {
    "$SINTER" --temperature 1350C --boundary free --coarsening surface --at-time 2s -o free.kiln green.kiln
    run -0 jq -e '.vanished_grains > 5' <("$ANALYZE" density free.kiln)
    "$SINTER" --temperature 900C --neck-growth surface --at-time 1h -o stiff.kiln green.kiln
    "$SINTER" --temperature 900C --at-time 1h -o slack.kiln green.kiln
    run -0 jq -se '.[0].neck_coverage > 1.2 * .[1].neck_coverage and .[0].relative_density <= .[1].relative_density and .[0].particles == 500' \
        <("$ANALYZE" density stiff.kiln) <("$ANALYZE" density slack.kiln)
}

@test "what coarsening lacks and what does not go with it is refused in a sentence" {
    "$SINTER" green -n 50 --density 0.5 -o plain.kiln
    run -1 "$SINTER" --temperature 1300C --coarsening surface --at-time 1s plain.kiln
    assert_output --partial "material 'alumina' has no surface_diffusion, which coarsening by surface diffusion needs"
    run -2 "$SINTER" --temperature 1300C --coarsening volume --at-time 1s plain.kiln
    assert_output --partial "--coarsening: 'volume' is none of surface, boundary"
    run -2 "$SINTER" --temperature 1300C --coarsening surface --method explicit --at-time 1s plain.kiln
    assert_output --partial "--coarsening: needs --method implicit"
    run -2 "$SINTER" --temperature 1300C --coarsening surface --chi 0.9 --at-time 1s plain.kiln
    assert_output --partial "--chi: needs --coarsening boundary"
    run -2 "$SINTER" --temperature 1300C --neck-share 0.9 --at-time 1s plain.kiln
    assert_output --partial "--neck-share: needs --coarsening"
}

@test "the figure of grain size against density; a history without grains is refused" {
    export PYTHONDONTWRITEBYTECODE=1
    run -0 "$PYTHON" "$ROOT/workflows/post/figure_grains.py" history.jsonl -o grains.svg
    run -0 grep -c "Mean grain diameter" grains.svg
    echo '{"relative_density":0.5}' >none.jsonl
    run -1 "$PYTHON" "$ROOT/workflows/post/figure_grains.py" none.jsonl -o none.svg
    assert_output --partial "no line has mean_grain_diameter"
}

@test "dem-convert keeps recorded necks in its own format and says where it leaves them out" {
    export PYTHONDONTWRITEBYTECODE=1
    run -0 "$ROOT/workflows/post/dem-convert" grown.kiln copy.jsonl
    assert_output ""
    cmp <("$ANALYZE" density grown.kiln) <("$ANALYZE" density copy.jsonl)
    run -0 "$ROOT/workflows/post/dem-convert" grown.kiln grown.dump
    assert_output --regexp "a dump does not hold .*necks"
}
