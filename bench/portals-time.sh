#!/bin/sh
# portals-time.sh BIN: how long finding the portals takes, and how much memory, on veach-ajar and on
# the same scene with each of its triangles split in four, beside a rendering of one sample per pixel at depth 6.
# Prints a table of medians and one of ratios. Runs take turns, so that a busy machine slows all down.
# The environment may set
#   SCENES   folder of the paper's scenes; without veach-ajar.glb a small scene of our own is taken
#   RUNS     of each program, 3
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd)
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} runs=${RUNS:-3}
sh "$here/bench/python.sh" -c '' || exit 5
command -v jq >/dev/null || { echo "portals-time: jq is missing" >&2; exit 5; }
name=veach-ajar scene=$scenes/veach-ajar.glb
if [ ! -r "$scene" ]; then
  echo "portals-time: $scene is not there, door-ajar.glb of testdata takes its place" >&2
  name=door-ajar scene=$here/testdata/scenes/door-ajar.glb
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$bin/split_scene" "$scene" "$work/split.glb"

# measured SCENE STAGE COMMAND...: runs it; adds a line of scene, stage, wall, CPU, CPU of loading the
# scene and of its BVH, peak MiB. The last two come from the summary, where there is one.
measured() {
  of=$1 stage=$2
  shift 2
  times >"$work/before"  # not in a pipe: a subshell has children of its own
  began=$(date +%s%N)
  "$@" >"$work/json"
  ended=$(date +%s%N)
  times >"$work/after"
  cpu=$(awk 'FNR == 2 { s = -s; for (i = 1; i <= 2; i++) { split($i, t, /[ms]/); s += 60 * t[1] + t[2] } }
             END { print s }' "$work/before" "$work/after")
  aside=0
  case $stage in
    ffgraph | lightgrid)
      aside=$(jq '[.phases.load, .phases.bvh] | map(select(.) | .cpu_seconds) | add // 0' "$work/json")
      ;;
  esac
  peak=$(jq -rs '((.[0] // {}).peak_bytes // 0) / 1048576 | round' "$work/json")
  echo "$of $stage $(awk "BEGIN { print ($ended - $began) / 1e9 }") $cpu $aside $peak" >>"$work/runs"
}

# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() {
  program=$1
  shift
  measured "$of" "$program" "$bin/$program" --quiet --json "$@"
}

run=0
while [ $run -lt "$runs" ]; do
  run=$((run + 1))
  measured "$name" bdpt "$bin/tdpt-render" --quiet --integrator bdpt --spp 1 --max-depth 6 \
    --width 1280 --height 720 "$scene" -o "$work/a.exr"
  of=$name && find_portals "$scene" "$work/a"
  of=$name/4 && find_portals "$work/split.glb" "$work/a"
done

sh "$here/bench/python.sh" "$here/bench/portals_time.py" "$name" "$work/runs"
