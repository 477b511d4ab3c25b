"""The parts of make tradeoff on made-up data."""
import contextlib
import io
import json
import math
import os
import random
import shutil
import stat
import sys
import tempfile
import time
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy as np

import curves
import figures
import glb
import knobs
import measure
import page
import plots
from error import Reference
from store import Failed, Store


class Errors(unittest.TestCase):
    def test_noise_of_the_reference_is_in_no_error(self):
        rng = np.random.default_rng(1)
        truth = np.full((64, 64, 3), 2.0)
        a, b = (truth + rng.normal(0, 0.5, truth.shape) for _ in range(2))
        x = truth + rng.normal(0, 0.1, truth.shape)
        found = Reference(a, b).measures(x)
        self.assertAlmostEqual(found["mse"], 0.01, delta=0.008)
        # Twin: against one half alone it is lost in that half's noise.
        self.assertGreater(Reference(a, a).measures(x)["mse"], 0.2)

    def test_black_picture_has_the_error_of_the_reference_itself(self):
        r = np.full((4, 4, 3), 3.0)
        self.assertAlmostEqual(Reference(r, r).black()["relmse"], 9 / (9 + 0.09))


class Glb(unittest.TestCase):
    def test_portals_can_be_read_back(self):
        rectangle = ((1, 2, 3), (0, 0, 2), (0, 4, 0))
        document, binary = glb.parse(glb.portals([rectangle, rectangle]))
        self.assertEqual([n["name"] for n in document["nodes"]], ["portal.0", "portal.1"])
        corners = glb.array(document, binary, document["meshes"][1]["primitives"][0]["attributes"]["POSITION"])
        np.testing.assert_array_equal(corners, [(1, 2, 3), (1, 2, 5), (1, 6, 5), (1, 6, 3)])
        a, b, c = corners[glb.array(document, binary, document["meshes"][1]["primitives"][0]["indices"]).ravel()[:3]]
        self.assertLess(np.cross(b - a, c - a)[0], 0)  # the light goes along z x y = -x

    def scene(self):
        """Two squares of sides 10 and 1."""
        document, binary = glb.parse(glb.portals([((0, 0, 0), (10, 0, 0), (0, 10, 0)), ((0, 0, 1), (1, 0, 0), (0, 1, 0))]))
        for mesh in document["meshes"]:
            mesh["primitives"][0]["material"] = 0
        document["materials"] = [{}]
        return document, binary

    def test_smallest_triangles_go_first_and_never_more_area_than_told(self):
        data, dropped, of = glb.simplified(glb.content(*self.scene()), 0.011)
        self.assertEqual((dropped, of), (1, 4))  # a half of the small square; a primitive is never empty
        document, binary = glb.parse(data)
        counts = [document["accessors"][m["primitives"][0]["indices"]]["count"] for m in document["meshes"]]
        self.assertEqual(counts, [6, 3])
        # Of equals all go or none.
        self.assertEqual(glb.simplified(glb.content(*self.scene()), 0.009)[1], 0)

    def test_what_emits_stays_and_a_larger_instance_counts(self):
        document, binary = self.scene()
        document["materials"].append({"emissiveFactor": [1, 1, 1]})
        document["meshes"][1]["primitives"][0]["material"] = 1
        self.assertEqual(glb.simplified(glb.content(document, binary), 0.4)[1:], (0, 2))
        document, binary = self.scene()
        document["nodes"][1]["scale"] = [100, 100, 1]  # now it is the larger one
        self.assertEqual(glb.simplified(glb.content(document, binary), 0.011)[1], 1)


class Kept(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name)
        self.program("tool", "echo run >>log")

    def tearDown(self):
        self.folder.cleanup()

    def program(self, name, extra):
        path = self.path / name
        # The last argument is where the result goes.
        path.write_text(f'#!/bin/sh\ncd {self.path}\n{extra}\nfor o; do :; done\ncat "$1" >"$o" || exit 3\necho \'{{"a": 1}}\'\n')
        path.chmod(path.stat().st_mode | stat.S_IXUSR)

    def runs(self):
        return (self.path / "log").read_text().count("run")

    def test_what_is_there_is_not_run_again_until_content_changes(self):
        given = self.path / "in"
        given.write_text("x")
        for _ in range(2):
            run = Store(self.path / "kept", self.path).run("tool", given, "--a")
        self.assertEqual((self.runs(), run.out.read_text(), run.said), (1, "x", {"a": 1}))
        given.write_text("y")
        self.assertEqual(Store(self.path / "kept", self.path).run("tool", given, "--a").out.read_text(), "y")
        self.program("tool", "echo run >>log; true")
        Store(self.path / "kept", self.path).run("tool", given, "--a")
        self.assertEqual(self.runs(), 3)

    def test_failed_run_leaves_nothing(self):
        store = Store(self.path / "kept", self.path)
        with self.assertRaises(Failed) as caught:
            store.run("tool", "absent")
        self.assertEqual(caught.exception.status, 3)
        self.assertEqual(os.listdir(self.path / "kept"), [])
        self.assertEqual(store.run("tool", "absent", may_fail=(3,)).status, 3)


def made_up():
    """Setting a is twice as quick as the default and its portals cost 1.5 as much; b finds none in `deep`."""
    rows = []
    for scene in ("wide", "deep"):
        for seed in range(1, 6):
            noise = 1 + 0.01 * seed
            for knob, value, chain, loss in (("true", "", 0, 1), ("default", "", 4, 1), ("lightgrid --lines", "512", 2, 1.5),
                                             ("lightgrid --lines", "2048", 3, 1 if scene == "wide" else 20)):
                rows.append({"knob": knob, "value": value, "scene": scene, "seed": seed, "chain_cpu": chain, "portals": 1,
                             "relmse": 0.1 * loss * noise, "cpu": 2.0})
    rooms = [{"knob": knob, "value": value, "verdict": "ok" if i != wrong else "MISS", "kind": f"kind{i}", "seed": 1, "coverage": 1,
              "tightness": 1, "cpu": 3} for knob, value, wrong in (("default", "", 0), ("lightgrid --lines", "512", 4))
             for i in range(10)]
    return curves.PortalCurves(rows, rooms)


class Curves(unittest.TestCase):
    def test_total_holds_the_four_stages_and_what_worse_portals_cost(self):
        curve = made_up()
        quick = ("lightgrid --lines", "512")
        self.assertAlmostEqual(curve.loss(quick).value, 1.5)
        self.assertAlmostEqual(curve.total(("default", ""), 10), 14)
        self.assertAlmostEqual(curve.total(quick, 10), 17)
        self.assertAlmostEqual(curve.total(quick, 1), 3.5)
        # A scene whose portal is lost is seen.
        self.assertAlmostEqual(curve.loss(("lightgrid --lines", "2048")).value, math.sqrt(20))

    def test_intervals_hold_the_value(self):
        loss = made_up().loss(("lightgrid --lines", "512"))
        self.assertTrue(loss.low < 1.5 < loss.high)
        right = made_up().right(("default", ""))
        self.assertEqual(right.value, 0.9)
        self.assertTrue(0.5 < right.low < 0.9 < right.high < 1)
        self.assertEqual(curves.wilson(10, 10).high, 1)

    def test_rooms_lost_and_won_are_named(self):
        self.assertEqual(page.changed(made_up(), ("lightgrid --lines", "512")), "-1 kind4, +1 kind0")
        self.assertEqual(page.changed(made_up(), ("default", "")), "")

    def test_finding_pays_from_where_the_gain_has_paid_the_stages(self):
        rows = [{"knob": "integrator", "value": i, "scene": "wide", "spp": 16, "seed": s, "relmse": e, "cpu": 1, "mean": 1}
                for i, e in (("bdpt", 0.4), ("auto", 0.1), ("tdpt", 0.5)) for s in (1, 2)]
        curve = curves.PictureCurves(rows)
        self.assertAlmostEqual(curve.pays_from("wide", 3), 4)  # 4 s of bdpt are 3 + 1 s
        self.assertIsNone(curve.pays_from("wide", 3, through="tdpt"))

    def test_figures_hold_every_setting(self):
        text = figures.stage(made_up(), "lightgrid").script("x.png")
        self.assertIn('"8.19k"', text)
        self.assertIn('"512"', text)
        self.assertIn("lightgrid --lines: rooms", text)
        self.assertEqual(plots.number(float("nan")), "NaN")

    def test_knobs_that_cost_no_time_stand_by_their_values(self):
        rows = [{"knob": k, "value": v, "scene": "wide", "seed": n, "chain_cpu": 4, "portals": 1, "relmse": 0.1 * n, "cpu": 2.0}
                for k, v in (("true", ""), ("default", ""), ("portalfit --max-portals", "1")) for n in (1, 2)]
        rooms = [{"knob": "default", "value": "", "verdict": "ok", "kind": "a", "seed": 1, "cpu": 3}]
        script = figures.stage(curves.PortalCurves(rows, rooms), "portalfit").script("x.png")
        self.assertIn('set xtics ("1" 0, "8" 1)', script)
        self.assertIn("portals at most", script)
        self.assertNotIn('"512" 0', figures.stage(made_up(), "lightgrid").script("x.png"))

    def test_paths_keep_their_underscores_and_titles_show_them(self):
        figure = plots.Figure(1)
        figure.panel("a_b", "x", "y", [])
        script = figure.script("my_dir/x.png")
        self.assertIn('set output "my_dir/x.png"', script)
        self.assertIn('set title "a\\\\_b"', script)


class Tasks(unittest.TestCase):
    class Bench:
        extent = measure.Extent({"JOBS": "1", "SEEDS": "2"})

    def test_rows_come_in_order(self):
        with contextlib.redirect_stderr(io.StringIO()):
            self.assertEqual(measure.run_all(self.kept(), "name", [lambda i=i: [i] for i in range(5)]), [0, 1, 2, 3, 4])

    def test_first_failure_ends_them_all(self):
        ran = []

        def fails():
            raise Failed("no", 3)

        first = list(range(51))
        random.Random("name").shuffle(first)
        tasks = [lambda: ran.append(time.sleep(0.01)) or [] for _ in range(51)]
        tasks[first[0]] = fails
        with self.assertRaises(Failed):
            measure.run_all(self.kept(), "name", tasks)
        self.assertLess(len(ran), 10)

    def kept(self):
        bench = self.Bench()
        bench.store = Store(tempfile.mkdtemp(), ".")
        self.addCleanup(shutil.rmtree, bench.store.folder)
        return bench


class Rooms(unittest.TestCase):
    def test_rows_of_portals_bench_are_read(self):
        line = ("MISS  ajar-full        1801  portals 1/2  coverage 0.9979  tightness 0.995  angle  0.04  strays 0  lamp down    "
                "wall 0.100 in 4    scale 1  4.22 s\n      no portal\n")
        (row,) = measure.rooms_of(line)
        self.assertEqual((row["verdict"], row["kind"], row["portals"], row["openings"], row["cpu"]),
                         ("MISS", "ajar-full", "1", "2", "4.22"))


class Knobs(unittest.TestCase):
    def test_every_default_is_on_its_curve_and_quick_keeps_it(self):
        for knob in knobs.KNOBS:
            self.assertIn(knob.default, knob.values)
            self.assertIn(knob.default, measure.Extent({"QUICK": "1"}).values(knob))

    def test_scenes_without_an_opening_count_those_that_are_found(self):
        rows = [{"knob": k, "value": "", "scene": "lamps", "seed": 1, "chain_cpu": 1, "portals": n, "relmse": 1, "cpu": 1}
                for k, n in (("true", 0), ("default", 1))]
        self.assertEqual(curves.PortalCurves(rows, []).found(("default", "")).value, 0)
        rows[0]["portals"] = ""  # nobody knows
        self.assertTrue(math.isnan(curves.PortalCurves(rows, []).found(("default", "")).value))

    def test_openings_are_counted_where_they_are_known(self):
        self.assertEqual({s.name: s.openings for s in knobs.SCENES if s.name in ("three-rooms", "door-ajar", "living-room-lamps")},
                         {"three-rooms": 2, "door-ajar": "", "living-room-lamps": 0})

    def test_scenes_have_references(self):
        for scene in knobs.SCENES + knobs.OPEN:
            about = json.loads((measure.REFERENCES / f"{scene.name}.json").read_text())
            self.assertEqual(about["max_depth"], 6)


if __name__ == "__main__":
    unittest.main()
