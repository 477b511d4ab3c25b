"""Scenes and page of only-needed.sh: see USAGE."""
import csv
import json
import os
import struct
import subprocess
import sys

import numpy as np
from intervals import ratio_interval

USAGE = "usage: only_needed.py scenes ROOM FOLDER | nothing CSV STATUS WHAT COMMAND... | page FOLDER SPP WIDTH"
LIMIT = 1.02  # of tdpt-render over its twin


def read_glb(path):
    """The JSON of a .glb, and the chunks after it."""
    with open(path, "rb") as file:
        data = file.read()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[20 + length :]


def glb_bytes(scene, rest):
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + rest
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def dark(scene):
    """Without anything that emits."""
    for material in scene["materials"]:
        material.pop("emissiveFactor", None)
        material.pop("extensions", None)
    return scene


def away(scene):
    """Its camera far above, looking up."""
    for node in scene["nodes"]:
        if "camera" in node:
            node.pop("matrix", None)
            node["translation"], node["rotation"] = [0, 50, 0], [0.5**0.5, 0, 0, 0.5**0.5]
    return scene


def ratios(rows):
    """Of runs as (what, scene, run, a, b): {(what, scene): (median of a/b, its interval's ends, median of b)}."""
    groups = {}
    for what, scene, _, a, b in rows:
        groups.setdefault((what, scene), []).append((float(a), float(b)))
    table = {}
    for key, pairs in groups.items():
        a, b = np.array(pairs).T
        low, high = ratio_interval(a / b, np.ones(len(b)), np.random.default_rng(1)) if len(b) > 1 else (np.nan, np.nan)
        table[key] = float(np.median(a / b)), float(low), float(high), float(np.median(b))
    return table


def verdict(ratio, low, high):
    """By the interval of the mean; where that says nothing, by the median."""
    if high <= LIMIT or low > LIMIT:
        return "yes" if high <= LIMIT else "**no**"
    return "likely" if ratio <= LIMIT else "perhaps not"


def round_lines(rows):
    yield "| scene | round | why | CPU seconds |"
    yield "|---|---|---|---|"
    for row in rows:
        yield "| " + " | ".join(row) + " |"


def read(folder, name):
    with open(f"{folder}/{name}.csv", newline="") as file:
        return list(csv.reader(file, delimiter=";"))


def twin_lines(runs, counts):
    yield "| scene | integrator | CPU time | 95 % interval of the mean | instructions | within 2 % |"
    yield "|---|---|---|---|---|---|"
    counted = {key: value[0] for key, value in ratios(counts).items()}
    for (what, scene), (ratio, low, high, _) in ratios(runs).items():
        if not what.startswith("twin "):
            continue
        count = counted.get((what, scene))
        told = f"{count:.3f}" if count else "-"
        name = what.removeprefix("twin --integrator ")
        yield f"| {scene} | {name} | {ratio:.3f} | {low:.3f} to {high:.3f} | {told} | {verdict(ratio, low, high)} |"


def asked_lines(runs):
    yield "| what | scene | CPU time | 95 % interval of the mean |"
    yield "|---|---|---|---|"
    for (what, scene), (ratio, low, high, _) in ratios(runs).items():
        if not what.startswith("twin "):
            yield f"| {what} | {scene} | {ratio:.3f} | {low:.3f} to {high:.3f} |"


def nothing_lines(rows):
    yield "| stage | CPU seconds |"
    yield "|---|---|"
    for what, seconds in rows:
        yield f"| {what} | {float(seconds):.2f} |"


def settings(runs, counts, spp, width):
    """How the page was made, which the command may be told otherwise."""
    counted = "INSTRUCTIONS=1" if counts else "instructions not counted"
    n = max(int(row[2]) for row in runs)
    return f"RUNS={n} pairs of runs that take turns, SPP={spp} samples a pixel, WIDTH={width} pixels,\n{counted}"


def page(folder, spp, width):
    runs, counts = read(folder, "runs"), read(folder, "instructions")
    return f"""# What is not needed, and what it costs

`make only-needed` writes this page. This one: {settings(runs, counts, spp, width)}; one thread, CPU seconds of rendering alone.
`--explain` of every program says what it leaves out, and why.

## A diffuse scene

`tdpt-render` over its twin `tdpt-render-diffuse`, the same sources without textures, normals that are not the
triangle's own, microfacets, transmission, absorption and Dirac lobes. Both make the same bytes. CPU time: the median of
the ratios, and the interval of their mean, which decides where it can; else `likely` and `perhaps not` go by the median.
Instructions are of rendering alone, without loading; most of those that the twin saves are cheap: predicted branches,
registers put aside.

{chr(10).join(twin_lines(runs, counts))}

## What is not asked for

The price of asking for something, as a ratio to not asking: what is saved without it.

{chr(10).join(asked_lines(runs))}

## Nothing to do

{chr(10).join(nothing_lines(read(folder, "nothing")))}

A scene without light is refused by `ffgraph`, which has nothing to start from; the others end with status 0 and a
sentence (`cli.nothing-to-do`, `longest_path_test`).

## Done only when it pays

| what | who decides | price of deciding | held by |
|---|---|---|---|
| layers, frames, alpha | options; off | above | `layers_test`, `stats_test`, `alpha_test` |
| techniques | `auto`, by error x work of samples that are thrown away | about 1 to 6 % of the picture's work | `auto_test`, [regret.md](regret.md) |
| portals | a small picture's light, then `auto` | 2 % of the samples, at most 3072 | `portal_ways_test`, `auto_test`, [regret.md](regret.md) |
| tables of the sky through windows | there are both, a sky and portals | nothing | `sky_samplers_test` |
| kinds of light by what arrives | there is a sky beside other lights | a small picture of `nee` | `arrival_test` |
| panels | one big rectangle or 2 to 8 are all that emits | nothing | `panels_test` |
| cuts | drops of the potential; closets are not cut | two maximum flows for one opening | `series_cut_test` |
| batches of segments | until the counts change by less than 4 % | comparing two grids | `lightgrid_test` |
| the fine pass of a cut | a coarse segment joins its sides | nothing | `lightgrid_test`, `cli.lightgrid-no-bottleneck` |
| candidates of a portal | a quarter of the threshold of lines is left | nothing | `portalfit_test` |
| rounds of `ffgraph` | patches straddle an opening | below | `ffgraph_test` |

A round narrows the opening where patches straddle it, and is made whether it then pays or not: it pays where the opening
lets a twentieth less of the light pass than before.

{chr(10).join(round_lines(read(folder, "rounds")))}
"""


def nothing(path, status, what, *command):
    """A row more: the CPU seconds of a command, which ends with that status."""
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = child.stderr.read().decode(errors="replace")
    _, ended, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(ended)
    if child.returncode != int(status):
        sys.exit(f"only-needed: {what}: status {child.returncode}, expected {status}: {said}")
    with open(path, "a", encoding="ascii") as file:
        print(what, "%.3f" % (usage.ru_utime + usage.ru_stime), sep=";", file=file)


def main(arguments):
    if not arguments or arguments[0] not in ("scenes", "nothing", "page"):
        sys.exit(USAGE)
    if arguments[0] == "nothing":
        nothing(*arguments[1:])
    elif arguments[0] == "scenes":
        scene, rest = read_glb(arguments[1])
        text = json.dumps(scene)
        for name, change in {"dark": dark, "away": away}.items():
            with open(f"{arguments[2]}/{name}.glb", "wb") as file:
                file.write(glb_bytes(change(json.loads(text)), rest))
    else:
        print(page(*arguments[1:]), end="")


if __name__ == "__main__":
    main(sys.argv[1:])
