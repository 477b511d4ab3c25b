#!/bin/sh
# only-needed.sh BIN [FOLDER]: what a scene or a command line does not ask for, costs how much? CPU seconds of
# rendering, runs taking turns, one thread: of tdpt-render over its twin that knows diffuse surfaces only
# (tdpt-render-diffuse), over itself with things asked for that others do without, and of stages that find nothing to
# do. Prints doc/only-needed.md. Half an hour. What was measured stays in FOLDER.
# The environment may set
#   SCENES        folder of the paper's scenes; without cornell-box.glb its rows are left out, with a word
#   RUNS          pairs of runs (15)
#   SPP           samples per pixel (16), WIDTH (160)
#   INSTRUCTIONS  1: count them as well, by valgrind, of a picture of 16 pixels' width: five minutes more
# shellcheck disable=SC2086  # unquoted variables are lists
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) out=${2:-build/only-needed}
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} small=$here/testdata/scenes
runs=${RUNS:-15} spp=${SPP:-16} width=${WIDTH:-160}
command -v jq >/dev/null || { echo "only-needed: jq is missing (cmake/packages-figures.txt)" >&2; exit 5; }
sh "$here/bench/python.sh" -c '' || { echo "only-needed: python3 with numpy is missing" >&2; exit 5; }
if [ "${INSTRUCTIONS:-0}" = 1 ] && ! command -v valgrind >/dev/null; then
  echo "only-needed: valgrind is missing (cmake/packages-figures.txt), which counts instructions" >&2
  exit 5
fi
[ -x "$bin/tdpt-render-diffuse" ] || {
  echo "only-needed: $bin/tdpt-render-diffuse is missing: cmake --build --preset release --target tdpt-render-diffuse" >&2
  exit 5
}
mkdir -p "$out"
out=$(cd "$out" && pwd)
: >"$out/runs.csv"
: >"$out/instructions.csv"
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() { program=$1; shift; "$bin/$program" --quiet "$@"; }

# cpu PROGRAM SCENE OPTION...: CPU seconds of rendering, of one thread; the picture is $out/PROGRAM.exr.
cpu() {
  program=$1 scene=$2
  shift 2
  if ! said=$("$bin/$program" --quiet --json --threads 1 --no-provenance --spp "$spp" --width "$width" "$scene" "$@" \
    -o "$out/$program.exr" 2>"$out/words"); then
    cat "$out/words" >&2
    return 1
  fi
  echo "$said" | jq .cpu_seconds
}
# counted SAMPLES PROGRAM SCENE OPTION...: instructions of a run.
counted() {
  samples=$1 program=$2 scene=$3
  shift 3
  valgrind --tool=callgrind --callgrind-out-file="$out/callgrind.$program" "$bin/$program" --quiet --threads 1 \
    --spp "$samples" --width 16 "$scene" "$@" -o "$out/counted.exr" 2>&1 | sed -n 's/.*Collected : //p'
}
# instructions PROGRAM SCENE OPTION...: of eight samples a pixel, without loading.
instructions() { echo $(($(counted 12 "$@") - $(counted 4 "$@"))); }
# pair WHAT SCENE "PROGRAM OPTIONS" "PROGRAM OPTIONS": both, in turns.
pair() {
  what=$1 scene=$2 first=$3 second=$4
  for run in $(seq "$runs"); do
    a=$(cpu ${first%% *} "$scene" ${first#* })
    b=$(cpu ${second%% *} "$scene" ${second#* })
    echo "$what;$(basename "$scene" .glb);$run;$a;$b" >>"$out/runs.csv"
  done
}
# twin SCENE OPTIONS: tdpt-render and its twin, which must make the same bytes.
twin() {
  pair "twin $2" "$1" "tdpt-render $2 $3" "tdpt-render-diffuse $2 $3"
  cmp "$out/tdpt-render.exr" "$out/tdpt-render-diffuse.exr"
  [ "${INSTRUCTIONS:-0}" = 1 ] || return 0
  echo "twin $2;$(basename "$1" .glb);1;$(instructions tdpt-render "$1" $2 $3);$(instructions tdpt-render-diffuse "$1" $2 $3)" \
    >>"$out/instructions.csv"
}

for scene in "$small/two-rooms.glb" "$scenes/cornell-box.glb" "$small/three-rooms.glb"; do
  if [ ! -r "$scene" ]; then
    echo "only-needed: $scene is not there, its rows are left out" >&2
    continue
  fi
  portal=$out/$(basename "$scene" .glb).portal.glb
  find_portals "$scene" "${portal%.portal.glb}"
  for integrator in nee bdpt tdpt-guided; do twin "$scene" "--integrator $integrator" "--portal $portal"; done
done

rooms=$small/two-rooms.glb bdpt="tdpt-render --integrator bdpt"
pair "tdpt-org without portals, over bdpt" "$rooms" "tdpt-render --integrator tdpt-org" "$bdpt"
pair "bdpt with a portal that it does not use, over bdpt" "$rooms" "$bdpt --portal $out/two-rooms.portal.glb" "$bdpt"
pair "--explain" "$rooms" "$bdpt --explain" "$bdpt"
pair "--layers" "$rooms" "$bdpt --layers" "$bdpt"
pair "--stats" "$rooms" "$bdpt --stats $out/stats.json" "$bdpt"
pair "--alpha" "$rooms" "$bdpt --alpha" "$bdpt"
pair "--environment 1e-30,0,0" "$rooms" "$bdpt --environment 1e-30,0,0" "$bdpt"

# nothing STATUS WHAT COMMAND...: CPU seconds of a program that has nothing to do and ends with STATUS.
nothing() { sh "$here/bench/python.sh" "$here/bench/only_needed.py" nothing "$out/nothing.csv" "$@"; }
: >"$out/nothing.csv"
sh "$here/bench/python.sh" "$here/bench/only_needed.py" scenes "$rooms" "$out"
nothing 3 "ffgraph, no light" "$bin/ffgraph" "$out/dark.glb" -o "$out/dark.max"
nothing 0 "ffgraph, the camera sees no surface" "$bin/ffgraph" "$out/away.glb" -o "$out/away.max"
nothing 0 "mincut, no flow" "$bin/mincut" "$out/away.max" -o "$out/away.cut"
nothing 0 "lightgrid, no bottleneck" "$bin/lightgrid" "$out/away.glb" "$out/away.cut" -o "$out/away.vdb"
nothing 0 "portalfit, empty grid" "$bin/portalfit" "$out/away.vdb" -o "$out/away.portal.glb"
nothing 0 "tdpt-render, 640 x 480 x 16, no light" "$bin/tdpt-render" "$out/dark.glb" -o "$out/x.exr"
nothing 0 "tdpt-render, 640 x 480 x 16, the camera sees no surface" "$bin/tdpt-render" "$out/away.glb" -o "$out/x.exr"

# What ffgraph's rounds of splitting brought.
for scene in "$small"/door-ajar.glb "$small"/half-metre-hole.glb "$small"/small-hole.glb "$small"/three-rooms.glb \
  "$small"/two-rooms.glb "$small"/window.glb "$scenes"/veach-ajar.glb "$scenes"/cornell-box-portal.glb; do
  [ -r "$scene" ] || continue
  "$bin/ffgraph" --quiet --explain "$scene" -o "$out/rounds.max" 2>"$out/words" || { cat "$out/words" >&2; exit 1; }
  sed -n "s/^ffgraph: round 1: \(.*\), because \(.*\) (\(.*\) CPU s)$/$(basename "$scene" .glb);\1;\2;\3/p" "$out/words"
done >"$out/rounds.csv"
sh "$here/bench/python.sh" "$here/bench/only_needed.py" page "$out" "$spp" "$width"
