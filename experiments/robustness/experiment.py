"""Robustness: see README.md beside this file."""
import itertools
import json
import math

import numpy
from lab import corruptions, fits, lobes, stats, tables
from lab.corruptions import CLEAN, kind_of, strength_of
from lab.fits import Fit
from lab.materials import Source
from lab.units import FOLDER, Product, Unit
from PIL import Image
from renderer import pictures

LOST_DB = 3.0  # loss on the sphere at which a fit breaks down
SPHERES, WIDTH = 8, 130  # a line; pixels
SAME_LOBE = 0.9  # congruence of the worst lobe with that of the clean fit
THREADS = 1
WAY = ("solver", "weighting", "remedy")  # how a fit is made
KEY = ("material", *WAY, "corruption")
KNOWN = "model-of-"
KNOWN_BY = ("auto", fits.DEFAULT, "default")  # solver, weighting, remedy


def _corruptions(setting, kinds=None):
    """kinds: {kind: [strength]}; else all of the manifest."""
    return corruptions.of_kinds(setting.manifest["corruptions"] if kinds is None else kinds)


def _fit(setting, source, solver, weighting, remedy, corruption):
    flags = {**setting.manifest["flags"], **setting.manifest["remedies"][remedy],
             **corruptions.flags(corruption)}
    return fits.fit(setting, source, solver, flags, weighting=weighting, threads=THREADS,
                    corruption=corruption, remedy=remedy, kind="fit")


def _known(setting):
    """A source whose model is known: the table of a clean fit of each material of "known"."""
    sources = []
    for source in setting.sources:
        if source.name in setting.manifest["known"]:
            table = Unit(f"known/{source.name}", setting.program(),
                         ("convert", Product(_fit(setting, source, *KNOWN_BY, CLEAN), "model.json"),
                          f"--out={FOLDER}/table.binary"), product="table.binary")
            sources.append(Source(KNOWN + source.name, Product(table, "table.binary")))
    return sources


def _sources(setting, of):
    """The sources that a set of fits names, or every n-th of the lists, or all."""
    known = _known(setting)
    given = setting.every(of["every"]) if "every" in of else setting.sources
    return [source for source in given + known
            if source.name in of.get("materials", [source.name])]


def _fitted(setting):
    """Fits to what was corrupted, and the score of each against what was not."""
    made = {}
    for of in setting.manifest["sets"]:
        for source, solver, weighting, remedy, corruption in itertools.product(
                _sources(setting, of), of["solvers"], of.get("weightings", [fits.DEFAULT]),
                of["remedies"], _corruptions(setting, of.get("kinds"))):
            unit = _fit(setting, source, solver, weighting, remedy, corruption)
            scored = Unit(
                f"robustness/{source.name}/{fits.file_name(corruption)}", setting.program(),
                ("score", Product(unit, "model.json"), source.path, "--json",
                 f"--threads={THREADS}", *fits.words(setting.reading(source))),
                labels={**unit.labels, "kind": "score"})
            made.setdefault(unit.key, unit)
            made.setdefault(scored.key, scored)
    return list(made.values())


def _drawn(setting, fitted):
    """Spheres of the fits of some materials by the first set's solver and remedy."""
    first = setting.manifest["sets"][0]
    return [Unit(f"sphere/{unit.labels['material']}/{fits.file_name(unit.labels['corruption'])}",
                 setting.program(), ("plot", Product(unit, "model.json"), f"--out={FOLDER}",
                                     f"--threads={THREADS}"),
                 product="spheres.png", labels={**unit.labels, "kind": "sphere"})
            for unit in fitted if unit.labels["kind"] == "fit"
            and unit.labels["material"] in setting.manifest["pictured"]
            and unit.labels["corruption"] in _corruptions(setting, first["kinds"])
            and unit.labels["solver"] == first["solvers"][0]
            and unit.labels["remedy"] == first["remedies"][0]
            and unit.labels["weighting"] == fits.DEFAULT]


def units(setting):
    fitted = _fitted(setting)
    return fitted + _drawn(setting, fitted)


def _spheres(results):
    """A page of them, a few a line; None where there is none."""
    lines = []
    drawn = [{**result.labels, "folder": result.folder} for result in results
             if result.labels["kind"] == "sphere" and result.folder]
    for of in tables.groups(drawn, "material").values():
        shown = []
        for row in of:
            with Image.open(row["folder"] / "spheres.png") as image:
                shown.append((numpy.asarray(image.convert("RGB")) / 255.0, row["corruption"]))
        lines += [(of[0]["material"] if k == 0 else "", shown[k:k + SPHERES])
                  for k in range(0, len(shown), SPHERES)]
    return pictures.side_by_side(lines, width=WIDTH) if lines else None


def _key(labels):
    return tuple(labels[name] for name in KEY)


def _same_lobes(model, clean):
    """The congruence of the lobe that is least like its own in the clean fit; nan where their
    number, or that of their nodes, differs."""
    a, b = (lobes.Model.read(fit.folder / "model.json") for fit in (model, clean))
    if a.lobes == 0 or (a.D.shape, a.G.shape) != (b.D.shape, b.G.shape):
        return math.nan
    table = lobes.scores(a, b)
    return float(min(table[i][j] for i, j in enumerate(lobes.assign(table))))


def _albedo_error(score):
    """Mean error over theta_i of the share of light that is reflected; nan where no appearance was compared."""
    appearance = score.get("appearance") or {}
    return (appearance.get("albedo") or {}).get("mean_error", math.nan)


def _rises(fit):
    """Iterations that raised what is minimised by more than rounding."""
    name = "objective_with_prior" if "objective_with_prior" in fit.trace[0] else "objective"
    objectives = [row[name] for row in fit.trace]
    return sum(b > a * (1 + 1e-12) for a, b in zip(objectives, objectives[1:]))


def _own_clean(fitted, key):
    """The fit whose lobes those of another should be."""
    material, *way = key[:4]
    if material.startswith(KNOWN):
        return fitted.get((material.removeprefix(KNOWN), *KNOWN_BY, CLEAN))
    return fitted.get((material, *way, CLEAN))


def _looks(score):
    """PSNR and Delta E of the sphere, or of the samples; of an anisotropic material against its formula."""
    formula = (score.get("appearance") or {}).get("from_formula")
    return formula["fitted"] if formula else score["verdict"]


def tabulate(setting, results):
    """fits: a row for each; failed: those that there are none of."""
    done = [result for result in results if result.folder]
    fitted = {_key(result.labels): Fit(result.folder)
              for result in done if result.labels["kind"] == "fit"}
    rows = []
    for result in done:
        if result.labels["kind"] != "score":
            continue
        said = json.loads((result.folder / "stdout.txt").read_text())
        key = _key(result.labels)
        fit, clean = fitted[key], _own_clean(fitted, key)
        looks = _looks(said)
        psnr = looks["psnr_db"]
        rows.append({**dict(zip(KEY, key)),
                     "psnr_db": math.inf if psnr is None else psnr,
                     "mean_delta_e": looks["mean_delta_e"],
                     "mean_log_error": said["mean_log_error"],
                     "albedo_error": _albedo_error(said),
                     "relative_objective": said["relative_objective"],
                     "worst_lobe": _same_lobes(fit, clean) if clean else math.nan,
                     "iterations": fit.report["iterations"],
                     "rises": _rises(fit),
                     "seconds": sum(fit.report["seconds"].values())})
    page = _spheres(done)
    return {**({"fitted.jpg": page} if page else {}),
            "fits": sorted(rows, key=lambda row: row["material"]),
            "failed": [dict(zip(KEY, _key(result.labels))) for result in results
                       if not result.folder and result.labels["kind"] == "fit"]}


# --- texts and pictures ---------------------------------------------------------------------------


def _lost(rows):
    """The same rows with `lost_db`, the sphere's loss against the clean fit of the same kind."""
    clean = {tuple(row[name] for name in KEY[:-1]): row["psnr_db"] for row in rows
             if row["corruption"] == CLEAN}
    return [{**row, "lost_db": clean[at] - row["psnr_db"]} for row in rows
            if (at := tuple(row[name] for name in KEY[:-1])) in clean]


def _by_default(rows):
    return [row for row in rows if tuple(row[name] for name in WAY) == KNOWN_BY]


def _by_corruption(rows):
    """Losses of the default, a line a corruption, a column a material."""
    materials = list(tables.groups(rows, "material"))
    lines = []
    for corruption, of in tables.groups(rows, "corruption").items():
        lost = {row["material"]: row["lost_db"] for row in of}
        shown = ({row["material"]: row["psnr_db"] for row in of} if corruption == CLEAN else lost)
        lines.append([corruption, f"{stats.median(list(lost.values())):.1f}",
                      f"{max(lost.values()):.1f}",
                      *(f"{shown[name]:.1f}" if name in shown else "" for name in materials)])
    return tables.markdown(["corruption", "lost dB, median", "most", *materials], lines)


# Columns of `errors.md` for each fit: heading, member of a row, digits.
ERRORS = (("lost dB", "lost_db", ".1f"), ("Delta E", "mean_delta_e", ".2f"),
          ("mean log error", "mean_log_error", ".4f"), ("albedo off by", "albedo_error", ".4f"),
          ("worst lobe", "worst_lobe", ".2f"), ("iterations", "iterations", ".0f"),
          ("seconds", "seconds", ".0f"))


def _errors(rows):
    """The table of the default, a line a corruption: errors against the clean table, and what a fit took; medians over
    the materials, those of an earlier run having no albedo."""
    lines = []
    for corruption, of in tables.groups(rows, "corruption").items():
        known = [[row[name] for row in of if not math.isnan(row.get(name, math.nan))]
                 for _, name, _ in ERRORS]
        lines.append([corruption, str(len(of)), *(format(stats.median(values), digits) if values else ""
                                                  for values, (_, _, digits) in zip(known, ERRORS))])
    shown = [k for k in range(len(lines[0])) if k < 2 or any(line[k] for line in lines)]
    headings = ["corruption", "materials", *(heading for heading, _, _ in ERRORS)]
    return tables.markdown([headings[k] for k in shown], [[line[k] for k in shown] for line in lines])


def _by_way(rows, of):
    """dB that are lost by each solver, weighting or remedy, the others as by default, against the
    clean fit by default: a line a corruption and material; empty where there is but one."""
    others = [(name, value) for name, value in zip(WAY, KNOWN_BY) if name != of]
    rows = [row for row in rows if all(row[name] == value for name, value in others)]
    ways = list(tables.groups(rows, of))
    clean = {row["material"]: row["psnr_db"] for row in _by_default(rows)
             if row["corruption"] == CLEAN}
    lost = {(row["corruption"], row["material"], row[of]): clean[row["material"]] - row["psnr_db"]
            for row in rows if row["material"] in clean}
    lines = [[corruption, material, *(f"{lost[(corruption, material, way)]:.1f}"
                                      if (corruption, material, way) in lost else ""
                                      for way in ways)]
             for corruption, material in tables.groups(rows, "corruption", "material")
             if sum((corruption, material, way) in lost for way in ways) > 1]
    return tables.markdown(["corruption", "material", *ways], lines) if lines else ""


def _breakdowns(rows):
    """A line a kind and way: the weakest strength at which a fit breaks down, by the median over
    the materials."""
    lines = []
    for (kind, *way), of in tables.groups(
            [{**row, "kind": kind_of(row["corruption"])} for row in rows
             if row["corruption"] != CLEAN], "kind", *WAY).items():
        strengths = tables.groups(of, "corruption")
        weakest = [next((strength_of(text) for text, part in strengths.items() if breaks(part)), "–")
                   for breaks in (
                       lambda part: stats.median([row["lost_db"] for row in part]) > LOST_DB,
                       lambda part: stats.median([row["worst_lobe"] for row in part]) < SAME_LOBE)]
        lines.append([kind, *way, ", ".join(strength_of(text) for text in strengths), *weakest])
    return tables.markdown(["kind", *WAY, "tried", f"{LOST_DB:g} dB lost",
                            f"a lobe is less than {SAME_LOBE:g} like its own"], lines)


def _rising(rows):
    """A line a solver: fits, and how many of them raised what they minimise."""
    return tables.markdown(
        ["solver", "fits", "with a rise", "rises"],
        [[solver, str(len(of)), str(sum(row["rises"] > 0 for row in of)),
          str(sum(row["rises"] for row in of))] for solver, of in
         tables.groups(rows, "solver").items()])


def _figure(rows):
    """A panel a kind, a line or dot a material."""
    from lab import plots
    by_kind = tables.groups([{**row, "kind": kind_of(row["corruption"])} for row in rows
                             if row["corruption"] != CLEAN], "kind")
    columns = min(6, len(by_kind))
    lines = math.ceil(len(by_kind) / columns)
    figure, axes = plots.plt.subplots(lines, columns, figsize=(2.3 * columns, 2.0 * lines),
                                      sharey=True, squeeze=False)
    for panel in axes.flat[len(by_kind):]:
        panel.set_axis_off()
    for panel, (kind, of) in zip(axes.flat, by_kind.items()):
        strengths = list(tables.groups(of, "corruption"))
        for part in tables.groups(of, "material").values():
            panel.plot([strengths.index(row["corruption"]) for row in part],
                       [row["lost_db"] for row in part], "o-", color=plots.BLUE, alpha=0.5,
                       markersize=4, linewidth=1 if len(part) == len(strengths) else 0)
        panel.axhline(LOST_DB, color=plots.VERMILION, linewidth=1)
        panel.set_xticks(range(len(strengths)), [strength_of(text) for text in strengths],
                         fontsize=8)
        panel.set_xlim(-0.4, len(strengths) - 0.6)
        panel.set_title(kind)
    axes[0][0].set_ylim(-2, 30)
    axes[0][0].invert_yaxis()
    for panel in axes[:, 0]:
        panel.set_ylabel("lost (dB)")
    return figure


def _in_order(rows):
    """Rows by kind, in the order of the first ones, and strength, weakest first for several of one kind and sign."""
    kinds = list(tables.groups([{"kind": kind_of(row["corruption"])} for row in rows], "kind"))

    def place(row):
        kind = kind_of(row["corruption"])
        strength = float(strength_of(row["corruption"]) or 0)
        falls = kind in ("photons", "beyond", "quantize", "brackets", "repeat")
        return kinds.index(kind), strength < 0, -strength if falls else strength
    return sorted(rows, key=place)


def draw(drawn, _):
    """The table `strengths`, where there is one, has fits of another run at more strengths."""
    there = {tuple(row[name] for name in KEY) for row in drawn["fits"]}
    more = [row for row in drawn.get("strengths", [])
            if tuple(row[name] for name in KEY) not in there]
    rows = _in_order(_lost(drawn["fits"] + more))
    own = _by_default(rows)
    drawn_by = {"breakdowns.md": _breakdowns(rows), "rises.md": _rising(drawn["fits"])}
    for name, table in (("solver", "solvers.md"), ("weighting", "weightings.md"),
                        ("remedy", "remedies.md")):
        if text := _by_way(rows, name):
            drawn_by[table] = text
    if own:
        drawn_by |= {"spheres": _figure(own), "corruptions.md": _by_corruption(own),
                     "errors.md": _errors(own)}
    return drawn_by
