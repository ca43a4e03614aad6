#!/usr/bin/python3
"""Draws the diagrams of the pages, which need no fit: draw_diagrams.py [NAME...] [--out=.]."""

import argparse
import pathlib

from diagrams import geometry, program
from diagrams.look import save

DRAWN = {
    "angles": geometry.angles,
    "factors": geometry.model,
    "layout": geometry.layout,
    "folding": geometry.folding,
    "parts": program.parts,
    "solver": program.solver,
    "on_disk": program.on_disk,
    "cost": program.cost,
}


def main() -> None:
    """Draws the diagrams that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help=", ".join(DRAWN))
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("."), help="a folder")
    options = parser.parse_args()
    for name in options.names or DRAWN:
        if name not in DRAWN:
            parser.error(f"there is no {name}; there are {', '.join(DRAWN)}")
        save(DRAWN[name](), options.out / f"{name}.png")


if __name__ == "__main__":
    main()
