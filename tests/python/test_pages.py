"""The Python of README.md and docs/python.md runs as it stands there."""

import pathlib
import re
import subprocess
import sys

import pytest

pytest.importorskip("trilobe._fit")
ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_runs(page, tmp_path):
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(), re.MULTILINE | re.DOTALL)
    assert blocks
    try:
        import mitsuba  # noqa: F401
    except ImportError:
        blocks = [block for block in blocks if not re.search(r"mitsuba|\bmi\.", block)]
    run = subprocess.run([sys.executable, "-c", "\n".join(blocks)], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
