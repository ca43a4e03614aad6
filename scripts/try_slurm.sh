#!/usr/bin/env bash
# Sends synthetic measurements through a Slurm of one node that it starts on this machine, kills two
# jobs on the way, and checks that nothing is missing in the end; then the same without Snakemake, as
# an array job. Must be run as root, when the release preset has been built. All that Slurm writes is
# in a temporary folder.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh
program=$PWD/build/release/bin/trilobe
shards=4

((EUID == 0)) || die "this starts Slurm's daemons as root; run it as root"
[[ -x $program ]] || die "there is no $program; build it first, as by ./run"
setup_packages spread slurm

unset "${!SLURM_@}" "${!SBATCH_@}" # another cluster is none of its business
dir=$(mktemp -d)
daemons=()
workflow=

# await SECONDS COMMAND...: until COMMAND succeeds.
await() {
  local deadline=$((SECONDS + $1))
  shift
  until "$@"; do
    ((SECONDS < deadline)) || return 1
    sleep 0.2
  done
}

not_running() { ! kill -0 "$1" 2>/dev/null; }
no_job_left() { [[ -z $(squeue --noheader 2>/dev/null) ]]; }

stop_all() {
  local status=$? daemon
  trap - EXIT
  set +e
  if [[ -n $workflow ]] && kill -0 "$workflow" 2>/dev/null; then
    kill -KILL "$workflow" # a milder signal lets it wait for its jobs
    wait "$workflow"
  fi
  if [[ -n ${SLURM_CONF:-} ]] && ! no_job_left; then
    scancel --state=PENDING --user=root 2>/dev/null
    scancel --signal=KILL --user=root 2>/dev/null
    await 20 no_job_left
  fi
  # munged last: the others ask it who speaks to them.
  for ((k = ${#daemons[@]} - 1; k >= 0; --k)); do
    daemon=${daemons[k]}
    kill "$daemon" 2>/dev/null
    await 20 not_running "$daemon" || kill -KILL "$daemon"
    wait "$daemon"
  done 2>/dev/null
  if ((status != 0)) && [[ -d $dir/log ]]; then
    tail -n 20 "$dir"/log/* "$dir"/fits/shards/*.log >&2
  fi
  rm -rf "$dir"
  exit "$status"
}
trap stop_all EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

# daemon NAME COMMAND...: starts one that stays in the foreground.
daemon() {
  local log=$dir/log/$1.log
  shift
  "$@" >"$log" 2>&1 </dev/null &
  daemons+=($!)
}

start_slurm() {
  local host ports
  host=$(hostname -s)
  read -ra ports < <(/usr/bin/python3 -c '
import socket
free = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
print(*(s.getsockname()[1] for s in free))')
  chmod 711 "$dir" # for munged, whose socket must be within everyone's reach
  mkdir -p "$dir"/{log,state,spool}
  mkdir -m 755 "$dir/munge"
  cat >"$dir/slurm.conf" <<END
ClusterName=trial
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports[0]}
SlurmdPort=${ports[1]}
SlurmUser=root
AuthInfo=socket=$dir/munge/socket
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
# Needs no cgroups; with linuxproc, what a shell had started outlives it when it is killed.
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
NodeName=$host NodeAddr=127.0.0.1 CPUs=2
PartitionName=all Nodes=ALL Default=YES
END
  export SLURM_CONF=$dir/slurm.conf

  mungekey --create --keyfile="$dir/munge/key"
  daemon munged munged --foreground --key-file="$dir/munge/key" --socket="$dir/munge/socket" \
    --pid-file="$dir/munge/pid" --seed-file="$dir/munge/seed"
  await 30 test -S "$dir/munge/socket" || die "munged does not start"
  daemon slurmctld slurmctld -D -c -f "$SLURM_CONF"
  daemon slurmd slurmd -D -f "$SLURM_CONF"
  await 60 node_is_idle || die "the node does not come up"
}

node_is_idle() { [[ $(sinfo --noheader --format=%T 2>/dev/null) == idle ]]; }

# state_of JOB, log_of JOB: as Slurm knows them.
state_of() { scontrol --oneliner show job "$1" | grep -oP '\bJobState=\K\w+'; }
log_of() { scontrol --oneliner show job "$1" | grep -oP '\bStdOut=\K\S+'; }
has_ended() { [[ $(state_of "$1") != @(RUNNING|COMPLETING) ]]; }

# A job that has fitted one measurement and is at the next one, in $job, and its process in $fit.
find_running_fit() {
  local pid
  ! not_running "$workflow" || die "the batch ended before a fit could be stopped"
  for job in $(squeue --noheader --states=RUNNING --name=trilobe-shard --format=%A); do
    grep -q ': fitted' "$(log_of "$job")" 2>/dev/null || continue
    for pid in $(scontrol listpids "$job" 2>/dev/null | awk 'NR > 1 && $1 > 0 { print $1 }'); do
      if [[ $(ps --no-headers --format comm --pid "$pid") == trilobe ]]; then
        fit=$pid
        return
      fi
    done
  done
  return 1
}

# stop_job OPTION...: scancel OPTION... of a job in the midst of its fits.
stop_job() {
  local state=
  until [[ $state == CANCELLED ]]; do # COMPLETED, when the job was faster
    await 300 find_running_fit || die "no fit was seen running"
    scancel "$@" "$job"
    await 60 has_ended "$job" || die "scancel $* $job does not end the job"
    await 10 not_running "$fit" || die "scancel $* $job leaves its fit running"
    state=$(state_of "$job")
  done
  step "scancel $*${*:+ }$job ended the job in the midst of its fits"
}

# expect WHAT HAS WANTED
expect() { [[ $2 == "$3" ]] || die "$1: $2 instead of $3"; }

start_slurm
step "Slurm $(sinfo --version | cut -d' ' -f2) is up in $SECONDS s"

options=(--solver=awls --max_iterations=2 --lobes=1 --max_angle=30)
mapfile -t names < <("$program" synth | awk '/^  / { print $1 }')
fits=$dir/fits
start=$SECONDS
snakemake --profile "$PWD/scripts/slurm" --snakefile scripts/fit_batch.smk --directory "$dir" \
  --latency-wait 5 --config sources="${names[*]/#/synth:}" out="$fits" shards=$shards \
  program="$program" options="${options[*]}" \
  >"$dir/log/snakemake.log" 2>&1 </dev/null &
workflow=$!
stop_job --signal=KILL
stop_job
wait "$workflow" || die "the batch failed"
workflow=
elapsed=$((SECONDS - start))
await 30 no_job_left || die "jobs are left"

for name in "${names[@]}"; do
  for file in model.json report.json; do
    [[ -s $fits/$name/$file ]] || die "there is no $name/$file"
  done
done
expect "lines of fits.csv" "$(wc -l <"$fits/fits.csv")" $((${#names[@]} + 1))
expect "measurements kept in fits.csv" "$(grep -c ',kept,' "$fits/fits.csv")" ${#names[@]}
expect "temporary files" "$(find "$fits" -name '.*trilobe-tmp-*' | wc -l)" 0
expect "jobs" "$(grep -c '^Submitted job' "$dir/log/snakemake.log")" $((shards + 2 + 1))
kept=$(cat "$fits"/shards/*-of-$shards.log | grep -c '^\[.*: kept')
((kept >= 2)) || die "jobs that were run again kept $kept fits of at least 2"
step "$shards shards fitted ${#names[@]} measurements in $elapsed s; 2 were run again, and kept $kept fits"

# The commands of docs/batch.md.
array=$dir/array
mkdir "$array"
command="'$program' fit ${names[*]/#/synth:} --out='$array' --threads=1 ${options[*]}"
start=$SECONDS
job=$(sbatch --parsable --array=1-$shards --output="$array/shard-%a.log" \
  --wrap="$command --shard=\$SLURM_ARRAY_TASK_ID/$shards")
sbatch --wait --dependency="afterany:$job" --output="$array/gather.log" --wrap="$command" \
  >/dev/null || die "gathering the array job failed"
expect "lines of fits.csv of the array job" "$(wc -l <"$array/fits.csv")" $((${#names[@]} + 1))
expect "measurements that it kept" "$(grep -c ',kept,' "$array/fits.csv")" ${#names[@]}
step "An array job of $shards did the same in $((SECONDS - start)) s"
