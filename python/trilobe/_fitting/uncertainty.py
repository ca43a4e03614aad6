"""Standard deviations of the tables of a fit: by the covariance of least squares, and by a bootstrap over blocks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from trilobe._fitting.measurement import half_angles
from trilobe._fitting.objective import Objective, Problem
from trilobe._model.brdf import Brdf
from trilobe._model.error import Error
from trilobe._model.table import Table

MOST = 4000  # parameters at most, as matrices of them are stored
_RESOLVED = 1e-12  # share of the largest eigenvalue, below which data say nothing

Vector = NDArray[np.float64]


class Uncertainty:
    """Standard deviations of the numbers of a model, as `Result.uncertainty` returns them.

    Attributes:
        x: of all parameters, in the order of `Objective.parts`. [n]
        covariance: of all parameters. [n][n]
        d, s, D, F, G: `x` as tables, as the model has them. 0 is an entry that no sample reads, or that is at 0, where
            it is held; inf one on which the data say nothing.
    """

    def __init__(self, model: Brdf, parts: dict[str, slice], covariance: Vector, unresolved: NDArray[np.bool_]) -> None:
        """Takes the covariance of what is resolved."""
        self.covariance = covariance
        self.x = np.sqrt(np.maximum(covariance.diagonal(), 0))
        self.x[unresolved] = np.inf
        for name in ("d", "s", "D", "F", "G"):
            of_name = [self.x[part] for key, part in parts.items() if key.rstrip("0123456789") == name]
            table = getattr(model, name)
            values = np.concatenate(of_name).reshape(table.shape)
            setattr(self, name, Table(values, table.dims, table.coords, table.rules))

    d: Table
    s: Table
    D: Table
    F: Table
    G: Table

    def __repr__(self) -> str:
        """A short description."""
        return f"<trilobe.Uncertainty of {len(self.x)} parameters, {int(np.isinf(self.x).sum())} of them unknown>"


class _Steps:
    """Gauss-Newton steps from x that keep the scale of each table, and entries at 0.

    In units in which the diagonal of J'J is 1, steps are Z z, where Z spans what is orthogonal to the gauge's
    constraints: the sum of (J'J)_kk x_k dx_k over each table is 0.
    """

    def __init__(self, E: Objective, x: Vector, hessian: Vector) -> None:
        self._free = np.flatnonzero(E.observed & (x > 0) & (hessian.diagonal() > 0))
        self._size = len(x)
        diagonal = hessian.diagonal()[self._free]
        self._unit = 1 / np.sqrt(diagonal)
        held = []
        for name, part in E.parts.items():
            inside = (self._free >= part.start) & (self._free < part.stop)
            if name not in ("d", "s") and inside.any():
                held.append(np.where(inside, np.sqrt(diagonal) * x[self._free], 0))
        constraints = np.reshape(held, (-1, len(self._free))).T
        self._Z = np.linalg.qr(constraints, mode="complete")[0][:, constraints.shape[1] :]
        self._inverse, self.rank, lost = self._inverted(hessian)
        self.unresolved = np.zeros(self._size, bool)
        self.unresolved[self._free] = lost > 1e-3

    def _inverted(self, hessian: Vector) -> tuple[Vector, int, Vector]:
        """(J'J)^-1 of such steps, how many are resolved, and the share of each entry in those that are not."""
        scaled = hessian[np.ix_(self._free, self._free)] * self._unit * self._unit[:, None]
        values, vectors = np.linalg.eigh(self._Z.T @ scaled @ self._Z)
        known = values > _RESOLVED * max(values.max(initial=0), 1e-300)
        directions = self._Z @ vectors
        inverse = (directions[:, known] / values[known]) @ directions[:, known].T
        return inverse, int(known.sum()), np.square(directions[:, ~known]).sum(axis=1)

    def covariance(self) -> Vector:
        """(J'J)^-1, 0 for what is held. [n][n]."""
        whole = np.zeros((self._size, self._size))
        whole[np.ix_(self._free, self._free)] = self._inverse * self._unit * self._unit[:, None]
        return whole

    def step(self, hessian: Vector, gradient: Vector) -> Vector:
        """The step for other sums of the same form. [n]."""
        whole = np.zeros(self._size)
        whole[self._free] = -self._unit * (self._inverted(hessian)[0] @ (self._unit * gradient[self._free]))
        return whole


def uncertainty(
    problem: Problem, model: Brdf, method: Any, replicates: Any, blocks: Any, seed: Any
) -> Uncertainty:
    """Computes `Result.uncertainty`."""
    if not isinstance(method, str) or method not in ("covariance", "bootstrap"):
        raise Error(f"unknown method {' '.join(repr(method).split())[:60]}; known: covariance, bootstrap")
    for name, value, least in (("replicates", replicates, 2), ("blocks", blocks, 1), ("seed", seed, 0)):
        if not isinstance(value, (int, np.integer)) or not least <= value <= 1_000_000:
            raise Error(f"{name} must be an integer from {least} to 1000000")
    E = _objective(problem, model, None)
    if E.num_parameters > MOST:
        raise Error(f"uncertainties are known of at most {MOST} parameters; this model has {E.num_parameters}")
    x = E.start(model)
    hessian, _ = E.normal_equations(x)
    steps = _Steps(E, x, hessian)
    if method == "covariance":
        samples = 3 * E.num_samples
        if samples <= steps.rank:
            raise Error(f"{samples} values cannot tell how far {steps.rank} parameters are off")
        covariance = steps.covariance() * (E.value(x) / (samples - steps.rank))
    else:
        moved = []
        for counts in _drawn(problem, blocks, replicates, seed):
            drawn = _objective(problem, model, counts)
            moved.append(steps.step(*drawn.normal_equations(x)))
        covariance = np.cov(np.array(moved), rowvar=False)
    return Uncertainty(model, E.parts, covariance, steps.unresolved)


def _objective(problem: Problem, model: Brdf, counts: Vector | None) -> Objective:
    """E of the samples, each as often as it counts."""
    assert problem.measurement is not None
    valid = problem.measurement.valid
    weights = np.zeros(len(valid))
    weights[valid] = 1 if problem.weights is None else problem.weights
    if counts is not None:
        weights[valid] *= counts
    return Objective(
        problem.measurement, like=model, weighting=problem.weighting, weights=weights, threads=problem.threads)


def _drawn(problem: Problem, blocks: int, replicates: int, seed: int) -> Any:
    """Counts of each valid sample, replicate by replicate: the blocks drawn are cells of theta_h and theta_d."""
    data = problem.measurement
    assert data is not None
    theta_h, theta_d = half_angles(data.wi[data.valid], data.wo[data.valid])
    row = np.minimum((np.sqrt(theta_h / (np.pi / 2)) * blocks).astype(np.int64), blocks - 1)
    column = np.minimum((theta_d / (np.pi / 2) * blocks).astype(np.int64), blocks - 1)
    _, block = np.unique(row * blocks + column, return_inverse=True)
    count = int(block.max()) + 1
    rng = np.random.default_rng(seed)
    for _ in range(replicates):
        drawn = np.bincount(rng.integers(count, size=count), minlength=count)
        yield drawn[block].astype(np.float64)
