#!/usr/bin/env bash
# Runs the whole chain on one small packing, each method of each program once, and writes every output into FOLDER: chain.sh FOLDER
# [THREADS]
# Two folders are compared with diff: equal bytes mean that threads or builds make no difference.
set -euo pipefail
folder=$1 threads=${2:-1}
export OMP_NUM_THREADS=$threads
bin=${BUILD:-$(cd "$(dirname "$0")/.." && pwd)/build}/bin
SINTER=${SINTER:-$bin/sinter} BONDIFY=${BONDIFY:-$bin/bondify} BEND=${BEND:-$bin/bend} ANALYZE=${ANALYZE:-$bin/analyze}
mkdir -p "$folder"
cd "$folder"
fire=(-q --temperature 1200C)

"$SINTER" green -q -n 5000 --aspect 4:1:1 --method affine --compact-to 0.52 --seed 6 -o green.kiln
"$SINTER" green -q -n 300 --distribution lognormal:100nm:1.3 --aspect 4:1:1 --density 0.5 --seed 7 -o small.kiln
"$SINTER" "${fire[@]}" --to-density 0.55,0.7 --report viscosity --history history.jsonl -o sintered.kiln green.kiln
"$SINTER" "${fire[@]}" --at-time 20s --boundary free -o free.kiln small.kiln
"$SINTER" "${fire[@]}" --to-density 0.52 --method explicit -o explicit.kiln small.kiln
"$BONDIFY" -q -o bonded.kiln sintered.kiln
"$BONDIFY" -q --method sweep --decrement 0.01nm -o swept.kiln sintered.kiln
"$SINTER" "${fire[@]}" --to-density 0.65 small.kiln | "$BONDIFY" -q -o small-bonded.kiln
"$BEND" -q --cycles 2 --states states -o bend.json bonded.kiln
"$BEND" -q --tensile-strength 500MPa --until 0.7 --states broken -o strength.json small-bonded.kiln
"$BEND" -q --method dynamic --cycles 1 --points 3 --punch-velocity 0.05m/s -o dynamic.json small-bonded.kiln
for command in density bonds elastic; do "$ANALYZE" $command -q -o $command.json bonded.kiln; done
"$ANALYZE" modulus bend.json | tee modulus.json | "$ANALYZE" fit -q >fit.json
