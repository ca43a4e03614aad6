"""Convergence: see README.md beside this file."""
import json
import math

import numpy

from lab import fits, stats, tables
from lab.fits import Fit
from lab.units import Unit

POINTS = 40  # of a curve, at iterations that grow by a constant factor


def units(setting):
    look = setting.manifest["element_by_element"]
    program = setting.program("monotone")
    return fits.planned(setting) + [
        Unit(f"monotone/{source.name}/{solver}", program,
             (f"--solver={solver}", f"--stride={look['stride']}", f"--sweeps={look['sweeps']}",
              f"--weighting={look['weighting']}", *fits.words(setting.reading(source)),
              source.path), labels={"material": source.name, "solver": solver, "run": "elements"})
        for source in setting.every(look["every"]) for solver in look["solvers"]]


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


def _roughness(fit):
    """Root mean square second difference of the G tables, each over its mean; of whole ones."""
    model = json.loads((fit.folder / "model.json").read_text())
    values = []
    for table, unobserved in zip(model["G"], model.get("unobserved", model.get("dead", {}))
                                 .get("G", [[]] * len(model["G"]))):
        table = numpy.asarray(table, dtype=float)
        if unobserved or table.mean() == 0:
            continue
        values.append(numpy.diff(table / table.mean(), 2) ** 2)
    return math.sqrt(numpy.mean(values)) if values else math.nan


def _filter_row(result, fit):
    rises = [(after["objective"] - before["objective"]) / before["objective"]
             for before, after in zip(fit.trace, fit.trace[1:])
             if after["objective"] > before["objective"] > 0]
    return {"material": result.labels["material"],
            "filter_deg": fit.report["options"]["given"]["g_filter_sigma"],
            "sweeps": fit.report["iterations"], "best_sweep": fit.report["best_iteration"],
            "sweeps_that_raised_E": len(rises), "worst_rise": max(rises, default=0.0),
            # Of the sweeps: the report's E is that after entries at the edge of the data are tied.
            "objective": min(row["objective"] for row in fit.trace),
            "last_objective": fit.trace[-1]["objective"],
            "psnr_db": fit.report["psnr_db"], "mean_log_error": fit.report["mean_log_error"],
            "G_roughness": _roughness(fit)}


def tabulate(setting, results):
    there = [result for result in results if result.folder]
    of_run = {}
    for result in there:
        of_run.setdefault(result.labels["run"], []).append(result)
    solver_fits = [(result, Fit(result.folder, fits.clock(setting)))
                   for result in of_run.get("solvers", [])]
    best = {}
    for result, fit in solver_fits:
        name = result.labels["material"]
        best[name] = min(best.get(name, math.inf), fit.report["objective"])
    curves = [row for result, fit in solver_fits
              for row in _curve_rows(result, fit, best[result.labels["material"]])]
    elements = [{"material": result.labels["material"],
                 **json.loads((result.folder / "stdout.txt").read_text())}
                for result in of_run.get("elements", [])]
    return {"solvers": [_solver_row(result, fit) for result, fit in solver_fits],
            "curves": curves, "elements": elements,
            "filter": [_filter_row(result, Fit(result.folder))
                       for result in of_run.get("filter", [])],
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
            # As far as at least half of the materials go.
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


def _elements_figure(elements):
    """The worst relative rise of each material, sorted."""
    from lab import plots
    figure, axes = plots.plt.subplots(figsize=(8, 4))
    for solver, rows in tables.groups(elements, "solver").items():
        worst = sorted(max(row["worst_relative_rise"], 1e-17) for row in rows)
        axes.plot(range(1, len(worst) + 1), worst, "o", markersize=4, label=solver,
                  color=plots.solver_style(solver)["color"])
    axes.axhline(numpy.finfo(float).eps, color=plots.GREY, linewidth=1)
    axes.annotate("rounding of one double", (1, numpy.finfo(float).eps * 1.3), fontsize=9,
                  color="#555555")
    axes.set(yscale="log", ylim=(1e-17, 1e-9), xlabel="materials, sorted",
             ylabel="worst relative rise of E in one update",
             title="The worst rise of each material, a dot each (1e-17: none at all)")
    plots.label_ends(axes)
    return figure


def _filter_figure(rows):
    """What the filter costs in E and buys in smoothness, a line a material."""
    from lab import plots
    figure, panels = plots.plt.subplots(1, 2, figsize=(11, 4.6))
    widths = sorted({row["filter_deg"] for row in rows})
    at = {(row["material"], row["filter_deg"]): row for row in rows}
    names = sorted({row["material"] for row in rows if (row["material"], 0) in at})
    for axes, column, label in ((panels[0], "objective", "lowest E over that without filter"),
                                (panels[1], "G_roughness",
                                 "roughness of G over that without filter")):
        for k, name in enumerate(names):
            shown = [w for w in widths if (name, w) in at]
            base = at[name, 0][column]
            if base is None or math.isnan(base):  # no G table that data touch everywhere
                continue
            axes.plot(shown, [stats.ratio(at[name, w][column], base) for w in shown], marker="o",
                      label=name, color=plots.SERIES[k % len(plots.SERIES)], linewidth=1.4,
                      linestyle="-" if k < len(plots.SERIES) else "--")
        axes.set(yscale="log", title=label,
                 xlabel="standard deviation of the filter on G (degrees)")
        axes.set_xticks(widths)
        plots.plain_numbers(axes.yaxis)
        plots.label_ends(axes, spacing=0.06)
    return figure


def _by_solver(rows, missing, run):
    """{solver: (its rows, how many of its fits are missing)}"""
    return tables.with_missing(rows, [row for row in missing if row["run"] == run], "solver")


def _solver_table(rows, missing):
    header = ["solver", "n", "iterations", "s an iteration", "factor an iteration", "order",
              "last decrease of E", "optimality at the end", "steps taken back"]
    lines = []
    for solver, (of, lost) in _by_solver(rows, missing, "solvers").items():
        lines.append([solver, tables.count(len(of) + lost, lost),
                      *(tables.quartiles([row[column] for row in of])
                        for column in ("iterations", "seconds_an_iteration", "factor", "order",
                                       "last_decrease", "optimality", "rejected"))])
    return tables.markdown(header, lines)


def _elements_table(rows, missing):
    lines = []
    for solver, (of, lost) in _by_solver(rows, missing, "elements").items():
        if not of:
            lines.append([solver, tables.count(lost, lost), *["–"] * 4])
            continue
        worst = max(of, key=lambda row: row["worst_relative_rise"])
        lines.append([solver, tables.count(len(of) + lost, lost),
                      f"{sum(row['updates'] for row in of):,}",
                      f"{sum(row['raised'] for row in of):,}",
                      f"**{worst['worst_relative_rise']:.2g}**", worst["material"]])
    return tables.markdown(["solver", "materials", "updates", "that raised E at all",
                            "worst relative rise", "on"], lines)


def _filter_table(rows):
    at = {(row["material"], row["filter_deg"]): row for row in rows}
    lines = []
    for width in sorted({row["filter_deg"] for row in rows if row["filter_deg"] > 0}):
        pairs = [(at[name, 0], row) for (name, w), row in at.items()
                 if w == width and (name, 0) in at]
        lines.append([f"{width:g}", str(len(pairs)),
                      tables.quartiles([row["sweeps_that_raised_E"] / row["sweeps"] * 100
                                  for _, row in pairs]),
                      tables.quartiles([100 * row["worst_rise"] for _, row in pairs]),
                      tables.quartiles([stats.ratio(row["objective"], plain["objective"])
                                        for plain, row in pairs]),
                      tables.quartiles([stats.ratio(row["last_objective"], row["objective"])
                                        for _, row in pairs]),
                      tables.quartiles([plain["psnr_db"] - row["psnr_db"] for plain, row in pairs]),
                      tables.quartiles([row["G_roughness"] / plain["G_roughness"]
                                  for plain, row in pairs])])
    return tables.markdown(["filter, degrees", "n", "sweeps that raised E, %", "worst rise, %",
                            "lowest E over that without", "last E over lowest", "PSNR lost, dB",
                            "roughness of G over that without"], lines)


def draw(drawn, _):
    products = {}
    if drawn["solvers"]:
        products["solvers.md"] = _solver_table(drawn["solvers"], drawn["missing"])
    if drawn["curves"]:
        products["curves"] = _curves_figure(drawn["curves"])
    if drawn["elements"]:
        products["elements.md"] = _elements_table(drawn["elements"], drawn["missing"])
        if any(row["raised"] for row in drawn["elements"]):  # else there is nothing to see
            products["elements"] = _elements_figure(drawn["elements"])
    if drawn["filter"]:
        products["filter.md"] = _filter_table(drawn["filter"])
        products["filter"] = _filter_figure(drawn["filter"])
    return products
