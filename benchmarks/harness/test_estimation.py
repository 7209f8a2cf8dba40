"""Claims about `estimation`: python3 -m unittest discover -s benchmarks/harness -t benchmarks"""

import math
import random
import unittest

from harness import estimation as e


class Estimation(unittest.TestCase):
    def test_quantiles_of_students_t_are_the_tabulated_ones(self):
        # Abramowitz and Stegun, table 26.10.
        for freedom, probability, truth in ((1, 0.975, 12.706), (2, 0.975, 4.303), (5, 0.95, 2.015), (30, 0.995, 2.750)):
            self.assertAlmostEqual(e.student_quantile(probability, freedom), truth, places=3)
            self.assertAlmostEqual(e.student_quantile(1 - probability, freedom), -truth, places=3)
        self.assertAlmostEqual(e.student_quantile(0.975, 1e7), 1.95996, places=4)

    def test_half_the_error_in_the_same_time_is_twice_the_efficiency(self):
        self.assertAlmostEqual(e.efficiency(0.021, 0.001, 2.0), 25.0)
        self.assertAlmostEqual(e.efficiency(0.011, 0.001, 2.0), 50.0)

    def test_an_error_that_is_the_references_own_has_no_efficiency(self):
        self.assertIsNone(e.efficiency(0.0015, 0.001, 2.0))

    def test_intervals_of_geometric_means_cover_as_often_as_they_say(self):
        draw = random.Random(1)
        trials, covered = 1000, 0
        for _ in range(trials):
            _, low, high = e.geometric_mean([math.exp(draw.gauss(0.3, 0.2)) for _ in range(3)], 0.9)
            covered += low <= math.exp(0.3) <= high
        # Five standard errors of a binomial share of 0.9.
        self.assertLess(abs(covered / trials - 0.9), 5 * math.sqrt(0.09 / trials))

    def test_intervals_of_ratios_cover_at_least_nearly_as_often_as_they_say(self):
        draw = random.Random(2)
        trials, covered = 1000, 0
        for _ in range(trials):
            ours = [math.exp(draw.gauss(1.0, 0.1)) for _ in range(4)]
            theirs = [math.exp(draw.gauss(0.0, 0.3)) for _ in range(3)]
            _, low, high = e.ratio(ours, theirs, 0.95)
            covered += low <= math.e <= high
        self.assertGreater(covered / trials, 0.92)
        self.assertLess(covered / trials, 0.985)

    def test_one_seed_has_no_interval(self):
        self.assertEqual(e.geometric_mean([2.0])[1:], (None, None))
        value, low, high = e.ratio([4.0], [2.0])
        self.assertAlmostEqual(value, 2.0)
        self.assertEqual((low, high), (None, None))

    def test_a_power_law_has_its_exponent(self):
        x = [1, 2, 4, 8, 16]
        slope, low, high = e.exponent(x, [3 * v**0.7 for v in x])
        self.assertAlmostEqual(slope, 0.7)
        self.assertAlmostEqual(low, 0.7)
        self.assertAlmostEqual(high, 0.7)
        slope, low, high = e.exponent(x, [1.1, 1.9, 4.4, 7.5, 16.5])
        self.assertLess(low, 1.0)
        self.assertGreater(high, 1.0)

    def test_means_that_differ_only_by_noise_agree(self):
        draw = random.Random(3)
        beyond, trials = 0, 1000
        for _ in range(trials):
            of_reference = draw.gauss(0, 0.05)
            differences = [draw.gauss(0, 0.1) - of_reference for _ in range(4)]
            # Variance 0.01 of each picture and 0.0025 of the reference, which thus has a fifth of relMSE.
            z = e.mean_agreement(differences, [math.sqrt(0.0125)] * 4, [1.0] * 4, 0.2, 1.0, 0.0)
            beyond += z > e.critical_z(0.05, 1)
        self.assertLess(abs(beyond / trials - 0.05), 5 * math.sqrt(0.0475 / trials))

    def test_an_offset_is_found_unless_it_is_allowed(self):
        arguments = ([0.02, 0.021], [0.001] * 2, [0.1] * 2, 0.001, 1.0)
        self.assertGreater(e.mean_agreement(*arguments, 0.0), e.critical_z(0.01, 18))
        self.assertEqual(e.mean_agreement(*arguments, 0.03), 0.0)


if __name__ == "__main__":
    unittest.main()
