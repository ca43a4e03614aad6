"""Fits of texels, tile by tile."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Union, overload

import numpy as np
from numpy.typing import NDArray

from trilobe._fitting.extension import fits
from trilobe._model.arrays import as_array
from trilobe._model.brdf import Brdf, load, model_of
from trilobe._model.error import Error
from trilobe._model.files import make_folder, printable, text_of_path, write_bytes, write_text
from trilobe._texels.materials import Problem, find
from trilobe._texels.source import Source, Vector
from trilobe._texels.texels import About, Texels, load_texels, write_pictures

_LOOKED_AT = 4096  # texels in which materials are looked for
_HASHED = 256  # by which others are told
_OWN = {"callback", "start", "stop", "weighting", "weights"}  # options of `fit` that are not for others to set

Model = Union[Brdf, str, "os.PathLike[str]"]
Tile = NDArray[np.float32]


@overload
def fit_texels(
    directions: tuple[Any, Any], rho: Any, shared: int | Sequence[Model], *, out: str | os.PathLike[str] | None = ...,
    shard: None = ..., coloured: bool = ..., weighting: str = ..., anisotropic: bool = ..., threads: int = ...,
    progress: bool = ..., **fit_options: Any,
) -> Texels: ...


@overload
def fit_texels(
    directions: tuple[Any, Any], rho: Any, shared: int | Sequence[Model], *, out: str | os.PathLike[str],
    shard: tuple[int, int], coloured: bool = ..., weighting: str = ..., anisotropic: bool = ..., threads: int = ...,
    progress: bool = ..., **fit_options: Any,
) -> None: ...


def fit_texels(
    directions: tuple[Any, Any],
    rho: Any,
    shared: int | Sequence[Model],
    *,
    out: str | os.PathLike[str] | None = None,
    shard: tuple[int, int] | None = None,
    coloured: bool = False,
    weighting: str = "appearance",
    anisotropic: bool = False,
    threads: int = 0,
    progress: bool = True,
    **fit_options: Any,
) -> Texels | None:
    """Fits a surface that consists of a few materials, texel by texel.

        f = d + sum over materials of s times the lobes of the material

    d and s of each texel are those >= 0 of the least E (docs/objective.md), by non-negative least squares.

    Args:
        directions: wi and wo, each (samples, 3), in which all texels were measured; away from the surface, z along
            its normal.
        rho: BRDF values [1/sr] without a cosine, (height, width, samples, 3) or (texels, samples, 3): an array, the
            path of a .npy file, or what has a shape and gives arrays for slices of its first axis, as h5py and zarr
            do; a few rows at a time are read. A texel's samples that are negative or not finite are left out.
        shared: the materials, up to 6, as models or files of them, of which the lobes count; or how many to find,
            in 4096 of the texels.
        out: a folder to write to, tile by tile (`Texels.save`); then memory does not grow with the texels, and the
            same call goes on where one was interrupted.
        shard: (k, n) does the k-th of n shares of the tiles, from 1 on, and returns None. When all are through, the
            same call without it makes the pictures.
        coloured: gives a material a strength for each channel of a texel, in place of one for all.
        weighting: a name of `weightings()`; what it is relative to is the mean of the texel.
        anisotropic: whether materials that are to be found change with the azimuth.
        threads: 0 for all cores.
        progress: shows a bar, where tqdm is installed.
        **fit_options: of `fit`, for materials that are to be found, as lobes=1.

    Raises:
        Error: if an argument makes no sense, or `out` holds what another call has written.
        KeyboardInterrupt: soon; tiles in `out` remain.
    """
    source = Source(rho)
    options = {"weighting": weighting, "coloured": coloured, "threads": threads}
    problem = Problem(*_unit(directions, source.samples), options, anisotropic)
    problem.solve(problem.none, np.empty((0, source.samples, 3)))  # its errors
    texels = _Fit(problem, source, _given(shared), fit_options, bool(progress))
    if out is not None:
        return texels.in_folder(Path(text_of_path(out)), shard)
    if shard is not None:
        raise Error("a shard needs a folder to write to; give out=")
    return texels.in_memory()


class _Fit:
    """A fit of texels that is to be made: its problem, values, materials and options."""

    def __init__(
        self, problem: Problem, source: Source, shared: int | list[Brdf], options: dict[str, Any], progress: bool
    ) -> None:
        if options and not isinstance(shared, int):
            raise Error(f"{min(options)} is for materials that are to be found, and these are given")
        if _OWN & set(options):
            raise Error(f"{min(_OWN & set(options))} cannot be chosen for materials of texels")
        self._problem, self._source, self._shared = problem, source, shared
        self._options, self._progress = options, progress

    def in_memory(self) -> Texels:
        """All texels."""
        about, materials = self._about(), self._materials()
        lobes = self._lobes(materials)
        tiles = [self._tile(rows, lobes) for rows in self._shown(self._source.tiles())]
        empty = np.empty((0, about.channels), np.float32)
        return about.texels(materials, about.split(np.concatenate([empty, *tiles])))

    def in_folder(self, folder: Path, shard: Any) -> Texels | None:
        """Fits texels into a folder: those of a shard, or all and their pictures."""
        import shutil

        tiles, about = self._source.tiles(), self._about(self._hash())
        share = _share(shard, len(tiles))
        there = About.load(folder)
        if there is None:
            about.check_free(folder)
            make_folder(folder)
            about.save(folder)
        elif there != about:
            raise Error(f"{printable(folder)} holds texels of other values or options; give another folder")
        if not about.finished(folder):
            lobes = self._lobes(self._kept_materials(folder / "materials"))
            make_folder(folder / "tiles")
            paths = [folder / "tiles" / f"{begin}-{end}.npy" for begin, end in tiles]
            for number in self._shown(share):
                if not paths[number].exists():
                    content = io.BytesIO()
                    np.save(content, self._tile(tiles[number], lobes))
                    write_bytes(paths[number], content.getvalue())
            if shard is not None:
                return None
            write_pictures(folder, about, (about.split(np.load(path)) for path in paths))
            shutil.rmtree(folder / "tiles", ignore_errors=True)
        return None if shard is not None else load_texels(folder)

    def _about(self, of: str = "") -> About:
        count = self._shared if isinstance(self._shared, int) else len(self._shared)
        return About(self._source.shape, count, self._problem.options["coloured"], of)

    def _hash(self) -> str:
        """Hash of all that results depend on; of the values a few."""
        import hashlib

        shared, problem = self._shared, self._problem
        given = shared if isinstance(shared, int) else [material.to_json() for material in shared]
        options = {**problem.options, **self._options, "anisotropic": problem.anisotropic, "threads": 0}
        told = repr((given, sorted(options.items())))
        parts = (problem.wi, problem.wo, self._source.spread(_HASHED))
        content = told.encode("utf-8", "surrogatepass") + b"".join(part.tobytes() for part in parts)
        return hashlib.blake2b(content, digest_size=16).hexdigest()

    def _materials(self) -> list[Brdf]:
        if not isinstance(self._shared, int):
            return self._shared
        options = {"progress": self._progress, **self._options}
        return find(self._problem, self._source.spread(_LOOKED_AT), self._shared, options)

    def _kept_materials(self, folder: Path) -> list[Brdf]:
        """Materials of a folder, which is made if need be; of shards that make it at once, the first decides."""
        import shutil
        import tempfile

        if not folder.exists():
            materials = self._materials()
            made: Path | None = None
            try:
                made = Path(tempfile.mkdtemp(dir=folder.parent, prefix=".materials-"))
                for k, material in enumerate(materials):
                    write_text(made / f"{k}.json", material.to_json())
                made.chmod(0o755)
                made.rename(folder)
            except OSError as error:
                if made is not None:
                    shutil.rmtree(made, ignore_errors=True)
                if not folder.exists():
                    raise Error(f"cannot make the folder {printable(folder)}: {error.strerror}") from None
        return [load(folder / f"{k}.json") for k in range(self._about().materials)]

    def _lobes(self, materials: list[Brdf]) -> Vector:
        return np.stack([self._problem.lobes(material) for material in materials])

    def _tile(self, rows: tuple[int, int], lobes: Vector) -> Tile:
        """d, error and strengths of each texel, side by side."""
        solved = self._problem.solve(lobes, self._source.read(*rows))
        s = solved.s if self._problem.options["coloured"] else solved.s[..., :1]
        strengths = [s[:, k] for k in range(s.shape[1])]
        return np.column_stack([solved.d, solved.error, *strengths]).astype(np.float32)

    def _shown(self, work: Sequence[Any]) -> Iterator[Any]:
        """The same, with a bar."""
        if self._progress:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                pass
            else:
                return iter(tqdm(work, desc="texels", unit="tile", leave=False))
        return iter(work)


def _unit(directions: Any, samples: int) -> tuple[Vector, Vector]:
    """wi and wo. Raises Error unless they are above the surface."""
    try:
        wi, wo = directions
    except (TypeError, ValueError):
        raise Error("directions must be (wi, wo)") from None
    checked = []
    for name, values in (("wi", wi), ("wo", wo)):
        w = as_array(values, name).astype(np.float64)
        if w.shape != (samples, 3):
            raise Error(f"{name} has the shape {w.shape}, and must have {(samples, 3)}, a row for each sample of rho")
        with np.errstate(all="ignore"):
            w /= np.abs(w).max(axis=-1, keepdims=True)
            w /= np.linalg.norm(w, axis=-1, keepdims=True)
        above = np.isfinite(w).all(axis=-1) & (w[:, 2] > 0)
        if not above.all():
            raise Error(f"{name}[{int(above.argmin())}] is no direction above the surface")
        checked.append(np.ascontiguousarray(w))
    return checked[0], checked[1]


def _given(shared: Any) -> int | list[Brdf]:
    """Materials, or how many are to be found."""
    if isinstance(shared, (int, np.integer)):
        given: int | list[Brdf] = int(shared)
        count = int(shared)
    else:
        single = isinstance(shared, (Brdf, str, os.PathLike))
        try:
            given = [model_of(model) for model in ([shared] if single else list(shared))]
        except TypeError:
            raise Error("shared must be models, or how many to find") from None
        count = len(given)
    if not 1 <= count <= fits().MAX_TEXEL_MATERIALS:
        raise Error(f"there are {count} shared materials; give 1 to {fits().MAX_TEXEL_MATERIALS}")
    return given


def _share(shard: Any, count: int) -> range:
    """Numbers of the tiles of a shard."""
    if shard is None:
        return range(count)
    try:
        k, n = (int(part) for part in shard)
    except (TypeError, ValueError, OverflowError):
        k, n = 0, 0
    if not 1 <= k <= n:
        raise Error("shard must be (k, n), k from 1 to n")
    return range(k - 1, count, n)

