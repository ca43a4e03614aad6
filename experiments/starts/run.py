#!/usr/bin/env python3
"""Which starting point is best? Fits every source from every start with the same number of sweeps.

Usage: experiments/starts/run.py [--program build/release/bin/trilobe] [--out out/starts]
                                 [--sweeps 80] SOURCE [SOURCE ...]

Prints a table: for each start, after 5, 10, 20, 40 and 80 sweeps, E over the lowest E that any start
has on that material by then: geometric mean, worst case, and on how many materials it is the lowest.
A run that the same command has made is not repeated. Needs nothing but Python.
"""
import argparse
import csv
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from fits import fit_once  # noqa: E402

STARTS = ["analytic", "highlight", "constant", "random"]
CHECKPOINTS = [5, 10, 20, 40, 80]


def objectives(program, source, start, sweeps, folder):
    """E after each sweep of one fit."""
    command = [program, "fit", source, "--solver=awls", f"--init={start}", f"--max_iterations={sweeps}",
               "--tolerance=0", f"--out={folder}"]
    with open(fit_once(command, folder, "trace.csv"), newline="") as file:
        return {int(row["iteration"]): float(row["objective"]) for row in csv.DictReader(file)}


def after(trace, sweeps):
    """E after this many sweeps, or after the last one where the fit ended earlier."""
    return trace[min(sweeps, max(trace))]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/trilobe")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/starts"))
    parser.add_argument("--sweeps", type=int, default=80)
    parser.add_argument("sources", nargs="+")
    options = parser.parse_args()

    traces = {}
    for source in options.sources:
        name = pathlib.Path(source).name.replace(":", "-")
        for start in STARTS:
            traces[name, start] = objectives(options.program, source, start, options.sweeps,
                                             options.out / name / start)
    names = sorted({name for name, _ in traces})
    checkpoints = [k for k in CHECKPOINTS if k <= options.sweeps]
    print("| start | " + " | ".join(f"{k} sweeps" for k in checkpoints) + " |")
    print("|---" * (1 + len(checkpoints)) + "|")
    for start in STARTS:
        cells = []
        for k in checkpoints:
            ratios = []
            for name in names:
                best = min(after(traces[name, other], k) for other in STARTS)
                ratios.append(after(traces[name, start], k) / best)
            mean = math.exp(sum(math.log(ratio) for ratio in ratios) / len(ratios))
            wins = sum(ratio == 1 for ratio in ratios)
            cells.append(f"{mean:.3f}, worst {max(ratios):.2f}, best on {wins}")
        print(f"| {start} | " + " | ".join(cells) + " |")
    print(f"\n{len(names)} materials.")


if __name__ == "__main__":
    main()
