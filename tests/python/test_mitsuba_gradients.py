"""Gradients of Mitsuba's pictures by the tables of a model."""

import numpy as np
import pytest

import trilobe

from models import anisotropic, directions, isotropic
from scenes import COMPILED, at, dr, mi, needs_compiled, scene, vectors

import trilobe.mitsuba as plugin  # isort: skip


@needs_compiled
@pytest.mark.parametrize("integrator", ["path", "prb"])
@pytest.mark.parametrize("make", [isotropic, anisotropic])
def test_gradients_are_finite_differences(make, integrator):
    mi.set_variant(COMPILED)
    ball = scene(plugin.bsdf(make(), update_sampling=False), size=8, spp=256, type=integrator, max_depth=2)
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
        # Its d is far enough off that a gradient along it is seen through the noise, and has a logarithm.
        self.start = truth.replace(d=np.asarray(truth.d) + 0.05, s=np.asarray(truth.s) * 0.7,
                                   D=np.sqrt(D * D.mean(axis=-1, keepdims=True)))
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
        deviation = np.std(found, ddof=1) / np.sqrt(len(found))  # standard error of the mean
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
