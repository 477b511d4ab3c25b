"""Scenes of other renderers, imported and rendered, beside Mitsuba's own picture of them: doc/scenes.md."""
import json
import os
import tempfile
from pathlib import Path

import numpy as np

import pages
from common import ROOT, Setting, Stop, checked, measure, peers_python, settings
from formats import exr_read

INSIDE = ROOT / "bench/mitsuba_scene.py"
FORMATS = {".json": "Tungsten", ".xml": "Mitsuba", ".pbrt": "pbrt"}
PEAK = 10  # brighter values are cut in both pictures, since a few paths would decide the mean


def scenes(folder):
    """[(name, format, path)] of the scene files below a folder, by the names of their own folders: those called
    scene.SUFFIX, which is what Bitterli's archives have."""
    found = [(path.parent.name, path) for suffix in FORMATS for path in Path(folder).rglob(f"scene{suffix}")]
    return [(name, FORMATS[path.suffix], path) for name, path in sorted(found, key=lambda f: (f[0], str(f[1])))]


def version_of(path):
    """Of a scene of Mitsuba: "0.6", "3" and so on."""
    text = path.read_text(errors="replace")
    return text.split("<scene", 1)[-1].split('version="', 1)[-1].split('"', 1)[0]


def mean_of(path):
    return np.minimum(exr_read(path)[0][..., :3], PEAK).mean(axis=(0, 1))


def by_mitsuba(bench, name, paths):
    """A picture by Mitsuba 3 of the first file that it reads, or why there is none."""
    out = bench.cache / f"{name}.mitsuba.exr"
    told = out.with_suffix(".json")
    if not told.exists():
        facts = {"failed": "no file for Mitsuba"}
        for path in paths:
            same = bench.cache / f"{name.rpartition('.')[0]}.{version_of(path)}.mitsuba.json"
            if same != told and same.exists() and "failed" not in json.loads(same.read_text()):
                return same.with_suffix(".exr"), json.loads(same.read_text())
            run = measure([peers_python(), str(INSIDE), str(path), str(out), str(bench.settings.width),
                           str(bench.settings.peer_spp)])
            if run.status == 0:
                facts = json.loads(run.said.strip().split("\n")[-1])
                if any(facts["mean"]):
                    break
                facts = {"failed": "Mitsuba 3 reads no light of it"}
                continue
            facts = {"failed": next((line for line in run.errors.split("\n") if "Error" in line), "")[-150:]}
        told.write_text(json.dumps(facts))
    facts = json.loads(told.read_text())
    return (out, facts) if "failed" not in facts else (None, facts)


def ours(bench, name, form, path):
    """(facts, picture, CPU seconds of the import) of an imported scene; the picture None if it is refused."""
    with tempfile.TemporaryDirectory() as scratch:
        glb = os.path.join(scratch, "scene.glb")
        run = measure([bench.store.program("tdpt-import"), str(path), "-o", glb, "--json", "--quiet"])
        if run.status:
            return {"refused": run.errors.strip().split("\n")[-1]}, None, run.cpu
        out = bench.cache / f"{name}.{form}.exr"
        checked([bench.store.program("tdpt-render"), glb, "-o", str(out), "--integrator", bench.settings.integrator, "--width",
                 str(bench.settings.width), "--spp", str(bench.settings.spp), "--quiet"])
        return json.loads(run.said), out, run.cpu


def words_of(ratios):
    return " ".join(f"{r:.3f}" for r in ratios)


@settings(FOLDER=Setting("", "that of the scenes, files called scene.json, scene.xml and scene.pbrt in folders of their names"),
          WIDTH=Setting(320, "pixels", 120), SPP=Setting(256, "our samples per pixel", 16),
          PEER_SPP=Setting(512, "Mitsuba's samples per pixel", 32), INTEGRATOR=Setting("nee", "of tdpt-render"))
def imported(bench):
    """Imports every scene file below FOLDER, renders it, and prints a table of the means beside those of Mitsuba 3
    (`make peers`), which renders the scene's own file of Mitsuba's format. Pairs of pictures go to CACHE."""
    if not os.path.isdir(bench.settings.folder):
        raise Stop(2, "FOLDER=FOLDER: expected the folder of the scenes")
    found = [s for s in scenes(bench.settings.folder) if not bench.settings.only or s[0] in bench.settings.only]
    if not found:
        raise Stop(3, f"{bench.settings.folder}: has no scene.json, scene.xml or scene.pbrt")
    bench.cache.mkdir(parents=True, exist_ok=True)
    rows, refused = [], []
    for name in dict.fromkeys(name for name, _, _ in found):
        of_name = [(form, path) for n, form, path in found if n == name]
        references = sorted((path for form, path in of_name if form == "Mitsuba"), key=version_of)
        for form, path in of_name:
            label = f"{form} {version_of(path)}" if form == "Mitsuba" else path.parent.parent.name
            told, picture, cpu = ours(bench, name, path.parent.parent.name, path)
            # A file of Mitsuba's is compared with itself, others with the oldest, which was edited least.
            reference, facts = (by_mitsuba(bench, f"{name}.{version_of(path)}", [path]) if form == "Mitsuba" else
                                by_mitsuba(bench, f"{name}.first", references))
            if picture is None:
                refused.append((name, label, told["refused"]))
                continue
            ratio = "-"
            if reference:
                ratio = words_of(mean_of(picture) / np.maximum(mean_of(reference), 1e-30))
                pair = bench.cache / f"{name}.{path.parent.parent.name}.png"
                checked([bench.store.program("exrdiff"), str(picture), str(reference), "--side-by-side", str(pair)])
            rows.append((name, label, told["triangles"],
                         f"{cpu:.1f}", len(told["losses"]), ratio,
                         f"{facts['error'] * 100:.1f} %" if reference else facts["failed"]))
            bench.say(" | ".join(map(str, rows[-1])))
    print(pages.table(("scene", "format", "triangles", "CPU s", "losses", "ours / Mitsuba (red green blue)", "s.e."), rows))
    for name, label, why in refused:
        print(f"{name}, {label}: {why}")
