"""stored_reference.py FOLDER NAME SCENE A B PROGRAM: keeps a reference in FOLDER, where efficiency.sh finds it, in two
halves of different seeds, as pictures of half floats: NAME-1.exr and NAME-2.exr from A.exr and B.exr, with A.json and
B.json what tdpt-render --json says of them; NAME.json, what they are; and a row of FOLDER/README.md for each that
is there. SCENE: the file they show; PROGRAM: words for what rendered them.

Rounding to half floats is off by at most 2^-11 of a value: relMSE 2.4e-7 at most, 5e-8 on average.
"""
import glob
import json
import os
import struct
import subprocess
import sys

import exr_file

README = """# References of doc/efficiency.md

Written by `make efficiency-references` (`bench/stored_reference.py`), read by `bench/efficiency.sh` while scene, depth
and size are those of NAME.json, whatever the renderer: every integrator here converges to the same picture.
Each is two halves of different seeds, half floats, which `bench/efficiency.sh` tells how to use; NAME-whole has no
limit of depth. To make one anew, delete its NAME.json. doc/efficiency.md says how noisy they are.

| name | size | depth | integrator | samples per pixel | CPU seconds | rendered by |
|---|---|---|---|---|---|---|
"""


def scene_sum(path):
    """What cksum says: sum and size."""
    with open(path, "rb") as file:
        return subprocess.run(["cksum"], stdin=file, check=True, capture_output=True, text=True).stdout.strip()


def described(scene, halves, seeds, program):
    """What NAME.json says. Halves that do not belong together are an error."""
    first, second = halves
    for field in ("integrator", "width", "height", "max_depth"):
        if first[field] != second[field]:
            raise ValueError(f"{field} of the halves: {first[field]} and {second[field]}, expected the same")
    if seeds[0] == seeds[1]:
        raise ValueError(f"both halves have seed {seeds[0]}, expected two")
    return {"scene": scene_sum(scene), "max_depth": first["max_depth"], "width": first["width"], "height": first["height"],
            "integrator": first["integrator"], "program": program, "seeds": [int(s) for s in seeds],
            "spp": [h["spp"] for h in halves], "cpu_seconds": [round(h["cpu_seconds"], 1) for h in halves]}


def readme(folder):
    rows = []
    for path in sorted(glob.glob(os.path.join(glob.escape(folder), "*.json"))):
        with open(path, encoding="utf-8") as file:
            r = json.load(file)
        rows.append("| %s | %d x %d | %s | %s | %d and %d | %.0f and %.0f | %s |\n" % (
            os.path.basename(path)[: -len(".json")], r["width"], r["height"], r["max_depth"] or "no limit",
            r["integrator"], *r["spp"], *r["cpu_seconds"], r["program"]))
    return README + "".join(rows)


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def main(folder, name, scene, a, b, program):
    halves, pictures = [], []
    for stem in (a, b):
        with open(stem + ".json", encoding="utf-8") as file:
            halves.append(json.load(file))
        pictures.append(exr_file.read(stem + ".exr"))
    for _, header in pictures:
        if f"from {os.path.basename(scene)} " not in header["provenance"]:
            raise ValueError(f"a half is not from {os.path.basename(scene)}: {header['provenance']}")
    about = described(scene, halves, [header["seed"] for _, header in pictures], program)
    for i, (rgb, header) in enumerate(pictures):
        exr_file.write(os.path.join(folder, f"{name}-{i + 1}.exr"), rgb, **header)
    write(os.path.join(folder, f"{name}.json"), json.dumps(about, indent=1) + "\n")
    write(os.path.join(folder, "README.md"), readme(folder))


if __name__ == "__main__":
    if len(sys.argv) != 7:
        sys.exit("usage: stored_reference.py FOLDER NAME SCENE A B PROGRAM")
    try:
        main(*sys.argv[1:])
    except (OSError, KeyError, ValueError, struct.error) as error:
        sys.exit(f"stored_reference.py: {error}")
