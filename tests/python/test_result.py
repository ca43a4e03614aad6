"""Results as users of SciPy and lmfit know them: keys, statistics, a report, HTML for notebooks."""

import base64
import pickle
import re

import numpy as np
import pytest

import trilobe

from models import SMALL, directions, isotropic

pytest.importorskip("trilobe._fit")


@pytest.fixture(scope="module")
def fitted(plastic):
    return trilobe.fit(plastic, solver="varpro", progress=False)


def test_has_the_keys_of_scipys_results(fitted):
    optimize = pytest.importorskip("scipy.optimize")
    scipys = optimize.minimize(lambda x: float(x @ x), np.ones(2), jac=lambda x: 2 * x)
    missing = set(scipys) - set(fitted)
    assert missing == {"hess_inv"}  # L-BFGS has one; `uncertainty` has the covariance here
    for name, value in fitted.items():
        assert value is getattr(fitted, name) or np.array_equal(value, getattr(fitted, name))
    assert fitted["fun"] == fitted.fun and "fun" in fitted and "fum" not in fitted
    assert len(fitted) == len(list(fitted)) and fitted.get("fum") is None
    with pytest.raises(KeyError, match="fum"):
        fitted["fum"]
    assert fitted == fitted and fitted in {fitted}


def test_status_is_a_number_for_the_message(plastic, fitted):
    assert fitted.success and fitted.status == 0
    brief = {"solver": "awls", "progress": False}
    limited = trilobe.fit(plastic, max_iterations=1, **brief)
    assert (limited.status, limited.message) == (1, "max_iterations is reached")
    stopped = trilobe.fit(plastic, callback=lambda record, model: True, **brief)
    assert (stopped.status, stopped.message) == (3, "interrupted")


def test_jac_is_the_gradient_and_residual_what_is_left(plastic, fitted):
    E = trilobe.Objective(plastic)
    np.testing.assert_allclose(fitted.jac, E.gradient(fitted.x), rtol=1e-9, atol=1e-9)
    step = 1e-6 * fitted.x
    numeric = (E.value(fitted.x + step) - E.value(fitted.x - step)) / 2
    assert fitted.jac @ step == pytest.approx(numeric, rel=1e-3, abs=1e-12)
    assert fitted.residual.shape == (3 * E.num_samples,) == (fitted.ndata,)
    assert fitted.residual @ fitted.residual == pytest.approx(fitted.fun, rel=1e-9)


def test_residuals_are_of_the_weights_that_were_given():
    """Of scattered samples, whose weights the fit takes by density."""
    brdf = isotropic(entries=12)
    wi, wo = directions(3000, 1), directions(3000, 2)
    rho = brdf.eval(wi, wo) * (1 + 0.1 * np.random.default_rng(3).normal(size=(3000, 1)))
    data = trilobe.Measurement(wi, wo, rho, anisotropic=False, min_theta_d=0)
    for weights in (None, np.linspace(0, 2, 3000)):
        result = trilobe.fit(data, weights=weights, solver="varpro", max_iterations=3, progress=False)
        assert result.residual @ result.residual == pytest.approx(result.fun, rel=1e-6)


@pytest.mark.parametrize("solver", ["awls", "varpro", "lm", "lm_plain"])
def test_nfev_counts_evaluations(solver):
    """Threads do not change what is counted, and each further iteration evaluates E."""
    def of(iterations, threads=1):
        result = trilobe.fit("synth:felt@12x12x24", solver=solver, max_iterations=iterations, tolerance=0, raw=True,
                             threads=threads, progress=False)
        return result.nfev, result.njev

    few, more = of(1), of(4)
    assert few == of(1, threads=2)
    assert more[0] - few[0] >= 3  # an iteration has at least the E that the trace tells
    assert more[0] > 5  # the start, and those of four iterations
    if solver != "awls":
        assert more[1] > few[1]


def test_fits_side_by_side_count_their_own():
    import threading

    def fit(lobes):
        return trilobe.fit("synth:felt@16x16x32", lobes=lobes, solver="varpro", max_iterations=6, raw=True,
                           progress=False).nfev

    alone = [fit(1), fit(2)]
    together = [0, 0]
    threads = [threading.Thread(target=lambda k=k: together.__setitem__(k, fit(k + 1))) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert together == alone


def test_statistics_are_lmfits(fitted):
    n, k = fitted.ndata, fitted.nvarys
    x, E = fitted.x, trilobe.Objective(SMALL)
    tables = len(E.parts) - 2
    assert k == int((E.observed & (x > 0)).sum()) - tables
    assert fitted.nfree == n - k
    assert fitted.chisqr == fitted.fun and fitted.redchi == pytest.approx(fitted.fun / (n - k))
    assert fitted.aic == pytest.approx(n * np.log(fitted.fun / n) + 2 * k)
    assert fitted.bic == pytest.approx(n * np.log(fitted.fun / n) + np.log(n) * k)


def test_redchi_is_the_variance_of_noise():
    """Uniform weights, noise of 0.01, and no limit by the form."""
    three = isotropic(entries=8)
    brdf = trilobe.Brdf([0.5, 0.5, 0.5], [[4, 3, 2]], [np.linspace(1, 0.3, 8)], three.F, three.G[:1])
    wi, wo = directions(1500, 1), directions(1500, 2)
    rho = brdf.eval(wi, wo) + 0.01 * np.random.default_rng(5).normal(size=(1500, 3))
    data = trilobe.Measurement(wi, wo, rho, anisotropic=False, min_theta_d=0)
    result = trilobe.fit(data, start=brdf, weighting="uniform", weights=np.ones(1500), prior=0, raw=True,
                         solver="varpro", tolerance=1e-9, progress=False)
    E = trilobe.Objective(data, like=brdf, weighting="uniform", weights=np.ones(1500))
    unit = E.measured_energy / (rho**2).sum()  # weights have a common factor
    assert np.sqrt(result.redchi / unit) == pytest.approx(0.01, rel=0.03)


def test_fit_report_has_a_line_for_each_number(fitted):
    told, report = fitted.uncertainty(), fitted.fit_report()
    values = dict(re.findall(r"^ {4}(\S.*?): +(\S.*)$", report, re.MULTILINE))
    for m in range(fitted.model.lobes):
        for c, channel in enumerate(("red", "green", "blue")):
            value, off = values[f"s[{m}, {channel}]"].split(" +/- ")
            assert float(value) == pytest.approx(fitted.model.s[m, c], rel=1e-6)
            assert float(off.split()[0]) == pytest.approx(told.s[m, c], rel=1e-3)
    assert {"d[red]", "d[blue]", "D[2]", "F[green]", "G[0]"} <= set(values)
    statistics = dict(re.findall(r"^ {4}(\S.*?) += (.*)$", report.split("[[Variables]]")[0], re.MULTILINE))
    assert float(statistics["reduced chi-square"]) == pytest.approx(fitted.redchi, rel=1e-6)
    assert int(statistics["function evals"]) == fitted.nfev
    found = re.findall(r"C\((.*), (\S+\[.*\])\) = (\S+)", report)
    sizes = [abs(float(value)) for *_, value in found]
    assert sizes == sorted(sizes, reverse=True) and min(sizes) >= 0.0999
    # C(s[0, red], s[0, green]), by hand.
    a, b = 3, 4
    wanted = told.covariance[a, b] / (told.x[a] * told.x[b])
    assert [float(value) for first, second, value in found
            if (first, second) == ("s[0, red]", "s[0, green]")] == pytest.approx([wanted], abs=1e-3)
    assert "Correlations" not in fitted.fit_report(show_correl=False)
    assert len(fitted.fit_report(min_correl=0.9)) < len(report)


def test_what_needs_the_measurement_says_so(fitted):
    again = pickle.loads(pickle.dumps(fitted))
    assert "jac" not in dict(again) and again["fun"] == fitted.fun and again.nfev == fitted.nfev
    for name in ("jac", "residual", "redchi", "aic"):
        with pytest.raises(trilobe.Error, match="has no measurement") as caught:
            getattr(again, name)
        assert (caught.value.kind, caught.value.key) == ("missing", "measurement")


def pictures_of(text):
    return [base64.b64decode(content) for content in re.findall(r'src="data:image/png;base64,([^"]+)"', text)]


def test_notebooks_show_pictures(fitted):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    before = pyplot.get_fignums()
    text = fitted._repr_html_()
    assert fitted.verdict in text and f"<td>{fitted.nfev}</td>" in text
    assert len(pictures_of(text)) == 2
    wi, wo = directions(50, 1), directions(50, 2)
    scattered = trilobe.fit(trilobe.Measurement(wi, wo, np.full(50, 0.2), source="<b>"), solver="awls", lobes=1,
                            model="isotropic", max_iterations=1, progress=False)
    assert len(pictures_of(scattered._repr_html_())) == 2  # on no grid, the model alone
    assert "<td>&lt;b&gt;</td>" in scattered._repr_html_()
    for model in (fitted.model, trilobe.load("material:linen")):
        found = pictures_of(model._repr_html_())
        assert len(found) == 2 and all(picture.startswith(b"\x89PNG") for picture in found)
    assert pyplot.get_fignums() == before  # which notebooks would show again
