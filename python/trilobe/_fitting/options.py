"""Options of `fit`: their names, so that an editor finds a typo, and what C++ takes for them.

The tests compare the names with what C++ knows.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, Literal, TypedDict, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trilobe._core import Error
from trilobe._fitting.measurement import Measurement
from trilobe._model.arrays import as_array

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


def form_options(
    model: str,
    lobes: int | None,
    stretch: ArrayLike | None,
    d_nodes: str | None,
    g_nodes: str | None,
    f_bins: int | None,
    nodes: str,
) -> dict[str, Any]:
    """The form of a model, as C++ takes it. Raises Error."""
    pairs: list[list[float]] = []
    if stretch is not None:
        array = as_array(stretch, "stretch").astype(np.float64)
        if array.ndim not in (1, 2) or array.shape[-1] != 2:
            raise Error("stretch must be (along, across), once or for each lobe")
        pairs = array.reshape(-1, 2).tolist()
    if not isinstance(nodes, str) or nodes not in ("given", "held_out"):
        raise Error(f"unknown nodes {' '.join(repr(nodes).split())[:60]}; known: given, held_out")
    return {
        "model": model,
        "lobes": lobes,
        "stretch": [tuple(pair) for pair in pairs],
        "d_nodes": _nodes_of("d_nodes", d_nodes),
        "g_nodes": _nodes_of("g_nodes", g_nodes),
        "f_bins": f_bins,
        "nodes_by_held_out": nodes == "held_out",
    }


def _nodes_of(name: str, text: Any) -> tuple[int, bool, int] | None:
    if text is None:
        return None
    match = re.fullmatch(r"(\d{1,4})(r?)x(\d{1,4})", text) if isinstance(text, str) else None
    if match is None or (match[2] and name == "g_nodes"):
        given = " ".join(repr(text).split())[:60]
        raise Error(f"{name}={given} are no nodes; give theta x phi, as '6x48'")
    return int(match[1]), bool(match[2]), int(match[3])
