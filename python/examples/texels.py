#!/usr/bin/env python3
"""Texels: a surface of three materials, fitted with these given, and with three to be found.

texels.py [--quick] [--size=512] [--rgl=FOLDER] [--out=FOLDER]

Draws texels.png. With a folder of RGL files the materials are measured ones, as Mitsuba evaluates them, else models.
"""

import argparse
import pathlib
import time

import matplotlib
import numpy as np

import trilobe

matplotlib.use("agg")
from matplotlib import pyplot  # noqa: E402

NAMES = ["satin_purple", "acrylic_felt_green", "leaf_maple"]


def pairs(count, seed):
    """wi and wo, half of their half vectors near the normal, where highlights are."""
    rng = np.random.default_rng(seed)
    found = []
    while len(found) < count:
        reach = 25 if len(found) % 2 else 70
        theta, phi = np.radians(rng.random() ** 2 * reach), 2 * np.pi * rng.random()
        h = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
        w = rng.normal(size=3)
        across = np.cross(h, w) / np.linalg.norm(np.cross(h, w))
        theta_d = np.radians(rng.uniform(3, 70))
        pair = [np.cos(theta_d) * h + sign * np.sin(theta_d) * across for sign in (1, -1)]
        if min(pair[0][2], pair[1][2]) > 0.15:
            found.append(pair)
    return np.moveaxis(np.array(found), 1, 0)


def measured(folder, name, wi, wo):
    """An RGL file's values."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    bsdf = mi.load_dict({"type": "measured", "filename": str(folder / f"{name}_rgb.bsdf")})
    at = mi.SurfaceInteraction3f()
    values = []
    for i, o in zip(wi, wo):
        at.wi = mi.Vector3f(*i)
        values.append(np.ravel(bsdf.eval(mi.BSDFContext(), at, mi.Vector3f(*o))) / o[2])
    return np.maximum(np.array(values), 0)


def surface(size):
    """Diffuse terms and weights of materials: two shapes on a third, all with stripes."""
    y, x = np.mgrid[:size, :size] / size
    disc = 1 / (1 + np.exp(60 * (np.hypot(x - 0.35, y - 0.4) - 0.25)))
    waves = 1 / (1 + np.exp(-8 * (np.sin(9 * x + 2) + np.cos(7 * y) - 0.3)))
    weights = np.stack([disc, (1 - disc) * waves, (1 - disc) * (1 - waves)], axis=-1)
    colours = np.stack([np.sin(20 * x + 3 * y), np.sin(13 * y - 5 * x), np.cos(17 * (x - y))], axis=-1)
    return 0.035 + 0.025 * colours, weights * (0.75 + 0.25 * np.sin(31 * x + 11 * y))[..., None]


def shown(f, white):
    """Display values of f, about sRGB (a gamma of 2.2)."""
    return np.clip(f / white, 0, 1) ** (1 / 2.2)


def main():
    """Makes a surface, fits it twice, and draws it in directions that were not measured."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few texels, and a fit that is cut short")
    parser.add_argument("--size", default=512, type=int)
    parser.add_argument("--rgl", type=pathlib.Path)
    parser.add_argument("--out", default="out/texels", type=pathlib.Path)
    arguments = parser.parse_args()
    size = 16 if arguments.quick else arguments.size
    models = [trilobe.load(f"material:{name}") for name in NAMES]
    seen, unseen = pairs(64, 3), pairs(100, 4)

    def values(wi, wo):
        if arguments.rgl is None:
            return np.stack([model.eval(wi, wo) for model in models])
        return np.stack([measured(arguments.rgl, name, wi, wo) for name in NAMES])

    d, weights = surface(size)
    arguments.out.mkdir(parents=True, exist_ok=True)
    path = arguments.out / "rho.npy"
    rho = np.lib.format.open_memmap(path, "w+", np.float32, (size, size, 64, 3))
    rng = np.random.default_rng(5)
    for row, of_materials in enumerate(np.float32(values(*seen))[None].repeat(size, 0)):
        exact = d[row, :, None] + np.einsum("wb,bjc->wjc", weights[row], of_materials)
        rho[row] = exact * (1 + 0.02 * rng.standard_normal(exact.shape))
    rho.flush()
    truth = values(*unseen)
    figure, panels = pyplot.subplots(3, 5, figsize=(10, 6.2), layout="constrained")
    cut_short = {"max_seconds": 0.1} if arguments.quick else {}
    for line, (name, shared, options) in enumerate([("given", models, {}), ("found", 3, cut_short)], 1):
        since = time.monotonic()
        texels = trilobe.fit_texels(seen, path, shared, progress=False, **options)
        seconds = time.monotonic() - since
        decibels, scatter = [], []
        for k in range(100):
            exact = d + np.einsum("hwb,bc->hwc", weights, truth[:, k])
            white = np.percentile(exact, 98)
            pictures = shown(exact, white), shown(texels.eval(unseen[0][k], unseen[1][k]), white)
            decibels.append(-10 * np.log10(np.mean((pictures[1] - pictures[0]) ** 2)))
            if k == 7:
                panels[0, 0].imshow(pictures[0])
                panels[line, 0].imshow(pictures[1])
        for b in range(3):
            s = np.stack([strength[..., 0].ravel() for strength in texels.s])
            alike = np.corrcoef(s, weights[..., b].ravel())[-1, :-1]
            scatter.append(alike.max())
            panels[0, 1 + b].imshow(weights[..., b], cmap="gray")
            panels[line, 1 + b].imshow(texels.s[alike.argmax()][..., 0], cmap="gray")
        of_materials = np.stack([model.d for model in models])
        panels[0, 4].imshow(shown(d + weights @ of_materials, 0.5))
        panels[line, 4].imshow(shown(texels.d, 0.5))
        print(f"{name}: {seconds:.1f} s, error {np.median(texels.error):.3f}; pictures in directions not measured "
              f"{np.median(decibels):.1f} dB, strengths correlate by {min(scatter):.3f}")
    for axes, label in zip(panels[:, 0], ("exact", "materials given", "materials found")):
        axes.set_ylabel(label)
    for axes, label in zip(panels[0], ("not measured", *NAMES, "d")):
        axes.set_title(label, fontsize=9)
    for axes in panels.flat:
        axes.set(xticks=[], yticks=[])
    figure.savefig(arguments.out / "texels.png", dpi=100)


if __name__ == "__main__":
    main()
