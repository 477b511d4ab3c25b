#!/bin/sh
# stages.sh BIN CACHE: the pictures of doc/stages.md, one of each stage, from the programs in BIN, for a room behind a
# door and for one with windows; CACHE receives what lies between the stages, and the same for 3D viewers.
# The environment may set
#   SCENE   default veach-ajar.glb of the paper's scenes
#   INTERIOR   a room whose lamp stands in its own window, for the last picture; default kitchen.glb of the interiors;
#              left out, with a word, where it is not there
#   WINDOWS   a room lit by an environment through its windows; default living-room.glb of the interiors; left out, with
#             a word, where it is not there
#   SKY       what shines on WINDOWS, --environment; default the map beside it, NAME.env.exr
#   DOC     where figures/stage-*.png go; default doc
set -eu
bin=${1:-build/bin} cache=${2:-build/stages}
here=$(cd "$(dirname "$0")/.." && pwd)
scene=${SCENE:-$here/../shared/scenes/veach-ajar.glb} doc=${DOC:-$here/doc}
interior=${INTERIOR:-$here/../shared/scenes/interiors/kitchen.glb}
windows=${WINDOWS:-$here/../shared/scenes/interiors/living-room.glb}
[ -s "$scene" ] || { echo "stages: there is no scene $scene; name one with SCENE=FILE" >&2; exit 3; }
mkdir -p "$cache" "$doc/figures"
# With the two side outputs of each stage. suffix: of the pictures' names; sky: what shines, nothing for lamps alone.
stage() {
  program=$1
  shift
  case $program in
    mincut) set -- "$@" --scene "$scene" ;;
    ffgraph | lightgrid) [ -z "$sky" ] || set -- "$@" --environment "$sky" ;;
  esac
  "$bin/$program" --quiet "$@" --preview "$doc/figures/stage-$program$suffix.png" \
    --debug-glb "$cache/$program$suffix.debug.glb"
}
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
suffix='' sky=''
find_portals "$scene" "$cache/room"
if [ -s "$interior" ]; then
  "$bin/ffgraph" --quiet "$interior" -o "$cache/interior.max"
  "$bin/mincut" --quiet "$cache/interior.max" -o "$cache/interior.cut" --scene "$interior" \
    --preview "$doc/figures/stage-mincut-kitchen.png"
else
  echo "stages: $interior is not there: its picture is left out" >&2
fi
if [ -s "$windows" ]; then
  scene=$windows suffix=-windows sky=${SKY:-${windows%.*}.env.exr}
  find_portals "$scene" "$cache/windows"
else
  echo "stages: $windows is not there: its pictures are left out" >&2
fi
echo "stages: $doc/figures/stage-{ffgraph,mincut,lightgrid,portalfit}.png, for 3D viewers $cache/*.debug.glb"
