#!/usr/bin/env bash
# slurm.sh: a Slurm of one node with two processors, for tests: slurm.sh start FOLDER; slurm.sh stop FOLDER
#
# Everything of it stands in FOLDER: configuration, keys, sockets, logs, states of jobs. Its ports are free ones, munge has a key
# and a socket of its own, and nothing of systemd or of the machine's name is needed, so a Slurm of the machine does not notice it.
# Its clients are told by SLURM_CONF=FOLDER/slurm.conf. Jobs run as the user who starts it.
set -euo pipefail
command=$1 folder=$(realpath -m "$2")

configure() {
    local host me ports
    host=$(uname -n) me=$(id -un)
    ports=($(/usr/bin/python3 -c '
import socket
sockets = [socket.socket() for _ in range(2)]
for each in sockets:
    each.bind(("127.0.0.1", 0))
print(*(each.getsockname()[1] for each in sockets))'))
    cat >"$folder/slurm.conf" <<CONF
ClusterName=kiln-test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$me
SlurmdUser=$me
SlurmctldPort=${ports[0]}
SlurmdPort=${ports[1]}
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,bf_interval=1
SlurmdParameters=config_overrides
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$folder/jobs.txt
MpiDefault=none
MailProg=/bin/true
ReturnToService=2
KillWait=2
NodeName=node NodeHostname=$host NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000000 State=UNKNOWN
PartitionName=tests Nodes=node Default=YES MaxTime=INFINITE OverSubscribe=NO State=UP
CONF
}

# The daemons, each a child that writes what it says into a log; no descriptor of the caller stays open in them.
launch() {
    local name=$1
    shift
    "$@" </dev/null >>"$folder/$name.out" 2>&1 3>&- 4>&- &
    echo $! >"$folder/$name.child"
}

# wait_for SECONDS SENTENCE COMMAND…
wait_for() {
    local until=$((SECONDS + $1)) sentence=$2
    shift 2
    until "$@" >/dev/null 2>&1; do
        if ((SECONDS > until)); then
            echo "slurm.sh: $sentence" >&2
            tail -n 5 "$folder"/*.log "$folder"/*.out >&2
            stop
            exit 1
        fi
        sleep 0.2
    done
}

start() {
    mkdir -p "$folder"/{state,spool}
    chmod 700 "$folder"
    configure
    (umask 077 && head -c 128 /dev/urandom >"$folder/munge.key")
    export SLURM_CONF="$folder/slurm.conf"
    # --force: that other users cannot get at its socket is meant.
    launch munged /usr/sbin/munged --foreground --force --num-threads=2 --key-file="$folder/munge.key" \
        --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
        --log-file="$folder/munged.log" --seed-file="$folder/munge.seed"
    wait_for 10 "munged does not answer" munge -n --socket="$folder/munge.socket"
    launch slurmctld slurmctld -D -f "$SLURM_CONF"
    wait_for 20 "slurmctld does not answer" scontrol ping
    launch slurmd slurmd -D -N node -f "$SLURM_CONF"
    wait_for 30 "the node does not get ready" bash -c 'sinfo -h -n node -o %T | grep -qx idle'
}

stop() {
    local name child
    if [ -e "$folder/slurmd.child" ]; then  # jobs outlive slurmd otherwise
        export SLURM_CONF="$folder/slurm.conf"
        timeout 5 scancel --user="$(id -un)" || true
        timeout 5 bash -c 'while squeue -h | grep -q .; do sleep 0.2; done' || true
    fi
    for name in slurmd slurmctld munged; do
        [ -e "$folder/$name.child" ] || continue
        child=$(cat "$folder/$name.child")
        kill "$child" 2>/dev/null || true
        for _ in $(seq 50); do
            kill -0 "$child" 2>/dev/null || break
            sleep 0.1
        done
        kill -9 "$child" 2>/dev/null || true
        rm -f "$folder/$name.child"
    done
}

case $command in
    start) start ;;
    stop) stop ;;
    *) echo "usage: slurm.sh start|stop FOLDER" >&2 && exit 2 ;;
esac
