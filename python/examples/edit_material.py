#!/usr/bin/env python3
"""Edit a material: make its highlight wider, tint it, take a lobe away, and see what the light budget says.

edit_material.py [--quick] [--out=FOLDER] [MODEL.json]     draws edited.png and writes edited.json
"""

import argparse
import pathlib

import matplotlib
import numpy as np

import trilobe

matplotlib.use("agg")
from matplotlib import pyplot  # noqa: E402

from trilobe import plot  # noqa: E402


def wider(brdf, factor):
    """D stretched over theta_h by a factor, and scaled so that it still integrates to 1."""
    theta = brdf.D.coords["theta_h"]
    edges = np.linspace(0, 1, len(theta) + 1) ** 2 * np.pi / 2
    projected = np.pi * np.diff(np.sin(edges) ** 2)  # the solid angle of a bin, projected
    rows = np.asarray(brdf.D)
    stretched = np.array([np.interp(theta / factor, theta, row) for row in rows])
    stretched *= (rows @ projected / np.maximum(stretched @ projected, 1e-12))[:, None]
    return brdf.replace(D=stretched)


def main():
    """Edits a model in four ways."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", nargs="?", help="by default a fit of synthetic plastic")
    parser.add_argument("--quick", action="store_true", help="small pictures of a rough fit")
    parser.add_argument("--out", default="out/edit_material", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.model:
        brdf = trilobe.load(arguments.model)
    else:
        size = "24x24x48" if arguments.quick else "90x90x180"
        brdf = trilobe.fit(f"synth:plastic@{size}", max_iterations=3 if arguments.quick else 100).model
    edited = {
        "as it was": brdf,
        "wider highlights": wider(brdf, 1.8),
        "red and blue exchanged": brdf.replace(d=brdf.d[::-1], s=brdf.s[:, ::-1], F=np.asarray(brdf.F)[::-1]),
        "without its first lobe": trilobe.Brdf(brdf.d, brdf.s[1:], brdf.D[1:], brdf.F, brdf.G[1:]),
    }
    arguments.out.mkdir(parents=True, exist_ok=True)
    figure = pyplot.figure(figsize=(12, 3.4))
    size = 48 if arguments.quick else 192
    for part, (name, material) in zip(figure.subfigures(1, len(edited)), edited.items()):
        plot.spheres(material, figure=part, size=size)
        part.axes[0].set_title(name, fontsize=9)
        print(f"{name:24} reflects {np.round(material.albedo([0, 0, 1]), 3)} of the light along the normal")
    figure.savefig(arguments.out / "edited.png", dpi=100)
    edited["wider highlights"].save(arguments.out / "edited.json")


if __name__ == "__main__":
    main()
