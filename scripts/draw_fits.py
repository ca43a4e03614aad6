#!/usr/bin/python3
"""Draws a picture of fits for a page, by the program trilobe: draw_fits.py NAME [SOURCE] [--out=.].

Those of few_samples and forms need a measured file, SOURCE; corruptions needs a group of kinds (readings, directions
or light).
"""

import argparse
import pathlib

from diagrams import corruptions, fits
from diagrams.look import save

DRAWN = {draw.__name__: draw for draw in (corruptions.corruptions, fits.few_samples, fits.forms, fits.method,
                                          fits.saturated, fits.stored, fits.synthetic)}


def main() -> None:
    """The one that is named."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", choices=DRAWN)
    parser.add_argument("source", nargs="*", help="a measured file, or a group of kinds")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("."), help="a folder")
    options = parser.parse_args()
    sources = [str(pathlib.Path(source).absolute()) if pathlib.Path(source).exists() else source
               for source in options.source]
    picture = fits.in_a_folder(DRAWN[options.name], *sources)
    colors = {"corruptions": 192, "forms": 96, "stored": 96, "method": 256}.get(options.name, 0)
    name = "_".join((options.name, *options.source)) if options.name == "corruptions" else options.name
    save(picture, options.out / f"{name}.png", colors)


if __name__ == "__main__":
    main()
