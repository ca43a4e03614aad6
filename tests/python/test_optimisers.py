"""Optimisers of other libraries on the same E, as experiments/optimisers runs them."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import trilobe

pytest.importorskip("scipy")
FOLDER = Path(__file__).parents[2] / "experiments/optimisers"
SOURCE = "synth:plastic@10x10x20"


def module(name: str) -> ModuleType:
    """A file of the experiment."""
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    assert spec is not None and spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    sys.modules[name] = loaded
    spec.loader.exec_module(loaded)
    return loaded


counting, methods = module("counted"), module("methods")


@pytest.fixture(scope="module")
def objective() -> trilobe.Objective:
    """E of a small table."""
    return trilobe.Objective(SOURCE, lobes=1, threads=1)


@pytest.mark.parametrize("name", methods.METHODS)
def test_each_lowers_the_same_e(objective: trilobe.Objective, name: str) -> None:
    library = {"mma": "nlopt", "ccsaq": "nlopt", "slsqp": "nlopt", "tnewton": "nlopt"}.get(name)
    if library or name.startswith("ipopt"):
        pytest.importorskip(library or "ipyopt")
    start = objective.start()
    counted = counting.Counted(objective, start, 0.3, name in methods.LOGARITHMIC)
    try:
        methods.METHODS[name](counted)
    except Exception as error:  # the time is over, or NLopt sees no further digit (its own test of convergence)
        # NLopt's MMA may ask for E at NaN when it has converged, as its subproblem has no width then.
        stepped_to_nan = name == "mma" and "is not finite" in str(error)
        assert counted.seconds >= counted.budget or type(error).__name__ == "RoundoffLimited" or stepped_to_nan
    assert counted.trace[0]["objective"] == objective.value(start)
    assert counted.lowest < objective.value(start)
    assert objective.value(counted.x) == pytest.approx(counted.lowest, rel=1e-12)
    assert (counted.x >= 0).all()
    assert (np.diff([row["objective"] for row in counted.trace]) < 0).all()


@pytest.mark.parametrize("logarithmic", [False, True])
def test_derivatives_are_those_of_what_is_counted(objective: trilobe.Objective, logarithmic: bool) -> None:
    counted = counting.Counted(objective, objective.start() + 1e-3, 60, logarithmic)
    z = counted.start
    along = np.random.default_rng(1).uniform(-1, 1, counted.n) * (1 if logarithmic else z)
    _, gradient = counted.value_and_gradient(z)
    slope = (counted.value(z + 1e-5 * along) - counted.value(z - 1e-5 * along)) / 2e-5
    assert gradient @ along == pytest.approx(slope, rel=1e-5)


def test_condensed_residuals_have_e_and_its_derivatives(objective: trilobe.Objective) -> None:
    counted = counting.Counted(objective, objective.start() + 1e-3, 60)
    condensed = methods._Condensed(counted)
    r, J = condensed.residuals(counted.start), condensed.jacobian(counted.start)
    value, gradient = counted.value_and_gradient(counted.start)
    matrix = counted.equations(counted.start)[0]
    assert r @ r == pytest.approx(value, rel=1e-9)
    np.testing.assert_allclose(2 * J.T @ r, gradient, rtol=1e-8, atol=1e-10 * np.abs(gradient).max())
    np.testing.assert_allclose(J.T @ J, matrix, rtol=1e-8, atol=1e-9 * np.abs(matrix).max())
