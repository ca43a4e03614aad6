"""Sweeps of AWLS: see README.md beside this file."""
import json
import math

import numpy

from lab import fits, stats, tables
from lab.fits import Fit
from lab.units import Unit


def units(setting):
    look, smooth = setting.manifest["element_by_element"], setting.manifest["filter"]
    program = setting.program("monotone")
    elements = [
        Unit(f"monotone/{source.name}/{solver}-{weighting}", program,
             (f"--solver={solver}", f"--stride={look['stride']}", f"--sweeps={look['sweeps']}",
              f"--weighting={weighting}", *fits.words(setting.reading(source)), source.path),
             labels={"material": source.name, "solver": solver, "weighting": weighting, "run": "elements"})
        for source in setting.every(look["every"]) for solver in look["solvers"] for weighting in look["weightings"]]
    return elements + [
        fits.fit(setting, source, "awls", {**setting.manifest["flags"], "g_filter": width}, threads=1,
                 weighting=weighting, run="filter")
        for source in setting.sources if source.database == "own" or source.name in smooth["materials"]
        for weighting in smooth["weightings"] for width in smooth["degrees"]]


# --- tables ---------------------------------------------------------------------------------------


def _roughness(fit):
    """Root mean square second difference of the G tables, each over its mean; of whole ones."""
    model = json.loads((fit.folder / "model.json").read_text())
    unobserved = model.get("unobserved", {}).get("G", [[]] * len(model["G"]))
    values = [numpy.diff(numpy.array(table) / numpy.mean(table), 2) ** 2
              for table, entries in zip(model["G"], unobserved) if not entries and any(table)]
    return math.sqrt(numpy.mean(values)) if values else math.nan


def _filter_row(result, fit):
    rises = [stats.ratio(after["objective"], before["objective"]) - 1 for before, after in zip(fit.trace, fit.trace[1:])
             if after["objective"] > before["objective"]]
    return {"material": result.labels["material"], "weighting": result.labels["weighting"],
            "filter_deg": fit.report["options"]["given"]["g_filter_sigma"],
            "sweeps": fit.report["iterations"], "best_sweep": fit.report["best_iteration"],
            "sweeps_that_raised_E": len(rises), "worst_rise": max(rises, default=0.0),
            # Lowest E of the sweeps: the report's E is that after entries at the edge of the data are tied.
            "objective": min(row["objective"] for row in fit.trace),
            "highest_objective": max(row["objective"] for row in fit.trace[1:]),
            "last_objective": fit.trace[-1]["objective"],
            "psnr_db": fit.report["psnr_db"], "sphere_psnr_db": fit.report["appearance"]["psnr_db"],
            "G_roughness": _roughness(fit)}


def tabulate(_, results):
    there = tables.groups([{"run": result.labels["run"], "result": result} for result in results if result.folder],
                          "run")
    of_run = {run: [row["result"] for row in rows] for run, rows in there.items()}
    return {"elements": [{"material": result.labels["material"], "weighting": result.labels["weighting"],
                          **json.loads((result.folder / "stdout.txt").read_text())}
                         for result in of_run.get("elements", [])],
            "filter": [_filter_row(result, Fit(result.folder)) for result in of_run.get("filter", [])],
            "missing": [{**{key: result.labels[key] for key in ("material", "solver", "weighting", "run")},
                         "unit": result.unit.path} for result in results if not result.folder]}


# --- pictures -------------------------------------------------------------------------------------


def _elements_table(rows, missing):
    lines = []
    for (solver, weighting), (of, lost) in tables.with_missing(
            rows, [row for row in missing if row["run"] == "elements"], "solver", "weighting").items():
        worst = max(of, key=lambda row: row["worst_relative_rise"], default=None)
        count = {key: sum(row[key] for row in of) for key in ("updates", "raised", "cubics", "of_one_root")}
        lines.append([solver, weighting, tables.count(len(of) + lost, lost), f"{count['updates']:,}",
                      f"{count['raised']:,}", f"**{worst['worst_relative_rise']:.2g}**" if worst else "–",
                      f"{count['cubics']:,}",
                      f"{100 * count['of_one_root'] / count['cubics']:.1f}" if count["cubics"] else "–"])
    return tables.markdown(["solver", "weighting", "materials", "updates", "that raised E at all", "worst relative rise",
                            "cubics", "of one real root, %"], lines)


def _pairs(rows):
    """[(fit without the filter, fit with it)]"""
    plain = {(row["material"], row["weighting"]): row for row in rows if row["filter_deg"] == 0}
    return [(plain[key], row) for row in rows
            if row["filter_deg"] > 0 and (key := (row["material"], row["weighting"])) in plain]


def _filter_table(rows):
    lines = []
    for plain, row in sorted(_pairs(rows), key=lambda pair: (pair[0]["weighting"], pair[0]["material"])):
        lines.append([row["weighting"], row["material"], f"{plain['objective']:.4g}",
                      f"{stats.ratio(row['objective'], plain['objective']):.3g}",
                      f"{row['sweeps_that_raised_E']} of {row['sweeps']}",
                      f"{100 * row['worst_rise']:.3g}" if row["worst_rise"] else "–",
                      f"{plain['sphere_psnr_db']:.1f}", f"{row['sphere_psnr_db']:.1f}",
                      f"{row['G_roughness'] / plain['G_roughness']:.2f}"])
    return tables.markdown(["weighting", "material", "E without", "E over that", "sweeps that raised E", "worst rise, %",
                            "sphere without, dB", "with, dB", "roughness of G over that without"], lines)


def _filter_figure(rows):
    """Draws the filter's cost in E and gain in smoothness: a line a material, a dot a weighting."""
    from lab import plots
    pairs = _pairs(rows)
    weightings = list(dict.fromkeys(row["weighting"] for row in rows))
    names = sorted({plain["material"] for plain, _ in pairs}, reverse=True)
    figure, panels = plots.plt.subplots(1, 3, figsize=(13, 0.4 * len(names) + 1.8), sharey=True)
    for axes, column, label in ((panels[0], "objective", "lowest E, over that without"),
                                (panels[1], "sphere_psnr_db", "PSNR of the sphere, dB more than without"),
                                (panels[2], "G_roughness", "roughness of G, over that without")):
        for weighting, colour in zip(weightings, (plots.BLUE, plots.VERMILION)):
            of = [(names.index(row["material"]), plain[column], row[column]) for plain, row in pairs
                  if row["weighting"] == weighting]
            axes.plot([with_it - without if column.endswith("_db") else with_it / without for _, without, with_it in of],
                      [place for place, _, _ in of], "o", color=colour, label=weighting)
        axes.axvline(0 if column.endswith("_db") else 1, color=plots.GREY, linewidth=1)
        axes.set_title(label)
        if not column.endswith("_db"):
            axes.set_xscale("log")
            plots.plain_numbers(axes.xaxis)
    panels[0].set_yticks(range(len(names)), names)
    plots.legend_above(figure, panels[0])
    return figure


def draw(drawn, _):
    products = {}
    if drawn["elements"]:
        products["elements.md"] = _elements_table(drawn["elements"], drawn["missing"])
    if drawn["filter"]:
        products["filter.md"] = _filter_table(drawn["filter"])
        products["filter"] = _filter_figure(drawn["filter"])
    return products
