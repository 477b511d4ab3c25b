"""whole_light.py on runs whose ratios are known."""
import contextlib
import io
import unittest

import numpy as np

import whole_light


def runs(slower=1.25, noisier=1.0, missing=0.25, base=True, seeds=6):
    """Depth 6 takes 2 s, no limit `slower` times as much with `noisier` times the relMSE; every run has its noise, and
    the machine is twice as slow for some seeds."""
    rng, lines = np.random.default_rng(5), []
    for seed in range(1, seeds + 1):
        busy = 2 if seed % 3 == 0 else 1
        for kind, cpu, relmse, mean in (("none", slower, noisier, 1), ("six", 1, 1, 1 - missing), ("base", 2, 1, 1 - missing)):
            if base or kind != "base":
                numbers = (2 * cpu * busy, 0.1 * relmse * rng.lognormal(0, 0.02), 3 * mean * rng.normal(1, 0.002))
                lines.append(" ".join(("room", "bdpt", kind, str(seed), *map(str, numbers))))
    return lines


def kinds(lines):
    return whole_light.read(lines)["room", "bdpt"]


def tables(lines):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        whole_light.print_tables(whole_light.read(lines))
    return out.getvalue()


class Ratios(unittest.TestCase):
    def test_time_is_that_of_neighbours_in_time(self):
        of = kinds(runs())
        self.assertAlmostEqual(whole_light.cpu_ratio(of["none"], of["six"]), 1.25)
        # Out of order, slow runs would stand against quick ones.
        self.assertEqual(kinds(runs()), kinds(list(reversed(runs()))))

    def test_efficiency_counts_time_and_error(self):
        of = kinds(runs(noisier=2, seeds=12))
        value, low, high = whole_light.efficiency_ratio(of["none"], of["six"])
        self.assertAlmostEqual(value, 1 / 2.5, delta=0.02)
        self.assertTrue(low < 1 / 2.5 < high)
        value, _, high = whole_light.efficiency_ratio(of["six"], of["six"])
        self.assertEqual(value, 1)

    def test_the_light_left_out_shows_in_the_mean_and_no_other_share_does(self):
        of = kinds(runs(missing=0.25))
        ratio, error = whole_light.mean_ratio(of["six"], of["none"])
        self.assertLess(abs(ratio - 0.75), 4 * error)
        self.assertGreater(abs(ratio - 0.74), 4 * error)

    def test_an_error_within_the_noise_of_the_reference_is_no_ratio(self):
        of = kinds(runs(noisier=-1))
        self.assertTrue(np.isnan(whole_light.efficiency_ratio(of["none"], of["six"])[0]))
        self.assertIn("| - |", tables(runs(noisier=-1)))


class Tables(unittest.TestCase):
    def test_rows(self):
        text = tables(runs())
        self.assertRegex(text, r"\n\| room \| bdpt \| 3\.33 \| 2\.67 \| 1\.25 \| 0\.\d+ \| 0\.\d+ \| 0\.\d\d \[0\.\d\d, \d\.\d\d\] \| "
                               r"0\.7\d+ \+- 0\.0\d+ \|\n")
        self.assertRegex(text, r"after / before \|\n.*\n\| room \| bdpt \| 2\.67 \| 5\.33 \| 0\.50 \|")
        self.assertNotIn("before", tables(runs(base=False)))

    def test_one_seed_has_no_interval(self):
        for mark in ("[", "+-", "nan"):
            self.assertIn(mark, tables(runs()) + "nan")
            self.assertNotIn(mark, tables(runs(seeds=1)))


if __name__ == "__main__":
    unittest.main()
