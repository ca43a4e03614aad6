"""Options of `fit`: their names, so that an editor finds a typo, and what C++ takes for them.

The tests compare the names with what C++ knows.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, TypedDict, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trilobe._fitting.measurement import Measurement
from trilobe._model.arrays import as_array
from trilobe._model.error import Error

Form = Literal["shared", "isotropic", "anisotropic", "independent", "auto"]
SolverName = Literal[
    "auto", "multistart", "awls", "awls_block", "awls_accelerated", "awls_gss", "awls_literal", "hybrid", "newton",
    "varpro", "lm", "lm_plain",
]
InitName = Literal[
    "analytic", "highlight", "moments", "freed", "constant", "roughness", "random",
]
Weights = Union[ArrayLike, Callable[[Any, Any, Any], ArrayLike]]


class SolverOptions(TypedDict, total=False):
    """Keyword arguments that solvers take; `trilobe.solvers()` says which takes what, and what they mean."""

    max_iterations: int
    max_seconds: float
    tolerance: float
    optimality_tolerance: float
    diagnose: bool
    starts: int
    g_filter: float
    memory: int
    positivity: Literal["active_set", "bounds"]
    trust_region: Literal["levenberg_marquardt", "dogleg"]
    nonmonotonic: bool
    linear_solver: Literal[
        "auto", "dense_qr", "dense_normal_cholesky", "sparse_normal_cholesky", "dense_schur", "sparse_schur",
        "iterative_schur", "cgnr",
    ]
    inner_iterations: bool


def weights_of(weights: Weights | None, data: Measurement) -> NDArray[np.float64] | None:
    """The weights of the valid samples. Raises Error."""
    if weights is None:
        return None
    given = weights(data.wi, data.wo, data.rho) if callable(weights) else weights
    array = as_array(given, "weights").astype(np.float64)
    if array.shape != data.valid.shape:
        raise Error(f"weights have the shape {array.shape}, and must have {data.valid.shape}, one for each row of rho")
    array = np.ascontiguousarray(array[data.valid])
    if not (np.isfinite(array) & (array >= 0)).all() or not array.any():
        raise Error("weights of valid samples must be finite and 0 or more, and one above 0")
    return array


def stretch_text(stretch: ArrayLike | None) -> str | None:
    """The exponents as the flag --stretch has them. Raises Error."""
    if stretch is None:
        return None
    array = as_array(stretch, "stretch").astype(np.float64)
    if array.ndim not in (1, 2) or array.shape[-1] != 2:
        raise Error("stretch must be (along, across), once or for each lobe")
    return ",".join(repr(float(x)) for x in array.ravel())


def without_none(**optional: Any) -> dict[str, Any]:
    """Those options that were given; the others have the defaults of the program."""
    return {name: value for name, value in optional.items() if value is not None}
