"""experiments/beyond/guesses.py: what other rules guess where a table has no values."""
import pathlib
import sys
import unittest

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "beyond"))
import guesses  # noqa: E402

RANDOM = numpy.random.default_rng(1)


class Guesses(unittest.TestCase):
    def test_nearest_goes_round_in_phi_and_ends_elsewhere(self):
        table = numpy.full((3, 4, 6, 3), -1.0)
        table[0, 0, 0], table[2, 3, 4] = 1, 2
        filled = guesses.nearest(table)
        self.assertTrue((filled > 0).all())
        self.assertEqual(filled[0, 0, 5, 0], 1)  # one step over the end of phi_d
        self.assertEqual(filled[2, 0, 0, 0], 1)  # two steps from the first, four from the second
        self.assertEqual(filled[2, 3, 3, 0], 2)
        with self.assertRaises(ValueError):
            guesses.nearest(numpy.full((3, 4, 6, 3), -1.0))

    def test_components_find_what_is_one_of_a_family(self):
        shape = (6, 8, 12)
        base, across = RANDOM.uniform(0.2, 1, (*shape, 1)), RANDOM.normal(size=(*shape, 1))

        def of(amounts):  # values that differ in the logarithm along one component
            return base * numpy.exp(across * numpy.asarray(amounts))

        others = [of(RANDOM.normal(size=3)) for _ in range(12)]
        whole = of([0.3, -0.2, 0.5])
        given = whole.copy()
        given[:, 5:] = -1
        before = guesses.RIDGE, guesses.ROWS
        guesses.RIDGE, guesses.ROWS = 1e-6, 1
        try:
            found = guesses.components(given, others, numpy.ones(shape))
        finally:
            guesses.RIDGE, guesses.ROWS = before
        numpy.testing.assert_array_equal(found[:, :5], given[:, :5])
        numpy.testing.assert_allclose(found[:, 5:], whole[:, 5:], rtol=0.02)


if __name__ == "__main__":
    unittest.main()
