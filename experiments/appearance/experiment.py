"""Appearance: see README.md beside this file."""
import itertools
import json
import math
import pathlib
import sys

import numpy

from lab import UsageError, fits, lobes, merl, stats, tables
from lab.units import FOLDER, Product, Unit
from renderer import noise, pictures
from renderer import units as rendering

ONE = ("threads", "start")  # the tables know one of each
SHARED, INDEPENDENT = "shared", "independent"  # the runs that everything is held against
BIVARIATE, COARSE = "bivariate", "bivariate of 8,100"
FACTORS = {"awls": 0, "awls, filtered": 1}  # the fits of which D, F and G are drawn
PUBLISHED = ("NPF", "SGD", "ABC", "Cook-Torrance", "Ward")  # the first as a model, not a formula
PEER = "network"
BUILT_IN = "built-in"
HERE = pathlib.Path(__file__).resolve().parent
PICTURED = (HERE / "bins.py", *rendering.modules("pictures.py"))  # files that `render` reads
NPF_MODEL = HERE.parent / "final_error" / "npf_model"
# Worst values, for results that are missing.
WORST = {"psnr_db": -math.inf, "linear_psnr_db": -math.inf, "flip": math.inf}


# --- units ----------------------------------------------------------------------------------------


def _script(path, name, *arguments, product="stdout.txt", modules=(), **labels):
    """A unit of a program of this folder."""
    program = name if isinstance(name, pathlib.Path) else HERE / name
    return Unit(path, program, arguments, product,
                modules=(pathlib.Path(merl.__file__), *modules), labels=labels)


def _scenes(setting):
    """{name: the flags that describe it}, of those that the files given allow."""
    probe, mesh_probe, mesh = (setting.place(name) for name in ("probe", "mesh_probe", "mesh"))
    if (mesh is None) != (mesh_probe is None):
        raise UsageError("give mesh and mesh_probe together")
    if probe or mesh:
        rendering.require_mitsuba()
    elif setting.quick and not rendering.has_mitsuba():
        print("appearance: without Mitsuba no mesh is shown, and nothing is held against its own "
              "pictures", file=sys.stderr)
    found = {}
    for name, flags in setting.manifest["scenes"].items():
        given = {"sphere": {"probe": probe}, "mesh": {"probe": mesh_probe, "shape": mesh}}[name]
        if name == "sphere" or mesh:
            found[name] = tuple(fits.words({**flags, **{k: v for k, v in given.items() if v}}))
    return found


def _published(setting, source):
    """{name: the product}, of the fits to this material that the manifest's files have."""
    found = {}
    npf, names = setting.place("npf"), setting.place("npf_names")
    if npf and names and source.name in names.read_text().split():
        found["NPF"] = Product(_script(f"npf/{source.name}/model", NPF_MODEL, str(npf), str(names),
                                       source.name, f"{FOLDER}/model.json", product="model.json"),
                               "model.json")
    if folder := setting.place("published"):
        for name, file in (("SGD", "bagher_sgd"), ("ABC", "low_lowmicrofacet_E2"),
                           ("Cook-Torrance", "ngan_cooktorrance"), ("Ward", "ngan_ward")):
            path = folder / f"{file}.fit"
            if path.is_file() and f"\n{source.name} = " in path.read_text():
                found[name] = Product(_script(
                    f"appearance/{source.name}/{name}", "published_table", str(path), source.name,
                    FOLDER, product="table.npy"), "table.npy")
    peers = setting.place("peers")
    if source.database == "RGL" and peers and (peers / f"{source.name}.binary").is_file():
        found[PEER] = str(peers / f"{source.name}.binary")
    return found


def _of_factors(setting, source):
    """The fits of which D, F and G are drawn, {name: unit}."""
    if source.name not in setting.manifest["factors"]:
        return {}
    return {name: fits.fit(setting, source, "awls", {**setting.manifest["flags"],
                                                     "g_filter": sigma}, run=name)
            for name, sigma in FACTORS.items()}


def _fitted(setting, source, planned):
    """{name: product}: all that is rendered beside the measurement."""
    reading = fits.words(setting.reading(source))
    of = {unit.labels["run"]: Product(unit, "model.json") for unit in planned
          if unit.labels["material"] == source.name}
    of.update({name: Product(unit, "model.json")
               for name, unit in _of_factors(setting, source).items()})
    for name, theta_d in ((BIVARIATE, 90), (COARSE, 30)):
        of[name] = Product(_script(
            f"appearance/{source.name}/bivariate-{theta_d}", "bivariate", str(setting.program()), source.path,
            FOLDER, str(theta_d), *reading, product="table.npy", modules=(HERE / "bins.py",)), "table.npy")
    return {**of, **_published(setting, source)}


def _rendered(setting, source, scene, fitted, paths, seed):
    words = [word for pair in fitted.items() for word in pair]
    return _script(f"appearance/{source.name}/{scene}-{seed}", "render", str(setting.program()),
                   source.path, FOLDER, *words, paths, *fits.words(setting.reading(source)),
                   product="scores.json", modules=PICTURED,
                   material=source.name, scene=scene, seed=seed, kind="render")


def _agreement(setting, source, scene, flags, fitted):
    """Pictures by Mitsuba's integrator; of an RGL file also by its own reader, and then of all
    directions, as that leaves none out."""
    plugin = source.path.endswith("_rgb.bsdf")
    words = [f"--plugin={source.path}", "--read=--extrapolated"] if plugin else []
    names = [] if plugin else [SHARED, fitted[SHARED]]
    return _script(f"appearance/{source.name}/{scene}-mitsuba", "mitsuba_picture",
                   str(setting.program()), source.path, FOLDER, *names, *words, *flags,
                   f"--samples={setting.manifest['samples']}", product="pictures.npz",
                   modules=(HERE / "bins.py", *rendering.modules(
                       "bsdf.py", "scene.py", "light_lobes.py")),
                   material=source.name, scene=scene, kind="mitsuba")


def units(setting):
    """Fits, the program's own scores of them, and pictures."""
    planned = fits.planned(setting)
    sources = {unit.labels["material"] for unit in planned}
    again = {source.name for source in setting.every(setting.manifest["noise_every"])}
    scenes, made = _scenes(setting), list(planned)
    probe = setting.place("probe")
    environments = {BUILT_IN: (), **({"probe": (f"--probe={probe}",)} if probe else {})}
    for source in setting.sources:
        made += _of_factors(setting, source).values()
        if source.name not in sources:
            continue
        fitted = _fitted(setting, source, planned)
        for (run, product), (name, flags) in itertools.product(fitted.items(),
                                                               environments.items()):
            if run in (SHARED, INDEPENDENT):
                made.append(Unit(
                    f"appearance/{source.name}/score-{run}-{name}", setting.program(),
                    ("score", product, source.path, "--json", "--threads=2", *flags,
                     *fits.words(setting.reading(source))),
                    labels={"material": source.name, "run": run, "kind": "score",
                            "environment": name}))
        for scene, flags in scenes.items():
            paths = {seed: rendering.light_paths(setting, "appearance", scene, flags, seed)
                     for seed in (1, noise.AGAIN)}
            for seed in (1, noise.AGAIN) if source.name in again else (1,):
                made.append(_rendered(setting, source, scene, fitted, paths[seed], seed))
            if source.name in setting.manifest["agreement"]:
                made.append(_agreement(setting, source, scene, flags, fitted))
                if source.path.endswith("_rgb.bsdf"):  # the same directions as in Mitsuba's
                    made.append(_script(
                        f"appearance/{source.name}/{scene}-whole", "render",
                        str(setting.program()), source.path, FOLDER, SHARED, fitted[SHARED],
                        paths[1], "--extrapolated", product="scores.json", modules=PICTURED,
                        material=source.name, scene=scene, kind="whole"))
    return made


# --- tables ---------------------------------------------------------------------------------------


def _scored(results):
    """{(material, run, environment): the PSNR by `trilobe score`}"""
    found = {}
    for result in results:
        if result.labels.get("kind") == "score" and result.folder:
            looks = json.loads((result.folder / "stdout.txt").read_text())["appearance"]
            value = looks["psnr_db"]
            found[result.labels["material"], result.labels["run"],
                  result.labels["environment"]] = math.inf if value is None else value
    return found


def _render_rows(setting, results, source_of):
    scored, rows = _scored(results), []
    for result in results:
        labels = result.labels
        if (labels.get("kind"), labels.get("seed")) != ("render", 1):
            continue
        source = source_of[labels["material"]]
        names = result.unit.arguments[3:]
        names = [name for name in names[::2] if isinstance(name, str) and not name.startswith("--")]
        scores = {}
        if result.folder:
            scores = json.loads((result.folder / "scores.json").read_text())
        for fit in names:
            row = {"material": source.name, "database": source.database,
                   "half": source.half or "own", "scene": labels["scene"], "fit": fit,
                   **WORST, **scores.get(fit, {})}
            if labels["scene"] == "sphere":
                row.update({f"{environment}_psnr_db": scored.get((source.name, fit, environment))
                            for environment in (BUILT_IN, "probe")})
            rows.append(row)
    return rows


def _pictures(folder):
    return dict(numpy.load(folder / "pictures.npz"))


def _agreement_rows(results):
    """Our pictures beside Mitsuba's."""
    ours = {(r.labels["material"], r.labels["scene"], r.labels["kind"]): r.folder for r in results
            if r.labels.get("seed", 1) == 1 and r.labels.get("kind") in ("render", "whole")
            and r.folder}
    rows = []
    for result in results:
        labels = result.labels
        if labels.get("kind") != "mitsuba" or not result.folder:
            continue
        theirs = _pictures(result.folder)
        kind = "whole" if "plugin" in theirs else "render"
        folder = ours.get((labels["material"], labels["scene"], kind))
        if not folder:
            continue
        own = _pictures(folder)
        counts = own["share"] > 0
        factor = pictures.exposure(own["measured"], counts)

        def shown(picture, counts=counts, factor=factor):
            return pictures.encoded(picture * factor)[counts]
        row = {"material": labels["material"], "scene": labels["scene"],
               "noise_db": pictures.psnr(shown(theirs["measured"]), shown(theirs["again"]))}
        for name, of in (("measured_db", "measured"), ("fitted_db", SHARED),
                         ("plugin_db", "plugin")):
            if of in theirs:
                row[name] = pictures.psnr(shown(own["measured" if of == "plugin" else of]),
                                          shown(theirs[of]))
        if SHARED in theirs:
            row["psnr_db"] = pictures.psnr(shown(own["measured"]), shown(own[SHARED]))
            row["their_psnr_db"] = pictures.psnr(shown(theirs["measured"]), shown(theirs[SHARED]))
        rows.append(row)
    return rows


def _factor_rows(results):
    """D, F and G of the fits of FACTORS, in the order of the entries."""
    rows = []
    for result in results:
        if result.labels.get("run") not in FACTORS or not result.folder:
            continue
        model = lobes.Model.read(result.folder / "model.json")
        for factor in ("D", "F", "G"):
            for table, values in enumerate(getattr(model, factor)):
                rows += [{"material": result.labels["material"], "run": result.labels["run"],
                          "factor": factor, "table": table, "entry": k, "value": float(value)}
                         for k, value in enumerate(values)]
    return rows


def _beside(chosen):
    """A page of rows [(caption, folder)]: measured and fitted, with the PSNR of each."""
    rows = []
    for caption, folder in chosen:
        of = _pictures(folder)
        scores = json.loads((folder / "scores.json").read_text())
        factor = pictures.exposure(of["measured"], of["share"] > 0)
        rows.append((caption, [
            (pictures.encoded(of[name] * factor),
             name + (f"\n{scores[name]['psnr_db']:.1f} dB" if name in scores else ""))
            for name in ("measured", SHARED, INDEPENDENT, BIVARIATE)]))
    return pictures.side_by_side(rows)


def _best_and_worst(rows, results, scene):
    """The page of the two materials whose shared fits look best, and the two that look worst."""
    folder_of = {r.labels["material"]: r.folder for r in results if r.folder and
                 (r.labels.get("kind"), r.labels.get("seed"), r.labels.get("scene"))
                 == ("render", 1, scene)}
    order = sorted((row["psnr_db"], row["material"]) for row in rows
                   if (row["fit"], row["scene"]) == (SHARED, scene)
                   and row["material"] in folder_of)
    ends = order[:-3:-1] + order[1::-1] if len(order) > 3 else order[::-1]
    return _beside([(name, folder_of[name]) for _, name in ends]) if ends else None


def tabulate(setting, results):
    """renders, published: a row for each picture of a fit, and of a published model; noise, agreement, factors:
    README.md; aims."""
    source_of = {source.name: source for source in setting.sources}
    folder_of = {(r.labels["material"], r.labels["scene"], r.labels["seed"]): r.folder
                 for r in results if r.labels.get("kind") == "render" and r.folder}
    rows = _render_rows(setting, results, source_of)
    products = {"renders": [row for row in rows if row["fit"] not in PUBLISHED],
                "published": [row for row in rows if row["fit"] in PUBLISHED], "noise": noise.rows(folder_of, "measured"),
                "factors": _factor_rows(results), "agreement": _agreement_rows(results),
                "aims": [{"database": database, "median": of}
                         for database, of in setting.manifest["aims"].items()]}
    for scene in dict.fromkeys(row["scene"] for row in rows):
        if page := _best_and_worst(rows, results, scene):
            products[f"{scene}.jpg"] = page
    return products


# --- texts and pictures ---------------------------------------------------------------------------


def _order(rows):
    """The fits, our own first."""
    there = list(dict.fromkeys(row["fit"] for row in rows))
    first = [SHARED, INDEPENDENT]
    return [*(name for name in first if name in there),
            *(name for name in there if name not in first)]


def _summary_table(rows, aims):
    aim_of = {aim["database"]: aim["median"] for aim in aims}
    lines = []
    for (scene, database), part in tables.groups(rows, "scene", "database").items():
        of_fit = tables.groups(part, "fit")
        for fit in _order(part):
            of = of_fit[fit]
            lost = sum(not math.isfinite(row["flip"] or 0) for row in of)
            aim = aim_of.get(database)
            lines.append([scene, database, fit, tables.count(len(of), lost),
                          tables.quartiles([row["psnr_db"] for row in of], ".1f"),
                          f"{min(row['psnr_db'] for row in of):.1f}",
                          f"{aim:g}" if aim and (scene, fit) == ("sphere", SHARED) else "",
                          tables.quartiles([row["linear_psnr_db"] for row in of], ".1f"),
                          tables.quartiles([row["flip"] for row in of], ".3f")])
    return tables.markdown(["scene", "database", "fit", "n", "PSNR dB", "least",
                            "median asked for", "PSNR dB, linear", "FLIP"], lines)


def _against_table(rows):
    """The shared fits against each of the others, material by material."""
    lines = []
    for (scene, database), part in tables.groups(rows, "scene", "database").items():
        at = {(row["material"], row["fit"]): row for row in part}
        for fit in _order(part):
            pairs = [(at[name, SHARED], row) for (name, of), row in at.items()
                     if of == fit and (name, SHARED) in at]
            if fit == SHARED or not pairs:
                continue
            more = [a["psnr_db"] - b["psnr_db"] for a, b in pairs]
            known = [x for x in more if math.isfinite(x)]
            flips = [(a["flip"], b["flip"]) for a, b in pairs if a["flip"] is not None]
            loses = sorted(a["material"] for a, b in pairs if not a["psnr_db"] > b["psnr_db"])
            named = f": {', '.join(loses)}" if 0 < len(loses) <= 5 else ""
            lines.append([
                scene, database, fit, str(len(pairs)),
                f"{100 * (1 - len(loses) / len(pairs)):.0f} %",
                tables.quartiles(known, "+.1f"),
                f"{min(known):+.1f} to {max(known):+.1f}" if known else "–",
                f"{100 * sum(a < b for a, b in flips) / len(flips):.0f} %" if flips else "–",
                f"{len(loses)}{named}"])
    return tables.markdown(["scene", "database", "against", "n", "shared is better on",
                            "PSNR dB more", "range", "FLIP is lower on", "not better on"], lines)


def _rank_table(rows):
    """Compares the order of the materials by the program's own measure with that by the renderer."""
    lines = []
    sphere = [row for row in rows if row["scene"] == "sphere"]
    databases = {"all": sphere, **tables.groups(sphere, "database")}
    for environment, (database, part), fit in itertools.product(
            (BUILT_IN, "probe"), databases.items(), (SHARED, INDEPENDENT)):
        known = [(row[f"{environment}_psnr_db"], row["psnr_db"]) for row in part
                 if row["fit"] == fit and row.get(f"{environment}_psnr_db") is not None
                 and math.isfinite(row["psnr_db"])]
        if len(known) > 2:
            lines.append([environment, database, fit, str(len(known)),
                          f"{stats.rank_correlation(*zip(*known)):.3f}",
                          tables.quartiles([b - a for a, b in known], "+.1f")])
    return tables.markdown(["lights of `trilobe score`", "database", "fit", "n",
                            "rank correlation", "PSNR dB more in the renderer"], lines)


def _disagree_table(rows):
    """The materials on which the program's own measure and the renderer are furthest apart."""
    column = "probe_psnr_db" if any(row.get("probe_psnr_db") is not None for row in rows) \
        else f"{BUILT_IN}_psnr_db"
    known = [row for row in rows if (row["scene"], row["fit"]) == ("sphere", SHARED)
             and row.get(column) is not None and math.isfinite(row["psnr_db"])]
    known.sort(key=lambda row: -abs(row["psnr_db"] - row[column]))
    return tables.markdown(
        ["material", "database", "PSNR dB by `trilobe score`", "in the renderer"],
        [[row["material"], row["database"], f"{row[column]:.1f}", f"{row['psnr_db']:.1f}"]
         for row in known[:10]])


def _agreement_table(rows):
    def cell(row, name):
        return "" if row.get(name) is None else f"{row[name]:.1f}"
    return tables.markdown(
        ["material", "scene", "two pictures by Mitsuba, dB apart", "measured: ours and Mitsuba's",
         "fitted: ours and Mitsuba's", "Mitsuba's own reader of the file",
         "PSNR of the fit, ours", "Mitsuba's"],
        [[row["material"], row["scene"], *(cell(row, name) for name in (
            "noise_db", "measured_db", "fitted_db", "plugin_db", "psnr_db", "their_psnr_db"))]
         for row in rows])


def _materials_table(rows):
    fitted, lines = _order(rows), []
    for (scene, database, name), of in sorted(
            tables.groups(rows, "scene", "database", "material").items()):
        at = {row["fit"]: row for row in of}
        lines.append([scene, database, name, *(f"{at[fit]['psnr_db']:.1f}" if fit in at else ""
                                               for fit in fitted)])
    return tables.markdown(["scene", "database", "material", *fitted], lines)


def _psnr_figure(rows):
    """The paper's Fig. 3: a panel for each scene and database, materials by the one-lobe fit."""
    from lab import plots
    groups = tables.groups(rows, "scene", "database")
    widths = [max(4, len({row["material"] for row in of})) for of in groups.values()]
    scenes = list(dict.fromkeys(scene for scene, _ in groups))
    databases = sorted({database for _, database in groups})
    width_of = {database: max(width for (_, of), width in zip(groups, widths) if of == database)
                for database in databases}
    figure, panels = plots.plt.subplots(
        len(scenes), len(databases), squeeze=False, sharey=True,
        figsize=(3 + 0.19 * sum(width_of.values()), 4.4 * len(scenes)),
        gridspec_kw={"width_ratios": [width_of[database] for database in databases]})
    fitted = [fit for fit in _order(rows) if fit not in FACTORS]
    colours = (plots.BLACK, plots.VERMILION, plots.ORANGE, plots.BLUE, plots.GREEN, plots.PURPLE,
               plots.SKY, plots.GREY)
    styles = dict(zip(fitted, zip(itertools.cycle(colours), itertools.cycle("os^Dv*PXd<>"))))
    for line, scene in zip(panels, scenes):
        for axes, database in zip(line, databases):
            part = groups.get((scene, database), [])
            at = {(row["material"], row["fit"]): row["psnr_db"] for row in part}
            names = sorted({row["material"] for row in part},
                           key=lambda name, at=at: at.get((name, INDEPENDENT), -math.inf))
            for fit in fitted:
                known = [(x, at[name, fit]) for x, name in enumerate(names)
                         if math.isfinite(at.get((name, fit), math.inf))]
                colour, marker = styles[fit]
                lines = "-" if fit in (SHARED, INDEPENDENT, BIVARIATE) else ""
                axes.plot([x for x, _ in known], [y for _, y in known], marker=marker,
                          linestyle=lines, linewidth=1, color=colour, markersize=4,
                          label=fit, zorder=3 if fit == SHARED else 2)
            axes.set_xticks(range(len(names)), names, rotation=90, fontsize=7)
            axes.set(title=f"{database}, {scene}", xlim=(-0.7, len(names) - 0.3))
        line[0].set_ylabel("PSNR (dB), more is better")
    plots.legend_above(figure, max(panels.flat, key=lambda axes: len(
        axes.get_legend_handles_labels()[1])))
    return figure


def _factors_figure(rows):
    """The paper's Fig. 5: D, F and G of a material in a row, with and without the filter."""
    from lab import plots
    names = list(dict.fromkeys(row["material"] for row in rows))
    figure, panels = plots.plt.subplots(len(names), 3, squeeze=False,
                                        figsize=(13, 3 * len(names)))
    for line, name in zip(panels, names):
        for axes, factor in zip(line, ("D", "F", "G")):
            of = [row for row in rows if (row["material"], row["factor"]) == (name, factor)]
            size = 1 + max(row["entry"] for row in of)
            places = (numpy.arange(size) + 0.5) / size
            theta = 90 * (places ** 2 if factor == "D" else places)
            colours = (("#CC3311", plots.GREEN, plots.BLUE) if factor == "F"
                       else (plots.BLACK, plots.VERMILION, plots.SKY))
            for (run, table), entries in tables.groups(of, "run", "table").items():
                values = numpy.array([row["value"] for row in entries])
                part = "RGB"[table] if factor == "F" else f"lobe {table + 1}"
                axes.plot(theta, numpy.where(values > 0, values, numpy.nan) if factor == "D"
                          else values, color=colours[table % 3], linewidth=1.3,
                          linestyle="--" if FACTORS[run] else "-",
                          label=part + (", filtered" if FACTORS[run] else ""))
            axes.set(title=f"{name}: {factor}", xlabel={"D": "θh (°)", "F": "θd (°)",
                                                        "G": "θ (°)"}[factor])
            if factor == "D":
                axes.set_yscale("log")
                axes.set_ylim(bottom=max(1e-6, axes.get_ylim()[0]))
            axes.legend(fontsize=7)
    return figure


def draw(drawn, _):
    rows = drawn["renders"] + drawn["published"]
    products = {"psnr": _psnr_figure(rows), "summary.md": _summary_table(rows, drawn["aims"]),
                "against.md": _against_table(rows), "rank.md": _rank_table(rows),
                "disagree.md": _disagree_table(rows), "materials.md": _materials_table(rows)}
    if drawn.get("noise"):
        products["noise.md"] = noise.table(drawn["noise"], "a measurement")
    if drawn.get("agreement"):
        products["agreement.md"] = _agreement_table(drawn["agreement"])
    if drawn.get("factors"):
        products["factors"] = _factors_figure(drawn["factors"])
    return products
