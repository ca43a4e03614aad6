"""Beyond the data: see README.md beside this file."""
import json
import math
import pathlib

from lab import corruptions, fits, materials, tables
from lab.units import FOLDER, Product, Unit

FACTOR = 2.0  # an estimate of Delta E within it is right
SEEN = 2.0  # Delta E that nobody calls the same
SAMPLES, TABLE = "samples.csv", "given.binary"
HERE = pathlib.Path(__file__).parent
MODULES = (HERE / "guesses.py", HERE.parent / "lab" / "merl.py")
FITTED = "default"  # the rule that is a fit by the defaults


def _table(setting, source, name):
    """The table without what a corruption hides, or without what the table of "mask" has not, as a Product."""
    program = str(setting.program())
    file = f"{FOLDER}/{TABLE}"
    if name == "mask":
        command = (HERE / "hide_as", (program, str(setting.place("mask")), source.path, file))
    else:
        command = (setting.program(), ("convert", source.path, f"--corrupt={name}", f"--out={file}"))
    return Product(Unit(f"given/{source.name}/{fits.file_name(name)}", *command, TABLE,
                        modules=MODULES, labels={"material": source.name, "given": name}), TABLE)


def _samples(setting, source, pattern, count):
    """A few samples of the table, as a Product. Which they are may depend on what is read of those before."""
    flags = fits.words({"corrupt": f"noise:{setting.manifest['noise']}"}) if pattern.startswith("next_") else []
    arguments = (str(setting.program()), source.path, pattern, str(count), f"{FOLDER}/{SAMPLES}", *flags)
    return Product(Unit(f"samples/{source.name}/{pattern}-{count}", HERE / "sample_directions", arguments, SAMPLES,
                        labels={"material": source.name, "given": f"{pattern}:{count}"}), SAMPLES)


def _given(setting, source, part):
    """Data that a set of the manifest gives of a source to each rule: [(name, seed of the noise, the file, flags of a
    fit, the table as a Product or None)]."""
    made = []
    names = corruptions.of_kinds(part.get("hidden", {})) if part.get("clean", True) else []
    names += ["mask"] if part.get("mask") and setting.manifest["mask"] else []
    for name in names:
        if name == "mask":
            table = _table(setting, source, name)
            made.append((name, 1, table, {}, table))
        else:
            table = _table(setting, source, name) if part.get("others") and name != corruptions.CLEAN else None
            made.append((name, 1, source.path, corruptions.flags(name), table))
    for pattern, counts in part.get("kept", {}).items():
        for count in counts:
            file = _samples(setting, source, pattern, count)
            made += [(f"{pattern}:{count}", seed, file,
                      {"corrupt": f"noise:{setting.manifest['noise']}", "data_seed": seed}, None)
                     for seed in range(1, part.get("data_seeds", setting.manifest["data_seeds"]) + 1)]
    return made


def _fitted(setting, source, name, seed, file, flags):
    """A fit, its score on the whole table, and the light that it reflects."""
    labels = {"material": source.name, "given": name, "data_seed": seed, "rule": FITTED}
    place = f"beyond/{source.name}/{fits.file_name(name)}-{seed}"
    fitted = Unit(place, setting.program(),
                  ("fit", file, f"--out={FOLDER}", "--noplots", *fits.words({**setting.manifest["flags"], **flags})),
                  "report.json", labels=labels)
    model = Product(fitted, "model.json")
    return [*fitted.needs, fitted,
            Unit(f"{place}-whole", setting.program(), ("score", model, source.path, "--json", "--threads=1"),
                 labels={**labels, "of": "whole"}),
            Unit(f"{place}-light", setting.program(), ("info", model, "--json"), labels={**labels, "of": "light"})]


def _guessed(setting, source, name, rule, table):
    """The score of another rule's guess."""
    others = [other.path for other in setting.sources if other.name != source.name and other.database != "RGL"]
    if rule == "components" and len(others) < setting.manifest["least_others"]:
        return []
    return [table.unit,
            Unit(f"beyond/{source.name}/{fits.file_name(name)}-{rule}", HERE / "score_guess",
                 (str(setting.program()), rule, table, source.path, *(others if rule == "components" else ())),
                 modules=MODULES,
                 labels={"material": source.name, "given": name, "data_seed": 1, "rule": rule, "of": "whole"})]


def units(setting):
    """Fits to a part of each table, what other rules guess of the rest, and the score of each on all of it."""
    made = []
    for part in setting.manifest["sets"]:
        for source in setting.every(part["every"]):
            for name, seed, file, flags, table in _given(setting, source, part):
                made += _fitted(setting, source, name, seed, file, flags)
                for rule in part.get("others", []) if table else []:
                    made += _guessed(setting, source, name, rule, table)
    for source in materials.find(setting.manifest["nodes"]):
        made += _fitted(setting, source, "nodes:75", 1, source.path, {})
    return list({unit.key: unit for unit in made}.values())


def _looks(scored):
    """PSNR and Delta E of the whole sphere; an anisotropic material's formula is known beyond its nodes."""
    appearance = scored["appearance"]
    return (appearance["from_formula"] or {}).get("whole", appearance)


def tabulate(setting, results):
    """A row for each fit or guess: the whole sphere, and what a fit itself says of it."""
    of = {}
    for result in results:
        if result.folder and "rule" in result.labels:
            labels = result.labels
            key = (labels["material"], labels["given"], labels["data_seed"], labels["rule"])
            of.setdefault(key, {})[labels.get("of", "fit")] = result
    rows = []
    for (material, given, seed, rule), parts in of.items():
        if "whole" not in parts or (rule == FITTED and set(parts) != {"fit", "whole", "light"}):
            continue
        looks = _looks(json.loads((parts["whole"].folder / "stdout.txt").read_text()))
        row = {"material": material, "given": given, "data_seed": seed, "rule": rule,
               "psnr_db": looks["psnr_db"], "delta_e": looks["mean_delta_e"]}
        if rule == FITTED:
            verdict = json.loads((parts["fit"].folder / "report.json").read_text())["verdict"]
            albedo = json.loads((parts["light"].folder / "stdout.txt").read_text())["albedo"]
            estimate = verdict["whole"] or {}
            row.update({"measured_share": verdict["measured_share"],
                        "estimated_delta_e": estimate.get("mean_delta_e"),
                        "estimated_psnr_db": estimate.get("psnr_db"),
                        "praised": int(verdict["visibility"] == "none" and not estimate),
                        "largest_albedo": _largest(albedo)})
        rows.append(row)
    return {"whole": rows}


def _largest(albedo):
    """The largest albedo in a nested list or object."""
    if isinstance(albedo, dict):
        albedo = [value for name, value in albedo.items() if "theta" not in name and "deg" not in name]
    if isinstance(albedo, list):
        return max((_largest(part) for part in albedo), default=-math.inf)
    return float(albedo) if isinstance(albedo, (int, float)) else -math.inf


def _summary(rows):
    """A line for what was given to the fits."""
    lines = []
    for given, of in tables.groups([row for row in rows if row["rule"] == FITTED], "given").items():
        known = [row["estimated_delta_e"] / row["delta_e"] for row in of if row["estimated_delta_e"]]
        right = sum(1 / FACTOR <= ratio <= FACTOR for ratio in known)
        lines.append([given, str(len(of)), tables.quartiles([100 * row["measured_share"] for row in of], ".0f"),
                      tables.quartiles([row["psnr_db"] for row in of], ".1f"),
                      f"{min(row['psnr_db'] for row in of):.1f}",
                      tables.quartiles([row["delta_e"] for row in of], ".2f"),
                      f"{right} of {len(known)}" if known else "",
                      str(sum(row["praised"] and row["delta_e"] > SEEN for row in of)),
                      f"{max(row['largest_albedo'] for row in of):.2f}"])
    return tables.markdown(["given", "fits", "measured, %", "PSNR of the whole, dB", "least", "ΔE",
                            "estimate within a factor of 2", "praised above ΔE 2", "largest albedo"], lines)


def _rules(rows):
    """A line for each rule and what was given to all of them."""
    lines = []
    given = {row["given"] for row in rows if row["rule"] != FITTED}
    for (name, rule), of in tables.groups([row for row in rows if row["given"] in given], "given", "rule").items():
        lines.append([name, rule, str(len(of)),
                      tables.quartiles([row["psnr_db"] for row in of], ".1f"),
                      f"{min(row['psnr_db'] for row in of):.1f}",
                      tables.quartiles([row["delta_e"] for row in of], ".2f"),
                      f"{max(row['delta_e'] for row in of):.2f}"])
    return tables.markdown(["given", "rule", "tables", "PSNR of the whole, dB", "least", "ΔE", "largest"], lines)


def _figure(rows):
    """Estimated against true Delta E."""
    from lab import plots
    ticker = plots.matplotlib.ticker
    figure, axes = plots.plt.subplots(figsize=(5.5, 5))
    told = [row for row in rows if row.get("estimated_delta_e") and row["delta_e"] > 0]
    styles = [(marker, colour) for marker in "o^s" for colour in plots.SERIES]
    for (given, of), (marker, colour) in zip(tables.groups(told, "given").items(), styles):
        axes.loglog([row["delta_e"] for row in of], [row["estimated_delta_e"] for row in of], marker, color=colour,
                    label=given, markersize=5)
    ends = [min([row["delta_e"] for row in told], default=0.1), max([row["delta_e"] for row in told], default=10)]
    for factor in (1 / FACTOR, 1, FACTOR):
        axes.loglog(ends, [factor * end for end in ends], color=plots.GREY, linewidth=2 if factor == 1 else 1)
    axes.set(xlabel="ΔE of the whole sphere", ylabel="ΔE that the fit estimates")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(ticker.FormatStrFormatter("%g"))
        axis.set_minor_formatter(ticker.NullFormatter())
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3)
    return figure


def draw(drawn, _):
    rows = drawn["whole"]
    if not rows:
        return {}
    return {"summary.md": _summary(rows), "rules.md": _rules(rows), "estimate": _figure(rows)}
