#!/usr/bin/env bash
# Checks that what README.md and the pages that go on from it promise is so: their `sh` blocks run, one
# after the other, and the C++ of docs/library.md is what tests/consumer compiles. With TRILOBE_ALL_CHOICES in
# the environment (scripts/nightly.sh) all are run as they stand there, else those of which the outcome does not
# count under few lights, and for two iterations where they limit them. Needs the release preset to have been built.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."

# blocks LANGUAGE PAGE...: the contents of all ```LANGUAGE blocks.
blocks() {
  awk -v fence="\`\`\`$1" '/^```/ { inside = ($0 == fence); next } inside' "${@:2}"
}

diff <(blocks cpp docs/library.md) tests/consumer/main.cc || {
  echo "the C++ in docs/library.md is not that of tests/consumer/main.cc" >&2
  exit 1
}

# Left out is what has just been run: ./check, and the experiments' quick forms, which are tests.
commands() {
  blocks sh "$@" | grep -vx './check' | grep -v '^experiments/trilobe-experiments .* --quick'
}
shorter() {
  if [[ ${TRILOBE_ALL_CHOICES-} ]]; then
    cat
  else
    echo "export TRILOBE_TEST_LIGHTS=6"
    sed -E 's/--max_iterations=[0-9]+/--max_iterations=2/'
  fi
}
# Results of another time, or of an earlier version, may not be the program's to overwrite.
commands README.md docs/commands.md docs/library.md docs/scene.md | grep -oP -- '--out=\Kout/[^ ]+' | xargs rm -rf
{
  commands README.md docs/commands.md docs/library.md
  echo "trilobe --version" # which README.md has put into the PATH
} | shorter | bash -euo pipefail -x
commands docs/scene.md | bash -euo pipefail -x

# The scene shows what a scene is for: its models are small, have lobes, and lose what they may.
/usr/bin/python3 - out/scene/plan.json <<'END'
import json
import sys

for material in json.load(open(sys.argv[1]))["materials"]:
    numbers, off = material["parameters"], material["mean_delta_e"]
    good = (material["lobes"] > 0 and numbers["pruned"] < numbers["full"] / 10
            and off["full"] < off["pruned"] <= 1)
    if not good:
        sys.exit(f"{material['name']} of docs/scene.md is no good example: {numbers}, Delta E {off}")
END
