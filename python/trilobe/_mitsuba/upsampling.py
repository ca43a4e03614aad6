"""Spectra of colours in spectral variants of Mitsuba."""

from __future__ import annotations

from typing import Any

import numpy as np

from trilobe._mitsuba.primaries import BEGIN, STEP, basis
from trilobe._mitsuba.renderer import dr, mi


class Upsampling:
    """Spectra of RGB colours, the sums of three that add up to 1 (Mallett and Yuksel 2019)."""

    _tables: Any = None

    def __init__(self) -> None:
        spectra = basis()
        self._begin, self._step, self._size = BEGIN, STEP, spectra.shape[1]
        self._flat = [mi.Float(row.astype(np.float32)) if dr.is_jit_v(mi.Float) else row for row in spectra]

    def __call__(self, colour: Any, wavelengths: Any) -> Any:
        if not dr.is_jit_v(mi.Float):
            grid = self._begin + self._step * np.arange(self._size)
            at = np.array(wavelengths).ravel()
            value: Any = sum(float(colour[c]) * np.interp(at, grid, self._flat[c]) for c in range(3))
            return mi.UnpolarizedSpectrum([float(x) for x in value])
        x = dr.clip((wavelengths - self._begin) / self._step, 0, self._size - 1)
        value = mi.UnpolarizedSpectrum(0)
        for k in range(len(wavelengths)):
            low = dr.minimum(mi.UInt32(x[k]), self._size - 2)
            t = x[k] - mi.Float(low)
            for c in range(3):
                a = dr.gather(mi.Float, self._flat[c], low)
                b = dr.gather(mi.Float, self._flat[c], low + 1)
                value[k] += colour[c] * ((1 - t) * a + t * b)
        return value
