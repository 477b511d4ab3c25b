import os
import sys
import tempfile
import unittest

import only_needed


def runs(what, scene, ratios):
    return [[what, scene, str(i), str(2 * r), "2"] for i, r in enumerate(ratios)]


class Ratios(unittest.TestCase):
    def test_are_medians_of_pairs_with_an_interval_around_the_mean(self):
        table = only_needed.ratios(runs("twin --integrator nee", "room", [1.0, 1.01, 1.02, 1.03, 9.0]))
        ratio, low, high, least = table["twin --integrator nee", "room"]
        self.assertAlmostEqual(ratio, 1.02)
        self.assertLess(low, 1.03)
        self.assertGreater(high, 2)
        self.assertEqual(least, 2)

    def test_the_interval_decides_where_it_can(self):
        def last(*ratios):
            return list(only_needed.twin_lines(runs("twin --integrator nee", "room", ratios), []))[2].split(" | ")[-1]

        self.assertEqual(last(1.01, 1.011, 1.012, 1.01), "yes |")
        self.assertEqual(last(1.05, 1.051, 1.049, 1.05), "**no** |")
        self.assertEqual(last(1.0, 1.01, 1.09, 1.01), "likely |")
        self.assertEqual(last(1.03, 1.0, 1.031, 1.032), "perhaps not |")

    def test_instructions_stand_beside(self):
        key = "twin --integrator nee", "room"
        lines = list(only_needed.twin_lines(runs(*key, [1.01] * 3), runs(*key, [1.034])))
        self.assertIn("| 1.034 |", lines[2])
        self.assertIn("| - |", list(only_needed.twin_lines(runs(*key, [1.01] * 3), []))[2])

    def test_what_is_asked_for_stands_apart_from_twins(self):
        rows = runs("--layers", "room", [1.1] * 3) + runs("twin --integrator nee", "room", [1.0] * 3)
        self.assertEqual(len(list(only_needed.asked_lines(rows))), 3)
        self.assertEqual(len(list(only_needed.twin_lines(rows, []))), 3)


class Settings(unittest.TestCase):
    def test_are_those_of_the_run(self):
        rows = runs("--layers", "room", [1.0] * 6)
        self.assertRegex(only_needed.settings(rows, [], "8", "128"), r"RUNS=5.*SPP=8 .*WIDTH=128 .*\n.* not counted")
        self.assertIn("INSTRUCTIONS=1", only_needed.settings(rows, rows, "8", "128"))


class Scenes(unittest.TestCase):
    def test_a_glb_comes_back_as_it_went(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.glb")
            with open(path, "wb") as file:
                file.write(only_needed.glb_bytes({"asset": {"version": "2.0"}}, b"rest"))
            self.assertEqual(only_needed.read_glb(path), ({"asset": {"version": "2.0"}}, b"rest"))

    def test_dark_emits_nothing(self):
        scene = only_needed.dark({"materials": [{"emissiveFactor": [1, 1, 1], "extensions": {"e": 1}, "name": "m"}]})
        self.assertEqual(scene, {"materials": [{"name": "m"}]})

    def test_away_turns_the_camera_alone(self):
        scene = only_needed.away({"nodes": [{"mesh": 0}, {"camera": 0, "matrix": [1] * 16}]})
        self.assertEqual(scene["nodes"][0], {"mesh": 0})
        self.assertEqual(scene["nodes"][1]["translation"], [0, 50, 0])
        self.assertNotIn("matrix", scene["nodes"][1])


class Nothing(unittest.TestCase):
    def test_a_row_is_of_a_program_that_ends_as_it_should(self):
        def runs(path, status, *command):
            only_needed.main(["nothing", path, str(status), "a program", *command])

        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "nothing.csv")
            runs(path, 3, "sh", "-c", "exit 3")
            runs(path, 0, sys.executable, "-S", "-c", "import time\nwhile time.process_time() < 0.3: pass")
            for status, command in ((3, "true"), (0, "kill -SEGV $$")):
                with self.assertRaisesRegex(SystemExit, "a program: status .*, expected %d" % status):
                    runs(path, status, "sh", "-c", command)
            rows = only_needed.read(folder, "nothing")
            self.assertEqual([row[0] for row in rows], ["a program"] * 2)
            self.assertAlmostEqual(float(rows[1][1]), 0.3, delta=0.2)


if __name__ == "__main__":
    unittest.main()
