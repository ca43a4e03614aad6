"""Half vectors of a model's lobes, tabulated for renderers that sample by tables of their own.

For a direction wi, half vectors are drawn over two numbers in [0, 1] (docs/python.md#mitsuba):

    v   theta_h = v^2 theta_max, theta_max = (theta_i + 90 degrees) / 2, beyond which no wo is above the surface
    s   the azimuth of h from that of wi, from -phi_max to phi_max, within which wo is above the surface:
        cos phi_max = -cot theta_i cot 2 theta_h; of isotropic models its size, from 0 to phi_max

The table has f cos theta_o of the lobes times dω_o / (dv ds), so that its integral is what the lobes reflect.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from trilobe._brdf import Brdf

THETA_NODES = 24
_MAX_THETA = np.radians(89.5)


class HalfVectors(NamedTuple):
    """What a renderer draws by: densities that are bilinear between nodes of v and s, for some wi."""

    density: NDArray[np.float32]
    """[theta_i][phi_i][v][s], each normalised to 1; phi_i is 1 long for isotropic models."""
    reflected: NDArray[np.float32]
    """The share of the light that the lobes reflect, the mean over the channels: [theta_i][phi_i]."""
    diffuse: float
    """The same of the diffuse term."""

    def cumulated(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
        """Of v, its density and the integral of it, and of each row of s the integral up to a node."""
        density = self.density.astype(np.float64)
        rows, columns = density.shape[-2:]
        along = np.zeros_like(density)
        along[..., 1:] = np.cumsum((density[..., 1:] + density[..., :-1]) / 2, axis=-1) / (columns - 1)
        of_v = along[..., -1]
        upto = np.zeros_like(of_v)
        upto[..., 1:] = np.cumsum((of_v[..., 1:] + of_v[..., :-1]) / 2, axis=-1) / (rows - 1)
        return of_v.astype(np.float32), upto.astype(np.float32), along.astype(np.float32)


def theta_of(t: Any) -> Any:
    """The theta_i of node t (THETA_NODES - 1), t in [0, 1]: closer together towards grazing."""
    return np.pi / 2 * (1 - (1 - t) ** 2)


def max_phi(cos_i: Any, sin_i: Any, cos_h: Any, sin_h: Any) -> Any:
    """The azimuth between h and wi up to which wo is above the surface."""
    denominator = 2 * sin_h * cos_h * sin_i
    numerator = -cos_i * (2 * cos_h**2 - 1)
    with np.errstate(all="ignore"):
        cosine = np.where(denominator > 0, numerator / denominator, np.sign(numerator))
    return np.arccos(np.clip(np.nan_to_num(cosine), -1, 1))


def half_vectors(brdf: Brdf) -> HalfVectors:
    """Tabulates a model; some 10 ms, of an anisotropic one 0.3 s."""
    around = brdf.anisotropic
    d = brdf.D
    bins = d.shape[d.dims.index("theta_h")]
    stretched = any(x != 0 for pair in brdf.stretch for x in pair)
    v = np.linspace(0, 1, (4 if around or stretched else 2) * bins + 1)
    s = np.linspace(0, 1, 33 if around else 17)
    phis = 0
    if around:
        phis = max(12, min(36, max(d.shape[-1], brdf.G.shape[-1])))
    theta_i = np.minimum(theta_of(np.linspace(0, 1, THETA_NODES)), _MAX_THETA)
    phi_i = 2 * np.pi * np.arange(max(phis, 1)) / max(phis, 1)
    density = np.empty((THETA_NODES, len(phi_i), len(v), len(s)), np.float32)
    for k, theta in enumerate(theta_i):
        density[k] = _density(brdf, theta, phi_i, v, s)
    steps = np.ones((len(v), len(s))) / ((len(v) - 1) * (len(s) - 1))
    steps[[0, -1]] /= 2
    steps[:, [0, -1]] /= 2
    reflected = (density * steps).sum(axis=(-2, -1))
    # Where nothing is reflected, all is drawn alike, and seldom.
    black = reflected <= 0
    density[black] = 1
    density /= np.where(black, 1, reflected)[..., None, None]
    return HalfVectors(density, reflected.astype(np.float32), float(np.pi * np.mean(brdf.d)))


def _density(
    brdf: Brdf, theta: float, phi_i: NDArray[Any], v: NDArray[Any], s: NDArray[Any]
) -> NDArray[np.float64]:
    theta_max = (theta + np.pi / 2) / 2
    theta_h = v[:, None] ** 2 * theta_max
    cos_h, sin_h = np.cos(theta_h), np.sin(theta_h)
    widest = max_phi(np.cos(theta), np.sin(theta), cos_h, sin_h)
    phi = (2 * s - 1 if brdf.anisotropic else s) * widest
    at = phi_i[:, None, None]
    wi = np.stack(np.broadcast_arrays(np.sin(theta) * np.cos(at), np.sin(theta) * np.sin(at), np.cos(theta)), axis=-1)
    h = np.stack(np.broadcast_arrays(sin_h * np.cos(at + phi), sin_h * np.sin(at + phi), cos_h), axis=-1)
    wi_h = np.sum(wi * h, axis=-1)
    wo = 2 * wi_h[..., None] * h - wi
    wo[..., 2] = np.maximum(wo[..., 2], np.cos(_MAX_THETA))  # by rounding, and what is just above
    lobes = brdf.eval(wi, wo, components=True)[..., 1:, :].sum(axis=-2).mean(axis=-1)
    # dω_o = 4 (wi . h) sin theta_h dtheta_h dphi, and both sides of wi.
    scale = 4 * wi_h * sin_h * 2 * v[:, None] * theta_max * 2 * widest
    density: NDArray[np.float64] = np.maximum(lobes, 0) * wo[..., 2] * np.maximum(scale, 0)
    return density
