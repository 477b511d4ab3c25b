"""Renders a scene of Mitsuba 0.4 to 3 with Mitsuba 3, in the Python of `make peers`:
  mitsuba_scene.py SCENE.xml OUT.exr WIDTH SAMPLES
Prints JSON: mean, error (standard error of the mean, relative), left_out (what Mitsuba 3 does not read of the scene and
was taken away), seconds.

The integrator becomes a path tracer of 64 edges, the film one of float in WIDTH pixels with a box filter. What
tdpt-import names as lost is taken away here, too, so that what is left should look the same: microfacets become GGX,
rough diffuse surfaces Lambertian, and bump maps are left out."""
import json
import os
import re
import sys
import time
import xml.etree.ElementTree as ET

import numpy as np

from formats import exr_write

RENDERS, DEPTH = 8, 65  # pictures whose spread gives the error; edges and the one to the camera


def snake(name):
    return re.sub(r"(?<=[a-z])[A-Z]+", lambda m: "_" + m[0].lower(), name).lower()


def child(parent, tag, **attributes):
    return ET.SubElement(parent, tag, {k: str(v) for k, v in attributes.items()})


def size_of(root, film):
    """Pixels of a film, whose numbers may be parameters."""
    defaults = {d.get("name"): d.get("value") for d in root.findall("default")}
    size = {"width": 768, "height": 576}
    for entry in film.findall("integer"):
        text = entry.get("value")
        if entry.get("name") in size:
            size[entry.get("name")] = int(defaults.get(text[1:], text) if text.startswith("$") else text)
    return size["width"], size["height"]


def prepare(root, width):
    """Changes a scene so that Mitsuba 3 renders it as described above."""
    old = root.get("version", "0")[0] < "2"
    for integrator in root.findall("integrator"):
        root.remove(integrator)
    child(child(root, "integrator", type="path"), "integer", name="maxDepth" if old else "max_depth", value=DEPTH)
    for sensor in root.iter("sensor"):
        of = sensor.find("film")
        across, down = (768, 576) if of is None else size_of(root, of)
        for gone in [*sensor.findall("film"), *sensor.findall("sampler")]:
            sensor.remove(gone)
        film = child(sensor, "film", type="hdrfilm")
        child(film, "integer", name="width", value=width)
        child(film, "integer", name="height", value=max(1, round(width * down / across)))
        child(film, "string", name="pixelFormat" if old else "pixel_format", value="rgb")
        child(film, "rfilter", type="box")
        child(sensor, "sampler", type="independent")
    for element in root.iter():
        name, value = snake(element.get("name", "")), element.get("value")
        if name == "filter_type" and value in ("trilinear", "ewa"):
            element.set("value", "bilinear")
        if name == "distribution" and value in ("beckmann", "phong"):
            element.set("value", "ggx")
        if element.tag == "bsdf" and element.get("type") == "roughdiffuse":
            element.set("type", "diffuse")
        if element.tag == "bsdf" and element.get("type") in ("roughplastic", "roughconductor", "roughdielectric") and \
                not any(snake(c.get("name", "")) == "distribution" for c in element):
            child(element, "string", name="distribution", value="ggx")
    for parent in list(root.iter()):
        for i, element in enumerate(list(parent)):
            if element.tag == "bsdf" and element.get("type") == "bumpmap":
                inner = element.find("bsdf") if element.find("bsdf") is not None else element.find("ref")
                if element.get("id"):
                    inner.set("id", element.get("id"))
                parent[i] = inner


def load(mi, root, folder):
    """The scene, and what had to be taken away because this Mitsuba has no such parameter."""
    path, gone = os.path.join(folder, f".mitsuba-{os.getpid()}.xml"), []
    while True:
        ET.ElementTree(root).write(path)
        try:
            return mi.load_file(path), gone
        except RuntimeError as error:
            kind = re.search(r'plugin of type "(\w+)"', str(error))
            names = re.findall(r'^ +- \w+ "(\w+)"', str(error), re.M)
            fresh = [f"{kind[1]}.{n}" for n in names if f"{kind[1]}.{n}" not in gone] if kind else []
            if not fresh:
                raise
            gone += fresh
            for element in root.iter():
                if element.get("type") == kind[1]:
                    for entry in list(element):
                        if snake(entry.get("name", "")) in names:
                            element.remove(entry)
        finally:
            os.remove(path)


def main(source, out, width, samples):
    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb" if "llvm_ad_rgb" in mi.variants() else "scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    began = time.time()
    root = ET.parse(source).getroot()
    prepare(root, int(width))
    scene, gone = load(mi, root, os.path.dirname(source) or ".")
    each = max(1, int(samples) // RENDERS)
    pictures = [np.array(mi.render(scene, spp=each, seed=k))[:, :, :3] for k in range(RENDERS)]
    picture = np.mean(pictures, 0)
    means = np.array([p.mean() for p in pictures])
    exr_write(out, picture.astype(np.float32))
    print(json.dumps({"mean": picture.mean(axis=(0, 1)).tolist(), "left_out": gone,
                      "error": float(means.std(ddof=1) / RENDERS ** 0.5 / max(means.mean(), 1e-30)),
                      "seconds": time.time() - began}))


if __name__ == "__main__":
    main(*sys.argv[1:])
