#!/usr/bin/env bash
# Runs the unit tests and the Bats files given as arguments (all of tests/cli by default) and ends with "N passed, M failed".
# BUILD is the build folder; UNIT=0 leaves the unit tests out.
set -uo pipefail
cd "$(dirname "$0")/.."
build=${BUILD:-build}
case $build in /*) ;; *) build=$PWD/$build ;; esac
export BUILD="$build"
export SINTER="${SINTER:-$build/bin/sinter}" BONDIFY="${BONDIFY:-$build/bin/bondify}"
export BEND="${BEND:-$build/bin/bend}" ANALYZE="${ANALYZE:-$build/bin/analyze}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
passed=0 failed=0

if [ "${UNIT:-1}" = 1 ]; then
    "$build/test/unit" --no-colors=true | tee "$log"
    unit_status=${PIPESTATUS[0]}
    read -r ok bad < <(sed -nE 's/^\[doctest\] test cases: *[0-9]+ \| *([0-9]+) passed \| *([0-9]+) failed.*/\1 \2/p' "$log")
    if [ -z "${ok:-}" ]; then  # no summary: the program itself broke down
        ok=0 bad=1
    elif [ "$unit_status" -ne 0 ] && [ "$bad" -eq 0 ]; then
        bad=1
    fi
    passed=$((passed + ok)) failed=$((failed + bad))
fi

files=("$@")
[ ${#files[@]} -gt 0 ] || files=(tests/cli/*.bats)
# A file a processor, where GNU parallel is there to do it.
jobs=()
! command -v parallel >/dev/null || [ "$(nproc)" -lt 2 ] || jobs=(--jobs "$(nproc)" --no-parallelize-within-files)
bats --tap "${jobs[@]}" "${files[@]}" | tee "$log"
bats_status=${PIPESTATUS[0]}
bad=$(grep -c '^not ok' "$log")
[ "$bats_status" -eq 0 ] || [ "$bad" -gt 0 ] || bad=1
passed=$((passed + $(grep -c '^ok' "$log"))) failed=$((failed + bad))

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
