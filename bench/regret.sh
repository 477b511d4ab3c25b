#!/bin/sh
# regret.sh BIN CACHE [DOC]: what `auto` loses by not knowing which integrator is best, and how right its verdict on
# portals is: DOC/regret.md. About 25 minutes on two quiet cores. What was measured stays in CACHE, a file for
# each scene; a run that was stopped goes on where it was.
# The environment may set
#   SCENES    folder of the paper's scenes and of interiors/; what is not there is left out, with a word
#   SECONDS_EACH   CPU seconds for the true error of each integrator (4)
#   SEEDS     choices of each scene and length (12)
#   ROOMS     generated rooms of each kind (1); SEED of the first (1)
#   ONLY      names of scenes; default all
# bench/drawn holds portals drawn by hand.
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) cache=${2:-build/regret} doc=${3:-doc}
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} each=${SECONDS_EACH:-4} seeds=${SEEDS:-12} rooms=${ROOMS:-1} seed=${SEED:-1}
kinds=hole,slit,floor-door,ajar,window,two-openings,holes-in-row,arch,banister,glazing-bars,blinds,curtains,bay
kinds=$kinds,windows-in-row,double-door,shared-edge,l-room,lamp-outside
mkdir -p "$cache/rooms"

. "$here/bench/find-portals.sh"
stage() {
  program=$1
  shift
  "$bin/$program" --quiet "$@"
}
# measure NAME SCENE [PORTAL]
measure() {
  name=$1
  case " ${ONLY:-$name} " in *" $name "*) ;; *) return 0 ;; esac
  [ -s "$cache/$name.txt" ] && return 0
  [ -f "$2" ] || { echo "regret: $2 is not there: left out" >&2; return 0; }
  shift
  echo "regret: $name" >&2
  "$bin/regret_bench" "$@" --name "$name" --seconds "$each" --seeds "$seeds" --width 64 --height 48 >"$cache/part"
  mv "$cache/part" "$cache/$name.txt"
}
# found NAME SCENE: with the portals that the stages find.
found() {
  case " ${ONLY:-$1+found} " in *" $1+found "*) ;; *) return 0 ;; esac
  [ -f "$2" ] || { echo "regret: $2 is not there: left out" >&2; return 0; }
  [ -s "$cache/$1.portal.glb" ] || find_portals "$2" "$cache/$1"
  measure "$1+found" "$2" "$cache/$1.portal.glb"
}

data=$here/testdata/scenes
for name in two-rooms window; do measure "$name" "$data/$name.glb"; done
for name in cornell-box bathroom2 veach-ajar; do measure "$name" "$scenes/$name.glb"; done
for name in kitchen bathroom living-room-lamps classroom-lamps; do
  measure "$name" "$scenes/interiors/$name.glb"
  measure "$name+drawn" "$scenes/interiors/$name.glb" "$here/bench/drawn/$name.gltf"
done
measure window+drawn "$data/window.glb" "$here/bench/drawn/window.gltf"
for name in two-rooms small-hole half-metre-hole door-ajar three-rooms; do found "$name" "$data/$name.glb"; done
for name in veach-ajar cornell-box-portal bathroom2-channel; do found "$name" "$scenes/$name.glb"; done

if [ -z "${ONLY:-}" ]; then
  [ -n "$(find "$cache/rooms" -name '*.portal.glb')" ] ||
    "$bin/portals_bench" "$bin" --rooms "$rooms" --seed "$seed" --kinds "$kinds" --keep "$cache/rooms" >/dev/null 2>&1
  for portal in "$cache"/rooms/*.portal.glb; do
    room=${portal%.portal.glb}
    measure "${room##*/}+found" "$room.glb" "$portal"
  done
fi

{
  cat <<INTRO
# What \`auto\` loses, and how right its verdict is

Written by \`make regret\` ($("$bin/tdpt-render" --version | head -1)). 64 x 48 pixels, paths of any length. The true error of each integrator is the
relMSE of one sample, from eight pictures of $each CPU seconds in all; its efficiency is 1 over that and its CPU time for a
sample. \`auto\` chooses $seeds times at each length, each time from other samples; its efficiency is that of its choice, less
the time of the choice. Of these small pictures the choice takes more than of large ones, which need no more samples for it.

\`+found\`: with the portals that the four stages find; \`+drawn\`: drawn by hand (\`bench/drawn\`).

INTRO
  python3 "$here/bench/regret.py" "$cache"/*.txt
} >"$cache/page"
mv "$cache/page" "$doc/regret.md"
