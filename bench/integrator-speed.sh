#!/bin/sh
# integrator-speed.sh BIN CACHE: how fast the integrators are, and how noisy their pictures after a minute of one
# core, beside Tungsten's figures on a machine of the same kind (2 cores, depth 6, box filter, no
# roulette); ours are at depth 6, too. Prints a table. References are kept in CACHE.
# The environment may set
#   SCENES     folder of the paper's scenes; without veach-ajar.glb its rows are left out, with a word
#   SECONDS_EACH, REF_SECONDS   of a picture on one core (60), of a reference on all cores (600)
set -eu
bin=${1:-build/bin} cache=${2:-build/bench}
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} each=${SECONDS_EACH:-60} reference=${REF_SECONDS:-600}
command -v jq >/dev/null || { echo "integrator-speed: jq is missing" >&2; exit 5; }
mkdir -p "$cache"
bin=$(cd "$bin" && pwd)
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() { program=$1; shift; "$bin/$program" --quiet "$@"; }

# rows SCENE WIDTH HEIGHT NAME: a row for every integrator.
rows() {
  scene=$1 width=$2 height=$3 name=$4
  if [ ! -r "$scene" ]; then
    echo "integrator-speed: $scene is not there, its rows are left out" >&2
    return
  fi
  portal=$cache/$name.portal.glb
  key="$name $width $height $reference $(cksum <"$bin/tdpt-render") $(cksum <"$scene")"
  if [ "$(cat "$cache/$name.key" 2>/dev/null)" != "$key" ]; then
    find_portals "$scene" "$cache/$name"
    "$bin/tdpt-render" --quiet "$scene" --portal "$portal" --integrator tdpt-org --seed 1000 \
      --time "$reference" --max-depth 6 --width "$width" --height "$height" -o "$cache/$name.reference.exr"
    echo "$key" >"$cache/$name.key"
  fi
  for integrator in pt nee bdpt tdpt-org tdpt tdpt-guided; do
    "$bin/tdpt-render" --quiet "$scene" --portal "$portal" --integrator $integrator --threads 1 \
      --time "$each" --max-depth 6 --width "$width" --height "$height" --stats "$cache/stats.json" \
      -o "$cache/picture.exr"
    peer='- | -'
    case $name-$integrator in
      veach-ajar-bdpt) peer='47 000 | 0.20' ;;
      veach-ajar-nee) peer='140 000 | 0.44-0.59' ;;
      half-metre-hole-bdpt) peer='65 000 | 0.038' ;;
      half-metre-hole-nee) peer='280 000 | -' ;;
    esac
    rate=$(jq '.width * .height * .spp / .cpu_seconds | round' "$cache/stats.json")
    error=$("$bin/exrdiff" --json "$cache/picture.exr" "$cache/$name.reference.exr" |
      jq -r '[.relmse, .psnr, .black.relmse] | map(. * 10000 | round / 10000) | join(" | ")')
    echo "| $name | $integrator | $rate | $error | $peer |"
  done
}

echo "| scene | integrator | samples per CPU second | relMSE after $each s | PSNR | black relMSE |" \
  "Tungsten: samples | relMSE |"
echo "|---|---|---|---|---|---|---|---|"
rows "$scenes/veach-ajar.glb" 320 180 veach-ajar
rows "$here/testdata/scenes/half-metre-hole.glb" 256 256 half-metre-hole
