"""The tables of a model as Dr.Jit arrays, read as the model reads them (docs/model.md#how-a-table-is-read)."""

from __future__ import annotations

from typing import Any

import numpy as np

from trilobe._mitsuba.renderer import dr, mi
from trilobe._model.brdf import Brdf


class Columns:
    """Tables side by side, four an array, so that those that are read together are one load."""

    def __init__(self, count: int, size: int, extra: Any = None) -> None:
        """Makes `count` tables of `size` entries; `extra` is one more, that never changes."""
        self.count = count
        self._size = size
        self._indices: list[Any] = []
        self._masks: list[Any] = []
        self._extra = None if extra is None else np.asarray(extra, np.float32)
        total = count + (extra is not None)
        for begin in range(0, total, 4):
            columns = np.arange(begin, begin + 4)
            index = columns[None, :] * size + np.arange(size)[:, None]
            mask = np.broadcast_to(columns[None, :] < total, index.shape)
            self._indices.append(mi.UInt32(np.where(mask, index, 0).astype(np.uint32).ravel()))
            self._masks.append(mi.Bool(np.ascontiguousarray(mask).ravel()))
        self.chunks: list[Any] = []

    def fill(self, flat: Any) -> None:
        """Takes the entries, table by table."""
        if self._extra is not None:
            flat = dr.concat([flat, mi.Float(self._extra)])
        self.chunks = [dr.gather(mi.Float, flat, index, mask) for index, mask in zip(self._indices, self._masks)]
        dr.eval(self.chunks)

    def at(self, entry: Any, active: Any) -> list[Any]:
        """All tables at an entry, four in a vector."""
        return [dr.gather(mi.Vector4f, chunk, entry, active) for chunk in self.chunks]


def mix(columns: Columns, places: list[tuple[Any, Any]], active: Any) -> list[Any]:
    """The weighted sum of the tables at some entries, a number for each table."""
    sums: list[Any] = [0] * len(columns.chunks)
    for entry, weight in places:
        for k, vector in enumerate(columns.at(entry, active)):
            sums[k] = sums[k] + weight * vector
    return [component for vector in sums for component in (vector.x, vector.y, vector.z, vector.w)]


def linear(coordinate: Any, size: int) -> list[tuple[Any, Any]]:
    """Entries and weights of linear interpolation between the centres of bins of unit width, constant beyond."""
    x = dr.clip(coordinate - 0.5, 0, size - 1)
    low = dr.minimum(mi.UInt32(x), max(size - 2, 0))
    t = x - mi.Float(low)
    return [(low, 1 - t), (dr.minimum(low + 1, size - 1), t)]


def catmull_rom(coordinate: Any, size: int) -> list[tuple[Any, Any]]:
    """The same by a spline, over a table with one more entry on each side."""
    x = dr.clip(coordinate - 0.5, 0, size - 1)
    low = dr.minimum(mi.UInt32(x), size - 2)
    t = x - mi.Float(low)
    t2 = t * t
    t3 = t2 * t
    weights = (
        -0.5 * t + t2 - 0.5 * t3,
        1 - 2.5 * t2 + 1.5 * t3,
        0.5 * t + 2 * t2 - 1.5 * t3,
        -0.5 * t2 + 0.5 * t3,
    )
    return [(low + k, weight) for k, weight in enumerate(weights)]


def turns(x: Any, y: Any) -> Any:
    turns = dr.atan2(y, x) * (0.5 / dr.pi)
    return dr.select(turns < 0, turns + 1, turns)


class Tables:
    """The tables of a model as compiled variants read them."""

    def __init__(self, brdf: Brdf) -> None:
        self.lobes = brdf.lobes
        self.anisotropic = brdf.anisotropic
        self._axes = {name: brdf._material.axis(name) for name in "DFG"}
        self._stretch = brdf.stretch
        self._columns = {}
        for name, axis in self._axes.items():
            size, count = axis["size"], self._count(axis)
            if axis["rule"] == "spline":
                # Splines have one node more on each side; the cosines are splined likewise (docs/model.md).
                cosines = np.cos((np.arange(size) + 0.5) * np.pi / 2 / size)
                ends = (2 * cosines[0] - cosines[1], 2 * cosines[-1] - cosines[-2])
                self._columns[name] = Columns(count, size + 2, [ends[0], *cosines, ends[1]])
            else:
                self._columns[name] = Columns(count, size)
        polar = {name: axis for name, axis in self._axes.items() if axis["rule"] == "polar"}
        self._rings = {name: [float(x) for x in axis["theta_nodes"]] for name, axis in polar.items()}

    def _count(self, axis: dict[str, Any]) -> int:
        return (self.lobes if axis["per_lobe"] else 1) * (3 if axis["per_channel"] else 1)

    def fill(self, d: Any, s: Any, tables: dict[str, Any]) -> None:
        """Takes flat arrays, gradients and all."""
        self._d, self._s = d, s
        if self.lobes == 0:  # whose tables have no entries
            return
        for name, flat in tables.items():
            if self._axes[name]["rule"] == "spline":
                size = self._axes[name]["size"]
                count = self._count(self._axes[name])
                node = np.arange(size + 2) - 1
                inner = np.clip(node, 0, size - 1)
                beside = np.clip(np.where(node < 0, 1, size - 2), 0, size - 1)
                outside = np.tile((node < 0) | (node >= size), count)
                offset = np.arange(count)[:, None] * size
                first = mi.UInt32((offset + inner).astype(np.uint32).ravel())
                second = mi.UInt32((offset + beside).astype(np.uint32).ravel())
                value, other = dr.gather(mi.Float, flat, first), dr.gather(mi.Float, flat, second)
                flat = dr.select(mi.Bool(outside), 2 * value - other, value)
            self._columns[name].fill(flat)

    def value(self, wi: Any, wo: Any, active: Any) -> Any:
        """f of three channels [1/sr], for directions above the surface."""
        rho = [dr.gather(mi.Float, self._d, mi.UInt32(c)) for c in range(3)]
        if self.lobes == 0:
            return mi.Color3f(*rho)
        h = wi + wo
        length = dr.norm(h)
        h = h / length
        cos_d = dr.minimum(length / 2, 1)
        sin_h = dr.sqrt(dr.square(h.x) + dr.square(h.y))
        theta_h = dr.atan2(sin_h, h.z)
        per_lobe_D = self._read_D(wi, wo, h, theta_h, sin_h, cos_d, active)
        size = self._axes["F"]["size"]
        F = mix(self._columns["F"], linear(dr.safe_acos(cos_d) * (2 / dr.pi * size), size), active)
        G, inverse = self._read_G(wi, wo, active)
        for m in range(self.lobes):
            for c in range(3):
                s = dr.gather(mi.Float, self._s, mi.UInt32(3 * m + c))
                D = per_lobe_D[m][self._table("D", m, c)]
                term = D * F[self._table("F", m, c)] * G[self._table("G", m, c)]
                rho[c] = rho[c] + s * term * inverse
        return dr.maximum(mi.Color3f(*rho), 0)

    def _table(self, name: str, lobe: int, channel: int) -> int:
        axis = self._axes[name]
        first = lobe * (3 if axis["per_channel"] else 1) if axis["per_lobe"] else 0
        return first + (channel if axis["per_channel"] else 0)

    def _read_D(self, wi: Any, wo: Any, h: Any, theta_h: Any, sin_h: Any, cos_d: Any, active: Any) -> list[list[Any]]:
        """The tables of D as each lobe reads them."""
        columns, axis = self._columns["D"], self._axes["D"]
        if axis["rule"] == "polar":
            at = mix(columns, self._polar("D", h, theta_h, sin_h), active)
            return [at] * self.lobes
        size = axis["size"]
        read: dict[tuple[float, float], list[Any]] = {}
        for along, across in self._stretch:
            if (along, across) in read:
                continue
            theta = theta_h
            if along != 0 or across != 0:
                sines = 2 * sin_h * dr.safe_sqrt(1 - dr.square(cos_d))
                cosine = dr.select(sines > 0, dr.clip((wo.z - wi.z) / sines, -1, 1), 1)
                log = dr.log(dr.maximum(cos_d, 1e-6))
                factor = dr.square(cosine) * dr.exp(2 * along * log)
                factor += (1 - dr.square(cosine)) * dr.exp(2 * across * log)
                theta = dr.minimum(theta_h * dr.sqrt(factor), dr.pi / 2)
            read[along, across] = mix(columns, linear(dr.sqrt(theta * (2 / dr.pi)) * size, size), active)
        return [read[pair] for pair in self._stretch]

    def _read_G(self, wi: Any, wo: Any, active: Any) -> tuple[list[Any], Any]:
        """G(wi) G(wo) of each table, and 1 / (cos theta_i cos theta_o) as it is read."""
        columns, axis = self._columns["G"], self._axes["G"]
        if axis["rule"] == "polar":
            at = []
            for w in (wi, wo):
                sine = dr.sqrt(dr.square(w.x) + dr.square(w.y))
                at.append(mix(columns, self._polar("G", w, dr.safe_acos(w.z), sine), active))
            return [i * o for i, o in zip(*at)], dr.rcp(wi.z * wo.z)
        size = axis["size"]
        scale = 2 / dr.pi * size
        at = [mix(columns, catmull_rom(dr.safe_acos(w.z) * scale, size), active) for w in (wi, wo)]
        products = [i * o for i, o in zip(*at)]
        return products, dr.rcp(products[columns.count])

    def _polar(self, name: str, w: Any, theta: Any, sine: Any) -> list[tuple[Any, Any]]:
        rings, phis = self._rings[name], self._axes[name]["phi_nodes"]
        degrees = theta * (180 / dr.pi)
        low, begin, width = mi.UInt32(0), mi.Float(rings[0]), mi.Float(1)
        for k in range(len(rings) - 1):
            above = degrees >= rings[k] if k > 0 else mi.Bool(True)
            low = dr.select(above, mi.UInt32(k), low)
            begin = dr.select(above, rings[k], begin)
            width = dr.select(above, rings[k + 1] - rings[k], width)
        t = dr.clip((degrees - begin) / width, 0, 1)
        if phis == 1:
            return [(low, 1 - t), (dr.minimum(low + 1, len(rings) - 1), t)]
        x = dr.select(sine > 1e-9, turns(w.x, w.y), 0) * phis
        left = dr.minimum(mi.UInt32(x), phis - 1)
        f = x - mi.Float(left)
        right = dr.select(left + 1 < phis, left + 1, 0)
        below, above = low * phis, dr.minimum(low + 1, len(rings) - 1) * phis
        return [
            (below + left, (1 - t) * (1 - f)),
            (below + right, (1 - t) * f),
            (above + left, t * (1 - f)),
            (above + right, t * f),
        ]
