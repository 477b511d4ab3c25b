#!/bin/sh
# stages.sh BIN CACHE: the pictures of doc/stages.md, one of each stage, from the programs in BIN;
# CACHE receives what lies between the stages, and the same for 3D viewers.
# The environment may set
#   SCENE   default veach-ajar.glb of the paper's scenes
#   INTERIOR   a room whose lamp stands in its own window, for the last picture; default kitchen.glb of the interiors;
#              left out, with a word, where it is not there
#   DOC     where figures/stage-*.png go; default doc
set -eu
bin=${1:-build/bin} cache=${2:-build/stages}
here=$(cd "$(dirname "$0")/.." && pwd)
scene=${SCENE:-$here/../shared/scenes/veach-ajar.glb} doc=${DOC:-$here/doc}
interior=${INTERIOR:-$here/../shared/scenes/interiors/kitchen.glb}
[ -s "$scene" ] || { echo "stages: there is no scene $scene; name one with SCENE=FILE" >&2; exit 3; }
mkdir -p "$cache" "$doc/figures"
# With the two side outputs of each stage.
stage() {
  program=$1
  shift
  [ "$program" != mincut ] || set -- "$@" --scene "$scene"
  "$bin/$program" --quiet "$@" --preview "$doc/figures/stage-$program.png" --debug-glb "$cache/$program.debug.glb"
}
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
find_portals "$scene" "$cache/room"
if [ -s "$interior" ]; then
  "$bin/ffgraph" --quiet "$interior" -o "$cache/interior.max"
  "$bin/mincut" --quiet "$cache/interior.max" -o "$cache/interior.cut" --scene "$interior" \
    --preview "$doc/figures/stage-mincut-kitchen.png"
else
  echo "stages: $interior is not there: its picture is left out" >&2
fi
echo "stages: $doc/figures/stage-{ffgraph,mincut,lightgrid,portalfit}.png, for 3D viewers $cache/*.debug.glb"
