"""Other renderers in equal CPU time, behind holes and doors and in rooms of real buildings: Cycles without and with path
guiding, LuxCore's bidirectional path tracer, Mitsuba's path tracer: doc/peers.md."""
import functools
import json
import os

import numpy as np

import pages
import stats
from common import ROOT, Halves, Setting, Stop, checked, peers_python, settings, turns
from formats import glb_content, glb_parse, gltf_array, placed
from sky import Cell, Picture

# What light comes through, by rooms of testdata or HOUSE.CAMERA.
VIEWS = {"half-metre-hole": "a hole of 0.50 m", "two-rooms": "a hole of 0.25 m", "small-hole": "a hole of 0.10 m",
         "three-rooms": "two holes of 0.25 m in a row", "door-ajar": "a door ajar",
         "jasmin-night.bedroom": "two doors ajar, a house", "sample-house-night.bedroom": "one door, a house"}
PEERS = {"cycles": "Cycles", "cycles-guided": "Cycles, path guiding", "luxcore": "LuxCore, bidirectional",
         "mitsuba": "Mitsuba, path"}
OURS = {"bdpt": "our `bdpt`", "auto": "our `auto`, portals found"}
SEED = 20261126
INSIDE = ROOT / "bench/peers_inside.py"


# ---- The same scene for all ----
def without_panes(data):
    """(a scene without its panes of glass, how many meshes are gone)."""
    document, binary = glb_parse(data)
    glass = {i for i, m in enumerate(document["materials"])
             if "KHR_materials_transmission" in m.get("extensions", {})}
    bare, gone = {}, 0
    for node in document["nodes"]:
        if "mesh" not in node:
            continue
        primitives = [p for p in document["meshes"][node["mesh"]]["primitives"] if p["material"] not in glass]
        if not primitives:
            del node["mesh"]
            gone += 1
        else:
            bare.setdefault(node["mesh"], {**document["meshes"][node["mesh"]], "primitives": primitives})
            node["mesh"] = list(bare).index(node["mesh"])
    document["meshes"] = list(bare.values())
    return glb_content(document, binary), gone


def emission_of(material):
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
    return [strength * c for c in material.get("emissiveFactor", (0, 0, 0))]


def wrong_with(material):
    """Why the others would not see this material as it is here, or nothing."""
    surface, more = material.get("pbrMetallicRoughness", {}), material.get("extensions", {})
    emits = any(emission_of(material))
    return ("a texture" if "Texture" in json.dumps(material) else
            "metal" if surface.get("metallicFactor", 1) else
            "gloss" if more.get("KHR_materials_specular", {}).get("specularFactor", 1) else
            "glass" if "KHR_materials_transmission" in more else
            "transparency" if material.get("alphaMode", "OPAQUE") != "OPAQUE" else
            "light from both sides" if emits and material.get("doubleSided") else
            "a colour where it emits" if emits and any(surface.get("baseColorFactor", (1, 1, 1))[:3]) else "")


def plain(data, camera):
    """The arrays that peers_inside.py reads, of a scene of diffuse triangles and point lamps."""
    document, binary = glb_parse(data)
    materials = document["materials"]
    lights = document.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", ())
    corners, material, lamps, views = [], [], [], {}
    for node, matrix in placed(document, document["scenes"][document.get("scene", 0)]["nodes"], np.eye(4)):
        for primitive in document["meshes"][node["mesh"]]["primitives"] if "mesh" in node else ():
            wrong = wrong_with(materials[primitive["material"]])
            if wrong:
                raise ValueError(f"material {materials[primitive['material']].get('name')} has {wrong}")
            at = gltf_array(document, binary, primitive["attributes"]["POSITION"]) @ matrix[:3, :3].T + matrix[:3, 3]
            corners.append(at[gltf_array(document, binary, primitive["indices"]).reshape(-1, 3)])
            material.append(np.full(len(corners[-1]), primitive["material"]))
        if "camera" in node:
            of = document["cameras"][node["camera"]]
            views[of.get("name", node.get("name"))] = matrix, of["perspective"]["yfov"]
        if "KHR_lights_punctual" in node.get("extensions", {}):
            light = lights[node["extensions"]["KHR_lights_punctual"]["light"]]
            if light["type"] != "point":
                raise ValueError(f"lamp {light.get('name')} is a {light['type']}")
            lamps.append([matrix[:3, 3], np.array(light.get("color", (1, 1, 1))) * light.get("intensity", 1)])
    matrix, yfov = views[camera or next(iter(views))]
    return {"corners": np.concatenate(corners).astype("f4"), "material": np.concatenate(material),
            "colours": np.array([m["pbrMetallicRoughness"].get("baseColorFactor", (1, 1, 1))[:3] for m in materials]),
            "emission": np.array([emission_of(m) for m in materials]), "lamps": np.array(lamps).reshape(-1, 2, 3),
            "camera": matrix, "yfov": yfov}


# ---- Pictures ----
def inside(*arguments, may_fail=()):
    """What peers_inside.py says there; nothing where it may fail and does."""
    run = checked([peers_python(), "-B", INSIDE, *arguments], may_fail)
    return {} if run.status else json.loads(run.said.splitlines()[-1])


class View:
    """A room without its panes: NAME or HOUSE.CAMERA."""

    def __init__(self, bench, name, versions):
        self.bench, self.name, self.versions = bench, name, versions
        house, _, camera = name.partition(".")
        source = bench.find(house)
        if not source:
            raise Stop(3, f"there is no {house}.glb in SCENES")
        if source.with_name(f"{house}.env.exr").exists():
            raise Stop(2, f"{house} is lit by a sky, which the others do not get")
        content, _ = without_panes(source.read_bytes())
        self.scene, self.arrays = (bench.cache / f"{name}{end}" for end in (".glb", ".npz"))
        self.scene.write_bytes(content)
        np.savez(self.arrays, **plain(content, camera))
        self.camera = ("--camera", camera) if camera else ()
        self.size = ("--width", bench.settings.width, "--height", bench.settings.width * 9 // 16)

    @functools.cached_property
    def portals(self):
        return self.bench.portals(self.scene, (), lambda program: self.camera if program == "ffgraph" else (), 1)

    def theirs(self, method, seed, amount):
        """(path, samples, CPU seconds)"""
        store, words = self.bench.store, [method, *self.size, "--seed", seed, *amount]

        def make(folder):
            folder.mkdir()
            (folder / "told.json").write_text(json.dumps(inside(method, self.arrays, folder / "out.exr", *words[1:])))

        folder = store.keep([store.sum_of(self.scene), *self.camera, store.sum_of(INSIDE), self.versions[method],
                             os.environ.get("MITSUBA_VARIANT", ""), *words], make, ".peer")
        told = json.loads((folder / "told.json").read_text())
        return folder / "out.exr", told["samples"], told["cpu"]

    def ours(self, method, seed, samples):
        portal = ("--portal", self.portals.file) if method == "auto" and self.portals.count else ()
        run = self.bench.render(self.scene, *self.camera, *self.size, "--integrator", method, *portal, "--seed", seed,
                                "--spp", samples)
        return run.out, run.said["spp"], run.said["cpu_seconds"]

    def samples_in(self, method, seconds):
        """How many samples our program makes in so many CPU seconds; what auto decides first takes some of them."""
        (_, few, short), (_, more, longer) = (self.ours(method, 900000, n) for n in (8, 32))
        return max(1, round(few + (seconds - short) * (more - few) / max(1e-3, longer - short)))

    def made(self, method, seed, seconds, samples):
        """(path, samples, CPU seconds). samples: of the seed before, or None."""
        if method in OURS:
            return self.ours(method, seed, samples or self.samples_in(method, seconds))
        known = samples and method.startswith("cycles")  # The others stop by themselves.
        return self.theirs(method, seed, ("--spp", samples) if known else ("--cpu-seconds", seconds))


def measured(view, methods):
    """A Cell, with the means of the pictures by their methods; the one that gains are over is auto."""
    bench, s = view.bench, view.bench.settings
    samples = view.samples_in("auto", s.ref * s.seconds_each)
    reference = Halves(bench, *(view.ours("auto", 1000000 + half, samples)[0] for half in (1, 2)))
    cell = Cell(reference.black, reference.peak, ("auto",), SEED, portals=view.portals, means={m: [] for m in methods})
    known = {}
    for seed, method in turns(range(1, s.seeds + 1), methods):
        path, known[method], cpu = view.made(method, seed, s.seconds_each, known.get(method))
        off = reference.off(path)
        cell.pictures[method].append(Picture(cpu, off["relmse"], off["mse"], spp=known[method]))
        cell.means[method].append(off["mean"])
    bench.say(f"{view.name} is measured")
    return cell


# ---- Page ----
NAMES = {**PEERS, **OURS}


def gains_table(cells):
    """How many times as efficient auto is as each other method, a row a view."""
    others = [m for m in NAMES if m != "auto"]
    rows = [[name, VIEWS.get(name, ""), *(stats.ratio(cell.costs(m), cell.costs("auto"), SEED).text(pages.three)
                                          if cell.pictures[m] else "" for m in others),
             f"{cell.portals.count}, {cell.portals.cpu:.0f} s"] for name, cell in cells.items()]
    return pages.table(("view", "light comes through", *(NAMES[m] for m in others), "portals, CPU time of finding"), rows)


def pictures_table(cells):
    rows = []
    for name, cell in cells.items():
        for method in (m for m in NAMES if cell.pictures[m]):
            relmse, psnr = cell.error(method)
            spp, cpu = np.mean([(p.spp, p.cpu) for p in cell.pictures[method]], 0)
            rows.append([name, NAMES[method], "%.0f" % spp, "%.1f" % cpu, pages.three(relmse), "%.1f" % psnr])
        rows.append([name, "a black picture", "", "", pages.three(cell.black["relmse"]), "%.1f" % cell.black["psnr"]])
    return pages.table(("view", "method", "samples per pixel", "CPU s", "relMSE", "PSNR, dB"), rows)


def means_table(cells):
    """Of the pictures, beside those of bdpt."""
    rows = []
    for name, cell in cells.items():
        ours = np.mean(cell.means["bdpt"])
        for method, values in cell.means.items():
            mean, error = stats.mean_and_error(np.array(values))
            apart = f"{100 * (mean / ours - 1):+.2f} %" if method != "bdpt" else ""
            rows.append([name, NAMES[method], "%.5g" % mean, f"{100 * error / mean:.2f} %", apart])
    return pages.table(("view", "method", "mean", "standard error", "beside our `bdpt`"), rows)


@settings(SECONDS_EACH=Setting(5.0, "CPU seconds of a picture", 1.0), SEEDS=Setting(4, "pictures of each kind", 2),
          REF=Setting(8.0, "how many times as long each half of a reference takes", 2.0),
          WIDTH=Setting(96, "of the pictures", 48))
def peers(bench):
    """Other renderers beside ours in equal CPU time: rooms behind holes and doors and views of real buildings without
    their panes, several seeds taking turns, one thread each. ONLY: views, as NAME or HOUSE.CAMERA. `make peers` installs
    the others; those that are missing are left out. PEERS_PYTHON in the environment names another Python that has them.
    An hour."""
    versions = inside("versions", may_fail=(1,))  # a Python without numpy has none of them
    methods = [method for method in PEERS if method in versions]
    if not methods:
        raise Stop(5, "none of bpy, pyluxcore, mitsuba is installed (make peers)")
    for method in set(PEERS) - set(methods):
        bench.say(f"{PEERS[method]} is not installed (make peers), left out")
    views = [View(bench, name, versions) for name in bench.settings.only or VIEWS]
    cells = bench.side_by_side([functools.partial(measured, view, [*methods, *OURS]) for view in views])
    made = {view.name: cell for view, cell in zip(views, cells)}
    bench.page("peers", {"gains": gains_table(made), "pictures": pictures_table(made), "means": means_table(made)})
