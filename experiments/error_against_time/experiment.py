"""Error against run time: see README.md beside this file."""
import math

import numpy

from lab import fits, records, stats, tables
from lab.fits import Fit

POINTS = 32  # points per curve, at times that grow by a constant factor
TARGETS = (0.1, 0.01, 0.001)
DEFAULT_START = "analytic"
SOON = 5  # seconds after which errors are compared


def units(setting):
    return fits.planned(setting)


# --- tables ---------------------------------------------------------------------------------------


def _labels(result, setting):
    return {**{key: result.labels[key] for key in ("material", "solver", "start", "seed",
                                                   "threads", "repeat")},
            "clock": fits.clock(setting)}


def _best_objectives(fit_of):
    """{material: E*}: the lowest E that any fit of it has recorded."""
    best = {}
    for result, fit in fit_of:
        name = result.labels["material"]
        best[name] = min(best.get(name, math.inf), *(row["objective"] for row in fit.trace))
    return best


def _run_row(result, fit, best, labels, database):
    times = [row["clock"] for row in fit.trace]
    objectives = stats.best_so_far([row["objective"] for row in fit.trace])
    report = fit.report
    row = {**labels, "database": database[result.labels["material"]],
           "objective": objectives[-1], "excess": stats.excess(objectives[-1], best),
           **records.columns(report, result.labels["material"])}
    for target in TARGETS:
        row[f"seconds_to_{100 * target:g}_percent"] = stats.time_to_target(
            times, objectives, (1 + target) * best)
    return {**row, "seconds": times[-1], "before_s": fit.before, "iterations": report["iterations"],
            "stop_reason": report["stop_reason"],
            "optimality": report["diagnosis"] and report["diagnosis"]["optimality"],
            "trace_share": report["phases"]["tracing"] / report["seconds"]["solve"],
            "psnr_db": report["psnr_db"], "mean_log_error": report["mean_log_error"],
            "mean_relative_error": report["mean_relative_error"]}


def _on_grid(rows, column, grid):
    """The column of the last row at or before each time; inf before the first."""
    values = [row[column] for row in rows]
    if column == "objective":
        values = stats.best_so_far(values)
    return stats.value_at([row["clock"] for row in rows], values, grid)


def _curves(results, fit_of, best, grid):
    """A row a time of each fit from the default start, of the materials that most solvers were to
    fit: excess, loss of PSNR, mean log error over that of the fit with the lowest E."""
    solvers = {}
    for result in results:
        solvers.setdefault(result.labels["material"], set()).add(result.labels["solver"])
    most = max(map(len, solvers.values()), default=0)
    final = {}
    for result, fit in fit_of:
        name = result.labels["material"]
        if name not in final or fit.report["objective"] < final[name]["objective"]:
            final[name] = fit.report
    rows = []
    for result, fit in fit_of:
        if (result.labels["start"] != DEFAULT_START or result.labels["repeat"] > 1
                or len(solvers[result.labels["material"]]) < most):
            continue
        reference = final[result.labels["material"]]
        lowest = best[result.labels["material"]]
        objective = _on_grid(fit.trace, "objective", grid)
        psnr = _on_grid(fit.convergence, "psnr_db", grid)
        log_error = _on_grid(fit.convergence, "mean_log_error", grid)
        for k, seconds in enumerate(grid):
            if math.isinf(objective[k]):
                continue
            known = math.isfinite(psnr[k]) and math.isfinite(log_error[k])
            rows.append({
                **{key: result.labels[key] for key in ("material", "solver", "threads")},
                "seconds": float(f"{seconds:.4g}"),
                "excess": float(f"{stats.excess(objective[k], lowest):.4g}"),
                "psnr_loss_db": float(f"{reference['psnr_db'] - psnr[k]:.4g}") if known else None,
                "log_error_ratio": float(f"{log_error[k] / reference['mean_log_error']:.4g}")
                if known and reference["mean_log_error"] > 0 else None})
    return rows


def tabulate(setting, results):
    fit_of = [(result, Fit(result.folder, fits.clock(setting)))
              for result in results if result.folder]
    best = _best_objectives(fit_of)
    database = {source.name: source.database for source in setting.sources}
    fit_at = {result.unit.key: fit for result, fit in fit_of}
    runs = []
    for result in results:
        labels = _labels(result, setting)
        if fit := fit_at.get(result.unit.key):
            runs.append(_run_row(result, fit, best[result.labels["material"]], labels, database))
        else:
            runs.append({**labels, "database": database[result.labels["material"]],
                         "excess": math.inf, "stop_reason": "missing",
                         **{f"seconds_to_{100 * target:g}_percent": math.inf
                            for target in TARGETS}})
    clocks = [row["clock"] for _, fit in fit_of for row in fit.trace if row["clock"] > 0]
    grid = numpy.geomspace(min(clocks), max(clocks), POINTS) if clocks else []
    return {"runs": runs, "curves": _curves(results, fit_of, best, grid)}


# --- pictures -------------------------------------------------------------------------------------


def _complete(runs):
    """The rows of the materials that every solver was to fit from the default start with the larger
    number of threads, and all solvers."""
    threads = max(row["threads"] for row in runs)
    rows = [row for row in runs if row["start"] == DEFAULT_START and row["threads"] == threads]
    solvers = list(dict.fromkeys(row["solver"] for row in rows))
    names = {name for name, of in tables.groups(rows, "material").items()
             if {row["solver"] for row in of} == set(solvers)}
    return [row for row in rows if row["material"] in names], solvers, threads


def _clock(rows):
    return fits.CLOCKS[rows[0]["clock"]]


def _threads(number):
    return "1 thread" if number == 1 else f"{number} threads"


def _draw_shares(axes, of_solver, solvers, low, high):
    """Share of problems at most x, over a logarithmic x; the highest line labelled first."""
    from lab import plots
    at = numpy.geomspace(low, high, 300)
    for solver in solvers:
        axes.plot(at, 100 * stats.data_profile(of_solver[solver], at), label=solver,
                  **plots.solver_style(solver, solvers))
    axes.set(xscale="log", xlim=(low, high), ylim=(-2, 102))
    plots.plain_numbers(axes.xaxis)
    plots.label_ends(axes)


def _profile_figure(rows, solvers, threads):
    """Data profiles at the three targets, and the performance profile at 1 %."""
    from lab import plots
    figure, panels = plots.plt.subplots(2, 2, figsize=(11, 8))
    names = list(dict.fromkeys(row["material"] for row in rows))
    at = {(row["material"], row["solver"]): row for row in rows}
    for axes, target in zip(panels.flat, TARGETS):
        column = f"seconds_to_{100 * target:g}_percent"
        times = {s: [at[name, s][column] for name in names] for s in solvers}
        finite = [t for of in times.values() for t in of if math.isfinite(t)] or [1]
        _draw_shares(axes, times, solvers, 0.8 * min(finite), 1.1 * max(finite))
        axes.set(title=f"within {100 * target:g} % of the best E", xlabel=_clock(rows),
                 ylabel="share of materials (%)")
    column = "seconds_to_1_percent"
    ratios = stats.performance_ratios({s: [at[name, s][column] for name in names]
                                       for s in solvers})
    finite = [r for of in ratios.values() for r in of if math.isfinite(r)] or [1]
    axes = panels.flat[3]
    _draw_shares(axes, ratios, solvers, 1, max(1.1 * max(finite), 2))
    axes.set(title="performance profile: within 1 %", ylabel="share of materials (%)",
             xlabel="time over that of the soonest solver")
    figure.suptitle(f"How soon near the best E: all solvers, {len(names)} materials, "
                    f"{_threads(threads)}", x=0.01, ha="left")
    return figure


def _median_figure(curves, rows, solvers, threads):
    """Medians over the materials of excess, loss of PSNR and mean log error, with quartiles."""
    from lab import plots
    names = {row["material"] for row in rows}
    curves = [row for row in curves if row["material"] in names and row["threads"] == threads]
    figure, panels = plots.plt.subplots(3, 1, figsize=(9, 12), sharex=True)
    columns = (("excess", "excess of E over the best (%)", 100),
               ("psnr_loss_db", "PSNR below that of the best fit (dB)", 1),
               ("log_error_ratio", "mean log error over that of the best fit", 1))
    last = 1.05 * max(row["seconds"] for row in rows if row.get("seconds"))
    by_time = tables.groups(curves, "solver", "seconds")
    for axes, (column, label, factor) in zip(panels, columns):
        for solver in solvers:
            points = []
            for (of, seconds), group in by_time.items():
                if of != solver:
                    continue
                values = [row[column] * factor for row in group if row[column] is not None]
                values += [math.inf] * (len(names) - len(values))  # not begun, or missing
                quartiles = stats.spread(values, .25)
                if math.isfinite(quartiles[1]):
                    points.append((seconds, *quartiles))
            if not points:
                continue
            seconds, low, middle, high = zip(*sorted(points))
            style = plots.solver_style(solver, solvers)
            axes.plot(seconds, middle, label=solver, **style)
            if solver in ("auto", "awls"):
                whole = [math.isfinite(value) for value in high]
                axes.fill_between(seconds, low, high, where=whole, color=style["color"],
                                  alpha=0.12, linewidth=0)
        axes.set(xscale="log", ylabel=label, xlim=(None, last))
        if column == "excess":
            axes.set_yscale("symlog", linthresh=0.1)
            axes.set_ylim(bottom=0)
        elif column == "log_error_ratio":
            axes.set_yscale("log")
        else:
            axes.set_yscale("symlog", linthresh=1)
        plots.plain_numbers(axes.yaxis)
        plots.plain_numbers(axes.xaxis)
        plots.label_ends(axes)
    panels[0].set_title(f"Error against time: median over {len(names)} materials, "
                        f"{_threads(threads)}; bands: quartiles of auto and awls")
    panels[-1].set_xlabel(f"{_clock(rows)}, reading and preparing included")
    return figure


def _material_figure(curves, rows, solvers, threads):
    """A small picture for each material: excess over time."""
    from lab import plots
    names = sorted({row["material"] for row in rows})
    last = 1.05 * max(row["seconds"] for row in rows if row.get("seconds"))
    columns = min(4, len(names))
    lines = math.ceil(len(names) / columns)
    figure, panels = plots.plt.subplots(lines, columns, figsize=(3 * columns + 1, 2.3 * lines + 1),
                                        sharex=True, sharey=True, squeeze=False)
    of_fit = tables.groups([row for row in curves if row["threads"] == threads],
                           "material", "solver")
    for axes, name in zip(panels.flat, names):
        for solver in solvers:
            points = of_fit.get((name, solver), [])
            axes.plot([row["seconds"] for row in points],
                      [max(100 * row["excess"], 0.01) for row in points], label=solver,
                      **{**plots.solver_style(solver, solvers), "linewidth": 1.3})
        axes.set_title(name, fontsize=9)
        axes.set(xscale="log", yscale="log", xlim=(None, last), ylim=(0.009, 1e3))
        plots.plain_numbers(axes.xaxis)
        plots.plain_numbers(axes.yaxis)
        axes.minorticks_off()
    for axes in panels.flat[len(names):]:
        axes.set_axis_off()
    figure.supxlabel(_clock(rows))
    figure.supylabel("excess of E over the best (%)")
    plots.legend_above(figure, panels.flat[0])
    return figure


def _start_figure(runs, threads):
    """Final excess from each start, a dot a material; the line is the median."""
    from lab import plots
    rows = [row for row in runs if row["threads"] == threads]
    others = {row["material"] for row in rows if row["start"] != DEFAULT_START}
    rows = [row for row in rows if row["material"] in others]
    starts = list(dict.fromkeys(row["start"] for row in rows))
    solvers = [s for s, of in tables.groups(rows, "solver").items()
               if {row["start"] for row in of} == set(starts)]
    if not solvers:
        return None
    figure, axes = plots.plt.subplots(figsize=(max(1.4 * len(solvers) + 2.5, 6.5), 5))
    for i, solver in enumerate(solvers):
        for j, start in enumerate(starts):
            values = [max(100 * row["excess"], 0.01) for row in rows
                      if row["solver"] == solver and row["start"] == start]
            x = i + 0.8 * ((j + 0.5) / len(starts) - 0.5)
            colour = plots.SERIES[j]
            axes.plot([x] * len(values), values, "o", color=colour, markersize=4, alpha=0.7,
                      label=start if i == 0 else "_")
            middle = stats.median(values)
            if math.isfinite(middle):
                axes.plot([x - 0.07, x + 0.07], [middle, middle], color=colour, linewidth=3)
    axes.set_xticks(range(len(solvers)), solvers, rotation=20)
    axes.set(yscale="log", ylabel="excess of E over the best (%), 0.01 or less at the bottom",
             title=f"Where each start leads ({len(others)} materials, a dot each; bar: median)")
    axes.grid(axis="x", visible=False)
    plots.plain_numbers(axes.yaxis)
    axes.legend(title="start", ncol=len(starts), loc="upper left", bbox_to_anchor=(0, -0.18))
    return figure


def _above(row):
    """The excess of a fit's E over the book of records; without a record, over the lowest E here."""
    return row["excess"] if row.get("over_record") is None else row["over_record"]


def _share(rows, target):
    """The share of fits that end within the target, with its interval by bootstrap over the materials."""
    ends = [_above(row) <= target for row in rows]
    low, high = stats.bootstrap(ends, numpy.mean)
    return f"{100 * numpy.mean(ends):.0f} % [{100 * low:.0f}, {100 * high:.0f}]"


def _paired_table(rows, solvers):
    """Each two solvers on the same materials: how often each ends lower by more than 0.1 %, and the sign test's p."""
    of = tables.groups(rows, "solver")
    return tables.paired({solver: {row["material"]: math.inf if row.get("objective") is None else row["objective"]
                                   for row in of[solver]} for solver in solvers}, TARGETS[-1])


def _summary(rows, solvers):
    """Two Markdown tables, a row a solver: what it reaches, and how soon."""
    of = tables.groups(rows, "solver")
    reached, times = [], []
    for solver in solvers:
        mine = of[solver]

        def column(name, factor=1, rows_of=mine):
            return tables.quartiles([None if row.get(name) is None else factor * row[name]
                                     for row in rows_of])
        above = [_above(row) for row in mine]
        missing, largest = sum(map(math.isinf, above)), max(above)
        reached.append([solver, tables.count(len(mine), missing),
                        *(_share(mine, target) for target in TARGETS),
                        tables.quartiles([100 * share for share in above]),
                        f"{100 * largest:.3g}" if math.isfinite(largest) else "–"])
        times.append([solver, *(column(f"seconds_to_{100 * target:g}_percent")
                                for target in TARGETS),
                      column("iterations"), column("trace_share", 100)])
    names = [f"{100 * target:g} %" for target in TARGETS]
    return (tables.markdown(["solver", "materials", *(f"ends within {name}" for name in names),
                             "above the record, %", "largest, %"], reached) + "\n"
            + tables.markdown(["solver", *(f"seconds to {name}" for name in names), "iterations",
                               "trace, % of solving"], times))


def _errors_table(curves, solvers, threads):
    """The convergence curve's other errors, soon and at the end: median over the materials, and the worst. A
    fit that is missing, or has no model yet, has infinite errors."""
    curves = [row for row in curves if row["threads"] == threads]
    names = {row["material"] for row in curves}
    times = sorted({row["seconds"] for row in curves})
    soon = min(times, key=lambda seconds: abs(seconds - SOON))
    of_fit = tables.groups(curves, "material", "solver")
    lines = []
    for solver in solvers:
        cells = []
        for end in (soon, times[-1]):
            last = [max((row for row in of_fit.get((name, solver), []) if row["seconds"] <= end),
                        key=lambda row: row["seconds"], default={}) for name in names]
            for column, digits in (("psnr_loss_db", 2), ("log_error_ratio", 3)):
                values = [math.inf if row.get(column) is None else row[column] for row in last]
                cells += [f"{round(value, digits) + 0.0:.{digits}f}"  # and not -0.00
                          for value in (stats.median(values), max(values))]
        lines.append([solver, *cells])
    return tables.markdown(
        ["solver", *(f"{what}, {when}{which}" for when in (f"{soon:.3g} s", "end")
                     for what in ("PSNR lost (dB)", "log error ratio")
                     for which in ("", ": worst"))], lines)


def _thread_table(runs):
    """Paired: time to 1 % with one thread over that with two, on the same material."""
    rows = [row for row in runs if row["start"] == DEFAULT_START]
    numbers = sorted({row["threads"] for row in rows})
    if len(numbers) < 2:
        return ""
    few, many = numbers[0], numbers[-1]
    at = {(row["material"], row["solver"], row["threads"]): row for row in rows}
    lines = []
    for solver in dict.fromkeys(row["solver"] for row in rows if row["threads"] == few):
        names = [m for m, s, t in at if s == solver and t == few and (m, s, many) in at]
        cells = []
        for target in TARGETS[:2]:
            column = f"seconds_to_{100 * target:g}_percent"
            pairs = [(at[m, solver, few][column], at[m, solver, many][column]) for m in names]
            ratios = [a / b for a, b in pairs if math.isfinite(a) and math.isfinite(b)]
            cells.append(f"{tables.quartiles(ratios)} (n = {len(ratios)})" if ratios else "–")
        lines.append([solver, str(len(names)), *cells])
    return tables.markdown(["solver", "materials",
                            *(f"time to {100 * t:g} %, {few} thread over {many}"
                              for t in TARGETS[:2])], lines)


def _repeat_table(runs):
    """The same fit made again: the longer time to 10 % over the shorter one."""
    times = {}
    for (name, solver, threads), of in tables.groups(
            [row for row in runs if row["start"] == DEFAULT_START],
            "material", "solver", "threads").items():
        of_fit = [row["seconds_to_10_percent"] for row in of]
        if len(of_fit) > 1 and all(map(math.isfinite, of_fit)):
            times.setdefault((solver, threads), []).append(max(of_fit) / min(of_fit))
    if not times:
        return ""
    return tables.markdown(["solver", "threads", "fits", "longest over shortest", "worst"],
                           [[solver, str(threads), str(len(ratios)), tables.quartiles(ratios),
                             f"{max(ratios):.3g}"]
                            for (solver, threads), ratios in times.items()])


def _halves(runs, solvers, threads):
    """Summaries for the materials on which `auto` was developed, and for the others."""
    from lab import materials
    text = ""
    for half, what in (("developing", "on which `auto` was developed"), ("reporting", "others")):
        rows = [row for row in runs if row["start"] == DEFAULT_START and row["threads"] == threads
                and row["solver"] in solvers
                and materials.Source(row["material"], "").half == half]
        count = len({row["material"] for row in rows})
        if count:
            text += f"\nMaterials {what} ({count}):\n\n{_summary(rows, solvers)}"
    return text


def draw(drawn, _):
    curves = drawn.get("curves")  # bulk, which published tables lack
    runs = [row for row in drawn["runs"] if row["repeat"] == 1]
    rows, solvers, threads = _complete(runs)
    everywhere = [row for row in runs if row["start"] == DEFAULT_START
                  and row["threads"] == threads]
    count = len({row["material"] for row in everywhere})
    widest = [s for s in solvers
              if sum(row["solver"] == s for row in everywhere) == count]
    names = len({row["material"] for row in rows})
    summary = (f"All solvers, {names} materials:\n\n{_summary(rows, solvers)}\n")
    if count > names:
        wide = [row for row in everywhere if row["solver"] in widest]
        summary += f"\nAll {count} materials:\n\n{_summary(wide, widest)}\n"
    products = {"summary.md": summary, "paired.md": _paired_table(rows, solvers), "halves.md": _halves(runs, widest, threads)}
    for name, table in (("threads.md", _thread_table(runs)),
                        ("repeats.md", _repeat_table(drawn["runs"]))):
        if table:  # empty where the manifest does not ask for it
            products[name] = table
    if curves:
        products["errors.md"] = _errors_table(curves, solvers, threads)
        products["median"] = _median_figure(curves, rows, solvers, threads)
        products["materials"] = _material_figure(curves, rows, solvers, threads)
    products["profiles"] = _profile_figure(rows, solvers, threads)
    if (figure := _start_figure(runs, threads)) is not None:
        products["starts"] = figure
    return products
