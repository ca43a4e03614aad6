"""E for other people's optimisers: its values, derivatives and models are those of the solvers."""

from __future__ import annotations

import numpy as np
import pytest

import trilobe

SOURCE = "synth:copper@12x12x24"


@pytest.fixture(scope="module", params=["shared", "independent", "anisotropic"])
def objective(request: pytest.FixtureRequest) -> trilobe.Objective:
    """E of each kind of form."""
    if request.param == "anisotropic":
        return trilobe.Objective("synth:shot_silk@4x8", d_nodes="4x8", g_nodes="4x8", f_bins=6, lobes=2)
    return trilobe.Objective(trilobe.read(SOURCE, noise=0.05), request.param)


def at(objective: trilobe.Objective, seed: int = 1) -> np.ndarray:
    """A point near the start, of no zeros."""
    x = objective.start()
    return x * np.random.default_rng(seed).uniform(0.8, 1.2, len(x)) + 1e-3


def test_value_is_that_of_the_trace() -> None:
    data = trilobe.read(SOURCE, noise=0.05)
    objective = trilobe.Objective(data)
    fit = trilobe.fit(data, solver="awls", max_iterations=2, raw=True, progress=False)
    assert objective.value(objective.start()) == fit.trace["objective"][0]
    assert objective.value(objective.start(fit.model)) == pytest.approx(fit.trace["objective"][2], rel=1e-12)
    assert objective.value(np.zeros(objective.num_parameters)) == pytest.approx(objective.measured_energy, rel=1e-12)


def test_residuals_and_jacobian_add_up(objective: trilobe.Objective) -> None:
    pytest.importorskip("scipy")
    x = at(objective)
    r, J = objective.residuals(x), objective.jacobian(x)
    assert J.shape == (3 * objective.num_samples, objective.num_parameters)
    value, gradient = objective.value_and_gradient(x)
    assert r @ r == pytest.approx(value, rel=1e-10)
    scale = np.abs(gradient).max()
    np.testing.assert_allclose(2 * (J.T @ r), gradient, rtol=1e-9, atol=1e-12 * scale)
    matrix, right = objective.normal_equations(x)
    np.testing.assert_allclose((J.T @ J).toarray(), matrix, rtol=1e-9, atol=1e-12 * np.abs(matrix).max())
    np.testing.assert_allclose(2 * right, gradient, rtol=1e-13, atol=0)


def test_gradient_and_hessian_are_derivatives(objective: trilobe.Objective) -> None:
    x = at(objective)
    along = np.random.default_rng(2).uniform(-1, 1, len(x)) * x * objective.observed
    step = 1e-5
    before, after = (objective.value_and_gradient(x + k * step * along) for k in (-1, 1))
    slope = (after[0] - before[0]) / (2 * step)
    assert objective.gradient(x) @ along == pytest.approx(slope, rel=1e-6)
    curvature = (after[1] - before[1]) / (2 * step)
    expected = objective.hessian(x) @ along
    np.testing.assert_allclose(expected, curvature, rtol=1e-5, atol=1e-6 * np.abs(expected).max())


def test_unobserved_entries_have_no_derivative(objective: trilobe.Objective) -> None:
    gradient = objective.gradient(at(objective))
    assert not gradient[~objective.observed].any()
    assert objective.observed[objective.parts["d"]].all()


def test_parts_cover_x(objective: trilobe.Objective) -> None:
    slices = list(objective.parts.values())
    assert slices[0].start == 0
    assert slices[-1].stop == objective.num_parameters
    assert all(a.stop == b.start for a, b in zip(slices, slices[1:], strict=False))


def test_model_has_the_value_of_x() -> None:
    objective = trilobe.Objective(SOURCE)
    x = objective.start("random", seed=3)
    model = objective.model(x, solver="mine")
    assert objective.value(objective.start(model)) == pytest.approx(objective.value(x), rel=1e-11)
    assert '"mine"' in model.to_json()


def test_an_optimiser_of_others_lowers_it() -> None:
    optimize = pytest.importorskip("scipy.optimize")
    objective = trilobe.Objective(trilobe.read(SOURCE, noise=0.05))
    start = objective.start()
    found = optimize.minimize(
        objective.value_and_gradient, start, jac=True, method="L-BFGS-B", bounds=objective.bounds,
        options={"maxiter": 30},
    )
    assert found.fun < 0.1 * objective.value(start)
    assert (found.x >= 0).all()
    assert objective.value(objective.project(found.x - 1e-6)) >= 0


def test_project_is_the_nearest_that_is_allowed() -> None:
    objective = trilobe.Objective(SOURCE)
    projected = objective.project([-1.0, np.nan, np.inf, 2.0])
    assert projected.tolist() == [0.0, 0.0, np.finfo(float).max, 2.0]


def test_the_same_for_any_number_of_threads() -> None:
    one, two = (trilobe.Objective(SOURCE, threads=n) for n in (1, 2))
    x = at(one)
    assert one.value_and_gradient(x)[0] == two.value_and_gradient(x)[0]
    np.testing.assert_array_equal(one.gradient(x), two.gradient(x))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda e: e.value([1.0, 2.0]), "x has 2 parameters"),
        (lambda e: e.value(np.full(e.num_parameters, np.nan)), r"x\[0\] is not finite"),
        (lambda e: e.value(np.zeros((2, e.num_parameters))), "has the shape"),
        (lambda e: e.value("x"), "x "),
        (lambda e: e.model(np.full(e.num_parameters, -1.0)), "-1"),
        (lambda e: e.start("nowhere"), "nowhere"),
        (lambda e: e.start(3), "init must be a name"),
        (lambda e: e.start("random", seed=-1), "seed must be an integer from 0"),
        (lambda e: e.model(e.start(), solver=3), "solver must be a str"),
        (lambda e: e.start(trilobe.load("material:chm_mint")), "spec|model|bins|lobes"),
        (lambda e: trilobe.Objective(SOURCE, "auto"), "auto"),
        (lambda e: trilobe.Objective(SOURCE, weighting="none"), "none"),
        (lambda e: trilobe.Objective(SOURCE, lobes=99), "lobes"),
        (lambda e: trilobe.Objective("no/such.binary"), "no/such"),
    ],
)
def test_errors_are_one_line(call: object, message: str) -> None:
    objective = trilobe.Objective(SOURCE)
    with pytest.raises(trilobe.Error, match=message) as raised:
        call(objective)  # type: ignore[operator]
    assert "\n" not in str(raised.value)
