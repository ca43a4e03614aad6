"""The share of light that a model reflects, for Mitsuba's albedo pictures, by which denoisers tell surfaces apart."""

from __future__ import annotations

from typing import Any

import numpy as np

from trilobe._mitsuba.renderer import dr, mi
from trilobe._model.brdf import Brdf

_STEPS = 89  # in theta_i, a degree each; constant beyond


class Albedo:
    """`Brdf.albedo` over theta_i, linear between whole degrees; of an anisotropic model its mean over the azimuths."""

    def __init__(self, brdf: Brdf) -> None:
        self._at = brdf._albedo_by_degree(_STEPS).mean(axis=1)  # (90, 3)
        self._columns = [mi.Float(np.ascontiguousarray(column, np.float32)) for column in self._at.T] if (
            dr.is_jit_v(mi.Float)
        ) else []

    def of_one(self, cosine: float) -> list[float]:
        """Three channels, of a direction of this cosine."""
        degrees = np.degrees(np.arccos(np.clip(cosine, 0, 1)))
        return [float(np.interp(degrees, np.arange(_STEPS + 1), column)) for column in self._at.T]

    def __call__(self, cosine: Any, active: Any) -> Any:
        """The same of many, as Dr.Jit's arrays."""
        at = dr.minimum(dr.rad2deg(dr.acos(dr.clip(cosine, 0, 1))), _STEPS)
        low = dr.minimum(mi.UInt32(at), _STEPS - 1)
        part = at - mi.Float(low)
        return mi.Color3f([
            dr.lerp(dr.gather(mi.Float, column, low, active), dr.gather(mi.Float, column, low + 1, active), part)
            for column in self._columns
        ])
