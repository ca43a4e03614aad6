"""How half vectors are drawn in compiled variants of Mitsuba."""

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from trilobe._brdf import Brdf
from trilobe._half_vectors import THETA_NODES, half_vectors
from trilobe._mitsuba_tables import turns

# Of the half vectors, so much is drawn by the cosine, lest something between the nodes be missed.
_COSINE_SHARE = 0.01


def invert_linear(a: Any, b: Any, twice: Any) -> Any:
    """The part of a step in which a density that goes from a to b has half of `twice` as its integral."""
    root = a + dr.safe_sqrt(dr.fma(b - a, twice, a * a))
    return dr.select(root > 0, dr.clip(twice / root, 0, 1), 0.5)


class Sampling:
    """How half vectors are drawn (_half_vectors.py): the density is linear between nodes of wi, too.

    So it is that of drawing by one of the nodes around wi, chosen as often as its weight says.
    """

    def __init__(self, brdf: Brdf) -> None:
        self._any_lobe = brdf.lobes > 0
        self._around = brdf.anisotropic
        self._diffuse = mi.Float(float(np.pi * np.mean(brdf.d)))
        dr.make_opaque(self._diffuse)
        if not self._any_lobe:
            return
        made = half_vectors(brdf)
        self._phis, self._rows, self._columns = made.density.shape[1:]
        # The corners of each cell of (v, s) are one load.
        low, high = made.density[..., :-1, :], made.density[..., 1:, :]
        cells = np.stack([low[..., :-1], low[..., 1:], high[..., :-1], high[..., 1:]], axis=-1)
        of_v, upto, along = made.cumulated()
        self._cells, self._of_v, self._upto, self._along, self._reflected = (
            mi.Float(np.ascontiguousarray(array, np.float32).ravel())
            for array in (cells, of_v, upto, along, made.reflected)
        )

    def incident(self, wi: Any) -> Any:
        """What is drawn for wi: nodes with weights, theta_max, sin theta_i, and how often the cosine is."""
        sin_i = dr.sqrt(dr.square(wi.x) + dr.square(wi.y))
        theta = dr.safe_acos(wi.z)
        nodes: list[tuple[Any, Any]] = []
        cosine = mi.Float(1)
        if self._any_lobe:
            x = dr.clip((1 - dr.safe_sqrt(1 - theta * (2 / dr.pi))) * (THETA_NODES - 1), 0, THETA_NODES - 1)
            ring = dr.minimum(mi.UInt32(x), THETA_NODES - 2)
            t = x - mi.Float(ring)
            nodes = [(ring, 1 - t), (ring + 1, t)]
            if self._around:
                y = dr.select(sin_i > 1e-9, turns(wi.x, wi.y), 0) * self._phis
                left = dr.minimum(mi.UInt32(y), self._phis - 1)
                f = y - mi.Float(left)
                right = dr.select(left + 1 < self._phis, left + 1, 0)
                nodes = [
                    (ring * self._phis + phi, of_ring * weight)
                    for ring, of_ring in nodes
                    for phi, weight in ((left, 1 - f), (right, f))
                ]
            lobes = sum(weight * dr.gather(mi.Float, self._reflected, node) for node, weight in nodes)
            diffuse = self._diffuse + _COSINE_SHARE * lobes
            cosine = dr.select(lobes > 0, diffuse / (diffuse + lobes), 1)
        return nodes, (theta + dr.pi / 2) / 2, sin_i, cosine

    def _density_at(self, nodes: list[tuple[Any, Any]], v: Any, s: Any, active: Any) -> Any:
        x, y = v * (self._rows - 1), s * (self._columns - 1)
        row = dr.minimum(mi.UInt32(x), self._rows - 2)
        column = dr.minimum(mi.UInt32(y), self._columns - 2)
        t, f = x - mi.Float(row), y - mi.Float(column)
        cell = row * (self._columns - 1) + column
        size = (self._rows - 1) * (self._columns - 1)
        corners = sum(w * dr.gather(mi.Vector4f, self._cells, node * size + cell, active) for node, w in nodes)
        return (1 - t) * ((1 - f) * corners.x + f * corners.y) + t * ((1 - f) * corners.z + f * corners.w)

    def _draw_by_table(self, nodes: list[tuple[Any, Any]], choice: Any, u: Any, active: Any) -> tuple[Any, Any]:
        """A pair (v, s), by one of the nodes."""
        node, left = nodes[0][0], choice
        for other, weight in nodes[:0:-1]:
            node = dr.select((left >= 0) & (left < weight), other, node)
            left = left - weight
        base = node * self._rows
        last = self._rows - 1

        def before(row: Any) -> Any:
            return dr.gather(mi.Float, self._upto, base + row, active) <= u.y

        row = dr.minimum(dr.maximum(dr.binary_search(0, last, before), 1) - 1, last - 1)
        begin = dr.gather(mi.Float, self._upto, base + row, active)
        a = dr.gather(mi.Float, self._of_v, base + row, active)
        b = dr.gather(mi.Float, self._of_v, base + row + 1, active)
        t = invert_linear(a, b, (u.y - begin) * (2 * (self._rows - 1)))
        at = (base + row) * self._columns
        wanted = u.x * (a + t * (b - a))
        last = self._columns - 1

        def upto(column: Any) -> Any:
            low = dr.gather(mi.Float, self._along, at + column, active)
            high = dr.gather(mi.Float, self._along, at + self._columns + column, active)
            return low + t * (high - low)

        column = dr.binary_search(0, last, lambda column: upto(column) <= wanted)
        column = dr.minimum(dr.maximum(column, 1) - 1, last - 1)
        cell = (node * (self._rows - 1) + row) * (self._columns - 1) + column
        corners = dr.gather(mi.Vector4f, self._cells, cell, active)
        a = corners.x + t * (corners.z - corners.x)
        b = corners.y + t * (corners.w - corners.y)
        f = invert_linear(a, b, (wanted - upto(column)) * (2 * (self._columns - 1)))
        return (mi.Float(row) + t) / (self._rows - 1), (mi.Float(column) + f) / (self._columns - 1)

    @staticmethod
    def _max_phi(cos_i: Any, sin_i: Any, cos_h: Any, sin_h: Any) -> Any:
        denominator = 2 * sin_h * cos_h * sin_i
        numerator = -cos_i * (2 * dr.square(cos_h) - 1)
        ratio = dr.select(denominator > 0, numerator / denominator, dr.sign(numerator))
        return dr.safe_acos(ratio)

    def pdf(self, wi: Any, wo: Any, at: Any, active: Any) -> Any:
        """The density by solid angle of wo, for directions above the surface."""
        nodes, theta_max, sin_i, cosine = at
        density = cosine * wo.z / dr.pi
        if not self._any_lobe:
            return density
        h = wi + wo
        length = dr.norm(h)
        h = h / length
        sin_h = dr.sqrt(dr.square(h.x) + dr.square(h.y))
        v = dr.sqrt(dr.minimum(dr.atan2(sin_h, h.z) / theta_max, 1))
        widest = self._max_phi(wi.z, sin_i, h.z, sin_h)
        phi = dr.atan2(h.y * wi.x - h.x * wi.y, h.x * wi.x + h.y * wi.y)
        phi = dr.select(sin_i > 1e-9, phi, dr.atan2(h.y, h.x))
        part = dr.minimum(phi / widest, 1)
        s = dr.clip((part + 1) / 2, 0, 1) if self._around else dr.minimum(dr.abs(part), 1)
        # dω_o / (dv ds), as half_vectors has it; length / 2 is wi . h.
        scale = 2 * length * sin_h * 2 * v * theta_max * 2 * widest
        drawn = self._density_at(nodes, v, s, active)
        return density + dr.select(scale > 0, (1 - cosine) * drawn / scale, 0)

    def draw(self, wi: Any, at: Any, sample1: Any, sample2: Any, active: Any) -> Any:
        """A direction wo, perhaps below the surface by rounding."""
        nodes, theta_max, sin_i, cosine = at
        diffuse = mi.warp.square_to_cosine_hemisphere(sample2)
        if not self._any_lobe:
            return diffuse
        side = sample2.x * 2 - 1
        u = mi.Point2f(sample2.x if self._around else dr.abs(side), sample2.y)
        choice = (sample1 - cosine) / dr.maximum(1 - cosine, 1e-6)
        v, s = self._draw_by_table(nodes, choice, u, active)
        theta_h = dr.square(v) * theta_max
        sin_h, cos_h = dr.sincos(theta_h)
        widest = self._max_phi(wi.z, sin_i, cos_h, sin_h)
        phi = widest * (2 * s - 1 if self._around else dr.mulsign(s, side))
        sin_phi, cos_phi = dr.sincos(phi)
        upright = sin_i > 1e-9
        x = dr.select(upright, wi.x / sin_i, 1)
        y = dr.select(upright, wi.y / sin_i, 0)
        h = mi.Vector3f(sin_h * (cos_phi * x - sin_phi * y), sin_h * (cos_phi * y + sin_phi * x), cos_h)
        lobe = dr.fma(2 * dr.dot(wi, h), h, -wi)
        return dr.select(sample1 < cosine, diffuse, lobe)
