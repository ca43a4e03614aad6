"""Final error: see README.md beside this file."""
import io
import json
import math
import pathlib

from PIL import Image

from lab import fits, merl, records, stats, tables
from lab.fits import Fit
from lab.units import FOLDER, Product, Unit

ONE = ("threads", "start")  # the tables know one of each
MEASURES = ("psnr_db", "mean_relative_error", "mean_log_error")
PUBLISHED = "published, one lobe"
OURS = "three lobes"
BELOW = 75  # degrees; beyond, the published fits do not follow the measurements


def _published(setting, judged):
    """The units that score the published one-lobe fits of the materials of judged, {material: the
    unit of its fit}, if their file is given: on all samples, and together with that fit on those
    below BELOW degrees."""
    picture, names = setting.place("npf"), setting.place("npf_names")
    if not picture or not names:
        return []
    known = set(names.read_text().split())
    scores = []
    for source in setting.sources:
        if source.name not in known or source.name not in judged:
            continue
        fitted = judged[source.name]
        weighting = fitted.labels["weighting"]
        flags = fits.words(fits.of_weighting(setting, weighting))
        model = Unit(f"npf/{source.name}/model", pathlib.Path(__file__).with_name("npf_model"),
                     (str(picture), str(names), source.name, f"{FOLDER}/model.json"), "model.json",
                     labels={"run": "npf model"})
        scores += [
            model,
            Unit(f"npf/{source.name}/score", setting.program(),
                 ("score", Product(model, "model.json"), source.path, "--json", *flags,
                  *fits.words(setting.reading(source))),
                 labels={"material": source.name, "solver": PUBLISHED, "run": PUBLISHED,
                         "weighting": weighting}),
            Unit(f"npf/{source.name}/below", pathlib.Path(__file__).with_name("score_below"),
                 (str(setting.program()), source.path, str(BELOW), FOLDER,
                  Product(fitted, "model.json"), Product(model, "model.json"), *flags),
                 modules=(pathlib.Path(merl.__file__),),
                 labels={"material": source.name, "run": "below"})]
    return scores


def units(setting):
    """The fits, pictures of one solver's, and the scores of the published ones."""
    fitted = fits.planned(setting)
    source_of = {source.name: source for source in setting.sources}
    chosen = setting.manifest["plots"]
    judged = {unit.labels["material"]: unit for unit in fitted
              if (unit.labels["solver"], unit.labels["run"]) == (chosen["solver"], chosen["run"])}
    pictures = [
        Unit(f"plot/{name}/{unit.path.rsplit('/', 1)[-1]}", setting.program(),
             ("plot", Product(unit, "model.json"), source_of[name].path, f"--out={FOLDER}",
              *fits.words(setting.reading(source_of[name]))), "slices.png",
             labels={"run": "pictures", "material": name})
        for name, unit in judged.items()]
    return fitted + pictures + _published(setting, judged)


# --- tables ---------------------------------------------------------------------------------------


def _row(result, clock):
    labels = result.labels
    row = {"material": labels["material"], "run": labels["run"], "solver": labels["solver"],
           "weighting": labels["weighting"]}
    if not result.folder:
        return {**row, "objective": math.inf, "stop_reason": "missing"}
    if labels["run"] == PUBLISHED:
        score = json.loads((result.folder / "stdout.txt").read_text())
        return {**row, **{key: score[key] for key in
                          ("valid_samples", "objective", "relative_objective", "psnr_peak",
                           *MEASURES)}}
    fit = Fit(result.folder, clock)
    report = fit.report
    return {**row, **{key: report[key] for key in
                      ("valid_samples", "initial_objective", "objective", "relative_objective",
                       "psnr_peak", *MEASURES, "iterations", "stop_reason")},
            **records.columns(report, labels["material"]),
            "optimality": report["diagnosis"] and report["diagnosis"]["optimality"],
            "solve_s": fit.solved - fit.before, "all_s": fit.all}


def _for_a_page(path):
    """The picture at half its size, without its title, which names a path."""
    picture = Image.open(path).convert("RGB")
    width, height = picture.size
    picture = picture.crop((0, round(0.09 * height), width, height))
    picture = picture.resize((width // 2, picture.height // 2), Image.LANCZOS)
    picture = picture.quantize(64, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    text = io.BytesIO()
    picture.save(text, "PNG", optimize=True)
    return text.getvalue()


def tabulate(setting, results):
    rows = [_row(result, fits.clock(setting)) for result in results
            if result.labels["run"] not in ("pictures", "npf model", "below")]
    database = {source.name: source.database for source in setting.sources}
    for row in rows:
        row["database"] = database[row["material"]]
    chosen = setting.manifest["plots"]
    judged = [row for row in rows if row["solver"] == chosen["solver"]
              and row["run"] == chosen["run"] and math.isfinite(row["objective"])]
    worst = sorted(judged, key=lambda row: -row["mean_log_error"])[:chosen["worst"]]
    products = {"fits": rows,
                "worst": [{key: row[key] for key in ("material", "relative_objective", *MEASURES)}
                          for row in worst]}
    below = []
    for result in results:
        if result.labels["run"] == "below" and result.folder:
            scores = json.loads((result.folder / "stdout.txt").read_text())
            below += [{"material": result.labels["material"], "fit": fit,
                       **{key: score[key] for key in ("valid_samples", "objective", *MEASURES)}}
                      for fit, score in zip((OURS, PUBLISHED), scores)]
    if below:
        products["below"] = below
    folder = {result.labels["material"]: result.folder for result in results
              if result.labels["run"] == "pictures"}
    for row in worst:
        if folder.get(row["material"]):
            products[f"slices-{row['material']}.png"] = _for_a_page(
                folder[row["material"]] / "slices.png")
    return products


# --- texts and pictures ---------------------------------------------------------------------------


def _name(row):
    if row["run"] == "weighting":
        return row["weighting"]
    return row["solver"] if row["run"] in (PUBLISHED, "") else f"{row['solver']}, {row['run']}"


def _columns(rows):
    return list(dict.fromkeys(_name(row) for row in rows))


def _cells(rows, columns, measure, text, larger_is_better=False):
    """A cell a column, the best bold; of what ties with it in the digits shown, all."""
    of = {_name(row): row.get(measure) for row in rows}
    known = [of[c] for c in columns if of.get(c) is not None and math.isfinite(of[c])]
    best = text((max if larger_is_better else min)(known)) if known else None
    cells = []
    for column in columns:
        value = of.get(column)
        if value is None:
            cells.append("missing" if column in of else "")
        else:
            shown = text(value) if math.isfinite(value) else "missing"
            cells.append(f"**{shown}**" if shown == best else shown)
    return cells


def _table(rows, measure, text, larger_is_better=False):
    columns = _columns(rows)
    return tables.markdown(["material", *columns],
                           [[name, *_cells(of, columns, measure, text, larger_is_better)]
                            for name, of in sorted(tables.groups(rows, "material").items())])


def _overview(rows):
    """A row a column of the tables: how often best, and medians."""
    lines = []
    by_material = tables.groups(rows, "material")
    for column in _columns(rows):
        planned = [row for row in rows if _name(row) == column]
        of = [row for row in planned if math.isfinite(row["objective"])]
        ratios = []
        for row in of:
            alike = [other for other in by_material[row["material"]] if other["weighting"] == row["weighting"]]
            least = min(other[column] for other in alike for column in ("objective", "record")
                        if other.get(column) is not None)
            ratios.append(stats.ratio(row["objective"], least))
        if of:
            lines.append([column, tables.count(len(planned), len(planned) - len(of)),
                          f"{sum(ratio <= 1.001 for ratio in ratios)}",
                          f"{stats.geometric_mean(ratios):.4g}", f"{max(ratios):.4g}",
                          *(f"{stats.median([factor * row[measure] for row in of]):.4g}"
                            for measure, factor in (("psnr_db", 1), ("mean_relative_error", 100),
                                                    ("mean_log_error", 1)))])
    return tables.markdown(
        ["fits", "materials", "within 0.1 % of the lowest E", "E over the lowest, geometric mean",
         "worst", "PSNR dB, median", "mean relative error %, median", "mean log error, median"],
        lines)


def _defaults_table(rows):
    """All about the fits by the program's defaults."""
    header = ["material", "valid bins", "E at the start", "E", "% of black", "PSNR dB",
              "peak /sr", "mean rel. error %", "iterations", "stopped by", "solve s", "all s"]
    lines = []
    for row in sorted(rows, key=lambda row: (row["database"], row["material"])):
        if not math.isfinite(row["objective"]):
            lines.append([row["material"], "missing", *[""] * (len(header) - 2)])
            continue
        lines.append([row["material"], str(row["valid_samples"]),
                      f"{row['initial_objective']:.4g}", f"{row['objective']:.5g}",
                      f"{100 * row['relative_objective']:.3g}", f"{row['psnr_db']:.1f}",
                      f"{row['psnr_peak']:.3g}", f"{100 * row['mean_relative_error']:.2f}",
                      str(row["iterations"]), row["stop_reason"], f"{row['solve_s']:.2f}",
                      f"{row['all_s']:.2f}"])
    return tables.markdown(header, lines)


def _published_rows(rows):
    """[{"material", "fit", measures}] of the materials with a published fit, on all samples."""
    known = {row["material"] for row in rows if row["run"] == PUBLISHED
             and math.isfinite(row["objective"])}
    return [{**row, "fit": PUBLISHED if row["run"] == PUBLISHED else OURS} for row in rows
            if row["material"] in known and row["run"] in ("defaults", PUBLISHED)
            and math.isfinite(row["objective"])]


def _published_figure(everywhere, below):
    """Three lobes against the published one lobe, a line a material, on all samples and on those
    that are not near grazing."""
    from lab import plots
    ours = {row["material"]: row for row in below if row["fit"] == OURS}
    names = sorted(ours, key=lambda name: ours[name]["mean_log_error"])
    figure, panels = plots.plt.subplots(1, 4, figsize=(14, 0.2 * len(names) + 1.8), sharey=True)
    for k, (axes, (measure, label)) in enumerate(zip(
            panels, 2 * (("psnr_db", "PSNR (dB), more is better"),
                         ("mean_log_error", "mean log error, less is better")))):
        of = {fit: {row["material"]: row[measure] for row in group} for fit, group in
              tables.groups(everywhere if k < 2 else below, "fit").items()}
        for y, name in enumerate(names):
            axes.plot([of[PUBLISHED][name], of[OURS][name]], [y, y], color="#BBBBBB", linewidth=1)
        for fit, colour in ((PUBLISHED, plots.VERMILION), (OURS, plots.BLACK)):
            axes.plot([of[fit][name] for name in names], range(len(names)), "o", color=colour,
                      markersize=4, label=fit)
        axes.set_xlabel(label)
        axes.set_title("all samples" if k < 2 else f"both directions below {BELOW}°")
        if measure == "mean_log_error":
            axes.set_xscale("log")
            plots.plain_numbers(axes.xaxis)
    panels[0].set_yticks(range(len(names)), names, fontsize=8)
    panels[0].set_ylim(-0.7, len(names) - 0.3)
    plots.legend_above(figure, panels[0])
    return figure


def _published_table(everywhere, below):
    lines = []
    for samples, rows in (("all", everywhere), (f"both directions below {BELOW}°", below)):
        pairs = [{row["fit"]: row for row in of}
                 for of in tables.groups(rows, "material").values()]
        for fit in (OURS, PUBLISHED):
            lines.append([samples, fit, str(len(pairs)),
                          *(f"{stats.median([factor * pair[fit][measure] for pair in pairs]):.4g}"
                            for measure, factor in (("psnr_db", 1), ("mean_relative_error", 100),
                                                    ("mean_log_error", 1))),
                          str(sum(pair[fit]["mean_log_error"] == min(
                              row["mean_log_error"] for row in pair.values()) for pair in pairs))])
    return tables.markdown(["samples", "fit", "materials", "PSNR dB, median",
                            "mean relative error %, median", "mean log error, median",
                            "less mean log error on"], lines)


def _spread_figure(rows):
    """Mean log error of all materials by the defaults, sorted, by database."""
    from lab import plots
    figure, panels = plots.plt.subplots(1, 3, figsize=(12, 4.4))
    for axes, measure, factor, label in (
            (panels[0], "relative_objective", 100, "E, % of that of a black model"),
            (panels[1], "psnr_db", 1, "PSNR (dB)"),
            (panels[2], "mean_log_error", 1, "mean log error")):
        for (database, of), colour in zip(sorted(tables.groups(rows, "database").items()),
                                          plots.SERIES):
            values = sorted(factor * row[measure] for row in of)
            share = [100 * (k + 1) / len(values) for k in range(len(values))]
            axes.step(values, share, where="post", color=colour, label=f"{database} ({len(of)})")
        axes.set(xlabel=label, ylim=(0, 102))
        if measure != "psnr_db":
            axes.set_xscale("log")
            plots.plain_numbers(axes.xaxis)
    panels[0].set_ylabel("share of materials (%) at or below")
    panels[0].legend(loc="best")
    figure.suptitle("How well the defaults fit, over all materials", x=0.01, ha="left")
    return figure


def _worst_text(worst, folder):
    text = ""
    for place, row in enumerate(worst, start=1):
        text += (f"{place}. {row['material']}: mean log error {row['mean_log_error']:.4g}, "
                 f"PSNR {row['psnr_db']:.1f} dB, mean relative error "
                 f"{100 * row['mean_relative_error']:.1f} %, E "
                 f"{100 * row['relative_objective']:.3g} % of that of a black model\n\n")
        name = f"slices-{row['material']}.png"
        if (folder / name).exists():
            text += f"![Measured and fitted values of {row['material']}]({name})\n\n"
    return text


def draw(drawn, folder):
    rows = drawn["fits"]
    solvers = [row for row in rows if row["run"] != "weighting"]
    # The weightings' own materials alone, or the column of the default would be of others.
    others = {row["material"] for row in rows if row["run"] == "weighting"}
    weightings = [{**row, "run": "weighting"} for row in rows
                  if row["material"] in others and row["run"] in ("defaults", "weighting")]
    defaults = [row for row in rows if row["run"] == "defaults"]
    fitted = [row for row in defaults if math.isfinite(row["objective"])]
    known = [{**row, "run": "", "solver": "lowest known", "objective": row["record"]}
             for row in defaults if row.get("record") is not None]
    products = {
        "overview.md": _overview(solvers),
        "objective.md": _table(solvers + known, "objective", "{:.5g}".format),
        "psnr.md": _table(solvers, "psnr_db", "{:.2f}".format, larger_is_better=True),
        "relative_error.md": _table(solvers, "mean_relative_error", "{:.2%}".format),
        "defaults.md": _defaults_table(defaults),
        "worst.md": _worst_text(drawn["worst"], folder)}
    if others:
        products["weighting_psnr.md"] = _table(weightings, "psnr_db", "{:.2f}".format, True)
        products["weighting_relative_error.md"] = _table(weightings, "mean_relative_error",
                                                         "{:.2%}".format)
    if fitted:  # none if only other fits were asked for
        products["spread"] = _spread_figure(fitted)
    if drawn.get("below"):
        everywhere = _published_rows(rows)
        products["published"] = _published_figure(everywhere, drawn["below"])
        products["published.md"] = _published_table(everywhere, drawn["below"])
    return products
