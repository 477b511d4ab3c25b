"""target_error.py on runs whose coverage is known."""
import unittest

import numpy as np

import target_error


def runs(better=1.5, scatter=0.1, pictures=100, told=1.0):
    rng = np.random.default_rng(3)
    lines = []
    for seed in range(pictures):
        relmse = 0.02 / better * rng.lognormal(0, scatter)
        estimate = told * relmse
        lines.append(f"room 768 0.02 {relmse} {seed} 64 {estimate} {estimate / 1.2} {estimate * 1.2} 16 {int(estimate <= 0.02)}")
    return target_error.Summary(target_error.read(lines)["room"])


class Coverage(unittest.TestCase):
    def test_good_pictures_keep_the_word(self):
        s = runs()
        self.assertTrue(s.keeps_its_word())
        self.assertEqual(s.met, 1)
        self.assertAlmostEqual(s.better[1], 1.5, delta=0.05)
        self.assertEqual(s.pilot, 0.25)
        self.assertAlmostEqual(s.told, 1)

    def test_twin_too_few_meet_it(self):
        s = runs(better=1.05)
        self.assertFalse(s.keeps_its_word())
        self.assertEqual(s.known, s.missed)

    def test_twin_too_good(self):
        self.assertFalse(runs(better=3).keeps_its_word())

    def test_misses_that_are_not_told(self):
        s = runs(better=1.05, told=0.5)
        self.assertGreater(s.missed, 10)
        self.assertEqual(s.known, 0)
        self.assertGreater(runs(told=2).false_alarms, 50)

    def test_interval_of_a_share(self):
        low, high = target_error.wilson(0.9, 100)
        self.assertAlmostEqual(low, 0.826, delta=0.002)
        self.assertAlmostEqual(high, 0.945, delta=0.002)

    def test_page_has_a_row_for_each_scene(self):
        lines = [f"{scene} 768 0.02 0.01 1 64 0.01 0.009 0.011 16 1" for scene in ("a", "b")]
        page = "\n".join(target_error.table(target_error.read(lines)))
        self.assertIn("| a | 768 | 0.02 | 1 | 100 %", page)
        self.assertIn("All 2 pictures: 100.0 %", page)


if __name__ == "__main__":
    unittest.main()
