"""Guesses of other rules where a table has no values. Tables are as in lab.merl, invalid bins below 0."""
import numpy

EPSILON = 1e-3  # offset in logarithms, as in Nielsen et al.
RIDGE = 40.0  # the price of components, as theirs
ROWS = 16  # one of so many bins decides on the components


def is_measured(table):
    """[SHAPE]"""
    return (table >= 0).all(axis=-1)


def nearest(table):
    """Each invalid bin has the value of the nearest valid one, in steps of the grid along theta_h, theta_d and phi_d;
    phi_d is a circle."""
    filled, known = table.copy(), is_measured(table)
    while not known.all():
        took = False
        reached = known.copy()
        for axis in (1, 0, 2):
            for step in (1, -1):
                here = numpy.roll(known, step, axis)
                values = numpy.roll(filled, step, axis)
                if axis < 2:  # no circle
                    edge = [slice(None)] * 3
                    edge[axis] = 0 if step == 1 else -1
                    here[tuple(edge)] = False
                new = here & ~reached
                filled[new] = values[new]
                reached |= new
                took = took or new.any()
        known = reached
        if not took:
            raise ValueError("no bin is valid")
    return filled


def components(table, others, weight):
    """Guesses by principal components of other whole tables, each channel by itself (Nielsen, Jensen, Ramamoorthi 2015,
    On Optimal, Minimal BRDF Sampling for Reflectance Acquisition): logarithms relative to the median of all, weighted
    by `weight` [SHAPE], cos theta_i cos theta_o. What is valid stays."""
    known = is_measured(table).ravel()
    weight = numpy.maximum(weight, EPSILON).ravel()[:, None].astype(numpy.float32)
    columns = numpy.concatenate([numpy.maximum(other, 0).reshape(-1, 3).astype(numpy.float32) for other in others], 1)
    columns *= weight
    reference = numpy.median(columns, axis=1, keepdims=True) + EPSILON
    columns = numpy.log((columns + EPSILON) / reference)
    mean = columns.mean(axis=1, keepdims=True)
    columns -= mean
    sizes, turned = numpy.linalg.eigh((columns.T @ columns).astype(float))
    kept = sizes > 1e-6 * sizes[-1]  # a component is columns @ turned[:, k], as long as the data are along it
    basis = (turned[:, kept] / numpy.sqrt(len(columns[0]))).astype(numpy.float32)
    rows = numpy.flatnonzero(known)[::ROWS]
    seen = (columns[rows] @ basis).astype(float)
    values = numpy.maximum(table.reshape(-1, 3), 0) * weight
    wanted = numpy.log((values[rows] + EPSILON) / reference[rows]) - mean[rows]
    found = numpy.linalg.solve(seen.T @ seen + RIDGE * numpy.eye(seen.shape[1]), seen.T @ wanted)
    guess = columns @ (basis @ found.astype(numpy.float32)) + mean
    guess = numpy.maximum(numpy.exp(guess) * reference - EPSILON, 0) / weight
    return numpy.where(known[:, None], table.reshape(-1, 3), guess).reshape(table.shape)
