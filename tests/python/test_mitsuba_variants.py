"""The BSDF in all variants that Mitsuba has, and in scalar ones, which ask for one pair at a time."""

import math

import numpy as np
import pytest

import trilobe

from models import anisotropic, directions, isotropic
from scenes import ALL, BACKEND, mi, needs_compiled, scene

import trilobe.mitsuba as plugin  # isort: skip
from trilobe._fitting.measurement import completed  # isort: skip


def test_scalar_measured_is_what_was_measured(tmp_path):
    mi.set_variant("scalar_rgb")
    isotropic().save(tmp_path / "model.json")
    source = "synth:copper@20x20x40"
    bsdf = mi.load_dict({"type": "trilobe_measured", "filename": source, "model": str(tmp_path / "model.json")})
    made = completed(trilobe.read(source), isotropic())
    si = mi.SurfaceInteraction3f()
    for wi, wo in zip(directions(5, 6), directions(5, 7)):
        si.wi = mi.Vector3f(*map(float, wi))
        value = np.array(bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(*map(float, wo))))
        np.testing.assert_allclose(value, made.eval(wi[None], wo[None])[0] * wo[2], rtol=1e-3, atol=1e-5)


# All that this Mitsuba has, but for those of a backend that is not tested here.
VARIANTS = [pytest.param(variant, marks=[] if variant.startswith("scalar") else
                         needs_compiled if variant.startswith(f"{BACKEND}_") else
                         pytest.mark.skip(reason=f"this run is of scalar variants and {BACKEND}"))
            for variant in mi.variants()]


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_furnace_shows_the_albedo(variant):
    """Under even light, pictures of a white surface show its albedo in all variants."""
    mi.set_variant(variant)
    brdf = isotropic()
    spp = 256 if "spectral" in variant else 64  # noise of the wavelengths drawn
    picture = np.array(mi.render(scene(plugin.bsdf(brdf), size=8, spp=spp), spp=spp))
    middle = picture[3:5, 3:5].reshape(4, -1).mean(axis=0)
    # The four middle pixels, seen from (0, 0, 5), are about 6 degrees off the sphere's normal.
    albedo = brdf.albedo([math.sin(0.1), 0, math.cos(0.1)])
    if "mono" in variant:
        albedo = albedo @ LUMINANCE
    np.testing.assert_allclose(middle, albedo, rtol=0.06)


LUMINANCE = [0.212671, 0.715160, 0.072169]


@pytest.mark.parametrize("variant", VARIANTS)
def test_the_albedo_picture_has_the_share_that_is_reflected(variant):
    mi.set_variant(variant)
    brdf = isotropic()
    albedo = brdf.albedo([0.0, 0, 1])
    spp = 1024 if "spectral" in variant else 1

    def middle(material):  # where the ball is seen from above
        ball = scene(material, size=9, spp=spp, type="aov", aovs="albedo:albedo")
        return np.array(mi.render(ball, spp=spp))[4, 4, -3:]

    wanted = np.full(3, albedo @ LUMINANCE) if "mono" in variant else albedo
    if "spectral" in variant:  # Mitsuba shows these without a white point
        wanted = middle({"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo.tolist()}})
    np.testing.assert_allclose(middle(plugin.bsdf(brdf)), wanted, rtol=0.03 if "spectral" in variant else 0.01)


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_measurement_is_drawn_in_all_variants(variant, tmp_path):
    mi.set_variant(variant)
    isotropic().save(tmp_path / "model.json")
    material = {"type": "trilobe_measured", "filename": "synth:copper@20x20x40", "model": str(tmp_path / "model.json")}
    picture = np.array(mi.render(scene(material, size=4, spp=16), spp=16))
    assert np.isfinite(picture).all() and picture[1:3, 1:3].min() > 0.1


@pytest.mark.parametrize("make", ALL)
def test_scalar_is_the_same_function(make):
    """What scalar variants ask for one pair at a time is what arrays have."""
    mi.set_variant("scalar_rgb")
    brdf, context, si = make(), mi.BSDFContext(), mi.SurfaceInteraction3f()
    bsdf = mi.load_dict(plugin.bsdf(brdf))
    wi, wo = np.float32(directions(12, 3)), np.float32(directions(12, 4))
    wo[::4, 2] *= -1
    u = np.random.default_rng(5).random((12, 2), np.float32)
    drawn, f, pdf = brdf.sample(wi, u), brdf.eval_cos(wi, wo), brdf.pdf(wi, wo)
    for k in range(12):
        si.wi = mi.Vector3f(*map(float, wi[k]))
        out = mi.Vector3f(*map(float, wo[k]))
        sample, weight = bsdf.sample(context, si, 0.5, mi.Point2f(*map(float, u[k])))
        np.testing.assert_allclose(np.array(sample.wo), drawn.wo[k], atol=1e-6)
        assert sample.pdf == pytest.approx(drawn.pdf[k], rel=1e-5)
        np.testing.assert_allclose(np.array(weight), drawn.weight[k], rtol=1e-5)
        np.testing.assert_allclose(np.array(bsdf.eval(context, si, out)), f[k], rtol=1e-5, atol=1e-7)
        assert bsdf.pdf(context, si, out) == pytest.approx(pdf[k], rel=1e-5)
    for wi in ([0, 0, -1], [0, 0, 0]):  # nothing comes from there
        si.wi = mi.Vector3f(*wi)
        sample, weight = bsdf.sample(context, si, 0.5, mi.Point2f(1, 1))
        assert sample.pdf == 0 and not np.array(weight).any()
        assert not np.array(bsdf.eval(context, si, mi.Vector3f(0, 0, 1))).any()


def test_scalar_follows_what_is_changed():
    mi.set_variant("scalar_rgb")
    brdf, si = isotropic(), mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(0.6, 0, 0.8)
    u, context = mi.Point2f(0.4, 0.3), mi.BSDFContext()
    for follows in (True, False):
        bsdf = mi.load_dict(plugin.bsdf(brdf, update_sampling=follows))
        parameters = mi.traverse(bsdf)
        parameters["s"] = mi.TensorXf(np.asarray(brdf.s, np.float32) * [[4], [1], [1]])
        parameters.update()
        changed = brdf.replace(s=np.asarray(brdf.s) * [[4], [1], [1]])
        sample, weight = bsdf.sample(context, si, 0.5, u)
        wanted = (changed if follows else brdf).sample(np.float32([0.6, 0, 0.8]), np.float32([0.4, 0.3]))
        np.testing.assert_allclose(np.array(sample.wo), wanted.wo, atol=1e-5)
        value = changed.eval_cos([0.6, 0, 0.8], np.array(sample.wo).astype(float))
        np.testing.assert_allclose(np.array(weight), value / sample.pdf, rtol=1e-3)


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
