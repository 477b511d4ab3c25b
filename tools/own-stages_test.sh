#!/bin/sh
# own-stages_test.sh BIN ROOT: the stages of doc/own, in place of lightgrid and portalfit, find the opening of two-rooms.glb, 0.25 m
# wide and high in the wall x = 2..2.1 with its middle at (2.05, 1, 0); exit 77 without numpy.
bin=$(cd "${1:?usage: own-stages_test.sh BIN ROOT}" && pwd) root=$(cd "${2:?}" && pwd)
for python in python3 /usr/bin/python3 none; do
  "$python" -c 'import numpy' 2>/dev/null && break
done
[ "$python" != none ] || { echo "skipped: numpy is missing"; exit 77; }
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
PATH=$bin:$PATH
cd "$work" || exit 2
room=$root/testdata/scenes/two-rooms.glb own=$root/doc/own

cat >found.py <<'END'
# found.py TABLE JSON [GLTF]: whether what tdpt-info says of a portal is the opening, and the corners of GLTF lie in it.
import base64, json, sys
import numpy as np

(portal,) = json.loads(sys.argv[2])["facts"]["portals"]
print(sys.argv[1], "gives", portal["area_m2"], "m2")
assert abs(portal["area_m2"] / 0.0625 - 1) < 0.1
if len(sys.argv) > 3:
    gltf = json.load(open(sys.argv[3]))
    corners = np.frombuffer(base64.b64decode(gltf["buffers"][0]["uri"].split(",")[1]), "<f4").reshape(-1, 3)
    middle = (corners.min(0) + corners.max(0)) / 2
    assert np.all(np.abs(middle - [2.05, 1, 0]) < [0.06, 0.02, 0.02]), middle
    a, b, c = corners[:3]
    normal = np.cross(b - a, c - a)
    assert normal[0] / np.linalg.norm(normal) < -0.99, normal
END

set -e
ffgraph --quiet --quality draft "$room" | mincut --quiet -o room.cut
"$python" "$own/lightgrid.py" "$room" room.cut >lines.csv
portalfit --quiet lines.csv -o lines.glb
"$python" found.py "portalfit of our lines" "$(tdpt-info --json lines.glb)"
lightgrid --quiet --quality draft "$room" room.cut --lines-from lines.csv -o own.vdb
portalfit --quiet own.vdb -o grid.glb
"$python" found.py "portalfit of our lines in a grid" "$(tdpt-info --json grid.glb)"
tdpt-info --dump lines own.vdb >kept.csv
"$python" "$own/portalfit.py" kept.csv own.gltf
"$python" found.py "our fit of our lines" "$(tdpt-info --json own.gltf)" own.gltf
lightgrid --quiet --quality draft "$room" room.cut -o room.vdb
tdpt-info --dump lines room.vdb >drawn.csv
"$python" "$own/portalfit.py" drawn.csv drawn.gltf
"$python" found.py "our fit of lightgrid's lines" "$(tdpt-info --json drawn.gltf)" drawn.gltf
tdpt-render --quiet --width 16 --spp 1 --integrator tdpt "$room" --portal own.gltf -o room.exr 2>said
cat said
[ ! -s said ]
