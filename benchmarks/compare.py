#!/usr/bin/env python3
"""Benchmarks of two builds, before and after a change, in one table (Markdown).

benchmarks/compare.py BEFORE AFTER [--program=fit_benchmark] [--rounds=5] [--filter=REGEX]
                      [--rename=OLD=NEW ...]

BEFORE and AFTER are build folders. They take turns, so that what else the machine does falls on both,
as it does not with Google Benchmark's own compare.py; times are medians over the rounds. A benchmark that only one of them has is left out. Those of
anisotropic_benchmark compare within themselves, and are not for this.

    git worktree add ../before COMMIT
    (cd ../before && cmake --preset release &&
     cmake --build --preset release --target fit_benchmark trilobe_app)
    benchmarks/compare.py ../before/build/release build/release
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import sys


def times_of(program, pattern):
    """What one run measures: seconds by name."""
    command = [program, "--benchmark_format=json", f"--benchmark_filter={pattern}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"error: '{program}' failed: {done.stderr.strip()}")
    if not done.stdout:
        sys.exit(f"error: no benchmark of '{program}' matches '{pattern}'")
    units = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
    found = {}
    for entry in json.loads(done.stdout)["benchmarks"]:
        if not entry.get("error_occurred"):
            name = entry["name"].removeprefix("BM_").split("/iterations:")[0]
            found[name.removesuffix("/real_time").removesuffix("/manual_time")] = \
                entry["real_time"] * units[entry["time_unit"]]
    return found


def readable(seconds):
    return f"{seconds:.3g} s" if seconds >= 1 else f"{seconds * 1000:.3g} ms"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=pathlib.Path)
    parser.add_argument("after", type=pathlib.Path)
    parser.add_argument("--program", default="fit_benchmark")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--filter", default=".", help="a regular expression, of the names in both")
    parser.add_argument("--rename", action="append", default=[], metavar="OLD=NEW",
                        help="what BEFORE calls otherwise")
    arguments = parser.parse_args()
    renames = [rename.partition("=")[::2] for rename in arguments.rename]
    programs = [build / "benchmarks" / arguments.program
                for build in (arguments.before, arguments.after)]
    for program in programs:
        if not program.is_file():
            sys.exit(f"error: there is no '{program}'; build the target {arguments.program} there")

    runs = [{}, {}]
    for turn in range(arguments.rounds):
        for which in (0, 1) if turn % 2 == 0 else (1, 0):
            print(f"round {turn + 1} of {arguments.rounds}: {programs[which]}", file=sys.stderr)
            for name, seconds in times_of(programs[which], arguments.filter).items():
                for old, new in renames if which == 0 else []:
                    name = name.replace(old, new)
                runs[which].setdefault(name, []).append(seconds)

    print("| benchmark | before | after | after / before |\n| --- | --- | --- | --- |")
    for name in runs[1]:
        if name in runs[0]:
            before, after = (statistics.median(run[name]) for run in runs)
            print(f"| `{name}` | {readable(before)} | {readable(after)} | {after / before:.2f} |")


main()
