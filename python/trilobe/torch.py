"""Models in PyTorch, with gradients with respect to their tables and to directions.

    model = trilobe.torch.Model(brdf)             # a torch.nn.Module: parameters d, s, D, F, G
    f = model(wi, wo)                             # (..., 3) [1/sr]
    trilobe.torch.eval(brdf, wi, wo)              # without a module
    fitted = model.brdf()                         # a trilobe.Brdf again

Values are those of `Brdf.eval`, to 1e-6 of them in float64. A batch of texels is a model whose parameters have one axis
in front: d (texels, 3), s (texels, lobes, 3), D (texels, lobes, 90) and so on, of any of the five; directions are then
(texels, ..., 3).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from trilobe._model.brdf import Brdf
from trilobe._model.error import Error

try:
    import torch
    from torch import Tensor
except ImportError:
    raise ImportError("trilobe.torch needs PyTorch: pip install torch") from None

__all__ = ["Model", "eval"]

_NAMES = ("d", "s", "D", "F", "G")
_SMALL = 1e-12


class Model(torch.nn.Module):
    """A model of any form, whose d, s, D, F and G are parameters.

    Args:
        brdf: the model to start from; its form stays.
        dtype: of the parameters.
        texels: how many sets of them there are, each as `brdf` has them; None for one, without an axis for it.
        shared: names of those of which there is one set for all texels, as "DFG".
    """

    def __init__(
        self, brdf: Brdf, *, dtype: Any = torch.float64, texels: int | None = None, shared: str = ""
    ) -> None:
        """Makes parameters of the tables."""
        super().__init__()
        if not isinstance(brdf, Brdf):
            raise Error("the model must be a trilobe.Brdf")
        if texels is not None and (not isinstance(texels, int) or texels < 1):
            raise Error("texels must be an integer from 1, or None")
        if not isinstance(dtype, torch.dtype) or not dtype.is_floating_point:
            raise Error("dtype must be one of PyTorch's for real numbers, as torch.float32")
        if not isinstance(shared, str) or not set(shared) <= set(_NAMES):
            raise Error("shared must name some of d, s, D, F and G, as 'DFG'")
        self._form = brdf
        for name in _NAMES:
            table = torch.tensor(np.asarray(getattr(brdf, name)), dtype=dtype)
            if texels is not None and name not in shared:
                table = table.expand(texels, *table.shape).clone()
            setattr(self, name, torch.nn.Parameter(table))

    def forward(self, wi: Tensor, wo: Tensor) -> Tensor:
        """f [1/sr] of directions (..., 3)."""
        return eval(self._form, wi, wo, **{name: getattr(self, name) for name in _NAMES})

    def project(self) -> None:
        """Makes negative parameters 0, as an optimiser's step may have left them."""
        with torch.no_grad():
            for parameter in self.parameters():
                parameter.clamp_(min=0)

    def brdf(self, texel: int | None = None) -> Brdf:
        """The model, or that of a texel, with negative parameters made 0."""
        parts = {}
        for name in _NAMES:
            value = getattr(self, name).detach().cpu().numpy().astype(np.float64)
            batched = value.ndim > np.ndim(getattr(self._form, name))
            if batched and texel is None:
                raise Error("there is a model for each texel; give its number")
            if batched and (not isinstance(texel, (int, np.integer)) or not -len(value) <= texel < len(value)):
                raise Error(f"texel must be an integer from 0 to {len(value) - 1}")
            parts[name] = np.maximum(value[texel] if batched else value, 0)
        if self._form.lobes == 0:
            parts = {"d": parts["d"]}
        return self._form.replace(**parts)


def eval(brdf: Brdf, wi: Tensor, wo: Tensor, **parts: Tensor) -> Tensor:
    """The BRDF f [1/sr], without a cosine: (..., 3).

    Args:
        brdf: the model, or the form of one.
        wi: directions (..., 3), of any length; f is 0 below the surface, and NaN of zero, infinite and NaN ones.
        wo: the same; both broadcast.
        **parts: d, s, D, F or G in the place of the model's, perhaps with an axis of texels in front, which is then the
            first axis of the directions.
    """
    if not isinstance(brdf, Brdf):
        raise Error("the model must be a trilobe.Brdf")
    for name, tensor in {"wi": wi, "wo": wo, **parts}.items():
        if not isinstance(tensor, Tensor):
            raise Error(f"{name} must be a tensor of PyTorch")
        if tensor.is_complex():
            raise Error(f"{name} has the dtype {tensor.dtype}, and must be of real numbers")
    for name, w in (("wi", wi), ("wo", wo)):
        if w.ndim == 0 or w.shape[-1] != 3:
            raise Error(f"{name} has the shape {tuple(w.shape)}; directions are a tensor of the shape (..., 3)")
    unknown = set(parts) - set(_NAMES)
    if unknown:
        raise Error(f"there is no {min(unknown)}; there are d, s, D, F and G")
    try:
        shape = np.broadcast_shapes(wi.shape, wo.shape)
    except ValueError:
        raise Error(f"shapes {tuple(wi.shape)} and {tuple(wo.shape)} do not go together") from None
    dtype = torch.promote_types(wi.dtype, wo.dtype)
    if not dtype.is_floating_point:
        dtype = torch.get_default_dtype()
    wi, wo = (w.to(dtype).expand(shape) for w in (wi, wo))
    tables = {}
    texels = None
    for name in _NAMES:
        own = getattr(brdf, name)
        value = parts.get(name)
        if value is None:
            value = torch.tensor(np.asarray(own), dtype=wi.dtype, device=wi.device)
        if value.shape == own.shape:
            value = value[None]
        elif value.shape[1:] == own.shape:
            texels = value.shape[0]
        else:
            raise Error(f"{name} has the shape {tuple(value.shape)}, and must have {own.shape}, or one axis in front")
        tables[name] = value
    if texels is not None and (wi.ndim < 2 or wi.shape[0] != texels):
        raise Error(f"there are {texels} texels, and directions of the shape {tuple(wi.shape)}")
    rows = (texels or 1, -1, 3)
    none = [~w.isfinite().all(dim=-1) | (w == 0).all(dim=-1) for w in (wi.reshape(rows), wo.reshape(rows))]
    wi, wo = (_unit(w.reshape(rows)) for w in (wi, wo))
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    up = torch.tensor([0.0, 0.0, 1.0], dtype=wi.dtype, device=wi.device)
    wi, wo = (torch.where(above[..., None], w, up) for w in (wi, wo))  # so that no gradient is nan
    value = _Reader(brdf, tables).value(wi, wo)
    value = torch.where(above[..., None], value.clamp(min=0), torch.zeros_like(value))
    return torch.where((none[0] | none[1])[..., None], torch.full_like(value, math.nan), value).reshape(shape)


def _unit(w: Tensor) -> Tensor:
    largest = w.detach().abs().amax(dim=-1, keepdim=True)  # lest the square overflow or vanish
    w = w / torch.where((largest > 0) & largest.isfinite(), largest, torch.ones_like(largest))
    length = w.norm(dim=-1, keepdim=True)
    return torch.where(length > 0, w / torch.where(length > 0, length, torch.ones_like(length)), torch.zeros_like(w))


def _hypot(x: Tensor, y: Tensor) -> Tensor:
    square = x * x + y * y
    there = square > _SMALL**2
    return torch.where(there, torch.where(there, square, torch.ones_like(square)).sqrt(), torch.zeros_like(square))


def _at(table: Tensor, index: Tensor) -> Tensor:
    """Entries (texels, n) of tables (texels or 1, tables, size): (texels, tables, n)."""
    texels, n = index.shape
    count = table.shape[1]
    table = table.expand(texels, -1, -1)
    return table.gather(2, index[:, None].expand(texels, count, n))


def _linear(table: Tensor, place: Tensor) -> Tensor:
    """Interpolates between entries of unit distance, constant beyond the outer ones."""
    size = table.shape[-1]
    if size == 1:
        return _at(table, torch.zeros_like(place, dtype=torch.long))
    x = place.clamp(0, size - 1)
    low = x.detach().floor().long().clamp(max=size - 2)
    t = (x - low)[:, None]
    return (1 - t) * _at(table, low) + t * _at(table, low + 1)


def _spline(table: Tensor, place: Tensor) -> Tensor:
    """The same by Catmull-Rom, with one-sided differences at the ends."""
    size = table.shape[-1]
    first, last = 2 * table[..., :1] - table[..., 1:2], 2 * table[..., -1:] - table[..., -2:-1]
    table = torch.cat([first, table, last], dim=-1)
    x = place.clamp(0, size - 1)
    low = x.detach().floor().long().clamp(max=size - 2)
    t = (x - low)[:, None]
    p0, p1, p2, p3 = (_at(table, low + k) for k in range(4))
    return p1 + 0.5 * t * (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * (p1 - p2) + p3 - p0)))


class _Reader:
    """Reads the tables of a form (docs/model.md#how-a-table-is-read)."""

    def __init__(self, brdf: Brdf, tables: dict[str, Tensor]) -> None:
        self._brdf, self._d, self._s = brdf, tables["d"], tables["s"]
        self._axes = {name: brdf._material.axis(name) for name in "DFG"}
        self._tables = {}
        for name in "DFG":
            size = self._axes[name]["size"]
            self._tables[name] = tables[name].reshape(tables[name].shape[0], -1, max(size, 1))

    def value(self, wi: Tensor, wo: Tensor) -> Tensor:
        """rho (texels, n, 3) of directions (texels, n, 3) above the surface."""
        texels, n = wi.shape[:2]
        rho = self._d[:, None, :].expand(texels, n, 3)
        lobes = self._brdf.lobes
        if lobes == 0:
            return rho
        h = wi + wo
        length = h.norm(dim=-1)
        h = h / length[..., None]
        cos_d = (length / 2).clamp(max=1)
        sin_h = _hypot(h[..., 0], h[..., 1])
        theta_h = torch.atan2(sin_h, h[..., 2])
        sin_d = _hypot((wi - wo).norm(dim=-1) / 2, torch.zeros_like(cos_d))
        size = self._axes["F"]["size"]
        F = _linear(self._tables["F"], torch.atan2(sin_d, cos_d) * (2 / math.pi * size) - 0.5)
        D = self._read_D(wi, wo, h, theta_h, sin_h, sin_d, cos_d)
        G, cosines = self._read_G(wi, wo)
        for m in range(lobes):
            of_lobe = [
                D[m][:, self._index("D", m, c)] * F[:, self._index("F", m, c)] * G[:, self._index("G", m, c)]
                for c in range(3)
            ]
            rho = rho + self._s[:, None, m, :] * torch.stack(of_lobe, dim=-1) / cosines[..., None]
        return rho

    def _index(self, name: str, lobe: int, channel: int) -> int:
        axis = self._axes[name]
        channels = 3 if axis["per_channel"] else 1
        return (lobe * channels if axis["per_lobe"] else 0) + (channel if axis["per_channel"] else 0)

    def _read_D(
        self, wi: Tensor, wo: Tensor, h: Tensor, theta_h: Tensor, sin_h: Tensor, sin_d: Tensor, cos_d: Tensor
    ) -> list[Tensor]:
        """The tables as each lobe reads them."""
        table, size = self._tables["D"], self._axes["D"]["size"]
        if self._axes["D"]["rule"] == "polar":
            return [self._polar("D", h, theta_h)] * self._brdf.lobes
        read: dict[tuple[float, float], Tensor] = {}
        for along, across in self._brdf.stretch:
            if (along, across) in read:
                continue
            theta = theta_h
            if along != 0 or across != 0:
                sines = 2 * sin_h * sin_d
                there = sines > _SMALL
                ratio = (wo[..., 2] - wi[..., 2]) / torch.where(there, sines, torch.ones_like(sines))
                square = torch.where(there, ratio.clamp(-1, 1), torch.ones_like(sines)) ** 2
                factor = square * cos_d ** (2 * along) + (1 - square) * cos_d ** (2 * across)
                theta = (theta_h * factor.sqrt()).clamp(max=math.pi / 2)
            part = theta * (2 / math.pi)
            there = part > _SMALL
            root = torch.where(there, torch.where(there, part, torch.ones_like(part)).sqrt(), torch.zeros_like(part))
            read[along, across] = _linear(table, root * size - 0.5)
        return [read[pair] for pair in self._brdf.stretch]

    def _read_G(self, wi: Tensor, wo: Tensor) -> tuple[Tensor, Tensor]:
        """G(wi) G(wo) of each table, and cos theta_i cos theta_o as it is read."""
        table, size = self._tables["G"], self._axes["G"]["size"]
        thetas = [torch.atan2(_hypot(w[..., 0], w[..., 1]), w[..., 2]) for w in (wi, wo)]
        if self._axes["G"]["rule"] == "polar":
            at = [self._polar("G", w, theta) for w, theta in zip((wi, wo), thetas)]
            return at[0] * at[1], wi[..., 2] * wo[..., 2]
        nodes = (torch.arange(size, dtype=wi.dtype, device=wi.device) + 0.5) * (math.pi / 2 / size)
        places = [theta * (2 / math.pi * size) - 0.5 for theta in thetas]
        cosines = [_spline(nodes.cos()[None, None], place)[:, 0] for place in places]
        at = [_spline(table, place) for place in places]
        return at[0] * at[1], cosines[0] * cosines[1]

    def _polar(self, name: str, w: Tensor, theta: Tensor) -> Tensor:
        """Interpolates between rings of theta and, around them, nodes of phi."""
        axis, table = self._axes[name], self._tables[name]
        rings = torch.tensor(axis["theta_nodes"], dtype=theta.dtype, device=theta.device)
        phis = axis["phi_nodes"]
        degrees = theta * (180 / math.pi)
        low = (torch.searchsorted(rings, degrees.detach(), right=True) - 1).clamp(0, len(rings) - 2)
        t = ((degrees - rings[low]) / (rings[low + 1] - rings[low])).clamp(0, 1)[:, None]
        if phis == 1:
            return (1 - t) * _at(table, low) + t * _at(table, low + 1)
        there = _hypot(w[..., 0], w[..., 1]) > 1e-9
        x = torch.where(there, w[..., 0], torch.ones_like(theta))
        y = torch.where(there, w[..., 1], torch.zeros_like(theta))
        turns = torch.atan2(y, x) * (0.5 / math.pi)
        place = torch.where(turns < 0, turns + 1, turns) * phis
        left = place.detach().floor().long().clamp(max=phis - 1)
        f = (place - left)[:, None]
        right = (left + 1) % phis
        below, above = low * phis, (low + 1) * phis
        at_low: Tensor = (1 - f) * _at(table, below + left) + f * _at(table, below + right)
        at_high: Tensor = (1 - f) * _at(table, above + left) + f * _at(table, above + right)
        return (1 - t) * at_low + t * at_high
