"""Spheres: see README.md beside this file."""
import io
import itertools
import json
import math

from PIL import Image, ImageDraw, ImageFont

from lab import UsageError, fits, tables
from lab.fits import Fit
from lab.units import FOLDER, Product, Unit

ONE = ("solver", "threads", "start")  # the tables know one of each
# Members of the manifest by which comparisons other than runs are given.
PEERS = {"peer": "peers", "reciprocal peer": "reciprocal_peers"}
BUILT_IN = "built-in"
SHOWN = "default"  # the run of which the gallery is
FORMER = "compressive"  # the run that it is compared with
PICTURE = "spheres.png"
COLOUR = 0.02  # relative error of the mean colour that is still right
APART = 1.0  # dB: a difference that one may see
# Worst values, for results that are missing.
WORST = {"psnr_db": -math.inf, "mean_delta_e": math.inf, "delta_e_95": math.inf,
         "mean_color_error": math.inf, "mean_log_error": math.inf}
GALLERY_BYTES = 450_000  # at most


def _peers(setting, member):
    """{material: the peer's source}: tables NAME.binary in a folder, or as the manifest says."""
    given = setting.manifest[member]
    if isinstance(given, dict):
        return given
    folder = setting.place(member)
    if folder is None:
        return {}
    of_material = {source.name: folder / f"{source.name}.binary" for source in setting.sources}
    found = {name: str(path) for name, path in of_material.items() if path.is_file()}
    if not found:
        raise UsageError(f"{member}: {folder} has no NAME.binary of any of the materials given")
    return found


def units(setting):
    """The fits, and the score of each, and of each peer, under each environment."""
    fitted = fits.planned(setting)
    source_of = {source.name: source for source in setting.sources}
    probe = setting.place("probe")
    environments = {BUILT_IN: ()}
    if probe:
        environments[probe.stem] = (f"--probe={probe}",)
    judged = [(Product(unit, "model.json"), unit.labels) for unit in fitted]
    names = {unit.labels["material"] for unit in fitted}
    judged += [(peer, {"material": name, "run": run}) for run, member in PEERS.items()
               for name, peer in _peers(setting, member).items() if name in names]
    scores = []
    for what, labels in judged:
        source = source_of[labels["material"]]
        for environment, flags in environments.items():
            scores.append(Unit(
                f"spheres/{source.name}/{fits.file_name(labels['run'])}-"
                f"{fits.file_name(environment)}", setting.program(),
                ("score", what, source.path, "--json", f"--out={FOLDER}/{PICTURE}", "--threads=2",
                 *flags, *fits.words(setting.reading(source))),
                labels={**labels, "environment": environment}))
    return fitted + scores


# --- tables ---------------------------------------------------------------------------------------


def _numbers(model):
    """The number of numbers that a model file stores in its tables or coefficients."""
    if isinstance(model, dict):
        return len(model["values"])
    return sum(map(_numbers, model)) if isinstance(model, list) else 1


def _exponents(model):
    """The number of exponents by which the lobes' highlights are stretched."""
    stretch = model.get("stretch", [])
    return 2 * (len(stretch) if isinstance(stretch, list) else 1)


def _of_fit(folder):
    """The seconds that a fit took, and the numbers that its model has."""
    model = json.loads((folder / "model.json").read_text())
    return {"seconds": sum(Fit(folder).report["seconds"].values()),
            "numbers": sum(_numbers(model[part]) for part in ("d", "s", "D", "F", "G")) + _exponents(model)}


def _row(result, source, folder_of):
    labels = result.labels
    row = {"material": source.name, "database": source.database, "half": source.half or "own",
           "fit": labels["run"], "environment": labels["environment"]}
    if not result.folder:
        return {**row, **WORST}
    score = json.loads((result.folder / "stdout.txt").read_text())
    looks = score["appearance"]
    row.update({key: looks[key] for key in WORST if key in looks})
    if row["psnr_db"] is None:  # equal pictures
        row["psnr_db"] = math.inf
    row["mean_log_error"] = score["mean_log_error"]
    # PSNR with all directions, also those that were not measured, where there are any.
    row["whole_psnr_db"] = looks["beyond"] and looks["beyond"]["psnr_db"]
    return {**row, **(_of_fit(folder_of[result.unit.root.key]) if result.unit.needs else {})}


def _caption(row):
    if not math.isfinite(row["mean_delta_e"]):
        return "missing"
    whole = row["whole_psnr_db"]
    return (f"{row['psnr_db']:.1f} dB, ΔE {row['mean_delta_e']:.2f}"
            + (f"; all {whole:.1f} dB" if whole is not None else ""))


def _jpeg(page):
    """The best that is small enough for a page, or else the smallest."""
    for quality in (90, 85, 80, 70, 60, 50, 40):
        text = io.BytesIO()
        page.save(text, "JPEG", quality=quality, optimize=True)
        if text.tell() <= GALLERY_BYTES:
            break
    return text.getvalue()


def _gallery(shown):
    """All pairs of spheres, [(database, material, row, picture's path)], as a JPEG."""
    from matplotlib import font_manager
    path = font_manager.findfont("DejaVu Sans")
    large, small = (ImageFont.truetype(path, size) for size in (20, 13))
    # Pixels of a pair, its place, a headline, and the margin.
    pair, place, headline, margin = (204, 102), (220, 146), 44, 16
    columns = min(5, max(1, len(shown)))
    of_database = tables.groups([{"database": of[0], "of": of} for of in shown], "database")
    height = margin + sum(headline + place[1] * math.ceil(len(of) / columns)
                          for of in of_database.values())
    page = Image.new("RGB", (2 * margin + place[0] * columns, height), "white")
    pen = ImageDraw.Draw(page)
    top = margin
    for database, group in of_database.items():
        pen.text((margin, top), f"{database}: measured | fitted", "#111111", large)
        top += headline - 8
        for k, of in enumerate(group):
            _, material, row, path = of["of"]
            x, y = margin + place[0] * (k % columns), top + place[1] * (k // columns)
            if path:
                page.paste(Image.open(path).convert("RGB").resize(pair, Image.LANCZOS), (x, y))
            pen.text((x, y + pair[1] + 2), material, "#111111", small)
            pen.text((x, y + pair[1] + 18), _caption(row), "#555555", small)
        top += 8 + place[1] * math.ceil(len(group) / columns)
    return _jpeg(page)


def tabulate(setting, results):
    """fits: a row for each fit and peer under each environment; aims: what is asked for."""
    source_of = {source.name: source for source in setting.sources}
    folder_of = {result.unit.key: result.folder for result in results}
    rows, shown = [], []
    for result in results:
        if "environment" not in result.labels:
            continue
        source = source_of[result.labels["material"]]
        row = _row(result, source, folder_of)
        rows.append(row)
        if (row["fit"], row["environment"]) == (SHOWN, BUILT_IN):
            shown.append((source.database, source.name, row,
                          result.folder / PICTURE if result.folder else None))
    aims = [{"database": database, **of} for database, of in setting.manifest["aims"].items()]
    products = {"fits": rows, "aims": aims}
    if shown:
        products["gallery.jpg"] = _gallery(sorted(shown, key=lambda of: of[:2]))
    return products


# --- texts and pictures ---------------------------------------------------------------------------


def _parts(rows):
    """((environment, database, half), rows): each database as a whole, then by halves."""
    databases = sorted(tables.groups(rows, "database"))
    groups = tables.groups(rows, "environment", "database")
    for environment, database in itertools.product(tables.groups(rows, "environment"), databases):
        of = groups.get((environment, database), [])
        halves = sorted(tables.groups(of, "half").items())
        yield (environment, database, "all"), of
        if len(halves) > 1:
            for half, some in halves:
                yield (environment, database, half), some


def _pairs(rows, fit, other):
    """[(row of the one, row of the other)] of the materials that have both."""
    at = {(row["material"], row["fit"]): row for row in rows}
    return [(row, at[name, other]) for (name, run), row in at.items()
            if run == fit and (name, other) in at]


def _share(rows, holds):
    return f"{100 * sum(map(holds, rows)) / len(rows):.0f} %" if rows else "–"


def _difference(pairs, column, form):
    """Median and quartiles of the first's less the second's."""
    known = [a[column] - b[column] for a, b in pairs
             if math.isfinite(a[column]) and math.isfinite(b[column])]
    return tables.quartiles(known, form)


def _summary_table(rows):
    lines = []
    for names, part in _parts(rows):
        for fit, of in tables.groups(part, "fit").items():
            lost = sum(not math.isfinite(row["mean_delta_e"]) for row in of)
            lines.append([*names, fit, tables.count(len(of), lost),
                          tables.quartiles([row["psnr_db"] for row in of], ".1f"),
                          f"{min(row['psnr_db'] for row in of):.1f}",
                          tables.quartiles([row.get("whole_psnr_db") for row in of], ".1f"),
                          tables.quartiles([row["mean_delta_e"] for row in of], ".2f"),
                          tables.quartiles([row["delta_e_95"] for row in of], ".2f"),
                          tables.quartiles([100 * row["mean_color_error"] for row in of], ".2f"),
                          tables.quartiles([row["mean_log_error"] for row in of]),
                          tables.quartiles([row.get("seconds") for row in of], ".1f"),
                          tables.quartiles([row.get("numbers") for row in of], ".0f")])
    return tables.markdown(
        ["environment", "database", "half", "fit", "n", "PSNR dB", "least PSNR",
         "PSNR of the whole sphere", "mean ΔE", "ΔE at 95 %", "mean colour off by, %",
         "mean log error at bins", "seconds", "numbers"], lines)


def _shares_table(rows, aims):
    aim_of = {aim["database"]: aim for aim in aims}
    lines = []
    for names, part in _parts(rows):
        aim = aim_of.get(names[1])
        for fit, of in tables.groups(part, "fit").items():
            cells = ["", "", "", ""]
            if aim:
                cells = [f"{aim['median']:g}",
                         _share(of, lambda row, aim=aim: row["psnr_db"] >= aim["median"]),
                         f"{aim['minimum']:g}",
                         _share(of, lambda row, aim=aim: row["psnr_db"] >= aim["minimum"])]
            lines.append([*names, fit, str(len(of)), *cells,
                          _share(of, lambda row: row["mean_color_error"] <= COLOUR)])
    return tables.markdown(
        ["environment", "database", "half", "fit", "n", "median asked for, dB", "materials with it",
         "minimum asked for, dB", "materials with it", f"mean colour within {100 * COLOUR:g} %"],
        lines)


def _below_table(rows, aims):
    """All that miss the minimum, the worst first."""
    least = {aim["database"]: aim["minimum"] for aim in aims}
    missing = [row for row in rows if row["psnr_db"] < least.get(row["database"], -math.inf)]
    if not missing:
        return "None.\n"
    return tables.markdown(
        ["environment", "fit", "material", "half", "PSNR dB", "minimum dB", "mean ΔE",
         "mean colour off by, %"],
        [[row["environment"], row["fit"], row["material"], row["half"], f"{row['psnr_db']:.1f}",
          f"{least[row['database']]:g}", f"{row['mean_delta_e']:.2f}",
          f"{100 * row['mean_color_error']:.2f}"]
         for row in sorted(missing, key=lambda row: (
             row["environment"], row["fit"], row["psnr_db"] - least[row["database"]]))])


def _former_table(rows):
    """Every fit against the former default."""
    lines = []
    for names, part in _parts(rows):
        for fit in tables.groups(part, "fit"):
            pairs = _pairs(part, fit, FORMER)
            if fit in (FORMER, *PEERS) or not pairs:
                continue
            loses = [a["material"] for a, b in pairs if a["psnr_db"] < b["psnr_db"] - APART]
            lines.append([*names, fit, str(len(pairs)),
                          f"{len(loses)}" + (f" ({', '.join(loses)})" if loses else ""),
                          str(sum(a["psnr_db"] > b["psnr_db"] + APART for a, b in pairs)),
                          _difference(pairs, "psnr_db", "+.2f"),
                          _difference(pairs, "mean_delta_e", "+.2f")])
    return tables.markdown(
        ["environment", "database", "half", "fit", "n", f"more than {APART:g} dB below {FORMER}",
         f"more than {APART:g} dB above", "PSNR dB more", "mean ΔE more"], lines)


def _peers_table(rows):
    lines = []
    for names, part in _parts(rows):
        for fit, peer in itertools.product(tables.groups(part, "fit"), PEERS):
            pairs = _pairs(part, fit, peer)
            if fit in PEERS or not pairs:
                continue
            lines.append([*names, fit, peer, str(len(pairs)),
                          _share(pairs, lambda pair: pair[0]["psnr_db"] > pair[1]["psnr_db"]),
                          _share(pairs, lambda pair:
                                 pair[0]["mean_log_error"] < pair[1]["mean_log_error"]),
                          _difference(pairs, "psnr_db", "+.2f"),
                          _difference(pairs, "mean_delta_e", "+.2f"),
                          _difference(pairs, "mean_log_error", "+.2g")])
    return tables.markdown(
        ["environment", "database", "half", "fit", "against", "n", "better in PSNR",
         "in mean log error", "PSNR dB more", "mean ΔE more", "mean log error more"], lines)


def _materials_table(rows):
    """PSNR / mean ΔE of each material, a column a fit."""
    fitted = list(tables.groups(rows, "fit"))
    lines = []
    ordered = sorted(rows, key=lambda row: (row["environment"], row["database"], row["material"]))
    for (environment, name), of in tables.groups(ordered, "environment", "material").items():
        at = {row["fit"]: row for row in of}
        lines.append([environment, of[0]["database"], name, of[0]["half"],
                      *(f"{at[fit]['psnr_db']:.1f} / {at[fit]['mean_delta_e']:.2f}"
                        if fit in at else "" for fit in fitted)])
    return tables.markdown(["environment", "database", "material", "half",
                            *(f"{fit}: PSNR dB / ΔE" for fit in fitted)], lines)


def _psnr_figure(rows, aims):
    """A panel for each environment and database: PSNR of each material, sorted by the default's."""
    from lab import plots
    environments = list(tables.groups(rows, "environment"))
    databases = sorted(tables.groups(rows, "database"))
    fitted = list(tables.groups(rows, "fit"))
    aim_of = {aim["database"]: aim for aim in aims}
    most = max(len({row["material"] for row in rows if row["database"] == database})
               for database in databases)
    figure, panels = plots.plt.subplots(
        len(environments), len(databases), squeeze=False,
        figsize=(6.2 * len(databases), len(environments) * (0.19 * most + 1.6)))
    known = [row["psnr_db"] for row in rows if math.isfinite(row["psnr_db"])]
    for line, environment in zip(panels, environments):
        for axes, database in zip(line, databases):
            part = [row for row in rows
                    if (row["environment"], row["database"]) == (environment, database)]
            at = {(row["material"], row["fit"]): row["psnr_db"] for row in part}
            names = sorted({row["material"] for row in part},
                           key=lambda name, at=at: at.get((name, SHOWN), -math.inf))
            for value in (aim_of[database]["median"], aim_of[database]["minimum"]) \
                    if database in aim_of else ():
                axes.axvline(value, color=plots.GREY, linewidth=1, linestyle="--")
            for y, name in enumerate(names):
                values = [at[name, fit] for fit in fitted
                          if math.isfinite(at.get((name, fit), math.inf))]
                if values:
                    axes.plot([min(values), max(values)], [y, y], color="#CCCCCC", linewidth=1)
            for fit, colour, marker in zip(fitted, (plots.BLACK, plots.VERMILION, plots.BLUE,
                                                    plots.GREEN, plots.PURPLE), "osD^v"):
                shown = [(at[name, fit], y) for y, name in enumerate(names)
                         if math.isfinite(at.get((name, fit), math.inf))]
                filled = fit == SHOWN
                axes.plot([x for x, _ in shown], [y for _, y in shown], marker, color=colour,
                          markersize=5 if filled else 4, zorder=3 if filled else 2,
                          markerfacecolor=colour if filled else "white", label=fit)
            axes.set_yticks(range(len(names)), names, fontsize=7)
            axes.set(ylim=(-0.8, len(names) - 0.2), title=f"{database}, {environment}",
                     xlabel="PSNR of the sphere (dB), more is better")
            if known:
                axes.set_xlim(min(known) - 1, max(known) + 1)
    widest = max(panels.flat, key=lambda axes: len(axes.get_legend_handles_labels()[1]))
    plots.legend_above(figure, widest)
    return figure


def draw(drawn, _):
    rows, aims = drawn["fits"], drawn["aims"]
    products = {"psnr": _psnr_figure(rows, aims), "summary.md": _summary_table(rows),
                "shares.md": _shares_table(rows, aims), "below.md": _below_table(rows, aims),
                "materials.md": _materials_table(rows)}
    there = {row["fit"] for row in rows}
    if FORMER in there:
        products["compressive.md"] = _former_table(rows)
    if there & PEERS.keys():
        products["peers.md"] = _peers_table(rows)
    return products
