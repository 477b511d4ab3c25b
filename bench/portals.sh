#!/bin/sh
# portals.sh BIN CACHE: how right the portals are, on generated rooms whose openings are known, and what
# that costs: prints doc/portals.md. An hour on two quiet cores.
# The environment may set
#   ROOMS    rooms of each kind (20)
#   SEED     of the first; if not set, the first seven digits of the commit's hash, so that nobody chooses it
#   SCENES   folder of the paper's scenes, for the timing (bench/portals-time.sh)
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) cache=${2:-build/portals}
here=$(cd "$(dirname "$0")/.." && pwd)
rooms=${ROOMS:-20}
if [ -n "${SEED:-}" ]; then
  seed=$SEED whence=
else
  commit=$(git -C "$here" rev-parse HEAD | cut -c1-7)
  seed=$(printf '%d' "0x$commit") whence=", the first digits of the commit that was measured, $commit"
fi
few=$(((rooms + 6) / 7))  # rooms of each kind in the other tables
mkdir -p "$cache"
known=hole,slit,floor-door,through-floor,ajar-full,ajar,window,two-openings,holes-in-row,doors-in-row,closet
skies=sky-window,sky-windows,corner-windows,skylight,sky-blinds,colonnade,room-behind,deep-facade,landscape,deep-room

# table NAME ARGUMENT...: of portals_bench; its rows room by room stay in CACHE.
table() {
  name=$1
  shift
  "$bin/portals_bench" "$bin" --seed "$seed" "$@" 2>"$cache/$name.rooms" >"$cache/$name.md"
  cat "$cache/$name.md"
}
# summary NAME LABEL ARGUMENT...: one row over all kinds.
summary() {
  name=$1 label=$2
  shift 2
  table "$name" "$@" >"$cache/all.md"
  sed -n "s/^| all kinds together |/| $label |/p" "$cache/all.md"
}
head='| rooms | all four | coverage >= 0.98 | tightness >= 0.90 | angle <= 3 | right number | strays | median coverage | median tightness | median angle | CPU s |
|---|---|---|---|---|---|---|---|---|---|---|---|'

cat <<INTRO
# How right the portals are

Written by \`make portals\` ($("$bin/portalfit" --version | head -1), $(nproc 2>/dev/null || echo ?) cores). Rooms are generated from
seeds (\`libcommon/testing/rooms/known_rooms.h\`): sizes, lamps, furniture, walls of 1 to 30 cm, four ways of splitting the
triangles, and in every second room another place, direction or unit. Their openings are known. The first seed of
each kind is $seed$whence.

* **coverage**: share of the lines through an opening that cross the portals along their normal; of the worst opening.
* **tightness**: share of a portal's lines that pass an opening, relative to a perfect portal in the middle of the
  wall; of the worst portal.
* **angle**: degrees between the normals; of the worst portal.
* **strays**: portals that hardly any light passes (tightness below 0.3).

A window that bars split may have one portal or one for each pane, a door with a window above it likewise. What stands
in an opening (bars, slats, furniture) stops lines that no portal has to cover. Behind curtains, and beside a leaf, a
portal may lie in either of the two places that the light passes.

## By kind of room

INTRO
table kinds --rooms "$rooms"
cat <<SKIES

A wide window, the mouth of a lampshade, sconce, cupboard or alcove with the lamp in it, and a window with the lamp right
behind it may be found or not; \`open-room\` has nothing to be found. \`ajar-full\` is a leaf from floor to ceiling, with
one slit beside it; \`ajar\` is lower than the ceiling, and beside the slit it has a gap over the leaf, a triangle a few
centimetres wide that shares an edge with the slit and gets about a tenth of the light. A keyhole of 1 cm is found when a
step of the walks passes it, which in walls much thicker than that none does: then nothing is right only where portalfit
says that light may pass where no walk passed. More \`--walks\` find more of them.

## Rooms lit by the sky

A sky, the sun or both shine in through windows, and there is no lamp; in a \`landscape\` there is nothing to find. Fewer of
each kind.

SKIES
table skies --rooms "$few" --kinds $skies
cat <<PAPER

## The paper's rules

Rooms of the first eleven kinds, fewer of them. The paper's nodes are triangles with form factors (\`ffgraph --nodes triangles\`), its
normal is the main axis of the fullest voxels (\`portalfit --method paper\`).

| method $head
PAPER
summary ours "ours" --rooms "$few" --kinds $known
summary paper-graph "triangles, our fit" --rooms "$few" --kinds $known --ffgraph "--nodes triangles"
summary paper-fit "patches, the paper's fit" --rooms "$few" --kinds $known --portalfit "--method paper"
summary paper "triangles, the paper's fit" --rooms "$few" --kinds $known --ffgraph "--nodes triangles" \
  --portalfit "--method paper"
cat <<TRADE

## Speed against accuracy

The knobs: walks and rays of ffgraph, lines of lightgrid.

| setting $head
TRADE
summary trade-16 "a sixteenth of all" --rooms "$few" --kinds $known \
  --ffgraph "--walks 6250 --samples 18750" --lightgrid "--lines 512"
summary trade-4 "a quarter of all" --rooms "$few" --kinds $known \
  --ffgraph "--walks 25000 --samples 75000" --lightgrid "--lines 2048"
summary trade-walks "a quarter of the walks and rays" --rooms "$few" --kinds $known \
  --ffgraph "--walks 25000 --samples 75000"
summary trade-lines "a quarter of the lines" --rooms "$few" --kinds $known --lightgrid "--lines 2048"
summary trade-times-4 "four times all" --rooms "$few" --kinds $known \
  --ffgraph "--walks 400000 --samples 1200000" --lightgrid "--lines 32768"
cat <<MOVES

## Invariance

Rooms written in another way, and how far their portals lie from those of the room as it was: the largest distance of any
corner from the other portal, in voxels of the light grid. Another seed shows what chance alone does.

MOVES
"$bin/invariance_bench" "$bin" "$few" 2>"$cache/invariance.rooms"
cat <<TIME

## Time and memory

Medians of interleaved runs, all threads; the rendering is \`tdpt-render --integrator bdpt --spp 1 --max-depth 6
--width 1280 --height 720\`.

TIME
sh "$here/bench/portals-time.sh" "$bin"
