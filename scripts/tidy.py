#!/usr/bin/env python3
"""Runs clang-tidy (.clang-tidy) on the files of a configured build folder that are to be checked for
the changes since BASE (scripts/reached.py), or on all where BASE is empty.

scripts/tidy.py BUILD_DIR [BASE]     BUILD_DIR has a compile_commands.json

clang parses each file with its compiler's flags and without precompiled headers, so this also shows
clang's own warnings, and that each file and header includes what it needs. What it found nothing in
is remembered in ~/.cache/trilobe-tidy by all that a run of it reads, so that the same text, in this
checkout or another, is not checked again.
"""

import concurrent.futures
import hashlib
import json
import os
import pathlib
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
    return subprocess.run(words, capture_output=True, check=True, **options).stdout


def key_of(entry, settings):
    """A hash of all that clang-tidy reads of a file: its text and that of all that it includes, with
    comments, some of which clang-tidy heeds, and how it is compiled, wherever ROOT lies."""
    words = shlex.split(entry["command"])
    for option in ("-o", "-c"):
        at = words.index(option)
        del words[at:at + (2 if option == "-o" else 1)]
    text = output_of([*words, "-E", "-CC"], cwd=entry["directory"])
    whole = b"\n".join([settings, " ".join(words).encode(), text])
    return hashlib.sha256(whole.replace(str(ROOT).encode() + b"/", b"")).hexdigest()


def check(entry, build_dir, settings):
    """Whether clang-tidy has nothing against a file, and whether it had to look."""
    try:
        known = CACHE / key_of(entry, settings)
    except subprocess.CalledProcessError:
        known = None  # it does not even preprocess: clang-tidy says why
    if known and known.exists():
        known.touch()
        return True, False
    # What it prints on standard error are counts of what it does not report.
    done = subprocess.run(["clang-tidy", "--quiet", "-p", str(build_dir), entry["file"]],
                          stderr=subprocess.DEVNULL)
    if known and done.returncode == 0:
        known.touch()
    return done.returncode == 0, True


def main(build_dir, base="origin/main"):
    build_dir = pathlib.Path(build_dir).resolve()
    reached = set(output_of([ROOT / "scripts/reached.py", build_dir, base]).decode().split("\n"))
    entries = {entry["file"]: entry
               for entry in json.loads((build_dir / "compile_commands.json").read_text())
               if entry["file"] in reached and is_checked(pathlib.Path(entry["file"]))}
    settings = output_of(["clang-tidy", "--version"]) + (ROOT / ".clang-tidy").read_bytes()
    CACHE.mkdir(parents=True, exist_ok=True)
    for known in CACHE.iterdir():
        if known.stat().st_mtime < time.time() - UNUSED_DAYS * 86400:
            known.unlink(missing_ok=True)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda entry: check(entry, build_dir, settings), entries.values()))
    print(f"clang-tidy looked at {sum(looked for _, looked in results)} files of {len(results)} "
          f"that are to be checked; of the others it had seen the same text")
    return 0 if all(good for good, _ in results) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
