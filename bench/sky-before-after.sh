#!/bin/sh
# sky-before-after.sh BIN [CACHE [DOC]]: DOC/sky-before-after.png, a furnished room lit through its windows: on the left
# without portals, on the right with those that the four stages find, in equal CPU time; and what both are worth, for
# the caption, on stdout. A few minutes.
# The environment may set
#   SCENE, SKY   a room without lamps and its --environment (living-room.glb of the interiors and the map beside it)
#   WIDTH, SPP   of each half (480), and samples per pixel of the right one (16); the left one gets as many as it
#                needs for the same CPU time
#   BEFORE       integrator of the left one (bdpt); AFTER: of the right one (auto)
#   REF_SPP      samples per pixel of the reference (96)
# shellcheck disable=SC2086  # unquoted variables are lists
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) cache=${2:-build/sky} doc=${3:-doc}
here=$(cd "$(dirname "$0")/.." && pwd)
scene=${SCENE:-$here/../shared/scenes/interiors/living-room.glb}
sky=${SKY:-${scene%.*}.env.exr} width=${WIDTH:-480} spp=${SPP:-16} before=${BEFORE:-bdpt} after=${AFTER:-auto}
[ -s "$scene" ] || { echo "sky-before-after: there is no scene $scene; name one with SCENE=FILE" >&2; exit 3; }
command -v jq >/dev/null || { echo "sky-before-after: jq is missing" >&2; exit 5; }
mkdir -p "$cache" "$doc"
stem=$cache/before-after
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() {
  program=$1
  shift
  case $program in ffgraph | lightgrid) set -- "$@" --environment "$sky" ;; esac
  "$bin/$program" --quiet "$@"
}
# render NAME OPTION...: $stem-NAME.exr; prints its CPU seconds.
render() {
  name=$1
  shift
  "$bin/tdpt-render" "$scene" --environment "$sky" --width "$width" --quiet --json "$@" -o "$stem-$name.exr" >"$stem-$name.json"
  jq .cpu_seconds "$stem-$name.json"
}
find_portals "$scene" "$stem"
seconds=$(render after --portal "$stem.portal.glb" --integrator "$after" --spp "$spp")
one=$(render before --integrator "$before" --spp 2)
samples=$(awk -v all="$seconds" -v two="$one" 'BEGIN { n = int(2 * all / two + 0.5); if (n < 1) n = 1; print n }')
was=$(render before --integrator "$before" --spp "$samples")
render reference --portal "$stem.portal.glb" --integrator "$after" --spp "${REF_SPP:-96}" --seed 1000001 >"$stem.seconds"
"$bin/exrdiff" --quiet "$stem-before.exr" "$stem-after.exr" --side-by-side "$doc/sky-before-after.png" >"$stem.text"
told() {
  "$bin/exrdiff" --quiet --json "$stem-$1.exr" "$stem-reference.exr" |
    jq -r --arg what "$2" '"\($what): relMSE \(.relmse), PSNR \(.psnr) dB; mean \(.mean), reference \(.reference_mean); black: relMSE \(.black.relmse), PSNR \(.black.psnr) dB"'
}
echo "$(basename "$scene"), $(jq -r '"\(.width) x \(.height)"' "$stem-after.json")"
told before "$before, $samples samples per pixel, $was CPU s"
told after "$after ($(jq -r '.chosen // "as it is"' "$stem-after.json")), $spp samples per pixel, $seconds CPU s"
echo "sky-before-after: $doc/sky-before-after.png"
