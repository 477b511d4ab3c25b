#!/bin/sh
# tradeoff.sh BIN CACHE: every knob that trades speed for accuracy, as curves: doc/tradeoff.md, its plots and tables. A
# night on two cores; stopped, it goes on where it was, since what ran stays in CACHE by content.
# The environment may set
#   QUICK   1: fewer scenes, seeds, values and rooms: three quarters of an hour on two quiet cores
#   SEEDS   of each setting (5; QUICK 2)
#   ROOMS   of each kind (3; QUICK 1)
#   SCENES  folder of the paper's scenes, with interiors/
#   DOC     where the page goes (doc)
#   JOBS    programs at a time, one thread each (all cores)
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) cache=${2:-build/tradeoff}
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} doc=${DOC:-$here/doc}
command -v gnuplot >/dev/null || { echo "tradeoff: gnuplot is missing" >&2; exit 5; }
mkdir -p "$cache" "$doc"
sh "$here/bench/python.sh" "$here/bench/tradeoff/measure.py" "$bin" "$cache" "$scenes"
extent=$(for name in QUICK SEEDS ROOMS; do
  eval "value=\${$name:-}"
  [ -z "$value" ] || printf '%s' "$name=$value "
done)
sh "$here/bench/python.sh" "$here/bench/tradeoff/page.py" "$bin" "$cache" "$doc" "$extent" "$(nproc 2>/dev/null || echo ?)"
