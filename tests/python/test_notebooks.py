"""The notebooks run, and have their pictures in place."""

import json
import os
import pathlib
import subprocess
import sys

import pytest

pytest.importorskip("trilobe._fit")
for needed in ("matplotlib", "pandas", "scipy"):
    pytest.importorskip(needed)

ROOT = pathlib.Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "python" / "examples").glob("*.ipynb"))


def test_all_are_here():
    assert [path.stem for path in NOTEBOOKS] == ["compare_solvers", "fit_your_own", "which_directions"]


def kinds_of(cells):
    return [[output["output_type"] for output in cell.get("outputs", [])] for cell in cells]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_runs_and_has_its_pictures(path, tmp_path):
    copy = tmp_path / path.name
    copy.write_text(path.read_text())
    run = subprocess.run([sys.executable, ROOT / "scripts" / "run_notebook.py", "--write", copy], cwd=tmp_path,
                         capture_output=True, text=True, env={**os.environ, "TQDM_DISABLE": "1"})
    assert run.returncode == 0, run.stderr
    kept, made = (json.loads(file.read_text())["cells"] for file in (path, copy))
    assert kinds_of(kept) == kinds_of(made)
    assert "display_data" in sum(kinds_of(kept), [])
