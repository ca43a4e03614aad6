#!/usr/bin/env bash
# What takes too long for .ci/run: the thread sanitizer, some hundred faults, and long fuzzing.
#   scripts/nightly.sh [TRIALS [RUNS]]      faults to try (400), executions of each fuzzer (10000000)
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

setup_packages run check ci

step "Building what may race with the thread sanitizer"
quietly configure-tsan cmake --preset tsan
build tsan
step "Running it"
run_tests tsan

step "Building the program"
quietly configure-release cmake --preset release
build release trilobe_app
step "Breaking runs of it"
tests/faults/harness.py --trials="${1:-400}"

step "Fuzzing each reader"
scripts/fuzz_long.sh "" "${2:-10000000}"

step "All held in $((SECONDS / 60)) min"
