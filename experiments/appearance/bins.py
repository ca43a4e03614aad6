"""Measurements and what was fitted to them as rows of numbers, a row a bin of the MERL layout."""
import pathlib
import subprocess
import sys
import tempfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from lab import merl  # noqa: E402


def converted(program, file, flags=()):
    """A source or a model as a table."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "table.binary"
        subprocess.run([program, "convert", file, f"--out={out}", "--threads=1", *flags],
                       check=True, stdout=subprocess.DEVNULL)
        return merl.read(out)


def table(program, file):
    """The table of a measurement or fit, from a file."""
    if file.endswith(".npy"):
        return numpy.broadcast_to(numpy.load(file), (*merl.SHAPE, 3))
    return merl.read(file) if file.endswith(".binary") else converted(program, file)


def _nearest_above():
    """The bin above the surface in the same row that is nearest in phi_d, for each bin, and whether there is one.
    [bins], [bins]"""
    above = numpy.minimum(*merl.cosines()) > 0
    phi = numpy.arange(merl.SHAPE[2])
    row = numpy.where(above, phi, -1)
    left = numpy.maximum.accumulate(row, axis=2)
    right = numpy.where(above, phi, 10 ** 6)
    right = numpy.minimum.accumulate(right[:, :, ::-1], axis=2)[:, :, ::-1]
    there = above.any(axis=2, keepdims=True)
    chosen = numpy.where((left < 0) | (right - phi < phi - left), right, left)
    chosen = numpy.where(there, chosen, phi)
    first = numpy.arange(above[..., 0].size).reshape(*above.shape[:2], 1) * merl.SHAPE[2]
    return (first + chosen).ravel(), numpy.broadcast_to(there, above.shape).ravel()


def rows(measured, fitted):
    """All that is to render, a row a bin: the measurement, the fits, and 1 where it was measured;
    all 0 where not. [bins][3 * tables + 1], float32"""
    nearest, there = _nearest_above()
    valid = (measured >= 0).all(axis=-1) & numpy.isfinite(measured).all(axis=-1)
    counts = valid.ravel()[nearest] & there
    result = numpy.zeros((len(nearest), 3 * (1 + len(fitted)) + 1), numpy.float32)
    for k, of in enumerate([measured, *fitted]):
        flat = of.reshape(-1, 3)[nearest]
        result[:, 3 * k:3 * k + 3] = numpy.where(counts[:, None], numpy.maximum(flat, 0), 0)
    result[:, -1] = counts
    return result
