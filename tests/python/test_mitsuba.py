"""The BSDF for Mitsuba, where that is installed: values, densities, measurements, what is told of bad input."""

import math

import numpy as np
import pytest

import trilobe

from models import anisotropic, directions, independent, isotropic, stretched
from scenes import ALL, COMPILED, SIZE, at, dr, mi, needs_compiled, scene, vectors

import trilobe.mitsuba as plugin  # isort: skip
from trilobe._fitting.measurement import completed  # isort: skip


@needs_compiled
@pytest.mark.parametrize("make", ALL)
def test_compiled_is_the_same_function(make):
    mi.set_variant(COMPILED)
    brdf = make()
    bsdf = mi.load_dict(plugin.bsdf(brdf))
    wi, wo = directions(5000, 1), directions(5000, 2)
    value = np.array(bsdf.eval(mi.BSDFContext(), at(wi), vectors(wo))).T
    np.testing.assert_allclose(value, brdf.eval_cos(wi, wo), rtol=1e-4, atol=1e-5)
    wo[::2, 2] *= -1
    assert (np.array(bsdf.eval(mi.BSDFContext(), at(wi), vectors(wo))).T[::2] == 0).all()


@needs_compiled
@pytest.mark.parametrize("make", ALL)
def test_samples_have_the_density_that_it_says(make):
    mi.set_variant(COMPILED)
    brdf = make()
    bsdf, context = mi.load_dict(plugin.bsdf(brdf)), mi.BSDFContext()
    wi = directions(20000, 3)
    random = np.random.default_rng(4).random((3, len(wi))).astype(np.float32)
    drawn, weight = bsdf.sample(context, at(wi), mi.Float(random[0]), mi.Point2f(random[1:]))
    pdf, weight = np.array(drawn.pdf), np.array(weight).T
    assert (pdf > 0).mean() > 0.999
    np.testing.assert_allclose(np.array(bsdf.pdf(context, at(wi), drawn.wo)), pdf, rtol=1e-4)
    value = np.array(bsdf.eval(context, at(wi), drawn.wo)).T
    np.testing.assert_allclose(value, weight * pdf[:, None], rtol=1e-3, atol=1e-5)
    np.testing.assert_allclose(weight.mean(axis=0), brdf.sample(wi, random[1:].T).weight.mean(axis=0), rtol=0.02)
    assert weight.max() < 4


def half_vector_chi2(bsdf, theta_i, samples=200000, rows=24, columns=16, fine=16):
    """The p value of a chi-squared test over half vectors, where the sphere of wo would miss narrow peaks."""
    context = mi.BSDFContext()
    wi = np.array([math.sin(theta_i), 0, math.cos(theta_i)])
    random = np.random.default_rng(5).random((3, samples)).astype(np.float32)
    drawn, _ = bsdf.sample(context, at(np.tile(wi, (samples, 1))), mi.Float(random[0]), mi.Point2f(random[1:]))
    wo = np.array(drawn.wo).T[np.array(drawn.pdf) > 0]
    h = wi + wo
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    v = np.sqrt(np.arctan2(np.hypot(h[:, 0], h[:, 1]), h[:, 2]) / (np.pi / 2))
    phi = np.arctan2(h[:, 1], h[:, 0])
    counted, _, _ = np.histogram2d(v, phi, [rows, columns], [[0, 1], [-np.pi, np.pi]])
    # dω_o = 4 (wi . h) sin theta_h dtheta_h dphi, theta_h = v^2 90 degrees.
    v = (np.arange(rows * fine) + 0.5) / (rows * fine)
    phi = -np.pi + 2 * np.pi * (np.arange(columns * fine) + 0.5) / (columns * fine)
    v, phi = np.meshgrid(v, phi, indexing="ij")
    theta = v**2 * np.pi / 2
    h = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1).reshape(-1, 3)
    wi_h = h @ wi
    wo = 2 * wi_h[:, None] * h - wi
    density = np.array(bsdf.pdf(context, at(np.tile(wi, (len(wo), 1))), vectors(wo)))
    density *= np.maximum(4 * wi_h, 0) * np.sin(theta).ravel() * np.pi * v.ravel()
    cell = (1 / (rows * fine)) * (2 * np.pi / (columns * fine))
    wanted = density.reshape(rows, fine, columns, fine).sum(axis=(1, 3)) * cell * samples
    assert wanted.sum() == pytest.approx(samples, rel=0.01)
    many = wanted > 20
    chi2 = ((counted - wanted)[many] ** 2 / wanted[many]).sum() + (
        (counted[~many].sum() - wanted[~many].sum()) ** 2 / max(wanted[~many].sum(), 1))
    freedom = many.sum()
    # Wilson and Hilferty 1931: the cube root is nearly normal.
    z = ((chi2 / freedom) ** (1 / 3) - (1 - 2 / (9 * freedom))) / math.sqrt(2 / (9 * freedom))
    return 0.5 * math.erfc(z / math.sqrt(2))


@needs_compiled
@pytest.mark.parametrize("make", [isotropic, anisotropic, independent, stretched])
def test_chi2_over_half_vectors(make):
    mi.set_variant(COMPILED)
    bsdf = mi.load_dict(plugin.bsdf(make()))
    tests = [0, 30, 60, 75, 85]
    p = [half_vector_chi2(bsdf, math.radians(degrees)) for degrees in tests]
    assert min(p) > 0.01 / len(tests), dict(zip(tests, p))


@needs_compiled
@pytest.mark.parametrize("make", [isotropic, anisotropic, independent, stretched])
def test_density_is_that_of_the_library(make):
    mi.set_variant(COMPILED)
    bsdf = mi.load_dict(plugin.bsdf(make()))
    wi, wo = directions(20000, 6), directions(20000, 7)
    # Near the mirror direction, too.
    wo[::2] = wi[::2] * [-1, -1, 1] + 0.05 * (wo[::2] - wi[::2])
    wo /= np.linalg.norm(wo, axis=1, keepdims=True)
    pdf = np.array(bsdf.pdf(mi.BSDFContext(), at(wi), vectors(wo)))
    np.testing.assert_allclose(pdf, make().pdf(wi, wo), rtol=5e-3, atol=1e-5)


@needs_compiled
@pytest.mark.parametrize("name", ["cc_nothern_aurora", "vch_dragon_eye_red", "charmeuse"])
def test_weights_of_bundled_materials_are_bounded(name):
    """A sample with a weight of 60 is a bright pixel for long."""
    mi.set_variant(COMPILED)
    bsdf = mi.load_dict({"type": "trilobe", "filename": f"material:{name}"})
    random = np.random.default_rng(8).random((3, 20000)).astype(np.float32)
    for degrees in (0, 30, 60, 75, 80, 82, 85):
        wi = np.array([math.sin(math.radians(degrees)), 0, math.cos(math.radians(degrees))])
        arriving = at(np.tile(wi, (random.shape[1], 1)))
        _, weight = bsdf.sample(mi.BSDFContext(), arriving, mi.Float(random[0]), mi.Point2f(random[1:]))
        assert np.array(weight).mean(axis=0).max() < 4, degrees


# Tables of bins, and of nodes; an error of the fit, so that what is interpolated is not 1.
MEASURED = {"table": ("synth:copper@20x20x40", isotropic), "nodes": ("synth:shot_silk@5x12", anisotropic)}


@needs_compiled
@pytest.mark.parametrize("kind", MEASURED)
def test_measured_is_what_was_measured(kind, tmp_path):
    mi.set_variant(COMPILED)
    source, model = MEASURED[kind]
    model().save(tmp_path / "model.json")
    bsdf = mi.load_dict({"type": "trilobe_measured", "filename": source, "model": str(tmp_path / "model.json")})
    measurement = trilobe.read(source)
    wi, wo, rho = (x[measurement.valid][::97] for x in (measurement.wi, measurement.wo, measurement.rho))
    value = np.array(bsdf.eval(mi.BSDFContext(), at(wi), vectors(wo))).T / wo[:, 2:]
    # At nodes that stand at the horizon nothing is to be seen.
    seen = np.minimum(wi[:, 2], wo[:, 2]) > 0.05
    np.testing.assert_allclose(value[seen], rho[seen], rtol=2e-3, atol=1e-3 * rho.mean())
    # Between them it is what C++ interpolates, which `convert` writes.
    wi, wo = directions(5000, 1), directions(5000, 2)
    value = np.array(bsdf.eval(mi.BSDFContext(), at(wi), vectors(wo))).T
    wanted = completed(measurement, model()).eval(wi, wo) * wo[:, 2:]
    np.testing.assert_allclose(value, wanted, rtol=2e-3, atol=1e-4)
    assert np.abs(wanted - model().eval_cos(wi, wo)).max() > 0.1 * wanted.mean()
    if kind == "table":
        assert half_vector_chi2(bsdf, 0.8) > 0.01


@needs_compiled
def test_measured_is_fitted_where_no_model_is_given():
    mi.set_variant(COMPILED)
    bsdf = mi.load_dict({"type": "trilobe_measured", "filename": "synth:copper@20x20x40"})
    wi = directions(20000, 3)
    random = np.random.default_rng(4).random((3, len(wi))).astype(np.float32)
    drawn, weight = bsdf.sample(mi.BSDFContext(), at(wi), mi.Float(random[0]), mi.Point2f(random[1:]))
    value, pdf = bsdf.eval_pdf(mi.BSDFContext(), at(wi), drawn.wo)
    np.testing.assert_allclose(np.array(value), np.array(weight) * np.array(pdf), rtol=1e-3, atol=1e-5)
    assert np.quantile(np.array(weight), 0.999) < 3


@needs_compiled
def test_draws_by_another_model():
    mi.set_variant(COMPILED)
    wi = directions(1000, 3)
    random = np.random.default_rng(4).random((3, len(wi))).astype(np.float32)
    context = mi.BSDFContext()

    def drawn_by(name, **more):
        bsdf = mi.load_dict({"type": "trilobe", "filename": f"material:{name}", **more})
        drawn, weight = bsdf.sample(context, at(wi), mi.Float(random[0]), mi.Point2f(random[1:]))
        value = np.array(bsdf.eval(context, at(wi), drawn.wo))
        np.testing.assert_allclose(value, np.array(weight) * np.array(drawn.pdf), rtol=1e-3, atol=1e-5)
        return np.array(drawn.wo)

    own, other = drawn_by("paper_white"), drawn_by("satin_purple")
    assert np.abs(own - other).max() > 0.1
    np.testing.assert_array_equal(drawn_by("paper_white", sampling="material:satin_purple"), other)


def wrong_density_is_found(bsdf):
    """A test that can fail: a density that is off by 5 % where half vectors lean."""
    pdf = type(bsdf).pdf
    try:
        type(bsdf).pdf = lambda self, c, si, wo, active=True: pdf(self, c, si, wo, active) * (
            1 + 0.05 * dr.sign(wo.y))
        return half_vector_chi2(bsdf, 0.5) < 1e-4
    finally:
        type(bsdf).pdf = pdf


@needs_compiled
def test_chi2_can_fail():
    mi.set_variant(COMPILED)
    assert wrong_density_is_found(mi.load_dict(plugin.bsdf(isotropic())))


@needs_compiled
def test_time_and_memory_do_not_grow():
    mi.set_variant(COMPILED)
    ball = scene(plugin.bsdf(isotropic()), size=SIZE)
    dr.set_flag(dr.JitFlag.KernelHistory, True)
    try:
        kernels = []
        for seed in range(6):
            dr.kernel_history_clear()
            dr.eval(mi.render(ball, seed=seed))
            history = [entry for entry in dr.kernel_history() if entry.get("hash") is not None]
            kernels.append([entry["hash"] for entry in history])
            if seed > 0:
                assert all(entry["cache_hit"] for entry in history)
        assert kernels[1] == kernels[5]
    finally:
        dr.set_flag(dr.JitFlag.KernelHistory, False)


@pytest.mark.parametrize(("material", "told"), [
    ({"type": "trilobe"}, "needs either filename"),
    ({"type": "trilobe", "filename": "/no/such.json"}, "cannot read"),
    ({"type": "trilobe", "json": "{}"}, "the BSDF's json"),
    ({"type": "trilobe", "filename": "material:linnen"}, "did you mean"),
    ({"type": "trilobe_measured"}, "needs filename"),
    ({"type": "trilobe_measured", "filename": "synth:nothing"}, "nothing"),
])
def test_says_in_a_line_what_is_wrong(material, told):
    mi.set_variant("scalar_rgb")
    with pytest.raises(Exception, match=told):
        mi.load_dict(material)
    with pytest.raises(trilobe.Error, match=r"must be a trilobe\.Brdf"):
        plugin.bsdf(3)


def test_takes_a_file(tmp_path):
    mi.set_variant("scalar_rgb")
    isotropic().save(tmp_path / "model.json")
    bsdf = mi.load_dict({"type": "trilobe", "filename": str(tmp_path / "model.json")})
    assert "3 lobes" in str(bsdf)


def test_takes_the_name_of_a_model():
    assert plugin.bsdf("material:linen") == plugin.bsdf(trilobe.load("material:linen"))
