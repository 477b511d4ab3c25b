#!/bin/sh
# cycles-compare.sh BIN FOLDER: do Cycles, Blender's path tracer, and tdpt-render agree in the mean?
# Renders the same diffuse scenes with both, several seeds each, and prints a table for each scene
# and depth; see doc/cycles.md. Exit code 1 if any mean differs significantly. Pictures stay in FOLDER.
# The environment may set SCENES (files), DEPTHS, SEEDS, SPP, WIDTH, HEIGHT, INTEGRATOR, BLENDER, and
# CYCLES_OPTIONS (for cycles-render.py), SKY and SKY_ROTATION (--environment and its rotation, for both).
set -eu
bin=${1:-build/bin} out=${2:-cycles}
here=$(cd "$(dirname "$0")/.." && pwd)
rooms=$here/testdata/scenes
scenes=${SCENES:-$rooms/two-rooms.glb $rooms/window.glb $rooms/door-ajar.glb}
depths=${DEPTHS:-2 3 6} seeds=${SEEDS:-16} spp=${SPP:-64}
width=${WIDTH:-160} height=${HEIGHT:-120} integrator=${INTEGRATOR:-nee}
set --
[ -z "${SKY:-}" ] || set -- --environment "$SKY" --environment-rotation "${SKY_ROTATION:-0}"
mkdir -p "$out"

# Blender says much on stdout; it is kept in a file and shown when something goes wrong.
blender_run() {
  script=$1
  shift
  "${BLENDER:-blender}" -b --factory-startup --python-exit-code 1 --python "$here/bench/$script" -- "$@"
}

failed=0
for scene in $scenes; do
  for depth in $depths; do
    name=$(basename "$scene")
    work=$out/${name%.*}-$depth
    mkdir -p "$work"
    # shellcheck disable=SC2086  # several options
    blender_run cycles-render.py "$scene" "$work/cycles-%d.exr" --seeds "$seeds" --spp "$spp" \
      --max-depth "$depth" --width "$width" --height "$height" "$@" ${CYCLES_OPTIONS:-} \
      >"$work/blender.log" 2>&1 || { cat "$work/blender.log" >&2; exit 1; }
    seed=1
    while [ "$seed" -le "$seeds" ]; do
      "$bin/tdpt-render" "$scene" --integrator "$integrator" --seed "$seed" --spp "$spp" \
        --max-depth "$depth" --width "$width" --height "$height" "$@" --quiet -o "$work/ours-$seed.exr"
      seed=$((seed + 1))
    done
    printf '\n%s, depth %s, %s seeds of %s spp\n' "$name" "$depth" "$seeds" "$spp"
    blender_run cycles-table.py "$work/cycles-%d.exr" "$work/ours-%d.exr" --seeds "$seeds" \
      --names "Cycles,$integrator" --averages "$work" >"$work/table.log" 2>&1 || failed=1
    grep -E '^( {10}|[RGB] |luminance|blocks)' "$work/table.log" || { cat "$work/table.log" >&2; exit 1; }
  done
done
exit $failed
