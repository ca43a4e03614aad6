"""Pictures of fits that a page speaks of; the commands are those of the page, run in a folder of their own."""

from __future__ import annotations

import csv
import json
import pathlib
import subprocess
import tempfile
from collections.abc import Callable
from typing import Any

import numpy as np
from diagrams.look import BLUE, GREEN, GREY, RGB, SKY, VERMILION, plt
from PIL import Image

Folder = pathlib.Path
SIDE = 200  # width of a sphere in pixels


def trilobe(folder: Folder, *words: str) -> None:
    """Runs the program there; what it says is told where it fails."""
    done = subprocess.run(["trilobe", *words], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"trilobe {' '.join(words)}: {done.stdout}{done.stderr}")


def fit(folder: Folder, source: str, name: str, *flags: str) -> dict[str, Any]:
    """Fits without pictures into a folder of that name; what it reports."""
    trilobe(folder, "fit", source, "--noplots", f"--out={name}", *flags)
    report: dict[str, Any] = json.loads((folder / name / "report.json").read_text())
    return report


def score(folder: Folder, model: str, source: str, *flags: str) -> float:
    """The PSNR of the sphere against that measurement."""
    done = subprocess.run(["trilobe", "score", f"{model}/model.json", source, "--json", *flags], cwd=folder,
                          capture_output=True, text=True, check=True)
    return float(json.loads(done.stdout)["appearance"]["psnr_db"])


def spheres(folder: Folder, model: str, source: str, *flags: str) -> list[np.ndarray]:
    """Measured and fitted, cut out of spheres.png."""
    trilobe(folder, "plot", f"{model}/model.json", source, f"--out={model}", *flags)
    picture = Image.open(folder / model / "spheres.png").convert("RGB")
    corners = ((24, 132), (648, 132))
    return [np.asarray(picture.crop((x, y, x + 600, y + 600)).resize((SIDE, SIDE), Image.Resampling.LANCZOS))
            for x, y in corners]


def row_of(pictures: list[tuple[str, np.ndarray]], columns: int, size: float = 2.3, letters: float = 9) -> Any:
    """Spheres side by side with a line below each."""
    rows = -(-len(pictures) // columns)
    figure = plt.figure(figsize=(size * columns, (size + 0.25) * rows), layout="none")
    for k, (text, picture) in enumerate(pictures):
        x, y = size * (k % columns) + 0.04, (size + 0.25) * (rows - 1 - k // columns) + 0.25
        width, height = figure.get_size_inches()
        axes = figure.add_axes((x / width, y / height, (size - 0.08) / width, (size - 0.04) / height))
        axes.imshow(picture, aspect="auto")
        axes.axis("off")
        axes.text(0.5, -0.03, text, transform=axes.transAxes, ha="center", va="top", fontsize=letters)
    return figure


def few_samples(folder: Folder, whole: str) -> Any:
    """Fits to ever fewer of a table's bins, with the prior and without."""
    seen = "--max_angle=80"
    counts, looks = [], {"few": [], "bare": []}
    for missing in (0.99, 0.997, 0.999, 0.9997, 0.9999):
        trilobe(folder, "convert", whole, f"--missing={missing}", seen, "--out=few.csv")
        counts.append(sum(1 for _ in (folder / "few.csv").open()) - 2)
        for name, flags in (("few", []), ("bare", ["--prior=0"])):
            fit(folder, "few.csv", f"{name}_{missing}", *flags)
            looks[name].append(score(folder, f"{name}_{missing}", whole, seen))
    figure, (left, *right) = plt.subplots(1, 3, figsize=(9.6, 2.9), width_ratios=[1.5, 1, 1])
    for name, label, color in (("few", "fitted", BLUE), ("bare", "without the prior", GREY)):
        left.plot(counts, looks[name], "o-", color=color, label=label)
    left.set(xscale="log", xlabel="samples", ylabel="PSNR of the sphere [dB]", xticks=counts,
             xticklabels=[f"{count:,}" for count in counts])
    left.minorticks_off()
    left.legend()
    for axes, text, picture in zip(right, ("measured", f"fitted to {counts[2]}"),
                                   spheres(folder, "few_0.999", whole, seen), strict=True):
        axes.imshow(picture)
        axes.axis("off")
        axes.set_title(text, loc="center")
    return figure


def saturated(folder: Folder) -> Any:
    """A copper cut off at 1/sr: fitted as it is, and without what was cut off."""
    whole = "synth:copper"
    trilobe(folder, "convert", "synth:copper@30x30x60", "--noise=0.02", "--out=copper.csv")
    lines = (folder / "copper.csv").read_text().splitlines()
    flat, below = lines[:2], lines[:2]
    for line in lines[2:]:
        cells = line.split(",")
        values = [float(cell) for cell in cells[4:]]
        flat.append(",".join([*cells[:4], *(f"{min(value, 1)}" for value in values)]))
        if max(values) < 1:
            below.append(line)
    shown = []
    for name, kept, flags in (("flat", flat, []), ("below", below, ["--prior=0"])):
        (folder / f"{name}.csv").write_text("\n".join(kept) + "\n")
        fit(folder, f"{name}.csv", name, *flags)
        shown.append((spheres(folder, name, whole), score(folder, name, whole)))
    return row_of([("the copper", shown[0][0][0]), (f"cut off at 1/sr, fitted: {shown[0][1]:.1f} dB", shown[0][0][1]),
                   (f"without these samples: {shown[1][1]:.1f} dB", shown[1][0][1])], 3)


def synthetic(folder: Folder) -> Any:
    """A sphere of each synthetic material, from the thumbnail of a fit of many."""
    said = subprocess.run(["trilobe", "synth"], capture_output=True, text=True, check=True).stdout
    names = [line.split()[0] for line in said.splitlines() if line.startswith("  ")]
    trilobe(folder, "fit", *(f"synth:{name}" for name in names), "--lobes=1", "--solver=awls", "--max_iterations=1",
            "--nodiagnose", "--out=fits")
    pictures = []
    for name in names:
        pair = Image.open(folder / "fits" / name / "pair.png").convert("RGB")
        pictures.append((name, np.asarray(pair.crop((0, 0, pair.width // 2, pair.width // 2)))))
    return row_of(pictures, 7, 0.98, 7.2)


def stored(folder: Folder) -> Any:
    """Tables of a copper that was measured up to 60 degrees, and what was done where nothing was."""
    fit(folder, "synth:copper@45x45x90", "copper", "--noise=0.02", "--max_angle=60")
    made = json.loads((folder / "copper/model.json").read_text())
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(9.6, 3.2))
    for name, axes in (("D", left), ("G", middle)):
        part = (np.arange(len(made[name][0])) + 0.5) / len(made[name][0])
        at = 90 * (part**2 if name == "D" else part)
        lobes = zip(made[name], made["unobserved"][name], (BLUE, VERMILION, GREEN), strict=True)
        for table, unobserved, color in lobes:
            values = np.array(table) / (np.cos(np.radians(at)) if name == "G" else 1)
            known = np.ones(len(values), bool)
            known[unobserved] = False
            axes.plot(at[known], values[known], ".-", color=color, ms=4, lw=1)
            axes.plot(at[~known], values[~known], "o", color=color, ms=3, mfc="white", mew=0.8)
    left.set(title="D by θh [°]", xlim=(0, 90), yscale="log")
    middle.set(title="G/cos θ by θ [°]", xlim=(0, 90), ylim=0)
    middle.axvspan(60, 90, color="#f1f1f1")
    moved = fit(folder, "synth:car-paint@30x30x60", "paint", "--noise=0.02", "--lobes=1")["finishing"]
    light = next(step for step in moved if step["step"] == "reflected_light")
    rise = light["objective_after"] / light["objective_before"] - 1
    shares = [100 * share for share in (light["error_before"], light["error_after"], rise)]
    bars = right.bar(range(3), shares, color=(GREY, BLUE, VERMILION))
    right.bar_label(bars, [f"{share:.2g} %" for share in shares])
    right.set(xticks=range(3), xticklabels=["light that is off\nas fitted", "put right", "E rose by"],
              title="One lobe for a car paint")
    return figure


def method(folder: Folder) -> Any:
    """The six steps of the method, of one fit of a noisy plastic."""
    source, noise = "synth:plastic@30x30x60", "--noise=0.02"
    report = fit(folder, source, "plastic", noise)
    made = json.loads((folder / "plastic/model.json").read_text())
    measured, fitted = spheres(folder, "plastic", source, noise)
    figure, axes = plt.subplots(2, 3, figsize=(9.6, 5.4))
    trilobe(folder, "convert", source, noise, "--out=samples.csv")
    samples = np.loadtxt(folder / "samples.csv", delimiter=",", skiprows=2)
    level = np.log10(samples[:, 4:].mean(axis=1) + 1e-3)
    axes[0, 0].scatter(samples[:, 0], samples[:, 2], s=1, c=level, cmap="viridis", rasterized=True)
    axes[0, 0].set(title=f"1. {len(samples):,} samples", xlabel="θi [°]", ylabel="θo [°]")
    size = len(made["D"][0])
    at = 90 * ((np.arange(size) + 0.5) / size) ** 2
    for table, color in zip(made["D"], (BLUE, VERMILION, GREEN), strict=True):
        axes[0, 1].plot(at, np.array(table) + 1e-9, ".-", ms=3, lw=1, color=color)
    axes[0, 1].set(title="2. a model: here D of its lobes", xlabel="θh [°]", yscale="log", ylim=1e-3)
    seen = np.logspace(-3, 2)
    axes[0, 2].plot(seen, (seen + 1 / 20) ** -1.5, color=BLUE)
    axes[0, 2].set(title="3. E: dark samples weigh more", xlabel="brightness over the mean", ylabel="weight",
                   xscale="log", yscale="log")
    with (folder / "plastic/trace.csv").open() as file:
        trace = [float(row["objective"]) for row in csv.DictReader(file)]
    axes[1, 0].plot(trace, ".-", color=BLUE)
    axes[1, 0].set(title="4. a solver lowers E", xlabel="iteration", yscale="log")
    light = report["light"]
    parts = [("diffuse", light["diffuse"]["albedo"]),
             *((f"lobe {k + 1}", lobe["albedo"]) for k, lobe in enumerate(light["lobes"]))]
    for k, (_, albedo) in enumerate(parts):
        axes[1, 1].bar(k + 0.27 * (np.arange(3) - 1), albedo, 0.25, color=RGB)
    axes[1, 1].set(title="5. put right and stored", xticks=range(len(parts)), xticklabels=[name for name, _ in parts],
                   ylabel="albedo")
    axes[1, 2].imshow(np.hstack([measured, fitted]))
    axes[1, 2].set(title="6. measured, fitted", xlabel=f"PSNR {report['appearance']['psnr_db']:.1f} dB", xticks=[],
                   yticks=[])
    return figure


def forms(folder: Folder, source: str) -> Any:
    """The candidates of --model=auto: their looks and sizes."""
    report = fit(folder, source, "auto", "--model=auto")
    tried = sorted(report["candidates"], key=lambda one: one["psnr_db"])
    best = max((one for one in tried if one["parameters"] <= 822), key=lambda one: one["psnr_db"])
    figure, axes = plt.subplots(figsize=(9.6, 0.5 + 0.34 * len(tried)))
    for y, one in enumerate(tried):
        color = VERMILION if one is best else BLUE if one["parameters"] <= 828 else SKY
        axes.barh(y, one["psnr_db"], 0.7, color=color)
        axes.text(one["psnr_db"] + 0.1, y, f"{one['psnr_db']:.1f} dB, {one['parameters']:,} parameters", va="center",
                  fontsize=9)
    axes.set(yticks=range(len(tried)), yticklabels=[one["name"] for one in tried],
             xlim=(tried[0]["psnr_db"] - 4, tried[-1]["psnr_db"] + 8), xlabel="PSNR of the sphere [dB]")
    axes.tick_params(axis="y", labelsize=8)
    return figure


def in_a_folder(draw: Callable[..., Any], *arguments: str) -> Any:
    """The picture, made in a folder that is removed."""
    with tempfile.TemporaryDirectory() as folder:
        return draw(pathlib.Path(folder), *arguments)
