#!/usr/bin/env bash
# Installs the Python package by pip in fresh virtual environments, whole, only what evaluates, and whole with the
# library of build/release if that is there, and runs README.md's example in the last; says how long each takes. Needs
# PyPI, and the packages of the group run.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# install NAME ARGUMENT...: into an environment of that name.
install() {
  local name=$1
  local TIMEFORMAT="pip install of $name: %0R s, %0U s of processor time"
  shift
  /usr/bin/python3 -m venv "$folder/$name"
  time "$folder/$name/bin/pip" install --quiet --disable-pip-version-check "$@"
}

# With flags of its own it takes nothing from the build of ./run, as where there is none.
rm -rf build/pip
CXXFLAGS=-g0 install anew .
"$folder/anew/bin/python" -c 'import trilobe; trilobe.solvers()'
install evaluates ./python/evaluate
install all .
[[ ! -e build/release/bin/trilobe ]] || cmp build/release/bin/trilobe "$folder/all/bin/trilobe"
# Whoever names both folders means the same two packages; and what is installed goes by version, not by folder.
"$folder/all/bin/pip" install --quiet --disable-pip-version-check --dry-run . ./python/evaluate
"$folder/all/bin/pip" check
"$folder/all/bin/python" -c 'from importlib.metadata import requires, version
assert "trilobe-evaluate==" + version("trilobe") in requires("trilobe"), requires("trilobe")'
awk '/^```/ { inside = ($0 == "```python"); next } inside' README.md >"$folder/example.py"
cd "$folder"
all/bin/python example.py
all/bin/trilobe help >all.txt
evaluates/bin/python -c 'import trilobe; print(trilobe.load("material:linen").eval([0, 0, 1], [0, 0, 1]))'
if evaluates/bin/python -c 'import trilobe; trilobe.solvers()' 2>evaluates.txt; then exit 1; fi
grep -q "this package only evaluates models" evaluates.txt
if all/bin/trilobe-need scene.xml --out=need 2>need.txt; then exit 1; fi
grep -q "pip install 'trilobe\[need\]'" need.txt
