#!/usr/bin/env bash
# Checks that what README.md promises is so: its `sh` blocks run, its C++ is what tests/consumer
# compiles, and its links lead to files. Needs the release preset to have been built.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."

# blocks LANGUAGE: the contents of all ```LANGUAGE blocks.
blocks() {
  awk -v fence="\`\`\`$1" '/^```/ { inside = ($0 == fence); next } inside' README.md
}

while IFS= read -r link; do
  [[ -e $link ]] || {
    echo "README.md links to $link, which does not exist" >&2
    exit 1
  }
done < <(grep -oP '\]\(\K[^)#]+' README.md | grep -v '^http')

diff <(blocks cpp) tests/consumer/main.cc || {
  echo "the C++ in README.md is not that of tests/consumer/main.cc" >&2
  exit 1
}

# ./check is left out: it is what has just been run.
blocks sh | grep -vx './check' | bash -euo pipefail -x
