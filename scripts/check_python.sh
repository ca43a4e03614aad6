#!/usr/bin/env bash
# Builds the Python package beside the release preset's program, whose library it takes, and tests it:
#   scripts/check_python.sh [PYTEST_ARGUMENT...]
# What it needs from PyPI goes into build/python-venv; its BSDF for Mitsuba is tested where build/renderer has that
# (scripts/check_renderers.sh). Needs the release preset to have been built.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh
setup_packages run

venv=build/python-venv
if [[ ! -e $venv/ready || ! -x $venv/bin/mypy ]]; then
  /usr/bin/python3 -m venv --clear "$venv"
  "$venv/bin/pip" install --quiet --disable-pip-version-check nanobind numpy pytest hypothesis tqdm matplotlib pandas scipy xarray ruff mypy \
    nlopt ipyopt
  touch "$venv/ready"
fi

"$venv/bin/ruff" check --quiet --config python/ruff.toml python tests/python scripts/run_notebook.py

# The preset has the package no longer than this takes.
trap 'configure release -DTRILOBE_BUILD_PYTHON=OFF' EXIT
configure release -DTRILOBE_BUILD_PYTHON=ON -DPython_EXECUTABLE="$PWD/$venv/bin/python"
build release trilobe_python
"$venv/bin/mypy" --config-file python/mypy.ini --cache-dir build/mypy build/release/python/trilobe
export PYTHONPATH=$PWD/build/release/python
if build/renderer/bin/python -c 'import mitsuba, pytest' 2>/dev/null; then
  llvm=(/usr/lib/x86_64-linux-gnu/libLLVM.so.19*)
  [[ ! -e ${llvm[0]} ]] || export DRJIT_LIBLLVM_PATH=${DRJIT_LIBLLVM_PATH-${llvm[0]}}
  build/renderer/bin/python -m pytest -q tests/python/test_mitsuba*.py tests/python/test_need.py
fi
"$venv/bin/python" -m pytest -q --ignore-glob="*/test_mitsuba*.py" --ignore=tests/python/test_need.py "$@"
