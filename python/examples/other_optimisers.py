#!/usr/bin/env python3
"""Other people's optimisers on the E of our solvers: SciPy's, and Adam, beside lm and auto.

other_optimisers.py [--quick] [--seconds=20] [--out=FOLDER] [SOURCE...]     draws E over time and writes a table

All begin at the same start. Time is that of the processor. Each optimiser gets so many seconds, and what it has found
by then counts. "log" means that it works in y = log(x + 1e-9 max x), where no bounds are needed.
"""

import argparse
import csv
import pathlib
import time
import warnings

import matplotlib
import numpy as np
from scipy import optimize

import trilobe

matplotlib.use("agg")
from matplotlib import pyplot as plt  # noqa: E402


class OutOfTime(Exception):
    """Ends an optimiser that knows no limit of time."""


class Recorder:
    """E at points that an optimiser asks for: the lowest so far, over processor seconds."""

    def __init__(self, objective, seconds):
        self.objective, self.seconds = objective, seconds
        self.began = time.process_time()
        self.trace = []

    def __call__(self, x):
        """E and its gradient at x >= 0."""
        value, gradient = self.objective.value_and_gradient(self.objective.project(x))
        self.record(value)
        return value, gradient

    def record(self, value):
        """Notes E; ends the optimiser when its time is up."""
        elapsed = time.process_time() - self.began
        self.trace.append((elapsed, min(value, self.trace[-1][1]) if self.trace else value))
        if elapsed > self.seconds:
            raise OutOfTime


def in_logarithms(start):
    """Back from y to x, and dx/dy. The start of y; entries of 0 can grow."""
    floor = 1e-9 * start.max()

    def back(y):
        x = np.exp(np.clip(y, -300, 300))
        return np.maximum(x - floor, 0), x

    return back, np.log(start + floor)


def quasi_newton(method, logarithms):
    """SciPy's L-BFGS-B or TNC, in x under bounds or in log x."""

    def run(f, start):
        if not logarithms:
            optimize.minimize(f, start, jac=True, method=method, bounds=f.objective.bounds,
                              options={"maxiter": 10**6, "maxfun": 10**6, "ftol": 1e-12, "gtol": 1e-14})
            return
        back, y = in_logarithms(start)

        def of_y(y):
            x, slope = back(y)
            value, gradient = f(x)
            return value, gradient * slope

        optimize.minimize(of_y, y, jac=True, method=method, options={"maxiter": 10**6})

    return run


def adam(rate):
    """Adam (Kingma and Ba 2015) in log x, on all samples at once, with a step that falls as 1/sqrt(t)."""

    def run(f, start):
        back, y = in_logarithms(start)
        first, second = np.zeros_like(y), np.zeros_like(y)
        for t in range(1, 10**6):
            x, slope = back(y)
            gradient = f(x)[1] * slope
            first += 0.1 * (gradient - first)
            second += 0.001 * (gradient**2 - second)
            step = first / (1 - 0.9**t) / (np.sqrt(second / (1 - 0.999**t)) + 1e-12)
            y = y - rate / np.sqrt(t) * step

    return run


def trust_region(f, start):
    """SciPy's least_squares, trf, under bounds, with the sparse Jacobian."""
    objective = f.objective

    def residuals(x):
        r = objective.residuals(x)
        f.record(float(r @ r))
        return r

    optimize.least_squares(residuals, np.maximum(start, 1e-9 * start.max()), objective.jacobian,
                           bounds=(0, np.inf), x_scale="jac", max_nfev=10**5)


def newton_with_projection(f, start):
    """Levenberg's steps by the normal equations, clipped at 0: what one writes in an hour."""
    objective, x, damping = f.objective, start.copy(), 1e-3
    value = objective.value(x)
    while True:
        matrix, right = objective.normal_equations(x)
        f.record(value)
        lengths = np.maximum(np.diag(matrix), 1e-30)
        for _ in range(30):
            free = (x > 0) | (right < 0)
            step = np.zeros_like(x)
            damped = matrix[np.ix_(free, free)] + damping * np.diag(lengths[free])
            step[free] = np.linalg.solve(damped, -right[free])
            after = objective.project(x + step)
            lowered = objective.value(after)
            if lowered < value:
                break
            damping *= 4
        else:
            return
        x, value, damping = after, lowered, damping / 4


OTHERS = {
    "L-BFGS-B": quasi_newton("L-BFGS-B", logarithms=False),
    "L-BFGS-B log": quasi_newton("L-BFGS-B", logarithms=True),
    "TNC": quasi_newton("TNC", logarithms=False),
    "Adam log 0.1": adam(0.1),
    "Adam log 0.3": adam(0.3),
    "trf": trust_region,
    "projected LM": newton_with_projection,
}
OURS = ("awls", "lm", "auto")


def compare(measurement, names, seconds):
    """Traces by optimiser: (processor seconds, lowest E so far) at each evaluation."""
    objective = trilobe.Objective(measurement, threads=1)
    start = objective.start()
    traces = {}
    for name in names:
        if name in OURS:
            began = time.process_time()
            fit = trilobe.fit(measurement, solver=name, raw=True, max_seconds=seconds, tolerance=0, diagnose=False,
                              threads=1, max_iterations=10**6, progress=False)
            # One thread fits: the processor's time by the wall's, of the fit.
            share = (time.process_time() - began) / max(sum(fit.report["seconds"].values()), 1e-9)
            lowest = np.minimum.accumulate(fit.trace["objective"])
            traces[name] = list(zip(share * fit.trace["seconds"], lowest, strict=True))
            continue
        f = Recorder(objective, seconds)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # logarithms may run away
                OTHERS[name](f, start)
        except OutOfTime:
            pass
        traces[name] = f.trace
    return traces


def draw(traces, lowest, path, title):
    """E above the lowest, over seconds."""
    figure, axes = plt.subplots(figsize=(8, 5))
    for name, trace in traces.items():
        seconds, values = np.array(trace).T
        axes.step(np.maximum(seconds, 1e-2), np.maximum(values / lowest - 1, 1e-5), where="post", label=name,
                  linewidth=2.4 if name in OURS else 1.4)
    axes.set(xscale="log", yscale="log", xlabel="processor seconds", ylabel="E above the lowest, relative", title=title)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, ncols=2)
    figure.savefig(path, dpi=110, bbox_inches="tight")
    plt.close(figure)


def main():
    """Compares on each source, prints a table and writes it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sources", nargs="*", default=["synth:copper@30x30x60"])
    parser.add_argument("--quick", action="store_true", help="a small table, a second each")
    parser.add_argument("--seconds", type=float, default=20, help="of the processor, for each optimiser")
    parser.add_argument("--out", default="out/other_optimisers", type=pathlib.Path)
    arguments = parser.parse_args()
    seconds = 0.5 if arguments.quick else arguments.seconds
    sources = ["synth:copper@12x12x24"] if arguments.quick else arguments.sources
    arguments.out.mkdir(parents=True, exist_ok=True)
    with open(arguments.out / "optimisers.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["source", "optimiser", "evaluations", "objective", "excess", "seconds_to_1_percent"])
        for source in sources:
            synthetic = source.startswith("synth:")
            measurement = trilobe.read(source, noise=0.02 if synthetic else 0)
            traces = compare(measurement, [*OTHERS, *OURS], seconds)
            lowest = min(trace[-1][1] for trace in traces.values())
            name = pathlib.Path(source).stem.replace(":", "_")
            draw(traces, lowest, arguments.out / f"{name}.png", source)
            print(f"{source}\noptimiser      evaluations            E   above lowest   seconds to 1 %")
            for optimiser, trace in traces.items():
                reached = next((t for t, value in trace if value <= 1.01 * lowest), np.inf)
                excess = trace[-1][1] / lowest - 1
                table.writerow([source, optimiser, len(trace), trace[-1][1], excess, reached])
                print(f"{optimiser:14} {len(trace):11} {trace[-1][1]:12.6g} {100 * excess:12.3f} % {reached:16.3g}")


if __name__ == "__main__":
    main()
