"""E of a fit and its derivatives, for optimisers that are not ours."""

from __future__ import annotations

import os
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trilobe._fitting.extension import fits
from trilobe._fitting.measurement import Measurement, measurement_of
from trilobe._fitting.options import Form, Weights, stretch_text, weights_of, without_none
from trilobe._model.arrays import as_array
from trilobe._model.brdf import Brdf, model_of
from trilobe._model.error import Error

Vector = NDArray[np.float64]


class Problem(NamedTuple):
    """The data and weights of the E that a fit minimised."""

    measurement: Measurement | None
    weighting: str = "appearance"
    weights: NDArray[np.float64] | None = None
    threads: int = 0


class Objective:
    """The objective of the solvers, by the library's own sums: E(x) = |r(x)|^2 over x >= 0 (paper eq. 2).

    x holds d, s and the tables of D, F and G of all lobes (docs/method.md). A residual is sqrt(w) (rho - rho*), three
    for each sample. rho is a multilinear function of x, so E has many minima, and scale can move between
    the factors without changing it.

        E = trilobe.Objective("synth:copper@30x30x60")
        x = scipy.optimize.minimize(E.value_and_gradient, E.start(), jac=True, method="L-BFGS-B",
                                    bounds=E.bounds).x
        E.model(x, solver="L-BFGS-B").save("model.json")

    Attributes:
        num_parameters: the size n of x.
        num_samples: how many samples there are; residuals are three times as many.
        measured_energy: E of a black model, sum w rho*^2.
        observed: False for entries that no sample reads. Their derivatives are 0. [n]
        parts: name to slice of x: "d", "s", "D0", "D1", ..., "F0", ..., "G0", ...
        bounds: (0, inf), as scipy.optimize.minimize takes them. [n]
    """

    def __init__(
        self,
        measurement: Measurement | str | os.PathLike[str],
        model: Form = "shared",
        *,
        lobes: int | None = None,
        stretch: ArrayLike | None = None,
        d_nodes: str | None = None,
        g_nodes: str | None = None,
        f_bins: int | None = None,
        weighting: str = "appearance",
        weights: Weights | None = None,
        threads: int = 0,
        like: Brdf | None = None,
    ) -> None:
        """Prepares E; arguments are those of `fit`. `like` is a model whose form it has in the place of a name.

        Raises:
            Error: with the program's line.
        """
        if isinstance(model, str) and model == "auto":
            raise Error("model='auto' chooses among forms; give the one that E is of")
        options = {"model": model, "weighting": weighting, "threads": threads} | without_none(
            lobes=lobes, stretch=stretch_text(stretch), d_nodes=d_nodes, g_nodes=g_nodes, f_bins=f_bins
        )
        if like is not None:
            options["like"] = model_of(like).to_json().encode()
        data = measurement_of(measurement)
        self._objective = fits().Objective(data._data, options, weights_of(weights, data))
        self._source = data.source
        self.num_parameters: int = self._objective.num_parameters
        self.num_samples: int = self._objective.num_samples
        self.measured_energy: float = self._objective.measured_energy
        self.observed: NDArray[np.bool_] = self._objective.observed()
        self.parts: dict[str, slice] = {name: slice(begin, end) for name, begin, end in self._objective.parts()}
        self.bounds: list[tuple[float, float]] = [(0.0, np.inf)] * self.num_parameters

    def start(self, init: str | Brdf = "analytic", seed: int = 1) -> Vector:
        """A starting point: a name of `initial_models()`, or a model of the same form. [n]."""
        if isinstance(init, Brdf):
            given: Vector = self._objective.parameters_of(model_of(init).to_json().encode())
            return given
        if not isinstance(init, str):
            raise Error("init must be a name of initial_models(), or a trilobe.Brdf")
        if not isinstance(seed, (int, np.integer)) or not 0 <= seed < 2**64:
            raise Error("seed must be an integer from 0")
        x: Vector = self._objective.start(init, int(seed))
        return x

    def value(self, x: ArrayLike) -> float:
        """E, as traces and reports quote it. One pass over the samples."""
        value: float = self._objective.value(self._vector(x))
        return value

    def value_and_gradient(self, x: ArrayLike) -> tuple[float, Vector]:
        """E and dE/dx = 2 J'r. It costs as much as `normal_equations`. [], [n]."""
        value, gradient = self._objective.value_and_gradient(self._vector(x))
        return value, gradient

    def gradient(self, x: ArrayLike) -> Vector:
        """dE/dx = 2 J'r. [n]."""
        return self.value_and_gradient(x)[1]

    def normal_equations(self, x: ArrayLike) -> tuple[Vector, Vector]:
        """J'J and J'r, without storing J. [n][n], [n]."""
        matrix, right = self._objective.equations(self._vector(x), False)
        return matrix, right

    def hessian(self, x: ArrayLike) -> Vector:
        """d2E/dx2 = 2 (J'J + sum r d2r/dx2). It may be indefinite. [n][n]."""
        matrix: Vector = self._objective.equations(self._vector(x), True)[0]
        return 2 * matrix

    def residuals(self, x: ArrayLike) -> Vector:
        """r, by sample and channel. [3 num_samples]."""
        r: Vector = self._objective.residuals(self._vector(x))
        return r

    def jacobian(self, x: ArrayLike) -> Any:
        """J = dr/dx as a scipy.sparse.csr_array of some 35 entries a row. [3 num_samples][n].

        Raises:
            Error: where SciPy is not installed.
        """
        try:
            from scipy.sparse import csr_array
        except ImportError:
            raise Error("the Jacobian is a sparse array of SciPy: pip install scipy") from None
        values, columns, rows = self._objective.jacobian(self._vector(x))
        return csr_array((values, columns, rows), shape=(3 * self.num_samples, self.num_parameters))

    def project(self, x: ArrayLike) -> Vector:
        """The nearest x >= 0, with values that are no number made 0. [n]."""
        return np.nan_to_num(np.maximum(self._vector(x), 0.0), nan=0.0, posinf=np.finfo(float).max)

    def model(self, x: ArrayLike, solver: str = "") -> Brdf:
        """The model of these parameters, in canonical form; `solver` is told in its file.

        Raises:
            Error: unless all are finite and >= 0.
        """
        if not isinstance(solver, str):
            raise Error("solver must be a str")
        text = self._objective.model_text(self._vector(x), solver)
        return Brdf.from_json(text.decode(), "the model")

    def _vector(self, x: ArrayLike) -> Vector:
        array = as_array(x, "x").astype(np.float64)
        if array.ndim != 1:
            raise Error(f"x has the shape {array.shape}; it must be one of {self.num_parameters} numbers")
        return np.ascontiguousarray(array)

    def __repr__(self) -> str:
        """A short description."""
        return f"<trilobe.Objective: {self._source}, {self.num_samples} samples, {self.num_parameters} parameters>"
