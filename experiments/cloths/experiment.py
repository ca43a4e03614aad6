"""Cloths: see README.md beside this file."""
import itertools
import json
import math
import pathlib

import numpy

from lab import fits, stats, tables
from lab.units import FOLDER, Product, Unit
from renderer import noise, pictures
from renderer import units as rendering

HERE = pathlib.Path(__file__).resolve().parent
FORMULA, INTERPOLATED = "formula", "interpolated"  # names in `render`
DEFAULT, PUBLISHED, ROUND, ISOTROPIC = RUNS = ("default", "paper's nodes", "two azimuths",
                                               "isotropic")
AMPLIFIED = 4  # differences in pictures
# Worst values, for results that are missing.
WORST = {"psnr_db": -math.inf, "linear_psnr_db": -math.inf, "whole_psnr_db": -math.inf}


# --- units ----------------------------------------------------------------------------------------


def _scenes(setting):
    """{name: the words that describe it}; the cloth needs Mitsuba."""
    probe = setting.place("probe")
    if probe or not setting.quick:
        rendering.require_mitsuba()
    elif not rendering.has_mitsuba():
        print("cloths: without Mitsuba no cloth is shown")
    found = {}
    for name, flags in setting.manifest["scenes"].items():
        words = fits.words({**flags, **({"probe": probe} if probe else {})})
        if name == "cloth":
            if not rendering.has_mitsuba():
                continue
            mesh = Unit("cloths/drape", HERE / "drape",
                        (FOLDER, *fits.words(setting.manifest["drape"])), "cloth.obj")
            words += ["--shape", Product(mesh, "cloth.obj")]
        found[name] = tuple(words)
    return found


def _rendered(setting, source, scene, fitted, words, seed):
    paths = rendering.light_paths(setting, "cloths", scene, ("--directions", *words), seed)
    given = [word for pair in fitted.items() for word in pair]
    return Unit(f"cloths/{source.name}/{scene}-{seed}", HERE / "render",
                (str(setting.program("brdf_values")), source.path, FOLDER, *given, paths,
                 f"--within={setting.manifest['within']}"), "scores.json",
                modules=rendering.modules("pictures.py"),
                labels={"material": source.name, "scene": scene, "seed": seed, "kind": "render"})


def _agreement(setting, source, scene, fitted, words):
    return Unit(f"cloths/{source.name}/{scene}-mitsuba", HERE / "mitsuba_picture",
                (FOLDER, fitted[DEFAULT], *words, f"--samples={setting.manifest['samples']}"),
                "pictures.npz", modules=rendering.modules("bsdf.py", "scene.py", "light_lobes.py"),
                labels={"material": source.name, "scene": scene, "kind": "mitsuba"})


def units(setting):
    """Fits, and pictures of them and of what they are fits of."""
    planned = fits.planned(setting)
    again = {source.name for source in setting.every(setting.manifest["noise_every"])}
    made, scenes = list(planned), _scenes(setting)
    for source in setting.sources:
        fitted = {unit.labels["run"]: Product(unit, "model.json") for unit in planned
                  if unit.labels["material"] == source.name}
        for scene, words in scenes.items():
            for seed in (1, noise.AGAIN) if source.name in again else (1,):
                made.append(_rendered(setting, source, scene, fitted, words, seed))
            if source.name in setting.manifest["agreement"] and setting.place("probe"):
                made.append(_agreement(setting, source, scene, fitted, words))
    return made


# --- tables ---------------------------------------------------------------------------------------


def _short(name):
    return name.removeprefix("synth-")


def _fit_rows(results):
    """Rows of fits, with their errors at the measured directions."""
    rows = []
    for result in results:
        if "run" not in result.labels:
            continue
        row = {"material": _short(result.labels["material"]), "fit": result.labels["run"],
               "psnr_db": -math.inf}
        if result.folder:
            report = json.loads((result.folder / "report.json").read_text())
            row.update({name: report[name] for name in ("psnr_db", "psnr_peak", "objective")})
            row["seconds"] = sum(report["seconds"].values())
        rows.append(row)
    return rows


def _render_rows(results):
    rows = []
    for result in results:
        labels = result.labels
        if (labels.get("kind"), labels.get("seed")) != ("render", 1):
            continue
        runs = [word for word in result.unit.arguments[3:-2:2] if isinstance(word, str)]
        scores = (json.loads((result.folder / "scores.json").read_text()) if result.folder else {})
        rows += [{"material": _short(labels["material"]), "scene": labels["scene"], "fit": fit,
                  **WORST, **scores.get(fit, {})} for fit in (INTERPOLATED, *runs)]
    return rows


def _agreement_rows(results, folder_of):
    """Mitsuba's pictures beside ours."""
    rows = []
    for result in results:
        labels = result.labels
        ours = folder_of.get((labels["material"], labels.get("scene"), 1))
        if labels.get("kind") != "mitsuba" or not result.folder or not ours:
            continue
        own, theirs = (numpy.load(of) for of in (ours / "whole.npz",
                                                 result.folder / "pictures.npz"))
        counts = own["share"] >= 0
        factor = pictures.exposure(own[FORMULA], counts)
        shown = [pictures.encoded(of * factor)[counts]
                 for of in (own[DEFAULT], theirs["first"], theirs["again"])]
        rows.append({"material": _short(labels["material"]), "scene": labels["scene"],
                     "noise_db": pictures.psnr(*shown[1:]), "apart_db": pictures.psnr(*shown[:2]),
                     "mean_ratio": float(shown[1].mean() / shown[0].mean())})
    return rows


def _best_and_worst(rows, folder_of, scene):
    """The page of the two materials whose default fits look best, and the two that look worst."""
    short = {_short(name): folder for (name, where, seed), folder in folder_of.items()
             if (where, seed) == (scene, 1)}
    order = sorted((row["psnr_db"], row["material"]) for row in rows
                   if (row["fit"], row["scene"]) == (DEFAULT, scene) and row["material"] in short)
    page = []
    for _, material in order[:-3:-1] + order[1::-1] if len(order) > 3 else order:
        folder = short[material]
        of, scores = numpy.load(folder / "whole.npz"), json.loads(
            (folder / "scores.json").read_text())
        factor = pictures.exposure(of[FORMULA], of["share"] >= 0)
        truth = pictures.encoded(of[FORMULA] * factor)
        line = [(truth, "the material")]
        for name in (DEFAULT, ROUND, ISOTROPIC):
            if name in scores:
                shown = pictures.encoded(of[name] * factor)
                difference = numpy.clip(0.5 + AMPLIFIED / 2 * (shown - truth), 0, 1)
                line += [(shown, f"{name}\n{scores[name]['psnr_db']:.1f} dB"),
                         (difference, "difference")]
        page.append((material, line))
    return pictures.side_by_side(page, width=150) if page else None


def tabulate(setting, results):
    """fits: at the measured directions; renders: a row for each picture; noise, agreement."""
    folder_of = {(r.labels["material"], r.labels["scene"], r.labels["seed"]): r.folder
                 for r in results if r.labels.get("kind") == "render" and r.folder}
    rows = _render_rows(results)
    products = {"fits": _fit_rows(results), "renders": rows,
                "noise": noise.rows(folder_of, FORMULA),
                "agreement": _agreement_rows(results, folder_of)}
    for scene in dict.fromkeys(row["scene"] for row in rows):
        if page := _best_and_worst(rows, folder_of, scene):
            products[f"{scene}.jpg"] = page
    return products


# --- texts and pictures ---------------------------------------------------------------------------


def _order(drawn):
    """Materials by the PSNR of the isotropic fit's sphere."""
    at = {row["material"]: row["psnr_db"] for row in drawn["renders"]
          if (row["scene"], row["fit"]) == ("sphere", ISOTROPIC)}
    return sorted(at, key=at.get)


def _runs(drawn):
    there = list(dict.fromkeys(row["fit"] for row in drawn["renders"]))
    known = [name for name in (INTERPOLATED, *RUNS) if name in there]
    return known + [name for name in there if name not in known]


def _groups(drawn):
    """{title: {fit: {material: PSNR}}}: at the measured directions, and of each scene."""
    found = {"numerical": drawn["fits"], **tables.groups(drawn["renders"], "scene")}
    return {title: {fit: {row["material"]: row["psnr_db"] for row in of}
                    for fit, of in tables.groups(rows, "fit").items()}
            for title, rows in found.items()}


TITLES = {"numerical": "at the measured directions", "sphere": "sphere, rendered",
          "cloth": "cloth, rendered"}


def _cells(values):
    return [f"{value:.1f}" if math.isfinite(value) else "–" for value in values]


def _materials_table(drawn):
    """A table a group, with a line a material, and the mean and the median."""
    peak = {row["material"]: row.get("psnr_peak") for row in drawn["fits"]}
    order, texts = _order(drawn), []
    for title, of in _groups(drawn).items():
        numerical = title == "numerical"
        fitted = [fit for fit in _runs(drawn) if fit in of]
        values = [[of[fit].get(name, -math.inf) for fit in fitted] for name in order]
        lines = [[name, *_cells(cells),
                  *([f"{peak[name]:.3g}" if peak[name] else "–"] if numerical else [])]
                 for name, cells in zip(order, values)]
        for name, middle in (("mean", numpy.mean), ("median", numpy.median)):
            lines.append([f"*{name}*", *_cells(middle(values, axis=0)), *[""] * numerical])
        header = [f"PSNR dB {TITLES[title]}", *fitted, *["peak, 1/sr"] * numerical]
        texts.append(tables.markdown(header, lines))
    return "\n".join(texts)


def _whole_table(drawn):
    """Medians and quartiles; of whole pictures, too, grazing directions among them."""
    lines = []
    for scene, part in tables.groups(drawn["renders"], "scene").items():
        of_fit = tables.groups(part, "fit")
        for fit in _runs(drawn):
            of = of_fit[fit]
            lines.append([scene, fit, *(tables.quartiles([row[name] for row in of], ".1f")
                                        for name in ("psnr_db", "linear_psnr_db",
                                                     "whole_psnr_db")),
                          tables.quartiles([row.get("flip") for row in of], ".3f")])
    return tables.markdown(["scene", "fit", "PSNR, dB", "linear", "PSNR of all directions",
                            "FLIP"], lines)


def _rank_table(drawn):
    """Whether one measure orders the materials as another does, for each fit and over all fits."""
    groups, order = _groups(drawn), _order(drawn)
    fitted = [fit for fit in _runs(drawn) if all(fit in of for of in groups.values())]
    lines = []
    for name, part in [*((fit, [fit]) for fit in fitted), ("all of these", fitted)]:
        at = {title: [of[fit].get(material, -math.inf) for fit in part for material in order]
              for title, of in groups.items()}
        lines.append([name, *(f"{stats.rank_correlation(at[a], at[b]):.2f}"
                              for a, b in itertools.combinations(groups, 2))])
    return tables.markdown(["fit", *(f"{a} – {b}" for a, b in itertools.combinations(groups, 2))],
                           lines)


def _agreement_table(rows):
    return tables.markdown(
        ["material", "scene", "two pictures by Mitsuba, dB apart", "ours and Mitsuba's, dB apart",
         "mean of Mitsuba's over that of ours"],
        [[row["material"], row["scene"], f"{row['noise_db']:.1f}", f"{row['apart_db']:.1f}",
          f"{row['mean_ratio']:.4f}"] for row in rows])


def _figure(drawn):
    """The paper's Fig. 4: PSNR of each material, sorted by that of the isotropic fit's sphere."""
    from lab import plots
    order, groups = _order(drawn), _groups(drawn)
    figure, panels = plots.plt.subplots(1, len(groups), squeeze=False, sharey=True,
                                        figsize=(1.5 + 4 * len(groups), 4.6))
    styles = {INTERPOLATED: (plots.GREY, "x"), DEFAULT: (plots.BLACK, "o"),
              PUBLISHED: (plots.SKY, "^"), ROUND: (plots.GREEN, "v"),
              ISOTROPIC: (plots.VERMILION, "s")}
    for axes, (title, of) in zip(panels[0], groups.items()):
        for fit in _runs(drawn):
            colour, marker = styles.get(fit, (plots.PURPLE, "D"))
            known = [(x, of[fit][name]) for x, name in enumerate(order)
                     if math.isfinite(of.get(fit, {}).get(name, math.inf))]
            if known:
                axes.plot(*zip(*known), marker=marker, color=colour, linewidth=1, markersize=5,
                          label="the measurement, interpolated" if fit == INTERPOLATED else fit)
        axes.set_xticks(range(len(order)), order, rotation=90, fontsize=8)
        axes.set(title=TITLES[title])
    panels[0][0].set_ylabel("PSNR (dB), more is better")
    plots.legend_above(figure, panels[0][-1])
    return figure


def draw(drawn, _):
    products = {"psnr": _figure(drawn), "materials.md": _materials_table(drawn),
                "whole.md": _whole_table(drawn), "rank.md": _rank_table(drawn)}
    if drawn.get("noise"):
        products["noise.md"] = noise.table(drawn["noise"], "a material")
    if drawn.get("agreement"):
        products["agreement.md"] = _agreement_table(drawn["agreement"])
    return products
