"""regret.py on made-up measurements."""
import contextlib
import io
import os
import tempfile
import unittest

import regret

# Costs: bdpt 1000, nee 2000, tdpt-guided 250 [ns].
LINES = [
    "truth\troom\tbdpt\t10\t0.1\t100",
    "truth\troom\tnee\t40\t0.1\t50",
    "truth\troom\ttdpt-guided 0.5 0.4 1\t1.25\t0.1\t200",
    "told\troom\t8\t1\tbdpt\t9\t100",
    "told\troom\t8\t1\tnee\t40\t50",
    "told\troom\t8\t1\ttdpt-guided 0.5 0.4 1\t1.5\t200",
    # 8 samples of 1000 pixels at 200 ns are 1.6 ms.
    "choice\troom\t8\t1\ttdpt-guided 0.5 0.4 1\t0.0004\t10\t1000",
    "choice\troom\t8\t2\tnee\t0.0004\t10\t1000",
]


class Regret(unittest.TestCase):
    def test_efficiency_is_that_of_the_choice_less_its_time(self):
        right, wrong = regret.read(LINES)["room"].efficiencies(8)
        self.assertAlmostEqual(right[1], 1.6 / 2.0)
        self.assertAlmostEqual(right[0], 4 * 1.6 / 2.0)
        self.assertAlmostEqual(wrong[1], 250 / 2000 * 0.4 / 0.8)
        self.assertAlmostEqual(wrong[0], 1000 / 2000 * 0.4 / 0.8)

    def test_gain_is_of_the_best_with_portals_over_the_best_without(self):
        scene = regret.read(LINES)["room"]
        self.assertAlmostEqual(regret.portals_gain({i: scene.cost(i) for i in scene.truth}), 4)
        self.assertAlmostEqual(regret.portals_gain(scene.told[8, 1]), 3)
        self.assertIsNone(regret.portals_gain({"bdpt": 1, "nee": 2}))
        # The paper's algorithm alone is no candidate of auto.
        self.assertIsNone(regret.portals_gain({"bdpt": 1, "tdpt": 0.1}))

    def test_tables_hold_the_scene(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.txt")
            with open(path, "w", encoding="utf-8") as file:
                file.write("\n".join(LINES) + "\n")
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                regret.main([path])
        self.assertIn("| room | tdpt-guided 0.5 0.4 1 | 4.00 | 0.431 | tdpt-guided 0.5 0.4 1 |", out.getvalue())
        self.assertIn("| room | 4.00 | 3 (3 to 3) |", out.getvalue())
        self.assertIn("| **within a factor of two** | | 100 % |", out.getvalue())

    def test_what_is_no_measurement_is_refused(self):
        with self.assertRaisesRegex(ValueError, "line 1"):
            regret.read(["truth\troom\tbdpt\tx"])
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.txt")
            with open(path, "w", encoding="utf-8") as file:
                file.write("nothing\n")
            with self.assertRaisesRegex(ValueError, "no scene"):
                regret.main([path])


if __name__ == "__main__":
    unittest.main()
