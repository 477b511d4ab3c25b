"""intervals.py against tables, closed forms and its promise: 95 % intervals hold the truth in 95 % of the cases."""
import unittest

import numpy as np

import intervals


class Student(unittest.TestCase):
    def test_quantiles_are_those_of_the_tables(self):
        for df, t in ((1, 12.706), (2, 4.303), (3, 3.182), (4, 2.776), (7, 2.365), (15, 2.131), (30, 2.042), (120, 1.980)):
            self.assertAlmostEqual(intervals.t_quantile(0.025, df), t, delta=5e-4)
        self.assertAlmostEqual(intervals.t_quantile(0.005, 7), 3.499, delta=5e-4)

    def test_tails_are_the_integral_of_the_density(self):
        x = np.linspace(0, 2, 200001)
        for df in (1, 2, 3, 6, 11):
            density = (1 + x**2 / df) ** (-(df + 1) / 2)
            # Its mass on [0, inf) is a half; the substitution x = sqrt(df) tan(a) makes the whole finite.
            a = np.linspace(0, np.pi / 2, 200001)
            whole = np.trapz(np.cos(a) ** (df - 1), a) * np.sqrt(df)
            self.assertAlmostEqual(intervals.t_tail(2, df), 0.5 - 0.5 * np.trapz(density, x) / whole, places=7)

    def test_many_degrees_are_the_normal_distribution(self):
        self.assertAlmostEqual(intervals.t_tail(1.96, 10000), intervals.normal_tail(1.96), places=4)
        self.assertAlmostEqual(intervals.normal_tail(1.959964), 0.025, places=7)


def share_held(truth, tail, n=4, cases=400):
    """Of the intervals of the ratio of two means of n values that hold `truth`; the true ratio is 2."""
    rng, held = np.random.default_rng(7), 0
    for _ in range(cases):
        above, below = 2 * rng.lognormal(0, 0.5, n), rng.lognormal(0, 0.5, n)
        low, high = intervals.ratio_interval(above, below, rng, tail)
        held += low <= truth <= high
    return held / cases


def share_of_geometric_means_held(truth, cases=400):
    """The same for the geometric mean of three ratios of means of 6 values; the true ones are 1, 2 and 4."""
    rng, held = np.random.default_rng(8), 0
    for _ in range(cases):
        pairs = [(ratio * rng.lognormal(0, 0.5, 6), rng.lognormal(0, 0.5, 6)) for ratio in (1, 2, 4)]
        low, high = intervals.geometric_interval(pairs, rng)
        held += low <= truth <= high
    return held / cases


class Bootstrap(unittest.TestCase):
    # 95 % of 400: one standard deviation is 1.1 %.
    def test_intervals_hold_the_ratio_as_often_as_they_say(self):
        self.assertGreater(share_held(2, None), 0.92)

    def test_plain_percentiles_of_few_values_do_not_nor_do_intervals_hold_another_ratio(self):
        self.assertLess(share_held(2, 0.025), 0.92)
        self.assertLess(share_held(3, None), 0.92)

    def test_geometric_means_are_held_and_no_other_value(self):
        self.assertGreater(share_of_geometric_means_held(2), 0.92)
        self.assertLess(share_of_geometric_means_held(7 / 3), 0.92)  # the arithmetic mean

    def test_ends_without_bound(self):
        rng = np.random.default_rng(1)
        ones = np.ones(4)
        self.assertEqual(intervals.ratio_interval(ones, ones, rng), (1, 1))
        mixed = np.array([-3.0, 1, 1, 2])
        self.assertEqual(intervals.ratio_interval(mixed, ones, rng)[0], 0)
        self.assertEqual(intervals.ratio_interval(ones, mixed, rng)[1], intervals.NO_BOUND)
        self.assertEqual(intervals.geometric_interval([(ones, ones), (4 * ones, ones)], rng), (2, 2))
        self.assertEqual(intervals.geometric_interval([(ones, ones), (mixed, ones)], rng)[0], 0)
        self.assertEqual(intervals.geometric_interval([(ones, ones), (ones, mixed)], rng)[1], intervals.NO_BOUND)


class Means(unittest.TestCase):
    def test_standard_errors(self):
        rng = np.random.default_rng(2)
        means, errors = zip(*(intervals.mean_and_error(rng.normal(5, 2, 16)) for _ in range(2000)))
        self.assertAlmostEqual(np.std(means), 0.5, delta=0.03)
        self.assertAlmostEqual(np.sqrt(np.mean(np.square(errors))), 0.5, delta=0.03)

    def test_differences_in_errors(self):
        z = intervals.in_errors((np.array([3.0, 1.0]), np.array([3.0, 0.0])), (np.array([-2.0, 1.0]), np.array([4.0, 0.0])))
        np.testing.assert_allclose(z, [1, 0])

    def test_weighted_means_take_long_pictures_for_many_short_ones(self):
        rng = np.random.default_rng(3)
        weights = rng.integers(1, 200, 3000)
        mean, variance = intervals.weighted_mean(rng.normal(1, 0.5 / np.sqrt(weights)), weights)
        self.assertAlmostEqual(mean, 1, delta=0.01)
        self.assertAlmostEqual(variance, 0.25, delta=0.03)

    def test_small_ones(self):
        self.assertEqual(intervals.lower_median([5, 1, 3]), 3)
        self.assertEqual(intervals.lower_median([4, 1, 3, 2]), 2)
        self.assertEqual([intervals.percent(1, 4), intervals.percent(0, 0), intervals.percent(1, 0)], [25, 0, float("inf")])


if __name__ == "__main__":
    unittest.main()
