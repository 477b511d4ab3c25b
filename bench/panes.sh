#!/bin/sh
# panes.sh BIN [FOLDER]: is a window of six panes better rendered with one portal, one a column of panes or one a pane?
# A room (panes.py) with bars of 4 cm and of 20 cm under three skies, by each way to use a portal; equally many samples,
# one thread, runs taking turns. Prints the table of doc/guided.md: how many times as efficient, 1 / (relMSE x CPU s),
# three and six portals are as one. Ten minutes. What was measured stays in FOLDER.
# The environment may set BARS (4 20), SKIES (overcast clear sun), SPP (24), SEEDS (4), REF_SPP (96), WIDTH, HEIGHT
# (96 x 72).
# A picture x is off by (d(x,A) + d(x,B) - d(A,B)) / 2 from a reference in two halves A, B, d = relMSE.
# shellcheck disable=SC2086  # unquoted variables are lists
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) out=${2:-panes}
here=$(cd "$(dirname "$0")/.." && pwd)
spp=${SPP:-24} seeds=${SEEDS:-4} reference_spp=${REF_SPP:-96}
size="--width ${WIDTH:-96} --height ${HEIGHT:-72} --threads 1"
command -v jq >/dev/null || { echo "panes: jq is missing" >&2; exit 5; }
mkdir -p "$out"
out=$(cd "$out" && pwd)
sh "$here/bench/python.sh" "$here/bench/panes.py" "$out"

# render NAME PORTALS OPTION...: $stem-NAME.exr and its summary.
render() {
  name=$1 portals=$2
  shift 2
  "$bin/tdpt-render" "$room.gltf" $sky $size --quiet --json --portal "$room-$portals.gltf" "$@" -o "$stem-$name.exr" \
    >"$stem-$name.json"
}
distance() { "$bin/exrdiff" --quiet --json "$1" "$2"; }
cell() {
  for half in 1 2; do render $half one --integrator tdpt-guided --spp "$reference_spp" --seed $((1000000 + half)); done
  { distance "$stem-1.exr" "$stem-2.exr"; distance "$stem-2.exr" "$stem-1.exr"; } |
    jq -s 'map(.relmse) | add / 2' >"$stem.noise"
  : >"$stem.part"
  for seed in $(seq "$seeds"); do
    for way in nee tdpt-guided auto; do
      for portals in one three six; do
        option="--integrator $way"; [ "$way" != auto ] || option=
        render x "$portals" $option --spp "$spp" --seed "$seed"
        { cat "$stem-x.json"; distance "$stem-x.exr" "$stem-1.exr"; distance "$stem-x.exr" "$stem-2.exr"; cat "$stem.noise"; } |
          jq -rs --arg of "$bar $light $way $portals" '. as [$run, $a, $b, $noise] |
            "\($of) \($run.cpu_seconds) \(($a.relmse + $b.relmse - $noise) / 2)"' >>"$stem.part"
      done
    done
  done
  mv "$stem.part" "$stem.runs"
}
: >"$out/all"
for bar in ${BARS:-4 20}; do
  for light in ${SKIES:-overcast clear sun}; do
    room=$out/panes-$bar stem=$out/panes-$bar-$light
    case $light in
      overcast) sky="--environment 1,1,1" ;;
      clear) sky="--environment $here/testdata/environments/clear.exr" ;;
      sun) sky="--environment $here/testdata/environments/clear-sun.exr" ;;
      *) echo "panes: SKIES: $light is none of overcast, clear, sun" >&2; exit 2 ;;
    esac
    sky="$sky --environment-rotation -45"
    [ -s "$stem.runs" ] || { echo "panes: $bar cm, $light" >&2; cell; }
    cat "$stem.runs" >>"$out/all"
  done
done
# shellcheck disable=SC2016  # Markdown's code
echo '| bars | sky | portals | `nee` | `tdpt-guided` | `auto` |'
echo '|---|---|---|---|---|---|'
# Cost: mean over seeds of CPU s x relMSE.
awk '{ key = $1 " cm | " $2; cost[key, $3, $4] += $5 * $6; if (!(key in seen)) { seen[key] = 1; order[++n] = key } }
  END { for (i = 1; i <= n; ++i) for (k = 1; k <= 2; ++k) { portals = k == 1 ? "three" : "six"; row = "| " order[i] " | " portals " |"
    for (w = 1; w <= 3; ++w) { way = w == 1 ? "nee" : w == 2 ? "tdpt-guided" : "auto"
      row = row sprintf(" %.2f |", cost[order[i], way, "one"] / cost[order[i], way, portals]) }
    print row } }' "$out/all"
