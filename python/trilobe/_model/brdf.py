"""Models, evaluated and sampled over arrays, and edited."""

from __future__ import annotations

import json
import os
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trilobe import _core
from trilobe._model.arrays import Floats, check_width, common_shape, of_one_precision, rows
from trilobe._model.error import Error
from trilobe._model.files import printable, text_of_path, write_text
from trilobe._model.model_text import AXIS, POLAR, text_of_model
from trilobe._model.pictures import page, plots
from trilobe._model.table import Table

CHANNELS = ("red", "green", "blue")
# What `convert` writes, by the endings of names.
FORMATS = (
    ".binary", ".bin", ".csv", ".bsdf", ".zemax.bsdf", ".xml", ".xompt", ".mtlx", ".principled.json", ".gltf", ".usda",
    ".glsl", ".hlsl",
)
_ALBEDO_ERROR = 0.03  # error of Brdf.albedo, up to 85 degrees


class Sample(NamedTuple):
    """Directions that were drawn, as ``Brdf.sample`` returns them."""

    wo: Floats
    """Unit vectors (..., 3)."""
    pdf: Floats
    """Density by solid angle [1/sr], (...); 0 where nothing was drawn."""
    weight: Floats
    """f cos(theta_o) / pdf of three channels, (..., 3)."""


class Brdf:
    """A multi-lobe microfacet model of tables, of any form (docs/model.md).

        f = d + sum over lobes of s D(h) F(theta_d) G(wi) G(wo) / (cos theta_i cos theta_o)

    Directions are arrays (..., 3) that broadcast against each other, away from the surface, z
    along its normal, x where the azimuths of an anisotropic material begin. They are made unit
    vectors. Below the surface everything is 0. Where one is no direction, as it is zero, infinite
    or NaN, everything is NaN. Arrays of float32 are computed and returned as such, everything else
    as float64. Arrays of other libraries are taken by DLPack; results are numpy's.

    Immutable, and free for use by any number of threads: Python's lock is released.

    Args:
        d: diffuse term [1/sr], (3,), or one number.
        s: specular weights, (lobes, 3).
        D: distribution of normals: (lobes, 90) over theta_h, or a `Table`.
        F: Fresnel factor: (3, 90) over theta_d, or a `Table`.
        G: shadowing: (lobes, 90) over theta, or a `Table`.
        like: a model whose form (sharing, axes, stretch) plain arrays have, in place of the
            paper's isotropic one.
        stretch: of an isotropic model, (along, across), or one such pair a lobe
            (docs/model.md#stretched-highlights).

    `Table`s bring their axes and sharing along. All entries are finite and 0 or more.
    """

    _material: _core.Material
    _text: str

    def __init__(
        self,
        d: ArrayLike,
        s: ArrayLike,
        D: ArrayLike,
        F: ArrayLike,
        G: ArrayLike,
        *,
        like: Brdf | None = None,
        stretch: Any = None,
    ) -> None:
        """Makes a model of its tables."""
        if like is not None and not isinstance(like, Brdf):
            raise Error("like must be a trilobe.Brdf")
        self._set(text_of_model(d, s, {"D": D, "F": F, "G": G}, like, stretch), "the arrays of the model")

    def _set(self, text: str, source: str) -> None:
        self._material = _core.Material(text.encode("utf-8", "surrogatepass"), source)
        self._text = text

    @classmethod
    def from_json(cls, text: str, source: str = "the text") -> Brdf:
        """The model in the text of a model file (docs/file-formats.md); errors call it `source`."""
        if not isinstance(text, str):
            raise Error("the text of a model file must be a str")
        brdf = cls.__new__(cls)
        brdf._set(text, source)
        return brdf

    def to_json(self) -> str:
        """The text of its model file."""
        return self._text

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a model file, which `load` and the program read; whole, or not at all.

        Warns if a model that was made of arrays, or edited, reflects more light than falls on it.
        """
        for ending in FORMATS:
            if text_of_path(path).lower().endswith(ending):
                raise Error(f"a model file is not of the format {ending}; trilobe.convert(model, path) writes that")
        if not self.fit:
            self._warn_of_light()
        write_text(path, self._text)

    def _warn_of_light(self) -> None:
        albedo = self._albedo_by_degree(85).max(axis=(1, 2))
        if albedo.max() > 1 + _ALBEDO_ERROR:
            warnings.warn(
                f"the model reflects {albedo.max():.3g} times the light that falls on it at theta_i = "
                f"{albedo.argmax()} degrees, and would glow in a renderer",
                stacklevel=3,
            )

    # Evaluation.

    def eval(self, wi: Any, wo: Any, *, components: bool = False) -> Floats:
        """The BRDF f [1/sr], without a cosine.

        Args:
            wi: directions (..., 3).
            wo: directions (..., 3).
            components: return the parts, of which f is the sum.

        Returns:
            (..., 3) red, green, blue; with `components` (..., 1 + lobes, 3), the diffuse term
            first. f is 0 where the sum of the parts is below 0, as splines through G may make it.
        """
        wi, wo, shape = _pair(wi, wo)
        if not components:
            out = np.empty((_count(shape), 3), wi.dtype)
            self._material.eval(wi, wo, out, False)
            return out.reshape(*shape, 3)
        width = 1 + self.lobes
        out = np.empty((_count(shape), width * 3), wi.dtype)
        self._material.eval_components(wi, wo, out)
        return out.reshape(*shape, width, 3)

    @property
    def wavelengths(self) -> NDArray[np.float64]:
        """The wavelengths [nm] of a spectral model, whose colour `eval` and all else is; empty of others."""
        return np.array(self._material.wavelengths)

    def spectrum(self, wi: Any, wo: Any) -> NDArray[np.float64]:
        """The BRDF [1/sr] of a spectral model at its wavelengths, as `trilobe fit --spectral` stores it.

        Args:
            wi: directions (..., 3).
            wo: directions (..., 3).

        Returns:
            (..., wavelengths).

        Raises:
            Error: if the model has no wavelengths.
        """
        wi, wo, shape = _pair(wi, wo)
        width = len(self._material.wavelengths)
        out = np.empty((_count(shape), width))
        self._material.spectrum(wi.astype(np.float64), wo.astype(np.float64), out)
        return out.reshape(*shape, width)

    def eval_cos(self, wi: Any, wo: Any) -> Floats:
        """f cos(theta_o) [1/sr], as renderers ask for it: (..., 3)."""
        wi, wo, shape = _pair(wi, wo)
        out = np.empty((_count(shape), 3), wi.dtype)
        self._material.eval(wi, wo, out, True)
        return out.reshape(*shape, 3)

    def pdf(self, wi: Any, wo: Any) -> Floats:
        """The density [1/sr] with which ``sample(wi, u)`` draws wo: (...)."""
        wi, wo, shape = _pair(wi, wo)
        out = np.empty((_count(shape), 1), wi.dtype)
        self._material.pdf(wi, wo, out)
        return out.reshape(shape)

    def sample(self, wi: Any, u: Any) -> Sample:
        """Draws directions wo for given wi.

        Args:
            wi: directions (..., 3).
            u: two numbers from 0 to below 1 for each, (..., 2). Half vectors are drawn from what
                the lobes reflect at this wi, the diffuse term by a cosine (docs/rendering.md).

        Returns:
            wo (..., 3), pdf [1/sr] (...) and weight = f cos(theta_o) / pdf (..., 3). The latter
            two are 0 where wi is below the surface and, rarely, by rounding at the horizon.

        Raises:
            Error: for numbers that are not in [0, 1).
        """
        wi, u = of_one_precision(wi=wi, u=u)
        check_width(wi, "wi", 3, "directions")
        check_width(u, "u", 2, "pairs of random numbers")
        shape = common_shape(wi, u)
        out: Any = np.empty((_count(shape), 7), wi.dtype)
        self._material.sample(rows(wi, shape), rows(u, shape), out)
        out = out.reshape(*shape, 7)
        return Sample(out[..., :3], out[..., 3], out[..., 4:])

    def albedo(self, wi: Any) -> Floats:
        """The share of the light from wi that is reflected, (..., 3).

        Within 0.5 % at all angles of bundled anisotropic models, and of others 1.5 % up to 75 degrees from the normal
        and 3 % up to 85. The first call of a model takes up to a second.
        """
        (wi,) = of_one_precision(wi=wi)
        check_width(wi, "wi", 3, "directions")
        shape = wi.shape[:-1]
        out: Floats = np.empty((_count(shape), 3), wi.dtype)
        self._material.albedo(_all_rows(wi, shape), out)
        return out.reshape(*shape, 3)

    def _albedo_by_degree(self, last: int) -> Floats:
        """The albedo at theta_i of 0 to so many whole degrees, all around if it is anisotropic, (last + 1, phi, 3)."""
        theta = np.radians(np.arange(last + 1))[:, None]
        phi = np.radians(np.arange(0, 360, 30 if self.anisotropic else 360))
        wi = np.stack(np.broadcast_arrays(np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)), -1)
        return self.albedo(wi)

    # Form and parameters.

    @property
    def lobes(self) -> int:
        """The number of specular lobes."""
        return self._material.lobes

    @property
    def anisotropic(self) -> bool:
        """Whether f changes when the material is turned about its normal."""
        return self._material.anisotropic

    @property
    def stretch(self) -> list[tuple[float, float]]:
        """The exponents (along, across) of each lobe; all 0 without a stretch."""
        return self._material.stretch

    @property
    def d(self) -> Table:
        """The diffuse term [1/sr]: (channel)."""
        return _frozen(Table(self._material.d(), ("channel",), {"channel": np.array(CHANNELS)}))

    @property
    def s(self) -> Table:
        """The specular weights: (lobe, channel)."""
        coords = {"lobe": np.arange(self.lobes), "channel": np.array(CHANNELS)}
        return _frozen(Table(self._material.s(), ("lobe", "channel"), coords))

    @property
    def D(self) -> Table:
        """The distribution of normals: (lobe, theta_h), or of anisotropic models (lobe, theta_h, phi_h)."""
        return self._table("D")

    @property
    def F(self) -> Table:
        """The Fresnel factor: (channel, theta_d)."""
        return self._table("F")

    @property
    def G(self) -> Table:
        """Shadowing: (lobe, theta), or of anisotropic models (lobe, theta, phi)."""
        return self._table("G")

    def unobserved(self, factor: str) -> NDArray[np.bool_]:
        """Marks entries of "D", "F" or "G" that no sample of the fit has touched, in the table's shape."""
        if not isinstance(factor, str) or factor not in AXIS:
            raise Error(f"there is no factor {' '.join(repr(factor).split())[:60]}; there are D, F and G")
        marks: NDArray[np.bool_] = self._material.unobserved(factor).astype(bool)
        return marks.reshape(self._table(factor).shape)

    @property
    def fit(self) -> dict[str, Any]:
        """The origin of the model, as its file says; empty for one that was made of arrays."""
        fit = json.loads(self._text).get("fit", {})
        return fit if isinstance(fit, dict) else {}

    def replace(
        self,
        *,
        d: ArrayLike | None = None,
        s: ArrayLike | None = None,
        D: ArrayLike | None = None,
        F: ArrayLike | None = None,
        G: ArrayLike | None = None,
        stretch: Any = None,
    ) -> Brdf:
        """The same model with some of its parts replaced by arrays of the same shape."""
        return Brdf(
            self.d if d is None else d,
            self.s if s is None else s,
            self.D if D is None else D,
            self.F if F is None else F,
            self.G if G is None else G,
            like=self,
            stretch=stretch,
        )

    def _table(self, name: str) -> Table:
        axis = self._material.axis(name)
        dims: list[str] = []
        shape: list[int] = []
        coords: dict[str, Any] = {}
        if axis["per_lobe"] or self.lobes == 0:
            dims.append("lobe")
            shape.append(self.lobes)
            coords["lobe"] = np.arange(self.lobes)
        if axis["per_channel"]:
            dims.append("channel")
            shape.append(3)
            coords["channel"] = np.array(CHANNELS)
        if axis["rule"] == "polar":
            theta, phi = POLAR[name]
            dims += [theta, phi]
            shape += [len(axis["theta_nodes"]), axis["phi_nodes"]]
            coords[theta] = np.radians(axis["theta_nodes"])
            coords[phi] = 2 * np.pi * np.arange(axis["phi_nodes"]) / axis["phi_nodes"]
        else:
            dims.append(AXIS[name])
            shape.append(axis["size"])
            coords[AXIS[name]] = np.array(axis["theta"])
        values = self._material.tables(name).reshape(shape)
        return _frozen(Table(values, tuple(dims), coords, axis))

    def __eq__(self, other: object) -> bool:
        """Whether the other is a model of the same form and the same numbers."""
        if not isinstance(other, Brdf):
            return NotImplemented
        if self.lobes != other.lobes or self.stretch != other.stretch:
            return False
        if not (np.array_equal(self.d, other.d) and np.array_equal(self.s, other.s)):
            return False
        return all(
            self._material.axis(name) == other._material.axis(name)
            and np.array_equal(self._material.tables(name), other._material.tables(name))
            for name in "DFG"
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """A short description."""
        kind = "anisotropic" if self.anisotropic else "isotropic"
        return f"<trilobe.Brdf: {kind}, {self.lobes} lobes>"

    def _repr_html_(self) -> str:
        """The tables, and the model on a sphere where what draws that is installed, as notebooks show them."""
        plot = plots()
        drawings = {
            "D, F and G": (*plot.size_of_factors(self), lambda figure: plot.factors(self, figure)),
            "the model on a sphere": (3.2, 3.4, lambda figure: plot.spheres(self, None, figure)),
        }
        return page(repr(self)[1:-1], {}, drawings)

    def __reduce__(self) -> Any:
        """Pickles and copies by the text of the model file."""
        return Brdf.from_json, (self._text,)


def load(path: str | os.PathLike[str]) -> Brdf:
    """Reads a model file, the model.json of a folder that `trilobe fit` has written, or "material:NAME".

    The latter are fitted models of measured materials that come with the package; `materials` names them.

    Raises:
        Error: if there is no such file or material, or it is no model.
    """
    name = Path(text_of_path(path))
    if str(path).startswith("material:"):
        return Brdf.from_json(_core.material_text(text_of_path(path)), text_of_path(path))
    try:
        if name.is_dir():
            name = name / "model.json"
        content = name.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise Error(
            f"cannot read {printable(name)}: {reason}", kind="file", file=str(name), key="read", value=reason
        ) from None
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        raise Error(
            f"{printable(name)} is no model file: it is not UTF-8; trilobe.read reads measurements",
            kind="format",
            file=str(name),
        ) from None
    return Brdf.from_json(text, str(name))


def materials() -> list[str]:
    """Names for "material:NAME": fitted models that come with the package (materials/README.md)."""
    return list(_core.material_names())


def model_of(value: Any) -> Brdf:
    """A model, or what its file says."""
    if isinstance(value, Brdf):
        return value
    if isinstance(value, (str, os.PathLike)):
        return load(value)
    raise Error("the model must be a trilobe.Brdf, the path of a model file, or material:NAME")


def _count(shape: tuple[int, ...]) -> int:
    return int(np.prod(shape, dtype=np.int64))


def _pair(wi: Any, wo: Any) -> tuple[Floats, Floats, tuple[int, ...]]:
    wi, wo = of_one_precision(wi=wi, wo=wo)
    check_width(wi, "wi", 3, "directions")
    check_width(wo, "wo", 3, "directions")
    shape = common_shape(wi, wo)
    return rows(wi, shape), rows(wo, shape), shape


def _all_rows(array: Floats, shape: tuple[int, ...]) -> Floats:
    return np.ascontiguousarray(array.reshape(_count(shape), array.shape[-1]))


def _frozen(table: Table) -> Table:
    table.flags.writeable = False
    return table
