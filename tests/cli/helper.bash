# helper.bash: what every Bats file loads: assertions, the programs (from the environment, else from build/bin), the data of the
# tests, values of a JSON output and a comparison of numbers.
load /usr/lib/bats/bats-support/load
load /usr/lib/bats/bats-assert/load

ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
: "${SINTER:=$ROOT/build/bin/sinter}" "${BONDIFY:=$ROOT/build/bin/bondify}"
: "${BEND:=$ROOT/build/bin/bend}" "${ANALYZE:=$ROOT/build/bin/analyze}" "${PYTHON:=/usr/bin/python3}"
export SINTER BONDIFY BEND ANALYZE PYTHON
# States of a few hundred particles are done soonest on one thread, and tests may share the machine.
export OMP_NUM_THREADS="${OMP_NUM_THREADS:-1}"

DATA="$ROOT/tests/data"

value() { jq -r "$1" <<<"$output"; } # of what the last run wrote, by a filter of jq

# near A B TOLERANCE: fails, and says so, unless |A - B| <= TOLERANCE |B|.
near() {
    awk -v a="$1" -v b="$2" -v tolerance="$3" \
        'BEGIN { d = a - b; if (d < 0) d = -d; m = b < 0 ? -b : b; exit !(d <= tolerance * m) }' ||
        fail "$1 is not within $3 of $2"
}
