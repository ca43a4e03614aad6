"""Mitsuba for tests, where that is installed: scalar variants, and compiled ones where LLVM is there.

TRILOBE_TEST_BACKEND=cuda takes Mitsuba's variants for NVIDIA cards in the place of those for LLVM.
"""

import os

import numpy as np
import pytest

from models import anisotropic, independent, isotropic, lambertian, stretched

mi = pytest.importorskip("mitsuba")
import drjit as dr  # noqa: E402

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
