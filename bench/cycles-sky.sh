#!/bin/sh
# cycles-sky.sh [BIN [FOLDER]]: do Cycles and tdpt-render agree where an environment lights a room? Three rooms
# (sky_rooms.py) under one colour, under a map whose directions all differ, turned by 30 degrees, and under a clear sky
# with its sun in one texel. Prints the tables of cycles-compare.sh, which takes the same variables (INTEGRATOR, SEEDS,
# SPP, ...), and exits with 1 if any mean differs significantly. SKIES chooses some of: colour quarters sun. Pictures
# stay in FOLDER.
set -eu
bin=${1:-build/bin} out=${2:-cycles-sky}
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$out/rooms"
sh "$here/python.sh" "$here/sky_rooms.py" "$out/rooms"
failed=0
# compare NAME SKY ROTATION
compare() {
  printf '\n## %s\n' "$1"
  SCENES=${SCENES:-"$out/rooms/skylight.gltf $out/rooms/windows.gltf $out/rooms/behind.gltf"} DEPTHS=${DEPTHS:-6} \
    SPP=${SPP:-32} SKY=$2 SKY_ROTATION=$3 sh "$here/cycles-compare.sh" "$bin" "$out/$1" || failed=1
}
for sky in ${SKIES:-colour quarters sun}; do
  case $sky in
  colour) compare colour 1,0.8,0.5 0 ;;
  quarters) compare quarters "$out/rooms/quarters.exr" 30 ;;
  sun) compare sun "$here/../testdata/environments/clear-sun.exr" -45 ;;
  *) echo "cycles-sky.sh: SKIES: $sky is none of colour, quarters, sun" >&2; exit 2 ;;
  esac
done
exit $failed
