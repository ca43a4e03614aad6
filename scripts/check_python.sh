#!/usr/bin/env bash
# Builds the Python package beside the release preset's program, whose library it takes, and tests it:
#   scripts/check_python.sh [PYTEST_ARGUMENT...]
# What it needs from PyPI goes into build/python-venv. Needs the release preset to have been built.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh
setup_packages run

venv=build/python-venv
if [[ ! -e $venv/ready ]]; then
  /usr/bin/python3 -m venv --clear "$venv"
  "$venv/bin/pip" install --quiet --disable-pip-version-check nanobind numpy pytest hypothesis tqdm matplotlib ruff
  touch "$venv/ready"
fi

"$venv/bin/ruff" check --quiet --config python/ruff.toml python tests/python

# The preset has the package no longer than this takes.
trap 'configure release -DTRILOBE_BUILD_PYTHON=OFF' EXIT
configure release -DTRILOBE_BUILD_PYTHON=ON -DPython_EXECUTABLE="$PWD/$venv/bin/python"
build release trilobe_python
PYTHONPATH=build/release/python "$venv/bin/python" -m pytest -q "$@"
