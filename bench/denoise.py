"""What the filter is worth: noisy and filtered pictures against references of two halves: doc/denoise.md."""
import functools
import math
from dataclasses import dataclass

import pages
from common import Made, Setting, checked, decibels_of, settings

BUFFERS = ("--aov", "halves,albedo,normal,depth")
# What is rendered, by kind: (scene, camera or nothing).
KINDS = {"interiors": (("kitchen", ""), ("bathroom", ""), ("living-room", ""), ("classroom", "")),
         "behind a door": (("veach-ajar", ""),),
         "houses": (("jasmin-night", "hall"), ("five-zone-office", "core"), ("renga-house", "corridor"))}


@dataclass
class Measured:
    """Of one picture: relMSE and MSE before and after, by Open Image Denoise alone and with its help, CPU seconds of
    rendering it, of all that the filter adds, and the interval of the relMSE that it tells."""
    noisy: dict
    filtered: dict
    guest: dict
    both: dict
    render: float
    more: float
    told: list  # low and high end; None: not known

    @property
    def gain(self):
        return self.noisy["relmse"] / self.filtered["relmse"]

    @property
    def holds(self):
        return self.told and self.told[0] <= self.filtered["relmse"] <= self.told[1]

    @property
    def at_equal_time(self):
        return self.gain * self.render / (self.render + self.more)


class View:
    def __init__(self, bench, name, camera):
        self.bench, self.name, self.scene = bench, f"{name}.{camera}" if camera else name, bench.find(name)
        self.place = name, camera
        sky = self.scene.with_name(f"{self.scene.stem}.env.exr")
        self.sky = ("--environment", sky) if sky.exists() else ()
        self.camera = ("--camera", camera) if camera else ()

    @functools.cached_property
    def portals(self):
        """Options; none in furnished rooms without doors, whose windows are lamps."""
        if self.scene.parent.name == "interiors":
            return ()
        found = self.bench.portals(self.scene, self.sky, lambda p: self.camera if p == "ffgraph" else (), 1)
        return ("--portal", found.file) if found.count else ()

    def render(self, spp, seed, *options):
        return self.bench.render(self.scene, *self.sky, *self.camera, *self.portals, "--width", self.bench.settings.width,
                                 "--spp", spp, "--seed", seed, *options)

    @functools.cached_property
    def reference(self):
        return self.bench.halves(lambda seed: self.render(self.bench.settings.ref, seed))

    def measured(self, spp, seed):
        plain, noisy = self.render(spp, seed), self.render(spp, seed, *BUFFERS)
        clean, guest, both = (self.bench.store.run("exrdenoise", noisy.out, "--denoiser", denoiser)
                              if denoiser == "regression" or self.bench.settings.oidn else None
                              for denoiser in ("regression", "oidn", "auto"))
        off = lambda run: self.reference.off(run.out) if run else None
        return Measured(off(noisy), off(clean), off(guest), off(both), plain.cpu,
                        max(0, noisy.cpu - plain.cpu) + clean.cpu, clean.said.get("interval"))


def mean(values):
    """Geometric; nothing where noise of the references hides one."""
    values = list(values)
    return math.exp(sum(map(math.log, values)) / len(values)) if values and min(values) > 0 else math.nan


def line(view, spp, pictures):
    def gains(of):
        better = [decibels_of(1, of(p)["mse"]) - decibels_of(1, p.noisy["mse"]) for p in pictures]
        return "%s, %+.1f dB" % (pages.hundredths(mean(p.noisy["relmse"] / of(p)["relmse"] for p in pictures)),
                                 sum(better) / len(better))

    changes = [100 * (p.filtered["mean"] / p.noisy["mean"] - 1) for p in pictures]
    return [view.name, spp, pages.three(mean(p.noisy["relmse"] for p in pictures)),
            pages.three(mean(p.filtered["relmse"] for p in pictures)), gains(lambda p: p.filtered),
            pages.hundredths(mean(p.at_equal_time for p in pictures)), "%+.2f" % (sum(changes) / len(changes)),
            "%d of %d" % (sum(bool(p.holds) for p in pictures), sum(bool(p.told) for p in pictures)),
            *([gains(lambda p: p.guest), gains(lambda p: p.both)] if pictures[0].guest else []),
            "%.0f" % (100 * sum(p.more for p in pictures) / sum(p.render for p in pictures))]


@settings(SPPS=Setting(("4", "16", "64", "256"), "samples per pixel", ("4", "16")),
          SEEDS=Setting(2, "pictures of each kind", 1), WIDTH=Setting(320, "of the pictures", 96),
          OIDN=Setting(0, "1: beside Open Image Denoise, where exrdenoise finds it", 0),
          REF=Setting(512, "samples per pixel of each half of a reference", 64))
def denoise(bench):
    """Pictures before and after exrdenoise, against references of two halves. ONLY: scenes. Two hours."""
    s, rows, gains = bench.settings, [], {}
    there = bench.there([name for views in KINDS.values() for name, _ in views])
    views = [(kind, View(bench, name, camera)) for kind, of in KINDS.items() for name, camera in of if name in there]
    spps = [int(spp) for spp in s.spps]

    def measured(view):
        all_pictures = [[view.measured(spp, seed) for seed in range(1, s.seeds + 1)] for spp in spps]
        for spp, pictures in zip(spps, all_pictures):
            bench.say(" ".join(map(str, line(view, spp, pictures))))
        return all_pictures

    made = bench.side_by_side([functools.partial(measured, view) for _, view in views])
    for (kind, view), all_pictures in zip(views, made):
        for spp, pictures in zip(spps, all_pictures):
            rows.append(line(view, spp, pictures))
            gains.setdefault((kind, spp), []).append(mean(p.gain for p in pictures))
    heads = ("scene", "samples per pixel", "relMSE noisy", "filtered", "falls by, PSNR", "at equal time", "mean, %",
             "interval holds, of told", *(["Open Image Denoise", "both"] if s.oidn else []), "filter's time, %")
    kinds = [[kind, *(pages.hundredths(mean(gains.get((kind, spp), ()))) for spp in spps)] for kind in KINDS]
    made = {"scenes": pages.table(heads, rows),
            "kinds": pages.table(("kind", *(f"{spp} samples per pixel" for spp in spps)), kinds)}
    print("\n\n".join(made.values()))
    bench.page("denoise", made)


# ---- Pictures ----
# Hard places: (scene, camera or nothing) and corners of crops, as shares of width and height.
PLACES = {("kitchen", ""): ((0.16, 0.5), (0.62, 0.6), (0.64, 0.1)),
          ("veach-ajar", ""): ((0.23, 0.53), (0.44, 0.53), (0.8, 0.1)),
          ("living-room", ""): ((0.47, 0.74), (0.27, 0.55), (0.72, 0.72)),
          ("sample-house-night", "living"): ((0.79, 0.27), (0.08, 0.3), (0.68, 0.6))}
CROP = 0.2  # of width and height


def crops(bench, view, spp, folder):
    """Names of the columns of one picture: crops of the noisy picture, the filtered one and the reference, exposed
    alike, each row a place."""
    noisy = view.render(spp, 1, *BUFFERS).out
    reference = view.render(bench.settings.ref, 1000001).out
    denoisers = ("regression", "oidn", "auto") if bench.settings.oidn else ("regression",)
    columns = [noisy, *(bench.store.run("exrdenoise", noisy, "--denoiser", denoiser).out for denoiser in denoisers)]
    names = []
    for number, picture in enumerate((*columns, None)):
        both = bench.store.run("exrdiff", picture or noisy, reference, "--side-by-side", Made("both.png"), output=False)
        for row, (x, y) in enumerate(PLACES[view.place]):
            name = folder / f"{row}-{number}.png"
            width, height = bench.settings.width, round(bench.settings.width * 9 / 16)
            png = (both.folder / "both.png").read_bytes()
            left = width * x + (int.from_bytes(png[16:20], "big") - width if picture is None else 0)
            part = f"{round(CROP * width)}x{round(CROP * height)}+{round(left)}+{round(height * y)}"
            checked(["convert", both.folder / "both.png", "-crop", part, "+repage", "-filter", "point", "-resize", "300x",
                     "-strip", name])
            names.append(name)
    return sorted(names)


@settings(SPP=Setting(16, "samples per pixel", 2), WIDTH=Setting(480, "of the pictures", 96),
          OIDN=Setting(0, "1: beside Open Image Denoise, where exrdenoise finds it", 0),
          REF=Setting(512, "samples per pixel of the reference", 8))
def denoise_pictures(bench):
    """Crops of hard places, noisy, filtered and of a reference: DOC/figures/denoise-SCENE.jpg. ONLY: scenes. Half an
    hour."""
    folder = bench.cache / "crops"
    folder.mkdir(exist_ok=True)
    there = bench.there([name for name, _ in PLACES])
    for name, camera in (place for place in PLACES if place[0] in there):
        view = View(bench, name, camera)
        made = crops(bench, view, bench.settings.spp, folder)
        columns = len(made) // len(PLACES[view.place])
        out = bench.doc / "figures" / f"denoise-{name}.jpg"
        checked(["montage", *made, "-tile", f"{columns}x", "-geometry", "+2+2", "-quality", "90", out])
        bench.say(out)


# ---- Frames ----
def frames_line(bench, view, spp):
    """Of four frames of a camera that stands still: relMSE of the second, and between the second and third, each
    filtered alone and with those before and after."""
    noisy = [view.render(spp, seed, *BUFFERS).out for seed in range(1, 5)]
    pairs = []
    for options in (lambda k: (), lambda k: ("--previous", noisy[k - 1], "--next", noisy[k + 1])):
        middle = [bench.store.run("exrdenoise", noisy[k], "--denoiser", "regression", *options(k)).out for k in (1, 2)]
        pairs.append((view.reference.off(middle[0])["relmse"], bench.distance(middle[0], middle[1])["relmse"]))
    (alone, flicker), (left, less) = pairs
    return [view.name, spp, pages.three(alone), pages.three(left), pages.hundredths(alone / left), pages.three(flicker),
            pages.three(less), pages.hundredths(flicker / less)]


@settings(SPPS=Setting(("4", "16"), "samples per pixel", ("2",)), WIDTH=Setting(320, "of the pictures", 64),
          REF=Setting(512, "samples per pixel of each half of a reference", 16))
def denoise_frames(bench):
    """What the frames before and after are worth to the filter. ONLY: scenes. Half an hour."""
    views = [View(bench, name, "") for name in bench.there(("kitchen", "living-room", "veach-ajar"))]
    tasks = [functools.partial(frames_line, bench, view, int(spp)) for view in views for spp in bench.settings.spps]
    rows = bench.side_by_side(tasks)
    heads = ("scene", "samples per pixel", "relMSE alone", "with frames", "falls by", "between frames, alone", "with frames",
             "falls by")
    bench.page("denoise", {"frames": pages.table(heads, rows)})
