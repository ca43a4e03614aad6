#!/usr/bin/env bash
# Fuzzes for long: scripts/fuzz_long.sh [READER|all] [RUNS] lets the fuzzer of the preset `asan-ubsan`,
# which must have been built, run RUNS inputs (10,000,000) on each reader, or on READER alone, in chunks,
# and prints how far each is. Stopped at any time, it goes on where it was. What it keeps is in
# build/asan-ubsan/long/READER: progress (a line a chunk: executions, seconds, exit status), corpus, log,
# and inputs that crash. Take what is new over to the tree by
#   cd build/asan-ubsan
#   fuzz/reader_fuzzer --reader=READER -merge=1 fuzz/corpus/READER long/READER/corpus
#   ../../scripts/pack_corpus.sh READER fuzz/corpus/READER/*
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
reader=${1:-all}
runs=${2:-10000000}
chunk=200000
max_crashes=10
root=build/asan-ubsan/long
fuzz=build/asan-ubsan/fuzz  # with what the build unpacks from fuzz/corpus

mapfile -t readers < <(find fuzz/corpus -name '*.tar' -printf '%f\n' | sed 's/\.tar$//' | sort)
[[ $reader == all ]] || readers=("$reader")

# sum READER COLUMN: of its progress so far.
sum() { awk -v column="$2" '{ total += $column } END { print total + 0 }' "$root/$1/progress"; }
crashes() { find "$root/$1/crashes" -type f | wc -l; }

# One more chunk; false where nothing more can come of it.
run_chunk() {
  local folder=$root/$1 left=$((runs - $(sum "$1" 1))) begin=$EPOCHREALTIME status=0 executions
  ((left > 0 && $(crashes "$1") < max_crashes)) || return
  "$fuzz/reader_fuzzer" "--reader=$1" -runs=$((left < chunk ? left : chunk)) -timeout=10 -max_len=16384 \
    -print_final_stats=1 -artifact_prefix="$folder/crashes/" \
    "$folder/corpus" "$fuzz/corpus/$1" >"$folder/log" 2>&1 || status=$?
  executions=$(awk '/^stat::number_of_executed_units:/ { print $2 }' "$folder/log")
  awk -v n="${executions:-0}" -v a="$begin" -v b="$EPOCHREALTIME" -v status="$status" \
    'BEGIN { printf "%d %.1f %d\n", n, b - a, status }' >>"$folder/progress"
  ((${executions:-0} > 0))
}

for name in "${readers[@]}"; do
  mkdir -p "$root/$name"/{corpus,crashes}
  touch "$root/$name/progress"
done
# In turn, so that all are equally far.
for ((again = 1; again; )); do
  again=0
  for name in "${readers[@]}"; do
    if run_chunk "$name"; then again=1; fi
  done
done

printf '%-8s %12s %9s %7s %8s\n' reader executions seconds corpus crashes
for name in "${readers[@]}"; do
  printf '%-8s %12d %9.0f %7d %8d\n' "$name" "$(sum "$name" 1)" "$(sum "$name" 2)" \
    "$(find "$root/$name/corpus" "$fuzz/corpus/$name" -type f | wc -l)" "$(crashes "$name")"
done
[[ $(find "$root"/*/crashes -type f | wc -l) == 0 ]]
