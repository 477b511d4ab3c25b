"""efficiency_tables.py on made-up measurements whose gains are known."""
import contextlib
import io
import re
import unittest

import numpy as np

import efficiency_tables

COLUMNS = "scene,integrator,seed,seconds,spp,cpu_seconds,relmse,psnr,mape,mean,mse,peak_mib".split(",")


def measured(factor, spread, scenes=1, seconds="4"):
    """bdpt's relMSE is 8 and tdpt's 8 / factor on average over many seeds, of eight of which each is off by up to
    `spread` of it; tdpt takes half the samples, and 1 s less than bdpt's 4 s."""
    rng, rows, lines = np.random.default_rng(20261121), [], []
    for s in range(1, scenes + 1):
        lines.append("\t".join(f"room{s} door 5 9 0.04 0.02 -0.3 1 0.0001 0.001 80 0.7 20 90 bdpt 2000".split()))
        for seed in range(1, 9):
            off = 1 + spread * rng.uniform(-1, 1, 2)
            mean = 1 + 0.0005 * rng.uniform(-1, 1)
            for values in ((f"room{s}", "bdpt", seed, seconds, 100, 4, 8 * off[0], 20, 50, mean, 0.01, 60 + seed),
                           (f"room{s}", "tdpt", seed, seconds, 50, 3, 8 / factor * off[1], 23, 40, 1, 0.005, 70)):
                rows.append(dict(zip(COLUMNS, map(str, values))))
    return lines, rows


def renamed(data, kind, **others):
    """Its scenes are of `kind`; and with more rows, by other integrators, name: factor of tdpt's relMSE and MSE."""
    lines, rows = data
    more = []
    for name, factor in others.items():
        for r in (r for r in rows if r["integrator"] == "tdpt"):
            errors = {e: str(factor * float(r[e])) for e in ("relmse", "mse")}
            more.append({**r, "integrator": name.replace("_", "-"), **errors})
    return [line.replace("\tdoor\t", f"\t{kind}\t") for line in lines], rows + more


def read(lines, rows, seconds="4"):
    text = "\n".join([",".join(COLUMNS), *(",".join(r.values()) for r in rows)])
    return efficiency_tables.read(lines, io.StringIO(text), seconds)


def table(name, data, *which, seconds="4"):
    """The lines that are printed."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        efficiency_tables.TABLES[name](read(*data, seconds), *which)
    return out.getvalue().splitlines()


def gain_of(data):
    """The gain of tdpt and whether it meets the target of 5, of the first room."""
    cells = [c.strip() for c in table("gains", data, "doors")[2].split("|")]
    return cells[2], cells[4].removeprefix("tdpt: ")


class Gains(unittest.TestCase):
    def test_without_noise_are_what_they_are(self):
        six = measured(6, 0)
        self.assertEqual(gain_of(six), ("8.0 [8.0, 8.0]", "met"))
        self.assertEqual(table("psnr", six, "doors")[-1], "| room1 | +4.3 [+4.3, +4.3] | -0.3 | tdpt: met |")
        higher = [line.replace("-0.3", "5") for line in six[0]], six[1]
        self.assertTrue(table("psnr", higher, "doors")[-1].endswith("| 5 | tdpt: missed |"))
        self.assertEqual(gain_of(measured(3, 0)), ("4.0 [4.0, 4.0]", "missed"))

    def test_say_where_noise_decides(self):
        self.assertIn("within the noise", gain_of(measured(4, 0.6))[1])

    def test_of_errors_below_zero_have_no_lower_end(self):
        lines, rows = measured(4, 0.6)
        rows[0]["relmse"] = "-20"
        self.assertIn("[0, ", gain_of((lines, rows))[0])

    def test_intervals_hold_the_truth_and_no_other_value(self):
        # 95 % of 50 rooms; 41 is four standard deviations away.
        text = "\n".join(table("gains", measured(4.5, 0.7, scenes=50), "doors"))
        ends = np.array(re.findall(r"\| [0-9.]+ \[([0-9.]+), ([0-9.]+)\]", text), dtype=float)
        self.assertEqual(len(ends), 50)
        held = lambda truth: np.count_nonzero((ends[:, 0] <= truth) & (truth <= ends[:, 1]))
        self.assertGreaterEqual(held(6), 41)
        self.assertLess(held(10), 41)
        self.assertTrue(1.3 < np.median(ends[:, 1] / ends[:, 0]) < 3)


class Bases(unittest.TestCase):
    """What gains are over. tdpt costs 1 / 8 of bdpt, the others multiples of tdpt."""

    def test_are_the_older_programs_where_it_was_measured(self):
        head, _, row = table("gains", renamed(measured(6, 0), "door", bdpt_before=2), "doors")
        self.assertEqual(head, "| scene | bdpt | tdpt | aim (moonshot) | met | efficiency of bdpt-before [1/s] |"
                               " efficiency of bdpt [1/s] |")
        self.assertEqual(row, "| room1 | 0.25 [0.25, 0.25] | 2.0 [2.0, 2.0] | 5 (9) | tdpt: missed | 0.125 | 0.0312 |")

    def test_in_rooms_are_the_better_of_bdpt_and_nee(self):
        for factor, base, gain in ((2, "nee", "2.0 [2.0, 2.0]"), (20, "bdpt", "8.0 [8.0, 8.0]")):
            data = renamed(measured(6, 0), "open", nee=factor)
            self.assertIn(f"| {gain} |", table("gains", data, "rooms")[2])
            self.assertIn(f"| PSNR - that of {base} |", table("scene", data, "room1")[3])
        # Behind a door it is bdpt, and each table has its own scenes.
        self.assertIn("| 8.0 [8.0, 8.0] |", table("gains", renamed(measured(6, 0), "door", nee=2), "doors")[2])
        self.assertEqual(table("gains", data, "doors") + table("psnr", data, "whole"), [])

    def test_over_itself_have_no_interval_within_a_geometric_mean(self):
        # nee is the base of one room and 4 times worse than bdpt in the other.
        lines, rows = renamed(measured(6, 0.5, scenes=2), "interior", nee=4)
        for r in rows:
            if r["scene"] == "room2" and r["integrator"] == "nee":
                r["relmse"] = str(8 * float(r["relmse"]))
        m = read(lines, rows)
        mean, gain = m.geometric_mean(["room1", "room2"], "nee"), m.over_base("room2", "nee")
        self.assertEqual((m.base("room1"), m.base("room2")), ("nee", "bdpt"))
        np.testing.assert_allclose((mean.value, mean.low, mean.high), np.sqrt((gain.value, gain.low, gain.high)))

    def test_without_limit_are_this_programs(self):
        head, _, row = table("gains", renamed(measured(6, 0), "whole"), "whole")
        self.assertNotIn("before", head)
        self.assertIn("| 8.0 [8.0, 8.0] |", row)

    def test_geometric_mean_and_least_of_interiors(self):
        lines, rows = renamed(measured(6, 0, scenes=2), "interior")
        for r in rows:
            if r["scene"] == "room2" and r["integrator"] == "tdpt":
                r["relmse"] = str(4 * float(r["relmse"]))
        mean, low = table("gains", (lines, rows), "rooms")[-2:]
        self.assertEqual(mean, "| **geometric mean of 2 interiors** | 1.0 | 4.0 [4.0, 4.0] | 2.5 | tdpt: met | - |")
        self.assertEqual(low, "| **the least of them** | 1.0 (room1) | 2.0 (room2) | - | - | - |")
        # Scenes that are no interiors are not in it.
        lines[1] = lines[1].replace("interior", "open")
        self.assertIn("of 1 interiors** | 1.0 | 8.0 [8.0, 8.0] |", table("gains", (lines, rows), "rooms")[-2])
        # Where one gain is unknown, so is the mean.
        for r in rows:
            if r["scene"] == "room1" and r["integrator"] == "tdpt":
                r["relmse"] = "-1"
        self.assertIn("of 1 interiors** | 1.0 | - |", table("gains", (lines, rows), "rooms")[-2])

    def test_that_are_hidden_by_noise_are_told(self):
        lines, rows = renamed(measured(6, 0), "interior")
        for r in rows:
            if r["integrator"] == "bdpt":
                r["relmse"] = "-1"
        self.assertIn("| room1 | 1 | - | 5 (9) | tdpt: - | - |", table("gains", (lines, rows), "rooms"))
        self.assertIn("at most a tenth of the 0.04 that", table("scene", (lines, rows), "room1")[0])

    def test_bdpt_made_worse_shows(self):
        data = measured(6, 0)
        self.assertTrue(table("gains", data, "doors")[2].endswith("| 0.0312 |"))
        for r in data[1]:
            if r["integrator"] == "bdpt":
                r["relmse"] = str(2 * float(r["relmse"]))
        self.assertTrue(table("gains", data, "doors")[2].endswith("| 0.0156 |"))


class References(unittest.TestCase):
    """relMSE 0.001 of the reference; wanted after a minute: 0.04; bdpt 8 after 4 s."""

    def test_are_told_from_a_tenth_of_what_they_judge(self):
        lines, rows = measured(6, 0)
        self.assertEqual(table("scene", (lines, rows), "room1")[0],
                         "relMSE 0.001, at most a tenth of the 0.04 that it judges.")
        self.assertEqual(table("noisy", (lines, rows)), [])
        lines = [line.replace("0.001", "0.0041") for line in lines]
        self.assertIn("MORE THAN a tenth of the 0.04", table("scene", (lines, rows), "room1")[0])
        self.assertTrue(table("noisy", (lines, rows))[0].endswith("judge: room1."))

    def test_judge_the_aimed_gain(self):
        # 8 x 4 s / 5 in the 3 s of tdpt; an interior's 2.5; no aim: as bdpt.
        for kind, target, relmse in (("door", "5", 2.13), ("interior", "1", 4.27), ("open", "-", 10.7)):
            lines, rows = renamed(measured(6, 0), kind)
            lines = [line.replace("\t5\t9\t0.04\t0.02", f"\t{target}\t-\t-\t-") for line in lines]
            self.assertIn(f"tenth of the {relmse} that", table("scene", (lines, rows), "room1")[0])


class Words(unittest.TestCase):
    def test_pair(self):
        self.assertEqual(table("pair", measured(4, 0), "room1"), ["tdpt bdpt"])
        lines, rows = measured(4, 0)
        self.assertEqual(table("pair", (lines, [r for r in rows if r["integrator"] == "bdpt"]), "room1"), ["bdpt"])
        # Aims are asked of auto, be it worse, and the older program's bdpt comes before this one's.
        self.assertEqual(table("pair", renamed(measured(4, 0), "door", auto=2, bdpt_before=3), "room1"), ["auto bdpt-before"])

    def test_check_finds_two_per_cent(self):
        lines, rows = measured(4, 0)
        self.assertIn("they agree", table("scene", (lines, rows), "room1")[1])
        for row in rows:
            if row["integrator"] == "bdpt":
                row["mean"] = str(1.02 * float(row["mean"]))
        self.assertIn("THEY DISAGREE", table("scene", (lines, rows), "room1")[1])
        self.assertIn("not rendered often enough", table("scene", (lines, rows[:4]), "room1")[1])

    def test_means_have_the_error_they_scatter_by(self):
        # Pictures of 100 samples scatter by 0.0003; eight of them and the reference of 2000 by 0.0001.
        row = next(line for line in table("scene", measured(4, 0), "room1") if line.startswith("| bdpt "))
        mean, error = map(float, re.search(r"([0-9.]+) \+- ([0-9.]+)", row).groups())
        self.assertLess(abs(mean - 1), 0.0004)
        self.assertEqual(error, 0.0001)

    def test_long_pictures_are_asked_each(self):
        data = measured(4, 0, seconds="60")
        base, row = table("long", data, "room1", seconds="60")
        self.assertRegex(base, r"\| 4.0 \| - \| - \|$")
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

    def test_points_and_the_papers_row(self):
        data = measured(4, 0)
        self.assertEqual(table("points", data), ["room1 bdpt 4 8 8 8", "room1 tdpt 3 2 2 2"])
        short = [{**r, "seconds": "0.25", "cpu_seconds": "0.2"} for r in data[1]]
        self.assertEqual(table("points", (data[0], data[1] + short))[1:3], ["room1 tdpt 0.2 2 2 2", "room1 bdpt 4 8 8 8"])
        self.assertEqual(table("points", data, seconds="2"), [])
        self.assertTrue(table("scene", data, "room1")[5].startswith(
            "| bdpt | 100 | 4.00 | 68 | 8 [8, 8] | 0.0312 | 1 | 20.00 | 0 |"))
        self.assertEqual(table("paper", data, "room1"), ["+4.3 dB | 40 % against 50 %"])


if __name__ == "__main__":
    unittest.main()
