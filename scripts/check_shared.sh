#!/usr/bin/env bash
# Builds the library as a shared one, installs it, and runs the consumer against it:
# scripts/check_shared.sh BUILD_DIR.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
build_dir=$(realpath -m "${1:?usage: scripts/check_shared.sh BUILD_DIR}")

cmake -S . -B "$build_dir" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=ON \
  -DTRILOBE_BUILD_TESTS=OFF -DTRILOBE_BUILD_BENCHMARKS=OFF
cmake --build "$build_dir"
cmake -Dtrilobe_build_dir="$build_dir" -Dscratch_dir="$build_dir/consumer" -Dconfig=Release \
  -Dgenerator=Ninja -Dcxx_compiler=c++ -P tests/consumer/check.cmake
