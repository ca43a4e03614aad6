"""Models of every form, and the formula of docs/model.md in numpy, to compare with."""

import numpy as np

import trilobe

SMALL = "synth:plastic@24x24x48"  # a measurement that is fitted soon


def directions(count, seed):
    """Distributed by their cosines."""
    rng = np.random.default_rng(seed)
    r, phi = np.sqrt(rng.random(count)), 2 * np.pi * rng.random(count)
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r**2)], axis=-1)


def _peaks(lobes, entries):
    theta = (np.arange(entries) + 0.5) / entries
    widths = 0.1 + 0.2 * np.arange(lobes)[:, None]
    return np.exp(-((theta / widths) ** 2)) + 0.01


def isotropic(entries=90):
    """The paper's form, with three lobes."""
    rng = np.random.default_rng(100)
    F = 0.5 + 0.5 * ((np.arange(entries) + 0.5) / entries) ** 5 * np.ones((3, 1))
    G = 0.9 * np.cos(np.radians((np.arange(entries) + 0.5) * 90 / entries)) * np.ones((3, 1))
    return trilobe.Brdf([0.1, 0.05, 0.02], 0.2 + rng.random((3, 3)), _peaks(3, entries), F, G)


def stretched():
    """The same, each lobe stretched in its own way."""
    return isotropic().replace(stretch=[(-0.3, 0.2), (0, 0), (0.5, -0.1)])


def lambertian():
    """No lobe."""
    return trilobe.Brdf([0.1, 0.2, 0.3], np.empty((0, 3)), np.empty((0, 90)), np.empty((3, 90)),
                        np.empty((0, 90)))


def independent():
    """One lobe, nothing shared by the channels."""
    brdf = isotropic()

    def table(values, name):
        return trilobe.Table(np.stack([values * (1 + 0.1 * c) for c in range(3)])[None],
                             ("lobe", "channel", name))

    return trilobe.Brdf(brdf.d, brdf.s[:1], table(np.asarray(brdf.D[0]), "theta_h"),
                        table(np.asarray(brdf.F[0]), "theta_d"),
                        table(np.asarray(brdf.G[0]), "theta"))


def anisotropic():
    """Two lobes over polar coordinates."""
    theta = np.radians([0, 20, 50, 80])
    phi = 2 * np.pi * np.arange(12) / 12

    def table(values, names):
        return trilobe.Table(values, ("lobe", *names), dict(zip(names, (theta, phi))))

    around = 1 + 0.5 * np.cos(2 * phi)
    D = np.exp(-np.stack([4 * theta, 2 * theta])[..., None] ** 2 * around)
    G = np.cos(theta)[:, None] * (0.8 + 0.1 * np.cos(phi)) * np.ones((2, 1, 1))
    F = np.linspace(0.4, 1, 6) * np.ones((3, 1))
    return trilobe.Brdf(0.05, [[1, 0.8, 0.6], [0.3, 0.4, 0.5]], table(D, ("theta_h", "phi_h")),
                        trilobe.Table(F, ("channel", "theta_d")), table(G, ("theta", "phi")))


def _linear(table, place):
    place = np.clip(place, 0, table.shape[-1] - 1)
    low = np.minimum(place.astype(int), table.shape[-1] - 2)
    t = place - low
    return (1 - t) * table[..., low] + t * table[..., low + 1]


def _spline(table, place):
    """Catmull-Rom, with tangents of one-sided differences at the ends."""
    n = table.shape[-1]
    place = np.clip(place, 0, n - 1)
    low = np.minimum(place.astype(int), n - 2)
    t = place - low
    before = np.concatenate([2 * table[..., :1] - table[..., 1:2], table], axis=-1)
    padded = np.concatenate([before, 2 * table[..., -1:] - table[..., -2:-1]], axis=-1)
    p0, p1, p2, p3 = (padded[..., low + k] for k in range(4))
    return p1 + 0.5 * t * (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3
                                          + t * (3 * (p1 - p2) + p3 - p0)))


def _polar(table, theta, phi, thetas):
    rows = np.interp(theta, thetas, np.arange(len(thetas)))
    low = np.minimum(rows.astype(int), len(thetas) - 2)
    t = rows - low
    n = table.shape[-1]
    turns = np.mod(phi / (2 * np.pi), 1) * n
    left = turns.astype(int) % n
    f = turns - np.floor(turns)
    right = (left + 1) % n
    return ((1 - t) * ((1 - f) * table[..., low, left] + f * table[..., low, right])
            + t * ((1 - f) * table[..., low + 1, left] + f * table[..., low + 1, right]))


def literal(brdf, wi, wo):
    """The model's value, by its formula, for unit vectors above the surface."""
    h = wi + wo
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    theta_h = np.arctan2(np.hypot(h[:, 0], h[:, 1]), h[:, 2])
    cos_d = np.clip((wi * h).sum(axis=-1), -1, 1)
    theta_d = np.arccos(cos_d)
    theta = [np.arccos(np.clip(w[:, 2], -1, 1)) for w in (wi, wo)]
    phi = [np.arctan2(w[:, 1], w[:, 0]) for w in (wi, wo)]
    sines = np.maximum(2 * np.sin(theta_h) * np.sin(theta_d), 1e-300)
    cos_phi_d = np.clip((wo[:, 2] - wi[:, 2]) / sines, -1, 1)
    tables = {name: np.asarray(getattr(brdf, name)) for name in "DFG"}

    def of(name, lobe):
        dims = getattr(brdf, name).dims
        table = tables[name]
        table = table[lobe] if "lobe" in dims else table
        return table if "channel" in dims else np.broadcast_to(table, (3, *table.shape))

    value = np.broadcast_to(np.asarray(brdf.d), (len(wi), 3)).T.copy()
    for lobe in range(brdf.lobes):
        D, F, G = (of(name, lobe) for name in "DFG")
        if brdf.anisotropic:
            at_h = _polar(D, theta_h, np.arctan2(h[:, 1], h[:, 0]), brdf.D.coords["theta_h"])
            at = [_polar(G, t, p, brdf.G.coords["theta"]) for t, p in zip(theta, phi)]
            cosines = wi[:, 2] * wo[:, 2]
        else:
            along, across = brdf.stretch[lobe]
            read = theta_h * np.sqrt((cos_phi_d * cos_d**along) ** 2
                                     + (1 - cos_phi_d**2) * cos_d ** (2 * across))
            n = D.shape[-1]
            at_h = _linear(D, n * np.sqrt(np.minimum(read, np.pi / 2) / (np.pi / 2)) - 0.5)
            n = G.shape[-1]
            nodes = np.cos((np.arange(n) + 0.5) * np.pi / 2 / n)
            places = [n * t / (np.pi / 2) - 0.5 for t in theta]
            at = [_spline(G, place) for place in places]
            cosines = _spline(nodes, places[0]) * _spline(nodes, places[1])
        at_d = _linear(F, F.shape[-1] * theta_d / (np.pi / 2) - 0.5)
        value += np.asarray(brdf.s)[lobe][:, None] * at_h * at_d * at[0] * at[1] / cosines
    return np.maximum(value, 0).T
