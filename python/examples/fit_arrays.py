#!/usr/bin/env python3
"""Fit your own arrays: directions and values that no file format knows, here of a GGX microfacet formula.

fit_arrays.py [--quick] [--out=FOLDER]     writes model.json, report.json, trace.csv and slices.png
"""

import argparse
import pathlib

import matplotlib
import numpy as np

import trilobe

matplotlib.use("agg")
from trilobe import plot  # noqa: E402


def directions(count, rng):
    """Unit vectors above the surface, distributed by their cosines."""
    r, phi = np.sqrt(rng.random(count)), 2 * np.pi * rng.random(count)
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r**2)], axis=-1)


def ggx(wi, wo, alpha=0.25):
    """The BRDF [1/sr] of a rough golden metal (Walter et al. 2007), with Schlick's Fresnel factor."""
    h = wi + wo
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    distribution = alpha**2 / (np.pi * (h[:, 2] ** 2 * (alpha**2 - 1) + 1) ** 2)

    def shadowing(w):
        return 2 / (1 + np.sqrt(1 + alpha**2 * (1 / w[:, 2] ** 2 - 1)))

    fresnel = np.array([1.0, 0.78, 0.34]) + (1 - np.array([1.0, 0.78, 0.34])) * (1 - (wi * h).sum(-1)[:, None]) ** 5
    scale = distribution * shadowing(wi) * shadowing(wo) / (4 * wi[:, 2] * wo[:, 2])
    return scale[:, None] * fresnel


def main():
    """Measures, fits, and looks at directions that the fit has not seen."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer samples")
    parser.add_argument("--out", default="out/fit_arrays", type=pathlib.Path)
    arguments = parser.parse_args()
    rng = np.random.default_rng(1)
    count = 3000 if arguments.quick else 40000
    wi, wo = directions(count, rng), directions(count, rng)
    noise = np.exp(0.02 * rng.normal(size=(count, 1)))
    # The light came from anywhere, but the material looks the same when it is turned.
    measurement = trilobe.Measurement(wi, wo, ggx(wi, wo) * noise, anisotropic=False, min_theta_d=0)
    print(measurement)
    result = trilobe.fit(measurement)
    result.save(arguments.out)
    print(f"{result.verdict}; {result.report['stop_reason']} after {result.report['iterations']} iterations")
    wi, wo = directions(2000, rng), directions(2000, rng)
    error = np.abs(result.model.eval(wi, wo) / ggx(wi, wo) - 1)
    print(f"unseen directions: off by {100 * np.median(error):.2f} % in the median")
    plot.slices(result.model, measurement).savefig(arguments.out / "slices.png", dpi=100)


if __name__ == "__main__":
    main()
