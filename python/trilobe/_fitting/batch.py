"""Batches of fits, by the program."""

from __future__ import annotations

import csv
import os
import shutil
import subprocess
import sys
from typing import Any

from trilobe._model.error import Error, in_keywords
from trilobe._model.files import text_of_path


def find_program(given: Any) -> str:
    """The `trilobe` that was given, or the one beside this Python, or on the PATH."""
    if given is not None:
        return text_of_path(given)
    beside = os.path.join(os.path.dirname(sys.executable), "trilobe")
    found = beside if os.access(beside, os.X_OK) else shutil.which("trilobe")
    if found is None:
        raise Error("the program trilobe is neither beside this Python nor on the PATH; give program=PATH")
    return found


def _flag(name: str, value: Any) -> str:
    if isinstance(value, bool):
        return f"--{name}" if value else f"--no{name}"
    return f"--{name}={value}"


def run(sources: list[str], out: str, workers: int, program: Any, flags: dict[str, Any]) -> list[dict[str, Any]]:
    """Runs `trilobe fit`, and reads what it has gathered."""
    if not isinstance(workers, int):
        raise Error("workers must be an integer")
    if not sources:
        raise Error("there is no source to fit")
    # Two sources are a batch; of one, the batch is asked for as the first part of one.
    command = [find_program(program), "fit", *sources, f"--out={out}", f"--threads={workers}"]
    command += ["--shard=1/1"] if len(sources) == 1 else []
    command += [_flag(name, value) for name, value in flags.items()]
    try:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    except (OSError, ValueError) as error:
        raise Error(f"cannot run {command[0]!r}: {getattr(error, 'strerror', None) or error}") from None
    try:
        _, told = process.communicate()
    except KeyboardInterrupt:
        _, told = process.communicate()  # which has had the signal, too, and finishes what it can
        raise
    # 3: some could not be fitted, which their rows say.
    if process.returncode not in (0, 3):
        lines = [line for line in told.splitlines() if line.strip()]
        told_last = in_keywords(lines[-1].removeprefix("trilobe: ")) if lines else ""
        raise Error(told_last or f"trilobe ended with {process.returncode}")
    table = os.path.join(out, "fits.csv")
    try:
        with open(table, newline="", encoding="utf-8") as file:
            return [{key: _cell(value) for key, value in row.items()} for row in csv.DictReader(file)]
    except OSError as error:
        raise Error(f"cannot read '{table}': {error.strerror}") from None


def _cell(text: Any) -> Any:
    """A number, or a text without the ' that keeps a spreadsheet from taking it for a formula."""
    try:
        return float(text)
    except (TypeError, ValueError):
        guarded = isinstance(text, str) and text[:1] == "'" and text[1:2] in tuple("=+-@\t\r'")
        return text[1:] if guarded else text
