"""Names and options of `fit`, so that an editor finds a typo. The tests compare them with what C++ knows."""

from __future__ import annotations

from typing import Literal, TypedDict

Form = Literal["shared", "isotropic", "anisotropic", "independent", "auto"]
SolverName = Literal[
    "auto", "multistart", "awls", "awls_block", "awls_accelerated", "awls_gss", "awls_literal", "hybrid", "newton",
    "varpro", "lm", "lm_plain",
]
InitName = Literal[
    "analytic", "highlight", "moments", "freed", "constant", "roughness", "random",
]


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
