#!/usr/bin/env bash
# status.sh: how a job of Slurm is, for Snakemake: running, success or failed: status.sh JOB
#
# A job that is killed cannot tell its end, so Snakemake asks here. scontrol remembers a job for some minutes (MinJobAge); of an
# older one sacct knows, where jobs are accounted for. While the controller does not answer, a job is taken for running.
set -uo pipefail
job=$1

if said=$(scontrol show job -o "$job" 2>&1); then
    state=$(sed -nE 's/.*\bJobState=([A-Z_]+).*/\1/p' <<<"$said")
elif [[ $said == *"Invalid job id"* ]]; then
    state=$(sacct -X -n -P -o State -j "$job" 2>/dev/null | head -n 1)
    state=${state:-FORGOTTEN}
else
    state=RUNNING
fi

case $state in
    COMPLETED) echo success ;;
    PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | STOPPED | SIGNALING | STAGE_OUT | RE[QS]*) echo running ;;
    *) echo failed ;;
esac
