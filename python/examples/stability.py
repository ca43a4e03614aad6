#!/usr/bin/env python3
"""Stability: fits from many starts, how far apart their E are, and whether they have the same lobes.

stability.py [--quick] [--out=FOLDER]     draws starts.png: D of each fit
"""

import argparse
import pathlib

import matplotlib
import numpy as np

import trilobe

matplotlib.use("agg")
from matplotlib import pyplot  # noqa: E402


def main():
    """Fits one measurement from random starts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="three starts, few iterations")
    parser.add_argument("--out", default="out/stability", type=pathlib.Path)
    arguments = parser.parse_args()
    measurement = trilobe.read("synth:plastic@30x30x60", noise=0.02)
    starts = 3 if arguments.quick else 16
    results = [
        trilobe.fit(measurement, solver="varpro", init="random", seed=seed, progress=False,
                    max_iterations=4 if arguments.quick else 60)
        for seed in range(1, starts + 1)
    ]
    objectives = np.array([result.report["objective"] for result in results])
    near = np.mean(objectives < 1.01 * objectives.min())
    print(f"E from {objectives.min():.4g} to {objectives.max():.4g}; {near:.0%} of starts within 1 % of the best")
    best = results[int(objectives.argmin())].model
    alike = np.array([trilobe.match_lobes(best, result.model).agreement for result in results])
    print(f"the lobes of the best in {np.mean(alike >= 0.9):.0%} of them; least agreement {alike.min():.2f}")
    # Models may differ in their tables and not in what they say.
    rng = np.random.default_rng(1)
    w = rng.normal(size=(2, 2000, 3))
    w[..., 2] = np.abs(w[..., 2]) + 0.1
    values = np.log(1 + np.array([result.model.eval_cos(*w) for result in results]))
    tables = np.array([result.model.D for result in results])
    print(f"standard deviation between the fits: log values {values.std(axis=0).mean():.4f}, "
          f"entries of D {tables.std(axis=0).mean() / tables.mean():.2f} of their mean")
    figure, panels = pyplot.subplots(1, 3, figsize=(11, 3.2), layout="constrained", sharey=True)
    for lobe, axes in enumerate(panels):
        for result in results:
            table = result.model.D
            axes.plot(np.degrees(table.coords["theta_h"]), np.asarray(table)[lobe] + 1e-4, alpha=0.5)
        axes.set_yscale("log")
        axes.set_title(f"D of lobe {lobe + 1}")
        axes.set_xlabel("θh [°]")
    arguments.out.mkdir(parents=True, exist_ok=True)
    figure.savefig(arguments.out / "starts.png", dpi=100)


if __name__ == "__main__":
    main()
