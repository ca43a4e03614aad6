"""Reflectance spectra of the three primaries of sRGB, of which any colour's is a sum.

I. Mallett and C. Yuksel, Spectral Primary Decomposition for Rendering with sRGB Reflectance (2019): the smoothest
three that are nowhere negative, add up to 1, and under D65 have the colours red, green and blue. So a spectrum of
values is linear in the colour, and white stays white.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from trilobe._mitsuba.renderer import dr, mi

BEGIN, END, STEP = 360.0, 830.0, 10.0
"""Wavelengths at which they are tabulated [nm]."""


def _colour_of_spectra() -> NDArray[np.float64]:
    """[3][wavelengths]: linear sRGB of a reflectance under D65, whose integral is a sum."""
    wavelengths = np.arange(BEGIN, END + STEP / 2, STEP)
    illuminant = mi.load_dict({"type": "d65"})
    si = mi.SurfaceInteraction3f()
    if dr.is_jit_v(mi.Float):
        xyz = np.array(mi.cie1931_xyz(mi.Float(wavelengths)))
        si.wavelengths = mi.UnpolarizedSpectrum(mi.Float(wavelengths))
        d65 = np.array(mi.unpolarized_spectrum(illuminant.eval(si)))[0]
    else:
        xyz = np.array([np.ravel(mi.cie1931_xyz(float(wavelength))) for wavelength in wavelengths]).T
        d65 = np.empty(len(wavelengths))
        for k, wavelength in enumerate(wavelengths):
            si.wavelengths = mi.UnpolarizedSpectrum(float(wavelength))
            d65[k] = float(mi.unpolarized_spectrum(illuminant.eval(si))[0])
    weighted = xyz * d65
    weighted /= weighted[1].sum()
    to_rgb = np.array([[3.240479, -1.537150, -0.498535], [-0.969256, 1.875991, 0.041556],
                       [0.055648, -0.204043, 1.057311]])
    rgb: NDArray[np.float64] = to_rgb @ weighted
    rgb /= rgb.sum(axis=1, keepdims=True)  # white is white, to the last digit
    return rgb


@functools.lru_cache(maxsize=1)
def basis() -> NDArray[np.float64]:
    """[3][wavelengths]: the spectra of red, green and blue."""
    colour = _colour_of_spectra()
    return decompose(colour)


def decompose(colour: NDArray[np.float64]) -> NDArray[Any]:
    """The smoothest such spectra, by ADMM: equal constraints and bounds in turn."""
    n = colour.shape[1]
    difference = np.diff(np.eye(n), axis=0)
    smooth = np.kron(np.eye(3), difference.T @ difference)
    equal = np.concatenate([np.kron(np.eye(3), colour), np.kron(np.ones((1, 3)), np.eye(n))])
    wanted = np.concatenate([np.eye(3).ravel(), np.ones(n)])
    rho = 0.1
    system = np.block([[smooth + rho * np.eye(3 * n), equal.T], [equal, np.zeros((len(equal),) * 2)]])
    inverse = np.linalg.pinv(system, rcond=1e-12, hermitian=True)
    bounded, dual = np.full(3 * n, 1 / 3), np.zeros(3 * n)
    for _ in range(1000):
        x = (inverse @ np.concatenate([rho * (bounded - dual), wanted]))[: 3 * n]
        bounded = np.clip(x + dual, 0, 1)
        dual += x - bounded
    return bounded.reshape(3, n)
