"""Samples at directions that an instrument measures, out of a table in MERL layout."""
import numpy

from lab import merl

LARGEST = 80  # polar angle, in degrees


def in_plane():
    """Scans of the plane of incidence every 2 degrees at six incidences, none within 3 degrees of the light:
    theta_i, phi_i, theta_o and phi_o in degrees. [samples, 4]"""
    scan = numpy.arange(-LARGEST, LARGEST + 1, 2)
    return numpy.array([(i, 0, abs(o), 180 if o > 0 else 0) for i in (10, 20, 30, 45, 60, 70) for o in scan
                        if abs(i + o) > 3], float)


def goniometer():
    """Six incidences at 385 outgoing directions each, all around. [2310, 4]"""
    outgoing = [(0, 0)] + [(o, phi) for o in range(5, LARGEST + 1, 5) for phi in range(0, 360, 15)]
    return numpy.array([(i, 0, o, phi) for i in (5, 15, 30, 45, 60, 70) for o, phi in outgoing], float)


def at_random(count=1500):
    """Pairs of directions at random, uniform in solid angle. [count, 4]"""
    random = numpy.random.default_rng(1)
    thetas = numpy.degrees(numpy.arccos(random.uniform(numpy.cos(numpy.radians(LARGEST)), 1, (count, 2))))
    return numpy.stack([thetas[:, 0], 0 * thetas[:, 0], thetas[:, 1], random.uniform(0, 360, count)], -1)


PATTERNS = {"in-plane": in_plane, "goniometer": goniometer, "random": at_random}


def direction(theta, phi):
    """Unit vectors of angles in degrees. [..., 3]"""
    theta, phi = numpy.radians(theta), numpy.radians(phi)
    return numpy.stack([numpy.sin(theta) * numpy.cos(phi), numpy.sin(theta) * numpy.sin(phi), numpy.cos(theta)], -1)


def half_difference(pairs):
    """theta_h, theta_d and phi_d of pairs of directions, in radians. [samples] each"""
    wi, wo = direction(pairs[:, 0], pairs[:, 1]), direction(pairs[:, 2], pairs[:, 3])
    h = wi + wo
    h /= numpy.linalg.norm(h, axis=-1, keepdims=True)
    theta_h = numpy.arccos(numpy.clip(h[:, 2], -1, 1))
    theta_d = numpy.arccos(numpy.clip((wi * h).sum(-1), -1, 1))
    # phi_d: the azimuth of wi about h, from the plane of h and the normal.
    across = numpy.cross([0.0, 0.0, 1.0], h)
    size = numpy.linalg.norm(across, axis=-1, keepdims=True)
    across = numpy.where(size > 1e-9, across / numpy.maximum(size, 1e-9), [0.0, 1.0, 0.0])
    along = numpy.cross(across, h)
    return theta_h, theta_d, numpy.arctan2((wi * across).sum(-1), (wi * along).sum(-1)) % numpy.pi


def values(table, pairs):
    """The table between the centres of its bins, in 1/sr; below 0 where a bin of them is not valid. [samples, 3]"""
    theta_h, theta_d, phi_d = half_difference(pairs)
    half = numpy.pi / 2
    place = numpy.stack([numpy.sqrt(theta_h / half) * 90, theta_d / half * 90, phi_d / numpy.pi * 180]) - 0.5
    low = numpy.floor(place).astype(int)
    t = place - low
    total = numpy.zeros((len(pairs), 3))
    invalid = numpy.zeros(len(pairs), bool)
    for corner in numpy.ndindex(2, 2, 2):
        weight = numpy.prod([t[k] if corner[k] else 1 - t[k] for k in range(3)], axis=0)
        h, d = (numpy.clip(low[k] + corner[k], 0, merl.SHAPE[k] - 1) for k in range(2))
        found = table[h, d, (low[2] + corner[2]) % merl.SHAPE[2]]
        invalid |= (found < 0).any(axis=-1) & (weight > 1e-9)
        total += weight[:, None] * found
    total[invalid] = -1
    return total
