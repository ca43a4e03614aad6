import math
import unittest

from lab import stats

INF = math.inf


class StatsTest(unittest.TestCase):
    def test_quantiles_count_what_was_never_reached(self):
        self.assertEqual(stats.median([3, 1, 2]), 2)
        self.assertEqual(stats.median([4, 1, 2, 3]), 2.5)
        self.assertEqual(stats.median([1, INF, INF]), INF)
        self.assertEqual(stats.median([INF, 1]), INF)
        self.assertEqual(stats.spread([1, 2, 3, INF], 0.25), (1, 2.5, 3))
        self.assertEqual(stats.quantile([1, 2, 3, INF], 0.75), 3)
        self.assertEqual(stats.quantile([5], 0), 5)
        self.assertTrue(math.isnan(stats.median([])))

    def test_bootstrap(self):
        self.assertEqual(stats.bootstrap([3, 3, 3], stats.median), (3, 3))
        low, high = stats.bootstrap(list(range(101)), lambda of: sum(of) / len(of))
        # The mean of 101 draws has a standard deviation of sqrt((101^2 - 1) / 12 / 101) = 2.9.
        self.assertAlmostEqual(low, 50 - 1.96 * 2.9, delta=0.6)
        self.assertAlmostEqual(high, 50 + 1.96 * 2.9, delta=0.6)

    def test_sign_test(self):
        self.assertEqual(stats.sign_test([1, 1, 1, 1, 1, 2], [2, 2, 2, 2, 2, 1], 0.001), (5, 1, 14 / 64))
        self.assertEqual(stats.sign_test([1, 1], [1.0005, 1], 0.001), (0, 0, 1.0))
        self.assertEqual(stats.sign_test([1, INF], [INF, INF], 0.001), (1, 0, 1.0))

    def test_crossed_leaves_out_what_lacks_a_combination(self):
        rows = [{"a": a, "b": b, "x": 10 * a + b} for a in (1, 2) for b in (5, 3, 4) if (a, b) != (2, 3)]
        cube, left = stats.crossed(rows, ("a", "b"), "b", "x")
        self.assertEqual(left, [5, 4])
        self.assertEqual(cube.tolist(), [[15, 14], [25, 24]])
        cube, left = stats.crossed(rows[1:], ("a", "b"), "a", "x")
        self.assertEqual((left, cube.shape), ([], (0, 3)))

    def test_variance_shares(self):
        shares = stats.variance_shares([[4, 2], [-2, -4]], ("a", "b"))
        self.assertAlmostEqual(shares["a",], 0.9)
        self.assertAlmostEqual(shares["b",], 0.1)
        self.assertAlmostEqual(shares["a", "b"], 0)
        shares = stats.variance_shares([[[1, -1], [-1, 1]]] * 3, ("a", "b", "c"))
        self.assertAlmostEqual(shares["b", "c"], 1)
        self.assertAlmostEqual(sum(shares.values()), 1)
        self.assertEqual(len(shares), 7)
        self.assertTrue(math.isnan(stats.variance_shares([[1, 1], [1, 1]], ("a", "b"))["a",]))

    def test_excess(self):
        self.assertAlmostEqual(stats.excess(1.5, 1), 0.5)
        self.assertEqual(stats.excess(0, 0), 0)
        self.assertEqual(stats.excess(1, 0), INF)
        self.assertEqual(stats.ratio(INF, INF), INF)

    def test_time_to_target(self):
        self.assertEqual(stats.time_to_target([1, 2, 4], [9, 5, 3], 5), 2)
        self.assertEqual(stats.time_to_target([1, 2, 4], [9, 5, 3], 2), INF)

    def test_value_at(self):
        self.assertEqual(list(stats.value_at([1, 2, 4], [9, 5, 3], [0.5, 1, 3, 9])), [INF, 9, 5, 3])

    def test_profiles(self):
        self.assertEqual(list(stats.data_profile([1, INF, 3, 2], [0.5, 2, 10])), [0, 0.5, 0.75])
        ratios = stats.performance_ratios({"a": [1, 4, INF], "b": [2, 2, INF]})
        self.assertEqual(ratios, {"a": [1, 2, INF], "b": [2, 1, INF]})

    def test_rates(self):
        self.assertAlmostEqual(stats.linear_rate([0.5 ** k for k in range(30)]), 0.5)
        self.assertTrue(math.isnan(stats.linear_rate([1, 0, 0])))
        quadratic = [1e-1, 1e-2, 1e-4, 1e-8]
        self.assertAlmostEqual(stats.order(quadratic), 2)
        self.assertAlmostEqual(stats.order([0.5 ** k for k in range(9)]), 1)

    def test_geometric_mean(self):
        self.assertAlmostEqual(stats.geometric_mean([1, 4]), 2)

    def test_rank_correlation_is_of_the_order_alone(self):
        self.assertAlmostEqual(stats.rank_correlation([1, 2, 3, 9], [-1, 0, 7, 8]), 1)
        self.assertAlmostEqual(stats.rank_correlation([1, 2, 3], [3, 2, 1]), -1)
        # Ranks 1, 2.5, 2.5, 4 and 1, 2, 3, 4.
        self.assertAlmostEqual(stats.rank_correlation([1, 2, 2, 3], [1, 2, 3, 4]),
                               4.5 / math.sqrt(4.5 * 5))
        self.assertTrue(math.isnan(stats.rank_correlation([1], [1])))


if __name__ == "__main__":
    unittest.main()
