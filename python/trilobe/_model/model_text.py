"""Arrays as the text of a model file, which C++ checks and reads."""

from __future__ import annotations

import json
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trilobe._model.arrays import as_array
from trilobe._model.error import Error
from trilobe._model.table import Table

POLAR = {"D": ("theta_h", "phi_h"), "G": ("theta", "phi")}
AXIS = {"D": "theta_h", "F": "theta_d", "G": "theta"}


class Form(Protocol):
    """What plain arrays take from another model."""

    _material: Any

    @property
    def lobes(self) -> int:
        """The number of specular lobes."""
        ...

    @property
    def stretch(self) -> list[tuple[float, float]]:
        """The exponents of each lobe."""
        ...


def text_of_model(
    d: ArrayLike,
    s: ArrayLike,
    tables: dict[str, ArrayLike],
    like: Form | None,
    stretch: Any,
) -> str:
    """The text of the file of a model of these tables, whose form is that of `like` where arrays do not say it.

    Raises:
        Error: for arrays of another shape, or numbers that are not finite and 0 or more.
    """
    weights = as_array(s, "s").astype(np.float64)
    if weights.ndim != 2 or weights.shape[1] != 3:
        raise Error(f"s has the shape {weights.shape}, and must have (lobes, 3)")
    lobes = len(weights)
    diffuse = as_array(d, "d").astype(np.float64)
    if diffuse.shape not in ((), (1,), (3,)):
        raise Error(f"d has the shape {diffuse.shape}, and must have (3,)")
    json_of: dict[str, Any] = {
        "format": "trilobe-model",
        "version": 1,
        "kind": "isotropic",
        "lobes": lobes,
        "sharing": {},
    }
    axes = {name: _axis_of(name, values, like, lobes) for name, values in tables.items()}
    for name, (_, axis) in axes.items():
        json_of["sharing"][name] = {key: axis[key] for key in ("per_lobe", "per_channel")}
    polar = {name: axis for name, (_, axis) in axes.items() if axis["rule"] == "polar"}
    if polar:
        if set(polar) != {"D", "G"}:
            raise Error("of an anisotropic model both D and G are over theta and phi")
        json_of["kind"] = "anisotropic"
        json_of["theta_nodes"] = {name: list(axis["theta_nodes"]) for name, axis in polar.items()}
        json_of["phi_nodes"] = {
            name: [360.0 * k / axis["phi_nodes"] for k in range(axis["phi_nodes"])]
            for name, axis in polar.items()
        }
    pairs = _stretch_of(stretch, like, lobes)
    if pairs is not None:
        json_of["version"] = 2
        json_of["stretch"] = pairs
    numbers = {"d": np.broadcast_to(diffuse, (3,)), "s": weights}
    numbers.update({name: values for name, (values, _) in axes.items()})
    for name, values in numbers.items():
        if not (np.isfinite(values).all() and (values >= 0).all()):
            wrong = np.argwhere(~(np.isfinite(values) & (values >= 0)))[0]
            place = ", ".join(str(k) for k in wrong)
            raise Error(
                f"{name}[{place}] is {values[tuple(wrong)]}; all entries of a model must be finite and >= 0"
            )
        json_of[name] = values.tolist()
    return json.dumps(json_of)


def _axis_of(
    name: str, given: ArrayLike, like: Form | None, lobes: int
) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """The values in the shape that a file has, and the axis."""
    array = as_array(given, name).astype(np.float64)
    if isinstance(given, Table) and given.rules:
        axis = given.rules
    elif isinstance(given, Table) and given.dims:
        axis = _axis_by_names(name, given)
    elif like is not None:
        axis = like._material.axis(name)
    else:
        axis = {
            "rule": "",
            "size": array.shape[-1] if array.ndim > 0 else 0,
            "per_lobe": name != "F",
            "per_channel": name == "F",
        }
    if lobes == 0:  # a file has no tables then
        return np.empty(0), axis
    shape: tuple[int, ...] = (lobes,) if axis["per_lobe"] else ()
    if axis["per_channel"]:
        shape += (3,)
    if axis["rule"] == "polar":
        shape += (len(axis["theta_nodes"]), axis["phi_nodes"])
    else:
        shape += (axis["size"],)
    if array.shape != shape:
        raise Error(f"{name} has the shape {array.shape}, and must have {shape}")
    return array, axis


def _axis_by_names(name: str, table: Table) -> dict[str, Any]:
    """The axis of a table that somebody else made, by the names of its axes."""
    *shared, last = table.dims
    axis: dict[str, Any] = {"rule": "", "size": table.shape[-1]}
    if name in POLAR and tuple(table.dims[-2:]) == POLAR[name]:
        *shared, theta, _ = table.dims
        if theta not in table.coords:
            raise Error(f"{name} needs coords[{theta!r}], where its rows stand in radians")
        axis["rule"] = "polar"
        # Rounds to numbers that people write, such as 15 degrees.
        axis["theta_nodes"] = np.degrees(as_array(table.coords[theta], theta)).round(12).tolist()
        axis["phi_nodes"] = table.shape[-1]
    elif last != AXIS[name]:
        raise Error(f"{name} has the axes {table.dims}, and the last must be {AXIS[name]!r}")
    if shared not in (["lobe"], ["channel"], ["lobe", "channel"], []):
        raise Error(f"{name} has the axes {table.dims}; begin with 'lobe', 'channel', or both")
    axis["per_lobe"], axis["per_channel"] = "lobe" in shared, "channel" in shared
    return axis


def _stretch_of(stretch: Any, like: Form | None, lobes: int) -> Any:
    if stretch is None:
        pairs = like.stretch if like is not None and like.lobes == lobes else []
        if not any(x != 0 for pair in pairs for x in pair):
            return None
        stretch = pairs if len(set(pairs)) > 1 else pairs[0]
    array = as_array(stretch, "stretch").astype(np.float64)
    if array.shape not in ((2,), (lobes, 2)):
        raise Error(f"stretch has the shape {array.shape}, and must have (2,) or ({lobes}, 2)")
    if not np.isfinite(array).all():
        raise Error("stretch must be finite")
    named = [{"along": along, "across": across} for along, across in array.reshape(-1, 2).tolist()]
    if not array.any():
        return None
    return named[0] if array.ndim == 1 else named
