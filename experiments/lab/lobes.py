"""Lobes of fitted models: read, compared, matched between runs."""
import itertools
import json
import math
import subprocess

import numpy

CHANNELS = 3


def _edges(bins):
    """Edges of the theta_h bins of the MERL grid, in radians. [bins + 1]"""
    return (numpy.arange(bins + 1) / bins) ** 2 * (math.pi / 2)


def _solid_angles(bins):
    """Projected solid angles of the theta_h bins. [bins]"""
    return math.pi * numpy.diff(numpy.sin(_edges(bins)) ** 2)


def _solid_angles_of_nodes(thetas, phis):
    """Projected solid angles nearest to the nodes of D over theta_h (degrees, from 0) and so many
    phi_h. [len(thetas) phis]; the pole, whose entries are one, has its own at the first of them."""
    middles = numpy.radians((numpy.array(thetas[1:]) + thetas[:-1]) / 2)
    rings = math.pi * numpy.diff(numpy.sin([0, *middles, math.pi / 2]) ** 2)
    angles = numpy.repeat(rings / phis, phis)
    angles[:phis] = 0
    angles[0] = rings[0]
    return angles


class Model:
    """A model file of the paper's sharing (docs/file-formats.md).

    d [3], s [lobes][3], D [lobes][bins], F [3][bins], G [lobes][nodes]; observed: the same names,
    True where data touch the entry. D and G of an anisotropic model have their phi one after the
    other for each theta. solid_angles: projected, of the entries of D. [bins]
    """

    def __init__(self, content):
        if "stretch" in content:
            raise ValueError("stretch: lobes whose highlights are stretched are not compared")
        self.lobes = content["lobes"]
        self.d = numpy.array(content["d"], dtype=float)
        self.s = numpy.array(content["s"], dtype=float).reshape(self.lobes, CHANNELS)
        self.observed = {}
        for factor in "DFG":
            table = numpy.array(content[factor], dtype=float)
            if factor != "F" and table.ndim == 3:  # [lobes][theta][phi]
                table = table.reshape(len(table), -1)
            if table.ndim != 2 or len(table) != (CHANNELS if factor == "F" else self.lobes):
                raise ValueError(f"{factor}: D and G must have a table a lobe, F one a channel")
            observed = numpy.ones(table.shape, dtype=bool)
            lists = content.get("unobserved", content.get("dead", {}))  # "dead" was its first name
            for of, unobserved in zip(observed, lists.get(factor, [])):
                of[unobserved] = False
            setattr(self, factor, table)
            self.observed[factor] = observed
        self.solid_angles = (
            _solid_angles_of_nodes(content["theta_nodes"]["D"], len(content["phi_nodes"]["D"]))
            if content.get("kind") == "anisotropic" else _solid_angles(self.D.shape[1]))

    @staticmethod
    def read(path):
        return Model(json.loads(path.read_text()))


def congruence(a, b, weights=1.0):
    """The cosine between two arrays; 0 if either vanishes."""
    lengths = math.sqrt(numpy.sum(weights * a * a)) * math.sqrt(numpy.sum(weights * b * b))
    return float(numpy.sum(weights * a * b) / lengths) if lengths > 0 else 0.0


def scores(a, b):
    """Likeness in shape of every lobe of a and every lobe of b, whatever their strength. [a.lobes][b.lobes]

    It is the product of the congruences of D, weighted by the projected solid angle of its bins,
    of G and of s: 1 for lobes that differ in scale alone, 0 for lobes that have nothing in common
    or if one has vanished. Entries that no data touch in either model do not count.
    """
    result = numpy.zeros((a.lobes, b.lobes))
    for m, n in itertools.product(range(a.lobes), range(b.lobes)):
        result[m, n] = (congruence(a.D[m], b.D[n],
                                   a.solid_angles * (a.observed["D"][m] & b.observed["D"][n]))
                        * congruence(a.G[m], b.G[n], a.observed["G"][m] & b.observed["G"][n])
                        * congruence(a.s[m], b.s[n]))
    return result


def assign(table):
    """The assignment with the largest sum of scores: of each row its column. Of equal ones the
    first in lexical order, so the identity if that is among them. table: square, a few rows."""
    rows = range(len(table))
    return max(itertools.permutations(rows),
               key=lambda columns: sum(table[row][column] for row, column in zip(rows, columns)))


def matches(program, reference, paths):
    """Whether models have the lobes of the reference, by the program match_lobes, which compares them as `trilobe
    study` does (docs/study.md). A dict for each of the paths, as it prints them."""
    printed = subprocess.run([program, reference], input="".join(f"{path}\n" for path in paths), check=True,
                             stdout=subprocess.PIPE, text=True).stdout
    return [json.loads(line) for line in printed.splitlines()]
