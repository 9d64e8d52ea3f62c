#!/usr/bin/env bats
# petsc.bats: --solver petsc: the moduli of the library's own solver, on one process and on two, which read, write and fail as one.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    # Every build says what is amiss; only one with PETSc goes on from there.
    if ! pkg-config --exists PETSc 2>/dev/null || ! command -v mpirun >/dev/null; then
        echo "# petsc.bats: NOT TESTED WITH PETSC: it or mpirun is not installed; 'make PETSC=1' installs them" >&3
        return
    fi
    [ -z "${SANITIZED-}" ] || return 0 # MPI leaks
    export PETSC_PROGRAMS="$BATS_FILE_TMPDIR/bin"
    # What the build that is tested has compiled already is taken as it is; what needs PETSc may be older than the headers.
    local build=${BUILD:-$ROOT/build} old=()
    for name in flags packages-present libkiln.a tools/{common,bend,analyze}.o; do old+=(-o "$build/$name"); done
    rm -f "$build"/tools/ranks/petsc.o "$build"/lib/petsc/*.o
    make -C "$ROOT" BUILD="$build" PETSC=1 BIN="$PETSC_PROGRAMS" "${old[@]}" "$PETSC_PROGRAMS"/{bend,analyze} \
        >"$BATS_FILE_TMPDIR/make.log" 2>&1 || { cat "$BATS_FILE_TMPDIR/make.log" >&2 && return 1; }
    cd "$BATS_FILE_TMPDIR"
    "$SINTER" green -q -n 400 --density 0.45 --method affine --compact-to 0.75 --aspect 6:1:1 --seed 1 | "$BONDIFY" -q -o bonded.kiln
}

setup() {
    cd "$BATS_FILE_TMPDIR"
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
}

# Of `make PETSC=1 test` these programs have it already.
without_petsc() { "$BEND" --solver petsc nonesuch 2>&1 | grep -q "no PETSc" || skip "this build has PETSc"; }

with_petsc() { [ -n "${PETSC_PROGRAMS-}" ] || skip "there is no PETSc"; }

# two PROGRAM ARGUMENT...: on two processes. What mpirun says itself is framed by dashes.
two() {
    local status=0
    mpirun -n 2 --oversubscribe "$PETSC_PROGRAMS/$1" "${@:2}" 2>said || status=$?
    sed '/^---/,/^---/d; /ORTE_ERROR_LOG/d' said >&2
    return $status
}

@test "a build without PETSc says how to build one with it" {
    without_petsc
    run -2 "$BEND" --solver petsc bonded.kiln
    assert_output "bend: --solver: this build has no PETSc; make PETSC=1 builds the programs with it; see bend --help"
    run -2 "$ANALYZE" elastic --solver petsc bonded.kiln
    assert_output --partial "make PETSC=1"
}

@test "several processes that would all do the same work are refused, by one of them" {
    without_petsc
    for names in "OMPI_COMM_WORLD_RANK OMPI_COMM_WORLD_SIZE" "PMI_RANK PMI_SIZE" "PMIX_RANK SLURM_STEP_NUM_TASKS"; do
        read -r rank size <<<"$names"
        for program in "$SINTER green -n 10 -o nothing" "$BEND -o nothing" "$ANALYZE density"; do
            run -2 --separate-stderr env "$rank=0" "$size=2" $program
            [[ $stderr == *"2 processes were started, and each would do the same work and write the same file"* ]]
        done
        run -0 env "$rank=0" "$size=1" "$SINTER" --version
    done
    run -2 --separate-stderr env OMPI_COMM_WORLD_RANK=1 OMPI_COMM_WORLD_SIZE=2 "$BEND"
    assert_equal "$output$stderr" ""
    [ ! -e nothing ]
}

@test "bench/peers.py measures without PETSc what can be, and says so" {
    without_petsc
    PYTHONDONTWRITEBYTECODE=1 PROGRAMS=$(dirname "$(realpath "$BEND")") run -0 --separate-stderr "$PYTHON" "$ROOT/bench/peers.py" elastic --table \
        --particles 300 --tolerances 1e-2,1e-6
    assert_equal "$stderr" "peers: this build has no PETSc (make PETSC=1): its rows are left out"
    assert_line --regexp "^modulus of a cell, 300 particles$"
    assert_line --regexp "^ *our own +0\.01 +[0-9.]+e-0[4-9] "
    assert_line --regexp "^ *our own +1e-06 +[0-9.]+e-(09|1[0-9]) "
    refute_output --partial "PETSc"
}

@test "what does not solve linear systems of bonds takes no solver" {
    with_petsc
    run -2 "$PETSC_PROGRAMS/bend" --solver petsc --method dynamic bonded.kiln
    assert_output --partial "has no meaning with --method dynamic"
    run -2 "$PETSC_PROGRAMS/analyze" elastic --solver petsc --model voxel bonded.kiln
    assert_output --partial "has no meaning with --model voxel"
    run -2 "$PETSC_PROGRAMS/bend" --solver pets bonded.kiln
}

@test "the elastic tensor of a cell is that of our own solver, on one process and two, from files and pipes" {
    with_petsc
    "$ANALYZE" elastic --tolerance 1e-10 bonded.kiln >own.json
    "$PETSC_PROGRAMS/analyze" elastic --solver petsc --tolerance 1e-10 bonded.kiln >one.json
    run -0 --separate-stderr two analyze elastic --solver petsc --tolerance 1e-10 -v -o cell.json bonded.kiln
    assert_equal "$output$stderr" ""
    cat bonded.kiln bonded.kiln >twice.kiln
    run -0 --separate-stderr two analyze elastic --solver petsc --tolerance 1e-10 <twice.kiln
    assert_equal "$stderr" ""
    diff <(echo "$output") <(cat cell.json cell.json)
    for file in one.json cell.json; do
        jq -e --slurpfile own own.json '.converged and .residual <= 1e-10 and ([.stiffness, $own[0].stiffness] | map(flatten) |
            transpose | all((.[0] - .[1] | fabs) <= 1e-8 * $own[0].young_modulus))' $file
    done
}

@test "bars bend and break as by our own solver, and the bent state says by which" {
    with_petsc
    "$BEND" -q --tolerance 1e-8 -o own.json bonded.kiln
    "$PETSC_PROGRAMS/bend" -q --solver petsc --tolerance 1e-8 -o one.json bonded.kiln
    run -0 --separate-stderr two bend -q --solver petsc --tolerance 1e-8 --states bent.kiln -o two.json bonded.kiln
    assert_equal "$output$stderr" ""
    slope() { "$ANALYZE" modulus "$1" | jq .slope; }
    near "$(slope one.json)" "$(slope own.json)" 1e-7
    near "$(slope two.json)" "$(slope own.json)" 1e-7
    head -1 bent.kiln | jq -e '.history[-1] | .tool == "bend" and .arguments[:2] == ["--tolerance", "1e-8"]
        and (.arguments | index("petsc"))'
    "$BEND" -q --tensile-strength 500MPa bonded.kiln >own.json
    run -0 --separate-stderr two bend -q --solver petsc --tensile-strength 500MPa bonded.kiln
    jq -e --slurpfile own own.json '.strength | .breaks == $own[0].strength.breaks and
        (.bending_strength / $own[0].strength.bending_strength - 1 | fabs) < 1e-3' <<<"$output"
}

@test "what all processes meet is said once; what one of them meets ends the others" {
    with_petsc
    "$SINTER" green -q -n 10 -o loose.kiln
    run -1 --separate-stderr two analyze elastic --solver petsc -o out.json loose.kiln
    assert_equal "$stderr" "analyze elastic: loose.kiln, document 1: the state has no bonds; run bondify first"
    run -1 --separate-stderr two bend --solver petsc -o out.json nonesuch.kiln
    assert_equal "$stderr" "bend: nonesuch.kiln: cannot be opened: No such file or directory"
    run -1 --separate-stderr two bend --solver petsc -o nonesuch/out.json bonded.kiln
    assert_equal "$stderr" "bend: nonesuch/out.json: cannot be written: No such file or directory"
    run -2 --separate-stderr two bend --solver petsc --cycles 0 -o out.json bonded.kiln
    assert_equal "${#stderr_lines[@]}" 1
    run -0 two bend --version
    assert_equal "${#lines[@]}" 1
    # A file of options that the second machine does not have.
    run -1 --separate-stderr mpirun --oversubscribe -n 1 "$PETSC_PROGRAMS/bend" --solver petsc -o out.json bonded.kiln : \
        -n 1 "$PETSC_PROGRAMS/bend" --solver petsc --config nonesuch.toml bonded.kiln
    assert_equal "$(grep ^bend <<<"$stderr")" "bend (process 2): --config: nonesuch.toml cannot be read"
    [ ! -e out.json ]
}

@test "on two processes nothing runs without --solver petsc" {
    with_petsc
    for program in "analyze elastic bonded.kiln" "analyze density bonded.kiln" "bend bonded.kiln"; do
        run -2 --separate-stderr two $program -o out.json
        assert_equal "${#stderr_lines[@]}" 1
        [[ $stderr == *"2 processes were started"* ]]
    done
    [ ! -e out.json ]
}

@test "under a real Slurm, by srun and by mpirun in a job" {
    with_petsc
    for program in slurmctld slurmd munged srun; do
        PATH="$PATH:/usr/sbin" type -P $program >/dev/null && continue
        echo "# petsc.bats: NOT TESTED ON A CLUSTER: there is no $program; 'make optional-packages' installs it" >&3
        skip "there is no $program"
    done
    "$ROOT/tests/slurm.sh" start slurm
    export SLURM_CONF="$PWD/slurm/slurm.conf"
    run -0 --separate-stderr srun -n 2 --mpi=pmix "$PETSC_PROGRAMS/analyze" elastic --solver petsc --tolerance 1e-10 bonded.kiln
    diff <(echo "$output") cell.json
    run -2 --separate-stderr srun -n 2 --mpi=pmix "$PETSC_PROGRAMS/analyze" elastic bonded.kiln
    assert_equal "$(grep -c "2 processes were started" <<<"$stderr")" 1
    printf '#!/bin/bash\n%s\n' "mpirun $PETSC_PROGRAMS/analyze elastic --solver petsc --tolerance 1e-10 -o $PWD/job.json $PWD/bonded.kiln" >job.sh
    sbatch -W --ntasks=2 --output=job.log job.sh || fail "$(cat job.log)"
    diff job.json cell.json
}

teardown_file() { [ ! -d "$BATS_FILE_TMPDIR/slurm" ] || "$ROOT/tests/slurm.sh" stop "$BATS_FILE_TMPDIR/slurm"; }
