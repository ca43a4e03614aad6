#!/usr/bin/env bash
# Builds the program without the kernels for AVX-512, and compares a fit by it, bit by bit, with one by the release
# preset, which must have been built: scripts/check_copies.sh. Where the processor has no AVX-512 both are the same.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
cmake --preset release -B build/avx2 -DTRILOBE_WIDEST_VECTOR=256 -DTRILOBE_BUILD_TESTS=OFF \
  -DTRILOBE_BUILD_BENCHMARKS=OFF -DTRILOBE_BUILD_EXPERIMENTS=OFF
cmake --build build/avx2

results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
for build in release avx2; do
  "build/$build/bin/trilobe" fit synth:copper --noise=0.02 --noplots --out="$results/$build"
done
python3 - "$results" <<'END'
import json
import sys
from pathlib import Path

models = [json.loads((Path(sys.argv[1]) / build / "model.json").read_text()) for build in ("release", "avx2")]
for model in models:
    del model["fit"]  # has the date
sys.exit(0 if models[0] == models[1] else "models of the two copies differ")
END
