"""efficiency_tables.py on made-up measurements whose gains are known."""
import contextlib
import io
import re
import unittest

import numpy as np

import efficiency_tables

COLUMNS = "scene,integrator,seed,seconds,spp,cpu_seconds,relmse,psnr,mape,mean,mse".split(",")


def measured(factor, spread, scenes=1, seconds="4"):
    """bdpt's relMSE is 8 and tdpt's 8 / factor on average over many seeds, of eight of which each is off by up to
    `spread` of it; tdpt takes half the samples, and 1 s less than bdpt's 4 s."""
    rng, rows, lines = np.random.default_rng(20261121), [], []
    for s in range(1, scenes + 1):
        lines.append("\t".join(f"room{s} 5 9 0.04 0.02 1 0.0001 0.001 80 0.7 20 90 bdpt 2000".split()))
        for seed in range(1, 9):
            off = 1 + spread * rng.uniform(-1, 1, 2)
            mean = 1 + 0.0005 * rng.uniform(-1, 1)
            for values in ((f"room{s}", "bdpt", seed, seconds, 100, 4, 8 * off[0], 20, 50, mean, 0.01),
                           (f"room{s}", "tdpt", seed, seconds, 50, 3, 8 / factor * off[1], 23, 40, 1, 0.005)):
                rows.append(dict(zip(COLUMNS, map(str, values))))
    return lines, rows


def table(name, data, *which, seconds="4"):
    """The lines that are printed."""
    lines, rows = data
    text = "\n".join([",".join(COLUMNS), *(",".join(r.values()) for r in rows)])
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        m = efficiency_tables.read(lines, io.StringIO(text), seconds)
        efficiency_tables.TABLES[name](m, *which)
    return out.getvalue().splitlines()


def gain_of(data):
    """The gain of tdpt and whether it meets the target of 5, of the first room."""
    cells = [c.strip() for c in table("gains", data)[2].split("|")]
    return cells[2], cells[4].removeprefix("tdpt: ")


class Gains(unittest.TestCase):
    def test_without_noise_are_what_they_are(self):
        six = measured(6, 0)
        self.assertEqual(gain_of(six), ("8.0 [8.0, 8.0]", "met"))
        self.assertEqual(table("psnr", six)[-1], "| room1 | +4.3 [+4.3, +4.3] | tdpt: met |")
        self.assertEqual(gain_of(measured(3, 0)), ("4.0 [4.0, 4.0]", "missed"))

    def test_say_where_noise_decides(self):
        self.assertIn("within the noise", gain_of(measured(4, 0.6))[1])

    def test_of_errors_below_zero_have_no_lower_end(self):
        lines, rows = measured(4, 0.6)
        rows[0]["relmse"] = "-20"
        self.assertIn("[0, ", gain_of((lines, rows))[0])

    def test_intervals_hold_the_truth_and_no_other_value(self):
        # 95 % of 50 rooms; 41 is four standard deviations away.
        text = "\n".join(table("gains", measured(4.5, 0.7, scenes=50)))
        ends = np.array(re.findall(r"\| [0-9.]+ \[([0-9.]+), ([0-9.]+)\]", text), dtype=float)
        self.assertEqual(len(ends), 50)
        held = lambda truth: np.count_nonzero((ends[:, 0] <= truth) & (truth <= ends[:, 1]))
        self.assertGreaterEqual(held(6), 41)
        self.assertLess(held(10), 41)
        self.assertTrue(1.3 < np.median(ends[:, 1] / ends[:, 0]) < 3)


class Words(unittest.TestCase):
    def test_best(self):
        self.assertEqual(table("best", measured(4, 0), "room1"), ["tdpt"])
        lines, rows = measured(4, 0)
        self.assertEqual(table("best", (lines, [r for r in rows if r["integrator"] == "bdpt"]), "room1"), [""])

    def test_check_finds_two_per_cent(self):
        lines, rows = measured(4, 0)
        self.assertIn("they agree", table("check", (lines, rows), "room1")[0])
        for row in rows:
            if row["integrator"] == "bdpt":
                row["mean"] = str(1.02 * float(row["mean"]))
        self.assertIn("THEY DISAGREE", table("check", (lines, rows), "room1")[0])
        self.assertIn("not rendered often enough", table("check", (lines, rows[:4]), "room1")[0])

    def test_means_have_the_error_they_scatter_by(self):
        # Pictures of 100 samples scatter by 0.0003; eight of them and the reference of 2000 by 0.0001.
        row = next(line for line in table("scene", measured(4, 0), "room1") if line.startswith("| bdpt "))
        mean, error = map(float, re.search(r"([0-9.]+) \+- ([0-9.]+)", row).groups())
        self.assertLess(abs(mean - 1), 0.0004)
        self.assertEqual(error, 0.0001)

    def test_long_pictures_are_asked_each(self):
        data = measured(4, 0, seconds="60")
        row = table("long", data, "room1", seconds="60")[1]
        self.assertRegex(row, r"^\| tdpt \| 2(, 2){7} \| 3.0 \| at most 0.04 \(0.02\), every seed \| missed \|$")
        for r in data[1]:
            r["relmse"] = "0.03"
        self.assertIn("| met |", table("long", data, "room1", seconds="60")[1])

    def test_busy_machines_are_told(self):
        data = measured(4, 0)
        self.assertEqual(table("busy", data), [])
        for r in data[1]:
            r["cpu_seconds"] = "2.5"
        self.assertEqual(table("busy", data), ["The machine was busy: on average a picture got 2.5 of its 4 CPU seconds."])

    def test_targets_against_the_best_other(self):
        lines, rows = measured(6, 0)
        lines = [line.replace("\t5\t9\t", "\tothers\t-\t") for line in lines]
        self.assertEqual(table("gains", (lines, rows))[2],
                         "| room1 | 8.0 [8.0, 8.0] | 0.9 x the best other | tdpt: met: 8.0 [8.0, 8.0] x bdpt |")

    def test_points_and_the_papers_row(self):
        data = measured(4, 0)
        self.assertEqual(table("means", data, "room1", "tdpt"), ["3 2 2 2"])
        self.assertEqual(table("means", data, "room1", "auto"), [])
        self.assertEqual(table("paper", data, "room1"), ["+4.3 dB | 40 % against 50 %"])


if __name__ == "__main__":
    unittest.main()
