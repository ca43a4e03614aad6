#!/usr/bin/env bash
# Checks that what README.md promises is so: its `sh` blocks run, and its C++ is what tests/consumer
# compiles. Needs the release preset to have been built.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."

# blocks LANGUAGE: the contents of all ```LANGUAGE blocks.
blocks() {
  awk -v fence="\`\`\`$1" '/^```/ { inside = ($0 == fence); next } inside' README.md
}

diff <(blocks cpp) tests/consumer/main.cc || {
  echo "the C++ in README.md is not that of tests/consumer/main.cc" >&2
  exit 1
}

# ./check is left out: it is what has just been run.
blocks sh | grep -vx './check' | bash -euo pipefail -x

# The scene shows what a scene is for: its models are small, have lobes, and lose what they may.
/usr/bin/python3 - out/scene/plan.json <<'END'
import json
import sys

for material in json.load(open(sys.argv[1]))["materials"]:
    numbers, psnr = material["parameters"], material["psnr_db"]
    good = (material["lobes"] > 0 and numbers["pruned"] < numbers["full"] / 10
            and 0.1 < psnr["full"] - psnr["pruned"] <= 1)
    if not good:
        sys.exit(f"{material['name']} of README.md's scene is no good example: {numbers}, {psnr} dB")
END
