"""Smooth tables, and the lobes of two halves: see README.md beside this file."""
import itertools
import math

from lab import fits, lobes, stats, tables
from lab.fits import Fit

SAME = 0.9  # match score of the least alike lobe


def units(setting):
    """Every way fits every half."""
    manifest = setting.manifest
    planned = []
    for source, (way, own), half in itertools.product(
            setting.every(manifest["every"]), manifest["ways"].items(), manifest["halves"]):
        flags = {**manifest["flags"], **own, "corrupt": f"gaps:{manifest['gaps']:g}"}
        planned.append(fits.fit(setting, source, flags.pop("solver"), flags, seed=half,
                                threads=flags["threads"], way=way))
    return planned


def _holes(model):
    """Zeros of D between entries that are not."""
    count = 0
    for table in model.D:
        positive = [k for k, value in enumerate(table) if value > 0]
        if positive:
            count += positive[-1] - positive[0] + 1 - len(positive)
    return count


def _least_match(one, other):
    if one.lobes != other.lobes:
        return math.nan
    scores = lobes.scores(one, other)
    return float(min((scores[i][j] for i, j in enumerate(lobes.assign(scores))), default=1.0))


def tabulate(setting, results):
    """A row for each fit; its match is that with the fit of the first half."""
    clock = fits.clock(setting)
    rows, first = [], {}
    for result in results:
        if not result.folder:
            continue
        labels, fit = result.labels, Fit(result.folder, clock)
        model = lobes.Model.read(result.folder / "model.json")
        reference = first.setdefault((labels["material"], labels["way"]), model)
        rows.append({
            "material": labels["material"], "way": labels["way"], "half": labels["seed"],
            "match": _least_match(reference, model) if model is not reference else None,
            "relative_objective": fit.report["relative_objective"],
            "psnr_db": fit.report["appearance"]["psnr_db"],
            "holes": _holes(model),
            "seconds": fit.all})
    return {"fits": rows}


def _summary(rows):
    """A line a way; E against the lowest of any way on the same half."""
    lowest = {key: min(row["relative_objective"] for row in of)
              for key, of in tables.groups(rows, "material", "half").items()}
    lines = []
    for way, of in tables.groups(rows, "way").items():
        matches = [row["match"] for row in of if row["match"] is not None]
        excess = [100 * stats.excess(row["relative_objective"],
                                     lowest[row["material"], row["half"]]) for row in of]
        lines.append([way, f"{sum(match >= SAME for match in matches)} of {len(matches)}",
                      tables.quartiles(matches, ".2f"), tables.quartiles(excess, ".2f"),
                      f"{max(excess):.1f}", tables.quartiles([row["psnr_db"] for row in of], ".1f"),
                      f"{sum(row['holes'] > 0 for row in of)} of {len(of)}",
                      tables.quartiles([row["seconds"] for row in of], ".1f")])
    return tables.markdown(
        ["way", "same lobes", "match of the least alike", "E above the lowest, %", "most",
         "PSNR dB", "with holes in D", "processor seconds"], lines)


def _figure(rows):
    """Matches, a line a material, a colour a way."""
    from lab import plots
    halves = [row for row in rows if row["match"] is not None]
    ways = list(tables.groups(halves, "way"))
    of_first = {row["material"]: row["match"] for row in halves if row["way"] == ways[0]}
    materials = sorted(of_first, key=lambda name: of_first[name])
    figure, axes = plots.plt.subplots(figsize=(8, 1.2 + 0.28 * len(materials)))
    for way, colour in zip(ways, plots.SERIES):
        of = {row["material"]: row["match"] for row in halves if row["way"] == way}
        shift = 0.12 * (ways.index(way) - (len(ways) - 1) / 2)
        known = [(of[name], k + shift) for k, name in enumerate(materials) if name in of]
        axes.plot(*zip(*known), "o", color=colour, label=way, markersize=5)
    axes.axvline(SAME, color=plots.GREY, linewidth=1)
    axes.set(yticks=range(len(materials)), yticklabels=materials, xlim=(-0.02, 1.02),
             xlabel="match of the least alike lobe, between fits to two halves of the bins")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=2)
    return figure


def draw(drawn, _):
    rows = drawn["fits"]
    if not rows:
        return {}
    return {"summary.md": _summary(rows), "match": _figure(rows)}
