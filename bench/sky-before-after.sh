#!/bin/sh
# sky-before-after.sh BIN [CACHE [DOC]]: DOC/sky-before-after.png, a room that the sun lights through its window: on the
# left without portals, on the right with those that the four stages find, in equal CPU time; and what both are worth,
# for the caption, on stdout. A few minutes.
# The environment may set
#   SCENE, SKY, TURN   a room without lamps, its --environment and --environment-rotation (blinds.glb, which sky.sh
#                leaves in CACHE, clear-sun.exr of testdata and 0). For living-room.glb of the interiors TURN=200 lets
#                the sun in through both walls' windows
#   WIDTH, SPP   of each half (480), and samples per pixel of the right one (12); others get as many as they need for
#                the same CPU time
#   BEFORE       integrator of the left one (nee); ALSO: another without portals, told alone (bdpt)
#   REF_SPP      samples per pixel of the reference (36), by auto with the portals
# shellcheck disable=SC2086  # unquoted variables are lists
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) cache=${2:-build/sky} doc=${3:-doc}
here=$(cd "$(dirname "$0")/.." && pwd)
scene=${SCENE:-$cache/blinds.glb}
sky="--environment ${SKY:-$here/testdata/environments/clear-sun.exr} --environment-rotation ${TURN:-0}"
width=${WIDTH:-480} spp=${SPP:-12} before=${BEFORE:-nee} also=${ALSO:-bdpt}
[ -s "$scene" ] || { echo "sky-before-after: there is no scene $scene; run sky.sh first, or name one with SCENE=FILE" >&2; exit 3; }
command -v jq >/dev/null || { echo "sky-before-after: jq is missing" >&2; exit 5; }
mkdir -p "$cache" "$doc"
stem=$cache/before-after
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() {
  program=$1
  shift
  case $program in ffgraph | lightgrid) set -- "$@" $sky ;; esac
  "$bin/$program" --quiet "$@"
}
# render NAME OPTION...: $stem-NAME.exr; prints its CPU seconds.
render() {
  name=$1
  shift
  "$bin/tdpt-render" "$scene" $sky --width "$width" --quiet --json "$@" -o "$stem-$name.exr" >"$stem-$name.json"
  jq .cpu_seconds "$stem-$name.json"
}
find_portals "$scene" "$stem"
seconds=$(render after --portal "$stem.portal.glb" --spp "$spp")
# without INTEGRATOR: in the time of the picture with portals.
without() {
  few=$(render "$1" --integrator "$1" --spp 2)
  samples=$(awk -v all="$seconds" -v two="$few" 'BEGIN { n = int(2 * all / two + 0.5); if (n < 1) n = 1; print n }')
  render "$1" --integrator "$1" --spp "$samples" >"$stem.seconds"
}
without "$before"
without "$also"
render reference --portal "$stem.portal.glb" --spp "${REF_SPP:-36}" --seed 1000001 >"$stem.seconds"
"$bin/exrdiff" --quiet "$stem-$before.exr" "$stem-after.exr" --side-by-side "$doc/sky-before-after.png" >"$stem.text"
# told NAME: what it is and how far off.
told() {
  { cat "$stem-$1.json"; "$bin/exrdiff" --quiet --json "$stem-$1.exr" "$stem-reference.exr"; } |
    jq -rs '. as [$run, $off] | "\($run.integrator) \($run.chosen // "without portals"), \($run.spp) samples per pixel, " +
      "\($run.cpu_seconds) CPU s: relMSE \($off.relmse), PSNR \($off.psnr) dB, mean \($off.mean) (reference " +
      "\($off.reference_mean)); black: relMSE \($off.black.relmse), PSNR \($off.black.psnr) dB"'
}
echo "$(basename "$scene"), $(jq -r '"\(.width) x \(.height)"' "$stem-after.json") each"
for name in "$before" "$also" after; do told "$name"; done
echo "sky-before-after: $doc/sky-before-after.png"
