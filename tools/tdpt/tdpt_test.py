"""tdpt_test.py BIN TESTDATA [TEST ...]: tdpt among other people: files that change under it, names that shells would run, other
runs beside it, signals and kills. Each test is a fault that a front end made of a shell and Make had."""

import contextlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import uuid

BIN, TESTDATA = (os.path.abspath(path) for path in sys.argv[1:3])
TDPT = os.path.join(BIN, "tdpt")
QUICK = ["--spp", "2", "--width", "16"]
KILLS = int(os.environ.get("KILLS", "8"))  # 50 in make test-long
# A rendering whose first film is there long before its end; tests stop the program there, whatever the machine's speed.
PICTURE = ["--spp", "16", "--width", "64", "--integrator", "tdpt-guided"]
LONG = [*PICTURE, "--set", "checkpoint-every=0", "--threads", "1"]
# An ffgraph that is easily met at work.
SLOW = {"FFGRAPH_FLAGS": "--set walks=20000 --samples 100000 --set rounds=0"}


class Tdpt(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="tdpt_test.")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.cache = os.path.join(self.folder, "cache")
        self.here = os.path.join(self.folder, "here")
        os.mkdir(self.here)
        self.mark = uuid.uuid4().hex
        self.env = dict(os.environ, TMPDIR=self.folder, XDG_CACHE_HOME=self.cache, TDPT_TEST_MARK=self.mark, LC_ALL="C",
                        FFGRAPH_FLAGS="--set walks=2000 --samples 10000 --set rounds=0", LIGHTGRID_FLAGS="--resolution 16 --set lines=200")
        self.scene("two-rooms", "room.glb")

    whole_picture = None

    def whole(self):
        """The bytes of LONG's picture that nobody disturbed, rendered once for all tests: no folder and no number of threads shows
        in them."""
        if Tdpt.whole_picture is None:
            self.run_tdpt("room.glb", "-o", "whole.exr", *PICTURE, "--work", os.path.join(self.folder, "whole"))
            Tdpt.whole_picture = self.bytes_of("whole.exr")
            os.remove(self.path("whole.exr"))
        return Tdpt.whole_picture

    def path(self, name):
        return os.path.join(self.here, name)

    def scene(self, name, to):
        shutil.copyfile(os.path.join(TESTDATA, "scenes", name + ".glb"), self.path(to))

    def start(self, *words, env=None, **more):
        return subprocess.Popen([TDPT, *words], cwd=self.here, env=dict(self.env, **(env or {})), stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)

    def run_tdpt(self, *words, expect=0, env=None):
        child = self.start(*words, env=env)
        out, err = (text.decode("utf-8", "surrogateescape") for text in child.communicate())
        self.assertEqual(child.returncode, expect, f"tdpt {words}\n{err}")
        return out, err

    def bytes_of(self, name):
        with open(self.path(name), "rb") as stream:
            return stream.read()

    def processes(self):
        """Those that a run has started, itself included."""
        found = []
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{pid}/environ", "rb") as stream:
                    if self.mark.encode() in stream.read():
                        with open(f"/proc/{pid}/stat", encoding="utf-8") as state:
                            if state.read().rsplit(")", 1)[1].split()[0] != "Z":
                                found.append(int(pid))
            except OSError:
                pass
        return found

    def wait_until(self, is_so, what, seconds=60):
        end = time.monotonic() + seconds
        while not is_so():
            self.assertLess(time.monotonic(), end, f"not within {seconds} s: {what}")
            time.sleep(0.005)

    def runs(self, program):
        def is_so():
            return any(b"--check" not in self.command_of(pid).split(b"\0") for pid in self.pids_of(program))
        return is_so

    @staticmethod
    def command_of(pid):
        try:
            with open(f"/proc/{pid}/cmdline", "rb") as stream:
                return stream.read() or b"--check"  # nothing: it is ending
        except OSError:  # it has ended
            return b"--check"

    def film(self):
        for entry in os.listdir(os.path.join(self.cache, "tdpt")) if os.path.isdir(os.path.join(self.cache, "tdpt")) else []:
            path = os.path.join(self.cache, "tdpt", entry, "film.exr")
            if os.path.exists(path):
                return path
        return None

    @contextlib.contextmanager
    def held(self, program, is_so=None):
        """With the program stopped as soon as it runs, or as something is so."""
        self.wait_until(lambda: (is_so is None or is_so()) and self.runs(program)(), f"{program} is where it is to be held")
        pids = [pid for pid in self.pids_of(program) if b"--check" not in self.command_of(pid).split(b"\0")]
        for pid in pids:
            os.kill(pid, signal.SIGSTOP)
        self.assertNotEqual(pids, [], f"{program} has ended before it could be held")
        try:
            yield
        finally:
            for pid in pids:
                with contextlib.suppress(ProcessLookupError):  # it was killed
                    os.kill(pid, signal.SIGCONT)

    # Pictures and who made them.

    def test_a_picture_made_by_hand_is_nobody_s(self):
        subprocess.run([os.path.join(BIN, "tdpt-render"), "room.glb", "--spp", "1", "--width", "8", "--quiet", "-o", "p.exr"],
                       cwd=self.here, check=True)
        self.scene("furnace", "other.glb")
        before = self.bytes_of("p.exr")
        for more in ([], ["--dry-run"]):
            out, err = self.run_tdpt("other.glb", "-o", "p.exr", *QUICK, *more, expect=2)
            self.assertIn("tdpt did not make it; --force replaces it", err)
            self.assertEqual(out, "")
        self.assertEqual(self.bytes_of("p.exr"), before)
        self.run_tdpt("other.glb", "-o", "p.exr", *QUICK, "--force")
        self.assertNotEqual(self.bytes_of("p.exr"), before)
        _, err = self.run_tdpt("other.glb", "-o", "p.exr", *QUICK)
        self.assertIn("is up to date", err)
        # The hand again, over a picture of tdpt's.
        with open(self.path("p.exr"), "wb") as stream:
            stream.write(before)
        self.run_tdpt("other.glb", "-o", "p.exr", *QUICK, expect=2)

    def test_a_picture_made_by_hand_after_a_run_that_was_stopped(self):
        self.stop(signal.SIGTERM)
        with open(self.path("p.exr"), "wb") as stream:
            stream.write(b"by hand")
        self.run_tdpt("room.glb", "-o", "p.exr", *LONG, expect=2)
        self.assertEqual(self.bytes_of("p.exr"), b"by hand")

    def test_preview_has_the_exposure_that_is_asked_for(self):
        words = ["room.glb", "-o", "p.exr", *QUICK]
        self.run_tdpt(*words)
        before = self.bytes_of("p.exr")
        previews = {}
        for exposure in ([], ["--exposure=-3"], ["--exposure=2"], []):
            _, err = self.run_tdpt(*words, "--preview", *exposure)
            self.assertIn("tdpt: wrote p.png\n", err)
            self.assertNotIn("rendering", err)
            png = self.bytes_of("p.png")
            self.assertEqual(previews.setdefault(str(exposure), png), png)
        _, err = self.run_tdpt(*words, "--preview")
        self.assertNotIn("wrote", err)
        self.assertEqual(len(set(previews.values())), 3)
        self.assertEqual(self.bytes_of("p.exr"), before)

    def test_its_own_picture_is_replaced_by_another_command(self):
        self.run_tdpt("room.glb", "-o", "p.exr", *QUICK)
        self.scene("furnace", "other.glb")
        for words in (["other.glb", *QUICK], ["room.glb", "--spp", "2", "--width", "12"], ["room.glb", *QUICK]):
            _, err = self.run_tdpt(*words, "-o", "p.exr")
            self.assertIn("wrote p.exr", err)
            self.assertEqual("goes on from" in err, words == ["room.glb", *QUICK], err)  # the film is still there
            self.run_tdpt(*words, "-o", "alone.exr", "--work", "alone")
            self.assertEqual(self.bytes_of("p.exr"), self.bytes_of("alone.exr"), words)
        # What shapes nothing makes no other command; a picture that was moved is known, one that was changed is nobody's.
        os.rename(self.path("p.exr"), self.path("q.exr"))
        _, err = self.run_tdpt("room.glb", "-o", "q.exr", *QUICK, "--threads", "1")
        self.assertIn("q.exr is up to date", err)
        with open(self.path("q.exr"), "ab") as stream:
            stream.write(b" ")
        _, err = self.run_tdpt("room.glb", *QUICK, "--seed", "3", "-o", "q.exr", expect=2)
        self.assertIn("q.exr: is there already, and tdpt did not make it; --force replaces it", err)

    def test_more_samples_go_on_from_those_that_are_there(self):
        def same(a, b):
            out = subprocess.run([os.path.join(BIN, "exrdiff"), "--json", self.path(a), self.path(b)], check=True, capture_output=True)
            return json.loads(out.stdout)["mse"] == 0
        words = ["room.glb", "-o", "p.exr", "--width", "16", "--integrator", "bdpt"]
        self.run_tdpt(*words, "--spp", "4")
        for spp, goes_on in (("9", True), ("6", False), ("6", None)):
            _, err = self.run_tdpt(*words, "--spp", spp)
            self.assertEqual("goes on from" in err and "begins with the first sample" not in err, goes_on is True, err)
            self.assertEqual("is up to date" in err, goes_on is None, err)
            self.run_tdpt(*words[:2], "alone.exr", *words[3:], "--spp", spp, "--work", "alone" + spp)
            self.assertTrue(same("p.exr", "alone.exr"), spp)
            os.remove(self.path("alone.exr"))
        _, err = self.run_tdpt(*words, "--spp", "12", "--seed", "2")  # another picture
        self.assertNotIn("goes on from", err)

    def test_what_is_read_counts_and_not_its_time(self):
        subprocess.run(["sh", os.path.join(TESTDATA, "..", "libcommon", "testing", "files", "loose_scene.sh"), self.path("room.glb"),
                        self.path("loose")], check=True, cwd=self.here)
        shutil.copyfile(os.path.join(TESTDATA, "environments", "clear.exr"), self.path("sky.exr"))
        words = ["loose.gltf", "-o", "p.exr", *QUICK, "--environment", "sky.exr"]
        self.run_tdpt(*words)
        for name in ("loose.gltf", "loose.png", "loose.bin", "sky.exr"):
            before = self.bytes_of(name)
            with open(self.path(name), "ab") as stream:
                stream.write(b" ")
            os.utime(self.path(name), (1e9, 1e9))
            out, _ = self.run_tdpt(*words, "--dry-run")
            self.assertIn("/tdpt-render", out, f"{name} has changed")
            with open(self.path(name), "wb") as stream:
                stream.write(before)
            _, err = self.run_tdpt(*words)
            self.assertIn("is up to date", err)
        os.rename(self.path("loose.png"), self.path("away.png"))
        out, _ = self.run_tdpt(*words, "--dry-run")
        self.assertIn("/tdpt-render", out, "a texture is gone")

    def test_a_scene_that_is_saved_under_way(self):
        child = self.start("room.glb", "-o", "p.exr", *QUICK, env=SLOW)
        self.scene("furnace", "new.glb")
        with self.held("ffgraph"):
            os.replace(self.path("new.glb"), self.path("room.glb"))
        err = child.communicate()[1].decode()
        self.assertEqual(child.returncode, 3, err)
        self.assertIn("room.glb: has changed while tdpt was at work; start it again", err)
        self.run_tdpt("room.glb", "-o", "p.exr", *QUICK, env=SLOW)
        self.run_tdpt("room.glb", "-o", "alone.exr", *QUICK, "--work", "fresh", env=SLOW)
        self.assertEqual(self.bytes_of("p.exr"), self.bytes_of("alone.exr"))

    def pids_of(self, program):
        found = []
        for pid in self.processes():
            try:
                if os.path.basename(os.readlink(f"/proc/{pid}/exe")) == program:
                    found.append(pid)
            except OSError:  # it has ended
                pass
        return found

    # Runs side by side.

    def test_side_by_side(self):
        cameras = {"a.exr": ["--look-from", "-1,1,0", "--look-at", "1,1,0"], "b.exr": ["--frame"], "c.exr": []}
        children = {name: self.start("room.glb", "-o", name, *QUICK, *words) for name, words in cameras.items()}
        children["c2"] = self.start("room.glb", "-o", "c.exr", *QUICK)
        children["d.exr"] = self.start("room.glb", "-o", "d.exr", *QUICK)
        for name, child in children.items():
            err = child.communicate()[1].decode()
            self.assertEqual(child.returncode, 0, f"{name}: {err}")
        for name, words in cameras.items():
            self.run_tdpt("room.glb", "-o", "alone-" + name, *QUICK, *words, "--work", "alone")
            self.assertEqual(self.bytes_of(name), self.bytes_of("alone-" + name), name)
        self.assertEqual(self.bytes_of("c.exr"), self.bytes_of("d.exr"))
        # To and fro costs no stage.
        for name, words in cameras.items():
            out, _ = self.run_tdpt("room.glb", "-o", "e.exr", *QUICK, *words, "--dry-run")
            self.assertNotIn("ffgraph", out)

    def test_two_commands_for_one_picture(self):
        first = self.start("room.glb", "-o", "p.exr", *QUICK, env=SLOW)
        with self.held("ffgraph"):
            self.run_tdpt("room.glb", "-o", "p.exr", *QUICK, env=SLOW)  # makes the same portals
            before = self.bytes_of("p.exr")
        err = first.communicate()[1].decode()
        self.assertEqual(first.returncode, 0, err)
        self.assertEqual(self.bytes_of("p.exr"), before)
        _, err = self.run_tdpt("room.glb", "-o", "p.exr", *QUICK, env=SLOW)
        self.assertIn("is up to date", err)

    def test_a_scene_that_is_saved_while_it_renders(self):
        child = self.start("room.glb", "-o", "p.exr", *LONG)
        self.scene("furnace", "new.glb")
        with self.held("tdpt-render", self.film):
            os.replace(self.path("new.glb"), self.path("room.glb"))
        err = child.communicate()[1].decode()
        self.assertEqual(child.returncode, 0, err)
        self.assertIn("room.glb has changed while tdpt was at work; the same command renders it", err)
        _, err = self.run_tdpt("room.glb", "-o", "p.exr", *LONG)  # the picture is tdpt's, and of no command
        self.assertIn("wrote p.exr", err)

    # Names.

    def test_names_are_never_run(self):
        planted = "touch ${HOME}ran"
        names = ["a$(id>ran).glb", "a`id>ran`&it's (1);b #c%d.glb", "-a.glb", "line\nbreak.glb", "\udcff.glb"]
        for name in names:
            with self.subTest(name):
                self.scene("two-rooms", name)
                picture = name[:-4] + ".exr"
                scene = name if not name.startswith("-") else "./" + name
                self.run_tdpt(scene, "-o", "./" + picture, *QUICK)
                out, _ = self.run_tdpt(scene, "-o", "./2" + picture, *QUICK, "--dry-run")
                subprocess.run(["sh", "-e"], input=out.encode("utf-8", "surrogateescape"), cwd=self.here, check=True,
                               capture_output=True)
                self.assertEqual(self.bytes_of(picture), self.bytes_of("2" + picture))
        for words in (["--seed", "1;id>ran"], ["--quality", "draft;id>ran"], ["--environment", "1,1,1;id>ran"],
                      ["--device", f"gpu;{planted}"]):
            self.run_tdpt("room.glb", "-o", "x.exr", *words, expect=2)
        _, err = self.run_tdpt("room.glb", "-o", "x.exr", "--environment", "$(id>ran)", expect=3)
        self.assertIn("$(id>ran): cannot be opened", err)
        self.assertEqual([name for name in os.listdir(self.here) if name.endswith("ran")], [])

    # Signals.

    def stop(self, number, to="child", program="tdpt-render"):
        renders = program == "tdpt-render"
        child = self.start("room.glb", "-o", "p.exr", *LONG, start_new_session=True, env={} if renders else SLOW)
        with self.held(program, self.film if renders else None):
            (os.killpg if to == "group" else os.kill)(child.pid, number)
        err = child.communicate()[1].decode()
        return child.returncode, err

    def test_a_signal_leaves_the_picture_and_the_next_run_goes_on(self):
        self.whole()
        for number, to in ((signal.SIGTERM, "child"), (signal.SIGINT, "group")):
            with self.subTest(f"{number} to {to}"):
                code, err = self.stop(number, to)
                self.assertEqual(code, 6, err)
                self.assertIn("tdpt: p.exr has what was rendered until then\ntdpt: stopped while rendering; the same command goes on\n", err)
                self.assertEqual(self.processes(), [])
                self.assertNotEqual(self.bytes_of("p.exr"), self.whole())
                _, err = self.run_tdpt("room.glb", "-o", "p.exr", *LONG)
                self.assertIn("goes on from", err)
                self.assertEqual(self.bytes_of("p.exr"), self.whole())
                self.assertEqual(sorted(os.listdir(self.here)), ["p.exr", "room.glb"])
                os.remove(self.path("p.exr"))
                shutil.rmtree(self.cache)  # the film of this one

    def test_a_signal_before_the_picture(self):
        code, err = self.stop(signal.SIGTERM, program="ffgraph")
        self.assertEqual(code, 6)
        self.assertIn("tdpt: stopped while tracing where light goes; the same command goes on\n", err)
        self.assertEqual(self.processes(), [])
        self.assertEqual(os.listdir(self.here), ["room.glb"])
        self.run_tdpt("room.glb", "-o", "p.exr", *LONG)

    def test_what_lightgrid_has_when_it_is_stopped_is_not_taken_for_whole(self):
        many = {"LIGHTGRID_FLAGS": "--quality high"}
        child = self.start("room.glb", "-o", "p.exr", *QUICK, env=many)
        with self.held("lightgrid", lambda: self.runs("lightgrid")() and time.sleep(0.1) is None):  # it handles signals by then
            child.terminate()
        err = child.communicate()[1].decode()
        self.assertEqual(child.returncode, 6, err)
        self.assertIn("the grid holds what was drawn until then", err)
        self.run_tdpt("room.glb", "-o", "p.exr", *QUICK, env=many)
        self.run_tdpt("room.glb", "-o", "alone.exr", *QUICK, "--work", "alone", env=many)
        self.assertEqual(self.bytes_of("p.exr"), self.bytes_of("alone.exr"))

    def test_a_signal_that_is_ignored_stays_ignored(self):
        def ignore():
            signal.signal(signal.SIGHUP, signal.SIG_IGN)
        child = self.start("room.glb", "-o", "p.exr", *QUICK, preexec_fn=ignore, start_new_session=True, env=SLOW)
        with self.held("ffgraph"):
            os.killpg(child.pid, signal.SIGHUP)
        self.assertEqual(child.wait(), 0)
        child.communicate()

    def test_outlives_its_parent(self):
        words = [TDPT, "room.glb", "-o", "p.exr", *QUICK]
        shell = subprocess.Popen(["sh", "-c", '"$@" 2>err & sleep 60', "sh", *words], cwd=self.here,
                                 env={**self.env, **SLOW})
        with self.held("ffgraph"):
            shell.kill()
            shell.wait()
        self.wait_until(lambda: os.path.exists(self.path("p.exr")) and not self.pids_of("tdpt"), "the picture")
        for pid in self.processes():  # the shell's sleep
            os.kill(pid, signal.SIGKILL)

    def test_kills_leave_nothing_behind(self):
        words = ["room.glb", "-o", "p.exr", "--preview", "--spp", "16", "--width", "48", "--set", "checkpoint-every=0"]
        began = time.monotonic()
        self.run_tdpt("room.glb", "-o", "whole.exr", *words[3:])
        lasts = time.monotonic() - began
        draw = random.Random(7)
        remaining = finished = 0
        for i in range(KILLS):
            if i % 5 == 0:  # through the stages, too
                shutil.rmtree(os.path.join(self.cache, "tdpt"), ignore_errors=True)
                for name in ("p.exr", "p.png"):
                    if os.path.exists(self.path(name)):
                        os.remove(self.path(name))
            child = self.start(*words)
            time.sleep(draw.random() * lasts)
            number = draw.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
            child.send_signal(number)
            err = child.communicate()[1].decode()
            self.assertIn(child.returncode, (0, 6, -number), err)
            finished += child.returncode == 0
            end = time.monotonic() + 2
            while self.processes() and time.monotonic() < end:
                time.sleep(0.005)
            remaining += len(self.processes())
            self.assertLessEqual(set(os.listdir(self.here)), {"p.exr", "p.png", "room.glb", "whole.exr", "whole.png"})
        self.assertEqual(remaining, 0)
        self.assertLess(finished, 0.9 * KILLS, "the kills came too late to mean anything")
        self.run_tdpt(*words)
        self.assertEqual(self.bytes_of("p.exr"), self.bytes_of("whole.exr"))
        self.assertEqual(self.bytes_of("p.png"), self.bytes_of("whole.png"))
        left = [name for _, _, files in os.walk(self.cache) for name in files if name.startswith(".tdpt-")]
        self.assertEqual(left, [])
        for name in os.listdir(os.path.join(self.cache, "tdpt")):
            if name.startswith("run-"):
                os.utime(os.path.join(self.cache, "tdpt", name), (1e9, 1e9))
        self.run_tdpt(*words)
        self.assertEqual([name for name in os.listdir(os.path.join(self.cache, "tdpt")) if name.startswith("run-")], [])

    def test_a_report_that_is_killed_leaves_no_process(self):
        def measures():
            return any(b"/report/with.0.exr" in self.command_of(pid) for pid in self.pids_of("tdpt-render"))
        child = self.start("room.glb", "-o", "p.exr", *QUICK, "--report", "--threads", "1", env={"REPORT_TIME": "24", "REPORT_WIDTH": "64"})
        # What is stopped, and outlives a kill, is there for as long as is looked.
        with self.held("tdpt-render", measures):
            child.kill()
            self.assertEqual(child.wait(), -signal.SIGKILL)
            self.wait_until(lambda: not self.processes(), "all have ended", 2)
        child.communicate()
        self.assertEqual(sorted(os.listdir(self.here)), ["p.exr", "room.glb"])

    # What it says.

    def test_progress_is_one_line_or_json(self):
        _, err = self.run_tdpt("room.glb", "-o", "p.exr", *QUICK, "--set", "progress=json", "--quiet")
        steps = [json.loads(line)["progress"] for line in err.splitlines()]
        self.assertEqual([s["program"] for s in steps if "what" not in s],
                         ["tdpt-render", "ffgraph", "mincut", "lightgrid", "portalfit", "tdpt-render"])
        self.assertTrue(all(1 <= s["step"] <= s["steps"] == 6 for s in steps), steps)
        script = subprocess.run(["script", "-qec", f"{TDPT} room.glb -o t.exr --spp 60 --width 64", "/dev/null"], cwd=self.here,
                                env=self.env, capture_output=True, stdin=subprocess.DEVNULL, check=False)
        if script.returncode != 0 and b"script:" in script.stdout + script.stderr:
            self.skipTest("no pseudo-terminal")
        self.assertRegex(script.stdout.decode(), r"\[2/2\] rendering")

    def test_a_picture_to_look_at_comes_first(self):
        child = self.start("room.glb", "-o", "p.exr", *QUICK, "--preview", env=SLOW)
        with self.held("ffgraph"):  # where the preview waits for the stages, there is none
            self.wait_until(lambda: os.path.exists(self.path("p.png")), "a preview")
            self.assertFalse(os.path.exists(self.path("p.exr")))
            first = self.bytes_of("p.png")
        self.assertEqual(child.wait(), 0)
        child.communicate()
        self.assertNotEqual(self.bytes_of("p.png"), first)

    def test_portals_only_where_they_are_of_use(self):
        for integrator, stages in (("pt", 0), ("bdpt", 0), ("nee", 0), ("tdpt", 4), ("auto", 4)):
            out, _ = self.run_tdpt("room.glb", "-o", "p.exr", "--integrator", integrator, "--dry-run")
            self.assertEqual(len(re.findall("/(ffgraph|mincut|lightgrid|portalfit) ", out)), stages, integrator)
        out, _ = self.run_tdpt("room.glb", "-o", "p.exr", "--integrator", "nee", "--environment", "1,1,1", "--dry-run")
        self.assertIn("/ffgraph ", out)

    # The folder of work.

    def test_the_cache_is_bounded_and_emptied(self):
        def entries():
            return [name for name in os.listdir(os.path.join(self.cache, "tdpt")) if name.startswith("portals-")]
        for seed in ("1", "2", "3"):
            self.run_tdpt("room.glb", "-o", seed + ".exr", *QUICK, "--seed", seed)
        self.assertEqual(len(entries()), 3)
        def used(name):
            return os.path.getmtime(os.path.join(self.cache, "tdpt", name))
        last = max(entries(), key=used)
        film = max((name for name in os.listdir(os.path.join(self.cache, "tdpt")) if name.startswith("film-")), key=used)
        size = sum(os.path.getsize(os.path.join(self.cache, "tdpt", entry, name)) for entry in (last, film)
                   for name in os.listdir(os.path.join(self.cache, "tdpt", entry)))
        self.run_tdpt("room.glb", "-o", "3.exr", *QUICK, "--seed", "3", "--work-size", str(size + 1))
        self.assertEqual(entries(), [last])
        self.run_tdpt("--clean")
        self.assertEqual(entries(), [])
        # What was made is still known.
        _, err = self.run_tdpt("room.glb", "-o", "3.exr", *QUICK, "--seed", "3")
        self.assertIn("is up to date", err)

    def test_a_checkpoint_that_is_damaged_is_left(self):
        self.stop(signal.SIGTERM)
        with open(self.film(), "r+b") as stream:
            stream.truncate(1000)
        _, err = self.run_tdpt("room.glb", "-o", "p.exr", *LONG)
        self.assertIn("what the run before left cannot be used; begins with the first sample", err)
        self.assertEqual(self.bytes_of("p.exr"), self.whole())

    def test_nobody_reads_what_it_says(self):
        for more in ("2>/dev/full", "<&- >&- 2>&-"):
            subprocess.run(["sh", "-c", f'"$@" {more}', "sh", TDPT, "room.glb", "-o", "p.exr", "--force", *QUICK], cwd=self.here,
                           env=self.env, check=True)
            os.remove(self.path("p.exr"))

    def test_a_cache_that_goes_while_it_renders(self):
        child = self.start("room.glb", "-o", "p.exr", *LONG)
        with self.held("tdpt-render", self.film):
            shutil.rmtree(self.cache, ignore_errors=True)
        err = child.communicate()[1].decode()
        self.assertEqual(child.returncode, 4, err)
        self.assertIn("the picture is kept in", err)
        self.run_tdpt("room.glb", "-o", "p.exr", *LONG)


class Timed(unittest.TextTestResult):
    def startTest(self, test):
        self.began = time.monotonic()
        super().startTest(test)

    def stopTest(self, test):
        print(f"{time.monotonic() - self.began:6.1f} s  {test._testMethodName}", flush=True)
        super().stopTest(test)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *("Tdpt." + name for name in sys.argv[3:])],
                  testRunner=unittest.TextTestRunner(resultclass=Timed))
