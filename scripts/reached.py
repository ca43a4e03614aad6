#!/usr/bin/env python3
"""Prints which sources of a build folder the changes of this branch can reach, one a line.

scripts/reached.py BUILD_DIR [BASE]     BUILD_DIR has a compile_commands.json

Those are the sources that have changed since this branch left BASE (origin/main), or include,
however indirectly, a file that has, or are compiled otherwise than there: where it has changed how
things are built, the preset that BUILD_DIR is named after is configured as it was at BASE, too. All
of them where it cannot be told: if BASE is empty or unknown, if nothing has changed since, as on
BASE itself, if the former preset cannot be configured, or if what has changed says what is checked,
or with what.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
CONCERNS_ALL = re.compile(
    r"(^|/)(\.clang-tidy|dependencies\.txt)$|^scripts/(tidy\.sh|reached\.py)$")
CONCERNS_BUILD = re.compile(
    r"(^|/)(CMakeLists\.txt|CMakePresets\.json|rooms\.txt)$|\.cmake(\.in)?$")
INCLUDE = re.compile(rb'^#include "([^"]+)"', re.MULTILINE)


def git(*arguments):
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout


def compiled(root, build_dir):
    """How each source is compiled: its path below `root`, and with what, wherever `root` lies.
    Sources that the build folder makes come with their text."""
    found = {}
    for entry in json.loads((build_dir / "compile_commands.json").read_text()):
        source = pathlib.Path(entry["directory"], entry["file"]).resolve()
        is_made = source.is_relative_to(build_dir) and source.is_file()
        command = entry.get("command", "").replace(str(root), "")
        found.setdefault(str(source.relative_to(root)), []).append(
            (command, source.read_text() if is_made else ""))
    return found


def compiled_otherwise(commit, build_dir):
    """Sources that are compiled otherwise than at a commit, or were not at all."""
    now = compiled(ROOT, build_dir)
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder).resolve() / "then"
        git("worktree", "add", "--quiet", "--detach", str(root), commit)
        try:
            subprocess.run(["cmake", "--preset", build_dir.name], cwd=root, capture_output=True,
                           check=True)
            then = compiled(root, root / build_dir.relative_to(ROOT))
        finally:
            git("worktree", "remove", "--force", str(root))
    return {ROOT / source for source, how in now.items() if then.get(source) != how}


def changes(base, build_dir):
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
    changed = {(ROOT / path).resolve() for path in paths}
    if any(CONCERNS_BUILD.search(path) for path in paths):
        try:
            changed |= compiled_otherwise(since, build_dir)
        except (subprocess.CalledProcessError, FileNotFoundError):  # not to be configured, then
            return None
    return changed


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
    build_dir = pathlib.Path(sys.argv[1]).resolve()
    base = sys.argv[2] if len(sys.argv) > 2 else "origin/main"
    commands = json.loads((build_dir / "compile_commands.json").read_text())
    sources = [pathlib.Path(command["directory"], command["file"]).resolve()
               for command in commands]
    changed = changes(base, build_dir)
    known = {}
    for source in dict.fromkeys(sources):
        if changed is None or (source.is_file() and reaches(source, changed, known)):
            print(source)


main()
