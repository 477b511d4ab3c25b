#!/bin/sh
# stages.sh BIN CACHE: the pictures of doc/stages.md, one of each stage, from the programs in BIN;
# CACHE receives what lies between the stages, and the same for 3D viewers.
# The environment may set
#   SCENE   default veach-ajar.glb of the paper's scenes
#   DOC     where figures/stage-*.png go; default doc
set -eu
bin=${1:-build/bin} cache=${2:-build/stages}
here=$(cd "$(dirname "$0")/.." && pwd)
scene=${SCENE:-$here/../shared/scenes/veach-ajar.glb} doc=${DOC:-$here/doc}
[ -s "$scene" ] || { echo "stages: there is no scene $scene; name one with SCENE=FILE" >&2; exit 3; }
mkdir -p "$cache" "$doc/figures"
# picture STAGE: the two side outputs of a stage.
picture() { printf '%s' "--preview $doc/figures/stage-$1.png --debug-glb $cache/$1.debug.glb"; }
# Unquoted on purpose: several options.
"$bin/ffgraph" --quiet "$scene" -o "$cache/room.max" $(picture ffgraph)
"$bin/mincut" --quiet "$cache/room.max" --scene "$scene" -o "$cache/room.cut" $(picture mincut)
"$bin/lightgrid" --quiet "$scene" "$cache/room.cut" -o "$cache/room.vdb" $(picture lightgrid)
"$bin/portalfit" --quiet "$cache/room.vdb" -o "$cache/room.portal.glb" $(picture portalfit)
echo "stages: $doc/figures/stage-{ffgraph,mincut,lightgrid,portalfit}.png, for 3D viewers $cache/*.debug.glb"
