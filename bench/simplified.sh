#!/bin/sh
# simplified.sh BIN [WORK]: what becomes of the portals when the smallest triangles of a scene are dropped, 0.1 % to 50 %
# of its area (paper, 4.1: "proper simplification does not affect the stability of the results"). Prints a table in
# markdown; first a row for another seed, which is what chance alone does. Five CPU seconds a row.
# The environment may set
#   SCENES   files; default veach-ajar of the paper's, where it is beside the project, and three of testdata
#   SHARES   default "0.001 0.01 0.02 0.05 0.1 0.2 0.5"
set -eu
export LC_ALL=C
bin=${1:-build/bin} work=${2:-build/simplified}
here=$(cd "$(dirname "$0")/.." && pwd)
paper=$here/../shared/scenes own=$here/testdata/scenes
scenes=${SCENES:-$paper/veach-ajar.glb $own/two-rooms.glb $own/door-ajar.glb $own/three-rooms.glb}
shares=${SHARES:-0.001 0.01 0.02 0.05 0.1 0.2 0.5}
mkdir -p "$work"
bin=$(cd "$bin" && pwd)
python() { sh "$here/bench/python.sh" "$here/bench/simplified.py" "$@"; }

# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() {
  program=$1
  shift
  case $program in ffgraph | lightgrid) set -- --threads 1 --seed "$seed" "$@" ;; esac
  "$bin/$program" --quiet "$@"
}
echo '| scene | area dropped | triangles dropped | portal |'
echo '|---|---|---|---|'
for scene in $scenes; do
  [ -r "$scene" ] || { echo "simplified: $scene is not there, left out" >&2; continue; }
  name=$(basename "$scene" .glb)
  seed=1
  find_portals "$scene" "$work/whole"
  seed=2
  find_portals "$scene" "$work/other"
  echo "| $name | none, another seed | - | $(python compare "$work/whole.portal.glb" "$work/other.portal.glb") |"
  seed=1
  for share in $shares; do
    dropped=$(python drop "$scene" "$share" "$work/less.glb")
    find_portals "$work/less.glb" "$work/other"
    echo "| $name | $share | $dropped | $(python compare "$work/whole.portal.glb" "$work/other.portal.glb") |"
  done
done
