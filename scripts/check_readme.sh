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
