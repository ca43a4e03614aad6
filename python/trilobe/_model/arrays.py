"""Conversion of arrays of others before C++ sees them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from trilobe._model.error import Error

Floats = NDArray[np.floating[Any]]


def as_array(values: Any, name: str) -> NDArray[Any]:
    """A numpy array of numbers, without a copy where that is possible.

    Takes numpy arrays, sequences of numbers, and whatever exports DLPack or ``__array__`` from
    the CPU's memory, as tensors of PyTorch, JAX and Dr.Jit do.
    """
    try:
        if isinstance(values, np.ndarray) or not hasattr(values, "__dlpack__"):
            array = np.asarray(values)
        else:
            array = np.from_dlpack(values)
    except Error:
        raise
    except Exception as error:  # whatever the other library raises
        reason = (str(error) or type(error).__name__).splitlines()[0]
        raise Error(
            f"{name} cannot be read as an array in the CPU's memory: {reason}", kind="format", key=name
        ) from None
    if array.dtype.kind not in "fiub":
        raise Error(
            f"{name} has the dtype {array.dtype}, and must be of real numbers",
            kind="format",
            key=name,
            value=str(array.dtype),
        )
    return array


def of_one_precision(**named: Any) -> list[Floats]:
    """Arrays of float32 where all that have a precision of their own are single or half, else of float64."""
    arrays = [as_array(values, name) for name, values in named.items()]
    precisions = [
        array.dtype.itemsize if array.dtype.kind == "f" else 8
        for array, values in zip(arrays, named.values())
        if hasattr(values, "dtype")
    ]
    single = bool(precisions) and max(precisions) <= 4
    with np.errstate(over="ignore"):
        return [np.asarray(array, np.float32 if single else np.float64) for array in arrays]


def check_width(array: Floats, name: str, width: int, what: str) -> None:
    """Raises Error unless the last axis is so long."""
    if array.ndim == 0 or array.shape[-1] != width:
        raise Error(
            f"{name} has the shape {array.shape}; {what} are an array of the shape (..., {width})",
            kind="mismatch",
            key=name,
            value=str(array.shape),
        )


def common_shape(*arrays: Floats) -> tuple[int, ...]:
    """The shape to which the shapes without their last axes broadcast."""
    try:
        return np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
    except ValueError:
        shapes = " and ".join(str(array.shape) for array in arrays)
        raise Error(
            f"shapes {shapes} do not go together; all axes but the last must be equal or 1", kind="mismatch"
        ) from None


def rows(array: Floats, shape: tuple[int, ...]) -> Floats:
    """The array as rows side by side, one for each place of the shape, or one for all."""
    width = array.shape[-1]
    if array.size == width:
        return np.ascontiguousarray(array.reshape(1, width))
    if array.shape[:-1] != shape:
        array = np.broadcast_to(array, (*shape, width))
    return np.ascontiguousarray(array.reshape(-1, width))
