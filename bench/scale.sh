#!/bin/sh
# scale.sh BIN [WORK]: CPU time and peak memory of the five programs on scenes of a thousand to ten million triangles,
# one thread each: doc/scale.{csv,md,png}. A quarter of an hour, 5 GiB of memory, 1.5 GiB of disk in WORK.
# The environment may set
#   SIZES   triangles of the scenes (1e3 1e4 1e5 1e6 1e7)
#   FORMS   of bench/many_triangles.py (grid parts soup)
#   DOC     where the results go; default doc
#   KEEP    not empty: the rows that are in WORK make the page anew, nothing runs
set -eu
export LC_ALL=C
bin=${1:-build/bin} work=${2:-build/scale}
here=$(cd "$(dirname "$0")/.." && pwd)
sizes=${SIZES:-1e3 1e4 1e5 1e6 1e7} forms=${FORMS:-grid parts soup} doc=${DOC:-$here/doc}
command -v gnuplot >/dev/null || { echo "scale: gnuplot is missing" >&2; exit 5; }
python() { sh "$here/bench/python.sh" "$@"; }
python -c '' || { echo "scale: python3 with numpy is missing" >&2; exit 5; }
mkdir -p "$work" "$doc"
bin=$(cd "$bin" && pwd) doc=$(cd "$doc" && pwd)
cd "$work"
trap 'rm -f room.glb room.max room.cut room.vdb room.portal.glb room.exr' EXIT

# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() {
  program=$1
  shift
  python "$here/bench/scale.py" run scale.csv "$form" "$triangles" "$program" "$bin/$program" --quiet --threads 1 "$@"
}
[ -n "${KEEP:-}" ] || rm -f scale.csv
for form in ${KEEP:+none} $forms; do
  [ -z "${KEEP:-}" ] || break
  for size in $sizes; do
    triangles=$(python "$here/bench/many_triangles.py" "$size" "$form" room.glb)
    find_portals room.glb room
    stage tdpt-render room.glb --portal room.portal.glb --integrator tdpt-guided --spp 1 --width 64 --height 48 \
      -o room.exr
    echo "$form: $triangles triangles"
  done
done

style_of() {
  case $1 in
    ffgraph) printf 'pt 7 lc rgb "#000000"' ;;
    mincut) printf 'pt 5 lc rgb "#8c8c8c"' ;;
    lightgrid) printf 'pt 9 lc rgb "#0072b2"' ;;
    portalfit) printf 'pt 11 lc rgb "#56b4e9"' ;;
    *) printf 'pt 13 lc rgb "#d55e00"' ;;
  esac
  case $2 in grid) printf ' dt 1' ;; parts) printf ' dt 3' ;; *) printf ' dt 2' ;; esac
}
# panel FIELD TITLE LABEL LEAST LINE: a panel of the plot.
panel() {
  printf 'set title "%s"\nset ylabel "%s"\nplot [500:2e7] [%s:] %s' "$2" "$3" "$4" "$5"
  for form in $forms; do
    for program in ffgraph mincut lightgrid portalfit tdpt-render; do
      python "$here/bench/scale.py" points scale.csv "$form" "$program" >"$form-$program.points"
      printf ', "%s" using 1:%s with linespoints lw 2 %s' "$form-$program.points" "$1" "$(style_of "$program" "$form")"
    done
  done
  printf '\n'
}
{
  cat <<'PLOT'
set terminal pngcairo size 1400,520 font "sans-serif,12" background "white"
set output "scale.png"
set multiplot layout 1,3
set logscale xy
set format x "10^{%T}"
set xlabel "triangles"
set grid lc rgb "#dddddd" lt 1 lw 0.5
set key off
PLOT
  panel 2 "Time" "CPU seconds" 0.02 '1.5e-7*x*log(x) with lines dt 4 lc rgb "#666666"'
  panel 3 "Memory" "peak MiB" 8 '400*x/1048576 with lines dt 4 lc rgb "#666666"'
  # The last cell holds the key alone.
  printf '%s\n' 'unset title' 'unset xlabel' 'unset ylabel' 'unset tics' 'unset border' 'unset grid' \
    'set key left center samplen 3 Left reverse'
  printf 'plot [1:2] [1:2] NaN with lines dt 4 lc rgb "#666666" title "n log n; 400 bytes a triangle"'
  for form in $forms; do
    for program in ffgraph mincut lightgrid portalfit tdpt-render; do
      printf ', NaN with linespoints lw 2 %s title "%s, %s"' "$(style_of "$program" "$form")" "$program" "$form"
    done
  done
  echo
} >plot.gnuplot
gnuplot plot.gnuplot
{
  cat <<PAGE
# Time and memory against triangles

Written by \`make scale\` ($("$bin/tdpt-render" --version | head -1); \`bench/scale.sh\`), one thread. [scale.csv](scale.csv) has a row a run.

The scene is two furnished rooms with one opening, the same surfaces cut into more and more triangles
(\`bench/many_triangles.py\`): **grid**, large meshes whose triangles share corners (25 bytes of file a triangle); **parts**, a mesh
and a node for every 512 triangles at most; **soup**, no corner shared (72 bytes of file a triangle). tdpt-render makes one sample
per pixel at 64 x 48 with tdpt-guided, so its time is that of loading and of its hierarchy.

![CPU seconds and memory against triangles](scale.png)

PAGE
  python "$here/bench/scale.py" page scale.csv
  cat <<'PAGE'
What does not depend on triangles: ffgraph's 1.2 million hits of walks and its pairs of patches, the network that mincut cuts, the
voxels and lines of lightgrid. Up to 10^5 triangles that is most of the memory; it grows with the surfaces that are found to
be pieces. portalfit reads no triangle: it takes 0.4 s, or 4 s where the first plane through the lines is not good enough,
and which of the two is chance.

Where a triangle's memory is (soup, tdpt-render): 52 bytes are its corners and material, 36 more normals where they are
interpolated, 104 its plane and edges in double precision, the rest Embree's hierarchy, which has corners of its own.
Embree's compact hierarchy would save 50 to 60 bytes; rays through a soup of 10^6 triangles then take 1.55 times as long, through a
grid 1.1 times, and the pictures are the same bytes, so it is not used. `bench.memory` holds the programs below the limit.

What corners have beside a place and a normal comes on top where a material uses it: 8 bytes for texture coordinates, 16 for a
tangent or a colour. A scene that has surfaces with alpha or window panes costs 16 bytes a triangle more.
PAGE
} >scale.md
cp scale.csv scale.md scale.png "$doc/"
echo "scale: $doc/scale.md"
