"""Shared look of the pages' diagrams: that of the experiments' pictures, arrows, arcs and boxes."""

from __future__ import annotations

import pathlib
import sys
from typing import Any

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "experiments"))

from lab.plots import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, plt  # noqa: E402

__all__ = ["BLUE", "GREEN", "GREY", "ORANGE", "PURPLE", "ROOT", "SKY", "VERMILION", "arrow", "bare", "box", "plt",
           "save", "table_of"]

RGB = ("#c03030", "#2f8f3f", "#3050c0")


def bare(axes: Any, width: float, height: float) -> None:
    """An empty sheet of that size, of equal units."""
    axes.set(xlim=(0, width), ylim=(0, height), aspect="equal")
    axes.axis("off")


def arrow(axes: Any, start: Any, end: Any, color: str = "#404040", **style: Any) -> None:
    """Draws an arrow from one point to another."""
    how = {"arrowstyle": "-|>", "color": color, "lw": 1.6, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 11, **style}
    axes.annotate("", xy=tuple(end), xytext=tuple(start), arrowprops=how)


def box(axes: Any, corner: tuple[float, float], size: tuple[float, float], text: str, color: str = "#eef3f8",
        **style: Any) -> None:
    """A rectangle with text in its middle, or at its top left by va="top"."""
    axes.add_patch(plt.Rectangle(corner, *size, facecolor=color, edgecolor="#6a7f94", lw=1))
    top = style.get("va") == "top"
    x, y = (corner[0] + 0.12, corner[1] + size[1] - 0.12) if top else np.add(corner, np.multiply(size, 0.5))
    axes.text(x, y, text, **{"ha": "left" if top else "center", "va": "center", "fontsize": 9, **style})


def table_of(page: str, first: str) -> list[list[str]]:
    """The rows of the table of a page of docs whose header begins with that cell."""
    rows: list[list[str]] = []
    for line in (ROOT / "docs" / page).read_text().splitlines():
        if line.startswith(f"| {first} |") or (rows and line.startswith("|")):
            rows.append([cell.strip() for cell in line.strip("|").split("|")])
        elif rows:
            break
    if not rows:
        raise SystemExit(f"docs/{page} has no table that begins with '{first}'")
    return rows[2:]


def save(figure: Any, path: pathlib.Path, colors: int = 96) -> None:
    """Saves a figure with a palette, which is a third of the size; photographs, by colors=0, without."""
    from PIL import Image

    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3].copy())
    if colors:
        picture = picture.quantize(colors, dither=Image.Dither.NONE)
    picture.save(path, optimize=True)
    plt.close(figure)
