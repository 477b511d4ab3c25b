#!/bin/sh
# whole-light.sh BIN [CACHE]: what the whole light costs beside the light of paths of 6 edges, same samples: CPU
# time, error, efficiency 1 / (relMSE x CPU s) and mean, with bdpt and with auto and the portals that the four stages
# find: doc/whole-light.md. Half an hour on two quiet cores. Runs take turns, one thread each, so that a busy
# machine slows all down. References and portals stay in CACHE under keys that hold programs, scene and options.
# The environment may set
#   SCENES         folder of the paper's scenes (../shared/scenes); one that is not there is left out, with a word
#   ONLY           names of the scenes to measure; default all
#   BASE           another tdpt-render, of an older commit: depth 6 is compared with its depth 6
#   SPP, SEEDS     samples per pixel (64), and pictures of each kind (6)
#   REF_INTEGRATOR of the references (tdpt-guided); REF_SECONDS of each half of one, all threads (60)
#   WIDTH, HEIGHT  of all pictures, for trials; else each scene has its own
#   DOC            where whole-light.md goes (doc)
#
# No limit and depth 6 have a reference each, of two halves A, B. A picture x is off by
# (d(x,A) + d(x,B) - d(A,B)) / 2, d = relMSE, to which the noise of neither half contributes on average.
# shellcheck disable=SC2086  # unquoted variables are lists
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) cache=${2:-build/whole-light}
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} doc=${DOC:-$here/doc} base=${BASE:-}
spp=${SPP:-64} seeds=${SEEDS:-6} reference_integrator=${REF_INTEGRATOR:-tdpt-guided} reference_seconds=${REF_SECONDS:-60}
list='
veach-ajar 160 90
bathroom2 128 72
two-rooms 128 96
'
say() { printf '%s\n' "$*"; }
command -v jq >/dev/null || { say "whole-light: jq is missing" >&2; exit 5; }
sh "$here/bench/python.sh" -c '' || { say "whole-light: python3 with numpy is missing" >&2; exit 5; }
[ -z "$base" ] || [ -x "$base" ] || { say "whole-light: BASE: $base is no program" >&2; exit 2; }
mkdir -p "$cache" "$doc"
: >"$cache/runs"

# made FILE KEY: FILE is there and was made with KEY. After making it: keep FILE KEY.
made() { [ -s "$1" ] && [ "$(cat "$1.key" 2>/dev/null)" = "$2" ]; }
keep() { printf '%s\n' "$2" >"$1.key"; }
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() { program=$1; shift; "$bin/$program" --quiet "$@"; }
portal_programs=$(cd "$bin" && cat ffgraph mincut lightgrid portalfit | cksum)
renderer=$(cksum <"$bin/tdpt-render")

# reference SCENE DEPTH: two halves, $stem-DEPTH-1.exr and -2.exr, and their distance, $stem-DEPTH.distance.
reference() {
  options="--integrator $reference_integrator $(depth_option "$2") $size --time $reference_seconds"
  for half in 1 2; do
    picture=$stem-$2-$half.exr key="$renderer $(cat "$1" "$portal" | cksum) $options"
    made "$picture" "$key" && continue
    say "$name: reference, half $half: $options" >&2
    "$bin/tdpt-render" --quiet "$1" --portal "$portal" $options --seed $((1000000 + half)) -o "$picture"
    keep "$picture" "$key"
  done
  { distance "$stem-$2-1.exr" "$stem-$2-2.exr"; distance "$stem-$2-2.exr" "$stem-$2-1.exr"; } |
    jq -s 'map(.relmse) | add / 2' >"$stem-$2.distance"
}
depth_option() { [ "$1" = none ] || say "--max-depth $1"; }
distance() { "$bin/exrdiff" --quiet --json "$1" "$2"; }

# run SCENE INTEGRATOR KIND SEED: a line of runs: scene, integrator, kind, seed, CPU s, relMSE, mean.
run() {
  program=$bin/tdpt-render depth=6
  case $3 in none) depth=none ;; base) program=$base ;; esac
  options="--integrator $2 $(depth_option $depth) $size --spp $spp --seed $4 --threads 1"
  case $2 in bdpt) ;; *) options="$options --portal $portal" ;; esac
  "$program" --quiet --json "$1" $options -o "$cache/picture.exr" >"$cache/picture.json"
  { cat "$cache/picture.json"; for half in 1 2; do distance "$cache/picture.exr" "$stem-$depth-$half.exr"; done
    cat "$stem-$depth.distance"; } |
    jq -rs --arg of "$name $2 $3 $4" '. as [$stats, $a, $b, $d] |
      "\($of) \($stats.cpu_seconds) \(($a.relmse + $b.relmse - $d) / 2) \($a.mean)"' >>"$cache/runs"
}

for name in $(say "$list" | cut -d ' ' -f 1); do
  case " ${ONLY:-$name} " in *" $name "*) ;; *) continue ;; esac
  file=$here/testdata/scenes/$name.glb stem=$cache/$name portal=$cache/$name.portal.glb
  [ -s "$file" ] || file=$scenes/$name.glb
  [ -s "$file" ] || { say "$name: there is no $name.glb in SCENES, left out" >&2; continue; }
  key="$portal_programs $(cksum <"$file")"
  made "$portal" "$key" || { find_portals "$file" "$stem"; keep "$portal" "$key"; }
  size="--width ${WIDTH:-$(say "$list" | awk -v s="$name" '$1 == s { print $2 }')}"
  size="$size --height ${HEIGHT:-$(say "$list" | awk -v s="$name" '$1 == s { print $3 }')}"
  reference "$file" none
  reference "$file" 6
  order="none six${base:+ base}"
  for seed in $(seq "$seeds"); do
    for integrator in bdpt auto; do
      for kind in $order; do run "$file" "$integrator" "$kind" "$seed"; done
    done
    order=$(set -- $order; first=$1; shift; say "$* $first")  # another one goes first
  done
done
[ -s "$cache/runs" ] || { say "whole-light: none of the scenes is there" >&2; exit 3; }

{
  cat <<INTRO
# What the whole light costs

Written by \`make whole-light\` ($("$bin/tdpt-render" --version | head -1)). Without a limit walks end by Russian roulette; with
\`--max-depth 6\` they end after 6 edges at the latest, and the light of longer paths is missing. $spp samples per pixel
both ways, $seeds seeds, runs of one thread taking turns; auto gets the portals that the four stages find. Each way has a reference of its own, whose noise is taken out of relMSE. Efficiency = 1 / (relMSE x CPU s).

* CPU time: median of the ratios of runs that followed each other; at depth 6 with the samples that tell what is left
  out, 1 % of all, up to a tenth of few. Efficiency: of the means over seeds, in brackets the 95 %
  interval by bootstrap. Mean: +- a standard error; what it lacks to 1 is the light that depth 6 leaves out.

INTRO
  sh "$here/bench/python.sh" "$here/bench/whole_light.py" "$cache/runs"
} >"$cache/page"
mv "$cache/page" "$doc/whole-light.md"
say "whole-light: $doc/whole-light.md"
