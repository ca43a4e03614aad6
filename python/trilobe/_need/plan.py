"""`trilobe fit --scene`, watched: which materials it has finished is told while it runs."""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from trilobe._model.error import Error

Tell = Callable[[str], None]

_TELL_SECONDS = 10.0


def plan_of(
    command: list[str], out: Path, names: list[str], tell: Tell, expected: float = 0, every: float = _TELL_SECONDS
) -> dict[str, Any]:
    """Runs the command, which writes a model of each name into `out`, and returns the plan that it leaves there.

    Tells at once, when a material is finished, and after so many seconds, how far it is and what is left. `expected`
    is how long it may take, as another took; 0 if nobody knows.
    """
    before = {name: _written(out / f"{name}.json") for name in names}
    begin, told_at, finished = time.perf_counter(), 0.0, 0
    tell(_progress(names, 0, 0, expected))
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        while True:
            try:
                _, told = process.communicate(timeout=1)
                break
            except subprocess.TimeoutExpired:
                left = [name for name, then in before.items() if _written(out / f"{name}.json") == then]
            seconds = time.perf_counter() - begin
            if len(names) - len(left) > finished or seconds - told_at >= every:
                finished, told_at = len(names) - len(left), seconds
                tell(_progress(left, finished, seconds, expected))
    if process.returncode != 0:
        lines = [line for line in told.splitlines() if line.strip()]
        raise Error(lines[-1].removeprefix("trilobe: ") if lines else f"trilobe ended with {process.returncode}")
    plan: dict[str, Any] = json.loads((out / "plan.json").read_text())
    return plan


def _progress(left: list[str], finished: int, seconds: float, expected: float) -> str:
    """The progress, such as "3 of 10 materials after 20 s, about 47 s left for wall, floor and 5 more"."""
    text = f"{finished} of {finished + len(left)} materials"
    if seconds > 0:
        text += f" after {seconds:.0f} s"
    if not left:
        return text
    estimate = seconds / finished * len(left) if finished > 0 else max(expected - seconds, 0)
    text += f", about {estimate:.0f} s left for " if estimate > 0 else "; left are "
    shown = left if len(left) <= 3 else [*left[:2], f"{len(left) - 2} more"]
    return text + (f"{', '.join(shown[:-1])} and {shown[-1]}" if len(shown) > 1 else shown[0])


def _written(path: Path) -> int:
    """When a file was written last, 0 if there is none [ns]."""
    try:
        return path.stat().st_mtime_ns
    except FileNotFoundError:
        return 0
