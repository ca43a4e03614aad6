#!/usr/bin/env python3
"""Prints which sources of a build folder the changes of this branch can reach, one a line.

scripts/reached.py BUILD_DIR [BASE]     BUILD_DIR has a compile_commands.json

Those are the sources that have changed since this branch left BASE (origin/main), or include,
however indirectly, a file that has. All of them where it cannot be told: if BASE is empty or
unknown, if nothing has changed since, as on BASE itself, or if what has changed says how things are
built or checked.
"""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CONCERNS_ALL = re.compile(
    r"(^|/)(CMakeLists\.txt|CMakePresets\.json|\.clang-tidy|dependencies\.txt)$|\.cmake(\.in)?$"
    r"|^scripts/(tidy\.sh|reached\.py)$|^\.ci/")
INCLUDE = re.compile(rb'^#include "([^"]+)"', re.MULTILINE)


def git(*arguments):
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout


def changes(base):
    """Paths below ROOT, committed or not; None where it cannot be told."""
    try:
        since = git("merge-base", "HEAD", base).strip()
    except (subprocess.CalledProcessError, FileNotFoundError):  # no such BASE, or no git
        return None
    # Without renames: what included a file by its former name has changed itself, or does not build.
    paths = set(git("diff", "--name-only", "--no-renames", since).splitlines())
    paths.update(git("ls-files", "--others", "--exclude-standard").splitlines())
    if not paths or any(CONCERNS_ALL.search(path) for path in paths):
        return None
    return {(ROOT / path).resolve() for path in paths}


def included_by(file):
    """The files of this repository that a file includes."""
    for name in INCLUDE.findall(file.read_bytes()):
        name = name.decode()
        for folder in (file.parent, ROOT / "include", ROOT):
            if (folder / name).is_file():
                yield (folder / name).resolve()
                break


def reaches(file, changed, known):
    """Whether `changed` has the file, or one that it includes."""
    if file not in known:
        known[file] = file in changed  # for a file that includes itself
        known[file] = known[file] or any(
            reaches(included, changed, known) for included in included_by(file))
    return known[file]


def main():
    build_dir = pathlib.Path(sys.argv[1])
    base = sys.argv[2] if len(sys.argv) > 2 else "origin/main"
    commands = json.loads((build_dir / "compile_commands.json").read_text())
    sources = [pathlib.Path(command["directory"], command["file"]).resolve()
               for command in commands]
    changed = changes(base)
    known = {}
    for source in dict.fromkeys(sources):
        if changed is None or (source.is_file() and reaches(source, changed, known)):
            print(source)


main()
