#!/bin/sh
# demo.sh BIN FOLDER: a portal for a room lit through a hole, and what it is good for. Finds the
# portal, renders with bdpt and through the portal in the same time, compares both with a reference,
# and leaves everything in FOLDER.
# The environment may set SCENE, SECONDS_EACH, SECONDS_REFERENCE, WIDTH, HEIGHT, DEPTH. DEPTH: edges of the longest
# path; default none, no limit, as whoever calls tdpt-render has it: the whole light costs little more, and
# testdata/references has a reference of it.
set -eu
bin=${1:-build/bin} out=${2:-demo}
here=$(cd "$(dirname "$0")/.." && pwd)
scene=${SCENE:-$here/testdata/scenes/two-rooms.glb}
seconds=${SECONDS_EACH:-20} reference_seconds=${SECONDS_REFERENCE:-90}
width=${WIDTH:-160} height=${HEIGHT:-120} depth=${DEPTH:-none}
bin=$(cd "$bin" && pwd)
case $scene in /*) ;; *) scene=$PWD/$scene ;; esac
mkdir -p "$out"
cd "$out"

say() { printf '%s\n' "$*"; }
# Shows a command as one would type it, then runs it.
run() {
  say "  \$ $*" | sed "s|$here/||g; s|$scene|$(basename "$scene")|g"
  tool=$1
  shift
  "$bin/$tool" "$@"
}

say "This ends on $out/before-after.png: the room without and with the portal, side by side, after $seconds seconds each."
say ""
say "Finding the portal"
run ffgraph "$scene" -o room.max --quiet
run mincut room.max -o room.cut --quiet
run lightgrid "$scene" room.cut -o room.vdb --quiet
run portalfit room.vdb -o room.portal.glb

say ""
say "Rendering for $seconds seconds each, without the portal and with it"
size="--width $width --height $height" kept=$here/testdata/references/$(basename "$scene" .glb)
case $depth in
  none) kept=$kept.exr ;;
  *) size="$size --max-depth $depth" kept=$kept-depth$depth.exr ;;
esac
# shellcheck disable=SC2086  # several options
run tdpt-render "$scene" --integrator bdpt --time "$seconds" $size -o bdpt.exr --preview \
  --stats bdpt.stats
# shellcheck disable=SC2086  # several options
run tdpt-render "$scene" --portal room.portal.glb --time "$seconds" $size -o portal.exr --preview \
  --stats portal.stats

say ""
# The shipped reference will do if it shows the very scene (its hash stands in the header) in the
# same size and depth; otherwise one is rendered, and kept for the next time.
origin() { head -c 16384 "$1" 2>/dev/null | grep -ao "from $(basename "$scene") [0-9a-f]*" | head -n 1; }
key="$(cat "$bin/tdpt-render" "$scene" room.portal.glb | cksum) $reference_seconds $size"
if [ -n "$(origin portal.exr)" ] && [ "$(origin portal.exr)" = "$(origin "$kept")" ] &&
  "$bin/exrdiff" portal.exr "$kept" >/dev/null 2>&1; then
  say "Comparing with the reference in testdata/references"
  cp "$kept" reference.exr
  rm -f reference.key
  note=
elif [ -s reference.exr ] && [ "$(cat reference.key 2>/dev/null)" = "$key" ]; then
  say "Comparing with the reference from last time"
  note=short
else
  say "Rendering a reference for $reference_seconds seconds, with another seed"
  rm -f reference.key
  # shellcheck disable=SC2086  # several options
  run tdpt-render "$scene" --portal room.portal.glb --integrator tdpt-guided \
    --time "$reference_seconds" --seed 2 $size -o reference.exr
  printf '%s\n' "$key" >reference.key
  note=short
fi
"$bin/exrdiff" bdpt.exr reference.exr --json -o bdpt-error.png >bdpt.json
"$bin/exrdiff" portal.exr reference.exr --json -o portal-error.png >portal.json
"$bin/exrdiff" bdpt.exr portal.exr --side-by-side before-after.png >/dev/null

# measure FILE NAME: of the picture; black FILE NAME: of the black picture.
measure() { sed 's/"black".*//' "$1" | tr ',{}' '\n\n\n' | sed -n "s/^\"$2\"://p"; }
black() { sed 's/.*"black"//' "$1" | tr ',{}' '\n\n\n' | sed -n "s/^\"$2\"://p"; }
row() {
  awk -v name="$1" -v relmse="$2" -v psnr="$3" -v mape="$4" -v mean="$5" 'BEGIN {
    printf "  %-14s %12.4g %12.2f %12.1f %12.4g\n", name, relmse, psnr, mape, mean }'
}
row_of() {
  row "$1" "$(measure "$2" relmse)" "$(measure "$2" psnr)" "$(measure "$2" mape)" \
    "$(measure "$2" mean)"
}

say ""
printf '  %-14s %12s %12s %12s %12s\n' "" relMSE "PSNR [dB]" "MAPE [%]" mean
row_of "bdpt, $seconds s" bdpt.json
row_of "portal, $seconds s" portal.json
row "all black" "$(black portal.json relmse)" "$(black portal.json psnr)" \
  "$(black portal.json mape)" 0
printf '  %-14s %12s %12s %12s %12.4g\n' reference "" "" "" \
  "$(measure portal.json reference_mean)"
say ""
awk -v before="$(measure bdpt.json relmse)" -v after="$(measure portal.json relmse)" \
  -v psnr_before="$(measure bdpt.json psnr)" -v psnr_after="$(measure portal.json psnr)" \
  -v black="$(black portal.json relmse)" -v seconds="$seconds" -v note="$note" '
BEGIN {
  gain = before / after
  db = psnr_after - psnr_before
  if (gain >= 1) {
    printf "In the same %g seconds the portal makes the error %.1f times smaller (relMSE), and the\n", seconds, gain
    printf "picture %.1f dB %s (PSNR). ", (db < 0 ? -db : db), (db < 0 ? "worse" : "better")
    printf "Since the error falls with time, bdpt alone would need\nabout %.0f seconds for the same.\n", seconds * gain
    if (note != "")
      printf "The reference has noise of its own, which counts against both: the true gain is larger.\n"
  } else {
    printf "In the same %g seconds the error is %.1f times larger with the portal (relMSE), PSNR differs\n", seconds, 1 / gain
    printf "by %+.1f dB: this scene is better rendered without.\n", db
  }
  if (before > 0.5 * black) printf "A picture of no light at all scores %.3g: bdpt has found little here.\n", black
}'
awk -v before="$(measure bdpt.stats cpu_seconds)" -v after="$(measure portal.stats cpu_seconds)" '
BEGIN {
  if (before > 1.1 * after || after > 1.1 * before)
    printf "But the machine was busy: bdpt got %.0f CPU seconds and the portal %.0f; try again when it is idle.\n", before, after
}'
say "Pictures: $out/before-after.png (bdpt left, through the portal right), $out/bdpt-error.png and"
say "$out/portal-error.png (red too bright, blue too dark), $out/*.exr."
