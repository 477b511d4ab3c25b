#!/bin/sh
# portal-worth.sh BIN FOLDER: measures what portals are worth in generated rooms and writes
# FOLDER/portal-worth.md with the table, and FOLDER/portal-worth.png, expected against measured gain.
# The environment may set
#   ROOMS, SEED  of each kind, and the first one's seed (2, 1)
#   SPP          samples per pixel of what is judged (128)
#   JOBS         rooms at a time (all cores)
#   KEEP         folder for scenes and pictures; those there already are not made again
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) out=${2:-doc}
command -v gnuplot >/dev/null || { echo "portal-worth: gnuplot is missing" >&2; exit 5; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
jobs=${JOBS:-$(nproc 2>/dev/null || echo 1)}
"$bin/worth_bench" "$bin" --rooms "${ROOMS:-2}" --seed "${SEED:-1}" --spp "${SPP:-128}" --jobs "$jobs" \
  --keep "${KEEP:-$work/rooms}" --data "$work/data" >"$work/table"

gnuplot <<END
set terminal pngcairo size 640,560
set output "$work/plot.png"
set logscale xy
set xrange [0.5:40]
set yrange [0.5:40]
set xlabel "expected by portalfit"
set ylabel "measured, tdpt-org / bdpt"
set key bottom right
set size square
plot x with lines lc rgb "black" title "as expected", \
  2*x with lines dt 2 lc rgb "gray50" title "a factor of two off", \
  x/2 with lines dt 2 lc rgb "gray50" notitle, \
  "$work/data" using 5:(\$5 > 0 ? \$3 : NaN) with points pt 7 lc rgb "#c03020" title "rooms"
END

cat >"$work/page" <<END
# What portals are worth

Written by \`bench/portal-worth.sh build/bin doc\` with ROOMS=${ROOMS:-2} SEED=${SEED:-1} SPP=${SPP:-128}.
Generated rooms (\`libcommon/testing/known_rooms.h\`), 48 x 36 pixels, depth 6. The gain is the ratio of
efficiencies 1 / (relMSE x CPU time), measured with *perfect* portals, the known openings themselves,
against a reference of tdpt-org with six times the samples, whose own error is taken out. *expected* is what
portalfit expects of the portals it finds itself, without rendering; the best of each room.

$(cat "$work/table")

![expected against measured](portal-worth.png)

## The law

    gain = 0.7 / (1 - S + S / (1 + (0.026 t / c)^0.6))

S: share of its cut's light that the portals cover (of the lines over 0.85, at most 1: the rest may be leaks). t: tightness, share of a portal's lines that pass.
c: conductance of the cut less its leaks, the share of the smaller side's light that crosses; in a closed room this is
the opening's area to that of the room's surface.

Why: bidirectional path tracing finds the way through an opening by luck, with a density that falls with c; a
portal's segment lies in it always. The balance heuristic adds densities, so the variance of the light that portals cover
falls by 1 + (density of segments) / (density of the rest). 0.7 is no fit: it is the time of a sample of bdpt to one of
tdpt-org (0.70 over all rooms), and what is left where a portal brings nothing. 0.026 and 0.6 were fitted to 22 rooms
of seeds 1 and 2 with perfect portals and conductances. An exponent of 1, every path through the opening in one stroke, fits about as well (scatter a factor of 1.85 instead
of 1.83), but calls no wide window useless.

How good: the scatter above; in 13 rooms of seven kinds and seeds 3 and 4, to which nothing was fitted, 11 were within
a factor of two. Most of it is the way the lamps shine, which a light grid does not know: where
a lamp shines straight through ("at", "several") bidirectional tracing connects with it and a portal gains less; where it
faces away, more. The largest misses are slits in thick walls, whose tightness
the grid's lines tell badly. A lone relMSE of bdpt
through a tiny hole is itself uncertain, as few of its samples pass.

So portalfit and tdpt-render say *useful* from 1.5, *little gain* from 1.1, *useless* below, with the reason: the
portal carries little of the light; few of the lines through it pass; or the way is wide (c of 0.08 or more).
Whether a portal lies on the light's way at all is known after rendering: tdpt-render calls one useless whose
samples brought less than 0.1 % of the light, or less than 1 % while under 10 % of them joined a lamp with the camera.

\`tdpt\`, which drops the bi-connections, is worth less than \`tdpt-org\` in most rooms, and often less than \`bdpt\` where
openings are as wide as doors; hence the default.
END
mv "$work/page" "$out/portal-worth.md"
mv "$work/plot.png" "$out/portal-worth.png"
