#!/usr/bin/env bats
# docs.bats: every command that the documentation fences as sh runs, and every change that it shows applies and compiles.
bats_require_minimum_version 1.5.0
load helper.bash

# Green bodies of the documentation have this many particles here, so that a page takes seconds.
: "${DOC_PARTICLES:=400}"
: "${STUDY_PARTICLES:=60}" # of each packing of a study

# A folder that looks like the source from within, but for what the commands write, and the programs under their names.
setup() {
    cd "$BATS_TEST_TMPDIR"
    mkdir -p tree/build/bin home
    cd tree
    for name in "$ROOT"/*; do [ "${name##*/}" = build ] || ln -s "$name" .; done
    for name in SINTER BONDIFY BEND ANALYZE; do ln -s "$(realpath "${!name}")" "build/bin/${name,,}"; done
    ln -s "$ROOT"/workflows/post/dem-{convert,view} build/bin/
    export HOME="$BATS_TEST_TMPDIR/home" PYTHONDONTWRITEBYTECODE=1
}

# What a page fences as a language.
fenced() { sed -n "/^\`\`\`$1\$/,/^\`\`\`\$/p" "$ROOT/$2" | grep -v '^```'; }

# Runs a page from top to bottom in one shell, with small green bodies; targets that build or test are only looked up.
run_page() {
    {
        printf '%s\n' 'set -euo pipefail' "export PATH=$PWD/build/bin:\$PATH" \
            'make() { if [[ ${1-} == -C ]]; then command make "$@"; else command make -n BUILD="$REAL_BUILD" "$@" >/dev/null; fi; }'
        fenced sh "$1" | sed -E "s/green -n [0-9]+/green -n $DOC_PARTICLES/; s/^particles = .*/particles = $STUDY_PARTICLES/; s/^seeds = .*/seeds = 1/"
    } >page.sh
    REAL_BUILD="${BUILD:-$ROOT/build}" BIN="$PWD/build/bin" FORMATS=svg run -0 bash page.sh
    refute_output --regexp "\bnan\b"
}

@test "the commands of the README run" {
    run_page README.md
}

@test "the tutorial leads from powder to modulus" {
    run_page docs/tutorial.md
    [ -s tutorial/bonded.kiln ]
    assert_output --partial "Young's modulus, GPa"
    assert_output --partial "E0, GPa"
}

@test "constants of diffusion are found as the page says" {
    run_page docs/kinetics.md
    assert_output --regexp "narrowest master curve +3 +568\."
    assert_output --regexp "history.jsonl +3 "
}

@test "stages are replaced as the page says, in Python, in the shell and in a study" {
    run_page docs/replace-a-stage.md
    jq -e '.history[-1].arguments == ["--volume", "cap-corrected"]' <(head -1 mine/0.88/bonded.kiln)
}

@test "pipes, states and results in Python are as the page says" {
    run_page docs/python.md
    assert_line --regexp "^0\.80  [0-9]+ GPa"
    assert_line --regexp "^0\.(1|10000|09999)[0-9]*$"
}

@test "files go to other programs and come back as the page says" {
    run_page docs/formats.md
    assert_line '["alumina","zirconia"]'
}

@test "the drawing of state, neck and bond is drawn by its script" {
    run -0 "$PYTHON" "$ROOT/docs/figures/state_neck_bond.py" -o state.png
    run -0 "$PYTHON" - state.png "$ROOT/docs/figures/state.png" <<'END'
import sys
from matplotlib.image import imread
drawn, shown = map(imread, sys.argv[1:])
assert drawn.shape == shown.shape and abs(drawn - shown).mean() < 0.005, "the picture is not that of the script"
END
}

@test "powders: tables of sizes, lists of spheres and a furnace's log become bodies and firings" {
    run_page docs/powders.md
    assert_output --partial "asked for"
}

@test "materials: the built-in ones, one of one's own, and one without diffusion data" {
    run_page docs/materials.md
    assert_output --partial "is surface_energy meant?"
    assert_output --regexp "zirconia-3y +6050 "
}

@test "a study of one's own: a report, the same beside measurements, and cases" {
    run_page docs/study.md
    [ -s my-powder/results/report.html ]
    assert_output --partial "dL/L0 less that of the dilatometer"
    [ -s sizes-results/figures/comparison.svg ]
    assert_line --regexp "^Calibrated on the dilatometer: .* Q [0-9.]+ kJ/mol"
}

@test "bonds get their strength as the page says: from toughness and flaw, or calibrated" {
    run_page docs/strength.md
    assert_line "3.94e+08 Pa"
    assert_line "2.19e+10 Pa"
    calibrated=$(grep -oP '^\[0\.79[0-9]*,\K[0-9.e+]+|^\[0\.789[0-9]*,\K[0-9.e+]+' <<<"$output")
    near "$calibrated" 375666666.7 4e-3
}

@test "no page has commands that are not run here" {
    run -0 grep -lE '^```(sh|bash|console|shell)$' -r "$ROOT/docs" "$ROOT/README.md" "$ROOT/CONTRIBUTING.md"
    for page in "${lines[@]}"; do
        grep -qxF "    run_page ${page#"$ROOT"/}" "$BATS_TEST_FILENAME" || fail "$page has commands that no test runs"
    done
}

@test "the laws that the page adds apply to the tree, compile without a warning and pass the page's test" {
    rm lib tests tools
    cp -r "$ROOT/lib" "$ROOT/tests" "$ROOT/tools" .
    fenced diff docs/add-a-law.md >change
    GIT_CEILING_DIRECTORIES="$BATS_TEST_TMPDIR" git apply change
    compile() { g++ -std=c++20 -pthread -Wall -Wextra -Wconversion -Wshadow -Werror -Ilib -I. -isystem /usr/include/eigen3 "$@"; }
    compile -fsyntax-only tools/common/bond_model.cpp
    compile -fsyntax-only -x c++ - <<<'#include "physics/sinter_contact.h"'
    compile -o law lib/physics/bond_law.cpp lib/physics/solid_law.cpp tests/unit/stepped_law_test.cpp tests/main.cpp
    run -0 ./law
    assert_output --partial "6 passed"
}

@test "every file that a page names is there, or is made by a change that it shows" {
    for page in README.md CONTRIBUTING.md docs/*.md; do
        while read -r name; do
            compgen -G "$ROOT/$name*" >/dev/null || grep -qxF "+++ b/$name" "$ROOT/$page" || fail "$page names $name"
        done < <(grep -oP '(?<![\w/])(lib|tools|docs|tests|bench|workflows)/[\w./-]+\w' "$ROOT/$page" | sort -u)
    done
}
