#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy) on the files of a configured build folder that are to be checked for the
# changes since BASE (scripts/reached.py), or on all where BASE is empty: scripts/tidy.sh BUILD_DIR [BASE].
# clang parses each file with its compiler's flags and without precompiled headers, so this also shows
# clang's own warnings, and that each file and header includes what it needs.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
build_dir=${1:?usage: scripts/tidy.sh BUILD_DIR [BASE]}
base=${2-origin/main}

mapfile -t sources < <(scripts/reached.py "$build_dir" "$base" |
  grep -E "^$PWD/(build/[^/]+/src/headers|src|tests|benchmarks|experiments)/")
echo "clang-tidy looks at ${#sources[@]} files"
((${#sources[@]} == 0)) && exit
# What it prints on standard error are counts of what it does not report.
printf '%s\0' "${sources[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy --quiet -p "$build_dir" 2>/dev/null
