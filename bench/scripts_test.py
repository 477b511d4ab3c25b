"""scripts_test.py TEST BIN: benchmarks at the size of a stamp, by the programs in BIN or by programs that play theirs.
Exit 77, with a word, where something is missing that they need."""
import csv
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import common
import cost
import formats
import pages
import peers
import run

HERE = Path(__file__).resolve().parent
SCENES = HERE.parent / "testdata/scenes"
BIN = Path(sys.argv.pop(2)).resolve() if len(sys.argv) > 2 else HERE.parent / "build/bin"


def skip(words):
    print(f"skipped: {words}")
    sys.exit(77)


class Stamp(unittest.TestCase):
    """A folder of its own, with scenes, a cache and pages."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = Path(folder.name)
        self.scenes, self.cache, self.doc = (self.work / name for name in ("scenes", "cache", "doc"))
        self.scenes.mkdir()

    def stand_in(self, **names):
        """Scenes of testdata that stand in for the paper's: name=scene."""
        for name, scene in names.items():
            shutil.copy(SCENES / f"{scene}.glb", self.scenes / f"{name.replace('_', '-')}.glb")

    def run_bench(self, name, *words, programs=BIN, path=None, **values):
        """(exit code, what is said); values: settings."""
        given = {"SCENES": str(self.scenes), **values}
        run = subprocess.run([sys.executable, "-B", HERE / "run.py", name, "--bin", programs, "--cache", self.cache,
                              "--doc", self.doc, *words, *(f"{k}={v}" for k, v in given.items())], capture_output=True,
                             text=True, check=False, env={**os.environ, **({"PATH": str(path)} if path else {})})
        return run.returncode, run.stdout + run.stderr

    def runs(self, name, *words, **values):
        """Of one that has to end well: (results made, what is said)."""
        status, said = self.run_bench(name, *words, **values)
        self.assertEqual(status, 0, said)
        made = re.search(r"(\d+) results made", said)
        return int(made.group(1)) if made else 0, said

    def page(self, name):
        return (self.doc / f"{name}.md").read_text(encoding="utf-8")

    def program(self, folder, name, script):
        """One that plays another's."""
        folder.mkdir(exist_ok=True)
        (folder / name).write_text(f"#!/bin/sh\n{script}\n")
        (folder / name).chmod(0o755)

    def missing_pictures(self, text):
        return [name for name in re.findall(r"!\[.*?\]\((figures[^)]*)\)", text)
                if not (self.doc / name).is_file() or not (self.doc / name).stat().st_size]


class Stages(Stamp):
    def test_every_picture_of_the_page_is_made(self):
        few = {"ffgraph": "--set walks=20000 --samples 100000 --set rounds=0", "lightgrid": "--resolution 32 --set lines=1000"}
        for program in common.STAGES:  # the same with a small number of rays
            self.program(self.work / "bin", program, f'exec "{BIN}/{program}" {few.get(program, "")} "$@"')
        self.stand_in(veach_ajar="two-rooms", living_room="window", kitchen="window")
        formats.exr_write(self.scenes / "living-room.env.exr", np.ones((8, 16, 3)))
        self.runs("stages", programs=self.work / "bin")
        text = (HERE.parent / "doc/portals.md").read_text(encoding="utf-8")
        self.assertEqual((text.count("!["), self.missing_pictures(text)), (9, []))
        self.assertIn("there is no scene", self.runs("stages", SCENE=self.work / "none.glb")[1])


class Figures(Stamp):
    def test_page_is_whole_and_nothing_is_made_twice(self):
        self.stand_in(cornell_box_portal="two-rooms", veach_ajar_flip="door-ajar")
        _, said = self.runs("figures", "--quick")
        self.assertIn("veach-ajar: there is no veach-ajar.glb in SCENES, left out", said)
        text = self.page("efficiency").partition("## The paper's figures")[2]
        for i in ("pt", "nee", "bdpt", "tdpt-org", "tdpt"):  # a row in Fig 5, one for each scene in Fig 7; no empty cell
            rows = re.findall(rf"^\|(?: [a-z-]+ \|)? {i}(?: \| [^| ][^|]*){{6,7}} \|$", text, re.M)
            self.assertEqual(len(rows), 1 if i in ("pt", "nee") else 3, i)
        self.assertEqual(self.missing_pictures(text), [])
        self.assertEqual(self.runs("figures", "--quick")[0], 0)
        self.assertEqual(self.runs("figures", "--quick", SPP=3)[0], 12)  # six pictures, judged
        self.assertEqual(self.run_bench("figures", SCENES=self.work)[0], 3)


class Efficiency(Stamp):
    def efficiency(self, **more):
        return {"WIDTH": 32, "HEIGHT": 24, "SECONDS_EACH": 0.02, "SEEDS": 2, "REF_SECONDS": 0.1, "INTEGRATORS": "bdpt tdpt-org",
                "ONLY": "window veach-ajar veach-ajar-flip", "REFERENCE_FOLDER": self.work / "references", **more}

    def test_page_csv_and_cache(self):
        self.stand_in(veach_ajar="two-rooms")
        _, said = self.runs("efficiency", **self.efficiency())
        self.assertIn("veach-ajar-flip: there is no veach-ajar-flip.glb in SCENES, left out", said)
        text = self.page("efficiency")
        self.assertRegex(text, r"\n<!-- doors -->\nGain over bdpt:\n\n.*\n.*\n\| window \| .*\n\| veach-ajar \| ")
        self.assertRegex(text, r"\nThe mean of bdpt's pictures agrees with the reference's in \d of 2 scenes")
        self.assertIsNone(re.search(r"\b(nan|None|inf)\b", text))
        self.assertTrue((self.doc / "efficiency.png").stat().st_size)
        with open(self.doc / "efficiency.csv", newline="", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual((len(rows), len(rows[0])), (24, 12))  # two scenes, two integrators, two seeds, three times
        self.assertEqual(self.runs("efficiency", **self.efficiency())[0], 0)
        more, _ = self.runs("efficiency", **self.efficiency(SEEDS=3, ONLY="window"))
        self.assertEqual(more, 6 * 3)  # each a picture, and what exrdiff says of it and both halves

    def test_older_program_stored_references_and_wrong_settings(self):
        self.program(self.work, "older", f'echo "$*" >>{self.work}/calls\nexec {BIN}/tdpt-render "$@"')
        older = self.work / "older"
        self.runs("efficiency-references", **self.efficiency(ONLY="window"))
        stored = self.work / "references"
        self.assertEqual(sorted(p.name for p in stored.iterdir()), ["window-1.exr", "window-2.exr", "window.json"])
        given = self.efficiency(ONLY="window", INTEGRATORS="bdpt", BASELINE=older, BASELINE_NAME="commit 1234567")
        self.runs("efficiency", **given)
        self.assertEqual((self.work / "calls").read_text().count("--integrator"), 12)
        self.assertIn("\nGain over bdpt of commit 1234567", self.page("efficiency"))
        made, _ = self.runs("efficiency", **{**given, "REFERENCE_FOLDER": self.work / "none"})
        self.assertGreater(made, 4)  # the reference, and what depends on it
        for says, wrong in (("no program", {"BASELINE": self.work / "none"}), ("limited", {"DEPTH": "none", "BASELINE": older}),
                            ("neither", {"DEPTH": "deep"}), ("no number", {"SEEDS": "many"}), ("no setting", {"WORD": "x"})):
            status, said = self.run_bench("efficiency", **self.efficiency(**wrong))
            self.assertEqual((status, says in said), (2, True), said)


def reading(reader):
    """Commands that run readers.py for this reader, one for each program that is here."""
    script = HERE / "readers.py"
    module = {"cycles": "bpy", "mitsuba": "mitsuba", "usd": "pxr.UsdValidation"}[reader]
    commands = [[common.peers_python(), "-B", script]]
    if not shutil.which(commands[0][0]) or common.measure([commands[0][0], "-c", f"import {module}"]).status:
        commands = []
    if reader == "cycles" and shutil.which("blender"):
        commands.append(["blender", "-b", "--factory-startup", "--python-exit-code", 1, "--python", script, "--"])
    return commands


class Readers(Stamp):
    """What `portalfit --for` writes for portals askew is read as those by the program that it is for; texts with a planted
    fault are told apart."""

    def portals(self):
        """(a file of two, the table of lines that they were fitted to)"""
        rng, table = np.random.default_rng(5), ["cut,light_x,light_y,light_z,camera_x,camera_y,camera_z", "# tdpt light grid 1"]
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        for cut, (corner, sides) in enumerate((((0, 0, 0), (1.2, 0.8)), ((3, 1, 0.5), (0.9, 1.6)))):
            for _ in range(1500):
                place = np.array(corner) + (*rng.uniform(0, sides), 0)
                way = np.array((*rng.uniform(-0.6, 0.6, 2), 1))
                ends = [(place + sign * way) @ turn for sign in (-1, 1)]
                table.append(",".join([str(cut), *("%.6f" % x for end in ends for x in end)]))
        path = self.work / "lines.csv"
        path.write_text("\n".join(table) + "\n")
        common.checked([BIN / "portalfit", path, "-o", self.work / "portal.glb", "--quiet"])
        return self.work / "portal.glb", path

    def faults(self, reader, text):
        """{name: (the text with a fault, what is said of it)}"""
        if reader == "cycles":
            placed = "portal.matrix_world = Matrix(matrix)"
            return {"turned round": (text.replace(placed, placed + " @ Matrix.Diagonal((1, -1, -1, 1))"), "sends light"),
                    "mirrored": (text.replace(placed, placed + " @ Matrix.Diagonal((1, -1, 1, 1))"), "is mirrored"),
                    "wider": (text.replace('lamp.size_y = "RECTANGLE", width,', 'lamp.size_y = "RECTANGLE", 1.01 * width,'),
                              "has side 0"),
                    "no portal": (text.replace("is_portal = True", "is_portal = False"), "that is a portal")}
        before = {"mitsuba": 'matrix value="', "usd": "xformOp:transform = "}[reader]
        line = next(line for line in text.splitlines() if before in line)
        at, number = line.index(before) + len(before), re.compile(r"-?\d[\d.e-]*")
        values = number.findall(line[at:])
        left = iter([values[4 * column + row] for row in range(4) for column in range(4)])
        faults = {"transposed": (text.replace(line, line[:at] + number.sub(lambda _: next(left), line[at:])), "side|mirrored")}
        if reader == "mitsuba":
            return {**faults, "other name": (text.replace("portal_0", "portal_9", 1), "lights .*expected"),
                    "no XML": (text.replace("</transform>", "", 1), "XML|parse|tag")}
        return {**faults, "wider": (text.replace("width = ", "width = 1", 1), "has side 0"),
                "unnamed": (re.sub(r"rel portals = \[.*\]", "rel portals = []", text), "dome light names"),
                "other type": (text.replace("float inputs:width", "double inputs:width", 1), "AttributeType"),
                "no units": (text.replace("    metersPerUnit = 1\n", ""), "(?i)metersPerUnit")}

    def test_what_is_read_are_the_portals_and_a_planted_fault_is_caught(self):
        portals, lines = self.portals()
        wrong = self.work / "wrong"
        env = {"PATH": f"/usr/bin:{os.environ['PATH']}"}  # Blender takes the first Python there; the distribution's has numpy
        for reader in ("cycles", "mitsuba", "usd"):
            common.checked([BIN / "portalfit", lines, "--for", reader, "-o", self.work / "text"])
            text = (self.work / "text").read_text()
            for command in reading(reader):
                said = common.checked([*command, reader, portals, self.work / "text"], env=env).said
                self.assertRegex(said, r"(?m)^2 lights for 2 portals")
                for fault, (planted, words) in self.faults(reader, text).items():
                    with self.subTest(reader=reader, fault=fault):
                        self.assertNotEqual(planted, text)
                        wrong.write_text(planted)
                        run = common.checked([*command, reader, portals, wrong], range(1, 256), env)
                        self.assertEqual(run.status, 1, run.said)
                        self.assertRegex(run.errors, words)


class Peers(Stamp):
    """A floor under a point lamp, seen from above, with a pane beside it."""

    def scene(self, **more):
        builder = formats.Builder()
        grey = builder.diffuse((0.5, 0.5, 0.5), **more)
        glass = builder.diffuse((1, 1, 1), extensions={"KHR_materials_transmission": {"transmissionFactor": 1}})
        for material, height in ((glass, 0), (grey, -1)):
            builder.mesh([(-5, 0, -5), (-5, 0, 5), (5, 0, 5), (5, 0, -5)], [0, 1, 2, 0, 2, 3], material=material,
                         translation=(0, height, 0))
        builder.json["extensions"] = {"KHR_lights_punctual": {"lights": [
            {"type": "point", "color": [1, 0.5, 0.2], "intensity": 10}]}}
        builder.node({"translation": [0, 1, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}})
        camera = builder.add("cameras", {"name": "above", "type": "perspective", "perspective": {"znear": 0.01, "yfov": 0.02}})
        builder.node({"camera": camera, "translation": [0, 0.5, 0], "rotation": [-(0.5**0.5), 0, 0, 0.5**0.5]})
        return builder.content()

    def test_others_get_the_scene_without_its_panes(self):
        bare, gone = peers.without_panes(self.scene())
        made = peers.plain(bare, "above")
        self.assertEqual((gone, made["corners"].shape, made["corners"][..., 1].max()), (1, (2, 3, 3), -1))
        self.assertEqual((made["lamps"].tolist(), made["yfov"]), ([[[0, 1, 0], [10, 5, 2]]], 0.02))
        for wrong, words in (({}, "glass"), ({"doubleSided": True, "emissiveFactor": (1, 1, 1)}, "light from both")):
            content = self.scene(**wrong)
            with self.assertRaisesRegex(ValueError, words):
                peers.plain(content if not wrong else peers.without_panes(content)[0], "above")

    @unittest.skipUnless(common.peers_python() != "python3", "make peers")
    def test_the_floor_under_a_lamp_is_as_bright_as_a_closed_form_says(self):
        scene = self.work / "scene.npz"
        np.savez(scene, **peers.plain(peers.without_panes(self.scene())[0], "above"))
        for method in peers.inside("versions"):
            peers.inside(method, scene, self.work / "out.exr", "--width", 16, "--height", 9, "--spp", 64)
            seen = formats.exr_read(self.work / "out.exr").mean((0, 1))
            for colour, intensity in zip(seen, (10, 5, 2)):
                self.assertAlmostEqual(colour / (0.5 / np.pi * intensity / 4), 1, delta=0.003, msg=method)


class Store(Stamp):
    def test_what_is_there_is_not_run_again_until_content_changes_and_failures_leave_nothing(self):
        script = f'echo run >>{self.work}/log\nfor o; do :; done\ncat "$1" >"$o" || exit 3\necho \'{{"a": 1}}\''
        self.program(self.work, "tool", script)
        count = lambda: (self.work / "log").read_text().count("run")
        store = lambda: common.Store(self.cache, self.work)
        given = self.work / "in"
        given.write_text("x")
        for _ in range(2):
            run = store().run("tool", given, "--a")
        self.assertEqual((count(), run.out.read_text(), run.said), (1, "x", {"a": 1}))
        given.write_text("y")
        self.assertEqual(store().run("tool", given, "--a").out.read_text(), "y")
        self.program(self.work, "tool", script + "\ntrue")
        store().run("tool", given, "--a")
        self.assertEqual(count(), 3)
        kept = store()
        with self.assertRaisesRegex(common.Stop, "exit code 3"):
            kept.run("tool", "absent")
        self.assertEqual(len(list(self.cache.iterdir())), 3)
        self.assertEqual(kept.run("tool", "absent", may_fail=(3,)).status, 3)

    def test_what_is_missing_is_said_in_a_line(self):
        path = self.work / "path"
        path.mkdir()
        for program in ("env", "sh", "python3"):
            (path / program).symlink_to(shutil.which(program))
        for name, words in (("quality", "gnuplot is missing"), ("limit", "ffgraph is missing")):
            status, said = self.run_bench(name, programs=self.work, path=path, ONLY="two-rooms")
            self.assertEqual((status, words in said, said.count("\n")), (5, True, 1), said)
        self.assertEqual(self.run_bench("none-such")[0], 2)

    def test_time_is_that_of_the_program(self):
        busy = common.measure([sys.executable, "-S", "-c", "import time\nwhile time.process_time() < 0.3: pass"])
        self.assertAlmostEqual(busy.cpu, 0.3, delta=0.2)


class Pages(unittest.TestCase):
    def test_parts_and_the_line_of_the_measurement_are_filled(self):
        text = "# A\n<!-- one -->\nold\n<!-- end -->\n<!-- two -->\nkept\n<!-- end -->\n*Measured by `make bench-a` x*\n"
        self.assertEqual(pages.filled(text, {"one": "new\n"}, "a", "*Measured by `make bench-a SEEDS=2` y*"),
                         text.replace("old", "new").replace("bench-a` x", "bench-a SEEDS=2` y"))
        for wrong in ({"three": "x"}, {"one": "x", "": "x"}):
            with self.assertRaisesRegex(ValueError, "expected 1"):
                pages.filled(text.replace("bench-a", "bench-b") if "" in wrong else text, wrong, "a", "x")

    def test_links_and_commands_are_there_and_every_picture_is_shown(self):
        root, linked = HERE.parent, set()
        files = [root / name for name in ("README.md", "CONTRIBUTING.md", "doc/own/README.md")] + [*root.glob("doc/*.md")]
        for page in files:
            for link in re.findall(r"\]\(([^)#:]+)[^):]*\)", page.read_text(encoding="utf-8")):
                linked.add((page.parent / link).resolve())
                self.assertTrue((page.parent / link).exists(), f"{page.name}: {link}")
            for name in re.findall(r"^\*Measured by `make bench-([a-z-]+)(?![^`]*` of commit)", page.read_text(encoding="utf-8"), re.M):
                self.assertIn(name, run.BENCHMARKS)
        shown = {path.resolve() for end in ("png", "jpg", "csv") for path in root.glob(f"doc/**/*.{end}")}
        self.assertEqual(shown - linked, set())


class Memory(Stamp):
    """The five programs hold less than 400 bytes for each triangle that a scene has more, one thread each."""

    few = {"ffgraph": ["--set", "walks=10000", "--samples", "20000"], "lightgrid": ["--resolution", "32"],
           "tdpt-render": ["--integrator", "bdpt", "--spp", "1", "--width", "16", "--height", "12"]}

    def test_of_each_program_is_below_the_limit(self):
        rows = {program: [] for program in cost.PROGRAMS}
        for n in (50000, 200000):
            made = cost.write_scene(n, self.work / f"{n}.glb")
            for program, arguments, output in cost.stages_of(self.work / str(n), self.few):
                run = common.checked([BIN / program, "--quiet", "--threads", 1, *arguments, "-o", output])
                rows[program].append(cost.Row(made, program, run.cpu, run.peak_mib))
        for program, of in rows.items():
            print("%s: %.0f bytes a triangle" % (program, cost.bytes_each(*of)))
            self.assertLess(cost.bytes_each(*of), cost.MOST_BYTES, program)

    def test_twin_a_program_that_holds_a_fifth_more_is_caught(self):
        def holds(each):
            runs = [common.measure([sys.executable, "-S", "-c", "b = bytearray(%d)" % (each * n)]).peak_mib
                    for n in (50000, 200000)]
            return (runs[1] - runs[0]) * cost.MIB / 150000

        self.assertLess(holds(0.8 * cost.MOST_BYTES), cost.MOST_BYTES)
        self.assertGreater(holds(1.2 * cost.MOST_BYTES), cost.MOST_BYTES)


if __name__ == "__main__":
    if "Efficiency" in sys.argv and not shutil.which("gnuplot"):
        skip("gnuplot is missing (cmake/packages-figures.txt)")
    if "Readers" in sys.argv and not any(map(reading, ("cycles", "mitsuba", "usd"))):
        skip("no Blender, Mitsuba and OpenUSD here (make peers; Debian: blender)")
    unittest.main()
