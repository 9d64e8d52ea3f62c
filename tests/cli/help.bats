#!/usr/bin/env bats
# help.bats: every --help is 100 columns wide, has its options in one order, and shows commands that run.
bats_require_minimum_version 1.5.0
load helper.bash

# Every command that has a --help of its own, a line each: a subcommand of analyze comes by being listed there.
commands() {
    printf '%s\n' sinter "sinter green" bondify bend analyze dem-convert dem-view
    "$ANALYZE" --help | sed -nE '/^Subcommands/,/^$/ s/^  ([a-z]+) {2,}.*/analyze \1/p'
}

help_of() { COLUMNS=100 "$@" --help; }

# The commands below "Examples:", to the end of the help.
examples_of() { help_of "$@" | sed -nE '/^[Ee]xamples?:$/,$ { /^ / p }'; }

setup_file() {
    export PARTICLES=500 FILES="$BATS_FILE_TMPDIR/files" PYTHONDONTWRITEBYTECODE=1 OMP_NUM_THREADS=1
    mkdir -p "$BATS_FILE_TMPDIR/bin" "$FILES"
    for name in SINTER BONDIFY BEND ANALYZE; do ln -s "$(realpath "${!name}")" "$BATS_FILE_TMPDIR/bin/${name,,}"; done
    ln -s "$ROOT"/workflows/post/dem-{convert,view} "$BATS_FILE_TMPDIR/bin/"
    # LAMMPS stands in for any neighbour that reads a data file and writes another.
    printf '#!/bin/sh\ncp bonded.data relaxed.data\n' >"$BATS_FILE_TMPDIR/bin/lmp"
    chmod +x "$BATS_FILE_TMPDIR/bin/lmp"
    export PATH="$BATS_FILE_TMPDIR/bin:$PATH"
    cd "$FILES"
    # The files that the examples name.
    sinter green -n "$PARTICLES" --aspect 4:1:1 -o green.kiln
    sinter --temperature 1200C --to-density 0.6,0.67,0.79,0.85 -o trajectory.kiln green.kiln
    analyze select --density 0.67,0.79 -o sintered.kiln trajectory.kiln
    sinter --temperature 1200C --boundary free --to-density 0.6 -o free.kiln green.kiln
    bondify -q -o bonded.kiln trajectory.kiln
    bend -o bent.json --states bent.kiln bonded.kiln
    analyze modulus -o moduli.json bent.json
    printf 'deflection (mm),force (N)\n0,0\n0.01,20\n0.015,30\n0.02,40\n0.025,50\n0.03,60\n0.025,50\n0.02,40\n0.015,30\n0.01,20\n' >bar7.csv
    printf 'deflection (mm),force (N)\n0,0\n0.01,20\n0.02,40\n0.03,60\n0.03,1\n' >broken.csv
    printf 'sample,force (N),width (mm),height (mm)\nA,90,4.01,3.00\nB,104,3.99,3.02\nC,110,4.00,3.01\n' >bars.csv
    printf 'strength (MPa)\n310\n352\n371\n388\n402\n431\n' >strengths.csv
    printf 'relative_density,young_modulus (GPa)\n0.70,121\n0.79,180\n0.88,262\n' >measured.csv
    printf '%s\n' 'temperature (C),5 K/min,10 K/min,20 K/min' 1150,0.607,0.602,0.597 1250,0.655,0.644,0.630 1350,0.739,0.717,0.691 \
        1450,0.842,0.818,0.784 >dilatometer.csv
    # A dump as LAMMPS writes it, with steps for times and no radii; a list of spheres, two species.
    dem-convert -q sintered.kiln packing.dump
    sed -i -e '/^ITEM: TIME$/,+1d' -e '/^ITEM: ATOMS/ s/ radius/ c_radius/' packing.dump
    printf '1.0 1.0 1.0 0.9\n1.8 1.0 1.0 0.8\n' >tomography.txt
    printf '2\nLattice="400 0 0 0 400 0 0 0 400" Properties=species:S:1:pos:R:3:radius:R:1\nAl 9 9 9 50\nZr 99 9 9 45\n' >mixed.xyz
    printf '{"name":"zirconia","density":6050,"young_modulus":2.1e11,"poisson_ratio":0.31}\n' >zirconia.json
    printf 'time (min),temperature (C)\n0,25\n120,1150\n130,1150\n190,25\n' >furnace.csv
    printf 'x (um),y (um),z (um),diameter (um)\n1,5,5,2\n2.9,5,5,2\n5,5,5,3\n8,5,5,3.4\n' >tomography.csv
}

@test "no line of a help is wider than 100 columns" {
    while read -ra command; do
        run -0 --separate-stderr awk 'length > 100 { print FNR ": " $0 }' <(help_of "${command[@]}")
        assert_output ""
    done < <(commands)
}

@test "a help whose reader goes away ends silently" {
    for name in SINTER BONDIFY BEND ANALYZE; do
        status=0
        { "${!name}" --help 2>said || status=$?; echo "$status" >status; } | true
        [ ! -s said ] || fail "${name,,} --help says: $(cat said)"
        assert_regex "$(cat status)" "^(0|141)$"
    done
}

@test "options stand in one order: those of the program, then the common ones" {
    common="--output( --text)? --quiet --verbose --threads --config --help --version"
    while read -ra command; do
        [[ ${command[0]} != dem-* ]] || continue
        options=$(help_of "${command[@]}" | sed -nE 's/^  (-[a-z],)?(--[a-z-]+)( .*)?$/\2/p' | paste -sd' ')
        [ "${command[*]}" = analyze ] || assert_regex "$options" " $common\$"
    done < <(commands)
}

@test "a value that is none is refused by every option that takes one, in a sentence that names it" {
    # What takes a file takes any word, and some are looked at once all options are known.
    free="--output --states --history --checkpoint --config --data --material --from --to --like --report --boundary --method --fix --confine --schedule --distribution --image --columns --spheres --time-column --temperature-column --curve --hold-out --grain-size --save-material --force-column --deflection-column --plot"
    while read -ra command; do
        [[ ${command[0]} != dem-* ]] || continue
        while read -r option; do
            [[ " $free " != *" $option "* ]] || continue
            run -2 --separate-stderr "${command[@]}" "$option" much </dev/null
            assert_regex "$stderr" "^${command[*]}: $option: .*'much'"
            assert_equal "${#stderr_lines[@]}" 1
        done < <(help_of "${command[@]}" | sed -nE 's/^  (-[a-z],)?(--[a-z-]+) [A-Z{].*$/\2/p')
        [ "${command[*]}" = analyze ] || {
            run -1 --separate-stderr "${command[@]}" --config absent.toml
            assert_equal "$stderr" "${command[*]}: --config: absent.toml cannot be read"
        }
    done < <(commands)
}

@test "bounds are said as numbers that can be given" {
    run -2 --separate-stderr "$BEND" --tolerance 5
    assert_equal "$stderr" "bend: --tolerance: 5 is not between 1e-14 and 0.01; see bend --help"
    run -2 --separate-stderr "$BEND" --cycles 1.5
    assert_equal "$stderr" "bend: --cycles: '1.5' is not a whole number; see bend --help"
    run -2 --separate-stderr "$BEND" --mass-scaling 0
    assert_equal "$stderr" "bend: --mass-scaling: 0 is not greater than 0; see bend --help"
    run -2 --separate-stderr "$BEND" --bond-law glue
    assert_equal "$stderr" "bend: --bond-law: 'glue' is none of auto, series, solid, neck, centre; see bend --help"
}

@test "every example of every help runs" {
    while read -ra command; do
        cd "$BATS_TEST_TMPDIR"
        rm -rf files
        cp -r "$FILES" files
        cd files
        examples_of "${command[@]}" | sed -E "s/green -n [0-9]+/green -n $PARTICLES/" >examples.sh
        [ -s examples.sh ] || fail "${command[*]} --help has no example"
        bash -euo pipefail examples.sh >said 2>&1 || fail "an example of ${command[*]} --help fails: $(cat said)"
        run -1 grep -w nan said
    done < <(commands)
}
