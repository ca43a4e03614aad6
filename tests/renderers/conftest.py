"""Fixtures for tests of files for renderers: fits, the program, and Mitsuba, without which they skip."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("TRILOBE_BUILD", REPOSITORY / "build/release"))


def run(*arguments: str | Path) -> str:
    """Runs trilobe and returns what it prints; its own error line is that of the test."""
    command = [str(BUILD / "bin/trilobe"), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}: {done.stderr}"
    return done.stdout


@pytest.fixture(scope="session")
def mitsuba() -> Any:
    """Set to a variant by whoever uses it."""
    return pytest.importorskip("mitsuba", reason="Mitsuba is not installed: experiments/renderer/setup")


@pytest.fixture(scope="session")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with plastic.json, a fit, and metal.json, whose peak is narrow."""
    folder = tmp_path_factory.mktemp("files")
    for name, source in (("plastic", "synth:plastic"), ("metal", "synth:chrome")):
        run("fit", source, "--solver=awls", "--max_iterations=2", "--noplots", f"--out={folder / name}")
        (folder / name / "model.json").rename(folder / f"{name}.json")
    return folder
