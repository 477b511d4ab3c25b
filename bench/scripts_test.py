"""scripts_test.py TEST BIN: benchmarks at the size of a stamp, by the programs in BIN or by programs that play theirs.
Exit 77, with a word, where something is missing that they need."""
import csv
import itertools
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

import common
import cycles
import formats
import pages
import peers
import price
import readers
import rooms

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
        rooms.write_rooms(self.work)
        few = {"ffgraph": "--set walks=20000 --samples 100000 --set rounds=0", "lightgrid": "--resolution 32 --set lines=1000"}
        for program in common.STAGES:  # the same with a small number of rays
            self.program(self.work / "bin", program, f'exec "{BIN}/{program}" {few.get(program, "")} "$@"')
        self.runs("stages", programs=self.work / "bin", SCENE=SCENES / "two-rooms.glb", INTERIOR=SCENES / "window.glb", SKY="1,1,1",
                  WINDOWS=self.work / "skylight.glb")
        text = (HERE.parent / "doc/figures.md").read_text(encoding="utf-8").partition("## The paper's figures")[0]
        self.assertEqual((text.count("!["), self.missing_pictures(text)), (9, []))
        (self.doc / "figures/stage-mincut.png").unlink()
        self.assertEqual(self.missing_pictures(text), ["figures/stage-mincut.png"])
        status, said = self.run_bench("stages", SCENE=self.work / "none.glb")
        self.assertEqual((status, "there is no scene" in said), (3, True))


class Figures(Stamp):
    def test_page_is_whole_and_nothing_is_made_twice(self):
        self.stand_in(cornell_box_portal="two-rooms", veach_ajar_flip="door-ajar")
        _, said = self.runs("figures", "--quick", WIDTH=32)
        self.assertIn("veach-ajar: there is no veach-ajar.glb in SCENES, left out", said)
        text = self.page("figures")
        for i in ("pt", "nee", "bdpt", "tdpt-org", "tdpt"):  # a row in Fig 5, one for each scene in Fig 7; no empty cell
            rows = re.findall(rf"^\|(?: [a-z-]+ \|)? {i}(?: \| [^| ][^|]*){{7}} \|$", text, re.M)
            self.assertEqual(len(rows), 1 if i in ("pt", "nee") else 3, i)
        self.assertEqual(self.missing_pictures(text.partition("## The paper's figures")[2]), [])
        self.assertIsNone(re.search(r"\b(nan|null|None|inf)\b", text))
        self.assertIn("</svg>", (self.doc / "figures/fig5.svg").read_text())
        self.assertEqual(self.runs("figures", "--quick", WIDTH=32)[0], 0)
        self.assertEqual(self.runs("figures", "--quick", WIDTH=32, SPP=3)[0], 12)  # six pictures, judged
        self.assertEqual(self.run_bench("figures", SCENES=self.work)[0], 3)


class Efficiency(Stamp):
    def efficiency(self, **more):
        return {"WIDTH": 32, "HEIGHT": 24, "SECONDS_EACH": 0.02, "SEEDS": 2, "REF_SECONDS": 0.1, "LONG_SECONDS": 0.1,
                "LONG_SEEDS": 2, "INTEGRATORS": "bdpt tdpt-org", "ONLY": "window veach-ajar veach-ajar-flip",
                "REFERENCE_FOLDER": self.work / "references", **more}

    def rows(self):
        with open(self.doc / "efficiency.csv", newline="", encoding="ascii") as file:
            return list(csv.DictReader(file))

    def test_page_csv_and_cache(self):
        self.stand_in(veach_ajar="two-rooms")
        _, said = self.runs("efficiency", **self.efficiency())
        self.assertIn("veach-ajar-flip: there is no veach-ajar-flip.glb in SCENES, left out", said)
        text, rows = self.page("efficiency"), self.rows()
        self.assertRegex(text, r"\n<!-- doors -->\nGain over bdpt:\n\n.*\n.*\n\| window \| .*\n\| veach-ajar \| ")
        self.assertRegex(text, r"\n\| veach-ajar \| bdpt \| [0-9.]+, [0-9.]+ \| ")
        self.assertRegex(text, r"\nThe mean of bdpt's pictures agrees with the reference's in \d of 2 scenes")
        self.assertIsNone(re.search(r"\b(nan|None|inf)\b", text))
        self.assertTrue((self.doc / "efficiency.png").stat().st_size)
        # Two scenes, two integrators, two seeds, three times; and two long ones of both.
        self.assertEqual((len(rows), len(rows[0])), (28, 12))
        self.assertTrue(all(5 < float(r["peak_mib"]) < 500 for r in rows))
        self.assertEqual(self.runs("efficiency", **self.efficiency())[0], 0)
        more, _ = self.runs("efficiency", **self.efficiency(SEEDS=3, ONLY="window"))
        self.assertEqual(more, 6 * 3)  # each a picture, and what exrdiff says of it and both halves

    def test_older_program_no_limit_and_wrong_settings(self):
        self.program(self.work, "older", f'echo "$*" >>{self.work}/calls\nexec {BIN}/tdpt-render "$@"')
        older = self.work / "older"
        self.stand_in(veach_ajar="two-rooms")
        self.runs("efficiency", **self.efficiency(ONLY="window veach-ajar-whole",
                  INTEGRATORS="bdpt auto", BASELINE=older, BASELINE_NAME="commit 1234567"))
        text = self.page("efficiency")
        self.assertEqual((self.work / "calls").read_text().count("--integrator"), 12)
        self.assertIn("\nGain over bdpt of commit 1234567", text)
        whole = text.partition("<!-- whole -->")[2].partition("<!-- end -->")[0]
        self.assertRegex(whole, r"\n\| veach-ajar-whole \| [0-9.-]")
        self.assertEqual(sum(r["scene"] == "veach-ajar-whole" for r in self.rows()), 4)
        for says, wrong in (("no program", {"BASELINE": self.work / "none"}),
                            ("limited", {"DEPTH": "none", "BASELINE": older}), ("neither", {"DEPTH": "deep"}),
                            ("cellar is none", {"LONG_SCENES": "cellar"}), ("no number", {"SEEDS": "many"}),
                            ("no setting", {"WORD": "x"})):
            status, said = self.run_bench("efficiency", **self.efficiency(**wrong))
            self.assertEqual((status, says in said), (2, True), said)

    def test_references_are_stored_and_fit_one_scene_depth_and_size(self):
        self.stand_in(veach_ajar="two-rooms")
        few = self.efficiency(ONLY="window", INTEGRATORS="bdpt", LONG_SEEDS=0)
        _, said = self.runs("efficiency-references", **self.efficiency(ONLY="window veach-ajar"))
        self.assertEqual(len(re.findall(r": stored, \S+ of 0.[18] CPU seconds", said)), 2)
        stored = self.work / "references"
        self.assertEqual(sorted(p.name for p in stored.iterdir()), [
            "README.md", "veach-ajar-1.exr", "veach-ajar-2.exr", "veach-ajar.json", "window-1.exr", "window-2.exr",
            "window.json"])
        self.assertIn("| window | 32 x 24 | 6 | tdpt-guided |", (stored / "README.md").read_text())
        pictures = lambda: len(list(self.cache.glob("runs/*/out")))
        self.runs("efficiency", **few)
        for change, rendered in (({}, 0), ({"REFERENCE_FOLDER": self.work / "none"}, 2), ({"DEPTH": 5}, 2 + 6),
                                 ({"WIDTH": 28}, 2 + 6)):
            before = pictures()
            self.runs("efficiency", **{**few, "REF_SECONDS": 0.2, **change})
            self.assertEqual(pictures() - before, rendered, change)


class ForOthers(Stamp):
    """Rooms under a sky: with an inner door, whose portal is left out, and with three windows, the whole askew."""

    def askew(self, content):
        document, binary = formats.glb_parse(content)
        scene = document["scenes"][0]
        document["nodes"].append({"children": scene["nodes"], "rotation": [0.48, 0.36, 0.0, 0.8]})
        scene["nodes"] = [len(document["nodes"]) - 1]
        return formats.glb_content(document, binary)

    def texts(self, renderer):
        """[(portals, the text)]"""
        (self.scenes / "behind.glb").write_bytes(rooms.behind().glb())
        (self.scenes / "askew.glb").write_bytes(self.askew(rooms.windows().glb()))
        bench, texts = common.Bench("cycles", cycles.equal_time, BIN, self.cache, self.doc), []
        for name, lights in (("behind", 1), ("askew", 3)):
            found = bench.portals(self.scenes / f"{name}.glb", ("--environment", "1,1,1"))
            text = bench.store.run("portalfit", found.runs["lightgrid"].out, "--for", renderer, threads=0).out
            self.assertEqual((len(readers.portals_of(found.file)), found.count > lights), (lights, name == "behind"))
            texts.append((found.file, text))
        return texts


class CyclesPortals(ForOthers):
    """What `portalfit --for cycles` writes makes lamps in every Blender here where the portals are, seen with the eyes of
    Blender's own glTF importer; and a script with a planted fault is told apart."""

    def test_lamps_are_where_the_portals_are(self):
        texts = self.texts("cycles")
        for command, (portals, script) in itertools.product(cycles.blenders(), texts):
            self.assertRegex(cycles.blender("check", portals, script, command=command).said,
                             r"(?m)^([1-9]\d*) lamps for \1 portals")
        text, wrong = script.read_text(), self.work / "wrong.py"
        placed = "portal.matrix_world = Matrix(matrix)"
        for old, new in ((placed, placed + " @ Matrix.Diagonal((1, -1, -1, 1))"),  # a lamp turned round
                         ('lamp.size_y = "RECTANGLE", width,', 'lamp.size_y = "RECTANGLE", 1.01 * width,'),
                         ("is_portal = True", "is_portal = False")):
            wrong.write_text(text.replace(old, new))
            self.assertNotEqual(wrong.read_text(), text)
            for command in cycles.blenders():
                with self.assertRaisesRegex(common.Stop, "cycles_blender.py: "):
                    cycles.blender("check", portals, wrong, command=command)


class Readers(ForOthers):
    """What `portalfit --for mitsuba` and `usd` write is read by both as the portals; planted faults are told apart."""

    def read(self, reader, *paths, may_fail=()):
        return common.checked([common.peers_python(), "-B", HERE / "readers.py", reader, *paths], may_fail)

    def test_what_is_read_are_the_portals(self):
        for reader in ("mitsuba", "usd"):
            for portals, text in self.texts(reader):
                self.assertRegex(self.read(reader, portals, text).said, r"(?m)^([1-9]\d*) lights for \1 portals")

    def faults(self, reader, text):
        """{name: (the text with a fault, what is said of it)}"""
        before = {"mitsuba": 'matrix value="', "usd": "xformOp:transform = "}[reader]
        line = next(line for line in text.splitlines() if before in line)
        at = line.index(before) + len(before)
        number = re.compile(r"-?\d[\d.e-]*")
        values = number.findall(line[at:])
        self.assertEqual(len(values), 16)

        def rearranged(new):
            left = iter(new)
            return text.replace(line, line[:at] + number.sub(lambda _: next(left), line[at:]))

        y = range(4, 8) if reader == "usd" else range(1, 12, 4)  # rows of USD, columns of Mitsuba
        faults = {"transposed": (rearranged(values[4 * column + row] for row in range(4) for column in range(4)), "side"),
                  "mirrored": (rearranged(("-" + v).replace("--", "") if i in y else v for i, v in enumerate(values)),
                               "is mirrored")}
        if reader == "mitsuba":
            return {**faults, "other name": (text.replace("portal_0", "portal_9", 1), "lights .*expected"),
                    "no XML": (text.replace("</transform>", "", 1), "XML|parse|tag")}
        return {**faults, "wider": (text.replace("width = ", "width = 1", 1), "has side 0"),
                "unnamed": (re.sub(r"rel portals = \[.*\]", "rel portals = []", text), "dome light names"),
                "other type": (text.replace("float inputs:width", "double inputs:width", 1), "AttributeType"),
                "no units": (text.replace("    metersPerUnit = 1\n", ""), "(?i)metersPerUnit")}

    def test_twins_a_planted_fault_is_caught(self):
        for reader in ("mitsuba", "usd"):
            portals, text = self.texts(reader)[-1]
            content, wrong = text.read_text(), self.work / "wrong"
            for fault, (planted, said) in self.faults(reader, content).items():
                with self.subTest(reader=reader, fault=fault):
                    self.assertNotEqual(planted, content)
                    wrong.write_text(planted)
                    run = self.read(reader, portals, wrong, may_fail=(1,))
                    self.assertEqual(run.status, 1, run.said)
                    self.assertRegex(run.errors, said)


class Peers(Stamp):
    """A floor under a point lamp, seen from above, with a pane beside it."""

    def scene(self, **more):
        builder = formats.Builder()
        grey = builder.diffuse((0.5, 0.5, 0.5), **more)
        glass = builder.diffuse((1, 1, 1), extensions={"KHR_materials_transmission": {"transmissionFactor": 1}})
        builder.mesh([(-5, 0, -5), (-5, 0, 5), (5, 0, 5), (5, 0, -5)], [0, 1, 2, 0, 2, 3], material=glass)
        builder.mesh([(-5, 0, -5), (-5, 0, 5), (5, 0, 5), (5, 0, -5)], [0, 1, 2, 0, 2, 3], material=grey,
                     translation=(0, -1, 0))
        builder.json["extensions"] = {"KHR_lights_punctual": {"lights": [
            {"type": "point", "color": [1, 0.5, 0.2], "intensity": 10}]}}
        builder.node({"translation": [0, 1, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}})
        builder.camera((0, 0.5, 0.001), (0, -1, 0), yfov=0.02)
        builder.json["cameras"][0]["name"] = "above"
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

    def test_without_any_of_them_nothing_is_measured(self):
        self.program(self.work / "bin", "python", "echo '{}'")
        with unittest.mock.patch.dict(os.environ, PEERS_PYTHON=str(self.work / "bin/python")):
            status, said = self.run_bench("peers")
        self.assertEqual((status, said.splitlines()[-1]), (5, "peers: none of bpy, pyluxcore, mitsuba is installed (make "
                                                              "peers)"), said)

    @unittest.skipUnless(common.peers_python() != "python3", "make peers")
    def test_the_floor_under_a_lamp_is_as_bright_as_a_closed_form_says(self):
        scene = self.work / "scene.npz"
        np.savez(scene, **peers.plain(peers.without_panes(self.scene())[0], "above"))
        for method in peers.inside("versions"):
            peers.inside(method, scene, self.work / "%d.exr", "--width", 16, "--height", 9, "--spp", 64)
            seen = formats.exr_read(self.work / "1.exr")[0].mean((0, 1))
            for colour, intensity in zip(seen, (10, 5, 2)):
                self.assertAlmostEqual(colour / (0.5 / np.pi * intensity / 4), 1, delta=0.003, msg=method)


class TargetError(Stamp):
    """By programs that play theirs."""

    def test_what_fails_is_no_result(self):
        programs = self.work / "bin"
        measures = 'for seed in 1 2; do echo "$seed 16 0.01 0.009 0.011 4 1"; : >"$2/$seed.exr"; ' \
                   ': >"$2/$seed.reference.exr"; done'
        self.program(programs, "tdpt-render", "echo tdpt-render 0")
        self.program(programs, "exrdiff", "echo '{ \"relmse\": 0.01 }'")
        self.program(programs, "target_bench", measures)
        for name in ("cornell-box", "kitchen"):
            (self.scenes / f"{name}.glb").write_text(name)
        run = lambda: self.run_bench("target-error", programs=programs, SEEDS=2, JOBS=2, ONLY="cornell-box kitchen")
        status, said = run()
        self.assertEqual(status, 0, said)
        self.assertIn("\n| kitchen | 960 |", self.page("regret"))
        self.assertRegex(self.page("regret"), r"\n\*Measured by `make bench-target-error SEEDS=2 .* with tdpt-render 0 on ")
        # What an older program measured is no result of one that fails.
        (self.doc / "regret.md").unlink()
        self.program(programs, "target_bench", f"case $1 in *kitchen*) exit 3 ;; esac\n{measures}")
        status, said = run()
        self.assertEqual(status, 3, said)
        self.assertIn("target-error: kitchen could not be measured", said)
        self.program(programs, "target_bench", measures + "\n:")
        self.program(programs, "exrdiff", "exit 4")
        self.assertEqual(run()[0], 4)
        self.assertFalse((self.doc / "regret.md").exists())


class Missing(Stamp):
    def test_what_is_missing_is_said_in_a_line(self):
        path = self.work / "path"
        path.mkdir()
        for folder in os.environ["PATH"].split(":"):
            for program in Path(folder).glob("*") if folder else ():
                if program.name not in ("gnuplot", "valgrind", "perf") and not (path / program.name).exists():
                    (path / program.name).symlink_to(program)
        for name, words in (("figures", "gnuplot is missing"), ("tradeoff", "gnuplot is missing"),
                            ("limit", "perf does not work and valgrind is missing"),
                            ("shards", "tdpt-render is missing")):
            status, said = self.run_bench(name, programs=self.work, path=path)
            self.assertEqual((status, words in said, said.count("\n")), (5, True, 1), said)
        self.assertEqual(self.run_bench("none-such")[0], 2)


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


class Memory(Stamp):
    """The five programs hold less than 400 bytes for each triangle that a scene has more, one thread each."""

    few = {"ffgraph": ["--set", "walks=10000", "--samples", "20000"], "lightgrid": ["--resolution", "32"],
           "tdpt-render": ["--integrator", "bdpt", "--spp", "1", "--width", "16", "--height", "12"]}

    def test_of_each_program_is_below_the_limit(self):
        rows = {program: [] for program in price.PROGRAMS}
        for n in (50000, 200000):
            rooms.write_scene(n, "soup", self.work / f"{n}.glb")
            for program, arguments, output in price.stages_of(self.work / str(n), self.few):
                run = common.checked([BIN / program, "--quiet", "--threads", 1, *arguments, "-o", output])
                rows[program].append(price.Row("soup", n, program, run.cpu, run.peak_mib))
        for program, of in rows.items():
            print("%s: %.0f bytes a triangle" % (program, price.bytes_each(*of)))
            self.assertLess(price.bytes_each(*of), price.MOST_BYTES, program)

    def test_twin_a_program_that_holds_a_fifth_more_is_caught(self):
        def holds(each):
            runs = [common.measure([sys.executable, "-S", "-c", "b = bytearray(%d)" % (each * n)]).peak_mib
                    for n in (50000, 200000)]
            return (runs[1] - runs[0]) * price.MIB / 150000

        self.assertLess(holds(0.8 * price.MOST_BYTES), price.MOST_BYTES)
        self.assertGreater(holds(1.2 * price.MOST_BYTES), price.MOST_BYTES)


if __name__ == "__main__":
    if {"Figures", "Efficiency"} & set(sys.argv) and not shutil.which("gnuplot"):
        skip("gnuplot is missing (cmake/packages-figures.txt)")
    if "CyclesPortals" in sys.argv and not cycles.blenders():
        skip("no Blender here (Debian: blender, or make peers)")
    here = [shutil.which(common.peers_python()) or "false", "-c", "import mitsuba, pxr.UsdValidation"]
    if "Readers" in sys.argv and common.measure(here).status:
        skip("no Mitsuba and OpenUSD here (make peers)")
    unittest.main()
