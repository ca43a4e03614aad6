"""Results of `trilobe-need` so far: its pictures, how far they are apart, and the page that shows them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from trilobe._model.files import write_text
from trilobe._need.page import page, totals


class Picture(NamedTuple):
    """A rendered scene."""

    linear: NDArray[np.float64]
    seconds: float


class Difference(NamedTuple):
    """The difference of two pictures."""

    flip: float
    delta_e: float
    map: NDArray[np.float32]


def shown(linear: NDArray[np.float64], white: float) -> NDArray[np.float32]:
    """sRGB, 0 to 1, of linear light."""
    x = np.clip(np.nan_to_num(linear) / white, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055).astype(np.float32)


def _lab(linear: NDArray[np.float64], white: float) -> NDArray[np.float64]:
    """CIELAB under D65 (CIE 15:2004)."""
    x = np.clip(np.nan_to_num(linear) / white, 0, 1)
    xyz = x @ np.array([[0.4124, 0.2126, 0.0193], [0.3576, 0.7152, 0.1192], [0.1805, 0.0722, 0.9505]])
    t = xyz / [0.95047, 1, 1.08883]
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    lab: NDArray[np.float64] = np.stack(
        [116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], axis=-1)
    return lab


def difference(reference: NDArray[np.float64], test: NDArray[np.float64], white: float) -> Difference:
    """Mean FLIP (Andersson et al. 2020) with its map, and the mean CIELAB difference."""
    import flip_evaluator

    heat, mean, _ = flip_evaluator.evaluate(shown(reference, white), shown(test, white), "LDR")
    delta_e = np.linalg.norm(_lab(reference, white) - _lab(test, white), axis=-1)
    return Difference(float(mean), float(delta_e.mean()), np.asarray(heat, np.float32))


def _write_png(path: Path, srgb: NDArray[np.float32]) -> None:
    from trilobe._mitsuba.renderer import mi

    bytes_of = (np.clip(srgb, 0, 1) * 255 + 0.5).astype(np.uint8)
    mi.Bitmap(np.ascontiguousarray(bytes_of)).write(str(path))


class Result:
    """All of it. Pictures are written as they come, and `index.html` each time that there is news."""

    def __init__(self, out: Path, scene: str, settings: dict[str, Any], rows: list[dict[str, Any]]) -> None:
        """`settings` are of the report; `rows` one for each material, which may be completed later."""
        self.rows = rows
        self.pictures: dict[str, Picture] = {}
        self.differences: dict[str, Difference] = {}
        self.tries: list[dict[str, Any]] = []
        self.prune_seconds = 0.0  # for the last budget
        self._out, self._scene, self._settings = out, scene, settings
        self._images: dict[str, NDArray[np.float32]] = {}
        self._white = 1.0  # the brightest 2 % of the first picture are beyond it
        self._doing = ""

    def __enter__(self) -> Result:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        """Writes the page once more after an error or Ctrl-C, so that it says so."""
        if kind is not None:
            self._write_page(ended=True)

    def add(self, name: str, picture: Picture, reference: str = "") -> None:
        """Shows a picture, and its difference from another."""
        if not self.pictures:
            self._white = max(float(np.quantile(picture.linear @ [0.2126, 0.7152, 0.0722], 0.98)), 1e-12)
        self.pictures[name] = picture
        self._show(name, shown(picture.linear, self._white))
        if reference:
            apart = difference(self.pictures[reference].linear, picture.linear, self._white)
            self.differences[name] = apart
            self._show(f"{name}_flip", apart.map)

    def _show(self, name: str, image: NDArray[np.float32]) -> None:
        self._images[name] = image
        _write_png(self._out / f"{name}.png", image)

    def tell(self, doing: str) -> None:
        """Says on the page what goes on."""
        self._doing = doing
        self._write_page()

    def _write_page(self, ended: bool = False) -> None:
        write_text(self._out / "index.html", page({**self.report(), "doing": self._doing, "ended": ended}))

    def finish(self) -> dict[str, Any]:
        """Writes what comes last, and returns what `need.json` has."""
        kinds = ("measured", "pruned", "pruned_flip")
        rows = [[self._images[prefix + kind] for kind in kinds]
                for prefix in ("", "moved_") if prefix + "measured" in self._images]
        self._show("overview", np.concatenate([np.concatenate(row, axis=1) for row in rows]))
        report = self.report()
        write_text(self._out / "need.json", json.dumps(report, indent=1) + "\n")
        self.tell("")
        return report

    def report(self) -> dict[str, Any]:
        """The report on results so far."""
        seconds = {name: picture.seconds for name, picture in self.pictures.items()}
        return {
            "totals": totals(self.rows, seconds), "scene": self._scene, **self._settings,
            "materials": self.rows, "tries": self.tries,
            "pictures": {name: {"seconds": value} for name, value in seconds.items()},
            "differences": {name: {"flip": d.flip, "delta_e": d.delta_e} for name, d in self.differences.items()},
        }
