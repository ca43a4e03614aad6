"""Diagrams of the program: what needs what, what a solver owes, what lies on the disk when, and what a fit costs."""

from __future__ import annotations

import csv
import re
from typing import Any

import numpy as np
from diagrams.look import BLUE, GREEN, GREY, ORANGE, ROOT, SKY, VERMILION, arrow, bare, box, plt, table_of


def parts() -> Any:
    """The parts of the build, how they contain each other, and the packages that they need."""
    figure, axes = plt.subplots(figsize=(9.6, 3.9))
    bare(axes, 19.2, 7.8)
    top = {"va": "top", "linespacing": 1.4}
    box(axes, (0.1, 0.1), (19, 7.6), "", "#ffffff")
    axes.text(0.35, 7.2, "everything: the program trilobe (gflags)   TRILOBE_BUILD_APP", fontsize=9.5)
    box(axes, (0.4, 0.4), (13.2, 6.4), "", "#f5f8fb")
    axes.text(0.65, 6.3, "library trilobe::trilobe   TRILOBE_BUILD_LIBRARY", fontsize=9.5)
    box(axes, (0.7, 0.7), (4.6, 5.2), "", "#cfe3f5")
    axes.text(0.9, 3.2, "trilobe::evaluate\n\nmodel files,\nvalues, samples, albedo\n\nC++ and POSIX alone:\n"
              "what a renderer holds", fontsize=9.5, va="center")
    for k, (name, text) in enumerate((
            ("SOLVERS", "solvers, scenes: GSL, Ceres, LAPACK, xxHash"), ("RGL", "the reader of RGL files"),
            ("PLOTS", "pictures: gnuplot, when they are drawn"), ("", "always: files, sums, scores, sources"))):
        option = f"TRILOBE_BUILD_{name}\n" if name else ""
        box(axes, (5.7, 4.65 - 1.32 * k), (7.6, 1.2), option + text, "#e4eef7", **top)
    for k, (name, text) in enumerate((
            ("TESTS", "GoogleTest"), ("BENCHMARKS", "Google Benchmark"), ("EXPERIMENTS", "gflags, Boost, Python"),
            ("FUZZERS", "clang; off by default"))):
        box(axes, (14, 5.35 - 1.5 * k), (4.8, 1.35), f"TRILOBE_BUILD_{name}\n{text}", "#f3efe2", **top)
    return figure


def solver() -> Any:
    """The calls between caller, solver and library when a solver runs."""
    figure, axes = plt.subplots(figsize=(9.6, 3.6))
    bare(axes, 19.2, 7.2)
    box(axes, (0.2, 4.5), (3.4, 2.2), "the caller\n\nSolve(objective,\noptions, model)")
    box(axes, (4.9, 4.5), (3.6, 2.2), "Solver\n\nchecks what it\nis given")
    box(axes, (9.8, 0.4), (9.2, 6.3), "your class: DoSolve", "#e3f1e6", va="top")
    steps = (("Start", "the clock, the trace, E of the start", 4.9), ("your step", "lowers E", 3.5),
             ("Record", "iteration, E, accepted; keeps the best", 2.1), ("Finish", "the best model, the summary", 0.7))
    for name, text, y in steps:
        mine = name == "your step"
        box(axes, (10.4, y), (2.4, 0.95), name, "#bfe3c6" if mine else "#ffffff", fontweight="bold" if mine else None)
        axes.text(13.1, y + 0.48, text, va="center", fontsize=9)
    for upper, lower in ((4.9, 4.45), (3.5, 3.05), (2.1, 1.65)):
        arrow(axes, (11.6, upper), (11.6, lower))
    axes.plot([10.4, 9.98, 9.98], [2.4, 2.4, 4.0], color=GREEN, lw=1.6)
    arrow(axes, (9.98, 4.0), (10.4, 4.0), GREEN)
    axes.text(13.1, 3.28, "again, while Record returns true", fontsize=9, color=GREEN, va="center")
    arrow(axes, (3.6, 5.6), (4.9, 5.6))
    arrow(axes, (8.5, 5.6), (9.8, 5.6))
    box(axes, (0.2, 0.4), (8.3, 2.9), "", "#fbf3e3")
    axes.text(0.45, 1.85, "Objective: E, the samples, NormalEquations: g and JᵀJ\n\n"
              "Run stops by: the limits of iterations and seconds,\na signal, the tolerance",
              va="center", fontsize=9)
    arrow(axes, (9.8, 1.85), (8.5, 1.85))
    return figure


def on_disk() -> Any:
    """The files in the folder of a fit at each time, and the effect of a signal then."""
    figure, axes = plt.subplots(figsize=(9.6, 3.4))
    bare(axes, 19.2, 6.8)
    phases = (("read", 2.4), ("solve", 4.4), ("finish", 2.6), ("score", 2.0), ("draw", 2.4))
    x, ends = 2.9, {}
    for name, width in phases:
        box(axes, (x, 5.4), (width, 0.9), name, "#dbe7f2")
        x += width
        ends[name] = x
    last = x + 2
    rows = (
        ("an earlier fit's files", 4.4, 2.9, ends["solve"], GREY),
        ("model.json", 3.6, ends["solve"], last, BLUE),
        ("the other files", 2.8, ends["solve"] + 0.4, last, BLUE),
        ("report.json, last", 2.0, ends["draw"], last, BLUE),
    )
    for text, y, start, end, color in rows:
        axes.text(2.7, y + 0.25, text, ha="right", va="center", fontsize=9)
        axes.add_patch(plt.Rectangle((start, y), end - start, 0.5, color=color, lw=0))
    signals = (
        (ends["read"] - 1.2, "Ctrl-C: it ends,\nnothing was begun", ORANGE),
        (ends["read"] + 2.2, "Ctrl-C: the best model so far;\ntwice: that, and no more", ORANGE),
        (ends["score"] - 1.4, "SIGKILL: each file\nis whole or absent", VERMILION),
        (ends["draw"] + 1.1, "all is there", GREEN),
    )
    for place, text, color in signals:
        axes.plot([place, place], [1.35, 5.35], color=color, lw=1.2, ls="--")
        axes.text(place, 1.1, text, ha="center", va="top", fontsize=8.5, color="#202020")
    return figure


def milliseconds(cell: str) -> float:
    """A time in a cell of a table."""
    found = re.match(r"([\d.]+) ms", cell)
    return float(found[1]) if found else np.nan


def cost() -> Any:
    """The cost of passes, from the page's own table, and how measured fits spend their time."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.3), width_ratios=[1, 1.25])
    named = {"E over all samples": "E", "E over all samples, the reference": "E, the reference",
             "one `awls` sweep, E for the trace included": "a sweep of awls",
             "one `awls_literal` sweep": "a sweep of the reference"}
    rows = {named[row[0]]: row for row in table_of("cost.md", "what, full-size material") if row[0] in named}
    for k, row in enumerate(rows.values()):
        for column, color, y in ((1, BLUE, k - 0.2), (2, SKY, k + 0.2)):
            value = milliseconds(row[column])
            if np.isnan(value):
                continue
            left.barh(y, value, 0.38, color=color, label=("1 thread", "2 threads")[column - 1] if k == 0 else None)
            left.text(1.1 * value, y, f"{value:g} ms", va="center", fontsize=9)
    left.set(xscale="log", xlim=(1, 4e4), yticks=range(len(rows)), yticklabels=list(rows), xlabel="ms",
             title="Passes over a million samples")
    left.invert_yaxis()
    left.legend(loc="upper right")
    with (ROOT / "experiments/final_error/results/fits.csv").open() as file:
        fits = sorted((float(row["all_s"]), float(row["solve_s"]), row["material"])
                      for row in csv.DictReader(file) if row["run"] == "defaults" and row["solve_s"])
    total, solving, names = zip(*fits, strict=True)
    y = np.arange(len(fits))
    right.barh(y, solving, color=BLUE, label="solving")
    right.barh(y, np.subtract(total, solving), left=solving, color=SKY, label="reading, finishing, scoring")
    right.set(yticks=y, yticklabels=names, xlabel="s of one processor", title="Fits of measured materials")
    right.tick_params(axis="y", labelsize=7)
    right.margins(y=0.01)
    right.set_xlim(0, 22)
    right.legend(loc="lower right", fontsize=9)
    return figure
