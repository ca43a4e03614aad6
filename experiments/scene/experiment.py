"""Scenes: see README.md beside this file."""
import json
import math
import pathlib

from lab import fits, materials, tables
from lab.units import FOLDER, Product, Unit

FULL = "full"  # instead of a budget: nothing left out
FINEST = 0.1  # %; below, the axis of rises is linear


def _absolute(path):
    """A scene file takes paths as relative to itself."""
    return path if path.startswith("synth:") else str(pathlib.Path(path).resolve())


def units(setting):
    """The scene's fit for each budget, which reuses nothing, and its comparison with full fits.

    The full fits are those of the first comparison, which the others take out of its cache.
    """
    budgets = [f"{budget:g}" for budget in setting.manifest["budgets"]]
    flags = fits.words(setting.manifest["flags"])
    sources = materials.named(setting.manifest["materials"], setting.sources)
    scenes = Unit("scene/files", pathlib.Path(__file__).with_name("write_scenes"),
                  (FOLDER, ",".join(budgets),
                   *(f"{source.name}={_absolute(source.path)}" for source in sources)),
                  f"rise-{budgets[-1]}.json", labels={"run": "files"})
    fitted, compared = [], []
    for budget in budgets:
        models = Unit(f"scene/rise-{budget}/models", setting.program(),
                      ("fit", "--scene", Product(scenes, f"rise-{budget}.json"),
                       f"--out={FOLDER}", "--nocache", *flags), "plan.json",
                      labels={"run": "models"})
        cache = Product(compared[0], "cache") if compared else f"{FOLDER}/cache"
        fitted.append(models)
        compared.append(Unit(f"scene/rise-{budget}/compare", setting.program(),
                             ("compare", Product(models, "."), "--json", "--cache", cache, *flags),
                             labels={"run": "compare", "budget": float(budget)}))
    return [scenes, *fitted, *compared]


# --- tables ---------------------------------------------------------------------------------------


def _material_rows(budget, compared, side):
    return [{"material": of["name"], "budget": budget,
             **{key: of[side][key] for key in ("parameters", "bytes", "objective", "psnr_db")},
             "relative_rise": 0.0 if side == FULL else of["relative_rise"]}
            for of in compared["materials"]]


def _scene_row(budget, compared, side, rows):
    of = compared["all"]
    return {"budget": budget, "materials": len(rows), "parameters": of["parameters"][side],
            "bytes": of["bytes"][side],
            "mean_relative_rise": 0.0 if side == FULL else of["mean_relative_rise"],
            "largest_relative_rise": max(row["relative_rise"] for row in rows),
            "mean_psnr_db": of["mean_psnr_db"][side]}


def tabulate(_, results):
    """materials: of each material, full and by budget; scene: the same of all materials."""
    of_material, of_scene = [], []
    for result in results:
        if result.labels["run"] != "compare":
            continue
        budget = result.labels["budget"]
        if not result.folder:
            of_scene.append({"budget": budget})
            continue
        compared = json.loads((result.folder / "stdout.txt").read_text())
        sides = [(budget, "pruned")] if of_material else [(FULL, FULL), (budget, "pruned")]
        for name, side in sides:
            rows = _material_rows(name, compared, side)
            of_material += rows
            of_scene.append(_scene_row(name, compared, side, rows))
    return {"materials": of_material, "scene": of_scene}


# --- texts and pictures ---------------------------------------------------------------------------


def _percent(fraction):
    return f"{100 * fraction:.3g} %"


def _budget(row):
    return FULL if row["budget"] == FULL else _percent(row["budget"])


def _scene_table(rows):
    whole = next((row for row in rows if row["budget"] == FULL), None)
    lines = []
    for row in rows:
        if row.get("parameters") is None:
            lines.append([_budget(row), "missing", *[""] * 5])
            continue
        lines.append([_budget(row), str(row["parameters"]), str(row["bytes"]),
                      f"{whole['parameters'] / row['parameters']:.1f}",
                      _percent(row["mean_relative_rise"]), _percent(row["largest_relative_rise"]),
                      f"{row['mean_psnr_db']:.2f}"])
    return tables.markdown(["rise of E allowed", "parameters", "bytes", "times fewer", "rise of E, mean",
                            "largest", "PSNR dB, mean"], lines)


def _materials_table(rows):
    lines = []
    for name, of in tables.groups(rows, "material").items():
        for row in of:
            lines.append([name, _budget(row), str(row["parameters"]), str(row["bytes"]),
                          _percent(row["relative_rise"]), f"{row['objective']:.5g}",
                          f"{row['psnr_db']:.2f}"])
    return tables.markdown(["material", "rise of E allowed", "parameters", "bytes", "rise of E", "E",
                            "PSNR dB"], lines)


def _label_points(axes, points):
    """Writes the budget of each point, (x, y, text), beside it; budgets that meet share a label."""
    to_axes = axes.transScale + axes.transLimits  # from data to fractions of the axes
    shared = []  # [place in the axes, point, texts]
    for x, y, text in points:
        place = to_axes.transform((x, y))
        near = next((label for label in shared if math.dist(label[0], place) < 0.09), None)
        if near:
            near[2].append(text)
        else:
            shared.append((place, (x, y), [text]))
    for _, point, texts in shared:
        axes.annotate(", ".join(texts) + " %", point, xytext=(6, 3), textcoords="offset points",
                      fontsize=8, annotation_clip=False)


def _figure(rows, budgets):
    """A panel a material: the rise of E over its bytes, from the full model to larger budgets."""
    from lab import plots
    by_material = tables.groups(rows, "material")
    columns = min(5, len(by_material))
    lines = math.ceil(len(by_material) / columns)
    figure, panels = plots.plt.subplots(lines, columns, squeeze=False, sharex=True, sharey=True,
                                        figsize=(2.8 * columns + 0.6, 2.9 * lines + 0.5))
    rises = [100 * row["relative_rise"] for row in rows]
    values = [row["bytes"] for row in rows]
    ticks = [0, *(100 * budget for budget in budgets)]
    if min(rises) < -FINEST:
        ticks.insert(0, float(f"{min(rises):.1g}"))
    for axes, (name, of) in zip(panels.flat, by_material.items()):
        axes.set_xscale("log")
        axes.set_yscale("symlog", linthresh=FINEST, linscale=0.5)
        axes.set_xlim(0.7 * min(values), 2.2 * max(values))
        axes.set_ylim(min(-0.5 * FINEST, 1.5 * min(rises)), 1.8 * max(*rises, *ticks))
        axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.set_yticks([], minor=True)
        plots.plain_numbers(axes.xaxis)
        points = [(row["bytes"], 100 * row["relative_rise"]) for row in of]
        axes.plot(*zip(*points[1:]), "o-", color=plots.BLUE, markersize=4.5)
        axes.plot(*points[0], "o", color=plots.VERMILION, markerfacecolor="white", markersize=7,
                  markeredgewidth=2)
        axes.annotate(FULL, points[0], xytext=(7, -3), textcoords="offset points", fontsize=8,
                      color=plots.VERMILION)
        _label_points(axes, [(*point, f"{100 * row['budget']:g}")
                             for point, row in zip(points[1:], of[1:])])
        axes.set_title(name, fontsize=10)
    for axes in panels.flat[len(by_material):]:
        axes.set_axis_off()
    figure.supxlabel("bytes of the model's parameters", fontsize=10)
    figure.supylabel("rise of E (%)", fontsize=10)
    return figure


def draw(drawn, _):
    rows, of_scene = drawn["materials"], drawn["scene"]
    products = {"scene.md": _scene_table(of_scene), "materials.md": _materials_table(rows)}
    if rows:
        budgets = [row["budget"] for row in of_scene if row["budget"] != FULL]
        products["bytes"] = _figure(rows, budgets)
    return products
