"""Ways into a fit and out of it: callbacks, stops, weights, scipy's names, deviations, tables of other libraries."""

import copy
import pickle
import threading
import time
import typing

import numpy as np
import pytest

import trilobe
from trilobe._fitting.options import InitName, SolverName, SolverOptions

from models import directions, isotropic

pytest.importorskip("trilobe._fit")


@pytest.fixture(scope="module")
def fitted(plastic):
    return trilobe.fit(plastic, progress=False)


def test_calls_back_with_the_record_and_the_model(plastic):
    seen = []

    def callback(record, model):
        assert threading.current_thread() is threading.main_thread()
        seen.append((record, model))
        return record.iteration == 2

    result = trilobe.fit(plastic, solver="awls", callback=callback, progress=False)
    assert [record.iteration for record, _ in seen] == [0, 1, 2]
    assert trilobe.Record._fields == result.trace.dtype.names
    assert [record.objective for record, _ in seen] == result.trace["objective"].tolist()
    # The model of a record is the one that E was computed of.
    E = trilobe.Objective(plastic)
    assert E.value(E.start(seen[1][1])) == pytest.approx(seen[1][0].objective, rel=1e-12)
    assert result.interrupted and result.message == "interrupted" and not result.success


def test_what_a_callback_raises_ends_the_fit(plastic):
    def callback(record, model):
        raise ZeroDivisionError("of mine")

    with pytest.raises(ZeroDivisionError, match="of mine"):
        trilobe.fit(plastic, callback=callback, progress=False)
    assert not [thread for thread in threading.enumerate() if thread.name == "trilobe.fit"]


def test_another_thread_stops_it(plastic):
    stop = threading.Event()
    result = trilobe.fit(plastic, solver="awls", max_iterations=10**6, tolerance=0, progress=False, stop=stop,
                         callback=lambda record, model: stop.set() if record.iteration == 3 else None)
    assert result.interrupted and 3 <= result.nit < 1000
    with pytest.raises(trilobe.Error, match="stopped before there was a model"):
        trilobe.fit("synth:plastic", stop=stop, progress=False)


def test_a_limit_of_time_bounds_the_whole_fit():
    measurement = trilobe.read("synth:plastic@45x45x90", noise=0.02)
    endless = {"max_iterations": 10**6, "tolerance": 0, "optimality_tolerance": 0, "solver": "awls"}
    begin = time.perf_counter()
    result = trilobe.fit(measurement, max_seconds=1, **endless, progress=False)
    wall = time.perf_counter() - begin
    assert result.report["stop_reason"] == "max_seconds" and result.message == "max_seconds is over"
    assert not result.interrupted and not result.success
    assert result.report["finishing"] == []  # no time is left for finishing steps
    seconds = result.report["seconds"]
    # An iteration may be under way; what is compared afterwards is apart.
    assert seconds["prepare"] + seconds["init"] + seconds["solve"] + seconds["finish"] < 3
    # All parts together are the whole, but for what Python does.
    assert sum(seconds.values()) - seconds["read"] == pytest.approx(wall, rel=0.1, abs=0.3)


def test_weights_of_samples(plastic):
    plain = {"solver": "varpro", "raw": True, "max_iterations": 4, "progress": False}
    alike = trilobe.fit(plastic, weights=np.ones(len(plastic.rho)), **plain)
    np.testing.assert_array_equal(alike.x, trilobe.fit(plastic, **plain).x)
    # A sample of weight n counts as n equal samples.
    brdf = isotropic(entries=12)
    wi, wo = directions(3000, 1), directions(3000, 2)
    rho = brdf.eval(wi, wo)
    counts = np.random.default_rng(3).integers(0, 3, 3000)
    options = {"anisotropic": False, "min_theta_d": 0}
    once = trilobe.Objective(trilobe.Measurement(wi, wo, rho, **options), weights=counts, weighting="uniform")
    again = trilobe.Measurement(*(np.repeat(a, counts, axis=0) for a in (wi, wo, rho)), **options)
    often = trilobe.Objective(again, weights=np.ones(len(again.rho)), weighting="uniform")
    x = once.start()
    assert once.value(x) == pytest.approx(often.value(x), rel=1e-9)
    np.testing.assert_allclose(once.gradient(x), often.gradient(x), rtol=1e-6, atol=1e-9)
    # Without weights, samples that are there often are dense, and count less.
    assert trilobe.Objective(again, weighting="uniform").value(x) < often.value(x)


def test_weights_are_a_function_of_what_was_measured(plastic):
    def weights(wi, wo, rho):
        assert wi.shape == wo.shape == rho.shape
        return wi[:, 2] * (rho[:, 0] < 1)

    by_function = trilobe.Objective(plastic, weights=weights)
    by_array = trilobe.Objective(plastic, weights=weights(plastic.wi, plastic.wo, plastic.rho))
    assert by_function.measured_energy == by_array.measured_energy < trilobe.Objective(plastic).measured_energy


@pytest.mark.parametrize(("weights", "told"), [
    (np.ones(3), r"weights have the shape \(3,\)"), (lambda wi, wo, rho: -rho[:, 0], "finite and 0 or more"),
    (lambda wi, wo, rho: 0 * wi[:, 0], "one above 0"), ("much", "weights has the dtype"),
])
def test_refuses_other_weights(plastic, weights, told):
    with pytest.raises(trilobe.Error, match=told):
        trilobe.fit(plastic, weights=weights)


def test_has_the_names_of_scipy(plastic, fitted):
    E = trilobe.Objective(plastic)
    assert E.value(fitted.x) == pytest.approx(fitted.fun, rel=1e-9)
    np.testing.assert_array_equal(E.start(fitted.model), fitted.x)
    assert fitted.success and fitted.message.startswith("an iteration changed E by less")
    assert fitted.nit == fitted.trace["iteration"][-1] and fitted.nfev > len(fitted.trace)


def test_types_name_all_solvers_and_options():
    solvers = trilobe.solvers()
    assert typing.get_args(SolverName) == tuple(solver.name for solver in solvers)
    assert typing.get_args(InitName) == tuple(trilobe.initial_models())
    hints = typing.get_type_hints(SolverOptions)
    taken = {name: value for solver in solvers for name, (value, _) in solver.options.items()}
    assert set(hints) == set(taken)
    for name, value in taken.items():
        values = typing.get_args(hints[name])
        assert value in values if values else isinstance(value, hints[name]), name


def test_measurements_are_pickled_and_copied(plastic, tmp_path):
    wi, wo = directions(50, 1), directions(50, 2)
    rho = np.full((50, 3), 0.2)
    rho[3] = -1
    scattered = trilobe.Measurement(wi, wo, rho, source="mine", max_angle=80)
    path = tmp_path / "plastic.csv"
    assert plastic.save(path) == ["CSV, 20284 samples"]
    for measurement in (plastic, scattered, trilobe.read(path, scale=2)):
        again = pickle.loads(pickle.dumps(measurement))
        for name in ("wi", "wo", "rho", "reason"):
            np.testing.assert_array_equal(getattr(again, name), getattr(measurement, name))
        assert again.counts == measurement.counts and again.source.split("/")[-1] == measurement.source.split("/")[-1]
        assert copy.copy(measurement) is copy.deepcopy(measurement) is measurement
    pickled = pickle.dumps(trilobe.read(path))
    path.write_text("\n".join(path.read_text().splitlines()[:-1]) + "\n")
    with pytest.raises(trilobe.Error, match=r"plastic\.csv has changed since"):
        pickle.loads(pickled)


def test_measurements_become_tables_of_pandas_and_xarray(plastic):
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    frame = plastic.to_pandas()
    np.testing.assert_array_equal(frame[["red", "green", "blue"]].to_numpy(), plastic.rho)
    assert (frame["reason"] == "valid").sum() == plastic.counts["valid"]
    valid = frame[frame["reason"] == "valid"]
    assert valid[["theta_i", "theta_o"]].to_numpy().max() < np.pi / 2
    data = plastic.to_xarray()
    assert data["rho"].dims == ("theta_h", "theta_d", "phi_d", "channel") and data["rho"].shape == (24, 24, 48, 3)
    theta_h = np.pi / 2 * ((np.arange(24) + 0.5) / 24) ** 2
    assert data["theta_d"].values == pytest.approx(np.pi / 2 * (np.arange(24) + 0.5) / 24)
    assert np.abs(data["theta_h"].values - theta_h).max() < 0.02
    wi, wo = directions(50, 1), directions(50, 2)
    scattered = trilobe.Measurement(wi, wo, np.full(50, 0.2)).to_xarray()
    np.testing.assert_allclose(np.cos(scattered["theta_i"]), wi[:, 2])
    assert scattered["rho"].dims == ("sample", "channel")


def test_deviations_are_those_of_repeated_fits():
    """The noise is that of the weights, and the model has no lobes that could change places."""
    three = isotropic(entries=8)
    brdf = trilobe.Brdf([0.5, 0.5, 0.5], [[4, 3, 2]], [np.linspace(1, 0.3, 8)], three.F, three.G[:1])
    wi, wo = directions(1500, 1), directions(1500, 2)

    def fit_of(seed):
        rho = brdf.eval(wi, wo) + 0.01 * np.random.default_rng(seed).normal(size=(1500, 3))
        measurement = trilobe.Measurement(wi, wo, rho, anisotropic=False, min_theta_d=0)
        return trilobe.fit(measurement, start=brdf, weighting="uniform", prior=0, raw=True, solver="varpro",
                           tolerance=1e-9, progress=False)

    result = fit_of(0)
    told, by_blocks = result.uncertainty(), result.uncertainty("bootstrap", replicates=40)
    E = trilobe.Objective(result._problem.measurement, like=brdf, weighting="uniform")
    x, hessian = result.x, E.normal_equations(result.x)[0]
    seen = np.std([_held(E, hessian, x, fit_of(seed).x) for seed in range(1, 13)], axis=0, ddof=1)
    known = np.isfinite(told.x) & (told.x > 0) & (told.x < 0.1 * x)
    assert known.sum() > 0.8 * len(x)
    assert np.median(told.x[known] / seen[known]) == pytest.approx(1, abs=0.2)
    assert np.median(by_blocks.x[known] / seen[known]) == pytest.approx(1, abs=0.4)
    assert told.D.dims == ("lobe", "theta_h") and told.D.shape == brdf.D.shape
    assert told.covariance.shape == (len(x), len(x))


def _held(E, H, x, other):
    """The other parameters, each table scaled as `Result.uncertainty` holds it, and s against it."""
    moved = other.copy()
    s = moved[E.parts["s"]].reshape(-1, 3)
    for name, part in E.parts.items():
        if name in ("d", "s"):
            continue
        weight = H.diagonal()[part] * x[part]
        scale = (weight @ x[part]) / (weight @ moved[part])
        moved[part] *= scale
        lobe_or_channel = int(name[1:])
        by = scale**2 if name[0] == "G" else scale
        if name[0] == "F":
            s[:, lobe_or_channel] /= by
        else:
            s[lobe_or_channel] /= by
    return moved


def test_a_pickled_result_asks_for_its_measurement(plastic, fitted):
    again = pickle.loads(pickle.dumps(fitted))
    with pytest.raises(trilobe.Error, match="give measurement="):
        again.uncertainty()
    np.testing.assert_array_equal(again.uncertainty(measurement=plastic).x, fitted.uncertainty().x)


@pytest.mark.parametrize(("arguments", "told"), [
    ({"method": "guess"}, "unknown method 'guess'"), ({"method": "bootstrap", "replicates": 1}, "replicates must be"),
    ({"method": "bootstrap", "blocks": 0.5}, "blocks must be"),
])
def test_refuses_other_uncertainties(fitted, arguments, told):
    with pytest.raises(trilobe.Error, match=told):
        fitted.uncertainty(**arguments)


def test_draws_deviations_as_bands(fitted, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    from trilobe import plot

    told = fitted.uncertainty()
    figure = plot.factors(fitted.model, uncertainty=told)
    for axes, name in zip(figure.axes, "DFG"):
        table, wide = np.asarray(getattr(fitted.model, name)), 2 * np.asarray(getattr(told, name))
        for band, low, high in zip(axes.collections, table - wide, table + wide):
            drawn = band.get_paths()[0].vertices[:, 1]
            assert drawn.max() == pytest.approx(high.max()) and drawn.min() == pytest.approx(max(low.min(), 0))
        assert len(axes.collections) == 3
    matplotlib.pyplot.close(figure)
    for other, error in ((told, "of another model"), (3, "what Result.uncertainty")):
        with pytest.raises(trilobe.Error, match=error):
            plot.factors(isotropic(), uncertainty=other)
