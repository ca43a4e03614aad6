#!/usr/bin/env bash
# State of a Slurm job, in snakemake's words: scripts/slurm/status.sh JOB prints running, success or failed. A job that
# was killed cannot say so itself. Needs no accounting: the controller knows a job until MinJobAge (five minutes) after
# its end.
set -uo pipefail

job=${1%%;*} # sbatch --parsable may add the cluster's name
if answer=$(scontrol --oneliner show job "$job" 2>&1); then
  state=$(grep -oP '\bJobState=\K\w+' <<<"$answer" | head -n 1)
elif [[ $answer == *"Invalid job id"* ]]; then
  state=$(sacct --noheader --allocations --parsable2 --format=State --jobs="$job" 2>/dev/null |
    grep -oP '^\w+' | tail -n 1)
  # Done again, it finds the fits that there are.
  state=${state:-FAILED}
else
  echo "$answer" >&2
  state=UNKNOWN # the controller does not answer; that passes
fi

case $state in
  COMPLETED) echo success ;;
  BOOT_FAIL | CANCELLED | DEADLINE | FAILED | NODE_FAIL | OUT_OF_MEMORY | PREEMPTED | REVOKED | \
    TIMEOUT) echo failed ;;
  *) echo running ;;
esac
