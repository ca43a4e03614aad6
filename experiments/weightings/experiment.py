"""Weightings: see README.md beside this file."""
import json
import math

import numpy

from lab import fits, stats, tables
from lab.fits import Fit
from lab.units import Product, Unit

ONE = ("solver", "threads", "start")  # of these the tables know one
# Errors that know no weights, and whether they are better when they are larger.
MEASURES = {"psnr_db": "PSNR (dB)", "mean_relative_error": "mean relative error",
            "mean_log_error": "mean log error"}


def units(setting):
    """Each fit, and its E under every other weighting."""
    fitted = fits.planned(setting)
    path_of = {source.name: source.path for source in setting.sources}
    weightings = list(dict.fromkeys(unit.labels["weighting"] for unit in fitted))
    scores = []
    for unit in fitted:
        for scored_by in weightings:
            if scored_by != unit.labels["weighting"]:
                material = unit.labels["material"]
                scores.append(Unit(
                    f"score/{material}/{unit.path.rsplit('/', 1)[-1]}-by-{scored_by}",
                    setting.program(), ("score", Product(unit, "model.json"), path_of[material],
                                        "--json", f"--weighting={scored_by}"),
                    labels={**unit.labels, "scored_by": scored_by}))
    return fitted + scores


def tabulate(_, results):
    rows = []
    for result in results:
        labels = result.labels
        row = {"material": labels["material"], "solver": labels["solver"],
               "fitted_by": labels["weighting"],
               "scored_by": labels.get("scored_by", labels["weighting"])}
        if not result.folder:
            rows.append({**row, "objective": math.inf})
            continue
        score = (json.loads((result.folder / "stdout.txt").read_text()) if "scored_by" in labels
                 else Fit(result.folder).report)
        rows.append({**row, "objective": score["objective"],
                     **{measure: score[measure] for measure in MEASURES}})
    best = {}
    for row in rows:
        key = row["material"], row["scored_by"]
        best[key] = min(best.get(key, math.inf), row["objective"])
    for row in rows:
        row["ratio"] = stats.ratio(row["objective"], best[row["material"], row["scored_by"]])
    return {"scores": sorted(rows, key=lambda row: (row["material"], row["solver"]))}


def _matrix(rows, weightings):
    """Geometric mean over the materials of E over the best E. [fitted_by][scored_by]"""
    groups = tables.groups(rows, "fitted_by", "scored_by")
    return numpy.array([[stats.geometric_mean([row["ratio"] for row in groups.get((f, s), [])])
                         for s in weightings] for f in weightings])


def _draw_matrix(axes, matrix, weightings, small=False):
    shown = numpy.log10(numpy.clip(matrix, 1, 1e3))
    # cividis: even in brightness, and the same for colour-blind eyes; dark is good.
    axes.imshow(shown, cmap="cividis", vmin=0, vmax=2)
    for i, row in enumerate(matrix):
        for j, value in enumerate(row):
            axes.text(j, i, f"{value:.2f}" if value < 9.995 else f"{value:.3g}", ha="center",
                      va="center", fontsize=6 if small else 10,
                      color="black" if shown[i, j] > 1 else "white")
    axes.grid(visible=False)
    size = {"fontsize": 6} if small else {}
    axes.set_xticks(range(len(weightings)), weightings, rotation=30 if small else 20, **size)
    axes.set_yticks(range(len(weightings)), weightings, **size)
    if not small:
        axes.set(xlabel="E by this weighting", ylabel="fitted by this weighting")


def draw(drawn, _):
    rows = drawn["scores"]
    weightings = list(dict.fromkeys(row["fitted_by"] for row in rows))
    by_material = tables.groups(rows, "material")
    from lab import plots
    matrix = _matrix(rows, weightings)
    mean, axes = plots.plt.subplots(figsize=(7, 5.6))
    _draw_matrix(axes, matrix, weightings)
    axes.set_title(f"E over the lowest E under the same weighting:\ngeometric mean over "
                   f"{len(by_material)} materials (1: best; dark is good)")

    columns = min(4, len(by_material))
    lines = math.ceil(len(by_material) / columns)
    each, panels = plots.plt.subplots(lines, columns, figsize=(2.6 * columns, 2.8 * lines + 0.6),
                                      squeeze=False)
    for panel, (name, of) in zip(panels.flat, by_material.items()):
        _draw_matrix(panel, _matrix(of, weightings), weightings, small=True)
        panel.set_title(name, fontsize=9)
    for panel in panels.flat[len(by_material):]:
        panel.set_axis_off()
    each.suptitle("E over the lowest E: rows are fitted by a weighting, columns scored by one",
                  fontsize=10)

    own = [row for row in rows if row["fitted_by"] == row["scored_by"]]
    lines = []
    for weighting in weightings:
        of = [row for row in own if row["fitted_by"] == weighting and "psnr_db" in row
              and row["psnr_db"] is not None]
        cells = []
        for measure in MEASURES:
            values = [row[measure] for row in of]
            cells.append(tables.quartiles(values, ".4g"))
        lines.append([weighting, str(len(of)), *cells])
    header = ["E over the best E", *weightings]
    body = [[name, *("missing" if math.isinf(value) else
                     f"**{value:.3g}**" if value == column.min() else f"{value:.3g}"
                     for value, column in zip(row, matrix.T))]
            for name, row in zip(weightings, matrix)]
    return {"mean": mean, "each": each, "matrix.md": tables.markdown(header, body),
            "measures.md": tables.markdown(["fitted by", "n", *MEASURES.values()], lines)}
