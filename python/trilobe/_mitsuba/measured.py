"""A measurement as Dr.Jit arrays, read between its bins or nodes by help of a model fitted to it."""

from __future__ import annotations

from typing import Any

import numpy as np

from trilobe._fitting.measurement import Measurement, completed
from trilobe._mitsuba.renderer import dr, mi
from trilobe._mitsuba.tables import Tables, linear, turns
from trilobe._model.brdf import Brdf


def half_difference(wi: Any, wo: Any) -> tuple[Any, Any, Any]:
    """theta_h, theta_d and phi_d [rad] of two unit vectors, phi_d from 0 to pi."""
    h = dr.normalize(wi + wo)
    sin_h = dr.sqrt(dr.square(h.x) + dr.square(h.y))
    leaning = sin_h > 0
    cos_phi, sin_phi = dr.select(leaning, h.x / sin_h, 1), dr.select(leaning, h.y / sin_h, 0)
    x = cos_phi * wi.x + sin_phi * wi.y
    y = cos_phi * wi.y - sin_phi * wi.x
    along = h.z * x - sin_h * wi.z
    phi_d = dr.atan2(y, along)
    phi_d = dr.select(phi_d < 0, phi_d + dr.pi, phi_d)
    theta_d = dr.atan2(dr.sqrt(dr.square(along) + dr.square(y)), sin_h * x + h.z * wi.z)
    return dr.atan2(sin_h, h.z), theta_d, dr.clip(phi_d, 0, dr.pi)


def _circular(coordinate: Any, size: int) -> list[tuple[Any, Any]]:
    """Entries and weights of linear interpolation on a circle of `size` entries, for coordinates from -1 to size."""
    x = coordinate + size
    low = mi.UInt32(x)
    t = x - mi.Float(low)
    return [(low % size, 1 - t), ((low + 1) % size, t)]


class MeasuredTable:
    """f = (m + e) q - e, as `trilobe convert` has it: m the model, q interpolated between what was measured."""

    def __init__(self, measurement: Measurement | None, model: Brdf) -> None:
        """Fills in what was not measured, which takes a moment; without a measurement it is the model."""
        self._tables = Tables(model)
        parts = (model.d, model.s, model.D, model.F, model.G)
        d, s, *factors = (mi.Float(np.asarray(part, np.float32).ravel()) for part in parts)
        self._tables.fill(d, s, dict(zip("DFG", factors)))
        self.shape: tuple[int, ...] = ()
        if measurement is None:
            return
        made = completed(measurement, model)
        self.shape = tuple(made.shape)
        self._offset = float(made.offset)
        if self.shape:
            # Four side by side are one load.
            ratios = np.ones((int(np.prod(self.shape)), 4), np.float32)
            ratios[:, :3] = made.ratios()
            self._ratios = mi.Float(ratios.ravel())

    def value(self, wi: Any, wo: Any, active: Any) -> Any:
        """f of three channels [1/sr], for directions above the surface."""
        model = self._tables.value(wi, wo, active)
        if not self.shape:
            return model
        places = self._bins(wi, wo) if len(self.shape) == 3 else self._nodes(wi, wo)
        ratio = mi.Vector4f(0)
        for index, weight in places:
            ratio += weight * dr.gather(mi.Vector4f, self._ratios, index, active)
        return dr.maximum((model + self._offset) * mi.Color3f(ratio.x, ratio.y, ratio.z) - self._offset, 0)

    def _bins(self, wi: Any, wo: Any) -> list[tuple[Any, Any]]:
        hs, ds, ps = self.shape
        theta_h, theta_d, phi_d = half_difference(wi, wo)
        return [
            ((h * ds + d) * ps + p, wh * wd * wp)
            for h, wh in linear(dr.sqrt(theta_h * (2 / dr.pi)) * hs, hs)
            for d, wd in linear(theta_d * (2 / dr.pi) * ds, ds)
            for p, wp in _circular(phi_d * (ps / dr.pi) - 0.5, ps)
        ]

    def _nodes(self, wi: Any, wo: Any) -> list[tuple[Any, Any]]:
        thetas, phis = self.shape[:2]

        def around(w: Any) -> list[tuple[Any, Any]]:
            # Node k stands at k steps, and that of a bin half a step further.
            rings = linear(dr.safe_acos(w.z) * (2 / dr.pi * thetas) + 0.5, thetas)
            circle = _circular(turns(w.x, w.y) * phis, phis)
            return [(ring * phis + phi, a * b) for ring, a in rings for phi, b in circle]

        return [(i * (thetas * phis) + o, a * b) for i, a in around(wi) for o, b in around(wo)]
