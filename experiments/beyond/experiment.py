"""Beyond the data: see README.md beside this file."""
import json
import math
import pathlib

from lab import corruptions, fits, tables
from lab.units import FOLDER, Product, Unit

FACTOR = 2.0  # an estimate of Delta E within it is right
SEEN = 2.0  # Delta E that nobody calls the same
SAMPLES = "samples.csv"


def _measured(setting, source):
    """What each fit is given: [(what is hidden or kept, seed of the noise, the file, flags)]."""
    given = [(name, 1, source.path, corruptions.flags(name))
             for name in corruptions.of_kinds(setting.manifest["hidden"])]
    for pattern, counts in setting.manifest["kept"].items():
        for count in counts:
            sampled = Unit(f"samples/{source.name}/{pattern}-{count}",
                           pathlib.Path(__file__).with_name("sample_directions"),
                           (str(setting.program()), source.path, pattern, str(count), f"{FOLDER}/{SAMPLES}"), SAMPLES,
                           labels={"material": source.name, "given": "samples"})
            given += [(f"{pattern}:{count}", seed, Product(sampled, SAMPLES),
                       {"corrupt": f"noise:{setting.manifest['noise']}", "data_seed": seed})
                      for seed in range(1, setting.manifest["data_seeds"] + 1)]
    return given


def units(setting):
    """Fits to a part of each table, and the score of each on all of it."""
    made = []
    for source in setting.every(setting.manifest["every"]):
        for name, seed, file, flags in _measured(setting, source):
            for way, own in setting.manifest["ways"].items():
                labels = {"material": source.name, "given": name, "data_seed": seed, "way": way}
                words = fits.words({**setting.manifest["flags"], **flags, **own})
                place = f"beyond/{source.name}/{fits.file_name(name)}-{seed}-{fits.file_name(way)}"
                fitted = Unit(place, setting.program(),
                              ("fit", file, f"--out={FOLDER}", "--noplots", *words), "report.json", labels=labels)
                model = Product(fitted, "model.json")
                made += [*fitted.needs, fitted,
                         Unit(f"{place}-whole", setting.program(),
                              ("score", model, source.path, "--json", "--threads=1"),
                              labels={**labels, "of": "whole"}),
                         Unit(f"{place}-light", setting.program(), ("info", model, "--json"),
                              labels={**labels, "of": "light"})]
    return list({unit.key: unit for unit in made}.values())


def tabulate(setting, results):
    """A row for each fit: the whole sphere, and what the fit itself says of it."""
    of = {}
    for result in results:
        if result.folder and "way" in result.labels:
            labels = result.labels
            key = (labels["material"], labels["given"], labels["data_seed"], labels["way"])
            of.setdefault(key, {})[labels.get("of", "fit")] = result
    rows = []
    for (material, given, seed, way), parts in of.items():
        if set(parts) != {"fit", "whole", "light"}:
            continue
        verdict = json.loads((parts["fit"].folder / "report.json").read_text())["verdict"]
        looks = json.loads((parts["whole"].folder / "stdout.txt").read_text())["appearance"]
        albedo = json.loads((parts["light"].folder / "stdout.txt").read_text())["albedo"]
        estimate = verdict["whole"] or {}
        rows.append({"material": material, "given": given, "data_seed": seed, "way": way,
                     "measured_share": verdict["measured_share"],
                     "psnr_db": looks["psnr_db"], "delta_e": looks["mean_delta_e"],
                     "estimated_delta_e": estimate.get("mean_delta_e"), "estimated_psnr_db": estimate.get("psnr_db"),
                     "praised": int(verdict["visibility"] == "none" and not estimate),
                     "largest_albedo": _largest(albedo)})
    return {"whole": rows}


def _largest(albedo):
    """Of the numbers in a nested list or object."""
    if isinstance(albedo, dict):
        albedo = [value for name, value in albedo.items() if "theta" not in name and "deg" not in name]
    if isinstance(albedo, list):
        return max((_largest(part) for part in albedo), default=-math.inf)
    return float(albedo) if isinstance(albedo, (int, float)) else -math.inf


def _summary(rows):
    """A line for what was given to each way of fitting."""
    lines = []
    for (given, way), of in tables.groups(rows, "given", "way").items():
        known = [row["estimated_delta_e"] / row["delta_e"] for row in of if row["estimated_delta_e"]]
        right = sum(1 / FACTOR <= ratio <= FACTOR for ratio in known)
        lines.append([given, way, str(len(of)), tables.quartiles([100 * row["measured_share"] for row in of], ".0f"),
                      tables.quartiles([row["psnr_db"] for row in of], ".1f"),
                      f"{min(row['psnr_db'] for row in of):.1f}",
                      tables.quartiles([row["delta_e"] for row in of], ".2f"),
                      f"{right} of {len(known)}" if known else "",
                      str(sum(row["praised"] and row["delta_e"] > SEEN for row in of)),
                      f"{max(row['largest_albedo'] for row in of):.2f}"])
    return tables.markdown(["given", "way", "fits", "measured, %", "PSNR of the whole, dB", "least", "ΔE",
                            "estimate within a factor of 2", "praised above ΔE 2", "largest albedo"], lines)


def _figure(rows):
    """Estimated against true Delta E."""
    from lab import plots
    ticker = plots.matplotlib.ticker
    figure, axes = plots.plt.subplots(figsize=(5.5, 5))
    told = [row for row in rows if row["estimated_delta_e"] and row["delta_e"] > 0]
    for (given, of), colour in zip(tables.groups(told, "given").items(), plots.SERIES * 3):
        axes.loglog([row["delta_e"] for row in of], [row["estimated_delta_e"] for row in of], "o", color=colour,
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
    return {"summary.md": _summary(rows), "estimate": _figure(rows)} if rows else {}
