#!/usr/bin/env python3
"""A model in Mitsuba 3: fit, render beside two of Mitsuba's own materials, without a file in between.

mitsuba_scene.py [--quick] [--variant=llvm_ad_rgb] [--out=FOLDER] [MODEL.json...]     writes mitsuba_scene.png
"""

import argparse
import pathlib

import mitsuba as mi
import numpy as np

import trilobe


def sky():
    """A sun, a window, and a sky that is brighter towards the horizon."""
    height = np.linspace(1, -1, 64)[:, None]
    picture = np.where(height > 0, 0.9 - 0.5 * height, 0.12)[..., None] * np.ones((64, 128, 3))
    picture *= np.where(height[..., None] > 0, [0.75, 0.9, 1.15], [1.0, 0.9, 0.8])
    picture[12:15, 30:33] = [220, 205, 180]
    picture[18:36, 84:100] += [5, 5, 5.5]
    return mi.Bitmap(picture.astype(np.float32))


def main():
    """Renders a row of spheres."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", help="by default fits of synthetic materials")
    parser.add_argument("--quick", action="store_true", help="a small picture of rough fits")
    parser.add_argument("--variant", default="llvm_ad_rgb", help="scalar_rgb needs no LLVM")
    parser.add_argument("--out", default="out/mitsuba_scene", type=pathlib.Path)
    arguments = parser.parse_args()
    mi.set_variant(arguments.variant)
    import trilobe.mitsuba as plugin  # registers the BSDF

    if arguments.models:
        models = [trilobe.load(path) for path in arguments.models]
    else:
        sources = ["synth:plastic@24x24x48"] if arguments.quick else ["synth:plastic", "synth:copper", "synth:felt"]
        models = [trilobe.fit(source, max_iterations=3 if arguments.quick else 100).model for source in sources]
    materials = [plugin.bsdf(model) for model in models] + [{"type": "roughplastic", "alpha": 0.15}]
    width = 2.3 * len(materials)
    look = mi.ScalarTransform4f().look_at([0, 1.2, 9], [0, 0, 0], [0, 1, 0])
    pixels = 64 if arguments.quick else 240
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 6},
        "sensor": {
            "type": "perspective", "fov": float(np.degrees(2 * np.arctan(width / 2 / 9))), "to_world": look,
            "film": {"type": "hdrfilm", "width": pixels * len(materials), "height": pixels},
            "sampler": {"type": "independent", "sample_count": 4 if arguments.quick else 256},
        },
        "sky": {"type": "envmap", "bitmap": sky()},
        "floor": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().translate([0, -1, 0]).rotate([1, 0, 0], -90).scale(40),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.35, 0.33, 0.3]}},
        },
    }
    for k, material in enumerate(materials):
        center = [2.3 * (k - (len(materials) - 1) / 2), 0, 0]
        scene[f"ball{k}"] = {"type": "sphere", "center": center, "bsdf": material}
    picture = mi.render(mi.load_dict(scene))
    arguments.out.mkdir(parents=True, exist_ok=True)
    mi.util.write_bitmap(str(arguments.out / "mitsuba_scene.png"), picture)
    print(f"{arguments.out / 'mitsuba_scene.png'}: {models}, and Mitsuba's roughplastic to their right")


if __name__ == "__main__":
    main()
