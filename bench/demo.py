"""`make demo`: a furnished room whose light comes past a door ajar, in the same time without its portals, with them, and
filtered."""
import os
import subprocess
from pathlib import Path

import formats
import numpy as np
import pages
from common import ROOT, TESTDATA, Setting, settings

ROOM = TESTDATA / "demo/furnished.glb"
NAMES = {"without": "without portals", "portals": "with portals", "filtered": "and filtered"}
GAP = 8  # pixels between panels


def sentence(seconds, off):
    """What the pictures are worth, in words, by what exrdiff says of each."""
    gain = off["without"]["relmse"] / off["portals"]["relmse"]
    words = (f"After the same {seconds:g} seconds the error (relMSE) with portals is {gain:.1f} times smaller: without them "
             f"it would take about {seconds * gain:.0f} seconds." if gain > 1 else "Portals are not worth it here.")
    return f"{words} Filtered, it is {off['without']['relmse'] / off['filtered']['relmse']:.0f} times smaller."


def psnr_as_shown(picture, truth):
    """On a screen: the middle of the truth is middle grey, and what is too bright is white."""
    shown = [np.clip(0.18 / np.median(truth) * p, 0, 1) ** (1 / 2.2) for p in (picture, truth)]
    return -10 * np.log10(np.mean((shown[0] - shown[1]) ** 2))


@settings(SCENE=Setting(str(ROOM), "a room that is lit from the next one"), WIDTH=Setting(480, "of a picture", 96),
          SECONDS_EACH=Setting(20.0, "of a picture", 1.0))
def demo(bench):
    """Finds the portals of a room, renders it without them and with them in the same time, filters the latter, and leaves the
    three side by side and a plan of the portals in CACHE. A second run shows what is there."""
    s, out, scene = bench.settings, os.path.relpath(bench.cache), Path(bench.settings.scene).resolve()
    os.chdir(bench.cache)

    def run(made, *words):
        """Shows a command as one would type it, then runs it, unless what it makes is there."""
        print("  $", " ".join(map(str, words)).replace(f"{ROOT}/", "").replace(str(scene), scene.name), flush=True)
        program, done = bench.store.program(words[0]), Path(f".{made}.done")
        stamp = "\n".join(map(str, (bench.store.sum_of(program), bench.store.sum_of(scene), *words)))
        if Path(made).exists() and done.exists() and done.read_text() == stamp:
            return
        if status := subprocess.run([program, *map(str, words[1:])], check=False).returncode:
            raise SystemExit(status)
        done.write_text(stamp)

    print(f"Finding the portals of {scene.name}")
    run("room.max", "ffgraph", scene, "-o", "room.max", "--quiet")
    run("room.cut", "mincut", "room.max", "-o", "room.cut", "--quiet")
    run("room.vdb", "lightgrid", scene, "room.cut", "-o", "room.vdb", "--quiet")
    run("room.portal.glb", "portalfit", "room.vdb", "-o", "room.portal.glb", "--preview", "plan.png")
    print(f"\nRendering for {s.seconds_each:g} seconds without portals, then with them")
    render = ("--time", f"{s.seconds_each:g}", "--width", s.width, "--aov", "halves,albedo,normal,depth")
    run("without.exr", "tdpt-render", scene, *render, "-o", "without.exr")
    run("portals.exr", "tdpt-render", scene, "--portal", "room.portal.glb", *render, "-o", "portals.exr")
    run("filtered.exr", "exrdenoise", "portals.exr", "-o", "filtered.exr")

    pictures = [formats.exr_read(f"{name}.exr") for name in NAMES]
    gap = np.ones((len(pictures[0]), GAP, 3))
    formats.exr_write("panels.exr", np.hstack([pictures[0], gap, pictures[1], gap, pictures[2]]))
    run("demo.png", "exrmerge", "panels.exr", "-o", "demo.png", "--quiet")
    reference = ROOM.with_suffix(".exr")
    truth = formats.exr_read(reference)
    if scene == ROOM and truth.shape == pictures[0].shape:
        off = {name: bench.fresh("exrdiff", f"{name}.exr", reference).said for name in NAMES}
        black = off["portals"]["black"]["relmse"]
        print(f"\n  {'':17} {'relMSE':>8} {'PSNR [dB], as shown':>21}")
        for words, relmse, picture in (*((words, off[name]["relmse"], picture) for (name, words), picture in
                                         zip(NAMES.items(), pictures)), ("a black picture", black, 0 * truth)):
            print(f"  {words:17} {pages.three(relmse):>8} {psnr_as_shown(picture, truth):21.1f}")
        print(f"\n{sentence(s.seconds_each, off)}")
    print(f"\n{out}/demo.png shows the three side by side, {out}/plan.png the portals.")
