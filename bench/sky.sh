#!/bin/sh
# sky.sh BIN [CACHE [DOC]]: what the windows that the stages find are worth under a sky: DOC/sky.md. Rooms x skies;
# in each, pictures of equally many samples by `bdpt` and `nee` without portals and by what can be done with the portals
# found, several seeds, taking turns, one thread each; efficiency 1 / (relMSE x CPU s) over the better of the two
# without. A quarter of an hour on two quiet cores. What was measured stays in CACHE, a file for each room and sky, under
# a key of programs, scene and options; a run that was stopped goes on where it was.
# The environment may set
#   ROOMS     names of the rooms to measure; default all
#   SKIES     of: overcast clear sun (sun: an interior has its own map instead); default all
#   SCENES    folder with interiors/ (../shared/scenes); what is not there is left out, with a word
#   SPP, SEEDS       samples per pixel (32), and pictures of each kind (4)
#   REF_SPP          samples per pixel of each half of a reference (96)
#   REF_INTEGRATOR   of the references, with the portals found (auto)
#   WIDTH, HEIGHT    of the pictures of rooms (72 x 54); those of interiors are a third wider
#   JOBS             rooms and skies at a time (all cores)
#
# A reference has two halves A, B. A picture x is off by (d(x,A) + d(x,B) - d(A,B)) / 2, d = relMSE or MSE, to which the
# noise of neither half contributes on average.
# shellcheck disable=SC2086  # unquoted variables are lists
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) cache=${2:-build/sky} doc=${3:-doc}
here=$(cd "$(dirname "$0")/.." && pwd)
interiors=${SCENES:-$here/../shared/scenes}/interiors maps=$here/testdata/environments
spp=${SPP:-32} seeds=${SEEDS:-4} reference_spp=${REF_SPP:-96} reference_integrator=${REF_INTEGRATOR:-auto}
width=${WIDTH:-72} height=${HEIGHT:-54}
wide=$((width * 4 / 3))
# Name, group, and what it is: the N-th room of a kind (room, below), or an interior.
list='
window windows sky-window 1
windows windows sky-windows 1
corner windows corner-windows 1
skylight windows skylight 1
blinds windows sky-blinds 1
facade windows deep-facade 1
behind second room-behind 1
behind-2 second room-behind 2
living-room interiors - -
classroom interiors - -
'
say() { printf '%s\n' "$*"; }
command -v jq >/dev/null || { say "sky: jq is missing" >&2; exit 5; }
sh "$here/bench/python.sh" -c '' || { say "sky: python3 with numpy is missing" >&2; exit 5; }
mkdir -p "$cache" "$doc"
cache=$(cd "$cache" && pwd)
programs=$(cd "$bin" && cat ffgraph mincut lightgrid portalfit tdpt-render | cksum)
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"

# room KIND N FILE: the N-th generated room of that kind which has no lamp and stands upright, in metres: half of them
# are turned, where no map's sky would be above. Stages that fail at once leave the room alone.
room() {
  [ -s "$3" ] && return 0
  for program in ffgraph mincut lightgrid portalfit; do
    mkdir -p "$cache/none"
    ln -sf "$(command -v false)" "$cache/none/$program"
  done
  "$bin/portals_bench" "$cache/none" --rooms 40 --kinds "$1" --jobs 1 --keep "$cache/none/rooms" >"$cache/none/$1" 2>&1
  seed=$(awk -v n="$2" '/ lamp sky / && / scale 1 / && !/ turned / && ++found == n {
    for (i = 1; i < NF; ++i) if ($i == "portals") print $(i - 1) }' "$cache/none/$1")
  [ -n "$seed" ] || { say "sky: of 40 rooms $1 fewer than $2 have a sky and no placement" >&2; return 1; }
  cp "$cache/none/rooms/$1-$seed.glb" "$3"
  rm -r "$cache/none/rooms"
}
# environment NAME SKY: what --environment gets.
environment() {
  case $2 in
    overcast) say 1,1,1 ;;
    clear) say "$maps/clear.exr" ;;
    sun) if [ -s "$interiors/$1.env.exr" ]; then say "$interiors/$1.env.exr"; else say "$maps/clear-sun.exr"; fi ;;
    *) say "sky: SKIES: $2 is none of overcast, clear, sun" >&2; return 2 ;;
  esac
}
stage() {
  program=$1
  shift
  case $program in
    ffgraph | lightgrid) set -- "$@" --environment "$sky" ;;
    portalfit) set -- "$@" --json ;;
  esac
  "$bin/$program" --quiet "$@"
}
render() { "$bin/tdpt-render" "$file" --quiet --json --environment "$sky" $size "$@"; }
distance() { "$bin/exrdiff" --quiet --json "$1" "$2"; }

# run METHOD SEED: a line "run NAME SKY METHOD SEED CPU RELMSE MSE MEAN CHOSEN".
run() {
  portal="--portal $stem.portal.glb"
  case $1 in
    bdpt | nee) set -- "$1" "$2" --integrator "$1" ;;
    windows) set -- "$1" "$2" $portal --integrator nee ;;
    aimed) set -- "$1" "$2" $portal --integrator nee --guide-camera 0.4 ;;
    guided) set -- "$1" "$2" $portal --integrator tdpt-guided ;;
    auto) set -- "$1" "$2" $portal ;;
  esac
  method=$1 number=$2
  shift 2
  render "$@" --spp "$spp" --seed "$number" --threads 1 -o "$stem.exr" >"$stem.json"
  { cat "$stem.json"; distance "$stem.exr" "$stem-1.exr"; distance "$stem.exr" "$stem-2.exr"; cat "$stem.distance"; } |
    jq -rs --arg of "$name $light $method $number" --arg method "$method" '. as [$stats, $a, $b, $d] |
      "run \($of) \($stats.cpu_seconds) \(($a.relmse + $b.relmse - $d.relmse) / 2) \(($a.mse + $b.mse - $d.mse) / 2) " +
      "\($a.mean / (($a.reference_mean + $b.reference_mean) / 2)) \($stats.chosen // $method | gsub(" "; "_"))"'
}
# The cell of a room and a sky: portals, references, pictures. Its lines: cell NAME GROUP SKY PORTALS BLACK_RELMSE
# BLACK_PSNR PEAK (squared), and those of run.
cell() {
  name=$1 light=$2 group=$3 file=$4
  stem=$cache/$name-$light sky=$(environment "$name" "$light") size="--width $width --height $height"
  [ "$group" != interiors ] || size="--width $wide --height $height"
  shines=$sky; [ ! -f "$sky" ] || shines=$(cksum <"$sky")
  key="$programs $(cksum <"$file") $shines $size $spp $seeds $reference_spp $reference_integrator"
  [ "$(cat "$stem.key" 2>/dev/null)" != "$key" ] || return 0
  rm -f "$stem.key"
  say "sky: $name, $light" >&2
  find_portals "$file" "$stem" >"$stem.found"
  rm -f "$stem.max" "$stem.cut" "$stem.vdb"
  for half in 1 2; do
    render --portal "$stem.portal.glb" --integrator "$reference_integrator" --spp "$reference_spp" \
      --seed $((1000000 + half)) --threads 1 -o "$stem-$half.exr" >"$stem.json"
  done
  { distance "$stem-1.exr" "$stem-2.exr"; distance "$stem-2.exr" "$stem-1.exr"; } |
    jq -s '{relmse: (map(.relmse) | add / 2), mse: (map(.mse) | add / 2), black: .[0].black,
            peak: (.[0].mse * pow(10; .[0].psnr / 10))}' >"$stem.distance"
  jq -rs --arg of "$name $group $light" '. as [$found, $d] |
    "cell \($of) \($found.portals | length) \($d.black.relmse) \($d.black.psnr) \($d.peak)"' \
    "$stem.found" "$stem.distance" >"$stem.part"
  methods="bdpt nee windows aimed guided auto"
  for n in $(seq "$seeds"); do
    for method in $methods; do run "$method" "$n" >>"$stem.part"; done
    methods=$(set -- $methods; first=$1; shift; say "$* $first")  # another one goes first
  done
  mv "$stem.part" "$stem.runs"
  printf '%s\n' "$key" >"$stem.key"
}

# Called by itself, below: one cell.
if [ $# -gt 3 ]; then
  shift 3
  cell "$@"
  exit
fi

: >"$cache/cells"
say "$list" | while read -r name group kind number; do
  case " ${ROOMS:-$name} " in *" $name "*) ;; *) continue ;; esac
  [ -n "$name" ] || continue
  file=$cache/$name.glb
  if [ "$group" = interiors ]; then
    file=$interiors/$name.glb
    [ -s "$file" ] || { say "sky: there is no $file: left out" >&2; continue; }
  else
    room "$kind" "$number" "$file"
  fi
  for light in ${SKIES:-overcast clear sun}; do
    environment "$name" "$light" >/dev/null
    say "$name $light $group $file" >>"$cache/cells"
  done
done
[ -s "$cache/cells" ] || { say "sky: none of the rooms is there" >&2; exit 3; }
xargs -L 1 -P "${JOBS:-$(nproc)}" sh "$0" "$bin" "$cache" "$doc" <"$cache/cells"
while read -r name light group file; do cat "$cache/$name-$light.runs"; done <"$cache/cells" >"$cache/all"

{
  cat <<INTRO
# What the windows found are worth under a sky

Written by \`make sky\` ($("$bin/tdpt-render" --version | head -1)). Pictures of $width x $height pixels (interiors $wide x $height), $spp samples per pixel,
paths of any length, $seeds seeds; runs of one thread taking turns. Portals are those that the four stages find, given the same
\`--environment\`; the reference has twice $reference_spp samples per pixel by \`$reference_integrator\`, and its noise is taken out of the errors.

* Skies. overcast: 1,1,1 from everywhere. clear: \`testdata/environments/clear.exr\`. sun: \`clear-sun.exr\`, all the sun in one
  texel; the interiors have their own maps instead, a low sun (living-room) and a sun beside a sky (classroom).
* Rooms: the first of a kind of \`libcommon/testing/rooms/known_rooms.h\` that have no lamp and stand upright. behind, behind-2: a door
  behind the room with the windows.
* Gain: efficiency, 1 / (relMSE x CPU s), over that of the better of \`bdpt\` and \`nee\` without portals; in brackets the 95 % interval
  over seeds, by bootstrap. The better one is picked by the same pictures, which favours it.
* \`nee\` + portals: next events through the windows. \`nee\` 0.4: \`--guide-camera 0.4\`, too. \`auto\` pays for its choice.

INTRO
  sh "$here/bench/python.sh" "$here/bench/sky.py" "$cache/all"
} >"$cache/page"
mv "$cache/page" "$doc/sky.md"
say "sky: $doc/sky.md"
