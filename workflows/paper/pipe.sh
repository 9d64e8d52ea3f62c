#!/bin/bash
# pipe.sh: the whole paper as one shell pipe, from particles to the law of Young's modulus. Usage: pipe.sh [PARTICLES [SEED]]
set -euo pipefail
bin=$(dirname "$0")/../../build/bin
SINTER=${SINTER:-$bin/sinter} BONDIFY=${BONDIFY:-$bin/bondify} BEND=${BEND:-$bin/bend} ANALYZE=${ANALYZE:-$bin/analyze}

$SINTER green -n "${1:-99000}" --diameter 100nm --density 0.43 --aspect 4:1:1 --seed "${2:-1}" |
    $SINTER --temperature 1200C --to-density 0.67,0.71,0.79,0.88 |
    $BONDIFY |
    $BEND |
    $ANALYZE modulus |
    $ANALYZE fit --law knudsen --weights equal
