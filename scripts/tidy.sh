#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy) on every file that a build folder compiles: scripts/tidy.sh BUILD_DIR.
# clang parses each file with its compiler's flags, so this also shows clang's own warnings.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
build_dir=${1:?usage: scripts/tidy.sh BUILD_DIR}

# run-clang-tidy takes regular expressions that a file's whole path must match from its start.
output=$(run-clang-tidy -quiet -p "$build_dir" -j "$(nproc)" \
  "^$PWD/(src|tests|benchmarks|experiments)/" 2>&1) && exit

# Nothing but the findings: it prints a line for each file that it looks at, too.
grep -A 4 -E '(error|warning):' <<<"$output" || printf '%s\n' "$output"
exit 1
