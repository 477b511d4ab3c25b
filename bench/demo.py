"""A portal for a room lit through a hole, and what it is good for: `make demo`."""
import os
import re
import subprocess
from pathlib import Path

import pages
from common import ROOT, TESTDATA, Setting, measure, settings


def comparison(seconds, bdpt, portal, cpu, noisy):
    """What two pictures of so many seconds are worth, in words; bdpt, portal: what exrdiff says of them, cpu: CPU
    seconds that they got; noisy: whether the reference is about as short."""
    gain, decibels = bdpt["relmse"] / portal["relmse"], portal["psnr"] - bdpt["psnr"]
    if gain >= 1:
        words = f"""In the same {seconds:g} seconds the portal makes the error {gain:.1f} times smaller (relMSE), \
and the
picture {abs(decibels):.1f} dB {'worse' if decibels < 0 else 'better'} (PSNR). \
Since the error falls with time, bdpt alone would need
about {seconds * gain:.0f} seconds for the same."""
        if noisy:
            words += "\nThe reference has noise of its own, which counts against both: the true gain is larger."
    else:
        words = f"""In the same {seconds:g} seconds the error is {1 / gain:.1f} times larger with the portal (relMSE), \
PSNR differs
by {decibels:+.1f} dB: this scene is better rendered without."""
    black = portal["black"]["relmse"]
    if bdpt["relmse"] > 0.5 * black:
        words += f"\nA picture of no light at all scores {black:.3g}: bdpt has found little here."
    if max(cpu) > 1.1 * min(cpu):
        words += f"\nBut the machine was busy: bdpt got {cpu[0]:.0f} CPU seconds and the portal {cpu[1]:.0f}; " \
                 "try again when it is idle."
    return words


@settings(SCENE=Setting(str(TESTDATA / "scenes/two-rooms.glb"), "a room lit through a hole"),
          SECONDS_EACH=Setting(20.0, "of a picture", 1.0),
          SECONDS_REFERENCE=Setting(90.0, "of the reference, where testdata/references has none of the scene", 4.0),
          WIDTH=Setting(160, "of the pictures"), HEIGHT=Setting(120, ""),
          DEPTH=Setting("none", "edges of the longest path; none: the whole light"))
def demo(bench):
    """Finds the portal of a room, renders with bdpt and through the portal in the same time, compares both with a
    reference, and leaves everything in CACHE."""
    s, out, scene = bench.settings, os.path.relpath(bench.cache), Path(bench.settings.scene).resolve()
    os.chdir(bench.cache)
    size = ["--width", s.width, "--height", s.height, *(() if s.depth == "none" else ("--max-depth", s.depth))]

    def run(*words):
        """Shows a command as one would type it, then runs it."""
        print("  $", " ".join(map(str, words)).replace(f"{ROOT}/", "").replace(str(scene), scene.name), flush=True)
        if status := subprocess.run([bench.store.program(words[0]), *map(str, words[1:])], check=False).returncode:
            raise SystemExit(status)

    print(f"This ends on {out}/before-after.png: the room without and with the portal, side by side, after "
          f"{s.seconds_each:g} seconds each.\n\nFinding the portal")
    run("ffgraph", scene, "-o", "room.max", "--quiet")
    run("mincut", "room.max", "-o", "room.cut", "--quiet")
    run("lightgrid", scene, "room.cut", "-o", "room.vdb", "--quiet")
    run("portalfit", "room.vdb", "-o", "room.portal.glb")
    print(f"\nRendering for {s.seconds_each:g} seconds each, without the portal and with it")
    for name, how in (("bdpt", ("--integrator", "bdpt")), ("portal", ("--portal", "room.portal.glb"))):
        run("tdpt-render", scene, *how, "--time", f"{s.seconds_each:g}", *size, "-o", f"{name}.exr", "--preview",
            "--stats", f"{name}.stats")
    print()

    # The shipped reference will do if it shows the very scene (its hash stands in the header) in the same size and
    # depth; otherwise one is rendered, and kept for the next time.
    kept = TESTDATA / f"references/{scene.stem}{'' if s.depth == 'none' else f'-depth{s.depth}'}.exr"
    origins = [re.search(rb"from %s [0-9a-f]*" % re.escape(scene.name).encode(), path.read_bytes()[:16384])
               for path in (Path("portal.exr"), kept) if path.exists()]
    shipped = len({origin and origin[0] for origin in origins}) == 1 and origins[0] and \
        measure([bench.store.program("exrdiff"), "portal.exr", kept]).status == 0
    read = (bench.store.program("tdpt-render"), scene, "room.portal.glb")
    key, noted = " ".join(map(str, (*map(bench.store.sum_of, read), s.seconds_reference, *size))), Path("reference.key")
    reference = kept if shipped else "reference.exr"
    if shipped:
        print("Comparing with the reference in testdata/references")
    elif noted.exists() and noted.read_text() == key:
        print("Comparing with the reference from last time")
    else:
        print(f"Rendering a reference for {s.seconds_reference:g} seconds, with another seed")
        noted.unlink(missing_ok=True)
        run("tdpt-render", scene, "--portal", "room.portal.glb", "--integrator", "tdpt-guided", "--time",
            f"{s.seconds_reference:g}", "--seed", "2", *size, "-o", reference)
        noted.write_text(key)
    errors = [bench.fresh("exrdiff", f"{name}.exr", reference, output=f"{name}-error.png").said
              for name in ("bdpt", "portal")]
    bench.fresh("exrdiff", "bdpt.exr", "portal.exr", "--side-by-side", "before-after.png")

    print(f"\n  {'':14} {'relMSE':>12} {'PSNR [dB]':>12} {'MAPE [%]':>12} {'mean':>12}")
    for name, of in (("bdpt", errors[0]), ("portal", errors[1]), ("", {"mean": 0, **errors[1]["black"]})):
        name = f"{name}, {s.seconds_each:g} s" if name else "all black"
        print(f"  {name:14} {of['relmse']:12.4g} {of['psnr']:12.2f} {of['mape']:12.1f} {of['mean']:12.4g}")
    print(f"  {'reference':14} {'':12} {'':12} {'':12} {errors[1]['reference_mean']:12.4g}\n")
    cpu = [pages.read_json(Path(f"{name}.stats"))["cpu_seconds"] for name in ("bdpt", "portal")]
    print(comparison(s.seconds_each, *errors, cpu, not shipped))
    print(f"Pictures: {out}/before-after.png (bdpt left, through the portal right), {out}/bdpt-error.png and\n"
          f"{out}/portal-error.png (red too bright, blue too dark), {out}/*.exr.")
