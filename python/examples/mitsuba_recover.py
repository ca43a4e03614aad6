#!/usr/bin/env python3
"""Recover D and s of a material from one picture, by gradients through Mitsuba 3.

mitsuba_recover.py [--quick] [--out=FOLDER]     writes before.png, after.png, picture.png and recovered.json

The picture shows a sphere under a known light, whose materials' F, G and diffuse term are known, too. D begins wide and
s grey; Adam goes down the squared error of the picture's logarithm. Needs an LLVM that Dr.Jit can load.
"""

import argparse
import pathlib

import drjit as dr
import mitsuba as mi
import numpy as np

import trilobe

mi.set_variant("llvm_ad_rgb")
import trilobe.mitsuba as plugin  # noqa: E402

ENTRIES = 30


def material():
    """One lobe, a golden metal with a halo."""
    theta = (np.arange(ENTRIES) + 0.5) / ENTRIES  # nodes in sqrt(theta_h / 90 degrees)
    D = np.exp(-((theta / 0.3) ** 2) * 2) + 0.05 * np.exp(-((theta / 0.6) ** 2))
    F = 0.8 + 0.2 * np.linspace(0, 1, ENTRIES) ** 5 * np.ones((3, 1))
    G = np.cos(np.radians((np.arange(ENTRIES) + 0.5) * 90 / ENTRIES)) * np.ones((1, 1))
    return trilobe.Brdf([0.02, 0.02, 0.02], [[6.0, 4.2, 1.6]], D[None], F, G)


def scene(brdf, size, spp):
    """A sphere under a sky with a sun."""
    sky = np.full((32, 64, 3), 0.3, np.float32)
    sky[8:10, 20:22] = 60
    sky[12:16, 40:48] = 4
    look = mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0])
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2},
        "sensor": {
            "type": "perspective", "fov": 24, "to_world": look,
            "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent", "sample_count": spp},
        },
        "sky": {"type": "envmap", "bitmap": mi.Bitmap(sky)},
        "ball": {"type": "sphere", "bsdf": plugin.bsdf(brdf)},
    })


def difference(brdf, other):
    """The mean difference of log values over many pairs of directions."""
    rng = np.random.default_rng(2)
    w = rng.normal(size=(2, 5000, 3))
    w[..., 2] = np.abs(w[..., 2]) + 0.2
    return np.abs(np.log((0.05 + brdf.eval_cos(*w)) / (0.05 + other.eval_cos(*w)))).mean()


def main():
    """Renders the picture, and goes down."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a small picture, fewer steps")
    parser.add_argument("--out", default="out/mitsuba_recover", type=pathlib.Path)
    arguments = parser.parse_args()
    size, spp, steps = (32, 32, 60) if arguments.quick else (64, 64, 240)
    truth = material()
    picture = mi.render(scene(truth, size, spp), spp=512, seed=1000)
    theta = (np.arange(ENTRIES) + 0.5) / ENTRIES
    start = truth.replace(D=0.2 * np.exp(-theta[None] * 3), s=[[3.0, 3.0, 3.0]])
    ball = scene(start, size, spp)
    first = mi.render(ball, spp=256)
    parameters = mi.traverse(ball)
    # Adam steps in logarithms, which may be any real number.
    adam = mi.ad.Adam(lr=0.06)
    for name in ("D", "s"):
        adam[name] = mi.TensorXf(np.log(np.array(parameters[f"ball.bsdf.{name}"])))
    wanted = dr.log(0.02 + picture)
    for step in range(steps):
        for name in ("D", "s"):
            parameters[f"ball.bsdf.{name}"] = dr.exp(adam[name])
        parameters.update()
        error = dr.mean(dr.square(dr.log(0.02 + mi.render(ball, parameters, spp=spp, seed=step)) - wanted), axis=None)
        dr.backward(error)
        adam.step()
        if step % 20 == 0 or step == steps - 1:
            print(f"step {step:4}: error of the picture {float(np.ravel(np.array(error))[0]):.5f}")
    found = truth.replace(**{name: np.exp(np.array(adam[name], np.float64)) for name in ("D", "s")})
    print(f"difference of log values from the truth: {difference(start, truth):.3f} at the start, "
          f"{difference(found, truth):.3f} now")
    ratio = np.ravel(found.s / found.s[0, 0]) / np.ravel(truth.s / truth.s[0, 0])
    print(f"colours of s, relative to the true ones: {np.round(ratio, 3)}")
    arguments.out.mkdir(parents=True, exist_ok=True)
    last = mi.render(scene(found, size, spp), spp=256)
    for name, image in (("picture", picture), ("before", first), ("after", last)):
        mi.util.write_bitmap(str(arguments.out / f"{name}.png"), image)
    found.save(arguments.out / "recovered.json")


if __name__ == "__main__":
    main()
