"""The paper's figures from our renders (in doc/efficiency.md), pictures of what each stage did (in doc/portals.md), and the
README's picture."""
import os
import shutil
from pathlib import Path
from statistics import mean

import pages
from common import ROOT, SEEDED, STAGES, Made, Setting, Stop, settings

SCENES = ("cornell-box-portal", "veach-ajar", "veach-ajar-flip", "bathroom2", "bathroom2-channel")
PICTURES = ("veach-ajar", "veach-ajar-flip")  # of which Fig 7 shows pictures
# The paper's share of non-zero pixels at 1 spp and CPU seconds of a frame; None: not in its text.
FIG5 = {"pt": ("0.00619 %", None), "nee": ("0.382 %", None), "bdpt": ("4.79 %", None), "tdpt-org": ("27.6 %", "3.1"),
        "tdpt": ("24.4 %", "2.5")}


class Figures:
    def __init__(self, bench):
        self.bench, self.s, self.files = bench, bench.settings, bench.there(SCENES)

    def render(self, scene, integrator, spp, depth, seed, *options):
        portal = self.bench.portals(self.files[scene], options=lambda program: (
            "--seed", self.s.seed) if program in SEEDED else ()).file
        given = ("--portal", portal) if integrator.startswith("tdpt") else ()
        return self.bench.render(self.files[scene], *given, "--integrator", integrator, "--height", self.s.height, "--spp",
                                 spp, "--max-depth", depth, "--seed", seed, *options, threads=0)

    def copy(self, path, name):
        shutil.copy(path, self.bench.doc / "figures" / name)


def percent(share):
    return pages.three(100 * share) + " %"


def figure5(figures):
    """How much of the picture of the Cornell box with a hole one sample finds."""
    rows = []
    for i, (share, seconds) in FIG5.items():
        one, many = (figures.render("cornell-box-portal", i, spp, 6, figures.s.seed).said for spp in (1, figures.s.frames))
        rows.append([i, percent(one["nonzero"]), share, pages.three(mean(many["mean"])), "about 0.02",
                     pages.three(many["cpu_seconds"] / many["spp"]), seconds or "not in the text"])
    return pages.table(("integrator", "non-zero at 1 spp", "the paper", f"mean at {figures.s.frames} spp", "the paper",
                        "CPU s per frame", "the paper"), rows)


def figure6(figures):
    """Non-zero pixels of one sample per pixel."""
    runs = {i: figures.render("veach-ajar-flip", i, 1, 5, figures.s.seed, "--set", Made("nonzero.png", "nonzero="))
            for i in ("bdpt", "tdpt-org", "tdpt")}
    for i, run in runs.items():
        figures.copy(run.folder / "nonzero.png", f"fig6-{i}.png")
    return pages.table(runs, [[f"![{i}](figures/fig6-{i}.png)" for i in runs],
                              [f"{percent(r.said['nonzero'])} non-zero" for r in runs.values()],
                              [f"mean {pages.three(mean(r.said['mean']))}" for r in runs.values()]])


def figure7(figures):
    """The same samples for everyone, against a long rendering."""
    rows, pictures, number, s = [], [], pages.three, figures.s
    for scene in figures.files:
        reference, bdpt = figures.render(scene, "tdpt-org", s.ref_spp, 5, s.seed + 1), None
        for i in ("bdpt", "tdpt-org", "tdpt"):
            run = figures.render(scene, i, s.spp, 5, s.seed)
            made = figures.bench.store.run("exrdiff", run.out, reference.out, "--side-by-side", Made("both.png"), output=False)
            e, seconds = made.said, run.said["cpu_seconds"]
            if scene in PICTURES and i != "tdpt-org":
                figures.copy(made.folder / "both.png", f"fig7-{scene}-{i}.png")
            cost = e["relmse"] * seconds
            bdpt = bdpt or cost
            rows.append([scene, i, "-" if e["psnr"] is None else "%.2f" % e["psnr"], *map(number, (e["mape"], e["relmse"])),
                         percent(e["nonzero"]), number(e["mean"]), number(seconds), "%.2g" % (bdpt / cost) if cost > 0 else "-"])
    pictures = [[scene, *(f"![{i} left, reference right](figures/fig7-{scene}-{i}.png)" for i in ("bdpt", "tdpt"))]
                for scene in PICTURES if scene in figures.files]
    return pages.sections(
        pages.table(("scene", "integrator", "PSNR [dB]", "MAPE [%]", "relMSE", "non-zero", "mean", "CPU s", "efficiency"), rows),
        pages.table(("scene", "bdpt, reference", "tdpt, reference"), pictures) if pictures else "")


@settings(HEIGHT=Setting(120, "of the pictures; the width follows from it and the camera", 18),
          SPP=Setting(16, "samples per pixel of Fig 7's pictures", 2), REF_SPP=Setting(512, "of their references", 4),
          FRAMES=Setting(128, "samples per pixel of Fig 5", 3), SEED=Setting(1, "of all"))
def figures(bench):
    """The paper's Figs 5 to 7 from our own renders, with portals that the four stages find. Five minutes."""
    (bench.doc / "figures").mkdir(exist_ok=True)
    f = Figures(bench)
    bench.page("efficiency", {"fig5": figure5(f) if "cornell-box-portal" in f.files else "",
                              "fig6": figure6(f) if "veach-ajar-flip" in f.files else "", "fig7": figure7(f)})


# ---- Pictures of the stages ----
@settings(SCENE=Setting("", "a scene of yours, alone; default: a room behind a door, one with windows under a sky, and one whose "
                        "lamp stands in its own window, of the paper's scenes and interiors, as far as they are there"),
          SKY=Setting("", "what shines on SCENE, --environment"))
def stages(bench):
    """The pictures of the stages in doc/portals.md; the cache receives the same for 3D viewers."""
    s, (folder, made) = bench.settings, (bench.doc / "figures", ("--preview", Made("preview.png"), "--debug-glb", Made("debug.glb")))
    folder.mkdir(exist_ok=True)
    own = bench.find("living-room")
    rooms = [(Path(s.scene).resolve(), "", s.sky, STAGES)] if s.scene else [
        (bench.find("veach-ajar"), "", "", STAGES), (own, "-windows", own and own.with_suffix(".env.exr"), STAGES),
        (bench.find("kitchen"), "-kitchen", "", ("mincut",))]
    for scene, suffix, sky, programs in rooms:
        if not scene or not scene.exists():
            bench.say(f"there is no scene {scene or 'for stage-*' + suffix + '.png'}, left out")
            continue
        light = ("--environment", Path(sky) if Path(sky).exists() else sky) if sky else ()
        of = bench.portals(scene, light, lambda program, scene=scene: (
            *(("--scene", scene) if program == "mincut" else ()), *made))
        for program in programs:
            shutil.copy(of.runs[program].folder / "preview.png", folder / f"stage-{program}{suffix}.png")
            shutil.copy(of.runs[program].folder / "debug.glb", bench.cache / f"{program}{suffix}.debug.glb")
    bench.say(f"{folder}/stage-*.png, for 3D viewers {bench.cache}/*.debug.glb")


@settings(SCENE=Setting("veach-ajar", "a room behind an opening, of SCENES, or a file"), WIDTH=Setting(640, "of each half", 24),
          SECONDS_EACH=Setting(60.0, "CPU seconds of a picture", 0.2), REF=Setting(10.0, "of the reference, over theirs", 2.0),
          SCENES=Setting(os.path.relpath(ROOT / "../shared/scenes"), "folder of the paper's scenes"))
def before_after(bench):
    """DOC/before-after.png, the README's picture: a room behind an opening, on the left without portals, on the right with
    those that the four stages find, in equal CPU time; and what both are worth, for the caption, on stdout."""
    s = bench.settings
    scene = Path(s.scene) if Path(s.scene).is_file() else Path(s.scenes) / f"{s.scene}.glb"
    if not scene.exists():
        raise Stop(3, f"there is no scene {scene}; name one with SCENE=FILE")
    scene, portal = scene.resolve(), ("--portal", bench.portals(scene.resolve()).file)

    def render(seconds, *options):
        """As many samples as take so long."""
        few = bench.render(scene, "--width", s.width, "--spp", 4, *options, threads=0).said["cpu_seconds"]
        return bench.render(scene, "--width", s.width, "--spp", max(1, round(4 * seconds / few)), *options, threads=0)

    pictures = [render(s.seconds_each, *how) for how in (("--integrator", "nee"), ("--integrator", "bdpt"), portal)]
    reference = render(s.ref * s.seconds_each, *portal, "--seed", 1000001)
    both = bench.store.run("exrdiff", pictures[0].out, pictures[2].out, "--side-by-side", Made("both.png"), output=False)
    shutil.copy(both.folder / "both.png", bench.doc / "before-after.png")
    for run in pictures:
        off, said = bench.distance(run.out, reference.out), run.said
        print(f"{said['integrator']} {said.get('chosen') or ''}, {said['spp']} samples per pixel, {said['cpu_seconds']} CPU s: "
              f"relMSE {off['relmse']}, PSNR {off['psnr']} dB; black: {off['black']['relmse']}, {off['black']['psnr']} dB")
