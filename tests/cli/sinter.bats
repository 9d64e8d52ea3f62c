#!/usr/bin/env bats
# sinter.bats: the command line of sinter: schedules, boundaries, methods, and runs that are interrupted and resumed.
bats_require_minimum_version 1.5.0
load helper

setup() {
    cd "$BATS_TEST_TMPDIR"
    export OMP_NUM_THREADS=1
    "$SINTER" green -n 300 --density 0.5 --seed 4 -o green.kiln
}

last() { "$ANALYZE" info "$1" | tail -1 | jq ".last_step.summary$2"; }

@test "a schedule ends in one state at its last temperature, with the temperature in the history" {
    run -0 "$SINTER" --schedule "25C 10K/min 1150C 2min 20K/min 25C" --history history.jsonl -o fired.kiln green.kiln
    run -0 jq -s 'length' <("$ANALYZE" info fired.kiln)
    assert_output 1
    run -0 jq -e '.temperature == 298.15 and .time == 10245' <("$ANALYZE" info fired.kiln)
    run -0 jq -se '(map(.temperature) | max) <= 1423.15 and (map(.time) | . == sort)' history.jsonl
}

@test "a schedule too cold for a wanted density is a warning and status 3, with what was reached written" {
    run -3 --separate-stderr "$SINTER" --schedule "25C 10K/min 1100C 10K/min 25C" --to-density 0.501,0.9 -o fired.kiln green.kiln
    assert_regex "$stderr" "the schedule ends at a relative density of 0\.[0-9]+, short of the required 0.9"
    run -0 jq -se 'length == 2 and (.[0].relative_density - 0.501 | fabs) < 1e-6 and .[1].temperature == 298.15' <("$ANALYZE" info fired.kiln)
}

@test "a body that becomes fully dense ends the run with a warning and status 3" {
    run -3 --separate-stderr "$SINTER" --temperature 1250C --at-time 100h -o fired.kiln green.kiln
    assert_regex "$stderr" "fully dense"
    run -0 jq -se 'length == 1 and (.[0].relative_density - 1 | fabs) < 2e-6' <("$ANALYZE" info fired.kiln)
}

@test "a film keeps its area and is under tension; a free one is not" {
    "$SINTER" --temperature 1200C --fix xy --to-density 0.55 -o film.kiln green.kiln
    run -0 jq -ne --argjson s "$(last film.kiln)" '$s.strain[0] == 0 and $s.strain[1] == 0 and $s.strain[2] < -0.09 and $s.stress[0] > 1e5'
    "$SINTER" --temperature 1200C --to-density 0.55 -o free.kiln green.kiln
    run -0 jq -ne --argjson s "$(last free.kiln)" '($s.stress | map(fabs) | max) < 1e3'
}

@test "pressure along one axis forges: it shrinks most there, and the stress is the pressure" {
    "$SINTER" --temperature 1200C --pressure 0MPa,0MPa,10MPa --to-density 0.55 -o forged.kiln green.kiln
    run -0 jq -ne --argjson s "$(last forged.kiln)" '$s.strain[2] < 2 * $s.strain[0] and ($s.stress[2] / -1e7 - 1 | fabs) < 1e-3'
}

@test "hot pressing in a die: the walls press or are clear of the body, and never pull; resumed it is the same" {
    fired() { "$SINTER" --temperature 1200C --to-density 0.55,0.58 "$@" green.kiln; }
    fired --confine xy --pressure 0MPa,0MPa,100MPa -o die.kiln --history die.jsonl
    fired --fix xy --pressure 0MPa,0MPa,100MPa -o fixed.kiln
    # Pressed all the time, they are the walls of a box of fixed length; without a pressure nobody meets them.
    run -0 jq -e '.stress[0] < -1e6 and .stress[1] < -1e6 and .strain[0] == 0' <(last die.kiln)
    assert_equal "$(last die.kiln '| [.time, .strain, .stress]')" "$(last fixed.kiln '| [.time, .strain, .stress]')"
    fired --confine xyz -o clear.kiln
    fired -o free.kiln
    near "$(last clear.kiln .time)" "$(last free.kiln .time)" 1e-4
    run -0 jq -ne --argjson s "$(last clear.kiln)" '($s.stress | map(fabs) | max) < 1e3 and ($s.strain | max) < -0.01'
    # Between the two the body leaves both walls and comes back to one after the other; a run that is killed goes on alike.
    between=(--confine xy --pressure 0MPa,0MPa,15MPa)
    fired "${between[@]}" -o whole.kiln --history whole.jsonl
    run -0 jq -se 'all(.[]; .strain[0] <= 1e-12 and .strain[1] <= 1e-12 and .stress[0] < 1e4 and .stress[1] < 1e4) 
        and (map(.strain[0]) | min) < -1e-4 and (.[0].stress[1] | fabs) < 1e3 and .[-1].stress[0] < -1e5 and .[-1].stress[1] < -1e5' whole.jsonl
    for delay in 0.05 0.1 0.15; do
        fired "${between[@]}" -o parts.kiln --history parts.jsonl --checkpoint run.kiln --checkpoint-every 0s --resume & pid=$!
        sleep "$delay"
        kill -9 $pid 2>/dev/null || true
        wait $pid 2>/dev/null || true
    done
    fired "${between[@]}" -o parts.kiln --history parts.jsonl --checkpoint run.kiln --checkpoint-every 0s --resume
    cmp parts.kiln whole.kiln
    cmp parts.jsonl whole.jsonl
}

@test "--boundary free sinters a body without faces; --report viscosity adds stress and viscosities" {
    "$SINTER" --temperature 1200C --boundary free --to-density 0.55 -o body.kiln green.kiln
    run -0 jq -e '.box.periodic == [false, false, false]' <("$ANALYZE" info body.kiln)
    "$SINTER" --temperature 1200C --report viscosity --to-density 0.55 -o cell.kiln green.kiln
    run -0 jq -ne --argjson s "$(last cell.kiln)" '$s.sintering_stress > 1e5 and $s.bulk_viscosity > $s.shear_viscosity and $s.shear_viscosity > 0'
}

@test "the explicit method comes late by its inertia, and closer with less of it" {
    time_of() { "$SINTER" --temperature 1200C --to-density 0.55 "$@" -o out.kiln green.kiln && last out.kiln .time; }
    implicit=$(time_of) heavy=$(time_of --method explicit) light=$(time_of --method explicit --mass-scaling 1e19)
    run -0 jq -ne "$implicit < $light and $light < $heavy and $light < 2 * $implicit"
}

@test "options that contradict each other are wrong usage, each in a sentence" {
    while IFS='|' read -r options wanted; do
        run -2 --separate-stderr bash -c "'$SINTER' $options green.kiln"
        assert_regex "$stderr" "$wanted"
        assert_equal "$(wc -l <<<"$stderr")" 1
    done <<'END'
--to-density 0.6|--temperature and --schedule
--temperature 1200C|--to-density, --at-time and --schedule
--schedule "25C 1200C" --to-density 0.6|'1200C' stands where a rate
--temperature 1200C --to-density 0.6 --fix xw|'xw' is not made of the axes
--temperature 1200C --to-density 0.6 --pressure 1MPa,2MPa|one value or three
--temperature 1200C --to-density 0.6 --pressure 10|has no unit
--temperature 1200C --to-density 0.6 --boundary free --fix x|--boundary free
--temperature 1200C --to-density 0.6 --boundary free --confine xy|--boundary free
--temperature 1200C --to-density 0.6 --confine xy --fix yz|--fix and --confine both name y
--temperature 1200C --to-density 0.6 --confine 2|'2' is not made of the axes
--temperature 1200C --to-density 0.6 --checkpoint c.kiln|-o FILE
--temperature 1200C --to-density 0.6 --resume -o o.kiln|--resume requires --checkpoint FILE
--temperature 1200C --to-density 0.6 --checkpoint-every 5s -o o.kiln|--checkpoint-every requires --checkpoint FILE
--temperature 1200C --to-density 0.6 --mass-scaling 1e19|--mass-scaling: needs --method explicit
--temperature 1200C --to-density 0.6 --method explicit --tolerance 1e-3|--tolerance: has no meaning with --method explicit
--temperature 1200C --to-density 0.6 --method explicit --order 1|--order: has no meaning with --method explicit
END
}

@test "killed at any moment and resumed, a run ends in the same bytes, outputs and history" {
    "$SINTER" green -n 1500 --density 0.43 --seed 5 | cat - green.kiln >two.kiln
    options=(--temperature 1200C --to-density 0.55,0.6,0.7,0.8)
    "$SINTER" "${options[@]}" --history whole.jsonl -o whole.kiln two.kiln
    resumable() { exec "$SINTER" "${options[@]}" --checkpoint run.kiln --checkpoint-every 0s --resume --history broken.jsonl -o broken.kiln two.kiln; }
    for delay in 0 0.02 0.05; do  # after the first checkpoint that a run writes, and a little more
        before=$(stat -c %i run.kiln 2>/dev/null || true)
        resumable & pid=$!
        while kill -0 "$pid" 2>/dev/null && [ "$(stat -c %i run.kiln 2>/dev/null || true)" = "$before" ]; do sleep 0.005; done
        sleep "$delay"
        kill -9 "$pid"
        wait "$pid" 2>/dev/null || true
        [ ! -e broken.kiln ]
    done
    (resumable)
    cmp broken.kiln whole.kiln
    cmp broken.jsonl whole.jsonl
    run -0 bash -c 'ls run.kiln* broken*partial* 2>/dev/null | wc -l'
    assert_output 0
}

@test "a checkpoint that was interrupted while it was written is written over, and gone in the end" {
    echo "half a checkpoint" >run.kiln.partial
    "$SINTER" --temperature 1200C --to-density 0.6 --checkpoint run.kiln --checkpoint-every 0s --resume -o out.kiln green.kiln
    run -0 bash -c 'echo run.kiln*'
    assert_output 'run.kiln*'
}

@test "SIGTERM with a checkpoint keeps the run; a checkpoint of other options or another input is refused" {
    "$SINTER" green -n 1500 --density 0.43 --seed 5 -o large.kiln
    options=(--temperature 1200C --checkpoint run.kiln --checkpoint-every 0s -o out.kiln)
    "$SINTER" "${options[@]}" --to-density 0.8 large.kiln & pid=$!
    while [ ! -e run.kiln ]; do sleep 0.02; done
    kill -TERM "$pid"
    status=0
    wait "$pid" || status=$?
    assert_equal "$status" 143
    [ ! -e out.kiln ] && [ -e out.kiln.partial ]
    run -1 --separate-stderr "$SINTER" "${options[@]}" --to-density 0.7 --resume large.kiln
    assert_regex "$stderr" "is of a run with other options"
    run -1 --separate-stderr "$SINTER" "${options[@]}" --to-density 0.8 --resume green.kiln
    assert_regex "$stderr" "another input"
    run -1 --separate-stderr "$SINTER" "${options[@]}" --to-density 0.8 large.kiln
    assert_regex "$stderr" "out.kiln.partial: is there already"
    run -0 "$SINTER" "${options[@]}" --to-density 0.8 --resume large.kiln
    "$SINTER" --temperature 1200C --to-density 0.8 -o whole.kiln large.kiln
    cmp out.kiln whole.kiln
}
