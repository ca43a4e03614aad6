#!/usr/bin/env bash
# Tests the files that `convert` writes for renderers in Mitsuba: scripts/check_renderers.sh [PYTEST_ARGUMENT...]
# What it needs from PyPI, 0.2 GB, goes into build/renderer, which experiments share; where that cannot be had, says so
# and is done. Needs the release preset's program.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=build/renderer
if ! "$venv/bin/python" -c 'import MaterialX, mitsuba, pxr, pytest' 2>/dev/null; then
  export PIP_RETRIES=1 PIP_DEFAULT_TIMEOUT=15 PIP_DISABLE_PIP_VERSION_CHECK=1
  if ! { experiments/renderer/setup "$venv" && "$venv/bin/pip" install --quiet materialx pytest ruff usd-core; }; then
    echo "left out: PyPI cannot be reached or has no Mitsuba for this machine, so files for renderers are not tested in it"
    exit 0
  fi
fi

"$venv/bin/ruff" check --quiet --config python/ruff.toml tests/renderers experiments/renderer/materials
cd tests/renderers
TRILOBE_TEST_LIGHTS=6 "$OLDPWD/$venv/bin/python" -m pytest -q -p no:cacheprovider "$@" .
