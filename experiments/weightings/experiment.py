"""Weightings: see README.md beside this file."""
import math

from lab import fits, stats, tables
from lab.fits import Fit

ONE = ("solver", "threads", "start")  # the tables know one of each
APART = 1.0  # dB: a difference that one may see
# Errors of the sphere and of the bins, with the values of a missing fit.
SPHERE = {"psnr_db": -math.inf, "mean_delta_e": math.inf, "mean_color_error": math.inf}
BINS = {"mean_log_error": math.inf, "mean_relative_error": math.inf}


def units(setting):
    return fits.planned(setting)


def _row(result, source):
    labels = result.labels
    row = {"material": source.name, "database": source.database, "half": source.half or "own",
           "weighting": labels["weighting"]}
    if not result.folder:
        return {**row, **SPHERE, **BINS}
    report = Fit(result.folder).report
    row.update({measure: report["appearance"][measure] for measure in SPHERE})
    if row["psnr_db"] is None:  # equal pictures
        row["psnr_db"] = math.inf
    return {**row, **{measure: report[measure] for measure in BINS},
            "iterations": report["iterations"], "seconds": sum(report["seconds"].values())}


def tabulate(setting, results):
    """fits: a row for each; weightings: what the manifest's own names stand for."""
    source_of = {source.name: source for source in setting.sources}
    rows = [_row(result, source_of[result.labels["material"]]) for result in results]
    own = setting.manifest.get("weightings", {})
    used = dict.fromkeys(row["weighting"] for row in rows)
    return {"fits": sorted(rows, key=lambda row: row["material"]),
            "weightings": [{"weighting": name, "flags": " ".join(fits.words(own[name]))
                            if name in own else f"--weighting={name}"} for name in used]}


# --- texts and pictures ---------------------------------------------------------------------------


def _measures_table(rows, weightings):
    """A line a weighting."""
    of_weighting = tables.groups(rows, "weighting")
    lines = []
    for weighting in weightings:
        of = of_weighting[weighting]
        lost = sum(not math.isfinite(row["mean_delta_e"]) for row in of)
        lines.append([weighting, tables.count(len(of), lost),
                      tables.quartiles([row["psnr_db"] for row in of], ".1f"),
                      f"{min(row['psnr_db'] for row in of):.1f}",
                      tables.quartiles([row["mean_delta_e"] for row in of], ".2f"),
                      tables.quartiles([100 * row["mean_color_error"] for row in of], ".2f"),
                      tables.quartiles([row["mean_log_error"] for row in of]),
                      tables.quartiles([100 * row["mean_relative_error"] for row in of])])
    return tables.markdown(["fitted by", "n", "PSNR dB", "least PSNR", "mean ΔE",
                            "mean colour off by, %", "mean log error at bins",
                            "mean relative error at bins, %"], lines)


def _pairs(rows, weighting, first):
    """[(its row, the row of the first)] of the materials that have both."""
    at = {(row["material"], row["weighting"]): row for row in rows}
    return [(row, at[name, first]) for (name, of), row in at.items()
            if of == weighting and (name, first) in at]


def _pairs_table(rows, weightings):
    """Every weighting against the first, material by material, on each half."""
    first, *others = weightings
    halves = {"all": rows, **dict(sorted(tables.groups(rows, "half").items()))}
    if len(halves) == 2:
        del halves["all"]
    lines = []
    for weighting in others:
        for half, part in halves.items():
            pairs = _pairs(part, weighting, first)
            if not pairs:
                continue
            more = [a["psnr_db"] - b["psnr_db"] for a, b in pairs
                    if math.isfinite(a["psnr_db"] - b["psnr_db"])]
            lines.append([weighting, half, str(len(pairs)), tables.quartiles(more, "+.2f"),
                          f"{min(more):+.1f} to {max(more):+.1f}" if more else "–",
                          str(sum(x > APART for x in more)), str(sum(x < -APART for x in more))])
    return tables.markdown(["fitted by", "half", "n", f"PSNR dB more than by {first}", "range",
                            f"more than {APART:g} dB above", f"more than {APART:g} dB below"],
                           lines)


def _databases_table(rows, weightings):
    databases = sorted(tables.groups(rows, "database"))
    of = tables.groups(rows, "weighting", "database")
    return tables.markdown(
        ["fitted by", *(f"{database}: PSNR dB" for database in databases),
         *(f"{database}: mean ΔE" for database in databases)],
        [[weighting, *(tables.quartiles([row[column] for row in of.get((weighting, database), [])],
                                        form)
                       for column, form in (("psnr_db", ".1f"), ("mean_delta_e", ".2f"))
                       for database in databases)] for weighting in weightings])


def _figure(rows, weightings):
    """A line a weighting: dots are materials, the bar is their median; halves apart."""
    from lab import plots
    figure, panels = plots.plt.subplots(1, 3, figsize=(14, 0.34 * len(weightings) + 1.6),
                                        sharey=True)
    of = tables.groups(rows, "weighting", "half")
    halves = sorted({row["half"] for row in rows})
    for axes, (column, factor, label, better) in zip(panels, (
            ("psnr_db", 1, "PSNR of the sphere (dB)", "more"),
            ("mean_delta_e", 1, "mean CIELAB difference", "less"),
            ("mean_color_error", 100, "mean colour off by (%)", "less"))):
        for k, half in enumerate(halves):
            colour = (plots.BLUE, plots.VERMILION, plots.GREEN)[k]
            for y, weighting in enumerate(reversed(weightings)):
                values = [factor * row[column] for row in of.get((weighting, half), [])
                          if math.isfinite(row[column])]
                at = y + 0.34 * ((len(halves) - 1) / 2 - k)
                axes.plot(values, [at] * len(values), "o", color=colour, markersize=3, alpha=0.45,
                          label=half if y == 0 else "_")
                if values:
                    axes.plot([stats.median(values)] * 2, [at - 0.17, at + 0.17], color=colour,
                              linewidth=3)
        axes.set_xlabel(f"{label}, {better} is better")
        if column != "psnr_db":
            axes.set_xscale("log")
            plots.plain_numbers(axes.xaxis)
    panels[0].set_yticks(range(len(weightings)), list(reversed(weightings)), fontsize=9)
    panels[0].set_ylim(-0.7, len(weightings) - 0.3)
    plots.legend_above(figure, panels[0])
    return figure


def draw(drawn, _):
    rows = drawn["fits"]
    weightings = [row["weighting"] for row in drawn["weightings"]]
    products = {
        "spheres": _figure(rows, weightings),
        "pairs.md": _pairs_table(rows, weightings),
        "databases.md": _databases_table(rows, weightings),
        "weightings.md": tables.markdown(["name", "flags of `trilobe fit`"], [
            [row["weighting"], f"`{row['flags']}`"] for row in drawn["weightings"]])}
    for half, part in tables.groups(rows, "half").items():
        products[f"{half}.md"] = _measures_table(
            part, [name for name in weightings if any(row["weighting"] == name for row in part)])
    return products
