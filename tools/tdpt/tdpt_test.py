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
KILLS = int(os.environ.get("KILLS", "15"))  # 50 in make test-long
# A rendering whose first film is there long before its end; tests stop the program there, whatever the machine's speed.
PICTURE = ["--spp", "30", "--width", "64", "--integrator", "tdpt-guided"]
LONG = [*PICTURE, "--set", "checkpoint-every=0", "--threads", "1"]
# An ffgraph that is easily met at work.
SLOW = {"FFGRAPH_FLAGS": "--set walks=20000 --samples 200000 --set rounds=0"}


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

    def provenance(self, name):
        return subprocess.run([os.path.join(BIN, "tdpt-info"), self.path(name)], check=True, capture_output=True,
                              text=True).stdout

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
        for number in (signal.SIGTERM, signal.SIGKILL):
            self.stop(number)
            with open(self.path("p.exr"), "wb") as stream:
                stream.write(b"by hand")
            self.run_tdpt("room.glb", "-o", "p.exr", *LONG, expect=2)
            self.assertEqual(self.bytes_of("p.exr"), b"by hand")
            os.remove(self.path("p.exr"))

    def test_equal_pictures_of_two_commands(self):
        os.mkdir(self.path("a"))
        os.mkdir(self.path("b"))
        for name in "ab":
            self.scene("two-rooms", f"{name}/room.glb")
            self.run_tdpt(f"{name}/room.glb", "-o", f"{name}/p.exr", *QUICK, "--preview")
        self.assertEqual(self.bytes_of("a/p.exr"), self.bytes_of("b/p.exr"))
        self.run_tdpt("a/room.glb", "-o", "a/q.exr", *QUICK)
        _, err = self.run_tdpt("a/room.glb", "-o", "a/p.exr", *QUICK, "--preview")
        self.assertIn("is up to date", err)
        self.scene("window", "a/room.glb")
        open(self.path("2"), "w").close()  # the value of an option is no file
        self.run_tdpt("a/room.glb", "-o", "a/p.exr", *QUICK, "--preview")

    def test_preview_has_the_exposure_that_is_asked_for(self):
        words = ["room.glb", "-o", "p.exr", *QUICK]
        self.run_tdpt(*words)
        made = os.stat(self.path("p.exr"))
        previews = {}
        for exposure in ([], ["--exposure=-3"], ["--exposure=2"], []):
            _, err = self.run_tdpt(*words, "--preview", *exposure)
            self.assertIn("tdpt: wrote p.png\n", err)
            self.assertNotIn("rendering", err)
            _, err = self.run_tdpt(*words, "--preview", *exposure)
            self.assertNotIn("wrote", err)
            png = self.bytes_of("p.png")
            self.assertEqual(previews.setdefault(str(exposure), png), png)
        self.assertEqual(len(set(previews.values())), 3)
        after = os.stat(self.path("p.exr"))
        self.assertEqual((after.st_ino, after.st_mtime_ns), (made.st_ino, made.st_mtime_ns))
        # As the renderer shows it.
        self.run_tdpt(*words[:2], "q.exr", *QUICK, "--preview")
        self.assertEqual(self.bytes_of("q.png"), self.bytes_of("p.png"))
        os.remove(self.path("p.png"))
        out, _ = self.run_tdpt(*words, "--preview", "--exposure=2", "--dry-run")
        subprocess.run(["sh", "-c", out], cwd=self.here, check=True, stderr=subprocess.DEVNULL)
        self.assertEqual(self.bytes_of("p.png"), previews["['--exposure=2']"])

    def test_its_own_picture_is_replaced_by_another_command(self):
        self.run_tdpt("room.glb", "-o", "p.exr", *QUICK)
        self.scene("furnace", "other.glb")
        for words in (["other.glb", *QUICK], ["room.glb", *QUICK, "--seed", "2"], ["room.glb", "--spp", "2", "--width", "12"],
                      ["room.glb", *QUICK]):
            _, err = self.run_tdpt(*words, "-o", "p.exr")
            self.assertIn("wrote p.exr", err)
            self.assertEqual("goes on from" in err, words == ["room.glb", *QUICK], err)  # the film is still there
            self.run_tdpt(*words, "-o", "alone.exr", "--work", "alone")
            self.assertEqual(self.bytes_of("p.exr"), self.bytes_of("alone.exr"), words)
        # One that was changed since is nobody's.
        before = self.bytes_of("p.exr")
        with open(self.path("p.exr"), "ab") as stream:
            stream.write(b" ")
        _, err = self.run_tdpt("room.glb", *QUICK, "--seed", "3", "-o", "p.exr", expect=2)
        self.assertIn("p.exr: is there already, and tdpt did not make it; --force replaces it", err)
        with open(self.path("p.exr"), "wb") as stream:
            stream.write(before)
        # What shapes nothing makes no other command; a picture that was moved is known.
        os.rename(self.path("p.exr"), self.path("q.exr"))
        _, err = self.run_tdpt("room.glb", "-o", "q.exr", *QUICK, "--threads", "1")
        self.assertIn("q.exr is up to date", err)

    def test_more_samples_go_on_from_those_that_are_there(self):
        def same(a, b):
            out = subprocess.run([os.path.join(BIN, "exrdiff"), "--json", self.path(a), self.path(b)], check=True, capture_output=True)
            return json.loads(out.stdout)["mse"] == 0
        words = ["room.glb", "-o", "p.exr", "--width", "16", "--integrator", "bdpt"]
        self.run_tdpt(*words, "--spp", "4")
        for spp, goes_on in (("8", True), ("9", True), ("6", False), ("6", None)):
            _, err = self.run_tdpt(*words, "--spp", spp)
            self.assertEqual("goes on from" in err and "begins with the first sample" not in err, goes_on is True, err)
            self.assertEqual("is up to date" in err, goes_on is None, err)
            self.run_tdpt(*words[:2], "alone.exr", *words[3:], "--spp", spp, "--work", "alone" + spp)
            self.assertTrue(same("p.exr", "alone.exr"), spp)
            os.remove(self.path("alone.exr"))
        # With another seed, or without a number, it is another picture.
        for more in (["--spp", "12", "--seed", "2"], ["--seed", "2"]):
            _, err = self.run_tdpt(*words, *more)
            self.assertNotIn("goes on from", err)
        _, err = self.run_tdpt(*words, "--seed", "2", "--spp", "20")  # of the 16 that it has by default
        self.assertIn("goes on from", err)

    def test_an_older_scene_is_another_scene(self):
        self.run_tdpt("room.glb", "-o", "p.exr", *QUICK)
        first = self.bytes_of("p.exr")
        self.scene("window", "room.glb")
        self.run_tdpt("room.glb", "-o", "p.exr", *QUICK)
        self.assertNotEqual(self.bytes_of("p.exr"), first)
        # A backup is restored, with its time.
        self.scene("two-rooms", "room.glb")
        os.utime(self.path("room.glb"), (1e9, 1e9))
        self.run_tdpt("room.glb", "-o", "p.exr", *QUICK)
        self.assertEqual(self.bytes_of("p.exr"), first)
        # A clock that went on, and a file that only looks new, make nothing.
        os.utime(self.path("room.glb"))
        _, err = self.run_tdpt("room.glb", "-o", "p.exr", *QUICK)
        self.assertIn("is up to date", err)

    def test_textures_and_skies_count(self):
        subprocess.run(["sh", os.path.join(TESTDATA, "..", "libcommon", "testing", "files", "loose_scene.sh"), self.path("room.glb"),
                        self.path("loose")], check=True, cwd=self.here)
        shutil.copyfile(os.path.join(TESTDATA, "environments", "clear.exr"), self.path("sky.exr"))
        words = ["loose.gltf", "-o", "p.exr", *QUICK, "--environment", "sky.exr"]
        self.run_tdpt(*words)
        for name in ("loose.png", "loose.bin", "sky.exr"):
            _, err = self.run_tdpt(*words)
            self.assertIn("is up to date", err)
            before = self.bytes_of(name)
            with open(self.path(name), "ab") as stream:
                stream.write(b" ")
            out, _ = self.run_tdpt(*words, "--dry-run")
            self.assertIn("/tdpt-render", out, f"{name} has changed")
            with open(self.path(name), "wb") as stream:
                stream.write(before)
        os.rename(self.path("loose.png"), self.path("away.png"))
        out, _ = self.run_tdpt(*words, "--dry-run")
        self.assertIn("/tdpt-render", out, "a texture is gone")

    def test_a_scene_that_is_saved_under_way(self):
        for program, env in (("ffgraph", SLOW), ("lightgrid", None)):
            with self.subTest(program):
                self.scene("two-rooms", "room.glb")
                shutil.rmtree(self.cache, ignore_errors=True)
                child = self.start("room.glb", "-o", program + ".exr", *QUICK, env=env)
                self.scene("furnace", "new.glb")
                with self.held(program):
                    os.replace(self.path("new.glb"), self.path("room.glb"))
                err = child.communicate()[1].decode()
                self.assertEqual(child.returncode, 3, err)
                self.assertIn("room.glb: has changed while tdpt was at work; start it again", err)
                self.run_tdpt("room.glb", "-o", program + ".exr", *QUICK, env=env)
                self.run_tdpt("room.glb", "-o", "alone.exr", *QUICK, "--work", "fresh", env=env)
                self.assertEqual(self.bytes_of(program + ".exr"), self.bytes_of("alone.exr"))
                os.remove(self.path("alone.exr"))

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
        names = ["a$(id>ran).glb", "a`id>ran`b.glb", "a&id>ran&b.glb", "kitchen(1).glb", "My flat.glb", "it's.glb", "a;b #c%d.glb",
                 "-a.glb", "line\nbreak.glb", "\udcff.glb"]
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
        folder = os.path.join(self.here, "My Scenes")
        os.mkdir(folder)
        shutil.copyfile(self.path("room.glb"), os.path.join(folder, "My flat.glb"))
        self.run_tdpt("My Scenes/My flat.glb", "-o", "My Scenes/My flat.exr", *QUICK, "--preview", "--work", "My Scenes/work here")

    def test_dry_run_prints_what_can_be_run(self):
        words = ["room.glb", *QUICK, "--quality", "draft", "--look-from", "-1,1,0", "--look-at=2,1,0", "--fov", "40"]
        out, _ = self.run_tdpt(*words, "-o", "by-hand.exr", "--work", "dry", "--dry-run")
        self.assertEqual(os.listdir(self.here), ["room.glb"])
        subprocess.run(["sh", "-e"], input=out, text=True, cwd=self.here, check=True, capture_output=True)
        self.run_tdpt(*words, "-o", "by-tdpt.exr")
        self.assertEqual(self.bytes_of("by-hand.exr"), self.bytes_of("by-tdpt.exr"))

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
        for number, to in ((signal.SIGTERM, "child"), (signal.SIGINT, "group"), (signal.SIGHUP, "child")):
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

    def test_what_is_said_of_a_resumed_picture_is_what_is_said_of_a_whole_one(self):
        def told(err):
            lines = [line for line in err.splitlines() if line.startswith("tdpt-render: ") and "goes on from" not in line]
            return [re.sub(r"[0-9.]+ (s|CPU s|minutes)\b", "T", line) for line in lines]

        def stats(name):
            with open(self.path(name), encoding="utf-8") as stream:
                text = stream.read()
            return json.loads(re.sub('"(seconds|cpu_seconds|cpu)":[^,}]*', r'"\1":0', text))
        words = ["room.glb", "--spp", "30", "--width", "64", "--set", "checkpoint-every=0", "--threads", "1", "--stats"]
        _, whole = self.run_tdpt(*words, "whole.json", "-o", "whole.exr", "--work", "whole")
        child = self.start(*words, "p.json", "-o", "p.exr")
        with self.held("tdpt-render", self.film):
            child.kill()
        child.communicate()
        _, err = self.run_tdpt(*words, "p.json", "-o", "p.exr")
        self.assertIn("goes on from", err)
        # What was measured before the first samples is said by the run that measured it.
        self.assertEqual(told(err)[0], "tdpt-render: rendering with tdpt-guided")
        self.assertEqual(told(err)[1:], told(whole)[2:])
        measured = ("pilot", "frames")
        self.assertTrue(set(measured) <= stats("whole.json").keys())
        self.assertEqual(*({key: value for key, value in stats(name).items() if key not in measured}
                           for name in ("p.json", "whole.json")))

    def test_a_signal_before_the_picture(self):
        code, err = self.stop(signal.SIGTERM, program="ffgraph")
        self.assertEqual(code, 6)
        self.assertIn("tdpt: stopped while tracing where light goes; the same command goes on\n", err)
        self.assertEqual(self.processes(), [])
        self.assertEqual(os.listdir(self.here), ["room.glb"])
        self.run_tdpt("room.glb", "-o", "p.exr", *LONG)

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
        words = ["room.glb", "-o", "p.exr", "--preview", "--spp", "30", "--width", "48", "--set", "checkpoint-every=0"]
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
        # Its first rendering takes 1.5 s. What is stopped, and outlives a kill, is there for as long as is looked.
        for number, code, seconds in ((signal.SIGKILL, -9, 2), (signal.SIGTERM, 6, 1)):
            child = self.start("room.glb", "-o", "p.exr", *QUICK, "--report", "--threads", "1",
                               env={"REPORT_TIME": "24", "REPORT_WIDTH": "64"})
            with self.held("tdpt-render", measures) if number == signal.SIGKILL else contextlib.nullcontext():
                self.wait_until(measures, "the report is measured")
                child.send_signal(number)
                err = child.communicate()[1].decode()
                self.assertEqual(child.returncode, code, err)
                self.wait_until(lambda: not self.processes(), "all have ended", seconds)
            self.assertEqual(sorted(os.listdir(self.here)), ["p.exr", "room.glb"])

    # What it says.

    def test_a_report_says_how_long_it_takes(self):
        _, err = self.run_tdpt("room.glb", "-o", "p.exr", *QUICK, "--report", env={"REPORT_TIME": "0.2", "REPORT_WIDTH": "16",
                                                                               "REPORT_REFERENCE": "2"})
        self.assertRegex(err, r"report: renders 16 pixels wide, .* for 0\.2 CPU seconds each, and a reference for about 0\.4: about [0-9]+ s")
        for number in (1, 2, 3):
            self.assertRegex(err, f"report: {number} of 3: .*, about [0-9]+ s")

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

    def test_folders_of_others_stay(self):
        for name in ("w/picture-finals", "w/portals-of-the-church"):
            os.makedirs(self.path(name))
        self.run_tdpt("--clean", "--work", "w", expect=2)
        _, err = self.run_tdpt("room.glb", "-o", "p.exr", *QUICK, "--work", "w", "--work-size", "1", expect=2)
        self.assertIn("has other things in it, expected a folder of its own", err)
        self.run_tdpt("room.glb", "-o", "p.exr", *QUICK)
        work = os.path.join(self.cache, "tdpt")
        os.mkdir(os.path.join(work, "portals-of-the-church"))
        self.run_tdpt("--clean")
        self.assertIn("portals-of-the-church", os.listdir(work))
        self.assertEqual(sorted(os.listdir(self.path("w"))), ["picture-finals", "portals-of-the-church"])

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
