"""Sampling: see README.md beside this file."""
import json

import numpy
from PIL import Image

from lab import fits, stats, tables
from lab.units import FOLDER, Product, Unit
from renderer import pictures

SAMPLERS = {"cosine": "#999999", "GGX": "#D55E00", "eq8": "#56B4E9", "paper": "#0072B2", "trilobe": "#009E73"}
AT = 64  # samples a pixel, of the table
FIGURE_2 = (64, 128)  # the same, of the pictures


def units(setting):
    """Fits, and a sphere of each under each environment."""
    manifest = setting.manifest
    planned = fits.planned(setting)
    made = list(planned)
    for unit in planned:
        material = unit.labels["material"]
        for environment in manifest["environments"]:
            made.append(Unit(
                f"sampling/{material}/{environment}", setting.program("noise"),
                (Product(unit, "model.json"), f"--environment={environment}",
                 f"--size={manifest['size']}", f"--samples={manifest['samples']}",
                 f"--cosine_samples={manifest['cosine_samples']}",
                 f"--reference={manifest['reference']}", f"--out={FOLDER}/noise.json",
                 f"--pictures={FOLDER}"),
                product="noise.json",
                labels={"material": material, "environment": environment, "kind": "noise"}))
    return made


def _pictured(setting, results):
    """The page of the paper's Fig. 2: a line a material."""
    manifest = setting.manifest
    shown = [("reference", "reference"),
             (f"cosine-{manifest['cosine_samples']}", f"cosine, {manifest['cosine_samples']}"),
             *((f"{name}-{samples}", f"{title}, {samples}")
               for name, title in (("eq8", "paper, eq. 8"), ("paper", "paper, true widths"), ("trilobe", "trilobe"))
               for samples in FIGURE_2)]
    page = []
    for result in results:
        labels = result.labels
        if (labels.get("kind") != "noise" or not result.folder
                or labels["environment"] != manifest["environments"][-1]
                or labels["material"] not in manifest["pictured"]):
            continue
        line = []
        for name, title in shown:
            if not (result.folder / f"{name}.png").exists():  # eq. 8 of an anisotropic material
                continue
            with Image.open(result.folder / f"{name}.png") as image:
                line.append((numpy.asarray(image) / 255.0, title))
        page.append((labels["material"], line))
    return pictures.side_by_side(page, width=150) if page else None


def tabulate(setting, results):
    rows = []
    for result in results:
        if result.labels.get("kind") != "noise" or not result.folder:
            continue
        said = json.loads((result.folder / "noise.json").read_text())
        rows += [{"material": result.labels["material"],
                  "environment": result.labels["environment"], **row} for row in said["rows"]]
    products = {"noise": [row for row in rows if not row["with_lights"]],
                "noise_with_lights": [row for row in rows if row["with_lights"]]}
    if page := _pictured(setting, results):
        products["spheres.jpg"] = page
    return products


def _at(rows, sampler, samples, lights, key="relative_mse"):
    return {row["material"]: row[key] for row in rows
            if row["sampler"] == sampler and row["samples"] == samples
            and (str(row["with_lights"]).lower() == "true") == lights}


def _materials(rows):
    """A line a material: relative MSE at 64 samples of the BSDF alone, and with light samples."""
    lines = []
    for environment, of in tables.groups(rows, "environment").items():
        for material in dict.fromkeys(row["material"] for row in of):
            line = [environment, material]
            for lights in (False, True):
                errors = [_at(of, sampler, AT, lights).get(material) for sampler in SAMPLERS]
                line += ["–" if error is None else f"{error:.1e}" for error in errors]
            lines.append(line)
    return tables.markdown(["environment", "material", *SAMPLERS,
                            *(f"{sampler}, and lights" for sampler in SAMPLERS)], lines)


def _summary(rows):
    """Medians over the materials of ratios to trilobe's own sampling; eq. 8 is of isotropic ones."""
    lines = []
    for environment, of in tables.groups(rows, "environment").items():
        for lights in (False, True):
            own, own_s = (_at(of, "trilobe", AT, lights, key) for key in ("relative_mse", "seconds"))
            for sampler in SAMPLERS:
                other, seconds = (_at(of, sampler, AT, lights, key)
                                  for key in ("relative_mse", "seconds"))
                equal = [other[m] / own[m] for m in other]
                timed = [other[m] * seconds[m] / (own[m] * own_s[m]) for m in other]
                lines.append([environment, "BSDF and lights" if lights else "BSDF", sampler,
                              f"{stats.median(equal):.2g}", f"{min(equal):.2g}",
                              f"{max(equal):.2g}", f"{stats.median(timed):.2g}"])
    return tables.markdown(["environment", "samples of", "sampler",
                            f"relative MSE at {AT} samples, of trilobe's: median", "least", "most",
                            "at equal time, median"], lines)


def _curves(rows):
    from lab import plots
    panels = [(environment, lights)
              for environment in dict.fromkeys(row["environment"] for row in rows)
              for lights in (False, True)]
    figure, axes = plots.plt.subplots(1, len(panels), figsize=(3.4 * len(panels), 3.4),
                                      sharey=True, squeeze=False)
    for axis, (environment, lights) in zip(axes[0], panels):
        of = [row for row in rows if row["environment"] == environment
              and (str(row["with_lights"]).lower() == "true") == lights]
        for sampler, colour in SAMPLERS.items():
            points = sorted({int(row["samples"]) for row in of if row["sampler"] == sampler})
            axis.plot(points, [stats.median(_at(of, sampler, n, lights).values())
                               for n in points], color=colour, marker="o", markersize=3,
                      label=sampler)
        axis.set(xscale="log", yscale="log", xlabel="samples a pixel",
                 title=f"{environment}\n{'BSDF and lights' if lights else 'BSDF alone'}")
    axes[0][0].set_ylabel("relative MSE, median over the materials")
    axes[0][-1].legend()
    return figure


def draw(drawn, _):
    rows = drawn["noise"] + drawn["noise_with_lights"]
    return {"noise": _curves(rows), "summary.md": _summary(rows), "materials.md": _materials(rows)}
