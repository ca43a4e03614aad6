"""The BSDF for Mitsuba, where that is installed: in scalar variants, and in compiled ones where LLVM is there.

TRILOBE_TEST_BACKEND=cuda takes Mitsuba's variants for NVIDIA cards in the place of those for LLVM.
"""

import math
import os

import numpy as np
import pytest

import trilobe

from models import anisotropic, directions, independent, isotropic, lambertian, stretched

mi = pytest.importorskip("mitsuba")
import drjit as dr  # noqa: E402

import trilobe.mitsuba as plugin  # noqa: E402
from trilobe._fitting.measurement import completed  # noqa: E402

BACKEND = os.environ.get("TRILOBE_TEST_BACKEND", "llvm")
COMPILED = f"{BACKEND}_ad_rgb"


def is_there():
    # Without a path Dr.Jit takes any LLVM, and Debian's 14 to 16 end the process.
    if BACKEND == "llvm" and "DRJIT_LIBLLVM_PATH" not in os.environ:
        return False
    try:
        mi.set_variant(COMPILED)
        dr.eval(mi.Float([1, 2]) + 1)
    except Exception:
        # A backend that is asked for by name must be there.
        if "TRILOBE_TEST_BACKEND" in os.environ:
            raise
        return False
    return True


IS_THERE = is_there()
needs_compiled = pytest.mark.skipif(not IS_THERE, reason="no LLVM; install libllvm19, set DRJIT_LIBLLVM_PATH")
ALL = [isotropic, anisotropic, independent, stretched, lambertian]
SIZE = 64 if os.environ.get("TRILOBE_LARGE_PICTURES") else 32


def scene(material, size=16, spp=16, light=None, **integrator):
    look = mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0])
    return mi.load_dict({
        "type": "scene", "integrator": integrator or {"type": "path", "max_depth": 2},
        "sensor": {"type": "perspective", "fov": 24, "to_world": look,
                   "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}},
                   "sampler": {"type": "independent", "sample_count": spp}},
        "light": light or {"type": "constant"}, "ball": {"type": "sphere", "bsdf": material},
    })


def at(wi):
    si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
    si.wi = mi.Vector3f(np.ascontiguousarray(wi.T, np.float32))
    return si


def vectors(array):
    return mi.Vector3f(np.ascontiguousarray(array.T, np.float32))


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


def test_scalar_measured_is_what_was_measured(tmp_path):
    mi.set_variant("scalar_rgb")
    isotropic().save(tmp_path / "model.json")
    source = MEASURED["table"][0]
    bsdf = mi.load_dict({"type": "trilobe_measured", "filename": source, "model": str(tmp_path / "model.json")})
    made = completed(trilobe.read(source), isotropic())
    si = mi.SurfaceInteraction3f()
    for wi, wo in zip(directions(5, 6), directions(5, 7)):
        si.wi = mi.Vector3f(*map(float, wi))
        value = np.array(bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(*map(float, wo))))
        np.testing.assert_allclose(value, made.eval(wi[None], wo[None])[0] * wo[2], rtol=1e-3, atol=1e-5)


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


@pytest.mark.parametrize("variant", ["scalar_rgb", "scalar_spectral"]
                         + [COMPILED, f"{BACKEND}_ad_spectral", f"{BACKEND}_ad_mono"] * IS_THERE)
def test_a_furnace_shows_the_albedo(variant):
    """Under even light, pictures of a white surface show its albedo in all variants."""
    if variant not in mi.variants():
        pytest.skip("not in this Mitsuba")
    mi.set_variant(variant)
    brdf = isotropic()
    spp = 256 if variant.endswith("spectral") else 64  # noise of the wavelengths drawn
    picture = np.array(mi.render(scene(plugin.bsdf(brdf), size=8, spp=spp), spp=spp))
    middle = picture[3:5, 3:5].reshape(4, -1).mean(axis=0)
    # The four middle pixels, seen from (0, 0, 5), are about 6 degrees off the sphere's normal.
    albedo = brdf.albedo([math.sin(0.1), 0, math.cos(0.1)])
    if variant.endswith("mono"):
        albedo = albedo @ [0.212671, 0.715160, 0.072169]
    np.testing.assert_allclose(middle, albedo, rtol=0.06)


@pytest.mark.parametrize("variant", ["scalar_rgb", pytest.param(COMPILED, marks=needs_compiled)])
def test_the_albedo_picture_has_the_share_that_is_reflected(variant):
    mi.set_variant(variant)
    brdf = isotropic()
    picture = np.array(mi.render(scene(plugin.bsdf(brdf), size=9, spp=1, type="aov", aovs="albedo:albedo")))
    # In the middle the ball is seen from above.
    np.testing.assert_allclose(picture[4, 4, -3:], brdf.albedo([0.0, 0, 1]), rtol=0.01)


def test_scalar_draws_as_it_evaluates():
    mi.set_variant("scalar_rgb")
    brdf = anisotropic()
    bsdf, context = mi.load_dict(plugin.bsdf(brdf)), mi.BSDFContext()
    si = mi.SurfaceInteraction3f()
    for k, wi in enumerate(directions(20, 6)):
        si.wi = mi.Vector3f(*map(float, wi))
        drawn, weight = bsdf.sample(context, si, 0.5, mi.Point2f(0.1 + 0.04 * k, 0.3))
        value, pdf = bsdf.eval_pdf(context, si, drawn.wo)
        np.testing.assert_allclose(np.array(value), np.array(weight) * drawn.pdf, rtol=1e-3)
        assert bsdf.pdf(context, si, drawn.wo) == pytest.approx(pdf)


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


@needs_compiled
@pytest.mark.parametrize("make", [isotropic, anisotropic])
def test_gradients_are_finite_differences(make):
    mi.set_variant(COMPILED)
    ball = scene(plugin.bsdf(make(), update_sampling=False), size=8, spp=256)
    parameters = mi.traverse(ball)
    for name in ("d", "s", "D", "F", "G"):
        key = f"ball.bsdf.{name}"
        start = np.array(parameters[key])
        # Along one direction of all entries, each in proportion to itself.
        along = (start * np.random.default_rng(7).random(start.shape)).astype(np.float32)

        def brightness(t, seed, key=key, start=start, along=along):
            parameters[key] = mi.TensorXf(start) + t * mi.TensorXf(along)
            parameters.update()
            return dr.mean(mi.render(ball, parameters, spp=256, seed=seed, seed_grad=3 if seed == 4 else 0).array)

        t = mi.Float(0)
        dr.enable_grad(t)
        dr.backward(brightness(t, seed=4))
        step = 0.02
        numbers = [np.float64(np.array(brightness(mi.Float(x), seed=3))[0]) for x in (step, -step)]
        wanted = (numbers[0] - numbers[1]) / (2 * step)
        assert np.array(t.grad)[0] == pytest.approx(wanted, rel=1e-3), name
        parameters[key] = mi.TensorXf(start)
        parameters.update()


class ThreeLights:
    """A ball on both sides of which is the material, under three lights, and the picture of another to come near."""

    def __init__(self):
        truth = trilobe.load("material:cc_nothern_aurora")  # whose D spans decades
        D = np.asarray(truth.D)
        self.start = truth.replace(D=np.sqrt(D * D.mean(axis=-1, keepdims=True)), s=np.asarray(truth.s) * 0.7)
        self.picture = mi.render(self.scene(truth), spp=256, seed=1000)
        self.ball = self.scene(self.start)
        self.parameters = mi.traverse(self.ball)
        self.keys = {name: f"ball.bsdf.brdf_0.{name}" for name in "dsD"}

    @staticmethod
    def scene(brdf):
        to = mi.ScalarTransform4f()
        lights = {f"light{k}": {"type": "rectangle", "to_world": to.look_at(at, [0, 0, 0], [0, 0, 1]) @ to.scale(0.6),
                                "emitter": {"type": "area", "radiance": {"type": "rgb", "value": light}}}
                  for k, (at, light) in enumerate([([3, -2, 3], 200), ([-3, -1, 3], 100), ([0, 3, 4], 150)])}
        return mi.load_dict({
            "type": "scene", "integrator": {"type": "path", "max_depth": 3}, **lights,
            "sensor": {"type": "perspective", "fov": 30, "to_world": to.look_at([0, -4, 3], [0, 0, 0], [0, 0, 1]),
                       "film": {"type": "hdrfilm", "width": 16, "height": 16, "rfilter": {"type": "box"}},
                       "sampler": {"type": "independent", "sample_count": 8}},
            "ball": {"type": "sphere", "bsdf": {"type": "twosided",
                                                "nested": plugin.bsdf(brdf, update_sampling=False)}},
        })

    def set(self, values):
        for name, value in values.items():
            self.parameters[self.keys[name]] = value
        self.parameters.update()

    def error(self, seed, spp):
        return dr.mean(dr.square(mi.render(self.ball, self.parameters, spp=spp, seed=seed) - self.picture), axis=None)

    def final_error(self):
        return float(np.ravel(np.array(self.error(999, 256)))[0])

    def gradients(self, seed, spp):
        values = {name: mi.TensorXf(np.asarray(getattr(self.start, name), np.float32)) for name in self.keys}
        dr.enable_grad(*values.values())
        self.set(values)
        dr.backward(self.error(seed, spp))
        return {name: np.array(dr.grad(value), np.float64) for name, value in values.items()}

    def descend(self, steps, lr, of_value, value_of):
        """Adam on a function of the values."""
        adam = mi.ad.Adam(lr=lr)
        for name in self.keys:
            adam[name] = mi.TensorXf(of_value(np.asarray(getattr(self.start, name), np.float32)))
        for step in range(steps):
            self.set({name: value_of(adam[name]) for name in self.keys})
            dr.backward(self.error(step, 8))
            adam.step()
        self.set({name: dr.detach(value_of(adam[name])) for name in self.keys})
        return self.final_error()


@needs_compiled
def test_gradients_of_an_error_are_unbiased_at_few_samples():
    mi.set_variant(COMPILED)
    lights = ThreeLights()
    few, many = [lights.gradients(seed, 8) for seed in range(16)], lights.gradients(1000, 256)
    for name in lights.keys:
        # Along the gradient itself, as single entries are noisy.
        along = many[name] / np.linalg.norm(many[name])
        found = [np.sum(gradient[name] * along) for gradient in few]
        wanted = np.linalg.norm(many[name])
        deviation = np.std(found, ddof=1) / 4  # standard error of the mean
        assert abs(np.mean(found) - wanted) < 4 * deviation, name
        assert deviation < 0.3 * wanted, name  # so that this says something


@needs_compiled
def test_descends_by_factors_and_not_by_amounts():
    """Adam moves each entry by about its step: in logarithms by a share, in values by as much as small ones are."""
    mi.set_variant(COMPILED)
    lights = ThreeLights()
    first = lights.final_error()
    assert lights.descend(12, 0.05, np.log, dr.exp) < 0.5 * first
    assert lights.descend(12, 0.05, lambda x: x, lambda x: dr.maximum(x, 0)) > first


@needs_compiled
def test_follows_what_is_changed():
    mi.set_variant(COMPILED)
    brdf = isotropic()
    bsdf = mi.load_dict(plugin.bsdf(brdf))
    parameters = mi.traverse(bsdf)
    parameters["s"] = mi.TensorXf(np.asarray(brdf.s, np.float32) * 2)
    parameters.update()
    wi, wo = directions(100, 8), directions(100, 9)
    value = np.array(bsdf.eval(mi.BSDFContext(), at(wi), vectors(wo))).T
    np.testing.assert_allclose(value, brdf.replace(s=brdf.s * 2).eval_cos(wi, wo), rtol=1e-3, atol=1e-5)


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
