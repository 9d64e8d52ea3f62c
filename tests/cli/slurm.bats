#!/usr/bin/env bats
# slurm.bats: the ensemble of packings x temperatures under Snakemake on a real Slurm of one node: jobs queue, killed ones are made
# again, and every file is the same as after a run without a cluster.
bats_require_minimum_version 1.5.0
load helper.bash

STATUS="$ROOT/workflows/ensemble/slurm/status.sh"

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    mkdir packings temperatures bin
    for seed in 1 2; do printf 'particles = 150\nmethod = "affine"\ncompact-to = 0.6\naspect = "4:1:1"\nseed = %s\n' $seed >packings/$seed.toml; done
    for pair in 1100C:0.67 1250C:0.8; do
        printf 'temperature = "%s"\nto-density = "%s"\n' "${pair%:*}" "${pair#*:}" >"temperatures/${pair%:*}.toml"
    done
}

setup() { cd "$BATS_FILE_TMPDIR"; }

teardown() { [ ! -e snakemake.pid ] || kill -9 "$(cat snakemake.pid)" 2>/dev/null || true; }

teardown_file() { "$ROOT/tests/slurm.sh" stop "$BATS_FILE_TMPDIR/slurm"; }

# ensemble FOLDER OPTION...: the study by Snakemake, with programs of the folder $programs.
ensemble() {
    local out=$1
    shift
    CI=true snakemake --scheduler greedy -s "$ROOT/workflows/ensemble/Snakefile" "$@" --config out="$PWD/$out" packings="$PWD/packings" \
        temperatures="$PWD/temperatures" bin="$programs" # CI: Snakemake asks for the state of jobs every second, not every ten
}

# Until a file is there, a minute at most.
await() {
    for _ in $(seq 300); do
        [ ! -s "$1" ] || return 0
        sleep 0.2
    done
    fail "there is no $1 after a minute"
}

@test "a real Slurm: jobs queue, a cancelled one and a killed one are made again, the files are those of a local run" {
    for program in snakemake slurmctld slurmd munged sbatch; do
        PATH="$PATH:/usr/sbin" type -P $program >/dev/null && continue
        echo "# slurm.bats: NOT TESTED ON A CLUSTER: there is no $program; 'make optional-packages' installs it" >&3
        skip "there is no $program"
    done
    programs=$(dirname "$(realpath "$ANALYZE")") ensemble local -c2 -q all

    # The first firing sleeps until it is cancelled; the first bar takes its whole job down at once.
    for program in sinter bondify bend analyze; do ln -s "$(realpath "$ANALYZE" | sed "s/analyze$/$program/")" bin/$program-itself; done
    printf '#!/bin/sh\nexec %s "$@"\n' "$PWD/bin/bondify-itself" >bin/bondify
    printf '#!/bin/sh\nexec %s "$@"\n' "$PWD/bin/analyze-itself" >bin/analyze
    cat >bin/sinter <<END
#!/bin/bash
if [[ \$1 != green ]] && mkdir $PWD/first-firing 2>/dev/null; then
    echo \$SLURM_JOB_ID >$PWD/sleeping
    sleep 300
fi
exec $PWD/bin/sinter-itself "\$@"
END
    cat >bin/bend <<END
#!/bin/bash
if mkdir $PWD/first-bar 2>/dev/null; then
    echo \$SLURM_JOB_ID >$PWD/killed
    kill -9 0
fi
exec $PWD/bin/bend-itself "\$@"
END
    chmod +x bin/{sinter,bondify,bend,analyze}

    "$ROOT/tests/slurm.sh" start slurm
    export SLURM_CONF="$PWD/slurm/slurm.conf"
    programs="$PWD/bin" ensemble cluster --profile "$ROOT/workflows/ensemble/slurm" >snakemake.log 2>&1 3>&- &
    local running=$!
    echo $running >snakemake.pid
    await sleeping
    for _ in $(seq 50); do
        squeue >queue.log
        [ "$(grep -c " PD " queue.log)" -lt 3 ] || break
        sleep 0.2
    done
    assert_equal "$(grep -c " PD " queue.log) $(grep -c " R " queue.log)" "3 1"
    scancel "$(cat sleeping)"
    wait $running || fail "$(tail -n 40 snakemake.log)"

    diff -r local cluster
    # 2 green bodies, 4 firings, 4 times bonds and bars, and the two that were made again.
    assert_equal "$(sed -nE 's/.* JobState=([A-Z]+) .*/\1/p' slurm/jobs.txt | sort | uniq -c | awk '{print $2, $1}' | paste -sd,)" \
        "CANCELLED 1,COMPLETED 14,FAILED 1"
    run -0 grep -E "^JobId=($(cat sleeping)|$(cat killed)) " slurm/jobs.txt
    assert_line --regexp "kiln-sinter .*JobState=CANCELLED"
    assert_line --regexp "kiln-bend .*JobState=FAILED"
    assert_equal "$(grep -c "Trying to restart job" snakemake.log)" 2
    run -0 "$STATUS" 1
    assert_output success
    run -0 "$STATUS" "$(cat killed)"
    assert_output failed
    run -0 "$STATUS" 999
    assert_output failed
    [ -z "${SLURM_LOG-}" ] || cat queue.log slurm/jobs.txt snakemake.log >"$SLURM_LOG"

    local daemons=$(cat slurm/*.child)
    "$ROOT/tests/slurm.sh" stop slurm
    for each in $daemons; do ! kill -0 "$each" 2>/dev/null || fail "a daemon is left, process $each"; done
}

@test "the state of a job, as Slurm says it" {
    mkdir -p stubs
    printf '#!/bin/sh\n%s\n' 'echo "JobId=7 JobName=x JobState=$STATE Reason=None"' >stubs/scontrol
    printf '#!/bin/sh\nexit 1\n' >stubs/sacct
    chmod +x stubs/*
    export PATH="$PWD/stubs:$PATH"
    for each in PENDING:running RUNNING:running COMPLETING:running CONFIGURING:running REQUEUED:running SUSPENDED:running COMPLETED:success \
        FAILED:failed CANCELLED:failed TIMEOUT:failed NODE_FAIL:failed OUT_OF_MEMORY:failed PREEMPTED:failed REVOKED:failed; do
        STATE=${each%:*} run -0 "$STATUS" 7
        assert_equal "$each" "${each%:*}:$output"
    done
    # The controller is away for a while; then it has forgotten the job, which sacct knows or does not.
    printf '#!/bin/sh\necho "slurm_load_jobs error: Unable to contact slurm controller (connect failure)" >&2; exit 1\n' >stubs/scontrol
    run -0 "$STATUS" 7
    assert_output running
    printf '#!/bin/sh\necho "slurm_load_jobs error: Invalid job id specified" >&2; exit 1\n' >stubs/scontrol
    run -0 "$STATUS" 7
    assert_output failed
    for each in "COMPLETED:success" "CANCELLED by 0:failed"; do
        printf '#!/bin/sh\necho "%s"\n' "${each%:*}" >stubs/sacct
        run -0 "$STATUS" 7
        assert_output "${each#*:}"
    done
}
