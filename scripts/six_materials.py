#!/usr/bin/env python3
"""Draws the README's picture: six measured materials and their fitted models, rendered by Mitsuba through the package.

six_materials.py NAME_rgb.bsdf... [--out=.] makes six_materials.png of files of https://rgl.epfl.ch, each beside the
model of its name that comes with trilobe. It needs Mitsuba with LLVM, and Pillow.
"""

import argparse
import pathlib

import mitsuba as mi
import numpy as np
from PIL import Image, ImageDraw, ImageFont

mi.set_variant("llvm_ad_rgb")
import trilobe.mitsuba  # noqa: E402, F401
from trilobe._need.result import shown  # noqa: E402

WIDTH, HEIGHT, LABEL = 960, 200, 28
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"


def picture(materials: list[dict[str, str]], spp: int) -> np.ndarray:
    """Spheres on a floor, in linear RGB."""
    moved = mi.ScalarTransform4f()
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 4},
        "sensor": {
            "type": "perspective", "fov": 40,
            "to_world": moved.look_at([0, 3.6, 17.5], [0, 0.95, 0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"}},
        },
        "floor": {
            "type": "rectangle", "to_world": moved.rotate([1, 0, 0], -90).scale(40),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.3, 0.3, 0.32]}},
        },
        "key": {
            "type": "rectangle", "to_world": moved.look_at([-7, 9, 7], [0, 0, 0], [0, 1, 0]).scale([2, 2, 1]),
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [26, 24, 21]}},
        },
        "rim": {
            "type": "rectangle", "to_world": moved.look_at([8, 5, -7], [0, 1, 0], [0, 1, 0]).scale([3, 1.5, 1]),
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [14, 16, 20]}},
        },
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [0.28, 0.3, 0.34]}},
    }
    for k, material in enumerate(materials):
        x = 2.08 * (k - (len(materials) - 1) / 2)
        scene[f"ball{k}"] = {"type": "sphere", "center": [x, 0.95, 0], "radius": 0.95, "bsdf": material}
    return np.array(mi.render(mi.load_dict(scene), spp=spp), np.float64)[..., :3]


def main() -> None:
    """Two rows, measured above fitted, of the same exposure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", type=pathlib.Path, nargs="+", help="measurements, NAME_rgb.bsdf")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("."), help="a folder")
    parser.add_argument("--spp", type=int, default=256, help="samples a pixel")
    options = parser.parse_args()
    names = [path.name.removesuffix("_rgb.bsdf") for path in options.files]
    models = [f"material:{name}" for name in names]
    files = [str(path.absolute()) for path in options.files]
    rows = {
        "measured": picture([
            {"type": "trilobe_measured", "filename": file, "model": model} for file, model in zip(files, models)
        ], options.spp),
        "fitted": picture([{"type": "trilobe", "filename": model} for model in models], options.spp),
    }
    white = float(np.quantile(rows["measured"] @ [0.2126, 0.7152, 0.0722], 0.985))
    whole = Image.new("RGB", (WIDTH, 2 * HEIGHT + LABEL), (30, 30, 32))
    draw, font = ImageDraw.Draw(whole), ImageFont.truetype(FONT, 14)
    for k, (title, linear) in enumerate(rows.items()):
        pixels = (shown(linear, white) * 255 + 0.5).astype(np.uint8)
        whole.paste(Image.fromarray(pixels), (0, k * HEIGHT))
        draw.text((8, k * HEIGHT + 6), title, (250, 250, 250), font)
    for k, name in enumerate(names):
        x = WIDTH / 2 + 159 * (k - (len(names) - 1) / 2)
        draw.text((x, 2 * HEIGHT + LABEL / 2), name, (230, 230, 230), font, "mm")
    whole.save(options.out / "six_materials.png", optimize=True)


if __name__ == "__main__":
    main()
