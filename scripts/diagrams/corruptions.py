"""A sphere under each kind of --corrupt, at four strengths, and the fits to it."""

from __future__ import annotations

from typing import Any

from diagrams.fits import Folder, score, spheres, trilobe
from diagrams.look import plt

SOURCE = "synth:car-paint@30x30x60"
# Strengths from unnoticeable to hopeless, in the units of docs/your-data.md.
STRENGTHS = {
    "readings": {"noise": (0.05, 0.2, 0.5, 1), "dark": (0.01, 0.1, 1, 10), "photons": ("1e7", "1e6", "1e5", "1e4"),
                 "outliers": (0.001, 0.01, 0.05, 0.5), "spikes": (0.5, 0.333, 0.2, 0.13),
                 "zeros": (0.001, 0.01, 0.05, 0.5), "clip": (0.001, 0.01, 0.05, 0.2), "quantize": (16, 12, 10, 8),
                 "brackets": (12, 8, 6, 4)},
    "directions": {"gaps": (0.9, 0.99, 0.999, 0.9999), "retro": (10, 30, 60, 90), "beyond": (80, 70, 60, 45),
                   "side": (0.3, 0.6, 0.9, 1), "tilt": (0.1, 0.5, 2, 5), "origin": (0.2, 1, 4, 10),
                   "aperture": (0.2, 1, 3, 10), "repeat": (80, 70, 60, 40)},
    "light": {"crosstalk": (0.01, 0.1, 0.3, 1), "stray": (0.001, 0.01, 0.1, 1),
              "flare": ("1e-6", "1e-5", "1e-4", "1e-3"), "shadow": (3, 10, 20, 40), "cosine": (0.1, 0.3, 1, -1),
              "nonreciprocal": (0.1, 0.5, 1, 3)},
}
# These lose samples and change none. What is between the others is not measured: a clean one is beside the fit.
LOSSES = ("gaps", "retro", "beyond", "side")
SIDE, LEFT, GAP = 1.0, 1.05, 0.22  # widths of a sphere and the names, gap above the line below, in inches


def _fitted(folder: Folder, corrupt: str) -> tuple[list[Any], str]:
    """The corrupted measurement and the fit, and how near the fit is to the clean one."""
    name, flag = corrupt.replace(":", "_"), f"--corrupt={corrupt}"
    trilobe(folder, "fit", SOURCE, flag, "--noplots", "--nodiagnose", "--solver=varpro", "--max_iterations=12",
            f"--out={name}")
    shown = [] if corrupt.split(":")[0] in LOSSES else [flag, "--outliers", "--dark_noise"]
    both = spheres(folder, name, SOURCE, *shown)
    return both, f"{score(folder, name, SOURCE):.1f} dB"


def corruptions(folder: Folder, group: str) -> Any:
    """A line a kind: at each strength the corrupted measurement and, beside it, the fit."""
    kinds = STRENGTHS[group]
    width, height = LEFT + 8 * SIDE + 4 * 0.1, (SIDE + GAP) * len(kinds) + 0.2
    figure = plt.figure(figsize=(width, height), layout="none")
    for row, (kind, strengths) in enumerate(kinds.items()):
        below = height - 0.2 - (SIDE + GAP) * (row + 1)
        figure.text(0.05 / width, (below + GAP + SIDE / 2) / height, kind, va="center", fontsize=10)
        for column, strength in enumerate(strengths):
            (corrupted, made), psnr = _fitted(folder, f"{kind}:{strength}")
            left = LEFT + column * (2 * SIDE + 0.1)
            for k, picture in enumerate((corrupted, made)):
                axes = figure.add_axes(((left + k * SIDE) / width, (below + GAP) / height, 0.98 * SIDE / width,
                                        0.98 * SIDE / height))
                axes.imshow(picture, aspect="auto")
                axes.axis("off")
                if row == 0:
                    axes.set_title(("corrupted", "fitted")[k], loc="center", fontsize=8)
            figure.text((left + SIDE) / width, (below + 0.06) / height, f"{strength}: {psnr}", ha="center",
                        fontsize=8)
    return figure
