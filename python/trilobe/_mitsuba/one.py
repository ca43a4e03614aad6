"""A model at one pair of directions at a time, as scalar variants of Mitsuba ask: without what arrays need."""

from __future__ import annotations

from typing import Any

import numpy as np

from trilobe._model.arrays import Floats
from trilobe._model.brdf import Brdf

_BELOW_ONE = float(np.nextafter(np.float32(1), np.float32(0)))


def row(w: Any) -> Floats:
    """A vector of a scalar variant, (1, 3)."""
    return np.array(((w.x, w.y, w.z),), np.float32)


class OnePair:
    """Values, densities and samples, of which those below the surface are 0, and so are those of no direction."""

    def __init__(self, brdf: Brdf) -> None:
        self._material = brdf._material

    def eval(self, wi: Floats, wo: Floats) -> Floats:
        """f [1/sr], (3,)."""
        out = np.zeros((1, 3), np.float32)
        if wi[0, 2] > 0 and wo[0, 2] > 0:
            self._material.eval(wi, wo, out, False)
        return out.ravel()

    def pdf(self, wi: Floats, wo: Floats) -> float:
        """The density of wo [1/sr]."""
        if not (wi[0, 2] > 0 and wo[0, 2] > 0):
            return 0.0
        out = np.empty((1, 1), np.float32)
        self._material.pdf(wi, wo, out)
        return float(out[0, 0])

    def sample(self, wi: Floats, u: Any) -> Floats:
        """wo, its density, and f cos theta_o over that, (7,); 0 where nothing is drawn."""
        out = np.zeros((1, 7), np.float32)
        if wi[0, 2] > 0:
            numbers = np.array(((min(u.x, _BELOW_ONE), min(u.y, _BELOW_ONE)),), np.float32)
            self._material.sample(wi, numbers, out)
        return out.ravel()
