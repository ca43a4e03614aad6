"""Measurements: read from any file, or made of arrays."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trilobe._fitting.extension import fits
from trilobe._model.arrays import as_array
from trilobe._model.brdf import CHANNELS, FORMATS, Brdf, load
from trilobe._model.error import Error, in_keywords
from trilobe._model.files import printable, text_of_path


class Measurement:
    """Measured values of a material: a table on a grid of half-vector angles, or scattered samples.

    Args:
        wi: directions towards the light (n, 3), away from the surface, z along its normal; any length.
        wo: directions towards the detector (n, 3).
        rho: BRDF values [1/sr] without a cosine, (n, 3), or (n,) or (n, 1) of all channels.
        anisotropic: whether azimuths matter, so that turning the sample changes what is measured. By default
            they do where light comes from several azimuths; say False of an isotropic material that was
            measured from anywhere.
        source: what reports call it.
        max_angle: theta_i and theta_o beyond it are left out [degrees].
        min_theta_d: half angles between wi and wo below it are left out [degrees]; -1 as far as the detector
            shows that it stood in its own light.

    Samples that are below the surface, negative or not finite are left out, and counted (`counts`).
    Immutable. What follows from it is computed when it is first asked for.
    """

    def __init__(
        self,
        wi: ArrayLike,
        wo: ArrayLike,
        rho: ArrayLike,
        *,
        anisotropic: bool | None = None,
        source: str = "arrays",
        max_angle: float = 90,
        min_theta_d: float = -1,
    ) -> None:
        """Makes a measurement of arrays."""
        arrays = {}
        for name, values in (("wi", wi), ("wo", wo), ("rho", rho)):
            array = as_array(values, name).astype(np.float64)
            if name == "rho" and (array.ndim == 1 or (array.ndim == 2 and array.shape[1] == 1)):
                array = np.repeat(array.reshape(-1, 1), 3, axis=1)
            if array.ndim != 2 or array.shape[1] != 3:
                raise Error(f"{name} has the shape {array.shape}, and must have (n, 3)")
            arrays[name] = np.ascontiguousarray(array)
        lengths = {name: len(array) for name, array in arrays.items()}
        if len(set(lengths.values())) > 1:
            raise Error(f"wi, wo and rho have {', '.join(map(str, lengths.values()))} rows, and must have the same")
        if anisotropic is not None and not isinstance(anisotropic, (bool, np.bool_)):
            raise Error("anisotropic must be True, False or None")
        azimuths = "auto" if anisotropic is None else "yes" if anisotropic else "no"
        options = source_options(max_angle=max_angle, min_theta_d=min_theta_d)
        made = (*arrays.values(), _name(source), azimuths, options)
        self._set(fits().from_arrays(*made), (_of_arrays, made))

    def _set(self, data: Any, made: tuple[Callable[..., Measurement], tuple[Any, ...]]) -> None:
        """`made` is how to make it again."""
        self._data = data
        self._made = made
        self._cache: dict[str, NDArray[Any]] = {}

    @classmethod
    def _of(cls, data: Any, made: tuple[Callable[..., Measurement], tuple[Any, ...]]) -> Measurement:
        measurement = cls.__new__(cls)
        measurement._set(data, made)
        return measurement

    def __reduce__(self) -> Any:
        """Arrays are pickled; of a file its path, which is read again, and an Error if it has changed since."""
        return self._made

    def __copy__(self) -> Measurement:
        """Itself, as it never changes."""
        return self

    def __deepcopy__(self, memo: Any) -> Measurement:
        """Itself, as it never changes."""
        return self

    def save(self, path: str | os.PathLike[str]) -> list[str]:
        """Writes it as `convert` does, for `read`: ".binary", ".bin" or ".csv". Returns the program's lines."""
        return convert(self, path)

    def to_xarray(self) -> Any:
        """An ``xarray.Dataset`` of rho [1/sr] and reason, if xarray is installed.

        Of a table the dimensions are theta_h, theta_d, phi_d and channel, with angles in radians; of samples they are
        sample and channel, and theta_i, phi_i, theta_o and phi_o are coordinates of the samples.
        """
        import xarray

        channels = ("channel", np.array(CHANNELS))
        told = {"reasons": self.reasons}
        if self.grid is None:
            angles = {name: ("sample", values) for name, values in self._angles().items()}
            return xarray.Dataset(
                {"rho": (("sample", "channel"), self.rho), "reason": ("sample", self.reason, told)},
                coords={**angles, "channel": channels},
                attrs={"source": self.source},
            )
        theta_h, theta_d = (angle.reshape(self.grid) for angle in half_angles(self.wi, self.wo))
        phi_d = (np.arange(self.grid[2]) + 0.5) * np.pi / self.grid[2]
        dims = ("theta_h", "theta_d", "phi_d")
        return xarray.Dataset(
            {
                "rho": ((*dims, "channel"), self.rho.reshape(*self.grid, 3)),
                "reason": (dims, self.reason.reshape(self.grid), told),
            },
            coords={"theta_h": theta_h[:, 0, 0], "theta_d": theta_d[0, :, 0], "phi_d": phi_d, "channel": channels},
            attrs={"source": self.source},
        )

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with a row for each of them, if pandas is installed.

        Columns are theta_i, phi_i, theta_o and phi_o [rad], red, green and blue [1/sr], and reason, in words.
        """
        import pandas

        colours = dict(zip(CHANNELS, self.rho.T))
        reason = pandas.Categorical.from_codes(self.reason.astype(np.int64), pandas.Index(self.reasons))
        return pandas.DataFrame({**self._angles(), **colours, "reason": reason})

    def _angles(self) -> dict[str, NDArray[np.float64]]:
        """Angles of all samples by name [rad]."""
        angles: dict[str, NDArray[np.float64]] = {}
        for end, w in (("i", self.wi), ("o", self.wo)):
            angles[f"theta_{end}"] = np.arctan2(np.hypot(w[:, 0], w[:, 1]), w[:, 2])
            angles[f"phi_{end}"] = np.arctan2(w[:, 1], w[:, 0])
        return angles

    @property
    def source(self) -> str:
        """The file, or the name of what it was made from."""
        return str(self._data.source)

    @property
    def kind(self) -> str:
        """The kind of measurement, such as "MERL measurement"."""
        return str(self._data.kind)

    @property
    def anisotropic(self) -> bool:
        """Whether azimuths matter."""
        return bool(self._data.anisotropic)

    @property
    def grid(self) -> tuple[int, int, int] | None:
        """The numbers of bins of theta_h, theta_d and phi_d that a table has; None for scattered samples."""
        return tuple(self._data.grid) or None

    @property
    def notes(self) -> list[str]:
        """Anomalies of the data, a sentence each."""
        return [in_keywords(note) for note in self._data.notes]

    @property
    def max_angle(self) -> float:
        """No theta_i or theta_o of a valid sample is beyond this [degrees]."""
        return float(self._data.max_angle)

    @property
    def counts(self) -> dict[str, int]:
        """The numbers of all samples, of valid ones, and of others by reason."""
        counts: dict[str, int] = json.loads(self._data.counts_json)
        return counts

    @property
    def wi(self) -> NDArray[np.float64]:
        """Directions towards the light, (n, 3), of each bin of a table or of each valid sample.

        Bins come theta_h first and phi_d fastest, and stand for their centres, half vectors leaning towards x.
        """
        return self._cached("wi", lambda: self._data.directions(True))

    @property
    def wo(self) -> NDArray[np.float64]:
        """Directions towards the detector, (n, 3)."""
        return self._cached("wo", lambda: self._data.directions(False))

    @property
    def rho(self) -> NDArray[np.float64]:
        """The BRDF [1/sr], (n, 3), as it is stored, whether valid or not."""
        return self._cached("rho", self._data.values)

    @property
    def reason(self) -> NDArray[np.uint8]:
        """Why each is left out, (n,): a number in `Measurement.reasons`; 0 is valid."""
        return self._cached("reason", self._data.reasons)

    @property
    def reasons(self) -> list[str]:
        """Names of the numbers in `reason`."""
        names: list[str] = fits().reasons()
        return names

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Whether a fit sees a sample, (n,)."""
        return self._cached("valid", lambda: np.asarray(self.reason == 0))

    def _cached(self, name: str, make: Callable[[], NDArray[Any]]) -> NDArray[Any]:
        if name not in self._cache:
            array = make()
            array.flags.writeable = False
            self._cache[name] = array
        return self._cache[name]

    def __repr__(self) -> str:
        """A short description."""
        counts = self.counts
        return f"<trilobe.Measurement {self.source}: {self.kind}, {counts['valid']} of {counts['total']} valid>"


def half_angles(wi: NDArray[np.float64], wo: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """theta_h and theta_d of directions (n, 3) of length 1 [rad]."""
    half = wi + wo
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    theta_h = np.arctan2(np.hypot(half[:, 0], half[:, 1]), half[:, 2])
    return theta_h, np.arccos(np.clip((wi * half).sum(axis=-1), -1, 1))


def read(
    source: str | os.PathLike[str],
    *,
    noise: float = 0,
    missing: float = 0,
    corrupt: str = "",
    cosine: float | str = 0,
    scale: float = 0,
    azimuth: str = "from_light",
    tilt: float | str = 0,
    seed: int = 1,
    max_angle: float = 90,
    min_theta_d: float = -1,
    extrapolated: bool = False,
    outliers: bool = False,
    dark_noise: bool = False,
    radiometry: str = "brdf",
    columns: str = "",
    rows: str = "",
    theta_i: float = -1,
    theta_o: float = -1,
    bands: float | str | Sequence[float] = "",
    threads: int = 0,
) -> Measurement:
    """Reads a measurement of any format (docs/file-formats.md), or makes a synthetic one, "synth:NAME".

    Args:
        source: the file; its content tells the format.
        noise: relative noise of a synthetic material, 0 to 1.
        missing: the share of the samples that is left out at random.
        corrupt: what is done to it, "KIND:STRENGTH,..." (docs/your-data.md).
        cosine: takes cos theta_i to this power out of it; of cos theta_o as "o:1".
        scale: a factor of all values, as 0.01 for percents; 1 says that a reflectance is f in 1/sr. 0: none given.
        azimuth: "from_mirror" where phi_o of scattered samples is counted from the mirror direction.
        tilt: takes out by how much the sample leant towards azimuth 0 [degrees]; "auto" as the highlight of
            a table shows.
        seed: seed of all random numbers.
        max_angle: theta_i and theta_o beyond it are left out [degrees].
        min_theta_d: theta_d below it is left out [degrees]; -1 as far as scattered samples show that the
            detector stood in its own light.
        extrapolated: of an RGL file, takes what its authors extrapolated, too.
        outliers: takes samples that are far off those around them, too.
        dark_noise: takes readings that are lost in dark noise as they are, not medians around them.
        radiometry: quantity that a UTIA file stores: "brdf", "cosine", "srgb" or "dj_brdf".
        columns: the names of the columns of a text table, "theta_i,theta_o,f", in the place of its header, or
            "theta_i=Angle,f=Value" by the names there.
        rows: the rows of a text table with these cells alone, "polarization=s,sample=2".
        theta_i: angle of incidence of a text table without a column of it [degrees]; -1 for none.
        theta_o: the same of the detector.
        bands: wavelengths of spectra to read [nm]: one for all channels, three as r, g and b, the longest as r, or
            more to make a colour of; by default all make a colour.
        threads: 0 for all cores.

    Raises:
        Error: with the program's line.
    """
    options = source_options(
        noise=noise,
        missing=missing,
        corrupt=corrupt,
        cosine=cosine,
        scale=scale,
        azimuth=azimuth,
        tilt=tilt,
        data_seed=seed,
        max_angle=max_angle,
        min_theta_d=min_theta_d,
        extrapolated=extrapolated,
        outliers=outliers,
        dark_noise=dark_noise,
        radiometry=radiometry,
        columns=columns,
        rows=rows,
        theta_i=theta_i,
        theta_o=theta_o,
        bands=_text_of_bands(bands),
        threads=threads,
    )
    name = text_of_path(source)
    again = os.path.abspath(name) if os.path.exists(name) else name
    data = fits().read(name, options)
    return Measurement._of(data, (_read_again, (again, options, data.xxh128)))


def _read_again(path: str, options: dict[str, Any], xxh128: str) -> Measurement:
    """Unpickles a measurement that was read from a file."""
    data = fits().read(path, options)
    if data.xxh128 != xxh128:
        raise Error(f"{path} has changed since the measurement was pickled; read it again")
    return Measurement._of(data, (_read_again, (path, options, xxh128)))


def _of_arrays(*made: Any) -> Measurement:
    """Unpickles a measurement that was made of arrays."""
    return Measurement._of(fits().from_arrays(*made), (_of_arrays, made))


def measurement_of(value: Any) -> Measurement:
    """A measurement, or what its file says."""
    return value if isinstance(value, Measurement) else read(value)


def convert(
    what: Brdf | Measurement | str | os.PathLike[str],
    path: str | os.PathLike[str],
    *,
    error: float = 0,
    spectral: bool = False,
    threads: int = 0,
) -> list[str]:
    """Writes a model or a measurement in another format, which the ending of the path says.

    ".binary" is MERL's layout, ".bin" UTIA's, ".csv" samples. ".bsdf" is an RGL tensor file for renderers as
    Mitsuba's `measured`, ".zemax.bsdf" a table for OpticStudio, ".xml" Klems matrices for Radiance and WINDOW, ".xompt"
    an isotropic table for OpenMATERIAL 3D, ".mtlx", ".principled.json", ".gltf" and ".usda" the nearest material of
    MaterialX, Blender, glTF and USD's preview; for a measurement a model is fitted for that, which takes seconds.
    ".glsl" and ".hlsl" are shaders, of models alone.

    Args:
        what: a model or a measurement, or the file of one, "material:NAME" or "synth:NAME".
        path: the file to write.
        error: of a ".bsdf" or ".zemax.bsdf" file, by how much it may be off in the median, 0 to 1; 0 for 0.005, of an
            anisotropic model 0.02, and of a measurement as near as files of usual size come.
        spectral: of a ".bsdf" file, spectra in place of RGB.
        threads: 0 for all cores.

    Returns:
        The program's lines that say what was written, and how far off it is.
    """
    if not isinstance(what, (Brdf, Measurement)):
        name = text_of_path(what)
        what = load(name) if is_model(name) else read(name)
    options = {"error": error, "spectral": spectral, "threads": threads}
    written = text_of_path(path)
    _check_ending(written, isinstance(what, Brdf))
    if isinstance(what, Brdf):
        return list(fits().convert_model(what.to_json().encode(), written, options))
    return list(fits().convert_measurement(what._data, written, options))


def _check_ending(path: str, of_model: bool) -> None:
    """Raises Error, which names all formats, for an ending that `convert` does not know."""
    ending = os.path.splitext(path)[1].lower()
    if not ending or path.lower().endswith(FORMATS):
        return
    others = [known for known in FORMATS if of_model or known not in (".glsl", ".hlsl")]
    model_file = "; model.save(path) writes a model file" if of_model and ending == ".json" else ""
    raise Error(
        f"{printable(path)}: trilobe.convert writes no {ending!r}; end the name in {', '.join(others[:-1])} or "
        f"{others[-1]}{model_file}", kind="unsupported", file=path, key="ending", value=ending)


def is_model(name: str) -> bool:
    """Whether a path is that of a model, by its name."""
    return name.endswith(".json") or name.startswith("material:") or os.path.isdir(name)


def completed(measurement: Measurement, model: Brdf, threads: int = 0) -> Any:
    """A measurement as a function of all directions, f = (m + e) q - e, by help of a model m fitted to it.

    `shape` has the numbers of bins over (theta_h, theta_d, phi_d) or of nodes over (theta_i, phi_i, theta_o, phi_o)
    at which q is known, and none where the samples stand at no grid, and f is the model; `ratios()` is q there, (n, 3),
    `offset` e [1/sr], and `eval(wi, wo)` f [1/sr], of unit vectors (n, 3).
    """
    return fits().Completed(model.to_json().encode(), measurement._data, {"threads": threads})


def _text_of_bands(bands: Any) -> str:
    if isinstance(bands, str):
        return bands
    try:
        return ",".join(repr(float(band)) for band in np.ravel(bands))
    except (TypeError, ValueError):
        raise Error("bands must be a wavelength [nm], or a list of some") from None


def source_options(**given: Any) -> dict[str, Any]:
    """Options of a source, by the names of their flags; those that are not given have the flags' defaults."""
    return {"threads": 0, **given}


def _name(source: Any) -> str:
    if not isinstance(source, str):
        raise Error("source must be a str")
    return source.encode("utf-8", "replace").decode("utf-8")
