#!/usr/bin/env python3
"""E computed anew from the formulas of docs/model.md and docs/objective.md: objective_test.py PROGRAM."""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

Array = np.ndarray
PROGRAM = ""
BINS = (90, 90, 180)
SCALES = np.array([1.0, 1.15, 1.66]) / 1500  # scales of a MERL file: red, green, blue


def spline(values: Array, theta: Array) -> Array:
    """Catmull-Rom through nodes at (k + 1/2) 90/n degrees, one-sided slopes at the two ends, constant beyond."""
    x = np.clip(theta / (np.pi / 2) * len(values) - 0.5, 0, len(values) - 1)
    k = np.minimum(x.astype(int), len(values) - 2)
    t = x - k
    slopes = np.gradient(values)
    hermite = (2 * t**3 - 3 * t**2 + 1, 3 * t**2 - 2 * t**3, t**3 - 2 * t**2 + t, t**3 - t**2)
    return hermite[0] * values[k] + hermite[1] * values[k + 1] + hermite[2] * slopes[k] + hermite[3] * slopes[k + 1]


def linear(values: Array, coordinate: Array) -> Array:
    """Linear interpolation between the centres of bins, whose coordinate is k + 1/2; constant beyond."""
    return np.interp(coordinate - 0.5, np.arange(len(values)), values)


class Samples:
    """Half and difference angles [rad], cosines of both directions, rho* [n, 3], and the solid angle W."""

    def __init__(self, theta_h: Array, theta_d: Array, cosines: tuple[Array, Array], rho: Array, solid_angle: Array):
        self.theta_h, self.theta_d, self.cosines = theta_h, theta_d, cosines
        self.rho, self.solid_angle = rho, solid_angle
        self.counts = np.ones(len(rho))

    def value(self, model: dict) -> Array:
        """rho of an isotropic model with shared factors (paper eq. 3) [n, 3]."""
        thetas = [np.arccos(cosine) for cosine in self.cosines]
        nodes = len(model["G"][0]) if model["lobes"] else 90
        node_cosines = np.cos((np.arange(nodes) + 0.5) / nodes * np.pi / 2)
        cosines = spline(node_cosines, thetas[0]) * spline(node_cosines, thetas[1])
        rho = np.tile(np.array(model["d"]), (len(self.rho), 1))
        for s, d_table, g_table in zip(model["s"], model["D"], model["G"], strict=True):
            g = np.array(g_table)
            d_table = np.array(d_table)
            d = linear(d_table, np.sqrt(self.theta_h / (np.pi / 2)) * len(d_table))
            shared = d * spline(g, thetas[0]) * spline(g, thetas[1]) / cosines
            for c in range(3):
                f = np.array(model["F"][c])
                rho[:, c] += s[c] * shared * linear(f, self.theta_d / (np.pi / 2) * len(f))
        return rho

    def weights(self) -> Array:
        """Weights of `appearance`, the same for all channels [n]."""
        c = self.cosines[0] * self.cosines[1]
        mean = self.rho.mean(axis=1)
        measure = self.solid_angle * self.counts
        level = np.sum(measure * c * mean) / np.sum(measure * c)
        return self.counts * self.solid_angle**0.75 * c**2 * (c * mean / level + 1 / 20) ** -1.5

    def objective(self, model: dict) -> float:
        residuals = self.value(model) - self.rho
        return float(np.sum(self.weights()[:, None] * residuals**2))


def read_merl(path: pathlib.Path) -> Samples:
    stored = np.fromfile(path, "<f8", offset=12).reshape(3, -1)
    h, d, p = (index.ravel() for index in np.indices(BINS))
    theta_h = ((h + 0.5) / 90) ** 2 * np.pi / 2
    theta_d, phi_d = (d + 0.5) * np.pi / 180, (p + 0.5) * np.pi / 180
    a, b = np.cos(theta_h) * np.cos(theta_d), np.sin(theta_h) * np.sin(theta_d) * np.cos(phi_d)
    valid = (a - b > 0) & (a + b > 0) & np.all(np.isfinite(stored) & (stored >= 0), axis=0)
    solid_angle = np.sqrt(theta_h) * np.sin(theta_h) * np.sin(theta_d) * np.cos(theta_d)
    cosines = (np.minimum(a - b, 1)[valid], np.minimum(a + b, 1)[valid])
    return Samples(theta_h[valid], theta_d[valid], cosines, (stored[:, valid] * SCALES[:, None]).T, solid_angle[valid])


def read_csv(path: pathlib.Path) -> Samples:
    with path.open(encoding="utf-8") as file:
        lines = [line for line in file if not line.startswith("#")]
    rows = np.array(list(csv.reader(lines))[1:], float)
    theta_i, phi_i, theta_o, phi_o = np.radians(rows[:, :4]).T
    wi, wo = (np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1)
              for theta, phi in ((theta_i, phi_i), (theta_o, phi_o)))
    half = (wi + wo) / np.linalg.norm(wi + wo, axis=1, keepdims=True)
    theta_h = np.arctan2(np.hypot(half[:, 0], half[:, 1]), half[:, 2])
    theta_d = np.arctan2(np.linalg.norm(np.cross(wi, half), axis=1), np.sum(wi * half, axis=1))
    samples = Samples(theta_h, theta_d, (np.cos(theta_i), np.cos(theta_o)), rows[:, 4:7], np.ones(len(rows)))
    samples.counts = counts_of(rows[:, :4])
    return samples


def counts_of(angles: Array) -> Array:
    """Weights of scattered samples, by how dense they are; `angles` in degrees [n, 4]."""
    theta = np.sort(angles[:, [0, 2]], axis=1)
    between = np.abs((angles[:, 1] - angles[:, 3] + 180) % 360 - 180)
    places = np.column_stack([theta / 7.5, between / 15])
    cells = np.minimum(np.floor(places + 1e-6), 11)
    _, cell, samples = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    most = 4 * np.sort(samples)[len(samples) // 2]
    return np.minimum(1, most / samples[cell.ravel()])


class Objective(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_program(self, *arguments: str | pathlib.Path) -> None:
        subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True)

    def fit(self, source: pathlib.Path, *flags: str) -> tuple[dict, dict]:
        """The model and the report."""
        out = self.folder / "out"
        self.run_program("fit", source, f"--out={out}", "--solver=awls", "--noplots", "--nodiagnose", *flags)
        return tuple(json.loads((out / name).read_text()) for name in ("model.json", "report.json"))

    def check(self, told: float, expected: float, tolerance: float) -> None:
        self.assertLessEqual(abs(told - expected), tolerance * expected, f"{told} is told, it is {expected}")

    def test_of_a_table(self) -> None:
        """All samples count in L, so nothing but rounding is between the two."""
        source = self.folder / "table.binary"
        self.run_program("synth", "copper", "--noise=0.02", f"--out={source}")
        model, report = self.fit(source, "--max_iterations=2")
        E = read_merl(source).objective(model)
        self.check(report["objective"], E, 1e-11)
        self.check(model["fit"]["objective"], E, 1e-11)

    def test_of_scattered_samples_with_a_guide(self) -> None:
        """E is that of the samples alone, the prior's are not in it; at the start, too."""
        source = self.folder / "few.csv"
        self.run_program("convert", "synth:copper", "--noise=0.02", "--missing=0.999", f"--out={source}")
        samples = read_csv(source)
        model, report = self.fit(source, "--max_iterations=5")
        self.check(report["objective"], samples.objective(model), 1e-9)
        with (self.folder / "out/trace.csv").open(encoding="utf-8") as trace:
            rows = list(csv.DictReader(trace))
        with_prior = [float(row["objective_with_prior"]) for row in rows]
        self.assertEqual(with_prior, sorted(with_prior, reverse=True))
        self.assertEqual(report["prior"]["initial_objective"], with_prior[0])
        self.assertEqual(report["prior"]["objective"], with_prior[-1])
        self.assertEqual(float(rows[0]["objective"]), report["initial_objective"])
        self.assertEqual(model["fit"]["initial_objective"], report["initial_objective"])
        _, alone = self.fit(source, "--max_iterations=0", "--prior=0")
        self.check(report["initial_objective"], alone["initial_objective"], 1e-12)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
