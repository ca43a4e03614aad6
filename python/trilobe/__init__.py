"""Multi-lobe non-parametric microfacet models of measured BRDFs.

    brdf = trilobe.load("model.json")
    f = brdf.eval(wi, wo)                     # [1/sr], without a cosine
    wo, pdf, weight = brdf.sample(wi, u)

    result = trilobe.fit(trilobe.read("material.binary"))
    result.model.save("model.json")

docs/python.md of the project has a tour, and the conventions. `trilobe.plot` draws, by matplotlib; `trilobe.mitsuba`
is a BSDF for Mitsuba 3; `trilobe.torch` evaluates in PyTorch.
"""

import importlib
from typing import Any

from trilobe._fitting.directions import Directions, NextDirections, directions_to_measure, next_directions
from trilobe._fitting.fit import (
    LobeMatch,
    Solver,
    fit,
    fit_many,
    initial_models,
    match_lobes,
    score,
    solvers,
    synthetic_materials,
    weightings,
)
from trilobe._fitting.measurement import Measurement, convert, read
from trilobe._fitting.objective import Objective
from trilobe._fitting.result import Record, Result
from trilobe._fitting.uncertainty import Uncertainty
from trilobe._model.brdf import Brdf, Sample, load, materials
from trilobe._model.error import Error
from trilobe._model.table import Table
from trilobe._texels.fit import fit_texels
from trilobe._texels.texels import Texels, load_texels

__all__ = [
    "Brdf",
    "Directions",
    "Error",
    "LobeMatch",
    "Measurement",
    "NextDirections",
    "Objective",
    "Record",
    "Result",
    "Sample",
    "Solver",
    "Table",
    "Texels",
    "Uncertainty",
    "convert",
    "directions_to_measure",
    "fit",
    "fit_many",
    "fit_texels",
    "initial_models",
    "load",
    "load_texels",
    "match_lobes",
    "materials",
    "next_directions",
    "read",
    "score",
    "solvers",
    "synthetic_materials",
    "weightings",
]
__version__ = "0.2.0"


def __getattr__(name: str) -> Any:
    """Imports `trilobe.plot`, `trilobe.mitsuba` and `trilobe.torch`, which need more, when they are first used."""
    if name in ("plot", "mitsuba", "torch"):
        return importlib.import_module(f"trilobe.{name}")
    raise AttributeError(f"module 'trilobe' has no attribute '{name}'")


