#!/usr/bin/env python3
"""Measures the costs of the package, by `package.py arrays MODEL.json` and `package.py mitsuba MODEL.json`.

arrays    evaluations and samples a second of one core, for arrays of a million pairs, the time to import it, and
          that of the tables at the first sample
mitsuba   in llvm_ad_rgb, processor time and noise of a sphere beside roughplastic and `measured` (an RGL file of the
          same model), what recompiles, and time and memory of ten renders in a row
"""

from __future__ import annotations

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import trilobe


def arrays(brdf: trilobe.Brdf) -> None:
    """Evaluations and samples a second."""
    started = time.perf_counter()
    subprocess.run([sys.executable, "-c", "import numpy"], check=True)
    without = time.perf_counter() - started
    started = time.perf_counter()
    subprocess.run([sys.executable, "-c", "import trilobe"], check=True)
    print(f"import trilobe: {time.perf_counter() - started:.2f} s, of which Python and numpy take {without:.2f} s")
    rng = np.random.default_rng(1)
    count = 1_000_000
    for dtype in (np.float32, np.float64):
        r, phi = np.sqrt(rng.random((2, count))), 2 * np.pi * rng.random((2, count))
        wi, wo = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r**2)], axis=-1).astype(dtype)
        u = rng.random((count, 2), dtype)
        first = trilobe.Brdf.from_json(brdf.to_json())
        started = time.process_time()
        first.sample(wi[:1], u[:1])
        print(f"{np.dtype(dtype).name} tables: {1e3 * (time.process_time() - started):.0f} ms at the first sample")
        brdf.sample(wi[:1], u[:1])
        for name, call in {
            "eval": lambda wi=wi, wo=wo: brdf.eval(wi, wo),
            "pdf": lambda wi=wi, wo=wo: brdf.pdf(wi, wo),
            "sample": lambda wi=wi, u=u: brdf.sample(wi, u),
        }.items():
            seconds = []
            for _ in range(5):
                started = time.process_time()
                call()
                seconds.append(time.process_time() - started)
            print(f"{np.dtype(dtype).name} {name:6}: {1e9 * min(seconds) / count:.0f} ns, "
                  f"{count / min(seconds) / 1e6:.1f} million a second and core")


def mitsuba(brdf: trilobe.Brdf) -> None:
    """Cost and noise beside other materials."""
    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    import trilobe.mitsuba as plugin

    sky = np.full((64, 128, 3), 0.3, np.float32)
    sky[10:13, 30:34] = 60
    sky[20:30, 80:95] = 3
    look = mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0])

    def ball(material: dict) -> mi.Scene:
        return mi.load_dict({
            "type": "scene", "integrator": {"type": "path", "max_depth": 3},
            "sensor": {"type": "perspective", "fov": 24, "to_world": look,
                       "film": {"type": "hdrfilm", "width": 256, "height": 256, "rfilter": {"type": "box"}},
                       "sampler": {"type": "independent", "sample_count": 64}},
            "sky": {"type": "envmap", "bitmap": mi.Bitmap(sky)}, "ball": {"type": "sphere", "bsdf": material},
        })

    def render(scene: mi.Scene, seed: int) -> tuple[float, np.ndarray]:
        started = time.process_time()  # all threads' processor time
        picture = mi.render(scene, seed=seed)
        dr.eval(picture)
        dr.sync_thread()
        return time.process_time() - started, np.array(picture)

    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "model.bsdf"
        trilobe.convert(brdf, path)
        scenes = {
            "roughplastic": ball({"type": "roughplastic", "alpha": 0.15}),
            "trilobe": ball(plugin.bsdf(brdf)),
            "measured": ball({"type": "measured", "filename": str(path)}),
        }
    unit = 1.0
    for name, scene in scenes.items():
        render(scene, 0)
        seconds, pictures = zip(*(render(scene, seed) for seed in range(1, 11)))
        unit = min(seconds) if name == "roughplastic" else unit
        noise = np.mean(np.var(pictures, axis=0, ddof=1) / (np.mean(pictures, axis=0) + 0.01) ** 2)
        print(f"{name:12}: {min(seconds):.3f} s, {min(seconds) / unit:.2f} of roughplastic's; relative MSE {noise:.2e}")
    dr.set_flag(dr.JitFlag.KernelHistory, True)
    megabytes, seconds, misses = [], [], 0
    for seed in range(20, 30):
        seconds.append(render(scenes["trilobe"], seed)[0])
        history = [entry for entry in dr.kernel_history() if entry.get("hash") is not None]
        misses += sum(not entry["cache_hit"] for entry in history)
        pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
        megabytes.append(pages * os.sysconf("SC_PAGE_SIZE") / 1e6)
    print(f"ten renders : {seconds[0]:.3f} s first, {seconds[-1]:.3f} s last; {megabytes[0]:.0f} MB first, "
          f"{megabytes[-1]:.0f} MB last; {misses} kernels compiled again")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["arrays", "mitsuba"])
    parser.add_argument("model")
    given = parser.parse_args()
    {"arrays": arrays, "mitsuba": mitsuba}[given.what](trilobe.load(given.model))
