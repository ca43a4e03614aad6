"""Do scenes keep what they read, and no more? See README.md beside this file."""
import json
import pathlib

from lab import fits, materials, stats, tables
from lab.units import FOLDER, Product, Unit
from renderer import units as rendering

LUMINANCE = "luminance"
GRID = (90, 90, 180)  # bins of MERL's tables, and of those made from RGL's


def _source(path):
    """SOURCE,GRID of write_reads; a scene file takes paths as relative to itself."""
    grid = path.rsplit("@", 1)[1] if "@" in path else "x".join(map(str, GRID))
    return f"{path if path.startswith('synth:') else pathlib.Path(path).resolve()},{grid}"


def _renders(setting):
    """{name: its paths}: a sphere, and a mesh, which shadows itself, where one is given."""
    probe, mesh_probe, mesh = (setting.place(name) for name in ("probe", "mesh_probe", "mesh"))
    if probe or mesh:
        rendering.require_mitsuba()
    given = {"sphere": {"probe": probe}}
    if mesh:
        given["mesh"] = {"probe": mesh_probe, "shape": mesh}
    return {name: rendering.light_paths(setting, "reads", name,
                                        fits.words({k: v for k, v in flags.items() if v}), 1)
            for name, flags in given.items()}


def units(setting):
    """A run of `trilobe fit --scene` for each way to read the materials."""
    manifest = setting.manifest
    renders = _renders(setting)
    settings = {key: manifest[key] for key in ("pairs", "budget", "luminance_budgets", "seed")}
    sources = materials.named(setting.manifest["materials"], setting.sources)
    scenes = Unit("reads/scenes", pathlib.Path(__file__).with_name("write_reads"),
                  (FOLDER, json.dumps(settings),
                   *(f"{source.name}={_source(source.path)}" for source in sources),
                   "--paths", *(word for render in renders.items() for word in render)),
                  f"{LUMINANCE}.json", labels={"reads": ""})
    names = [*(f"pairs-{count}" for count in manifest["pairs"]), "share", "within", *renders,
             LUMINANCE]
    flags = fits.words(manifest["flags"])
    return [scenes] + [
        Unit(f"reads/{name}", setting.program(),
             ("fit", "--scene", Product(scenes, f"{name}.json"), f"--out={FOLDER}/models",
              f"--cache={FOLDER}/cache", "--threads=1", *flags),
             "models/plan.json", labels={"reads": name})
        for name in names]


# --- tables ---------------------------------------------------------------------------------------


def tabulate(_, results):
    """scenes: of each material and way to read it, what is kept and how it looks."""
    rows = []
    for result in results:
        if not result.labels["reads"] or not result.folder:
            continue
        plan = json.loads((result.folder / "models/plan.json").read_text())
        for of in plan["materials"]:
            rows.append({
                "reads": result.labels["reads"], "material": of["name"].split("~")[0],
                "budget": of["budget"]["mean_delta_e"], "judged_by": of["judged_by"],
                "samples": of["samples"]["used"], "parameters": of["parameters"]["pruned"],
                "full_parameters": of["parameters"]["full"], "lobes": of["lobes"],
                "mean_delta_e": of["mean_delta_e"]["pruned"],
                "full_mean_delta_e": of["mean_delta_e"]["full"],
                "misses_budget": int(of["misses_budget"]),
                "seconds": of["seconds"]["prune"]})
    return {"scenes": rows}


# --- texts and pictures ---------------------------------------------------------------------------


def _label(name):
    if name.startswith("pairs-"):
        count = name.split("-")[1]
        return "one pair" if count == "1" else f"{count} pairs"
    return {"within": "all within 60 degrees", "share": "a random 2 % of these bins",
            "sphere": "a rendered sphere", "mesh": "a rendered mesh in its own shadow"}[name]


def _reads_table(rows):
    lines = []
    for name, of in tables.groups([row for row in rows if row["reads"] != LUMINANCE], "reads").items():
        numbers = [row["parameters"] for row in of]
        errors = [row["mean_delta_e"] for row in of]
        lines.append([_label(name), f"{stats.median([row['samples'] for row in of]):.0f}",
                      f"{stats.median(numbers):g}", str(max(numbers)), str(max(row["lobes"] for row in of)),
                      f"{stats.median(errors):.2f}", f"{max(errors):.2f}",
                      str(sum(row["misses_budget"] for row in of))])
    return tables.markdown(["the scene reads", "samples, median", "numbers kept, median", "most", "lobes, most",
                            "ΔE, median", "most", "budget missed"], lines)


def _budgets_table(rows):
    of_luminance = [row for row in rows if row["reads"] == LUMINANCE]
    budgets = sorted({row["budget"] for row in of_luminance})
    lines = []
    for name, of in tables.groups(of_luminance, "material").items():
        kept = {row["budget"]: row["parameters"] for row in of}
        lines.append([name, *(str(kept.get(budget, "")) for budget in budgets),
                      f"{100 * (_growth(of) - 1):.0f} %"])
    return tables.markdown(["material", *(f"ΔE {budget:g}" for budget in budgets), "most that a looser budget adds"],
                           lines)


def _growth(of):
    """The largest factor by which a looser budget keeps more than a tighter one."""
    of = sorted(of, key=lambda row: row["budget"])
    return max([1.0, *(later["parameters"] / row["parameters"] for k, row in enumerate(of) for later in of[k + 1:])])


def _figure(rows):
    from lab import plots
    names = list(dict.fromkeys(row["reads"] for row in rows if row["reads"] != LUMINANCE))
    figure, (left, right) = plots.plt.subplots(1, 2, figsize=(10, 4), width_ratios=(1.6, 1))
    for name, of in tables.groups([row for row in rows if row["reads"] != LUMINANCE], "material").items():
        kept = {row["reads"]: row["parameters"] for row in of}
        left.plot(range(len(names)), [kept.get(each) for each in names], "o-", markersize=4, linewidth=1, label=name)
    left.set_xticks(range(len(names)), [_label(name) for name in names], rotation=35, ha="right", fontsize=8)
    for name, of in tables.groups([row for row in rows if row["reads"] == LUMINANCE], "material").items():
        of = sorted(of, key=lambda row: row["budget"])
        right.plot([row["budget"] for row in of], [row["parameters"] for row in of], "o-", markersize=4, linewidth=1)
    right.set_xlabel("budget, mean ΔE, in luminance", fontsize=9)
    right.set_visible(any(row["reads"] == LUMINANCE for row in rows))
    for axes in (left, right):
        axes.set_yscale("log")
        axes.set_ylim(1, 1000)
        axes.axhline(822, color="0.7", linewidth=1)
        plots.plain_numbers(axes.yaxis)
    left.set_ylabel("numbers kept of 822", fontsize=9)
    left.legend(fontsize=7, ncols=2)
    return figure


def draw(drawn, _):
    rows = drawn["scenes"]
    products = {"reads.md": _reads_table(rows)}
    if any(row["reads"] == LUMINANCE for row in rows):
        products["budgets.md"] = _budgets_table(rows)
    if rows:
        products["kept"] = _figure(rows)
    return products
