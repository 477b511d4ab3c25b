"""cycles_equal.py on runs whose gains are known."""
import contextlib
import io
import os
import tempfile
import unittest

import numpy as np

import cycles_equal

# CPU s and relMSE of each method: gains over portals by hand 0.5, 0.8, 2, 10.
METHODS = {"cycles": (4, 0.2), "cycles-hand": (4, 0.1), "cycles-found": (4, 0.125), "ours-nee": (4, 0.05), "ours-auto": (2, 0.02)}


def lines(factor=1):
    """factor: by which the errors of auto are smaller under the sun."""
    rng, out = np.random.default_rng(3), []
    for room in ("window", "behind"):
        for sky in ("clear", "sun"):
            out.append(f"cell {room} {sky} 2 0.9 10.5 4 -0.001")
            for seed in range(1, 5):
                for method, (cpu, relmse) in METHODS.items():
                    error = relmse * rng.lognormal(0, 0.02)
                    if method == "ours-auto" and sky == "sun":
                        error /= factor
                    out.append(f"run {room} {sky} {method} {seed} 100 {cpu} {error} {error / 10} -")
    return out


def page(of):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "all")
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(of) + "\n")
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            cycles_equal.main(path)
        return out.getvalue()


class Gains(unittest.TestCase):
    def test_are_those_of_efficiency(self):
        for cell in cycles_equal.read(lines()).values():
            for method, wanted in (("cycles", 0.5), ("cycles-found", 0.8), ("ours-nee", 2), ("ours-auto", 10)):
                value, low, high = cycles_equal.gain(cell, method)
                self.assertLess(abs(value / wanted - 1), 0.05)
                self.assertTrue(low < value < high)
                self.assertTrue(low < wanted * 1.05 and wanted < high * 1.05)

    def test_twin_smaller_errors_under_the_sun(self):
        cells = cycles_equal.read(lines(3))
        means = {sky: cycles_equal.geometric_mean([c for (_, s), c in cells.items() if s == sky], "ours-auto")
                 for sky in ("clear", "sun")}
        self.assertAlmostEqual(means["sun"] / means["clear"] / 3, 1, delta=0.05)

    def test_psnr_is_of_the_mean_error(self):
        cell = cycles_equal.read(lines())["window", "sun"]
        self.assertAlmostEqual(cycles_equal.psnr(cell, "cycles-hand"), 10 * np.log10(4 / 0.01), delta=0.2)


class Page(unittest.TestCase):
    def test_has_a_row_for_each_cell_and_mean(self):
        rows = [r for r in page(lines()).splitlines() if r.startswith("| ")]
        self.assertEqual(sum(r.startswith("| window |") for r in rows), 4)
        self.assertEqual(sum(r.startswith("| geometric mean |") for r in rows), 3)
        self.assertTrue(all("nan" not in r for r in rows))

    def test_a_broken_line_is_named(self):
        with self.assertRaisesRegex(ValueError, "^line 3: "):
            cycles_equal.read([*lines()[:2], "run window clear"])


if __name__ == "__main__":
    unittest.main()
