"""The scenes, as Mitsuba takes them and as arrays: camera, shape and light.

The world: y up, z towards the eye. A probe's middle column is behind the object (-z), as in
`trilobe score --probe`. Flags of both programs that show a scene:

    --shape=sphere|FILE.obj --probe=FILE.hdr --eye=x,y,z --target=x,y,z --view=DEGREES --size=WxH
"""
import argparse
import glob
import os

import numpy

LLVM = "/usr/lib/*/libLLVM.so.19*"  # the one of Debian's that Dr.Jit works with


def _numbers(kind, separator):
    return lambda text: [kind(part) for part in text.split(separator)]


def parser(usage):
    """A parser with the flags of a scene."""
    result = argparse.ArgumentParser(description=usage,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    result.add_argument("--shape", default="sphere")
    result.add_argument("--probe")
    result.add_argument("--eye", type=_numbers(float, ","), default=[0, 0, 20])
    result.add_argument("--target", type=_numbers(float, ","), default=[0, 0, 0])
    result.add_argument("--view", type=float, default=6.0)
    result.add_argument("--size", type=_numbers(int, "x"), default=[128, 128])
    result.add_argument("--seed", type=int, default=1)
    return result


def mitsuba():
    """The module, in a variant that is there: vectorised where LLVM 19 is, else scalar."""
    import mitsuba as module
    if found := sorted(glob.glob(LLVM)):
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", found[-1])
    module.set_variant("llvm_ad_rgb" if "DRJIT_LIBLLVM_PATH" in os.environ else "scalar_rgb")
    return module


def shape(mi, options):
    """The shape, for mitsuba.load_dict."""
    if options.shape == "sphere":
        # Its poles, which are Mitsuba's +-z, up and down: x along the parallels of our world.
        return {"type": "sphere", "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], -90)}
    return {"type": "obj", "filename": options.shape}


def camera(options):
    """Origin, and the directions of the rays through points of the picture, a function of x and y
    in pixels from the left and from the top. [n][3]"""
    eye, target = numpy.array(options.eye), numpy.array(options.target)
    forward = (target - eye) / numpy.linalg.norm(target - eye)
    right = numpy.cross(forward, [0, 1, 0])
    right /= numpy.linalg.norm(right)
    up = numpy.cross(right, forward)
    width, height = options.size
    half = numpy.tan(numpy.radians(options.view) / 2)

    def rays(x, y):
        across, along = half * (2 * x / width - 1), half * (height - 2 * y) / width
        directions = forward + across[:, None] * right + along[:, None] * up
        return directions / numpy.linalg.norm(directions, axis=1)[:, None]
    return eye, rays


def coordinates(n, wi, wo):
    """Coordinates of two directions in a table in MERL layout: theta_h, theta_d, phi_d in units of bins, 0 at the
    centre of the first. n, wi, wo: [..., 3] of length 1. [..., 3]"""
    h = wi + wo
    h = h / numpy.maximum(numpy.linalg.norm(h, axis=-1, keepdims=True), 1e-12)
    cos_h = numpy.clip((n * h).sum(-1), 0, 1)
    across = numpy.cross(n, h)  # length sin(theta_h)
    sin_h = numpy.linalg.norm(across, axis=-1)
    cos_d = numpy.clip((wi * h).sum(-1), 0, 1)
    theta_h = numpy.degrees(numpy.arctan2(sin_h, cos_h))
    phi_d = numpy.degrees(numpy.arctan2((wi * across).sum(-1),
                                        cos_h * cos_d - (wi * n).sum(-1))) % 180
    return numpy.stack([numpy.sqrt(90 * theta_h) - 0.5, numpy.degrees(numpy.arccos(cos_d)) - 0.5,
                        phi_d - 0.5], axis=-1)


def picture(mi, options, bsdf, seed):
    """Radiance of the object by Mitsuba's own integrator, from options.samples paths a pixel that
    are reflected once. [height][width][3]"""
    eye, up = mi.ScalarPoint3f(options.eye), mi.ScalarVector3f(0, 1, 0)
    of = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2, "hide_emitters": True},
        "sensor": {"type": "perspective", "fov": options.view, "fov_axis": "x",
                   "to_world": mi.ScalarTransform4f().look_at(
                       origin=eye, target=mi.ScalarPoint3f(options.target), up=up),
                   "film": {"type": "hdrfilm", "width": options.size[0],
                            "height": options.size[1], "pixel_format": "rgb",
                            "component_format": "float32", "rfilter": {"type": "box"}},
                   "sampler": {"type": "independent"}},
        "light": {"type": "envmap", "filename": options.probe,
                  "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 180)},
        "shape": {**shape(mi, options), "bsdf": bsdf}})
    # In parts: a part's paths are in memory at a time.
    parts = max(1, options.samples * options.size[0] * options.size[1] // 2 ** 22)
    total = sum(numpy.array(of.integrator().render(of, spp=options.samples // parts,
                                                   seed=1000 * seed + part))
                for part in range(parts))
    return total / parts
