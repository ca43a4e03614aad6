"""Runs commands that pages name, in a temporary folder each, with the programs of the repository."""

import os
import pathlib
import re
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple, Optional

MEASURED = re.compile(r"(?<!\S)[\w.-]+\.(?:bsdf|mbsdf|brdf|binary|bin)\b")
WRITTEN = re.compile(r"--out=(\S+)")
PROGRAMS = ["build/release/bin", "experiments/renderer", "python/examples", "scripts"]


class Done(NamedTuple):
    """The results of a command."""

    folder: pathlib.Path
    succeeded: bool
    output: str
    absent: str  # a measured file that is not at hand, for want of which the command did not run


@contextmanager
def run(command: str, root: pathlib.Path, data: Optional[pathlib.Path]) -> Iterator[Done]:
    """Runs a command by bash; measured files that it names are looked for in the folder `data`, at any depth."""
    path = ":".join([*(str(root / folder) for folder in PROGRAMS), os.environ["PATH"]])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for measured in sorted(set(MEASURED.findall(command)) - set(WRITTEN.findall(command))):
            found = next(iter(sorted(data.rglob(measured))), None) if data else None
            if found is None:
                yield Done(folder, False, "", measured)
                return
            (folder / measured).symlink_to(found.resolve())
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=folder, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, env={**os.environ, "PATH": path}, check=False)
        yield Done(folder, done.returncode == 0, done.stdout, "")
