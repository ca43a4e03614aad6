#!/usr/bin/python3
"""Draws the measured ones of the library of materials as one picture: each measured and fitted, with its name.

gallery.py --out=DIR makes DIR/materials.png of the thumbnails that materials/make leaves beside the models.
"""

import argparse
import json
import pathlib

from PIL import Image, ImageDraw, ImageFont

MATERIALS = pathlib.Path(__file__).resolve().parent.parent / "materials"
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
COLUMNS, GAP, LABEL = 6, 10, 24


def spheres(path: pathlib.Path) -> Image.Image:
    """The two spheres of a thumbnail, without the words below them, at half the size."""
    pair = Image.open(path).convert("RGB")
    width = pair.size[0]
    return pair.crop((0, 0, width, width // 2)).resize((width // 2, width // 4), Image.Resampling.LANCZOS)


def main() -> None:
    """Pastes the thumbnails row by row; the legend has the place of one, where they fill no rectangle."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("."), help="a folder")
    options = parser.parse_args()
    listed = [of for of in json.loads((MATERIALS / "materials.json").read_text()) if of["parameters"] <= 822]
    pairs = [spheres(MATERIALS / f"{entry['name']}.png") for entry in listed]
    width, height = pairs[0].size
    rows = -(-(len(pairs) + 1) // COLUMNS)
    background = pairs[0].getpixel((0, 0))
    picture = Image.new("RGB", (COLUMNS * (width + GAP) + GAP, rows * (height + LABEL + GAP) + GAP), background)
    draw = ImageDraw.Draw(picture)
    font = ImageFont.truetype(FONT, 15)
    legend = "left: measured\nright: fitted by\n822 numbers at most"
    for k in range(len(pairs) + 1):
        x = GAP + k % COLUMNS * (width + GAP)
        y = GAP + k // COLUMNS * (height + LABEL + GAP)
        if k == len(pairs):
            draw.multiline_text((x + width / 2, y + height / 2), legend, (230, 230, 230), font, "mm", align="center")
        else:
            picture.paste(pairs[k], (x, y))
            draw.text((x + width / 2, y + height + LABEL / 2), listed[k]["title"], (230, 230, 230), font, "mm")
    picture.save(options.out / "materials.png", optimize=True)


if __name__ == "__main__":
    main()
