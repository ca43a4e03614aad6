"""Minima that are known: see README.md beside this file."""
import json
import math

from lab import fits, lobes, stats, tables
from lab.fits import Fit
from lab.units import FOLDER, Product, Unit

MODEL, TABLE = "model.json", "table.binary"
FOUND = 1e-6  # E over a black model's: 60 dB of the weighted error
NEAR = 1e-3
SAME = 0.99  # match score of the worst lobe
# E of the answer itself, where the spline of G is nowhere below 0; else the table, in which that is 0, is no exact one.
EXACT = 1e-20


def units(setting):
    """A model of each source, the table that it has, and fits to that table."""
    manifest = setting.manifest
    made = []
    for source in setting.every(manifest["every"]):
        reading = {"missing": manifest["missing"], **setting.reading(source)}
        known = Unit(f"known/{source.name}/model", setting.program(),
                     ("fit", source.path, f"--out={FOLDER}", "--noplots", "--raw", "--nodiagnose", "--threads=1",
                      *fits.words({**manifest["known"], **reading})), MODEL,
                     labels={"material": source.name, "run": "model"})
        table = Unit(f"known/{source.name}/table", setting.program(),
                     ("convert", Product(known, MODEL), f"--out={FOLDER}/{TABLE}"), TABLE,
                     labels={"material": source.name, "run": "table"})
        made += [known, table,
                 Unit(f"known/{source.name}/truth", setting.program(),
                      ("score", Product(known, MODEL), Product(table, TABLE), "--json", "--threads=1",
                       f"--missing={manifest['missing']}"),
                      labels={"material": source.name, "run": "truth"})]
        for solver, own in manifest["solvers"].items():
            for start, seed in manifest["starts"]:
                flags = {"missing": manifest["missing"], "solver": solver, "init": start, "seed": seed,
                         **manifest["flags"], **own}
                made.append(Unit(f"known/{source.name}/{solver}-{start}-{seed}", setting.program(),
                                 ("fit", Product(table, TABLE), f"--out={FOLDER}", "--noplots", *fits.words(flags)),
                                 "report.json",
                                 labels={"material": source.name, "run": "fit", "solver": solver, "start": start,
                                         "seed": seed}))
    return made


def _read(folder):
    return json.loads((folder / MODEL).read_text())


def tabulate(setting, results):
    known = {result.labels["material"]: result.folder for result in results
             if result.labels["run"] == "model" and result.folder}
    truths = {result.labels["material"]: json.loads((result.folder / "stdout.txt").read_text())["relative_objective"]
              for result in results if result.labels["run"] == "truth" and result.folder}
    rows = []
    for result in results:
        if result.labels["run"] != "fit":
            continue
        labels = {key: result.labels[key] for key in ("material", "solver", "start", "seed")}
        if not result.folder:
            rows.append({**labels, "relative_objective": math.inf})
            continue
        fit = Fit(result.folder, fits.clock(setting))
        truth = _read(known[labels["material"]])
        match = lobes.scores(lobes.Model(truth), lobes.Model(_read(result.folder)))
        rows.append({**labels, "E_of_truth": truths.get(labels["material"]), "zeros_in_G": sum(value == 0 for table in truth["G"] for value in table),
                     "relative_objective": fit.report["relative_objective"],
                     "worst_match": min(match[m][n] for m, n in enumerate(lobes.assign(match))),
                     "seconds": fit.solved - fit.before, "iterations": fit.report["iterations"],
                     "stop_reason": fit.report["stop_reason"]})
    return {"fits": rows}


def _text(value):
    return f"{value:.2g}" if math.isfinite(value) else "–"


def draw(drawn, _):
    from lab import plots
    rows = [row for row in drawn["fits"] if (row.get("E_of_truth") or 0) < EXACT]
    lines = []
    for (solver, start), of in tables.groups(rows, "solver", "start").items():
        ends = [row["relative_objective"] for row in of]
        found = [row for row in of if row["relative_objective"] <= FOUND]
        lines.append([solver, start, str(len(of)), str(len(found)), str(sum(end <= NEAR for end in ends)),
                      str(sum(row["worst_match"] >= SAME for row in found)),
                      _text(stats.median(ends)), _text(max(ends)),
                      _text(stats.median([row.get("seconds") or math.inf for row in of]))])
    figure, axes = plots.plt.subplots()
    solvers = list(tables.groups(rows, "solver"))
    for solver in solvers:
        ends = sorted(max(row["relative_objective"], 1e-16) for row in rows if row["solver"] == solver)
        axes.step(ends, [(k + 1) / len(ends) for k in range(len(ends))], where="post", label=solver,
                  **plots.solver_style(solver, solvers))
    axes.axvline(FOUND, color=plots.GREY, linewidth=0.8)
    axes.set(xscale="log", xlim=(1e-16, 1), ylim=(0, 1.02), xlabel="E at the end over E of a black model; it could be 0",
             ylabel="share of fits that end there or lower")
    axes.legend(loc="center left", bbox_to_anchor=(0.2, 0.35))
    return {"ends": figure, "summary.md": tables.markdown(
        ["solver", "start", "fits", f"E found to {FOUND:g}", f"to {NEAR:g}", "of those found: the same lobes",
         "E over a black model's, median", "largest", "seconds, median"], lines)}
