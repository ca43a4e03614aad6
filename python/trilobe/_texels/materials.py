"""Finds the materials that a surface consists of."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from trilobe._fitting.extension import fits
from trilobe._fitting.fit import fit
from trilobe._fitting.measurement import Measurement
from trilobe._model.brdf import Brdf
from trilobe._model.error import Error
from trilobe._texels.texels import lobes_of

Vector = NDArray[np.float64]

_ALIKE = 64  # texels of which the first guess of a material is the mean
_MOST_ROUNDS = 100
_LITTLE = 1e-3  # relative fall of the error in a round that is worth another one


class Solved(NamedTuple):
    """Solution for n texels: d (n, 3), s (n, materials, 3), E (n,) and that of the black texel (n,)."""

    d: Vector
    s: Vector
    objective: Vector
    energy: Vector

    @property
    def error(self) -> Vector:
        """The root of E over that of the black texel, (n,)."""
        error: Vector = np.sqrt(self.objective / np.maximum(self.energy, 1e-300))
        return error


class Problem(NamedTuple):
    """Data and options that all texels share; their materials are apart."""

    wi: Vector
    wo: Vector
    options: dict[str, Any]
    """weighting, coloured and threads, as C++ takes them."""
    anisotropic: bool

    def lobes(self, material: Brdf) -> Vector:
        """Its values without its diffuse term, (samples, 3)."""
        return lobes_of(material, self.wi, self.wo).astype(np.float64)

    def solve(self, lobes: Vector, rho: Vector) -> Solved:
        """Texels (n, samples, 3) of materials (materials, samples, 3)."""
        rows = fits().SharedTexels(lobes, self.wi, self.wo, self.options).solve(rho)
        return Solved(rows[:, :3], rows[:, 3:-2].reshape(len(rows), len(lobes), 3), rows[:, -2], rows[:, -1])

    def weigh(self, rho: Vector) -> Vector:
        """The weights of texels (n, samples, 3) in E."""
        weights: Vector = fits().SharedTexels(self.none, self.wi, self.wo, self.options).weigh(rho)
        return weights

    @property
    def none(self) -> Vector:
        """Lobes of no material."""
        return np.empty((0, len(self.wi), 3))


def find(problem: Problem, rho: Vector, count: int, options: dict[str, Any]) -> list[Brdf]:
    """Finds `count` materials of texels (n, samples, 3), by their values alone; in the end a model is fitted to each.

    The first guess of each is the mean of texels that those before explain least. Then, in turn, each becomes what
    fits best what the others and the diffuse terms leave of all texels.
    """
    weights = problem.weigh(rho)
    if not weights.any():
        raise Error("no sample of the texels is valid")
    rho = np.where(weights > 0, rho, 0)
    energy = np.maximum(problem.solve(problem.none, rho).energy, 1e-300)
    weights /= energy[:, None, None]  # so that texels count alike, bright or dark
    lobes = problem.none
    while len(lobes) < count:
        alike = _alike(rho, weights, problem.solve(lobes, rho), lobes)
        scale = 1 / np.sqrt(energy[alike])[:, None]
        lobes = np.concatenate([lobes, _mean(rho[alike], weights[alike], scale)[None]])
    least = np.inf
    for _ in range(_MOST_ROUNDS):
        error = np.inf
        for k in range(count):
            solved = problem.solve(lobes, rho)
            error = float(np.mean(solved.objective / energy))
            others = solved.s.copy()
            others[:, k] = 0
            if solved.s[:, k].any():
                lobes[k] = _mean(rho - _values(solved.d, others, lobes), weights, solved.s[:, k])
        if not error < (1 - _LITTLE) * least:
            break
        least = error
    return [_fitted(problem, of_material, options) for of_material in lobes]


def _values(d: Vector, s: Vector, lobes: Vector) -> Vector:
    """Values of n texels, (n, samples, 3)."""
    values: Vector = d[:, None] + np.einsum("nbc,bjc->njc", s, lobes)
    return values


def _alike(rho: Vector, weights: Vector, solved: Solved, lobes: Vector) -> NDArray[np.intp]:
    """The texel that is explained least, and those whose error looks most like its own."""
    errors = (np.sqrt(weights) * (rho - _values(solved.d, solved.s, lobes))).reshape(len(rho), -1)
    errors /= np.maximum(np.linalg.norm(errors, axis=1, keepdims=True), 1e-300)
    likeness = errors @ errors[solved.error.argmax()]
    return np.argsort(-likeness, kind="stable")[:_ALIKE]


def _mean(rho: Vector, weights: Vector, s: Vector) -> Vector:
    """The lobe (samples, 3) that, times s (n, 3), comes nearest to the values (n, samples, 3)."""
    counts = (weights * s[:, None] ** 2).sum(axis=0)
    mean: Vector = (weights * s[:, None] * rho).sum(axis=0) / np.maximum(counts, 1e-300)
    # The part that all directions share belongs to the texels' diffuse terms, none of which is below 0.
    mean -= mean.min(axis=0)
    return mean


def _fitted(problem: Problem, lobes: Vector, options: dict[str, Any]) -> Brdf:
    """A model of values (samples, 3)."""
    measurement = Measurement(
        problem.wi, problem.wo, lobes, anisotropic=problem.anisotropic, source="the mean of texels", min_theta_d=0)
    result = fit(
        measurement, weighting=problem.options["weighting"], threads=problem.options["threads"], **options)
    if result.interrupted:
        raise KeyboardInterrupt
    return result.model
