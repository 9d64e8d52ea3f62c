#!/usr/bin/env bash
# Runs the whole chain on one small packing, each method of each program once, and writes every output into FOLDER: chain.sh FOLDER [THREADS]
# Two folders are compared with diff: equal bytes mean that threads or builds make no difference.
set -euo pipefail
folder=$1 threads=${2:-1}
export OMP_NUM_THREADS=$threads
bin=${BUILD:-$(cd "$(dirname "$0")/.." && pwd)/build}/bin
SINTER=${SINTER:-$bin/sinter} BONDIFY=${BONDIFY:-$bin/bondify} BEND=${BEND:-$bin/bend} ANALYZE=${ANALYZE:-$bin/analyze}
mkdir -p "$folder"
cd "$folder"
fire=(-q --temperature 1200C)

"$SINTER" green -q -n 5000 --aspect 4:1:1 --method affine --compact-to 0.52 --seed 6 --threads "$threads" -o green.kiln
"$SINTER" green -q -n 300 --distribution lognormal:100nm:1.3 --aspect 4:1:1 --density 0.5 --seed 7 --threads "$threads" -o small.kiln
"$SINTER" "${fire[@]}" --to-density 0.55,0.7 --report viscosity --history history.jsonl --threads "$threads" -o sintered.kiln green.kiln
"$SINTER" "${fire[@]}" --at-time 20s --boundary free --threads "$threads" -o free.kiln small.kiln
"$SINTER" "${fire[@]}" --to-density 0.52 --method explicit --threads "$threads" -o explicit.kiln small.kiln
"$BONDIFY" -q --threads "$threads" -o bonded.kiln sintered.kiln
"$BONDIFY" -q --method sweep --decrement 0.01nm --threads "$threads" -o swept.kiln sintered.kiln
"$SINTER" "${fire[@]}" --to-density 0.65 small.kiln --threads "$threads" | "$BONDIFY" -q --threads "$threads" -o small-bonded.kiln
"$BEND" -q --cycles 2 --threads "$threads" --states states -o bend.json bonded.kiln
"$BEND" -q --tensile-strength 500MPa --until 0.7 --threads "$threads" --states broken -o strength.json small-bonded.kiln
"$BEND" -q --method dynamic --cycles 1 --points 3 --punch-velocity 0.05m/s --threads "$threads" -o dynamic.json small-bonded.kiln
for command in density bonds elastic; do "$ANALYZE" $command -q --threads "$threads" -o $command.json bonded.kiln; done
"$ANALYZE" modulus --threads "$threads" bend.json | tee modulus.json | "$ANALYZE" fit -q --threads "$threads" >fit.json
