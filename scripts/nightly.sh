#!/usr/bin/env bash
# Checks that take too long for .ci/run: clang-tidy on everything, all combinations of choices, the longest tests and
# those of the program under the address and undefined-behaviour sanitizers, the thread sanitizer, all tests as other
# processors and another compiler round, a newcomer's first hour in an inconvenient place, some hundred faults, and long
# fuzzing.
#   scripts/nightly.sh [TRIALS [RUNS [DATA]]]      faults to try (400), executions of each fuzzer (10000000), a
#                                                  folder with the measured files that pages name
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

setup_packages run check ci

step "Checking all of the code with clang-tidy"
configure tidy
# A fresh cache, so that files count which .ci/run has seen already.
forgetful=$(mktemp -d)
XDG_CACHE_HOME=$forgetful quietly tidy scripts/tidy.py build/tidy ""
rm -rf "$forgetful"

step "Building what may race with the thread sanitizer"
configure tsan
build tsan
step "Running it"
run_tests tsan

step "Building a shared library with the address and undefined-behaviour sanitizers"
configure asan-ubsan -DTRILOBE_BUILD_APP=ON
build asan-ubsan
step "Running the tests with them, the longest and those of the program included"
run_tests asan-ubsan-long

step "Building the program and the tests"
configure release -DTRILOBE_BUILD_TESTS=ON
build release
step "Running the tests that go through choices, with all combinations"
TRILOBE_ALL_CHOICES=1 run_tests release

step "Running every command of README.md and of the pages that go on from it, as it stands there"
TRILOBE_ALL_CHOICES=1 quietly readme scripts/check_readme.sh

step "Building them by clang"
configure clang -DTRILOBE_BUILD_TESTS=ON
build clang
# BLAS adds up otherwise on each, so that last bits differ, and no test may hang on these.
for compiler in release clang; do
  for kernels in Haswell Zen SandyBridge Prescott Nehalem; do
    step "Running the tests with the kernels of OpenBLAS for $kernels ($compiler)"
    OPENBLAS_CORETYPE=$kernels run_tests "$compiler"
  done
done

step "Fitting by the kernels of processors without AVX-512, to the same bits"
quietly copies scripts/check_copies.sh

step "Doing what a newcomer does, in an inconvenient place"
scripts/check_anywhere.sh

step "Giving each flag of each command a value"
tests/flags/sweep.py

step "Breaking runs of the program"
tests/faults/harness.py --trials="${1:-400}"

step "Testing files for renderers in Mitsuba, which draws a picture of the pages"
scripts/check_renderers.sh

step "Testing pages and shaders in a browser"
scripts/check_pages.sh

step "Testing the Python package, with some hundred thousand calls by arguments of any kind, and installing it"
TRILOBE_LONG_TESTS=1 TRILOBE_FUZZ_CALLS=20000 scripts/check_python.sh
scripts/check_pip.sh

step "Building wheels of it, and installing them where there is nothing but Python"
scripts/wheels.sh --check

step "Packing the program, and running it where there is nothing but glibc"
scripts/archive.sh --check

step "Fitting the materials that come along anew"
quietly materials materials/make ${3:+"$3"} --check

step "Comparing the figures of the pages with their commands and tables"
scripts/check_figures.py ${3:+--data="$3"}

step "Making the pictures of the pages"
scripts/check_pictures.py ${3:+--data="$3"}

step "Adding a made-up subcommand, format, form, solver and weighting, by the files that the page names"
scripts/check_what_to_touch.py --build

step "Fuzzing each reader"
scripts/fuzz_long.sh "" "${2:-10000000}"

step "All held"
