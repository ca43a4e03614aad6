"""Surfaces of a few materials, a diffuse term and strengths a texel."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from trilobe._model.arrays import Floats, check_width, of_one_precision
from trilobe._model.brdf import Brdf, load
from trilobe._model.error import Error
from trilobe._model.files import make_folder, printable, text_of_path, write_text
from trilobe._texels import exr

_FORMAT = {"format": "trilobe-texels", "version": 1}
_ABOUT = "texels.json"


class Texels:
    """A surface of a few materials, as `fit_texels` finds it and `load_texels` reads it.

        f = d + sum over materials of s times the lobes of the material

    Attributes:
        materials: models of them, of which the lobes count, and not the diffuse term.
        d: the diffuse term [1/sr] of each texel, (..., 3), where ... are the axes of the texels.
        s: of each material its strengths, (..., 3).
        error: the root of E over that of a black texel, (...): 0 is exact, 1 nothing of it.

    Arrays are of float32. Those of a folder are read as they are used, so that memory need not hold them.
    """

    materials: list[Brdf]
    d: NDArray[np.float32]
    s: list[NDArray[np.float32]]
    error: NDArray[np.float32]

    def __init__(
        self,
        materials: Sequence[Brdf],
        d: NDArray[np.float32],
        s: Sequence[NDArray[np.float32]],
        error: NDArray[np.float32],
    ) -> None:
        """Takes what is described above."""
        self.materials, self.d, self.s, self.error = list(materials), d, list(s), error

    @property
    def shape(self) -> tuple[int, ...]:
        """The axes of the texels, as (height, width)."""
        return self.error.shape

    def eval(self, wi: Any, wo: Any) -> Floats:
        """The BRDF f [1/sr] of each texel, without a cosine, (..., 3).

        Args:
            wi: a direction (3,), or one for each texel, (..., 3); as `Brdf.eval` takes them.
            wo: the same.
        """
        wi, wo = of_one_precision(wi=wi, wo=wo)
        for name, w in (("wi", wi), ("wo", wo)):
            check_width(w, name, 3, "directions")
            if w.ndim > 1 and w.shape[:-1] != self.shape:
                raise Error(f"{name} has the shape {w.shape}, and must have (3,) or {(*self.shape, 3)}")
        above: Any = (wi[..., 2:] > 0) & (wo[..., 2:] > 0)
        none: Any = 0
        for w in (wi, wo):
            none = none | ~np.isfinite(w).all(axis=-1, keepdims=True) | (w == 0).all(axis=-1, keepdims=True)
        f = np.where(none, np.nan, np.where(above, self.d, np.zeros((), wi.dtype)))
        for material, strength in zip(self.materials, self.s):
            f += strength * lobes_of(material, wi, wo)
        return f.astype(wi.dtype, copy=False)

    def save(self, folder: str | os.PathLike[str], *, force: bool = False) -> None:
        """Writes d.exr, error.exr, s0.exr and so on, materials/0.json and so on, and texels.json into a folder.

        The folder is made if need be. Strengths that are equal in all channels are pictures of one channel.

        Raises:
            Error: if it cannot be written or, without ``force``, a folder that is none of texels has such a file.
        """
        coloured = any(bool((s[..., :1] != s).any()) for s in self.s)
        name = Path(text_of_path(folder))
        if not force and About.load(name) is None:
            About(self.shape, len(self.materials), coloured).check_free(name)
        make_folder(name / "materials")
        for k, material in enumerate(self.materials):
            write_text(name / "materials" / f"{k}.json", material.to_json())
        about = About(self.shape, len(self.materials), coloured)
        strengths = self.s if coloured else [s[..., :1] for s in self.s]
        write_pictures(name, about, [[self.d, self.error[..., None], *strengths]])
        about.save(name)

    def __repr__(self) -> str:
        """A short description."""
        return f"<trilobe.Texels: {' x '.join(map(str, self.shape))}, {len(self.materials)} materials>"


def lobes_of(material: Brdf, wi: Any, wo: Any) -> Floats:
    """f without the diffuse term, (..., 3)."""
    lobes: Floats = material.eval(wi, wo, components=True)[..., 1:, :].sum(axis=-2)
    return np.maximum(lobes, 0)


def load_texels(folder: str | os.PathLike[str]) -> Texels:
    """Reads a folder that `fit_texels` or `Texels.save` has written.

    Raises:
        Error: if there is none, or it is not finished.
    """
    name = Path(text_of_path(folder))
    about = About.load(name)
    if about is None:
        raise Error(f"{printable(name)} has no {_ABOUT}, and is no folder of texels")
    materials = [load(name / "materials" / f"{k}.json") for k in range(about.materials)]
    pictures = [exr.read(name / f"{stem}.exr", *about.size, n) for stem, n in about.pictures()]
    return about.texels(materials, pictures)


class About(NamedTuple):
    """Contents of a folder of texels, by its texels.json."""

    shape: tuple[int, ...]
    materials: int
    coloured: bool
    of: str = ""
    """A hash of what `fit_texels` was given."""

    @property
    def size(self) -> tuple[int, int]:
        """Height and width of pictures; texels in a row stand in a column."""
        return self.shape[0], self.shape[1] if len(self.shape) > 1 else 1

    def pictures(self) -> list[tuple[str, int]]:
        """Their names and channels."""
        strengths = [(f"s{k}", 3 if self.coloured else 1) for k in range(self.materials)]
        return [("d", 3), ("error", 1), *strengths]

    @property
    def channels(self) -> int:
        """The number of channels of all pictures together."""
        return sum(channels for _, channels in self.pictures())

    def split(self, values: NDArray[np.float32]) -> list[NDArray[np.float32]]:
        """Values (n, channels) by picture."""
        return np.split(values, np.cumsum([channels for _, channels in self.pictures()])[:-1], axis=-1)

    def texels(self, materials: list[Brdf], pictures: list[NDArray[np.float32]]) -> Texels:
        """Texels from pictures in any shape."""
        d, error, *s = (values.reshape(*self.shape, values.shape[-1]) for values in pictures)
        return Texels(materials, d, [np.broadcast_to(values, (*self.shape, 3)) for values in s], error[..., 0])

    def check_free(self, folder: Path) -> None:
        """Raises Error if the folder has files of the names that are to be written."""
        materials = [f"materials/{k}.json" for k in range(self.materials)]
        for name in (*(f"{stem}.exr" for stem, _ in self.pictures()), *materials):
            if (folder / name).exists():
                raise Error(
                    f"{printable(folder / name)} exists, and Trilobe has not written it; move it away, or give "
                    "another folder"
                )

    def finished(self, folder: Path) -> bool:
        """Whether the pictures are there."""
        return all((folder / f"{stem}.exr").exists() for stem, _ in self.pictures())

    def save(self, folder: Path) -> None:
        """Writes texels.json."""
        write_text(folder / _ABOUT, json.dumps({**_FORMAT, **self._asdict()}))

    @classmethod
    def load(cls, folder: Path) -> About | None:
        """None where there is none. Raises Error for one that cannot be."""
        try:
            text = (folder / _ABOUT).read_text(encoding="utf-8")
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise Error(f"cannot read {printable(folder / _ABOUT)}: {reason}") from None
        try:
            said = json.loads(text)
            if {key: said.pop(key) for key in _FORMAT} != _FORMAT:
                raise ValueError("another format or version")
            about = cls(tuple(map(int, said.pop("shape"))), int(said.pop("materials")), **said)
            if len(about.shape) not in (1, 2) or min(*about.shape, about.materials) < 1:
                raise ValueError("no such shape")
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            reason = " ".join(str(error).split())
            raise Error(f"{printable(folder / _ABOUT)} is none of trilobe.fit_texels: {reason}") from None
        return about


def write_pictures(folder: Path, about: About, parts: Iterable[Sequence[NDArray[np.float32]]]) -> None:
    """Writes pictures of parts, in the order of About.pictures, each (some rows, ..., channels), from above."""
    if 0 in about.shape:
        raise Error("there is no texel to write")
    height, width = about.size
    try:
        files = [exr.Writer(folder / f"{stem}.exr", height, width, n) for stem, n in about.pictures()]
        for part in parts:
            for file, pixels in zip(files, part):
                file.append(pixels.reshape(-1, width, pixels.shape[-1]))
        for file in files:
            file.close()
    except OSError as error:
        raise Error(f"cannot write pictures into {printable(folder)}: {error.strerror}") from None
