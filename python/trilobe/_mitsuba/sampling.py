"""Sampling of half vectors in compiled variants of Mitsuba."""

from __future__ import annotations

from typing import Any

import numpy as np

from trilobe._mitsuba.renderer import dr, mi
from trilobe._mitsuba.tables import turns
from trilobe._model.brdf import Brdf

# Share of half vectors drawn by the cosine, lest something between the nodes be missed.
_COSINE_SHARE = 0.01


def invert_linear(a: Any, b: Any, twice: Any) -> Any:
    """The part of a step in which a density that goes from a to b has half of `twice` as its integral."""
    root = a + dr.safe_sqrt(dr.fma(b - a, twice, a * a))
    return dr.select(root > 0, dr.clip(twice / root, 0, 1), 0.5)


class Nodes:
    """Ascending numbers, found again by a coordinate in [0, 1] in which they are at least two BINS apart."""

    BINS = 4096

    def __init__(self, values: Any, coordinates: Any) -> None:
        self._last = len(values) - 2
        self._values = mi.Float(np.asarray(values, np.float32))
        # Half a bin early, whatever the rounding of the coordinate.
        begin = np.searchsorted(coordinates, (np.arange(self.BINS + 1) - 0.5) / self.BINS, side="right") - 1
        self._guide = mi.UInt32(np.clip(begin, 0, self._last).astype(np.uint32))

    def interval(self, x: Any, coordinate: Any, active: Any = True) -> tuple[Any, Any, Any]:
        """The nodes between which x lies: the first of them, its value, and their distance."""
        low = dr.gather(mi.UInt32, self._guide, mi.UInt32(dr.clip(coordinate, 0, 1) * self.BINS), active)
        above = dr.gather(mi.Float, self._values, low + 1, active)
        low = dr.select((above <= x) & (low < self._last), low + 1, low)
        begin, end = self.ends(low, active)
        return low, begin, end - begin

    def ends(self, low: Any, active: Any = True) -> tuple[Any, Any]:
        """The nodes low and low + 1."""
        return dr.gather(mi.Float, self._values, low, active), dr.gather(mi.Float, self._values, low + 1, active)


def coordinate_of_y(sin_h: Any, cos_h: Any) -> Any:
    """The root of theta_h, in which the entries of D are apart."""
    return dr.safe_sqrt(dr.atan2(sin_h, cos_h) * (2 / dr.pi))


class Sampling:
    """Half vectors are drawn by the table that `Brdf.sample` draws by (docs/rendering.md#how-it-samples).

    Its density is linear between nodes of wi. So it is that of drawing by one of the nodes around wi, chosen as often
    as its weight and its integral say.
    """

    def __init__(self, brdf: Brdf) -> None:
        self._any_lobe = brdf.lobes > 0
        self._around = brdf.anisotropic
        self._diffuse = mi.Float(float(np.pi * np.mean(brdf.d)))
        dr.make_opaque(self._diffuse)
        if not self._any_lobe:
            return
        table = brdf._material.half_vectors()
        values = table["values"]
        self._phis, self._rows, self._columns = values.shape[1:]
        # The corners of each cell of (y, s) are one load.
        low, high = values[..., :-1, :], values[..., 1:, :]
        cells = np.stack([low[..., :-1], low[..., 1:], high[..., :-1], high[..., 1:]], axis=-1)
        # The integral over s up to each node.
        along = np.zeros(values.shape)
        means = (values[..., 1:].astype(float) + values[..., :-1]) / 2
        along[..., 1:] = np.cumsum(means, axis=-1) / (self._columns - 1)
        self._cells, self._of_row, self._upto, self._along = (
            mi.Float(np.ascontiguousarray(array, np.float32).ravel())
            for array in (cells, table["of_row"], table["cumulated"], along)
        )
        theta_h = np.arcsin(np.sqrt(table["y"]))
        self._y = Nodes(table["y"], np.sqrt(theta_h * (2 / np.pi)))
        self._theta_i = Nodes(table["theta_i"], table["theta_i"] * (2 / np.pi))

    def incident(self, wi: Any) -> Any:
        """The distribution to draw from for wi.

        Nodes with weights and integrals, the sum of these, the largest y, sin theta_i, and how often the cosine is.
        """
        sin_i = dr.sqrt(dr.square(wi.x) + dr.square(wi.y))
        end = dr.minimum((1 + sin_i) / 2, 1)  # beyond it no wo is above the surface
        nodes: list[tuple[Any, Any, Any]] = []
        lobes, cosine = mi.Float(0), mi.Float(1)
        if self._any_lobe:
            theta = dr.atan2(sin_i, wi.z)
            ring, begin, width = self._theta_i.interval(theta, theta * (2 / dr.pi))
            t = dr.clip((theta - begin) / width, 0, 1)
            around = [(ring, 1 - t), (ring + 1, t)]
            if self._around:
                x = dr.select(sin_i > 1e-9, turns(wi.x, wi.y), 0) * self._phis
                left = dr.minimum(mi.UInt32(x), self._phis - 1)
                f = x - mi.Float(left)
                right = dr.select(left + 1 < self._phis, left + 1, 0)
                around = [
                    (ring * self._phis + phi, of_ring * weight)
                    for ring, of_ring in around
                    for phi, weight in ((left, 1 - f), (right, f))
                ]
            row, begin, width = self._y.interval(end, coordinate_of_y(dr.sqrt(end), dr.safe_sqrt(1 - end)))
            part = end - begin
            for node, weight in around:
                at = node * self._rows + row
                a, b = (dr.gather(mi.Float, self._of_row, at + k) for k in (0, 1))
                total = dr.gather(mi.Float, self._upto, at) + part * (a + (b - a) * part / (2 * width))
                nodes.append((node, weight, total))
            lobes = sum(weight * total for _, weight, total in nodes)
            diffuse = self._diffuse + _COSINE_SHARE * lobes
            cosine = dr.select(lobes > 0, diffuse / (diffuse + lobes), 1)
        return nodes, lobes, end, sin_i, cosine

    def _density_at(self, nodes: list[tuple[Any, Any, Any]], y: Any, coordinate: Any, s: Any, active: Any) -> Any:
        row, begin, width = self._y.interval(y, coordinate, active)
        t, x = dr.clip((y - begin) / width, 0, 1), s * (self._columns - 1)
        column = dr.minimum(mi.UInt32(x), self._columns - 2)
        f = x - mi.Float(column)
        cell = row * (self._columns - 1) + column
        size = (self._rows - 1) * (self._columns - 1)
        corners: Any = sum(w * dr.gather(mi.Vector4f, self._cells, node * size + cell, active) for node, w, _ in nodes)
        return (1 - t) * ((1 - f) * corners.x + f * corners.y) + t * ((1 - f) * corners.z + f * corners.w)

    def _draw_by_table(
        self, nodes: list[tuple[Any, Any, Any]], lobes: Any, choice: Any, u: Any, active: Any
    ) -> tuple[Any, Any]:
        """A pair (y, s), by one of the nodes."""
        node, _, total = nodes[0]
        left = choice * lobes
        for other, weight, of_other in nodes[:0:-1]:
            part = weight * of_other
            chosen = (left >= 0) & (left < part)
            node, total = dr.select(chosen, other, node), dr.select(chosen, of_other, total)
            left = left - part
        base = node * self._rows
        wanted = u.y * total
        last = self._rows - 1
        row = dr.binary_search(0, last, lambda row: dr.gather(mi.Float, self._upto, base + row, active) <= wanted)
        row = dr.minimum(dr.maximum(row, 1) - 1, last - 1)
        begin, end = self._y.ends(row, active)
        a, b = (dr.gather(mi.Float, self._of_row, base + row + k, active) for k in (0, 1))
        wanted = wanted - dr.gather(mi.Float, self._upto, base + row, active)
        t = invert_linear(a, b, 2 * wanted / (end - begin))
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
        return begin + t * (end - begin), (mi.Float(column) + f) / (self._columns - 1)

    @staticmethod
    def _max_phi(cos_i: Any, sin_i: Any, cos_h: Any, sin_h: Any) -> Any:
        denominator = 2 * sin_h * cos_h * sin_i
        numerator = -cos_i * (2 * dr.square(cos_h) - 1)
        ratio = dr.select(denominator > 0, numerator / denominator, dr.sign(numerator))
        return dr.safe_acos(ratio)

    def pdf(self, wi: Any, wo: Any, at: Any, active: Any) -> Any:
        """The density by solid angle of wo, for directions above the surface."""
        nodes, lobes, end, sin_i, cosine = at
        density = cosine * wo.z / dr.pi
        if not self._any_lobe:
            return density
        h = wi + wo
        length = dr.norm(h)
        h = h / length
        y = dr.square(h.x) + dr.square(h.y)
        sin_h = dr.sqrt(y)
        widest = self._max_phi(wi.z, sin_i, h.z, sin_h)
        phi = dr.atan2(h.y * wi.x - h.x * wi.y, h.x * wi.x + h.y * wi.y)
        phi = dr.select(sin_i > 1e-9, phi, dr.atan2(h.y, h.x))
        part = dr.minimum(phi / widest, 1)
        s = dr.clip((part + 1) / 2, 0, 1) if self._around else dr.minimum(dr.abs(part), 1)
        # dω_o = 4 (wi . h) dω_h, cos theta_h dω_h = dy dphi / 2, dphi = 2 phi_max ds; length / 2 is wi . h.
        scale = 2 * length * widest * lobes
        drawn = self._density_at(nodes, y, coordinate_of_y(sin_h, h.z), s, active & (y <= end)) * h.z
        return density + dr.select((scale > 0) & (y <= end), (1 - cosine) * drawn / scale, 0)

    def draw(self, wi: Any, at: Any, sample1: Any, sample2: Any, active: Any) -> Any:
        """A direction wo, perhaps below the surface by rounding."""
        nodes, lobes, end, sin_i, cosine = at
        diffuse = mi.warp.square_to_cosine_hemisphere(sample2)
        if not self._any_lobe:
            return diffuse
        side = sample2.x * 2 - 1
        u = mi.Point2f(sample2.x if self._around else dr.abs(side), sample2.y)
        choice = (sample1 - cosine) / dr.maximum(1 - cosine, 1e-6)
        y, s = self._draw_by_table(nodes, lobes, choice, u, active)
        y = dr.minimum(y, end)
        sin_h, cos_h = dr.sqrt(y), dr.safe_sqrt(1 - y)
        widest = self._max_phi(wi.z, sin_i, cos_h, sin_h)
        phi = widest * (2 * s - 1 if self._around else dr.mulsign(s, side))
        sin_phi, cos_phi = dr.sincos(phi)
        upright = sin_i > 1e-9
        x = dr.select(upright, wi.x / sin_i, 1)
        z = dr.select(upright, wi.y / sin_i, 0)
        h = mi.Vector3f(sin_h * (cos_phi * x - sin_phi * z), sin_h * (cos_phi * z + sin_phi * x), cos_h)
        lobe = dr.fma(2 * dr.dot(wi, h), h, -wi)
        return dr.select(sample1 < cosine, diffuse, lobe)
