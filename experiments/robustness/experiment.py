"""Robustness: see README.md beside this file."""
import itertools
import json
import math

import numpy
from lab import fits, lobes, stats, tables
from lab.fits import Fit
from lab.units import FOLDER, Product, Unit
from PIL import Image
from renderer import pictures

CLEAN = "clean"
LOST_DB = 3.0  # of the sphere: where a fit breaks down
SPHERES = 6  # a line
SAME_LOBE = 0.9  # congruence of the worst lobe with that of the clean fit
# What `info` says of a table, by words of its notes.
TOLD = {"cosine": "--cosine=", "saturation": "saturated", "levels": "few levels",
        "tilt": "is tilted", "shadow": "own light", "outliers": "dead readings"}


def _text(kind, strength):
    return f"{kind}:{strength:g}"


def _corruptions(setting, kinds=None):
    """All corruptions of the manifest, of these kinds, as flags; first none."""
    every = setting.manifest["corruptions"]
    return [CLEAN] + [_text(kind, strength) for kind in kinds or every if kind in every
                      for strength in every[kind]]


def _flags(corruption):
    return {} if corruption == CLEAN else {"corrupt": corruption}


def _sources(setting, of):
    """Those that a set of fits names, or all."""
    return [source for source in setting.sources if source.name in of.get("materials",
                                                                           [source.name])]


def _fitted(setting):
    """Fits to what was corrupted, and the score of each against what was not."""
    manifest = setting.manifest
    made = {}
    for of in manifest["sets"]:
        for source, solver, weighting, remedy, corruption in itertools.product(
                _sources(setting, of), of["solvers"], of.get("weightings", [fits.DEFAULT]),
                of["remedies"], _corruptions(setting, of.get("kinds"))):
            flags = {**manifest["flags"], **manifest["remedies"][remedy], **_flags(corruption)}
            unit = fits.fit(setting, source, solver, flags, weighting=weighting,
                            corruption=corruption, remedy=remedy, kind="fit")
            scored = Unit(
                f"robustness/{source.name}/{fits.file_name(corruption)}", setting.program(),
                ("score", Product(unit, "model.json"), source.path, "--json", "--threads=2",
                 *fits.words(setting.reading(source))),
                labels={**unit.labels, "kind": "score"})
            made.setdefault(unit.key, unit)
            made.setdefault(scored.key, scored)
    return list(made.values())


def _told(setting):
    return [Unit(f"info/{source.name}/{fits.file_name(corruption)}", setting.program(),
                 ("info", source.path, "--json", "--threads=1",
                  *fits.words({**setting.reading(source), **_flags(corruption)})),
                 labels={"material": source.name, "corruption": corruption, "kind": "info"})
            for corruption in _corruptions(setting)
            for source in setting.every(
                setting.manifest["told"]["clean_every" if corruption == CLEAN else "every"])]


def _drawn(setting, fitted):
    """Spheres of the fits of one material by the first set, each kind at its last strength."""
    strongest = [CLEAN, *(_text(kind, of[-1])
                          for kind, of in setting.manifest["corruptions"].items())]
    first = next(iter(setting.manifest["sets"]), None)
    return [Unit(f"sphere/{unit.labels['material']}/{fits.file_name(unit.labels['corruption'])}",
                 setting.program(), ("plot", Product(unit, "model.json"), f"--out={FOLDER}"),
                 product="spheres.png", labels={**unit.labels, "kind": "sphere"})
            for unit in fitted if unit.labels["kind"] == "fit"
            and unit.labels["material"] == setting.manifest["pictured"]
            and unit.labels["corruption"] in strongest
            and unit.labels["solver"] == first["solvers"][0]
            and unit.labels["remedy"] == first["remedies"][0]
            and unit.labels["weighting"] == fits.DEFAULT]


def units(setting):
    fitted = _fitted(setting)
    return fitted + _drawn(setting, fitted) + _told(setting)


def _spheres(results):
    """A page of them, a few a line; None where there is none."""
    shown = []
    for result in results:
        if result.labels["kind"] == "sphere" and result.folder:
            with Image.open(result.folder / "spheres.png") as image:
                shown.append((numpy.asarray(image.convert("RGB")) / 255.0,
                              result.labels["corruption"]))
    lines = [("", shown[k:k + SPHERES]) for k in range(0, len(shown), SPHERES)]
    return pictures.side_by_side(lines, width=150) if lines else None


def _key(labels):
    return tuple(labels[name] for name in ("material", "solver", "weighting", "remedy",
                                           "corruption"))


def _same_lobes(model, clean):
    """The congruence of the lobe that is least like its own in the clean fit; nan where they are
    not of the same number."""
    a, b = (lobes.Model.read(fit.folder / "model.json") for fit in (model, clean))
    if a.lobes != b.lobes or a.lobes == 0:
        return math.nan
    table = lobes.scores(a, b)
    return float(min(table[i][j] for i, j in enumerate(lobes.assign(table))))


def _rises(fit):
    """Iterations that raised E by more than rounding."""
    objectives = [row["objective"] for row in fit.trace]
    return sum(b > a * (1 + 1e-12) for a, b in zip(objectives, objectives[1:]))


def tabulate(setting, results):
    """fits: a row for each; told: what `info` says, a row for each."""
    done = [result for result in results if result.folder]
    fitted = {_key(result.labels): Fit(result.folder)
              for result in done if result.labels["kind"] == "fit"}
    rows, told = [], []
    for result in done:
        labels = result.labels
        said = (json.loads((result.folder / "stdout.txt").read_text())
                if labels["kind"] in ("info", "score") else None)
        if labels["kind"] == "info":
            notes = " ".join(said["notes"])
            told.append({"material": labels["material"], "corruption": labels["corruption"],
                         **{name: int(words in notes) for name, words in TOLD.items()}})
        if labels["kind"] != "score":
            continue
        key = _key(labels)
        fit, clean = fitted[key], fitted.get((*key[:4], CLEAN))
        psnr = said["verdict"]["psnr_db"]
        rows.append({**{name: labels[name] for name in ("material", "solver", "weighting",
                                                         "remedy", "corruption")},
                     "psnr_db": math.inf if psnr is None else psnr,
                     "mean_delta_e": said["verdict"]["mean_delta_e"],
                     "mean_log_error": said["mean_log_error"],
                     "relative_objective": said["relative_objective"],
                     "worst_lobe": _same_lobes(fit, clean) if clean else math.nan,
                     "iterations": fit.report["iterations"],
                     "rises": _rises(fit),
                     "seconds": sum(fit.report["seconds"].values())})
    missing = [result.labels for result in results
               if not result.folder and result.labels["kind"] == "fit"]
    page = _spheres(done)
    return {**({"fitted.jpg": page} if page else {}),
            "fits": sorted(rows, key=lambda row: row["material"]),
            "told": sorted(told, key=lambda row: row["material"]),
            "failed": [{name: labels[name] for name in ("material", "solver", "weighting", "remedy",
                                                        "corruption")} for labels in missing]}


# --- texts and pictures ---------------------------------------------------------------------------


def _lost(rows):
    """The same rows with `lost_db`, the sphere's loss against the clean fit of the same kind."""
    names = ("material", "solver", "weighting", "remedy")
    clean = {tuple(row[name] for name in names): row["psnr_db"] for row in rows
             if row["corruption"] == CLEAN}
    return [{**row, "lost_db": clean[at] - row["psnr_db"]} for row in rows
            if (at := tuple(row[name] for name in names)) in clean]


def _kind(corruption):
    return corruption.partition(":")[0]


def _by_corruption(rows):
    """What the default loses, a line a corruption."""
    lines = []
    own = [row for row in rows if (row["solver"], row["remedy"], row["weighting"])
           == (rows[0]["solver"], "default", fits.DEFAULT)]
    for corruption, of in tables.groups(own, "corruption").items():
        lost = [row["lost_db"] for row in of]
        lines.append([corruption, str(len(of)),
                      tables.quartiles([row["psnr_db"] for row in of], ".1f"),
                      f"{stats.median(lost):.1f}", f"{max(lost):.1f}",
                      tables.quartiles([row["mean_delta_e"] for row in of], ".2f"),
                      tables.quartiles([row["worst_lobe"] for row in of], ".2f")])
    return tables.markdown(["corruption", "n", "PSNR dB", "lost dB, median", "most",
                            "mean ΔE", "likeness of the worst lobe"], lines)


def _by_remedy(rows):
    """dB that are lost, median over the materials: a line a corruption, a column a way to fit."""
    ways = list(dict.fromkeys((row["solver"], row["weighting"], row["remedy"]) for row in rows))
    lost = {key: stats.median([row["lost_db"] for row in of]) for key, of in tables.groups(
        rows, "corruption", "solver", "weighting", "remedy").items()}
    corruptions = [corruption for corruption in tables.groups(rows, "corruption")
                   if corruption != CLEAN and sum((corruption, *way) in lost for way in ways) > 1]
    return tables.markdown(
        ["corruption", *(" ".join(part for part in way if part != fits.DEFAULT) for way in ways)],
        [[corruption, *(f"{lost[(corruption, *way)]:.1f}" if (corruption, *way) in lost else ""
                        for way in ways)] for corruption in corruptions])


def _breakdowns(rows):
    """A line a kind: the weakest strength of the manifest at which a fit breaks down."""
    lines = []
    for (kind, solver, weighting, remedy), of in tables.groups(
            [{**row, "kind": _kind(row["corruption"])} for row in rows
             if row["corruption"] != CLEAN], "kind", "solver", "weighting", "remedy").items():
        strengths = tables.groups(of, "corruption")
        dark = next((text for text, part in strengths.items() if
                     stats.median([row["lost_db"] for row in part]) > LOST_DB), "–")
        other = next((text for text, part in strengths.items() if
                      stats.median([row["worst_lobe"] for row in part]) < SAME_LOBE), "–")
        lines.append([kind, solver, weighting, remedy, dark, other])
    return tables.markdown(["kind", "solver", "weighting", "remedy", f"{LOST_DB:g} dB lost",
                            f"a lobe is less than {SAME_LOBE:g} like its own"], lines)


def _told_table(rows):
    """A line a corruption: on how many materials each symptom is told."""
    lines = []
    for corruption, of in tables.groups(rows, "corruption").items():
        counts = [sum(row[name] for row in of) for name in TOLD]
        if corruption == CLEAN or any(counts):
            lines.append([corruption, str(len(of)), *(str(count or "") for count in counts)])
    return tables.markdown(["corruption", "materials", *TOLD], lines)


def _figure(rows):
    """A panel a kind: dots are materials, the line their median."""
    from lab import plots
    first = (rows[0]["solver"], "default", fits.DEFAULT)
    own = [row for row in rows
           if (row["solver"], row["remedy"], row["weighting"]) == first]
    by_kind = tables.groups([{**row, "kind": _kind(row["corruption"])} for row in own
                             if row["corruption"] != CLEAN], "kind")
    columns = min(6, len(by_kind))
    lines = math.ceil(len(by_kind) / columns)
    figure, axes = plots.plt.subplots(lines, columns, figsize=(2.3 * columns, 2.0 * lines),
                                      sharey=True, squeeze=False)
    for panel in axes.flat[len(by_kind):]:
        panel.set_axis_off()
    for panel, (kind, of) in zip(axes.flat, by_kind.items()):
        strengths = tables.groups(of, "corruption")
        for x, part in enumerate(strengths.values()):
            panel.plot([x] * len(part), [row["lost_db"] for row in part], "o", color=plots.BLUE,
                       alpha=0.5, markersize=4)
        panel.plot(range(len(strengths)), [stats.median([row["lost_db"] for row in part])
                                           for part in strengths.values()], color=plots.BLUE)
        panel.axhline(LOST_DB, color=plots.VERMILION, linewidth=1)
        panel.set_xticks(range(len(strengths)),
                         [text.partition(":")[2] for text in strengths], fontsize=8)
        panel.set_xlim(-0.4, len(strengths) - 0.6)
        panel.set_title(kind)
    axes[0][0].set_ylim(-2, 30)
    axes[0][0].invert_yaxis()
    for panel in axes[:, 0]:
        panel.set_ylabel("lost (dB)")
    return figure


def draw(drawn, _):
    told = {"told.md": _told_table(drawn["told"])}
    if not drawn["fits"]:
        return told
    rows = _lost(drawn["fits"])
    return {**told, "spheres": _figure(rows), "corruptions.md": _by_corruption(rows),
            "remedies.md": _by_remedy(rows), "breakdowns.md": _breakdowns(rows)}
