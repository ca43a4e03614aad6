"""Pictures in OpenEXR: uncompressed scanlines of float32, which arrays can be mapped onto.

https://openexr.com/en/latest/OpenEXRFileLayout.html
"""

from __future__ import annotations

import os
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from trilobe._model.error import Error
from trilobe._model.files import printable

_MAGIC = b"\x76\x2f\x31\x01\x02\x00\x00\x00"
_CHANNELS = {1: "Y", 3: "BGR"}  # in the order of a file, by how many there are

Picture = NDArray[np.float32]


def _header(width: int, height: int, channels: int) -> bytes:
    """All before the lines: attributes, and where each line begins."""
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    # Entry of each channel: name, 2 for float32, not linear to the eye, and one sample per pixel.
    listed = b"".join(
        name.encode() + b"\0" + struct.pack("<i4x2i", 2, 1, 1) for name in _CHANNELS[channels]
    )
    attributes = [
        ("channels", "chlist", listed + b"\0"),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1)),
        ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1)),
    ]
    head = _MAGIC + b"".join(
        f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value for name, kind, value in attributes
    ) + b"\0"
    first = len(head) + 8 * height
    lines = first + np.arange(height, dtype="<u8") * _line(width, channels).itemsize
    return head + lines.tobytes()


def _line(width: int, channels: int) -> np.dtype[Any]:
    return np.dtype([("y", "<i4"), ("size", "<i4"), ("values", "<f4", (channels, width))])


class Writer:
    """Writes a file of 1 or 3 channels from its top to its bottom, beside its place until it is closed.

    Raises OSError.
    """

    def __init__(self, path: Path, height: int, width: int, channels: int) -> None:
        self._path = path
        self._beside = path.with_name(f".{path.name}")
        self._line = _line(width, channels)
        self._next = 0
        self._file = open(self._beside, "wb")
        self._file.write(_header(width, height, channels))

    def append(self, pixels: Picture) -> None:
        """The next lines: (lines, width, channels)."""
        lines = np.empty(len(pixels), self._line)
        lines["y"] = np.arange(self._next, self._next + len(lines))
        lines["size"] = self._line.itemsize - 8
        _pixels(lines)[...] = pixels
        self._file.write(lines.tobytes())
        self._next += len(lines)

    def close(self) -> None:
        """Moves it to its place."""
        self._file.close()
        os.replace(self._beside, self._path)


def read(path: Path, height: int, width: int, channels: int) -> Picture:
    """The pixels of a file that `Writer` has made, read when they are used: (height, width, channels)."""
    lines = height * (8 + 4 * width * channels)
    try:
        size = path.stat().st_size
        with open(path, "rb") as file:
            few = 0 < size - lines < 1000 + 8 * height
            right = few and file.read(size - lines) == _header(width, height, channels)
    except OSError as error:
        raise Error(f"cannot read {printable(path)}: {error.strerror}") from None
    if not right:
        raise Error(f"{printable(path)} is no picture of {width} x {height} float32 pixels as fit_texels writes them")
    return _pixels(np.memmap(path, _line(width, channels), "r", size - lines, (height,)))


def _pixels(lines: NDArray[Any]) -> Picture:
    """Pixels (height, width, channels) of lines that hold channel after channel, blue first."""
    pixels: Picture = lines["values"].transpose(0, 2, 1)[..., ::-1]
    return pixels
