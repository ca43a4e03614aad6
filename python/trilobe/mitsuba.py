"""A BSDF `trilobe` for Mitsuba 3, which importing this registers, for all variants that are set from then on.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    import trilobe.mitsuba

    mi.load_dict({"type": "sphere", "bsdf": {"type": "trilobe", "filename": "model.json"}})
    mi.load_dict({"type": "sphere", "bsdf": trilobe.mitsuba.bsdf(brdf)})

It reflects on the front side; put it into a `twosided` for both. All forms of the model, isotropic and anisotropic,
with RGB, spectral and monochrome colours. In variants that compile, tables are Dr.Jit arrays, and no Python runs for
a ray; they can be optimised: ``mi.traverse(scene)`` has d, s, D, F and G of it. In scalar variants each ray calls
Python, which is slow, but exact.

Parameters: `filename`, a model file, or `json`, its text; `update_sampling` (true), whether what is drawn follows
tables that are optimised.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from trilobe._brdf import Brdf, load
from trilobe._core import Error
from trilobe._half_vectors import THETA_NODES, half_vectors

try:
    import drjit as dr
    import mitsuba as mi
except ImportError:
    raise ImportError("trilobe.mitsuba needs Mitsuba 3: pip install mitsuba") from None

if tuple(int(part) for part in mi.__version__.split(".")[:2]) < (3, 6):
    raise ImportError(f"trilobe.mitsuba needs Mitsuba 3.6 or newer, not {mi.__version__}: pip install -U mitsuba")

__all__ = ["bsdf"]

# Of the half vectors, so much is drawn by the cosine, lest something between the nodes be missed.
_COSINE_SHARE = 0.01
_CLASSES: dict[str, Any] = {}


def bsdf(brdf: Brdf, **parameters: Any) -> dict[str, Any]:
    """What `mi.load_dict` makes the material of."""
    if not isinstance(brdf, Brdf):
        raise Error("the model must be a trilobe.Brdf")
    return {"type": "trilobe", "json": brdf.to_json(), **parameters}


def _brdf_of(props: Any) -> Brdf:
    given = [name for name in ("filename", "json") if name in props]
    if len(given) != 1:
        raise Error("a trilobe BSDF needs either filename, a model file, or json, its text")
    if given[0] == "json":
        return Brdf.from_json(str(props["json"]), "the BSDF's json")
    return load(str(mi.file_resolver().resolve(str(props["filename"]))))


class _Columns:
    """Tables side by side, four an array, so that those that are read together are one load."""

    def __init__(self, count: int, size: int, extra: Any = None) -> None:
        """Of so many tables of so many entries; `extra` is one more, that never changes."""
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


def _mix(columns: _Columns, places: list[tuple[Any, Any]], active: Any) -> list[Any]:
    """The weighted sum of the tables at some entries, a number for each table."""
    sums: list[Any] = [0] * len(columns.chunks)
    for entry, weight in places:
        for k, vector in enumerate(columns.at(entry, active)):
            sums[k] = sums[k] + weight * vector
    return [component for vector in sums for component in (vector.x, vector.y, vector.z, vector.w)]


def _linear(coordinate: Any, size: int) -> list[tuple[Any, Any]]:
    """Between the centres of bins of unit width, constant beyond the outer ones."""
    x = dr.clip(coordinate - 0.5, 0, size - 1)
    low = dr.minimum(mi.UInt32(x), max(size - 2, 0))
    t = x - mi.Float(low)
    return [(low, 1 - t), (dr.minimum(low + 1, size - 1), t)]


def _catmull_rom(coordinate: Any, size: int) -> list[tuple[Any, Any]]:
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


def _turns(x: Any, y: Any) -> Any:
    turns = dr.atan2(y, x) * (0.5 / dr.pi)
    return dr.select(turns < 0, turns + 1, turns)


class _Tables:
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
                # With one node more on each side, and the cosines that are splined, too (docs/model.md).
                cosines = np.cos((np.arange(size) + 0.5) * np.pi / 2 / size)
                ends = (2 * cosines[0] - cosines[1], 2 * cosines[-1] - cosines[-2])
                self._columns[name] = _Columns(count, size + 2, [ends[0], *cosines, ends[1]])
            else:
                self._columns[name] = _Columns(count, size)
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
        F = _mix(self._columns["F"], _linear(dr.safe_acos(cos_d) * (2 / dr.pi * size), size), active)
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
            at = _mix(columns, self._polar("D", h, theta_h, sin_h), active)
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
            read[along, across] = _mix(columns, _linear(dr.sqrt(theta * (2 / dr.pi)) * size, size), active)
        return [read[pair] for pair in self._stretch]

    def _read_G(self, wi: Any, wo: Any, active: Any) -> tuple[list[Any], Any]:
        """G(wi) G(wo) of each table, and 1 / (cos theta_i cos theta_o) as it is read."""
        columns, axis = self._columns["G"], self._axes["G"]
        if axis["rule"] == "polar":
            at = []
            for w in (wi, wo):
                sine = dr.sqrt(dr.square(w.x) + dr.square(w.y))
                at.append(_mix(columns, self._polar("G", w, dr.safe_acos(w.z), sine), active))
            return [i * o for i, o in zip(*at)], dr.rcp(wi.z * wo.z)
        size = axis["size"]
        scale = 2 / dr.pi * size
        at = [_mix(columns, _catmull_rom(dr.safe_acos(w.z) * scale, size), active) for w in (wi, wo)]
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
        x = dr.select(sine > 1e-9, _turns(w.x, w.y), 0) * phis
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


def _invert_linear(a: Any, b: Any, twice: Any) -> Any:
    """The part of a step in which a density that goes from a to b has half of `twice` as its integral."""
    root = a + dr.safe_sqrt(dr.fma(b - a, twice, a * a))
    return dr.select(root > 0, dr.clip(twice / root, 0, 1), 0.5)


class _Sampling:
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
                y = dr.select(sin_i > 1e-9, _turns(wi.x, wi.y), 0) * self._phis
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
        t = _invert_linear(a, b, (u.y - begin) * (2 * (self._rows - 1)))
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
        f = _invert_linear(a, b, (wanted - upto(column)) * (2 * (self._columns - 1)))
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


def _define() -> Any:
    """The BSDF of the current variant."""
    compiled = dr.is_jit_v(mi.Float)

    class Trilobe(mi.BSDF):  # type: ignore[misc]
        """A fitted model (trilobe.mitsuba)."""

        def __init__(self, props: Any) -> None:
            mi.BSDF.__init__(self, props)
            self._brdf = _brdf_of(props)
            self._follows = bool(props.get("update_sampling", True))
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            if self._brdf.anisotropic:
                flags = flags | mi.BSDFFlags.Anisotropic
            self.m_components = [flags]
            self.m_flags = flags
            self.d = mi.TensorXf(np.asarray(self._brdf.d, np.float32))
            self.s = mi.TensorXf(np.asarray(self._brdf.s, np.float32))
            self.D, self.F, self.G = (
                mi.TensorXf(np.asarray(getattr(self._brdf, name), np.float32)) for name in "DFG"
            )
            self._colours = _Upsampling() if mi.is_spectral else None
            if compiled:
                self._tables = _Tables(self._brdf)
                self._fill()
                self._sampling = _Sampling(self._brdf)

        def _fill(self) -> None:
            tables = {name: getattr(self, name).array for name in "DFG"}
            self._tables.fill(self.d.array, self.s.array, tables)

        def traverse(self, callback: Any) -> None:
            for name in ("d", "s", "D", "F", "G") if self._brdf.lobes > 0 else ("d",):
                callback.put(name, getattr(self, name), mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys: Any = ()) -> None:
            if compiled:
                self._fill()
            if self._follows or not compiled:
                parts = {
                    name: np.maximum(np.nan_to_num(np.array(dr.detach(getattr(self, name)), np.float64)), 0)
                    for name in (("d", "s", "D", "F", "G") if self._brdf.lobes > 0 else ("d",))
                }
                self._brdf = self._brdf.replace(**parts)
                if compiled:
                    self._sampling = _Sampling(self._brdf)

        # What all variants share.

        def _spectrum(self, si: Any, colour: Any) -> Any:
            if self._colours is not None:
                value = self._colours(colour, si.wavelengths)
            elif mi.is_monochromatic:
                value = mi.Color1f(mi.luminance(colour))
            else:
                value = mi.Color3f(colour)
            return mi.depolarizer(value) if mi.is_polarized else value

        def _both(self, si: Any, wo: Any, active: Any) -> tuple[Any, Any]:
            """The value times cos theta_o, and the density."""
            wi = si.wi
            if not compiled:
                value = self._brdf.eval_cos(np.array(wi, np.float32).ravel(), np.array(wo, np.float32).ravel())
                pdf = self._brdf.pdf(np.array(wi, np.float32).ravel(), np.array(wo, np.float32).ravel())
                return self._spectrum(si, mi.Color3f([float(x) for x in value])), float(pdf)
            active = active & (wi.z > 0) & (wo.z > 0)
            colour = self._tables.value(wi, wo, active) * wo.z
            with dr.suspend_grad():
                wi, wo = dr.detach(wi), dr.detach(wo)
                pdf = self._sampling.pdf(wi, wo, self._sampling.incident(wi), active)
            return dr.select(active, self._spectrum(si, colour), 0), dr.select(active, pdf, 0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            wi = si.wi
            if not compiled:
                return self._both(si, wo, active)[0]
            active = active & (wi.z > 0) & (wo.z > 0)
            colour = self._tables.value(wi, wo, active) * wo.z
            return dr.select(active, self._spectrum(si, colour), 0)

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            wi = si.wi
            if not compiled:
                return float(self._brdf.pdf(np.array(wi, np.float32).ravel(), np.array(wo, np.float32).ravel()))
            active = active & (wi.z > 0) & (wo.z > 0)
            with dr.suspend_grad():
                wi, wo = dr.detach(wi), dr.detach(wo)
                pdf = self._sampling.pdf(wi, wo, self._sampling.incident(wi), active)
            return dr.select(active, pdf, 0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self._both(si, wo, active)

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            drawn = mi.BSDFSample3f()
            drawn.eta = 1
            drawn.sampled_component = mi.UInt32(0)
            drawn.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            if not compiled:
                wi = np.array(si.wi, np.float32).ravel()
                wo, pdf, weight = self._brdf.sample(wi, np.array(sample2, np.float32).ravel())
                drawn.wo, drawn.pdf = mi.Vector3f([float(x) for x in wo]), float(pdf)
                return drawn, self._spectrum(si, mi.Color3f([float(x) for x in weight]))
            active = active & (si.wi.z > 0)
            with dr.suspend_grad():
                wi = dr.detach(si.wi)
                at = self._sampling.incident(wi)
                wo = self._sampling.draw(wi, at, sample1, sample2, active)
                active &= wo.z > 0
                pdf = self._sampling.pdf(wi, wo, at, active)
                active &= pdf > 0
            drawn.wo = wo
            drawn.pdf = dr.select(active, pdf, 0)
            colour = self._tables.value(si.wi, wo, active) * (wo.z / drawn.pdf)
            return drawn, dr.select(active, self._spectrum(si, colour), 0)

        def to_string(self) -> str:
            return f"Trilobe[{self._brdf!r}]"

    return Trilobe


class _Upsampling:
    """Spectra of RGB colours, the sums of three that add up to 1 (Mallett and Yuksel 2019)."""

    _tables: Any = None

    def __init__(self) -> None:
        from trilobe._spectra import BEGIN, STEP, basis

        spectra = basis()
        self._begin, self._step, self._size = BEGIN, STEP, spectra.shape[1]
        self._flat = [mi.Float(row.astype(np.float32)) if dr.is_jit_v(mi.Float) else row for row in spectra]

    def __call__(self, colour: Any, wavelengths: Any) -> Any:
        if not dr.is_jit_v(mi.Float):
            grid = self._begin + self._step * np.arange(self._size)
            at = np.array(wavelengths).ravel()
            value = sum(float(colour[c]) * np.interp(at, grid, self._flat[c]) for c in range(3))
            return mi.Spectrum([float(x) for x in value])
        x = dr.clip((wavelengths - self._begin) / self._step, 0, self._size - 1)
        value = mi.Spectrum(0)
        for k in range(len(wavelengths)):
            low = dr.minimum(mi.UInt32(x[k]), self._size - 2)
            t = x[k] - mi.Float(low)
            for c in range(3):
                a = dr.gather(mi.Float, self._flat[c], low)
                b = dr.gather(mi.Float, self._flat[c], low + 1)
                value[k] += colour[c] * ((1 - t) * a + t * b)
        return value


def _register(*_: Any) -> None:
    variant = mi.variant()
    if variant is None or variant in _CLASSES:
        return
    _CLASSES[variant] = _define()
    mi.register_bsdf("trilobe", _CLASSES[variant])


_register()
mi.detail.add_variant_callback(_register)
