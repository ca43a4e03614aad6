"""`trilobe fit --scene`, watched: which materials it has finished is told while it runs."""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from trilobe._core import Error

Tell = Callable[[str], None]


def plan_of(command: list[str], out: Path, names: list[str], tell: Tell) -> dict[str, Any]:
    """Runs the command, which writes a model of each name into `out`, and returns the plan that it leaves there."""
    before = {name: _written(out / f"{name}.json") for name in names}
    begin, finished = time.perf_counter(), 0
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        while True:
            try:
                _, told = process.communicate(timeout=1)
                break
            except subprocess.TimeoutExpired:
                now = sum(_written(out / f"{name}.json") != then for name, then in before.items())
            if now > finished:
                finished, seconds = now, time.perf_counter() - begin
                left = seconds / finished * (len(names) - finished)
                tell(f"{finished} of {len(names)} materials, about {left:.0f} s left")
    if process.returncode != 0:
        lines = [line for line in told.splitlines() if line.strip()]
        raise Error(lines[-1].removeprefix("trilobe: ") if lines else f"trilobe ended with {process.returncode}")
    plan: dict[str, Any] = json.loads((out / "plan.json").read_text())
    return plan


def _written(path: Path) -> int:
    """When a file was written last, 0 if there is none [ns]."""
    try:
        return path.stat().st_mtime_ns
    except FileNotFoundError:
        return 0
