"""Statistics against tables, closed forms and their promise, tables on made-up measurements whose answer is known, and
files against OpenEXR's reader. Each check has a twin: a planted fault that it must see."""
import itertools
import math
import shutil
import subprocess
import tempfile
import types
import unittest
from pathlib import Path

import numpy as np

import cost
import efficiency_tables
import formats
import promises
import public_files
import sky
import speed
import stats
import work_model
from common import Halves, turns


class Student(unittest.TestCase):
    def test_quantiles_are_those_of_the_tables(self):
        for df, t in ((1, 12.706), (2, 4.303), (3, 3.182), (7, 2.365), (15, 2.131), (30, 2.042), (120, 1.980)):
            self.assertAlmostEqual(stats.t_quantile(0.025, df), t, delta=5e-4)
        self.assertAlmostEqual(stats.t_quantile(0.005, 7), 3.499, delta=5e-4)
        self.assertAlmostEqual(stats.t_tail(1.96, 10000), stats.normal_tail(1.96), places=4)
        self.assertAlmostEqual(stats.normal_tail(1.959964), 0.025, places=7)


def share_held(truth, ratios, n, tail=None, cases=150):
    """Of the intervals of the geometric mean of these ratios of two means of n values that hold `truth`."""
    rng, held = np.random.default_rng(7), 0
    for _ in range(cases):
        pairs = [(ratio * rng.lognormal(0, 0.5, n), rng.lognormal(0, 0.5, n)) for ratio in ratios]
        low, high = stats.interval(pairs, rng, tail)
        held += low <= truth <= high
    return held / cases


class Bootstrap(unittest.TestCase):
    # 95 % of 150: one standard deviation is 1.8 %.
    def test_intervals_hold_the_ratio_as_often_as_they_say_and_no_other_value(self):
        for ratios, n in (((2,), 4), ((1, 2, 4), 6)):
            self.assertGreater(share_held(2, ratios, n), 0.92)
            self.assertLess(share_held(3, ratios, n), 0.92)

    def test_twin_plain_percentiles_of_few_values_do_not(self):
        self.assertLess(share_held(2, (2,), 4, 0.025), 0.92)

    def test_ends_without_bound_and_what_is_not_known(self):
        rng, ones, mixed = np.random.default_rng(1), np.ones(4), np.array([-3.0, 1, 1, 2])
        self.assertEqual(stats.interval([(ones, ones)], rng), (1, 1))
        self.assertEqual(stats.interval([(mixed, ones)], rng)[0], 0)
        self.assertEqual(stats.interval([(ones, ones), (ones, mixed)], rng)[1], stats.NO_BOUND)
        self.assertTrue(math.isnan(stats.geometric([(ones, ones), (-ones, ones)]).value))
        self.assertEqual(stats.ratio(ones[:1], ones).text("%.1f".__mod__), "1.0")
        self.assertEqual(stats.ratio(ones, ones).text("%.1f".__mod__), "1.0 [1.0, 1.0]")


class Means(unittest.TestCase):
    def test_differences_in_standard_errors(self):
        z = stats.in_errors((np.array([3.0, 1.0]), np.array([3.0, 0.0])), (np.array([-2.0, 1.0]), np.array([4.0, 0.0])))
        np.testing.assert_allclose(z, [1, 0])

    def test_weighted_means_take_long_pictures_for_many_short_ones(self):
        rng = np.random.default_rng(3)
        weights = rng.integers(1, 200, 3000)
        mean, variance = stats.weighted_mean(rng.normal(1, 0.5 / np.sqrt(weights)), weights)
        self.assertAlmostEqual(mean, 1, delta=0.01)
        self.assertAlmostEqual(variance, 0.25, delta=0.03)

    def test_shares_and_turns(self):
        share = stats.wilson(90, 100)
        np.testing.assert_allclose((share.low, share.high), (0.826, 0.945), atol=0.001)
        self.assertEqual([m for _, m in turns((1, 2, 3), "ab")], list("abbaab"))


# ---- efficiency ----
def measured(factor, spread=0.0, scenes=1, kind="door", **others):
    """bdpt's relMSE is 8 and tdpt's 8 / factor on average over many seeds, of eight of which each is off by up to
    `spread` of it; tdpt takes half the samples, and 1 s less than bdpt's 4 s. others: more integrators by name, and the
    factor of their relMSE to tdpt's."""
    rng, rows, of = np.random.default_rng(20261121), [], []
    for name in (f"room{s}" for s in range(1, scenes + 1)):
        of.append(efficiency_tables.Scene(name, 32, 24, kind, 5, 9, {"means": [0.9999, 1.0001], "relmse": 0.001}))
        for seed in range(1, 9):
            off, mean = 1 + spread * rng.uniform(-1, 1, 2), 1 + 0.0005 * rng.uniform(-1, 1)
            for values in (("bdpt", 100, 4, 8 * off[0], mean), ("tdpt", 50, 3, 8 / factor * off[1], 1)):
                row = dict(zip("integrator spp cpu_seconds relmse mean".split(), values))
                rows.append({"scene": name, "seed": seed, "seconds": 4.0, **row})
    rows += [{**r, "integrator": name.replace("_", "-"), "relmse": by * r["relmse"]} for name, by in others.items()
             for r in rows if r["integrator"] == "tdpt"]
    return of, rows


def lines(table, data, *which):
    return getattr(efficiency_tables.Measurements(*data, 4.0), table)(*which).splitlines()


def gain_of(data):
    """The gain of tdpt and whether it meets the target of 5, of the first room."""
    cells = [c.strip() for c in lines("gains", data, "doors")[2].split("|")]
    return cells[2], cells[4].removeprefix("tdpt: ")


def times(rows, field, factor, **which):
    """Changes a field of some rows."""
    for row in rows:
        if which.items() <= row.items():
            row[field] *= factor


class Efficiency(unittest.TestCase):
    def test_gains_without_noise_are_what_they_are_and_noise_is_told(self):
        self.assertEqual(gain_of(measured(6)), ("8.0 [8.0, 8.0]", "met"))
        self.assertEqual(gain_of(measured(3)), ("4.0 [4.0, 4.0]", "missed"))
        scenes, rows = measured(4, 0.6)
        self.assertIn("within the noise", gain_of((scenes, rows))[1])
        rows[0]["relmse"] = -20
        self.assertIn("[0, ", gain_of((scenes, rows))[0])

    def test_gains_are_over_the_older_program_or_the_better_base(self):
        self.assertEqual(lines("gains", measured(6, bdpt_before=2), "doors")[2],
                         "| room1 | 0.25 [0.25, 0.25] | 2.0 [2.0, 2.0] | 5 (9) | tdpt: missed | 0.0312 |")
        for factor, base, gain in ((2, "nee", "2.0 [2.0, 2.0]"), (20, "bdpt", "8.0 [8.0, 8.0]")):
            data = measured(6, kind="open", nee=factor)
            self.assertIn(f"| {gain} |", lines("gains", data, "rooms")[2])
            self.assertEqual(efficiency_tables.Measurements(*data, 4.0).base("room1"), base)
        self.assertEqual(lines("gains", data, "doors"), [])  # each table has its own scenes

    def test_geometric_mean_of_interiors(self):
        data = measured(6, scenes=2, kind="interior")
        times(data[1], "relmse", 4, scene="room2", integrator="tdpt")
        self.assertEqual(lines("gains", data, "rooms")[-1], "| **geometric mean of 2 interiors** | 1.0 | 4.0 | 2.5 | tdpt: met | - |")
        times(data[1], "relmse", -1, scene="room1", integrator="tdpt")  # where one gain is unknown, so is the mean
        self.assertIn("of 2 interiors** | 1.0 | - |", lines("gains", data, "rooms")[-1])

    def test_agreement_finds_two_per_cent_and_noisy_references_are_told(self):
        scenes, rows = measured(4)
        told = lambda of: lines("agreement", (scenes, of))
        self.assertRegex(told(rows)[0], r"in 1 of 1 scenes; the largest difference is [+-][0-2]\.\d standard errors, in room1\.$")
        times(rows, "mean", 1.02, integrator="bdpt")
        self.assertIn("**They disagree in room1.**", told(rows)[0])
        self.assertEqual(told(rows[:4]), [])
        self.assertEqual(lines("noisy", (scenes, rows)), [])
        scenes[0].reference["relmse"] = 0.21
        self.assertTrue(lines("noisy", (scenes, rows))[0].endswith("judge: room1."))

    def test_busy_machines_and_points(self):
        m = efficiency_tables.Measurements(*measured(4), 4.0)
        self.assertEqual(m.points(), {("room1", "bdpt"): [(4, 8, 8, 8)], ("room1", "tdpt"): [(3, 2, 2, 2)]})
        self.assertEqual(m.busy(), "")
        times(m.rows["room1", "bdpt"] + m.rows["room1", "tdpt"], "cpu_seconds", 0.5)
        self.assertIn("got 1.75 of its 4 CPU seconds", m.busy())


# ---- sky ----
# CPU s and relMSE of each method: nee is the better without portals, gains 2, 5, 10, 8.
METHODS = {"bdpt": (4, 0.5), "nee": (1, 1), "windows": (1, 0.5), "aimed": (1, 0.2), "guided": (4, 0.025),
           "auto": (2.5, 0.05)}
ROOMS = {"window": "windows", "corner": "windows", "behind": "second", "kitchen": "interiors"}


def cells(factor=None, seeds=6, noise=0.02):
    """factor: {(room, sky): by which the errors of methods with portals are smaller}. The machine is twice as slow for
    some seeds."""
    rng, made = np.random.default_rng(3), {}
    for room, light in itertools.product(ROOMS, ("overcast", "sun")):
        cell = made[room, light] = sky.Cell({"relmse": 0.9, "psnr": 10.5}, 2, group=ROOMS[room], portals=2)
        for seed, (method, (cpu, relmse)) in itertools.product(range(1, seeds + 1), METHODS.items()):
            by = 1 if method in sky.WITHOUT else (factor or {}).get((room, light), 1)
            error, busy = relmse / by * rng.lognormal(0, noise), 2 if seed % 3 == 0 else 1
            cell.pictures[method].append(sky.Picture(cpu * busy, error, error / 10, 100))
    return made


class Sky(unittest.TestCase):
    def test_time_and_error_count_against_the_better_without(self):
        cell = cells()["window", "sun"]
        self.assertEqual(cell.base(), "nee")
        for method, gain in (("windows", 2), ("aimed", 5), ("guided", 10), ("auto", 8)):
            self.assertAlmostEqual(cell.gain(method).value, gain, delta=0.05 * gain)
        self.assertAlmostEqual(cells(noise=0)["window", "sun"].error("nee")[1], 10 * math.log10(4 / 0.1))

    def test_a_geometric_mean_is_of_its_rooms_alone_and_of_what_is_known(self):
        made = cells({("window", "overcast"): 4, ("behind", "overcast"): 100, ("window", "sun"): -1})
        of = lambda *which: sky.geometric_mean(sky.select(made, *which), "windows").value
        self.assertAlmostEqual(of("windows", "overcast"), 2 * math.sqrt(4), delta=0.2)
        self.assertAlmostEqual(of("second"), 20, delta=1)
        # of the corner alone: the other's error hides in noise
        self.assertAlmostEqual(of("windows", "sun"), 2, delta=0.1)


# ---- Promises ----
class TargetError(unittest.TestCase):
    def row(self, better=1.5, told=1.0):
        rng, pictures = np.random.default_rng(3), []
        for relmse in 0.02 / better * rng.lognormal(0, 0.1, 100):
            e = told * relmse
            pictures.append(promises.Picture(relmse, 64, e, e / 1.2, e * 1.2, 16, e <= 0.02))
        return promises.target_row("a", 768, 0.02, pictures)

    def test_good_pictures_keep_the_word_and_twins_too_few_too_good_and_not_told_do_not(self):
        good = self.row()
        self.assertEqual((good[4], good[6], good[7], good[-3:]), ("100 % [96, 100]", "64", "25 %", ["0, 0", 0, "yes"]))
        self.assertAlmostEqual(float(good[5].split()[0]), 1.5, delta=0.05)
        self.assertRegex(self.row(better=1.05, told=0.5)[-3], r"^[1-9]\d, 0$")
        self.assertEqual([self.row(better=1.05)[-1], self.row(better=3)[-1]], ["no", "no"])
        self.assertGreater(self.row(told=2)[-2], 50)


# Costs: bdpt 1000, nee 2000, tdpt-guided 250 [ns]; pt, whose pictures are all black, has none. 8 samples of 1000 pixels
# at 200 ns are 1.6 ms.
REGRET = """truth\troom\tbdpt\t10\t0.1\t100
truth\troom\tnee\t40\t0.1\t50
truth\troom\ttdpt-guided 0.5 0.4 1\t1.25\t0.1\t200
truth\troom\tpt\t1\t0\t20
told\troom\t8\t1\tbdpt\t9\t100
told\troom\t8\t1\tnee\t40\t50
told\troom\t8\t1\ttdpt-guided 0.5 0.4 1\t1.5\t200
choice\troom\t8\t1\ttdpt-guided 0.5 0.4 1\t0.0004\t10\t1000\t3\t2\t5\ttdpt-guided 0.5 0.4 1\tbdpt
choice\troom\t8\t2\tnee\t0.0004\t10\t1000\t3\t2\t3.5\ttdpt-guided 0.5 0.4 1\tbdpt""".splitlines()


class Regret(unittest.TestCase):
    def test_efficiency_is_that_of_the_choice_less_its_time_and_gains_are_those_of_portals(self):
        scene = promises.read_regret(REGRET)["room"]
        np.testing.assert_allclose(scene.efficiencies(8), [
            (4 * 1.6 / 2.0, 1.6 / 2.0), (1000 / 2000 * 0.4 / 0.8, 250 / 2000 * 0.4 / 0.8)])
        self.assertAlmostEqual(promises.portals_gain({i: scene.cost(i) for i in scene.truth}), 4)
        self.assertAlmostEqual(promises.portals_gain(scene.told[8, 1]), 3)
        # the paper's algorithm alone is no candidate
        self.assertIsNone(promises.portals_gain({"bdpt": 1, "tdpt": 0.1}))
        text = "\n".join(promises.regret_parts({"room": scene}).values())
        for row in ("| room | 4.00 | 0.116 | 4.00 | 3 (3 to 3) |", "estimate | 100 % |", "interval | 50 % |"):
            self.assertIn(row, text)


# ---- What things cost ----
class Cost(unittest.TestCase):
    def test_growth_and_bytes_of_a_triangle(self):
        def page(time, memory):
            return cost.scale_table([cost.Row(n, "ffgraph", time(n), memory(n) / cost.MIB)
                                     for n in (10**3, 10**5, 10**6, 10**7)])
        self.assertIn("| 5.4 |", page(lambda n: 2 + 1e-7 * n * math.log(n), lambda n: n))
        self.assertIn("| **28.8** |", page(lambda n: 0.1 + 1e-9 * n**1.5, lambda n: n))
        self.assertIn("too short", page(lambda n: 0.02, lambda n: n))
        self.assertIn("| 300, 320 |", page(lambda n: 0.1, lambda n: 2e8 + 300 * n))
        self.assertIn("| **390, 410** |", page(lambda n: 0.1, lambda n: 2e8 + 390 * n))

    def test_quality_is_told_over_normal_with_the_time_of_the_stages(self):
        rows = [cost.Quality(scene, quality, cpu * slower, 100 * cpu, 1, 0.2 * worse * (1 + 0.01 * seed))
                for scene, slower in (("a", 1), ("b", 4)) for seed in range(1, 5)
                for quality, cpu, worse in (("draft", 1, 2), ("normal", 4, 1), ("high", 8, 0.5))]
        draft = cost.quality_of(rows)["draft"]
        self.assertEqual((draft[0], draft[1]), (2.5, 100))
        self.assertTrue(draft[2].low < 2 < draft[2].high)
        np.testing.assert_allclose(draft[3], [math.sqrt((1 + 2 * r) * (4 + 2 * r)) for r in cost.RENDERS])
        self.assertIn("\n| normal | 10.0 | 400 | 1.00 | ", cost.quality_table(rows))
        self.assertIn('title "b"', cost.quality_plot(rows))


class Limit(unittest.TestCase):
    def frames(self, *changes):
        """Of what limit_bench prints, a line for each change."""
        usual = dict(scene="a/a.glb", integrator="bdpt", threads=1, seed=1, samples=100, closest=700, shadow=500, rays=1200,
                     other=0, frame_cpu=3.0, raw_cpu=1.5, frame_wall=3.0, raw_wall=1.5)
        return speed.frames_of("\n".join("\t".join(map(str, {**usual, **change}.values())) for change in changes))

    def test_the_factor_is_the_median_over_seeds_and_held_against_what_is_wanted(self):
        row = speed.factor_rows(self.frames({}, {"seed": 2, "frame_cpu": 6.0}, {"seed": 3, "frame_cpu": 4.5}))[0]
        self.assertEqual(row, ("a", "`bdpt`", "12.0", "42 %", "45000000", "1250000", "3.00 (2.00 to 4.00)", "1.6: **missed**"))
        self.assertEqual(speed.factor_rows(self.frames({"integrator": "nee"}))[0][-1], "-")

    def test_shares_of_a_profile(self):
        shares = speed.shares(speed.profile_of([
            "50|libembree3.so.3|[.] 0x0021f4686", "  3,0|tdpt-render|[.] tdpt::Path::weight_by_products",
            "15|tdpt-render|[.] tdpt::Resampling::choose", "5|[kernel.kallsyms]|[k] exc_page_fault"]))
        for part, share in (("Embree", 50), ("weights, densities of paths", 30), ("memory, files, system", 5)):
            self.assertAlmostEqual(shares[part], share)

    def test_twins_rays_that_end_otherwise_or_are_missing_are_refused(self):
        for wrong, words in (({"other": 3}, "3 rays ended otherwise"), ({"rays": 1199}, "missing from the record")):
            with self.assertRaisesRegex(ValueError, words):
                self.frames(wrong)


class References(unittest.TestCase):
    def test_noise_of_the_halves_is_in_no_error(self):
        rng, truth = np.random.default_rng(1), np.full((64, 64, 3), 2.0)
        a, b = (truth + rng.normal(0, 0.5, truth.shape) for _ in range(2))
        x = truth + rng.normal(0, 0.1, truth.shape)
        measures = "relmse", "mse", "mape", "mean", "reference_mean", "black", "peak"
        exrdiff = types.SimpleNamespace(distance=lambda p, q: dict.fromkeys(measures, ((p - q) ** 2).mean()))
        self.assertAlmostEqual(Halves(exrdiff, a, b).off(x)["mse"], 0.01, delta=0.008)
        self.assertGreater(Halves(exrdiff, a, a).off(x)["mse"], 0.2)  # twin: one half alone

    def test_scenes_of_quality_have_some(self):
        for scene in cost.ROOMS:
            self.assertTrue((cost.REFERENCES / f"{scene}.json").exists())


# ---- The model of work ----
class WorkModel(unittest.TestCase):
    def lines(self, costs, noise, scenes=5):
        """Of work_model_bench: depth 3, 6 and 12, closest hits deeper in later scenes."""
        rng, out = np.random.default_rng(2), ["\t".join([*work_model.KEYS, "sample", "closest", "deeper", "shadow"])]
        for scene, depth, integrator in itertools.product(range(scenes), (3, 6, 12), "abcdef"):
            closest, shadow = depth * rng.uniform(0.5, 2, 2)
            terms = np.array([1, closest, closest * 3 * scene, shadow])
            time = terms @ costs * rng.uniform(1 - noise, 1 + noise)
            out.append("\t".join(map(str, (f"room{scene}", depth, integrator, 1, float(time), *map(float, terms)))))
        return out

    def fitted(self, lines, hide=None):
        names, rows = work_model.read_work(lines)
        terms = np.array([[0 if n == hide else t for n, t in zip(names, row)] for _, row in rows[1]])
        measured_times = np.array([float(keys["nanoseconds"]) for keys, _ in rows[1]])
        costs = work_model.fit(terms, measured_times)
        return costs, np.max(np.abs(terms @ costs / measured_times - 1))

    def test_fit_finds_the_costs_again_and_noise_averages_out_but_no_missing_term(self):
        costs = np.array([40, 190, 25, 300])
        np.testing.assert_allclose(self.fitted(self.lines(costs, 0))[0], costs, rtol=1e-6)
        noisy = self.lines(costs, 0.02)
        self.assertLess(self.fitted(noisy)[1], 0.06)
        self.assertGreater(self.fitted(noisy, hide="shadow")[1], 0.06)  # twin
        with self.assertRaisesRegex(ValueError, "more scenes"):
            self.fitted(self.lines(costs, 0, scenes=1)[:3])
        with self.assertRaisesRegex(ValueError, "line 3: expected 4 terms"):
            work_model.read_work([*noisy[:2], "room\t6\tbdpt\t1\t100"])


# ---- Files ----
class Pictures(unittest.TestCase):
    def test_are_read_back_as_they_were(self):
        rng = np.random.default_rng(5)
        for shape in ((1, 1, 3), (16, 8, 3), (37, 20, 3)):
            for rgb in (np.arange(np.prod(shape)).reshape(shape), rng.uniform(0, 60000, shape), np.zeros(shape)):
                content = formats.exr_content(rgb)
                np.testing.assert_array_equal(formats.exr_parse(content), rgb.astype(np.float16).astype(float))
        with self.assertRaisesRegex(ValueError, "expected channels B G R"):
            formats.exr_parse(content.replace(b"R\0", b"S\0", 1))

    def test_are_float_beyond_the_range_of_half(self):
        rgb = np.full((20, 10, 3), 0.1)
        rgb[3, 4] = 467000.25, 65504, 65505
        picture = formats.exr_parse(formats.exr_content(rgb))
        np.testing.assert_array_equal(picture[3, 4], [467000.25, 65504, 65505])
        np.testing.assert_array_equal(picture[0, 0], np.float16(0.1))

    def test_are_read_by_openexr(self):
        if not shutil.which("exrmaketiled"):
            self.skipTest("no exrmaketiled here (Debian: openexr)")
        with tempfile.TemporaryDirectory() as folder:
            for most in (100, 1e6):
                formats.exr_write(f"{folder}/a.exr", np.random.default_rng(3).uniform(0, most, (40, 30, 3)))
                subprocess.run(["exrmaketiled", f"{folder}/a.exr", f"{folder}/tiled.exr"], check=True)


class Glb(unittest.TestCase):
    def test_portals_can_be_read_back_and_look_along_edge_x_edge(self):
        document, binary = formats.glb_parse(formats.portals_glb([((1, 2, 3), (0, 0, 2), (0, 4, 0))] * 2))
        self.assertEqual([n["name"] for n in document["nodes"]], ["portal.0", "portal.1"])
        primitive = document["meshes"][1]["primitives"][0]
        corners = formats.gltf_array(document, binary, primitive["attributes"]["POSITION"])
        np.testing.assert_array_equal(corners, [(1, 2, 3), (1, 2, 5), (1, 6, 5), (1, 6, 3)])
        a, b, c = corners[formats.gltf_array(document, binary, primitive["indices"]).ravel()[:3]]
        self.assertLess(np.cross(b - a, c - a)[0], 0)  # the light goes along z x y = -x


class ManyTriangles(unittest.TestCase):
    def test_are_as_many_as_asked_for_and_the_same_surface_the_same_way_round(self):
        triangles = np.random.default_rng(3).normal(size=(4, 3, 3))
        normals = lambda t: np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
        for n in (1, 2, 5):
            fine = cost.cut(triangles, n)
            self.assertEqual(len(fine), 4 * n * n)
            np.testing.assert_allclose(n * n * normals(fine), np.repeat(normals(triangles), n * n, 0), atol=1e-12)
            inside = np.linalg.solve(triangles[0].T, fine[: n * n].reshape(-1, 3).T)  # weights of the corners
            np.testing.assert_allclose(inside.sum(0), 1)
            self.assertGreater(inside.min(), -1e-12)
        with tempfile.TemporaryDirectory() as folder:
            made = cost.write_scene(20000, f"{folder}/room.glb")
            document, _ = formats.glb_parse(Path(f"{folder}/room.glb").read_bytes())
            self.assertLess(abs(made / 20000 - 1), 0.1)
            self.assertEqual(3 * made, sum(document["accessors"][m["primitives"][0]["attributes"]["POSITION"]]["count"]
                                           for m in document["meshes"]))


class PublicFiles(unittest.TestCase):
    def test_copies_and_pointers_are_left_out(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("one.gltf", "{}"), ("three.glb", "glTF"), ("two.GLB", "glTF"), ("no.txt", "x"),
                               ("pointer.glb", public_files.POINTER.decode() + "/spec/v1\n")):
                (Path(folder) / name).write_text(text)
            self.assertEqual(sorted(Path(p).name for p in public_files.scenes(folder)), ["one.gltf", "three.glb"])


if __name__ == "__main__":
    unittest.main()
