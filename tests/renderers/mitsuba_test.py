"""Files that `convert` writes, in Mitsuba's `measured`.

The values are those of our own reader, samples are drawn by the density that Mitsuba says, and a picture comes out as
bright as it should.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import run

Array = NDArray[np.float64]
PAIRS = 20_000
GRID = (90, 90, 180)  # theta_h, theta_d, phi_d
SCALE = np.array([1, 1.15, 1.66]) / 1500  # channel scales of a MERL file


def reader_values(file: Path) -> tuple[Array, Array, Array]:
    """wi, wo [n, 3] and rho [n, 3] of random MERL bins, as our reader of RGL files has them."""
    merl = file.with_suffix(".binary")
    run("convert", file, f"--out={merl}")
    stored = np.fromfile(merl, dtype="<f8", offset=12).reshape(3, -1)
    merl.unlink()
    bins = np.random.default_rng(1).permutation(np.flatnonzero((stored >= 0).all(axis=0)))[:PAIRS]
    h, d, p = np.unravel_index(bins, GRID)
    theta_h = np.square((h + 0.5) / 90) * math.pi / 2
    theta_d, phi_d = (d + 0.5) * math.pi / 180, (p + 0.5) * math.pi / 180
    # wi in the frame of the half vector, which then leans by theta_h towards x.
    x, y, z = np.sin(theta_d) * np.cos(phi_d), np.sin(theta_d) * np.sin(phi_d), np.cos(theta_d)
    c, s = np.cos(theta_h), np.sin(theta_h)
    wi = np.stack([c * x + s * z, y, c * z - s * x], axis=1)
    wo = np.stack([-c * x + s * z, -y, c * z + s * x], axis=1)
    return wi, wo, stored[:, bins].T * SCALE


def measured(mi: Any, variant: str, file: Path) -> Any:
    mi.set_variant(variant)
    return mi.load_dict({"type": "measured", "filename": str(file)})


def errors(of: Array, expected: Array) -> Array:
    """Relative errors of rho cos theta_o, with an offset that keeps nearly black values out."""
    return np.linalg.norm(of - expected, axis=1) / (np.linalg.norm(expected, axis=1) + 1e-4)


@pytest.mark.parametrize("name", ["plastic", "metal"])
def test_rgb_values_are_those_of_our_reader(mitsuba: Any, files: Path, name: str) -> None:
    file = files / f"{name}.bsdf"
    run("convert", files / f"{name}.json", f"--out={file}", "--error=0.05")
    wi, wo, rho = reader_values(file)
    bsdf = measured(mitsuba, "scalar_rgb", file)
    context, at = mitsuba.BSDFContext(), mitsuba.SurfaceInteraction3f()
    values = np.empty_like(rho)
    for k, (i, o) in enumerate(zip(wi.tolist(), wo.tolist())):
        at.wi = i
        values[k] = bsdf.eval(context, at, o)
    off = errors(values, rho * wo[:, 2:])
    assert np.median(off) < 1e-5
    assert np.quantile(off, 0.999) < 1e-2


def test_spectral_values_have_the_colours_of_our_reader(mitsuba: Any, files: Path) -> None:
    file = files / "spectral.bsdf"
    run("convert", files / "plastic.json", f"--out={file}", "--error=0.05", "--spectral")
    wi, wo, rho = reader_values(file)
    mi = mitsuba
    bsdf = measured(mi, "scalar_spectral", file)
    context, at = mi.BSDFContext(), mi.SurfaceInteraction3f()
    wavelengths = np.arange(400, 701, 20)
    spectra = np.empty((PAIRS, wavelengths.size))
    for first in range(0, wavelengths.size, 4):
        at.wavelengths = wavelengths[first:first + 4].tolist()
        for k, (i, o) in enumerate(zip(wi.tolist(), wo.tolist())):
            at.wi = i
            spectra[k, first:first + 4] = bsdf.eval(context, at, o)
    # Linear between wavelengths, constant beyond; Mitsuba's own observer under D65.
    at_nm = np.arange(380, 781)
    d65 = mi.load_dict({"type": "d65"})
    weights = np.zeros((at_nm.size, 3))
    for k, nm in enumerate(at_nm):
        at.wavelengths = [float(nm)] * 4
        xyz = mi.cie1931_xyz(float(nm))
        weights[k] = np.array([float(x) for x in xyz]) * float(d65.eval(at)[0])
    to_srgb = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560],
                        [0.0556434, -0.2040259, 1.0572252]])
    weights = weights @ to_srgb.T / (weights.sum(axis=0) @ to_srgb.T)
    hats = np.array([np.interp(at_nm, wavelengths, row) for row in np.eye(wavelengths.size)])
    off = errors(spectra @ (hats @ weights), rho * wo[:, 2:])
    assert np.median(off) < 2e-3
    assert np.quantile(off, 0.999) < 1e-2


def chi2_survival(statistic: float, freedom: int) -> float:
    """The probability of a larger statistic (Wilson and Hilferty 1931)."""
    mean = 1 - 2 / (9 * freedom)
    z = ((statistic / freedom) ** (1 / 3) - mean) / math.sqrt(2 / (9 * freedom))
    return 0.5 * math.erfc(z / math.sqrt(2))


@pytest.mark.parametrize(("name", "theta"), [("plastic", 0.0), ("metal", 45.0), ("plastic", 80.0)])
def test_samples_are_drawn_by_the_density(mitsuba: Any, files: Path, name: str, theta: float) -> None:
    """A chi-squared test over half vectors; over the sphere of wo it would miss narrow peaks."""
    mi = mitsuba
    file = files / f"{name}.bsdf"
    if not file.exists():
        run("convert", files / f"{name}.json", f"--out={file}", "--error=0.05")
    bsdf = measured(mi, "scalar_rgb", file)
    context, at = mi.BSDFContext(), mi.SurfaceInteraction3f()
    wi = np.array([math.sin(math.radians(theta)), 0, math.cos(math.radians(theta))])
    at.wi = wi.tolist()
    count, columns, rows, fine = 40_000, 24, 12, 6
    random = np.random.default_rng(7).random((count, 2))
    observed = np.zeros((rows, columns))
    below = 0
    for u in random.tolist():
        sample, _ = bsdf.sample(context, at, 0.5, u)
        wo = np.array(sample.wo)
        if sample.pdf <= 0 or wo[2] <= 0:
            below += 1
            continue
        h = wi + wo
        h /= np.linalg.norm(h)
        column = min(int(math.sqrt(2 * math.acos(min(h[2], 1)) / math.pi) * columns), columns - 1)
        row = min(int((math.atan2(h[1], h[0]) / (2 * math.pi) + 0.5) * rows), rows - 1)
        observed[row, column] += 1
    # Expected share of each cell: the density at midpoints of fine^2 parts, theta_h = u^2 pi / 2.
    expected = np.zeros((rows, columns))
    for column in range(columns * fine):
        u = (column + 0.5) / (columns * fine)
        theta_h = u * u * math.pi / 2
        area = math.sin(theta_h) * math.pi * u / (columns * fine) * 2 * math.pi / (rows * fine)
        for row in range(rows * fine):
            phi = ((row + 0.5) / (rows * fine) - 0.5) * 2 * math.pi
            h = np.array([math.sin(theta_h) * math.cos(phi), math.sin(theta_h) * math.sin(phi), math.cos(theta_h)])
            cosine = float(wi @ h)
            wo = 2 * cosine * h - wi
            if cosine > 0 and wo[2] > 0:
                pdf = float(bsdf.pdf(context, at, wo.tolist()))
                expected[row // fine, column // fine] += count * pdf * 4 * cosine * area
    assert below < 0.02 * count
    # All but those below the horizon are within; what a cell has too few of is taken together.
    assert abs(expected.sum() + below - count) < 0.01 * count
    expected *= (count - below) / expected.sum()
    many = expected >= 5
    cells = np.append((observed - expected)[many] ** 2 / expected[many],
                      (observed - expected)[~many].sum() ** 2 / max(expected[~many].sum(), 1))
    assert chi2_survival(cells.sum(), cells.size - 1) > 1e-3


def test_a_picture_is_as_bright_as_the_albedo(mitsuba: Any, files: Path) -> None:
    """A sphere under light from everywhere, at 64 x 64: each pixel is the albedo of its direction."""
    mi = mitsuba
    file = files / "picture.bsdf"
    run("convert", files / "plastic.json", f"--out={file}", "--error=0.05")
    bsdf = measured(mi, "scalar_rgb", file)
    scene = mi.load_dict({
        "type": "scene", "integrator": {"type": "path", "max_depth": 2, "hide_emitters": True},
        "sensor": {"type": "perspective", "fov": 11.4,
                   "to_world": mi.ScalarTransform4f().look_at([0, 0, 10], [0, 0, 0], [0, 1, 0]),
                   "film": {"type": "hdrfilm", "width": 64, "height": 64, "rfilter": {"type": "box"},
                            "pixel_format": "rgb", "component_format": "float32"},
                   "sampler": {"type": "independent", "sample_count": 64}},
        "light": {"type": "constant"}, "sphere": {"type": "sphere", "bsdf": bsdf}})
    picture = np.array(mi.render(scene, seed=1))
    assert np.isfinite(picture).all() and (picture >= 0).all()
    middle = picture[26:38, 26:38].mean(axis=(0, 1))
    # The albedo at the normal, by quadrature over the disc of projected directions.
    context, at = mi.BSDFContext(), mi.SurfaceInteraction3f()
    at.wi = [0, 0, 1]
    albedo, nodes = np.zeros(3), 600
    for k in range(nodes):
        # theta_h by even steps of u, as the highlight asks for; isotropic, so that one azimuth does.
        u = (k + 0.5) / nodes
        theta_o = u * u * math.pi / 2
        value = np.array(bsdf.eval(context, at, [math.sin(theta_o), 0, math.cos(theta_o)]))
        albedo += value * math.sin(theta_o) * 2 * math.pi * math.pi * u / nodes
    assert np.allclose(middle, albedo, rtol=0.03)
