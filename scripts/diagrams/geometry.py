"""Diagrams of directions: the angles, what D, F and G mean, and where bins, nodes and folded samples lie."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from diagrams.look import BLUE, GREEN, GREY, ORANGE, PURPLE, RGB, ROOT, SKY, VERMILION, arrow, bare, plt

MATERIAL = "paper_white"  # in the library, with the paper's sharing


def seen(point: Any) -> np.ndarray:
    """A point in space on the sheet: from the front, 20 degrees from above."""
    x, y, z = np.asarray(point, float)
    lift = np.radians(20)
    return np.array([x, z * np.cos(lift) + y * np.sin(lift)])


def direction(theta: float, phi: float) -> np.ndarray:
    """The unit vector of polar angles in degrees."""
    t, p = np.radians([theta, phi])
    return np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])


def arc(axes: Any, one: np.ndarray, other: np.ndarray, radius: float, text: str, color: str, push: float) -> None:
    """Draws the angle between two unit vectors as an arc, with its name in its middle."""
    angle = np.arccos(one @ other)
    t = np.linspace(0, 1, 30)[:, None]
    points = radius * (np.sin((1 - t) * angle) * one + np.sin(t * angle) * other) / np.sin(angle)
    axes.plot(*np.array([seen(p) for p in points]).T, color=color, lw=1.6)
    axes.text(*seen(push * points[15]), text, color=color, ha="center", va="center", fontsize=13)


def angles() -> Any:
    """Half and difference angles over a surface."""
    figure, axes = plt.subplots(figsize=(6.6, 4.1))
    circle = np.array([seen(direction(90, p)) for p in range(0, 361, 3)])
    axes.fill(*circle.T, color="#eef3f8")
    axes.plot(*circle.T, color="#9fb3c6", lw=1)
    normal, light, eye = direction(0, 0), direction(74, 200), direction(27, -40)
    half = (light + eye) / np.linalg.norm(light + eye)
    for name, vector, color in (("n", normal, "#404040"), ("wi, to the light", light, ORANGE),
                                ("wo, to the eye", eye, BLUE), ("h", half, VERMILION)):
        arrow(axes, (0, 0), seen(vector), color, lw=2.4, mutation_scale=15)
        axes.text(*(seen(vector) + (0, 0.03)), name, color=color, ha="left" if name.startswith("wo") else "center",
                  va="bottom", fontsize=12)
    arc(axes, normal, light, 0.8, "θi", ORANGE, 1.1)
    arc(axes, normal, eye, 0.66, "θo", BLUE, 1.16)
    arc(axes, normal, half, 0.56, "θh", VERMILION, 1.17)
    arc(axes, half, light, 0.34, "θd", PURPLE, 0.7)
    arc(axes, half, eye, 0.34, "θd", PURPLE, 0.72)
    for vector, color in ((light, ORANGE), (eye, BLUE)):
        foot = vector * (1, 1, 0)
        axes.plot(*np.array([seen(vector), seen(foot), (0, 0)]).T, color=color, lw=0.9, ls=":")
    turn = np.linspace(200, 320, 40)
    axes.plot(*np.array([seen(0.42 * direction(90, p)) for p in turn]).T, color=GREY, lw=1.4)
    axes.text(*seen(0.52 * direction(90, 262)), "φo − φi", color=GREY, ha="center", va="top", fontsize=12)
    across = np.cross(half, normal)
    across /= np.linalg.norm(across)
    ring = np.linspace(-0.5, 2.6, 40)[:, None]
    ring_points = 0.86 * half + 0.13 * (np.cos(ring) * across + np.sin(ring) * np.cross(half, across))
    points = np.array([seen(p) for p in ring_points])
    axes.plot(*points.T, color=GREEN, lw=1.6)
    arrow(axes, points[-3], points[-1], GREEN)
    axes.text(*(points[18] + (-0.09, 0.0)), "φd", color=GREEN, ha="center", va="center", fontsize=13)
    axes.set(aspect="equal", xlim=(-1.35, 1.35), ylim=(-0.45, 1.2))
    axes.axis("off")
    return figure


def facets(axes: Any) -> None:
    """A row of small mirrors, some of which lean towards h, and one in whose shadow others lie."""
    x = np.arange(17) * 0.5
    y = 0.5 + np.array([0, .2, 0, .12, .3, .1, .25, .05, .3, 1.05, .2, .1, .3, .15, 0, .2, .05])
    axes.fill_between(x, 0, y, color="#dfe7ef")
    axes.plot(x, y, color="#50657a", lw=1.5)


def meanings(axes: Any) -> None:
    """Draws the meaning of each factor, in three sketches side by side."""
    bare(axes, 27.5, 4.6)
    titles = ("D(θh): how many mirrors lean towards h", "F(θd): how much a mirror reflects",
              "G(θi) G(θo): how much nothing hides")
    for k, title in enumerate(titles):
        axes.text(9.6 * k + 4, 4.3, title, ha="center", fontsize=10)
        part = axes.inset_axes([9.6 * k, 0, 8, 4], transform=axes.transData)
        bare(part, 8, 4)
        facets(part)
        if k == 0:
            for left, right, low, high in ((0.5, 1.0, .7, .5), (2, 2.5, .8, .6), (3, 3.5, .75, .55), (6, 6.5, .8, .65)):
                middle = np.array([(left + right) / 2, (low + high) / 2])
                normal = np.array([low - high, right - left])
                arrow(part, middle, middle + 2.2 * normal, VERMILION)
        if k == 1:
            foot = np.array([2.25, 0.7])
            arrow(part, (0.3, 2.1), foot, ORANGE)
            arrow(part, foot, (3.6, 3.1), BLUE)
            arrow(part, foot, foot + (0, 1.9), VERMILION, lw=1.1)
            part.text(2.3, 2.75, "h", color=VERMILION, ha="center", fontsize=11)
            part.text(1.85, 1.6, "θd", color=PURPLE, ha="center", fontsize=11)
        if k == 2:
            arrow(part, (0.2, 2.9), (4.45, 1.6), ORANGE)
            part.fill([4.5, 5.0, 7.4, 5.5, 5.0], [1.55, .7, .55, .6, .7], color="#50657a", alpha=.35, lw=0)
            part.plot([4.5, 7.4], [1.55, .6], color=ORANGE, lw=1, ls=":")
            part.text(6.4, 1.6, "in shadow", ha="center", fontsize=10, color="#50657a")


def entries(table: Any) -> np.ndarray:
    """All of a table of a model file; a compact one is linear between its nodes."""
    if isinstance(table, dict):
        return np.interp(np.arange(table["size"]), table["nodes"], table["values"])
    return np.array(table)


def model() -> Any:
    """The three factors as sketches, and below as tables of a fitted material."""
    figure = plt.figure(figsize=(9.6, 4.3))
    grid = figure.add_gridspec(2, 3, height_ratios=[1, 1.35])
    meanings(figure.add_subplot(grid[0, :]))
    fitted = json.loads((ROOT / f"materials/{MATERIAL}.json").read_text())
    lobes = (BLUE, VERMILION, GREEN)
    bins = np.arange(90) + 0.5
    at = {"D": 90 * (bins / 90) ** 2, "F": bins, "G": bins}
    labels = {"D": "D by θh [°], a curve a lobe", "F": "F by θd [°], a curve a channel",
              "G": "G by θi or θo [°], a curve a lobe"}
    for k, (name, label) in enumerate(labels.items()):
        axes = figure.add_subplot(grid[1, k])
        for table, color in zip(fitted[name], RGB if name == "F" else lobes, strict=True):
            axes.plot(at[name], entries(table), color=color, marker=".", ms=3, lw=1)
        axes.set(xlabel=label, xlim=(0, 90), xticks=range(0, 91, 30))
        axes.set_yscale("symlog", linthresh=0.01)
        axes.set_ylim(0)
    return figure


def layout() -> Any:
    """Bins of a MERL file, and the directions of a UTIA file."""
    figure = plt.figure(figsize=(9.6, 4.3))
    left = figure.add_subplot(1, 2, 1)
    edges = 90 * (np.arange(91) / 90) ** 2
    for k, edge in enumerate(edges):
        left.axvline(edge, color="#b9c7d5", lw=0.9 if k % 5 == 0 else 0.3)
    for k in range(91):
        left.axhline(k, color="#b9c7d5", lw=0.9 if k % 5 == 0 else 0.3)
    left.add_patch(plt.Rectangle((edges[60], 40), edges[61] - edges[60], 1, color=VERMILION))
    left.annotate("bin of θh 60, θd 40: 180 values by φd,\nfrom number 180 (40 + 90 · 60) = 975,600 on",
                  (edges[60] + 0.7, 41), (46, 60), ha="center", fontsize=9, color=VERMILION,
                  bbox={"color": "white", "alpha": .9}, arrowprops={"arrowstyle": "-", "color": VERMILION})
    left.set(xlim=(0, 90), ylim=(0, 90), xlabel="θh [°]: bin k from 90 (k/90)²", ylabel="θd [°]: bins of 1°",
             title="A plane of a MERL file", xticks=range(0, 91, 15), yticks=range(0, 91, 15))
    left.grid(visible=False)
    right = figure.add_subplot(1, 2, 2, projection="polar")
    for a in range(6):
        right.plot(np.radians(7.5) * np.arange(48), np.full(48, 15 * a), ".", color=BLUE, ms=3.5)
    right.annotate("number 48 · 3 + 7:\nθ = 45°, φ = 52.5°", (np.radians(52.5), 45), (np.radians(62), 104), fontsize=9,
                   ha="center", color=VERMILION, arrowprops={"arrowstyle": "-", "color": VERMILION})
    right.plot(np.radians(52.5), 45, "o", color=VERMILION, ms=5)
    right.set(ylim=(0, 90), yticks=[15, 45, 75], yticklabels=["15°", "45°", "75°"],
              xticks=np.radians([0, 90, 180, 270]), xticklabels=["x, warp", "y", "180°", "270°"])
    right.set_title("Directions of a UTIA file", loc="left", pad=22)
    return figure


def polar_angles(theta_h: float, theta_d: float, phi_d: np.ndarray) -> np.ndarray:
    """θi and θo of MERL's bins of one row."""
    h, d, p = np.radians(theta_h), np.radians(theta_d), np.radians(phi_d)
    along, up = np.sin(d) * np.cos(p), np.cos(d)
    return np.degrees(np.arccos(np.clip([np.cos(h) * up - np.sin(h) * along, np.cos(h) * up + np.sin(h) * along],
                                        -1, 1)))


def folding() -> Any:
    """Rows of bins in the plane of θi and θo, what is folded there, and the knots of G."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.5))
    phi = np.arange(180) + 0.5
    rows = ((10, 20, BLUE), (10, 55, GREEN), (30, 30, VERMILION), (45, 40, PURPLE))
    for theta_h, theta_d, color in rows:
        both = polar_angles(theta_h, theta_d, phi)
        kept = both[0] <= both[1]
        left.plot(*both[:, kept], ".", color=color, ms=3)
        left.plot(*both[:, ~kept], ".", color=color, ms=3, alpha=0.25)
        x, y = both[:, np.argmin(both[0])]
        left.text(x + 1, y + 1.5, f"θh {theta_h}°, θd {theta_d}°", color=color, fontsize=9)
    for theta_d, color in zip(range(27, 34), (BLUE, GREEN, PURPLE, VERMILION, ORANGE, SKY, GREY), strict=True):
        right.plot(*polar_angles(30, theta_d, phi), ".", color=color, ms=6)
    left.plot([0, 90], [0, 90], color=GREY, lw=1)
    left.text(75, 73, "exchanged", rotation=45, color=GREY, fontsize=9, ha="center", va="top")
    left.set(xlim=(0, 90), ylim=(0, 95), title="Rows of 180 bins; the pale half is folded")
    right.set(xlim=(20, 28), ylim=(50, 58), title="θh = 30°, θd = 27° … 33°, and G's knots",
              xticks=np.arange(20.5, 28), yticks=np.arange(50.5, 58))
    right.add_patch(plt.Rectangle((23.5, 53.5), 1, 1, facecolor=SKY, alpha=0.35))
    right.grid(color="#9fb3c6")
    for axes in (left, right):
        axes.set(xlabel="θi [°]", ylabel="θo [°]", aspect="equal")
    return figure
