#!/usr/bin/env python3
"""Prints which sources of a build folder are to be checked for the changes of this branch, one a line.

scripts/reached.py BUILD_DIR [BASE]     BUILD_DIR has a compile_commands.json

Those are the sources that have changed since this branch left BASE (origin/main); for each header
that has, one source that includes it, however indirectly, its own if it has one; all that include
a header that used to include what it no longer does, since they may have relied on it; and those
that are compiled otherwise than there: where it has changed how things are built, the preset that
BUILD_DIR is named after is configured as it was at BASE, too. On BASE itself, where nothing has
changed since, as in a fresh clone of what has just landed, BASE is the last commit that is
LANDING_HOURS older. All sources where it cannot be told: if BASE is empty or unknown, if nothing is
that old, if the former preset cannot be configured, or if what has changed says what is checked, or
with what.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
CONCERNS_ALL = re.compile(
    r"(^|/)(\.clang-tidy|dependencies\.txt)$|^scripts/(tidy\.py|reached\.py)$")
CONCERNS_BUILD = re.compile(
    r"(^|/)(CMakeLists\.txt|CMakePresets\.json|rooms\.txt)$|\.cmake(\.in)?$")
# Commits that land together are taken to have been written within so many hours; scripts/nightly.sh checks all.
LANDING_HOURS = 3
INCLUDE = re.compile(rb'^#include "([^"]+)"', re.MULTILINE)
ANY_INCLUDE = re.compile(rb"^#include (\S+)", re.MULTILINE)


def git(*arguments):
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout


def compiled(root, build_dir):
    """Compilations by source: its path below `root`, and with what it is compiled, wherever `root` lies. Sources that
    the build folder makes come with their text."""
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


def since(base):
    """The commit at which this branch left BASE, or one that is older where nothing has changed
    since; None where there is none, or no git."""
    try:
        commit = git("merge-base", "HEAD", base).strip()
        if not differing(commit):
            written = int(git("show", "--no-patch", "--format=%ct", commit))
            before = written - LANDING_HOURS * 3600
            commit = git("rev-list", "--first-parent", "--max-count=1", f"--before={before}",
                         commit).strip()
        return commit or None
    except (subprocess.CalledProcessError, FileNotFoundError):
        return None


def differing(commit):
    """Paths that differ from a commit, committed or not."""
    # Without renames: what included a file by its former name has changed itself, or does not build.
    paths = set(git("diff", "--name-only", "--no-renames", commit).splitlines())
    paths.update(git("ls-files", "--others", "--exclude-standard").splitlines())
    return paths


def changes(commit, build_dir):
    """Paths below ROOT that differ from a commit, committed or not; None where it cannot be told."""
    paths = differing(commit)
    if not paths or any(CONCERNS_ALL.search(path) for path in paths):
        return None
    changed = {(ROOT / path).resolve() for path in paths}
    if any(CONCERNS_BUILD.search(path) for path in paths):
        try:
            changed |= compiled_otherwise(commit, build_dir)
        except (subprocess.CalledProcessError, FileNotFoundError):  # not to be configured, then
            return None
    return changed


def includes_less(file, commit):
    """Whether a file no longer includes something that it did at a commit."""
    done = subprocess.run(["git", "show", f"{commit}:{file.relative_to(ROOT)}"], cwd=ROOT,
                          capture_output=True)
    return bool(set(ANY_INCLUDE.findall(done.stdout)) -
                set(ANY_INCLUDE.findall(file.read_bytes())))


def included_by(file):
    """The files of this repository that a file includes."""
    for name in INCLUDE.findall(file.read_bytes()):
        name = name.decode()
        for folder in (file.parent, ROOT / "include", ROOT / "src", ROOT):
            if (folder / name).is_file():
                yield (folder / name).resolve()
                break


def all_included_by(file, known):
    """The headers that it includes, however indirectly."""
    if file not in known:
        known[file] = set()  # for a file that includes itself
        for included in included_by(file):
            known[file] |= {included} | all_included_by(included, known)
    return known[file]


def to_check(sources, changed, commit):
    """The sources that are to be checked for the changes since a commit."""
    known = {}
    included = {source: all_included_by(source, known) for source in sources if source.is_file()}
    checked = {source for source in included if source in changed}
    for header in sorted(changed & set().union(*included.values())):
        users = [source for source in included if header in included[source]]
        if includes_less(header, commit):
            checked.update(users)
        else:
            # Its own source, or the one that the build makes for it: that includes it first, which
            # shows that the header includes what it needs.
            name = header.relative_to(ROOT).with_suffix("").parts[1:]
            name = name[1:] if name[0] == "trilobe" else name
            own = [user for user in users if user.with_suffix("").parts[-len(name):] == name]
            if own or not checked.intersection(users):
                checked.add((own or users)[0])
    return checked


def main():
    build_dir = pathlib.Path(sys.argv[1]).resolve()
    base = sys.argv[2] if len(sys.argv) > 2 else "origin/main"
    commands = json.loads((build_dir / "compile_commands.json").read_text())
    sources = list(dict.fromkeys(pathlib.Path(command["directory"], command["file"]).resolve()
                                 for command in commands))
    commit = since(base)
    changed = changes(commit, build_dir) if commit is not None else None
    checked = set(sources) if changed is None else to_check(sources, changed, commit)
    for source in sources:
        if source in checked:
            print(source)


main()
