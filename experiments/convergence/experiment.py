"""Convergence: see README.md beside this file."""
import math

import numpy

from lab import fits, stats, tables
from lab.fits import Fit

POINTS = 40  # points per curve, at iterations that grow by a constant factor


def units(setting):
    return fits.planned(setting)


# --- tables ---------------------------------------------------------------------------------------


def _steps(trace):
    """(rows of accepted iterations, the relative decrease of E of each)."""
    rows, decreases = [], []
    for before, after in zip(trace, trace[1:]):
        if after["accepted"]:
            rows.append(after)
            decreases.append((before["objective"] - after["objective"]) / before["objective"]
                             if before["objective"] > 0 else 0.0)
    return rows, decreases


def _solver_row(result, fit):
    rows, decreases = _steps(fit.trace)
    made = len(fit.trace) - 1
    diagnosis = fit.report["diagnosis"]
    return {"material": result.labels["material"], "solver": result.labels["solver"],
            "objective": fit.report["objective"], "iterations": made,
            "seconds_an_iteration": (fit.trace[-1]["clock"] - fit.trace[0]["clock"]) / max(made, 1),
            "rejected": fit.report["rejected_steps"],
            "factor": stats.linear_rate([d for d in decreases if d > stats.ROUNDING]),
            "order": stats.order([d for d in decreases if d > stats.ROUNDING]),
            "last_decrease": decreases[-1] if decreases else math.nan,
            "last_step": rows[-1]["step"] if rows else math.nan,
            "optimality": diagnosis["optimality"] if diagnosis else math.nan,
            "stop_reason": fit.report["stop_reason"]}


def _curve_rows(result, fit, best):
    """Iterations that grow by a constant factor; the decrease is the mean of an iteration since
    the row before. No decrease and no step where the step was taken back."""
    trace = fit.trace
    chosen = sorted({0, len(trace) - 1} | {
        round(k) for k in numpy.geomspace(1, max(1, len(trace) - 1), POINTS)})
    rows, before = [], None
    for k in chosen:
        if k >= len(trace):
            continue
        now = trace[k]
        decrease = None
        if before is not None and trace[before]["objective"] > 0:
            ratio = now["objective"] / trace[before]["objective"]
            decrease = 1 - ratio ** (1 / (k - before)) if ratio != 1 else None
        rows.append({"material": result.labels["material"], "solver": result.labels["solver"],
                     "iteration": k,
                     "excess": float(f"{stats.excess(now['objective'], best):.4g}"),
                     "decrease": None if decrease is None else float(f"{decrease:.4g}"),
                     "step": float(f"{now['step']:.4g}") if now["accepted"] else None,
                     "optimality": None if math.isnan(now["optimality"])
                     else float(f"{now['optimality']:.4g}")})
        before = k
    return rows


def tabulate(setting, results):
    solver_fits = [(result, Fit(result.folder, fits.clock(setting))) for result in results if result.folder]
    best = {}
    for result, fit in solver_fits:
        name = result.labels["material"]
        best[name] = min(best.get(name, math.inf), fit.report["objective"])
    curves = [row for result, fit in solver_fits
              for row in _curve_rows(result, fit, best[result.labels["material"]])]
    return {"solvers": [_solver_row(result, fit) for result, fit in solver_fits],
            "curves": curves,
            "missing": [{**{key: result.labels[key] for key in ("material", "solver", "run")},
                         "unit": result.unit.path} for result in results if not result.folder]}


# --- pictures -------------------------------------------------------------------------------------


def _curves_figure(curves):
    """Medians over the materials against the iteration: excess, decrease, step, optimality."""
    from lab import plots
    solvers = list(dict.fromkeys(row["solver"] for row in curves))
    names = {row["material"] for row in curves}
    panels_of = (("excess", "excess of E over the best (%)", 100, 1e-4),
                 ("decrease", "decrease of E an iteration (%)", 100, 1e-8),
                 ("step", "length of the step, of that of x (%)", 100, 1e-4),
                 ("optimality", "scaled projected gradient", 1, 1e-10))
    figure, panels = plots.plt.subplots(2, 2, figsize=(12, 9), sharex=True)
    for axes, (column, label, factor, least) in zip(panels.flat, panels_of):
        for solver in solvers:
            of_material = tables.groups([row for row in curves if row["solver"] == solver
                                         and row[column] is not None], "material")
            if not of_material:
                continue
            # The curve ends at an iteration that at least half of the materials reach.
            ends = sorted(max(row["iteration"] for row in rows) for rows in of_material.values())
            grid = numpy.unique(numpy.geomspace(1, max(2, ends[len(ends) // 2]), 60).round())
            values = [stats.value_at([row["iteration"] for row in rows],
                                     [factor * row[column] for row in rows], grid)
                      for rows in of_material.values()]
            middle = [max(stats.median(list(of)), least) for of in zip(*values)]
            shown = [(k, m) for k, m in zip(grid, middle) if math.isfinite(m)]
            if shown:
                axes.plot(*zip(*shown), label=solver, **plots.solver_style(solver, solvers))
        axes.set(xscale="log", yscale="log", title=label)
        plots.plain_numbers(axes.xaxis)
        plots.label_ends(axes, spacing=0.06)
    for axes in panels[-1]:
        axes.set_xlabel("iteration")
    figure.suptitle(f"Convergence: medians over {len(names)} materials", x=0.01, ha="left")
    return figure


def _solver_table(rows, missing):
    header = ["solver", "n", "iterations", "s an iteration", "factor an iteration", "order",
              "last decrease of E", "optimality at the end", "steps taken back"]
    lines = []
    for solver, (of, lost) in tables.with_missing(rows, missing, "solver").items():
        lines.append([solver, tables.count(len(of) + lost, lost),
                      *(tables.quartiles([row[column] for row in of])
                        for column in ("iterations", "seconds_an_iteration", "factor", "order",
                                       "last_decrease", "optimality", "rejected"))])
    return tables.markdown(header, lines)


def draw(drawn, _):
    products = {}
    if drawn["solvers"]:
        products["solvers.md"] = _solver_table(drawn["solvers"], drawn["missing"])
    if drawn["curves"]:
        products["curves"] = _curves_figure(drawn["curves"])
    return products
