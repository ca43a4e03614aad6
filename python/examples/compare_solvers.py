#!/usr/bin/env python3
"""Compare solvers: how far down E is after how many seconds, for all from the same start.

compare_solvers.py [--quick] [--out=FOLDER] [SOURCE]     draws trace.png and prints a table
"""

import argparse
import pathlib

import matplotlib

import trilobe

matplotlib.use("agg")
from trilobe import plot  # noqa: E402


def main():
    """Fits one measurement by several solvers."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", nargs="?", default="synth:copper@45x45x90")
    parser.add_argument("--quick", action="store_true", help="two solvers, few iterations")
    parser.add_argument("--out", default="out/compare_solvers", type=pathlib.Path)
    arguments = parser.parse_args()
    measurement = trilobe.read(arguments.source, noise=0.02 if arguments.source.startswith("synth:") else 0)
    solvers = ["awls", "newton"] if arguments.quick else ["awls", "awls_accelerated", "varpro", "newton", "auto"]
    iterations = 3 if arguments.quick else 40
    results = {}
    for solver in solvers:
        # Without what comes after the solver, which would be the same for all.
        results[solver] = trilobe.fit(measurement, solver=solver, max_iterations=iterations, diagnose=False)
    best = min(result.trace["objective"].min() for result in results.values())
    print("solver             iterations   seconds   E above the best")
    for solver, result in results.items():
        last = result.trace[-1]
        above = 100 * (last["objective"] / best - 1)
        print(f"{solver:18} {last['iteration']:10} {last['seconds']:9.2f} {above:16.3f} %")
    arguments.out.mkdir(parents=True, exist_ok=True)
    plot.trace(results).savefig(arguments.out / "trace.png", dpi=100)


if __name__ == "__main__":
    main()
