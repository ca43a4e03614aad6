"""Which directions to measure of a material, and which next: the program's, to the bit."""

from __future__ import annotations

import os
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trilobe._fitting.extension import fits
from trilobe._fitting.measurement import Measurement, measurement_of
from trilobe._fitting.running import run
from trilobe._model.arrays import as_array
from trilobe._model.error import Error


class Directions:
    """Pairs of directions of light and detector, in the order in which to measure them.

    ``brdf.eval(at.wi, at.wo)`` and ``trilobe.Measurement(at.wi, at.wo, rho)`` take them. ``at[:20]`` are the first
    ones, as Directions. Immutable.

    Args:
        angles: theta_i, phi_i, theta_o and phi_o [degrees], (n, 4).
    """

    def __init__(self, angles: ArrayLike) -> None:
        """Makes them of their angles."""
        array = as_array(angles, "angles").astype(np.float64)
        if array.ndim != 2 or array.shape[1] != 4:
            raise Error(f"angles have the shape {array.shape}, and must have (n, 4)", kind="mismatch", key="angles")
        if not np.isfinite(array).all():
            raise Error("angles must be finite", kind="data", key="angles")
        array.flags.writeable = False
        self._angles = array

    @property
    def angles(self) -> NDArray[np.float64]:
        """theta_i, phi_i, theta_o and phi_o [degrees], (n, 4): the columns of `trilobe measure`."""
        return self._angles

    @property
    def wi(self) -> NDArray[np.float64]:
        """Unit vectors towards the light, (n, 3)."""
        return _vectors(self._angles[:, :2])

    @property
    def wo(self) -> NDArray[np.float64]:
        """Unit vectors towards the detector, (n, 3)."""
        return _vectors(self._angles[:, 2:])

    def __len__(self) -> int:
        """The number of pairs."""
        return len(self._angles)

    def __getitem__(self, rows: Any) -> Directions:
        """Some of them: by a slice, a mask, or numbers."""
        return Directions(np.atleast_2d(self._angles[rows, :]))

    def __repr__(self) -> str:
        """How many there are."""
        return f"<trilobe.Directions: {len(self)} pairs>"


def _vectors(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    theta, phi = np.radians(angles).T
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


class NextDirections(NamedTuple):
    """What `next_directions` returns."""

    directions: Directions
    """Those to measure next."""
    measured: int
    """How many samples were fitted."""
    delta_e: float | None
    """About how far off a fit to these is, over all directions: a guess. None for fewer than 32 samples."""
    expected_delta_e: float | None
    """The same after `directions` were measured as well."""


def directions_to_measure(
    directions: int = 50,
    *,
    theta_max: float = 80,
    in_plane: bool = False,
    incidences: ArrayLike = (),
    step: float = 0,
    blind: float = 0,
) -> Directions:
    """Directions to measure of an isotropic material that is not known, as `trilobe measure` says (docs/measure.md).

    The first ones of more are those of fewer, and each beginning is spread as evenly. All angles are in degrees.

    Args:
        directions: how many pairs, 1 to 100000.
        theta_max: the largest angle of light and detector from the normal.
        in_plane: whether the detector stays in the plane of incidence.
        incidences: the angles that the light has; by default any.
        step: all angles but given incidences are multiples of this; 0 for any angle.
        blind: within this angle of the light the detector hides it.

    Raises:
        Error: for a number that is out of range, or if the device does not reach so many.
    """
    device = _device(theta_max, in_plane, incidences, step, blind)
    return Directions(fits().directions_to_measure({"directions": directions, **device}))


def next_directions(
    measured: Measurement | str | os.PathLike[str],
    next: int = 10,
    *,
    by: Literal["plan", "design", "both"] = "plan",
    theta_max: float = 80,
    in_plane: bool = False,
    incidences: ArrayLike = (),
    step: float = 0,
    blind: float = 0,
    threads: int = 0,
    progress: bool = True,
) -> NextDirections:
    """Which directions to measure next, by a fit to what was measured so far, as `trilobe measure FILE --next=10` says.

    None is among those that are measured. Ctrl-C ends it. Other Python threads run.

    Args:
        measured: scattered samples of an isotropic material, 10 or more: a `Measurement`, or what `read` takes.
        next: how many pairs, 1 to 1000.
        by: "plan" goes on with `directions_to_measure`; "design" takes those that tell most of what is seen, given the
            fit and all before; "both" takes turns.
        theta_max: as of `directions_to_measure`, like all that follow of the device.
        in_plane: whether the detector stays in the plane of incidence.
        incidences: the angles that the light has.
        step: all angles but given incidences are multiples of this.
        blind: within this angle of the light the detector hides it.
        threads: 0 for all cores. The result does not depend on it.
        progress: shows a bar, where tqdm is installed.

    Raises:
        Error: for a table, for samples whose azimuths matter, for fewer than 10, and as `directions_to_measure` and
            `fit`.
        KeyboardInterrupt: when it is interrupted.
    """
    options = {"next": next, "by": by, "threads": threads, **_device(theta_max, in_plane, incidences, step, blind)}
    data = measurement_of(measured)
    found = run(lambda running, _: fits().next_directions(data._data, options, running), data.source,
                progress=progress)
    if found is None:
        raise KeyboardInterrupt
    angles, *told = found
    return NextDirections(Directions(angles), *told)


def _device(theta_max: Any, in_plane: Any, incidences: Any, step: Any, blind: Any) -> dict[str, Any]:
    """The device, as C++ takes it."""
    angles = as_array(incidences, "incidences").astype(np.float64)
    return {
        "theta_max": theta_max,
        "in_plane": in_plane,
        "incidences": angles.ravel().tolist(),
        "step": step,
        "blind": blind,
    }
