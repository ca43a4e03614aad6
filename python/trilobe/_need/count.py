"""How often a scene reads its materials, and where: a path tracer that counts.

A path is followed twice, with the same random numbers (as the radiative backpropagation of Vicini et al. 2021 does it):
once for what it brings, L, and once for what each BSDF on its way has a share in. There L less what came before is what
is still to come; the part of it that a lamp sends, drawn by itself, is counted at (wi, lamp), and the rest, all that
comes by the direction that the BSDF drew, there. So a value of the table counts by the light that went through it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from trilobe._mitsuba.measured import half_difference
from trilobe._mitsuba.renderer import dr, mi

THETA_BINS = 90
_PATHS_AT_ONCE = 1 << 22


class Counts(NamedTuple):
    """Reads of a material, by what they add to the picture; the sum over materials and directions is 1."""

    bins: NDArray[np.float64]
    """Over (theta_h, theta_d, phi_d), as MERL's bins lie."""
    pairs: NDArray[np.float64]
    """Over (theta_i, theta_o), a degree each, in either order."""


class _Places:
    """Indices into one flat array at which a material's pairs of directions count."""

    def __init__(self, shapes: list[tuple[int, int, int]]) -> None:
        self.shapes = shapes
        self.begin = np.cumsum([0, *(int(np.prod(shape)) for shape in shapes)])
        self.size = int(self.begin[-1])

    def bins(self, material: Any, wi: Any, wo: Any) -> Any:
        theta_h, theta_d, phi_d = half_difference(wi, wo)
        x = [dr.sqrt(theta_h * (2 / dr.pi)), theta_d * (2 / dr.pi), phi_d / dr.pi]
        index = mi.UInt32(0)
        for k, shape in enumerate(self.shapes):
            at = [dr.minimum(mi.UInt32(a * size), size - 1) for a, size in zip(x, shape)]
            own = (at[0] * shape[1] + at[1]) * shape[2] + at[2] + int(self.begin[k])
            index = dr.select(material == k, own, index)
        return index

    def pairs(self, material: Any, wi: Any, wo: Any) -> Any:
        i, o = (dr.minimum(mi.UInt32(dr.safe_acos(w.z) * (2 / dr.pi * THETA_BINS)), THETA_BINS - 1) for w in (wi, wo))
        return (mi.UInt32(material) * THETA_BINS + dr.minimum(i, o)) * THETA_BINS + dr.maximum(i, o)


class Counter:
    """Counts in a scene. `sides` has for each BSDF that counts its numbers as a material, in front and behind."""

    def __init__(
        self, scene: Any, sides: list[tuple[Any, int, int]], shapes: list[tuple[int, int, int]], max_depth: int
    ) -> None:
        """Takes BSDFs by the objects that shapes have, and the bins of each material."""
        self._scene, self._max_depth = scene, max_depth
        self._sides = [(mi.BSDFPtr(bsdf), front, back) for bsdf, front, back in sides]
        self._places = _Places(shapes)
        film = scene.sensors()[0].film().crop_size()
        self.width, self.height = int(film[0]), int(film[1])

    def picture(self, spp: int, seed: int) -> NDArray[np.float64]:
        """Linear RGB (height, width, 3) by a box filter."""
        total = np.zeros((self.height * self.width, 3))
        for ray, pixel, sampler in self._rays(spp, seed):
            colour = self._follow(ray, sampler, None, None)
            sums = dr.zeros(mi.Float, 3 * self.height * self.width)
            for c in range(3):
                dr.scatter_reduce(dr.ReduceOp.Add, sums, colour[c], 3 * pixel + c)
            total += np.array(sums, np.float64).reshape(-1, 3)
        return total.reshape(self.height, self.width, 3) / spp

    def count(self, picture: NDArray[np.float64], spp: int, seed: int) -> list[Counts]:
        """Counts what each material is read for. `picture`: beyond its white, more light adds nothing that is seen."""
        light = picture @ [0.2126, 0.7152, 0.0722]
        white = max(float(np.quantile(light, 0.98)), 1e-12)
        weight = mi.Float((1 / np.maximum(light, white)).ravel().astype(np.float32))
        materials = len(self._places.shapes)
        bins = np.zeros(self._places.size)
        pairs = np.zeros(materials * THETA_BINS**2)
        for ray, pixel, sampler in self._rays(spp, seed):
            colour = self._follow(ray, sampler.clone(), None, None)
            dr.eval(colour)
            counted = (dr.zeros(mi.Float, bins.size), dr.zeros(mi.Float, pairs.size))
            dr.eval(counted)
            self._follow(ray, sampler, (colour, dr.gather(mi.Float, weight, pixel)), counted)
            dr.eval(counted)
            bins += np.array(counted[0], np.float64)
            pairs += np.array(counted[1], np.float64)
        total = max(float(bins.sum()), 1e-300)
        begin = self._places.begin
        return [
            Counts(bins[begin[k] : begin[k + 1]].reshape(shape) / total,
                   pairs.reshape(materials, THETA_BINS, THETA_BINS)[k] / total)
            for k, shape in enumerate(self._places.shapes)
        ]

    def _rays(self, spp: int, seed: int) -> Any:
        pixels = self.width * self.height
        at_once = max(_PATHS_AT_ONCE // pixels, 1)
        for first in range(0, spp, at_once):
            samples = min(at_once, spp - first)
            sampler = mi.load_dict({"type": "independent"})
            sampler.seed(seed + 7919 * first, pixels * samples)
            pixel = dr.arange(mi.UInt32, pixels * samples) // samples
            corner = mi.Point2f(mi.Float(pixel % self.width), mi.Float(pixel // self.width))
            where = (corner + sampler.next_2d()) / mi.Point2f(self.width, self.height)
            ray, _ = self._scene.sensors()[0].sample_ray(0.0, sampler.next_1d(), where, sampler.next_2d())
            dr.eval(ray, pixel)
            yield ray, pixel, sampler

    def _material(self, pointer: Any, behind: Any) -> Any:
        material = mi.Int32(-1)
        for bsdf, front, back in self._sides:
            material = dr.select(pointer == bsdf, dr.select(behind, back, front), material)
        return material

    @dr.syntax  # type: ignore[untyped-decorator]
    def _follow(self, ray: Any, sampler: Any, light: Any, counted: Any) -> Any:
        """The light of each path; with `light`, that and a weight, counts what it went through."""
        scene, context = self._scene, mi.BSDFContext()
        ray = mi.Ray3f(ray)
        left = mi.Color3f(0) if light is None else mi.Color3f(light[0])
        result, throughput = mi.Color3f(0), mi.Color3f(1)
        before, before_pdf, before_delta = dr.zeros(mi.SurfaceInteraction3f), mi.Float(1), mi.Bool(True)
        depth, active = mi.UInt32(0), mi.Bool(True)
        while active:
            si = scene.ray_intersect(ray, mi.RayFlags.All, depth == 0, active)
            sent = mi.DirectionSample3f(scene, si, before)
            emitter = sent.emitter
            emitter_pdf = scene.pdf_emitter_direction(before, sent, ~before_delta)
            mis = dr.select(before_pdf > 0, before_pdf / (before_pdf + emitter_pdf), 0)
            brought = throughput * mis * emitter.eval(si)
            result += brought
            left -= brought
            go_on = active & si.is_valid() & (depth + 1 < self._max_depth)
            bsdf = si.bsdf(ray)
            # Towards a lamp.
            lit = go_on & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
            lamp, lamp_weight = scene.sample_emitter_direction(si, sampler.next_2d(), True, lit)
            lit &= lamp.pdf > 0
            wo_lamp = si.to_local(lamp.d)
            value, value_pdf = bsdf.eval_pdf(context, si, wo_lamp, lit)
            mis_lamp = dr.select(lamp.delta, 1, lamp.pdf / (lamp.pdf + value_pdf))
            direct = dr.select(lit, throughput * mis_lamp * value * lamp_weight, 0)
            result += direct
            left -= direct
            # The path goes on.
            drawn, drawn_weight = bsdf.sample(context, si, sampler.next_1d(), sampler.next_2d(), go_on)
            if dr.hint(light is not None, mode="scalar"):
                behind = si.wi.z < 0
                material = self._material(bsdf, behind)
                up = dr.select(behind, -1, 1)
                for wo, colour, there in ((wo_lamp, direct, lit), (drawn.wo, left, go_on)):
                    wi_up, wo_up = mi.Vector3f(si.wi), mi.Vector3f(wo)
                    wi_up.z *= up
                    wo_up.z *= up
                    read = there & (material >= 0) & (wi_up.z > 0) & (wo_up.z > 0)
                    amount = dr.maximum(mi.luminance(colour), 0) * light[1]  # pyright: ignore[reportOptionalSubscript]
                    read &= dr.isfinite(amount)
                    dr.scatter_reduce(
                        dr.ReduceOp.Add, counted[0], amount, self._places.bins(material, wi_up, wo_up), read)
                    dr.scatter_reduce(
                        dr.ReduceOp.Add, counted[1], amount, self._places.pairs(material, wi_up, wo_up), read)
            throughput *= drawn_weight
            ray = si.spawn_ray(si.to_world(drawn.wo))
            before, before_pdf = si, drawn.pdf
            before_delta = mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Delta)
            active = go_on & dr.any(throughput != 0)
            depth += 1
        return result
