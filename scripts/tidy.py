#!/usr/bin/env python3
"""Runs clang-tidy (.clang-tidy) on the files of a configured build folder that are to be checked for
the changes since BASE (scripts/reached.py), or on all where BASE is empty.

scripts/tidy.py BUILD_DIR [BASE [SECONDS]]     BUILD_DIR has a compile_commands.json

After SECONDS it begins with no further file, and says how many it has left out: a change to what all
files include would take longer than the rest of CI, and scripts/nightly.sh looks at all. The library
comes first.

clang parses each file with its compiler's flags and without precompiled headers, so this also shows
clang's own warnings, and that each file and header includes what it needs. A file in which it found
nothing is remembered in ~/.cache/trilobe-tidy by all that a run of it reads, so that the same is not
checked again, in this checkout or another. scripts/nightly.sh, with another cache, forgets it all.
"""

import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
CACHE = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache",
                     "trilobe-tidy")
UNUSED_DAYS = 30  # after which it is forgotten


def is_checked(source):
    """Whether it is ours: not what a build makes, but for the headers without a source."""
    parts = source.relative_to(ROOT).parts
    return (parts[0] in ("src", "tests", "benchmarks", "experiments") or
            parts[0] == "build" and parts[2:4] == ("src", "headers"))


def output_of(words, **options):
    return subprocess.run(words, stdout=subprocess.PIPE, check=True, **options).stdout


@functools.cache
def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


@functools.cache
def tool():
    """Identity of the checker: clang-tidy, whatever processor it runs on, and this script."""
    version = output_of(["clang-tidy", "--version"]).decode()
    return re.sub(r".*Host CPU.*\n", "", version) + digest(pathlib.Path(__file__).resolve())


def read_for(entry):
    """The files that are read to compile an entry of compile_commands.json."""
    words = shlex.split(entry["command"])
    del words[words.index("-o"):words.index("-o") + 2]
    rule = output_of([*words, "-M"], cwd=entry["directory"], stderr=subprocess.DEVNULL).decode()
    names = shlex.split(rule.partition(":")[2].replace("\\\n", " "))
    return [pathlib.Path(entry["directory"], name) for name in names]


def key_of(entry):
    """A hash of all that clang-tidy reads for a file: the bytes of it, of what it includes and of
    the settings that hold there, and how it is compiled, wherever ROOT lies."""
    source = pathlib.Path(entry["file"])
    settings = [folder / ".clang-tidy" for folder in source.parents
                if folder.is_relative_to(ROOT) and (folder / ".clang-tidy").is_file()]
    lines = [tool(), entry["command"],
             *(f"{file} {digest(file.resolve())}" for file in settings + read_for(entry))]
    return hashlib.sha256("\n".join(lines).replace(str(ROOT), "").encode()).hexdigest()


def check(entry, build_dir, end):
    """Whether clang-tidy has nothing against a file, and whether it had to look; None where time is over."""
    if time.monotonic() > end:
        return True, None
    try:
        known = CACHE / key_of(entry)
    except subprocess.CalledProcessError:
        known = None  # a header is missing: clang-tidy says so
    if known and known.exists():
        known.touch()
        return True, False
    # Its standard error has counts of diagnostics that it does not report.
    done = subprocess.run(["clang-tidy", "--quiet", "-p", str(build_dir), entry["file"]],
                          stderr=subprocess.DEVNULL)
    if known and done.returncode == 0:
        known.touch()
    return done.returncode == 0, True


def main(build_dir, base="origin/main", seconds="inf"):
    end = time.monotonic() + float(seconds)
    build_dir = pathlib.Path(build_dir).resolve()
    reached = set(output_of([ROOT / "scripts/reached.py", build_dir, base]).decode().split("\n"))
    commands = json.loads((build_dir / "compile_commands.json").read_text())
    # clang-tidy itself looks at all that a file is compiled with.
    entries = {str(pathlib.Path(entry["file"]).resolve()): entry for entry in commands}
    entries = [entry for file, entry in entries.items()
               if file in reached and is_checked(pathlib.Path(file))]
    CACHE.mkdir(parents=True, exist_ok=True)
    for known in CACHE.iterdir():
        try:
            if known.stat().st_mtime < time.time() - UNUSED_DAYS * 86400:
                known.unlink()
        except FileNotFoundError:  # another run was faster
            pass
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda entry: check(entry, build_dir, end), entries))
    looked = [each for _, each in results if each is not None]
    late = len(results) - len(looked)
    print(f"clang-tidy looked at {sum(looked)} files of {len(results)} that are to be checked; " +
          (f"{late} are left to scripts/nightly.sh, and " if late else "") +
          "in the others it had found nothing before")
    return 0 if all(good for good, _ in results) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
