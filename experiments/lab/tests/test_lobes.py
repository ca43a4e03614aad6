"""Lobes: their scores, and the assignment between runs."""
import math
import unittest

import numpy

from lab import lobes

BINS = 90


def content(count, seed=1):
    random = numpy.random.default_rng(seed)
    return {"lobes": count, "d": [0.1, 0.2, 0.3], "s": random.random((count, 3)).tolist(),
            "D": (random.random((count, BINS)) ** 8).tolist(),
            "F": random.random((3, BINS)).tolist(),
            "G": (random.random((count, BINS)) ** 4).tolist()}


def permuted(of, order, scales):
    """The lobes in another order, each factor of the k-th lobe then times scales[k]."""
    result = dict(of)
    for name in ("s", "D", "G"):
        result[name] = [[scale * x for x in of[name][m]] for m, scale in zip(order, scales)]
    return result


class MatchTest(unittest.TestCase):
    def test_permuted_and_rescaled_lobes_are_the_same(self):
        a = content(4)
        order = (2, 0, 3, 1)
        b = permuted(a, order, (1e-9, 3.0, 1e7, 1.0))
        table = lobes.scores(lobes.Model(b), lobes.Model(a))
        self.assertEqual(lobes.assign(table), order)
        for row, column in enumerate(order):
            self.assertAlmostEqual(table[row, column], 1, places=12)

    def test_all_pairs_count_not_the_best_pair(self):
        # Taking the largest score first would leave 0.1: 1.1 in all, not 1.7.
        self.assertEqual(lobes.assign([[1.0, 0.9], [0.8, 0.1]]), (1, 0))
        self.assertEqual(lobes.assign([[0.5, 0.5], [0.5, 0.5]]), (0, 1))

    def test_a_factor_of_its_own_lowers_the_score(self):
        a = content(1)
        b = {**a, "s": [[1.0, 0.0, 0.0]]}
        s = numpy.array(a["s"][0])
        self.assertAlmostEqual(lobes.scores(lobes.Model(a), lobes.Model(b))[0, 0],
                               s[0] / math.sqrt(s @ s))

    def test_unobserved_entries_do_not_count(self):
        a = content(1)
        b = {**a, "D": [[*a["D"][0][:-1], 1e6]], "unobserved": {"D": [[BINS - 1]], "F": [], "G": []}}
        self.assertAlmostEqual(lobes.scores(lobes.Model(a), lobes.Model(b))[0, 0], 1)

    def test_a_vanished_lobe_matches_nothing(self):
        a = content(2)
        a["s"][1] = [0.0, 0.0, 0.0]
        model = lobes.Model(a)
        self.assertEqual(lobes.scores(model, model)[1, 1], 0)

    def test_lobes_of_anisotropic_models(self):
        random = numpy.random.default_rng(2)
        a = content(3)
        a.update(kind="anisotropic", D=random.random((3, 4, 6)).tolist(),
                 G=random.random((3, 3, 6)).tolist(), theta_nodes={"D": [0, 10, 40, 90]},
                 phi_nodes={"D": [0, 60, 120, 180, 240, 300]})
        model = lobes.Model(a)
        self.assertEqual((model.D.shape, model.G.shape), ((3, 24), (3, 18)))
        # The upper hemisphere's, each to one node; that of the pole to the first entry.
        self.assertAlmostEqual(model.solid_angles.sum(), math.pi)
        self.assertAlmostEqual(model.solid_angles[0], math.pi * math.sin(math.radians(5)) ** 2)
        self.assertTrue((model.solid_angles[1:6] == 0).all())
        turned = {**a, **{name: [a[name][m] for m in (2, 0, 1)] for name in ("s", "D", "G")}}
        self.assertEqual(lobes.assign(lobes.scores(lobes.Model(turned), model)), (2, 0, 1))
        turned["D"] = numpy.roll(turned["D"], 3, axis=2).tolist()  # by 180 degrees: other lobes
        self.assertLess(max(lobes.scores(lobes.Model(turned), model)[k, m]
                            for k, m in enumerate((2, 0, 1))), 0.95)


if __name__ == "__main__":
    unittest.main()
