#!/bin/sh
# cycles-portals_test.sh BIN: what `portalfit --for cycles` writes makes lamps in Blender where the portals are, seen
# with the eyes of Blender's own glTF importer; and a script with a planted fault is told apart. Exit 77, with a word,
# where there is no Blender. The environment may set BLENDER.
set -eu
bin=${1:?usage: cycles-portals_test.sh BIN}
here=$(cd "$(dirname "$0")/.." && pwd)
blender=${BLENDER:-blender}
command -v "$blender" >/dev/null || { echo "no Blender here (Debian: blender)" >&2; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

check() {
  "$blender" -b --factory-startup --python-exit-code 1 --python "$here/bench/cycles-portals.py" -- "$1" "$2" \
    >"$work/log" 2>&1
}

for room in window door-ajar; do
  scene=$here/testdata/scenes/$room.glb
  "$bin/ffgraph" --quiet "$scene" | "$bin/mincut" --quiet -o "$work/room.cut"
  "$bin/lightgrid" --quiet "$scene" "$work/room.cut" -o "$work/room.vdb"
  "$bin/portalfit" --quiet --all "$work/room.vdb" -o "$work/$room.glb"
  "$bin/portalfit" --quiet --all --for cycles "$work/room.vdb" -o "$work/$room.py"
  check "$work/$room.glb" "$work/$room.py" || { cat "$work/log"; exit 1; }
  grep ' lamps for ' "$work/log"
done

# plant NAME SED: the last script, changed, must be refused.
plant() {
  sed "$2" "$work/$room.py" >"$work/wrong.py"
  if cmp -s "$work/$room.py" "$work/wrong.py"; then echo "$1: nothing was planted"; exit 1; fi
  if check "$work/$room.glb" "$work/wrong.py"; then echo "$1 was not seen"; exit 1; fi
  grep -q '^cycles-portals.py: ' "$work/log" || { cat "$work/log"; exit 1; }
}
plant 'a lamp turned round' 's/portal.matrix_world = Matrix(matrix)/portal.matrix_world = Matrix(matrix) @ Matrix.Diagonal((1, -1, -1, 1))/'
plant 'a lamp 1 % too wide' 's/lamp.size_y = "RECTANGLE", width,/lamp.size_y = "RECTANGLE", 1.01 * width,/'
plant 'a lamp that is no portal' 's/is_portal = True/is_portal = False/'
