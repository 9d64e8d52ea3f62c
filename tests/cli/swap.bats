#!/usr/bin/env bats
# swap.bats: every stage of the pipe can be taken out and replaced by another program.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    export SINTERED="$BATS_FILE_TMPDIR/sintered.kiln"
    "$SINTER" green -n 600 --method affine --compact-to 0.55 --aspect 4:1:1 --seed 11 |
        "$SINTER" --temperature 1200C --to-density 0.6,0.7,0.8 -o "$SINTERED"
}

setup() {
    export PYTHONPATH="$ROOT/workflows/post" PYTHONDONTWRITEBYTECODE=1
    cd "$BATS_TEST_TMPDIR"
}

# A stage of ten lines: of all states, the one nearest to a density.
write_nearest() {
    cat >nearest.py <<'END'
import sys
import kiln
wanted, text = float(sys.argv[1]), "--text" in sys.argv
states = list(kiln.documents(sys.stdin.buffer))
nearest = min(states, key=lambda state: abs(kiln.relative_density(state) - wanted))
kiln.write(sys.stdout.buffer, nearest, text)
END
}

@test "a Python stage between sinter and bondify, binary and text" {
    write_nearest
    "$ANALYZE" select --density 0.7 "$SINTERED" | "$BONDIFY" | "$ANALYZE" bonds >expected.json
    "$PYTHON" nearest.py 0.72 <"$SINTERED" | "$BONDIFY" | "$ANALYZE" bonds >binary.json
    "$PYTHON" nearest.py 0.72 --text <"$SINTERED" | "$BONDIFY" | "$ANALYZE" bonds >text.json
    cmp expected.json binary.json
    cmp expected.json text.json
}

@test "a Python stage in place of analyze fit" {
    sed -n "/^cat >fit.py/,/^END/p" "$ROOT/docs/replace-a-stage.md" | bash
    "$BONDIFY" -q "$SINTERED" | "$BEND" -q | "$ANALYZE" modulus >modulus.json
    "$ANALYZE" fit --law knudsen modulus.json >expected.json
    "$PYTHON" fit.py <modulus.json >swapped.json
    near "$(jq .E0 swapped.json)" "$(jq .E0 expected.json)" 0.2
    near "$(jq .b swapped.json)" "$(jq .b expected.json)" 0.2
}

@test "text between all stages gives the numbers that binary gives" {
    "$ANALYZE" select --index 1,2,3 "$SINTERED" | "$BONDIFY" -q | "$BEND" -q | "$ANALYZE" modulus >binary.json
    "$ANALYZE" select --index 1,2,3 --text "$SINTERED" | "$BONDIFY" -q --text | "$BEND" -q | "$ANALYZE" modulus >text.json
    cmp binary.json text.json
}

@test "every stage of the pipe is called through its variable" {
    for stage in SINTER BONDIFY BEND ANALYZE; do
        printf '#!/bin/bash\necho %s >>called\nexec %s "$@"\n' "$stage" "${!stage}" >"$stage"
        chmod +x "$stage"
    done
    "$ROOT/workflows/paper/pipe.sh" 400 2 >expected.json
    env SINTER=./SINTER BONDIFY=./BONDIFY BEND=./BEND ANALYZE=./ANALYZE "$ROOT/workflows/paper/pipe.sh" 400 2 >wrapped.json
    cmp expected.json wrapped.json
    run -0 bash -c 'sort called | uniq -c | tr -s " "'
    assert_output $' 2 ANALYZE\n 1 BEND\n 1 BONDIFY\n 2 SINTER'
}

# h^3 = h0^3 + 3.375 Delta gamma t/R*: the law of an isolated pair (physics: Parhami and McMeeking's contact, alpha 9/2, beta 4).
@test "two spheres written by hand go through sinter and meet the pair law" {
    cat >pair.jsonl <<'END'
{"box":{"vectors":[[1e-6,0,0],[0,1e-6,0],[0,0,1e-6]],"periodic":[false,false,false]},"materials":[{"name":"mine","density":3950,"surface_energy":1.1,"diffusion_parameter":7.79e-35}],"particles":{"position":{"type":"f8","shape":[2,3],"data":[4e-7,5e-7,5e-7,4.69e-7,5e-7,5e-7]},"radius":{"type":"f8","shape":[2],"data":[5e-8,2e-8]}}}
END
    "$SINTER" --temperature 1200C --at-time 0.5s,20s --text pair.jsonl >grown.jsonl
    for row in 1 2; do
        overlap=$(sed -n "${row}p" grown.jsonl | jq '.particles.position.data as $x | 7e-8 - ($x[3] - $x[0])')
        time=$(sed -n "${row}p" grown.jsonl | jq .time)
        expected=$(jq -n --argjson t "$time" '(1e-27 + 3.375 * 7.79e-35 * 1.1 * $t / (5e-8 * 2e-8 / 7e-8)) | cbrt')
        near "$overlap" "$expected" 1e-6
    done
    near "$time" 20 1e-9
}
