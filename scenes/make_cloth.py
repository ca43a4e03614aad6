#!/usr/bin/env python3
"""Writes cloth.ply: a square cloth that lies on a ball and falls from it in folds.

make_cloth.py [cloth.ply]. Its u runs along the weft, v along the warp, and normals are those of the formula.
"""

import sys

import numpy as np

SIDE = 57
RADIUS = 0.62  # of what it lies on


def height(x, z):
    """A dome of the radius, from which the cloth falls in folds and lies flat further out."""
    r, phi = np.hypot(x, z), np.arctan2(z, x)
    dome = RADIUS * np.exp(-((r / 0.62) ** 2.4))
    folds = np.clip((r - 0.2) / 0.5, 0, 1) ** 2 * np.exp(-((r - 0.62) / 0.33) ** 2)
    return 0.02 + dome + 0.07 * folds * (1 + np.cos(8 * phi + 1.3 * np.sin(2 * phi)))


def main():
    """Writes the file."""
    t = np.linspace(-1.15, 1.15, SIDE)
    x, z = np.meshgrid(t, t, indexing="ij")
    y, step = height(x, z), 1e-3
    across = (height(x + step, z) - height(x - step, z)) / (2 * step)
    along = (height(x, z + step) - height(x, z - step)) / (2 * step)
    normal = np.stack([-across, np.ones_like(y), -along], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    uv = np.stack([x, z], axis=-1) / 2.3 + 0.5
    vertices = np.concatenate([np.stack([x, y, z], axis=-1), normal, uv], axis=-1).reshape(-1, 8).astype("<f4")
    k = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    a, b, c, d = k[:-1, :-1].ravel(), k[1:, :-1].ravel(), k[1:, 1:].ravel(), k[:-1, 1:].ravel()
    faces = np.zeros(2 * len(a), [("count", "u1"), ("corners", "<u2", 3)])
    faces["count"] = 3
    faces["corners"] = np.concatenate([np.stack([a, c, b], axis=1), np.stack([a, d, c], axis=1)])
    names = ("x", "y", "z", "nx", "ny", "nz", "u", "v")
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property float {name}" for name in names]
    header += [f"element face {len(faces)}", "property list uchar ushort vertex_indices", "end_header", ""]
    with open(sys.argv[1] if len(sys.argv) > 1 else "cloth.ply", "wb") as file:
        file.write("\n".join(header).encode() + vertices.tobytes() + faces.tobytes())


if __name__ == "__main__":
    main()
