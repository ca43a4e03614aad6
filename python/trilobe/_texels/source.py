"""Values of texels, of which a few rows at a time are read."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from trilobe._model.arrays import as_array
from trilobe._model.error import Error
from trilobe._model.files import printable, text_of_path

_TILE = 1 << 22  # numbers in a tile, unless a row has more

Vector = NDArray[np.float64]


class Source:
    """Values [1/sr] of texels, (height, width, samples, 3) or (texels, samples, 3).

    Args:
        rho: an array, the path of a .npy file, or what has a shape and gives arrays for slices.
    """

    def __init__(self, rho: Any) -> None:
        if isinstance(rho, (str, os.PathLike)):
            rho = _mapped(text_of_path(rho))
        elif not hasattr(rho, "shape") or not hasattr(rho, "__getitem__"):
            rho = as_array(rho, "rho")
        shape = _shape_of(rho)
        if len(shape) not in (3, 4) or shape[-1] != 3:
            raise Error(f"rho has the shape {shape}, and must have (height, width, samples, 3) or (texels, samples, 3)")
        self._rho, self._row = rho, shape[1:]
        self.shape, self.samples = shape[:-2], shape[-2]

    def tiles(self) -> list[tuple[int, int]]:
        """Rows from and to."""
        height = self.shape[0]
        rows = max(1, _TILE // max(1, int(np.prod(self._row, dtype=np.int64))))
        return [(begin, min(begin + rows, height)) for begin in range(0, height, rows)]

    def read(self, begin: int, end: int) -> Vector:
        """Texels of some rows, (n, samples, 3)."""
        try:
            values = self._rho[begin:end]
        except Exception as error:  # whatever the other library raises
            reason = (str(error) or type(error).__name__).splitlines()[0]
            raise Error(f"rho cannot be read: {reason}") from None
        array = as_array(values, "rho")
        if array.shape != (end - begin, *self._row):
            raise Error(f"rho gives the shape {array.shape} for {end - begin} rows")
        return np.ascontiguousarray(array.reshape(-1, self.samples, 3), np.float64)

    def spread(self, count: int) -> Vector:
        """Values of about `count` texels, spread evenly."""
        height, width = self.shape[0], self.shape[1] if len(self.shape) > 1 else 1
        if height * width == 0:
            raise Error("there is no texel")
        rows = min(height, max(64, count // width))
        columns = _spread(width, max(1, count // rows))
        return np.concatenate([self.read(row, row + 1)[columns] for row in _spread(height, rows).tolist()])


def _spread(size: int, count: int) -> NDArray[np.int64]:
    count = min(count, size)
    return (np.arange(count, dtype=np.int64) * 2 + 1) * size // (2 * count)


def _shape_of(array: Any) -> tuple[int, ...]:
    """The shape of an array; () if it is none."""
    try:
        return tuple(int(length) for length in array.shape)
    except (TypeError, ValueError):
        return ()


def _mapped(path: str) -> Any:
    try:
        return np.load(path, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise Error(f"cannot map {printable(path)} as a .npy file: {reason}") from None
