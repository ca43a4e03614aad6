"""Pictures of models and fits by matplotlib, which must be installed.

Each function draws into `figure`, or a new one, and returns it; none of them shows it.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from trilobe._fitting.directions import Directions
from trilobe._fitting.extension import fits
from trilobe._fitting.measurement import Measurement, half_angles, measurement_of
from trilobe._fitting.result import Result
from trilobe._fitting.uncertainty import Uncertainty
from trilobe._model.brdf import CHANNELS, Brdf, model_of
from trilobe._model.error import Error

_COLORS = ("#c03028", "#2a8a3a", "#2b55b8")


def _figure(figure: Any, size: tuple[float, float]) -> Any:
    try:
        from matplotlib import figure as figures
        from matplotlib import pyplot
    except ImportError:
        raise Error("pictures need matplotlib: pip install matplotlib") from None
    if figure is None:
        return pyplot.figure(figsize=size, layout="constrained")
    if not isinstance(figure, figures.FigureBase):
        raise Error("figure must be a figure of matplotlib")
    return figure


def size_of_factors(brdf: Brdf) -> tuple[float, float]:
    """Width and height of `factors` [inches]."""
    return (11, 3.4) if not brdf.anisotropic else (11, 2.4 * max(brdf.lobes, 1))


def factors(
    model: Brdf | str | os.PathLike[str], figure: Any = None, *, uncertainty: Uncertainty | None = None
) -> Any:
    """D, F and G of a model over their angles; entries that no data touched are dotted.

    Of an anisotropic model D and G are maps, the angle from the normal upwards and the azimuth to the right.
    `uncertainty`, as `Result.uncertainty()` returns it, is drawn as bands of two standard deviations to each side.
    """
    brdf = model_of(model)
    if uncertainty is not None and not isinstance(uncertainty, Uncertainty):
        raise Error("uncertainty must be what Result.uncertainty() returns")
    if uncertainty is not None and brdf.anisotropic:
        raise Error("bands are drawn of isotropic models alone")
    figure = _figure(figure, size_of_factors(brdf))
    if brdf.anisotropic and brdf.lobes > 0:
        return _polar_factors(brdf, figure)
    for axes, name in zip(figure.subplots(1, 3), "DFG"):
        table, unobserved = getattr(brdf, name), brdf.unobserved(name)
        if uncertainty is not None and getattr(uncertainty, name).shape != table.shape:
            raise Error("the uncertainty is of another model")
        deviations = None if uncertainty is None else getattr(uncertainty, name).reshape(-1, table.shape[-1])
        angles = np.degrees(table.coords[table.dims[-1]])
        rows = np.asarray(table).reshape(-1, table.shape[-1])
        hidden = unobserved.reshape(rows.shape)
        for k, (row, without) in enumerate(zip(rows, hidden)):
            lobe, channel = _of_row(table, k)
            style = {"color": _COLORS[channel] if channel is not None else f"C{lobe}"}
            of_lobe = "" if lobe is None else f"lobe {lobe + 1} "
            label = of_lobe + ("" if channel is None else CHANNELS[channel])
            axes.plot(angles, row, ":", lw=1, **style)
            axes.plot(angles, np.where(without, np.nan, row), lw=1.6, label=label, **style)
            if deviations is not None:
                wide = np.where(np.isfinite(deviations[k]), 2 * deviations[k], np.nan)
                axes.fill_between(angles, np.maximum(row - wide, 0), row + wide, alpha=0.2, lw=0, **style)
        axes.set_title(name)
        axes.set_xlabel({"D": "θh [°]", "F": "θd [°]", "G": "θ [°]"}[name])
        if name == "D" and brdf.lobes > 0:
            axes.set_yscale("symlog", linthresh=1e-2)
        if brdf.lobes > 0:
            axes.legend(fontsize=7)
    return figure


def _of_row(table: Any, k: int) -> tuple[int | None, int | None]:
    """The lobe and the channel of the k-th row of a table."""
    channels = 3 if "channel" in table.dims else 1
    lobe = k // channels if "lobe" in table.dims else None
    return lobe, k % channels if channels == 3 else None


def _polar_factors(brdf: Brdf, figure: Any) -> Any:
    grid = figure.subplots(brdf.lobes, 3, squeeze=False)
    for name, column in (("D", 0), ("G", 2)):
        table = getattr(brdf, name)
        maps = np.asarray(table).reshape(-1, *table.shape[-2:])
        theta, phi = (np.degrees(table.coords[dim]) for dim in table.dims[-2:])
        for lobe in range(brdf.lobes):
            axes = grid[lobe, column]
            picture = axes.pcolormesh(phi, theta, maps[lobe * len(maps) // brdf.lobes], shading="nearest")
            axes.set_title(f"{name}, lobe {lobe + 1}", fontsize=9)
            axes.set_xlabel("φ [°]")
            axes.set_ylabel("θ [°]")
            figure.colorbar(picture, ax=axes)
    F = brdf.F
    rows = np.asarray(F).reshape(-1, 3, F.shape[-1])
    for lobe in range(brdf.lobes):
        for row, color in zip(rows[lobe % len(rows)], _COLORS):
            grid[lobe, 1].plot(np.degrees(F.coords["theta_d"]), row, color=color)
        grid[lobe, 1].set_title("F" if len(rows) == 1 else f"F, lobe {lobe + 1}", fontsize=9)
        grid[lobe, 1].set_xlabel("θd [°]")
    return figure


def slices(model: Brdf | str | os.PathLike[str], measurement: Measurement | None = None, figure: Any = None) -> Any:
    """The BRDF in the plane of incidence over theta_o, for several theta_i; the light's side is below 0.

    Measured values are points: of a table those of the nearest bins, of scattered samples those within three
    degrees.
    """
    brdf = model_of(model)
    figure = _figure(figure, (11, 3.4))
    theta = np.radians(np.linspace(-89, 89, 357))
    wo = np.stack([np.sin(theta), np.zeros_like(theta), np.cos(theta)], axis=-1)
    grid = figure.subplots(1, 3, sharex=True)
    for k, degrees in enumerate((0, 30, 60)):
        at = np.radians(degrees)
        wi = np.array([-np.sin(at), 0, np.cos(at)])
        f = brdf.eval(wi, wo)
        for c, axes in enumerate(grid):
            axes.plot(np.degrees(theta), f[:, c], color=f"C{k}", label=f"θi = {degrees}°")
            axes.set_title(CHANNELS[c])
            axes.set_xlabel("θo [°]")
            axes.set_yscale("log")
        if measurement is not None:
            angles, values = _in_plane(measurement_of(measurement), at)
            for c, axes in enumerate(grid):
                axes.plot(np.degrees(angles), values[:, c], ".", ms=3, color=f"C{k}", alpha=0.5)
    grid[0].set_ylabel("f [1/sr]")
    grid[0].legend(fontsize=7)
    return figure


def _in_plane(measurement: Measurement, theta_i: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Signed theta_o and values of what was measured within some degrees of the plane of incidence."""
    valid = measurement.valid
    wi, wo, rho = measurement.wi[valid], measurement.wo[valid], measurement.rho[valid]
    width = np.radians(1.0 if measurement.grid else 3.0)
    near = np.abs(np.arccos(np.clip(wi[:, 2], -1, 1)) - theta_i) < width
    wi, wo, rho = wi[near], wo[near], rho[near]
    theta_o = np.arccos(np.clip(wo[:, 2], -1, 1))
    turn = np.arctan2(wo[:, 1], wo[:, 0]) - np.arctan2(wi[:, 1], wi[:, 0])
    if theta_i < width:
        turn = np.zeros_like(turn)  # there is no plane of incidence
    across = np.abs(np.sin(turn)) * np.sin(theta_o) < np.sin(width)
    signed = np.where(np.cos(turn) > 0, -theta_o, theta_o)
    if theta_i < width:
        signed = theta_o
    return signed[across], rho[across]


def _srgb(linear: NDArray[Any]) -> NDArray[Any]:
    x = np.clip(linear, 0, 1)
    encoded: NDArray[Any] = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return encoded


def spheres(
    model: Brdf | str | os.PathLike[str],
    measurement: Measurement | None = None,
    figure: Any = None,
    *,
    size: int = 192,
    threads: int = 0,
) -> Any:
    """The model on a sphere under the program's sky, sun and lamps; beside its measurement where that is given.

    Beside a measurement, directions that were not measured are left out of both.
    """
    brdf = model_of(model)
    module, text, options = fits(), brdf.to_json().encode(), {"size": size, "threads": threads}
    if measurement is None:
        image = module.render(text, options)
        bright = np.quantile(image[image.sum(axis=-1) > 0], 0.98) if (image > 0).any() else 1
        images = [("model", image / bright)]
    else:
        measured, fitted, exposure = module.render_pair(text, measurement_of(measurement)._data, options)
        images = [("measured", measured * exposure), ("fitted", fitted * exposure)]
    figure = _figure(figure, (3.2 * len(images), 3.4))
    for axes, (title, image) in zip(figure.subplots(1, len(images), squeeze=False)[0], images):
        axes.imshow(_srgb(image))
        axes.set_title(title)
        axes.set_axis_off()
    return figure


def trace(results: Result | Mapping[str, Result], figure: Any = None) -> Any:
    """E over iterations and over seconds, of a fit, or of several by their names."""
    if isinstance(results, Result):
        results = {results.report["solver"]: results}
    if not isinstance(results, Mapping) or not all(isinstance(result, Result) for result in results.values()):
        raise Error("trace takes a trilobe.Result, or a dict of them by their names")
    figure = _figure(figure, (9, 3.4))
    for axes, column, label in zip(figure.subplots(1, 2, sharey=True), ("iteration", "seconds"), ("iteration", "s")):
        for name, result in results.items():
            axes.plot(result.trace[column], result.trace["objective"], ".-", label=name)
        axes.set_xlabel(label)
        axes.set_yscale("log")
    figure.axes[0].set_ylabel("E")
    figure.axes[0].legend(fontsize=7)
    return figure


def directions(
    next: Directions | Measurement, measured: Directions | Measurement | None = None, figure: Any = None
) -> Any:
    """Pairs of directions, filled and numbered in their order; what is measured already is hollow.

    At the left where the detector stands, seen from above: theta_o outwards from the normal, phi_o - phi_i around it,
    the light's side at the left; sides that mirror each other are one. At the right theta_h over theta_d, of which
    highlights are the lowest rows. Colours are theta_i.
    """
    shown = [(_valid_pairs(next, "next"), True)]
    if measured is not None:
        shown.insert(0, (_valid_pairs(measured, "measured"), False))
    figure = _figure(figure, (10, 3.9))
    above, beside = figure.subplots(1, 2, width_ratios=(1.6, 1))
    colors = _theta_i_colors()
    for (wi, wo), is_next in shown:
        theta_i, theta_o = (np.degrees(np.arctan2(np.hypot(w[:, 0], w[:, 1]), w[:, 2])) for w in (wi, wo))
        phi = np.arctan2(wo[:, 1], wo[:, 0]) - np.arctan2(wi[:, 1], wi[:, 0])
        theta_h, theta_d = (np.degrees(angle) for angle in half_angles(wi, wo))
        by_theta_i = colors.to_rgba(theta_i)
        _mark(above, -theta_o * np.cos(phi), theta_o * np.abs(np.sin(phi)), by_theta_i, is_next)
        _mark(beside, theta_d, theta_h, by_theta_i, is_next)
    ticks = [0, 30, 60, 90]
    _draw_sky(above, ticks)
    beside.axhspan(0, 10, color="0.92", lw=0, zorder=0)
    beside.text(89, 5, "highlight", ha="right", va="center", fontsize=8, color="0.4")
    beside.set(xlim=(0, 90), ylim=(0, 90), aspect="equal", title="half and difference angles", xlabel="θd [°]",
               ylabel="θh [°]", xticks=ticks, yticks=ticks)
    figure.colorbar(colors, ax=beside, label="θi [°]", ticks=ticks, shrink=0.8)
    return figure


def _draw_sky(axes: Any, rings: list[int]) -> None:
    """Half of the hemisphere from above, with rings of theta_o and, at its edge, phi_o - phi_i."""
    around = np.linspace(0, np.pi, 181)
    for ring in rings[1:]:
        color = "black" if ring == 90 else "0.8"
        axes.plot(ring * np.cos(around), ring * np.sin(around), color=color, lw=0.8, zorder=0)
    for degrees in (0, 45, 90, 135, 180):
        x, y = -np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        axes.plot([0, 90 * x], [0, 90 * y], color="0.8", lw=0.8, zorder=0, clip_on=False)
        if 0 < degrees < 180:
            axes.text(97 * x, 97 * y, f"{degrees}°", ha="center", va="center", fontsize=8)
    axes.set(xlim=(-100, 100), ylim=(0, 103), aspect="equal", title="the detector, from above",
             xticks=[-90, -60, -30, *rings], xticklabels=[90, 60, 30, *rings], yticks=[],
             xlabel="light's side          θo [°]          mirror's side")
    axes.spines[:].set_visible(False)
    axes.legend(loc="upper left", bbox_to_anchor=(-0.03, 1.1), fontsize=8, frameon=False, handletextpad=0.2)


def _valid_pairs(pairs: Any, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if not isinstance(pairs, (Directions, Measurement)):
        raise Error(f"{name} must be trilobe.Directions or a trilobe.Measurement", kind="format", key=name)
    rows = pairs.valid if isinstance(pairs, Measurement) else slice(None)
    return pairs.wi[rows], pairs.wo[rows]


def _theta_i_colors() -> Any:
    from matplotlib import cm, colors

    return cm.ScalarMappable(colors.Normalize(0, 90), "viridis")


def _mark(axes: Any, x: NDArray[Any], y: NDArray[Any], colors: NDArray[Any], is_next: bool) -> None:
    """Pairs as circles, with numbers where few come next."""
    numbered = is_next and len(x) <= 60
    style = {"s": 120 if numbered else 26 if len(x) <= 100 else 8, "linewidths": 1.3}
    axes.scatter(x, y, facecolors=colors if is_next else "none", edgecolors=colors, zorder=3, clip_on=False, **style)
    label = "next, in order" if numbered else "next" if is_next else "measured"
    axes.scatter([], [], facecolors="0.4" if is_next else "none", edgecolors="0.4", label=label, **style)
    for k, color in enumerate(colors if numbered else ()):
        dark = color[:3] @ (0.3, 0.6, 0.1) < 0.5
        axes.annotate(str(k + 1), (x[k], y[k]), ha="center", va="center_baseline", fontsize=7, zorder=4,
                      color="white" if dark else "black")
