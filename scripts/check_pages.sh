#!/usr/bin/env bash
# Tests pages and shaders in a browser, Debian's chromium: scripts/check_pages.sh [PYTEST_ARGUMENT...]
# What drives it, and three.js, comes from PyPI into build/browser; where that or chromium cannot be had, says so and is done. Needs the
# release preset's program and tests.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."

if ! command -v chromium >/dev/null; then
  echo "left out: chromium is not installed, so pages are not tested in it"
  exit 0
fi
venv=build/browser
# nicegui is needed for its copy of three.js 0.168 alone.
if ! "$venv/bin/python" -c 'import numpy, PIL, playwright, pytest' 2>/dev/null || [[ ! -e $venv/three ]]; then
  export PIP_RETRIES=1 PIP_DEFAULT_TIMEOUT=15 PIP_DISABLE_PIP_VERSION_CHECK=1
  if ! { python3 -m venv "$venv" && "$venv/bin/pip" install --quiet numpy pillow playwright pytest ruff &&
    "$venv/bin/pip" install --quiet --no-deps nicegui==2.24.2 && touch "$venv/three"; }; then
    echo "left out: PyPI cannot be reached, so pages are not tested"
    exit 0
  fi
fi

"$venv/bin/ruff" check --quiet --config python/ruff.toml tests/web scripts/page_picture.py scripts/page_speed.py scripts/gallery.py \
  scripts/check_figures.py scripts/page_commands.py scripts/diagrams scripts/draw_diagrams.py scripts/draw_fits.py scripts/shrink.py materials/make materials/furnace
"$venv/bin/python" -m pytest -q -p no:cacheprovider "$@" tests/web
