"""The Python of README.md and docs/python.md runs as it stands there."""

import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest

import trilobe

pytest.importorskip("trilobe._fit")
ROOT = pathlib.Path(__file__).resolve().parents[2]


def blocks_of(page):
    return re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(), re.MULTILINE | re.DOTALL)


def test_texels_of_the_page_are_those_that_were_made(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {"np": np, "trilobe": trilobe, "brdf": trilobe.load("material:paper_white")}
    exec(next(block for block in blocks_of("docs/python.md") if "fit_texels" in block), names)
    for k in range(0, 64, 9):
        shown = names["texels"].eval(names["wi"][k], names["wo"][k])
        np.testing.assert_allclose(shown, names["rho"][:, :, k], rtol=1e-3)


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_runs(page, tmp_path):
    blocks = blocks_of(page)
    assert blocks
    try:
        import mitsuba  # noqa: F401
    except ImportError:
        blocks = [block for block in blocks if not re.search(r"mitsuba|\bmi\.", block)]
    run = subprocess.run([sys.executable, "-c", "\n".join(blocks)], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
