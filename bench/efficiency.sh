#!/bin/sh
# efficiency.sh BIN [CACHE]: how efficient the integrators are, 1 / (relMSE x CPU seconds), with portals that the
# four stages find: doc/efficiency.{csv,md,png}. 40 minutes on two quiet cores. Pictures and references stay in
# CACHE under names and keys that hold program, scene, portal and options, so that a run that was stopped goes
# on where it was.
# The environment may set
#   SCENES         folder of the paper's scenes; one that is not there is left out, with a word
#   ONLY           names of the scenes to measure, the page has no others; default all
#   INTEGRATORS    default "nee bdpt tdpt-org tdpt tdpt-guided auto"; bdpt is needed for gains
#   SECONDS_EACH   CPU seconds of a picture (4); also rendered: a quarter and a sixteenth of it
#   SEEDS          pictures of each kind (8)
#   REF_INTEGRATOR of the references (tdpt-guided)
#   REF_SECONDS    CPU seconds of a reference, in two halves (80; five times that at 320 x 180)
#   LONG_SECONDS, LONG_SEEDS   where other programs' figures are known, of the best (60, 3; no seeds: left out)
#   DEPTH          edges of the longest path, as the paper's figures have it (6); none: no limit, the whole light
#   WIDTH, HEIGHT  of all pictures, for trials; else each scene has its own
#   DOC, CACHE     where the results go and what is kept; default doc and build/efficiency
#   JOBS           renderings at a time, one thread each (all cores)
#
# A reference is two halves A, B of different seeds. What a picture x is off by is measured as
# (d(x,A) + d(x,B) - d(A,B)) / 2, d = relMSE or MSE of exrdiff: this is the mean of (x-A)(x-B), to which the
# noise of neither half contributes on average; it may come out below zero.
# shellcheck disable=SC2086  # unquoted variables are lists
set -eu
export LC_ALL=C
bin=${1:-build/bin} cache=${2:-${CACHE:-build/efficiency}}
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} doc=${DOC:-$here/doc}
integrators=${INTEGRATORS:-nee bdpt tdpt-org tdpt tdpt-guided auto}
each=${SECONDS_EACH:-4} seeds=${SEEDS:-8}
reference_integrator=${REF_INTEGRATOR:-tdpt-guided} reference_seconds=${REF_SECONDS:-80}
long=${LONG_SECONDS:-60} long_seeds=${LONG_SEEDS:-3}
jobs=${JOBS:-$(nproc 2>/dev/null || echo 1)} depth=${DEPTH:-6}

# Scene, width, height; over bdpt: target, moonshot; relMSE wanted after a minute, its moonshot.
list='
two-rooms 128 96 16 40 - -
small-hole 128 96 16 65 - -
door-ajar 128 96 12 - - -
half-metre-hole 128 96 5 - - -
three-rooms 128 96 6 - - -
window 128 96 others - - -
veach-ajar 320 180 5 - 0.04 0.02
veach-ajar-flip 320 180 5 - 0.1 0.03
bathroom2-channel 128 72 - - - -
cornell-box-portal 96 96 - - - -
'
say() { printf '%s\n' "$*"; }
calculate() { awk -v a="$1" -v b="$2" "BEGIN { printf \"%.6g\", $3 }"; }
# about SCENE FIELD: of its line in the list.
about() { say "$list" | awk -v s="$1" -v f="$2" '$1 == s { print $f }'; }

for program in jq gnuplot; do
  command -v $program >/dev/null || { say "efficiency: $program is missing" >&2; exit 5; }
done
sh "$here/bench/python.sh" -c '' || { say "efficiency: python3 with numpy is missing" >&2; exit 5; }
for name in ${ONLY:-}; do
  [ -n "$(about "$name" 1)" ] || { say "efficiency: ONLY: $name is none of the scenes" >&2; exit 2; }
done
for number in "$each" "$seeds" "$reference_seconds" "$long" "$long_seeds" "$jobs"; do
  say "$number" | grep -qxE '[0-9]+(\.[0-9]+)?' || { say "efficiency: $number is no number" >&2; exit 2; }
done
case $depth in
  none) depth_option='' depth_words='no limit of depth' ;;
  *[!0-9]*) say "efficiency: DEPTH=$depth is neither a number nor none" >&2; exit 2 ;;
  *) depth_option="--max-depth $depth" depth_words="depth $depth" ;;
esac
mkdir -p "$cache" "$doc"
bin=$(cd "$bin" && pwd) cache=$(cd "$cache" && pwd) doc=$(cd "$doc" && pwd)
[ ! -d "$scenes" ] || scenes=$(cd "$scenes" && pwd)
cd "$cache"

# made FILE KEY: FILE is there and was made with KEY. After making it: keep FILE KEY.
made() { [ -s "$1" ] && [ "$(cat "$1.key" 2>/dev/null)" = "$2" ]; }
keep() { printf '%s\n' "$2" >"$1.key"; }

# Renderings run side by side, $jobs of them; a round ends when its last one does.
round=
trap 'trap - INT TERM HUP; [ -z "$round" ] || kill $round 2>/dev/null || :; exit 130' INT TERM HUP
start() {
  "$@" &
  round="$round $!"
  [ "$(set -- $round; echo $#)" -lt "$jobs" ] || finish
}
finish() {
  status=0
  for process in $round; do wait "$process" || status=$?; done
  round=
  [ $status = 0 ] || exit $status
}

path_of() {
  if [ -e "$here/testdata/scenes/$1.glb" ]; then say "$here/testdata/scenes/$1.glb"; else say "$scenes/$1.glb"; fi
}
there=
for scene in $(say "$list" | cut -d ' ' -f 1); do
  case " ${ONLY:-$scene} " in *" $scene "*) ;; *) continue ;; esac
  if [ -s "$(path_of "$scene")" ]; then
    there="$there $scene"
  else
    say "$scene: there is no $scene.glb in SCENES, left out"
  fi
done
[ -n "$there" ] || { say "efficiency: none of the scenes is in $scenes" >&2; exit 3; }

# ---- Portals ----
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
# The summary that stays is the last one's.
stage() {
  program=$1
  shift
  "$bin/$program" --quiet --json "$@" >"$scene.portal.json"
}
portal_programs=$(cd "$bin" && cat ffgraph mincut lightgrid portalfit | cksum)
for scene in $there; do
  file=$(path_of "$scene")
  cksum <"$file" >"$scene.sum"
  key="$portal_programs $(cat "$scene.sum")"
  made "$scene.portal.glb" "$key" && continue
  say "$scene: portal"
  find_portals "$file" "$scene"
  rm -f "$scene.max" "$scene.cut" "$scene.vdb"
  keep "$scene.portal.glb" "$key"
done

# ---- Pictures ----
renderer=$(cksum <"$bin/tdpt-render")
size_of() {
  if [ -n "${WIDTH:-}${HEIGHT:-}" ]; then
    say "${WIDTH:+--width $WIDTH }${HEIGHT:+--height $HEIGHT}"
  else
    say "--width $(about "$1" 2) --height $(about "$1" 3)"
  fi
}
# draw NAME SCENE KEY OPTION...: what the background does; ended, it ends the renderer as well.
draw() {
  name=$1 file=$(path_of "$2") key=$3
  shift 3
  child=
  trap 'kill $child 2>/dev/null; exit 143' TERM
  "$bin/tdpt-render" "$file" "$@" --json -o "$name.exr" >"$name.json" 2>"$name.log" &
  child=$!
  wait $child || { status=$?; cat "$name.log" >&2; exit $status; }
  rm -f "$name.log"
  keep "$name.exr" "$key"
}
# render NAME SCENE INTEGRATOR SEED SECONDS: NAME.exr, and its statistics NAME.json; starts, does not wait.
render() {
  options="--integrator $3 --time $5 --seed $4 $depth_option --threads 1 $(size_of "$2")"
  key="$renderer $(cat "$2.sum")"
  case $3 in
    pt | nee | bdpt) ;;
    *) options="$options --portal $2.portal.glb" key="$key $(cksum <"$2.portal.glb")" ;;
  esac
  key="$key $options"
  made "$1.exr" "$key" && return
  say "$1: $options"
  rm -f "$1.exr.key"
  start draw "$1" "$2" "$key" --quiet $options
}

for scene in $there; do
  half=$(calculate "$reference_seconds" "$(about "$scene" 2)" 'a / 2 * (b >= 320 ? 5 : 1)')
  for h in 1 2; do render "$scene.reference-$h" "$scene" "$reference_integrator" $((1000000 + h)) "$half"; done
done
finish

compare() { "$bin/exrdiff" --quiet --json "$1" "$2"; }
for scene in $there; do
  a=$scene.reference-1 b=$scene.reference-2
  key="$(cat $a.exr.key) $(cat $b.exr.key)"
  made "$scene.reference.json" "$key" && continue
  { compare $a.exr $b.exr; compare $b.exr $a.exr; } |
    jq -s 'def m(f): map(f) | add / 2; {relmse: m(.relmse), mse: m(.mse), peak: m(.peak), mean: m(.mean),
      half: ((.[0].mean - .[1].mean) / 2 | fabs),
      black: {relmse: m(.black.relmse), psnr: m(.black.psnr), mape: m(.black.mape)}}' >"$scene.reference.json"
  keep "$scene.reference.json" "$key"
done

# row SCENE INTEGRATOR SEED SECONDS: renders; its row of the table is wanted.
rows=
row() {
  rows="$rows $1,$2,$3,$4"
  render "$1-$2-$3-$4" "$@"
}
# judge: NAME.row for all that is wanted; efficiency.csv and scenes.tsv.
judge() {
  finish
  {
    say scene,integrator,seed,seconds,spp,cpu_seconds,relmse,psnr,mape,mean,mse
    for r in $(printf '%s\n' $rows | awk '!seen[$0]++'); do
      name=$(say "$r" | tr , -) scene=${r%%,*}
      key="$(cat "$name.exr.key") $(cat "$scene.reference.json.key")"
      if ! made "$name.row" "$key"; then
        { cat "$name.json"; for h in 1 2; do compare "$name.exr" "$scene.reference-$h.exr"; done
          cat "$scene.reference.json"; } | jq -rs '
          . as [$stats, $a, $b, $r] |
          def free(f): ([$a, $b | f] | add - ($r | f)) / 2;
          free(.mse) as $mse |
          [$stats.spp, $stats.cpu_seconds, free(.relmse),
            (if $mse > 0 then 10 * ($r.peak * $r.peak / $mse | log10) else null end),
            ($a.mape + $b.mape) / 2, $a.mean, $mse] |
            map(if . == null then "" else tostring end) | join(" ")' |
          awk -v OFS=, '{ for (i = 1; i <= NF; ++i) $i = sprintf("%.6g", $i); $1 = $1; print }' >"$name.row"
        keep "$name.row" "$key"
      fi
      say "$r,$(cat "$name.row")"
    done
  } >efficiency.csv
  for scene in $there; do
    jq -r --arg line "$(about "$scene" 0 | cut -d ' ' -f 1,4-7)" --argjson a "$(cat "$scene.reference-1.json")" \
      --argjson b "$(cat "$scene.reference-2.json")" '
      ($line | split(" ")) + [.mean, .half, .relmse / 4, $a.cpu_seconds + $b.cpu_seconds,
      .black.relmse, .black.psnr, .black.mape, $a.integrator, $a.spp + $b.spp] | @tsv' "$scene.reference.json"
  done >scenes.tsv
}
# table NAME SECONDS [SCENE [INTEGRATOR]]
table() {
  name=$1
  shift
  sh "$here/bench/python.sh" "$here/bench/efficiency_tables.py" "$name" scenes.tsv efficiency.csv "$@"
}

# Pictures of one seed begin with the same samples: each length has its own seeds, from 1, 1001, 2001 and 3001.
times="$each $(calculate "$each" 4 a/b) $(calculate "$each" 16 a/b)"
for scene in $there; do
  before=0
  for seconds in $times; do
    order=$integrators
    for seed in $(seq "$seeds"); do
      for i in $order; do row "$scene" "$i" $((before + seed)) "$seconds"; done
      # Another one goes first.
      order=$(set -- $order; first=$1; shift; say "$* $first")
    done
    before=$((before + 1000))
  done
done
judge
for scene in $there; do
  [ "$(about "$scene" 6)" != - ] || continue
  i=$(table best "$each" "$scene")
  for seed in $(seq "$long_seeds"); do [ -z "$i" ] || row "$scene" "$i" $((3000 + seed)) "$long"; done
done
judge

# ---- Plot: error against time, a panel for each scene ----
style_of() {
  case $1 in
    bdpt) say 'lc rgb "#000000" pt 7' ;;
    nee) say 'lc rgb "#8c8c8c" pt 5' ;;
    tdpt-org) say 'lc rgb "#0072b2" pt 9' ;;
    tdpt) say 'lc rgb "#56b4e9" pt 11' ;;
    tdpt-guided) say 'lc rgb "#d55e00" pt 13' ;;
    auto) say 'lc rgb "#009e73" pt 6' ;;
    *) say 'lc rgb "#cc79a7" pt 4' ;;
  esac
}
rm -f ./*.points
for scene in $there; do
  for i in $integrators; do
    for seconds in $(printf '%s\n' $times | sort -g); do
      table means "$seconds" "$scene" "$i"
    done >"$scene-$i.points"
  done
done
# The same times in every panel.
span=$(cat ./*.points | awk '{ if (!least || $1 < least) least = $1; if ($1 > most) most = $1 }
  END { printf "[%.4g:%.4g]", most ? least / 1.4 : 0.1, most ? most * 1.4 : 1 }')
columns=$(set -- $there; [ $# -le 3 ] && echo $(($# + 1)) || echo 4)
lines=$(set -- $there; echo $((($# + columns) / columns)))
{
  cat <<PLOT
set terminal pngcairo size $((400 * columns)),$((340 * lines)) font "sans-serif,13" background "white"
set output "efficiency.png"
set multiplot layout $lines,$columns
set logscale xy
set format x "%g"
set format y "10^{%T}"
set xtics in (0.1, 0.3, 1, 3, 10, 30, 100)
set xlabel "CPU seconds" offset 0,0.6
set ylabel "relMSE" offset 1.2,0
set grid lc rgb "#dddddd" lt 1 lw 0.5
set border lw 1
set key off
set pointsize 1.1
set bars 0.6
set lmargin 8
set rmargin 1.5
set tmargin 2
set bmargin 3
PLOT
  for scene in $there; do
    black=$(awk -F '\t' -v s="$scene" '$1 == s { print $10 }' scenes.tsv)
    printf 'set title "%s" offset 0,-0.6\n' "$(say "$scene" | tr _ ' ')"
    printf 'plot %s %s with lines dt 3 lw 1.2 lc rgb "#666666" notitle' "$span" "$black"
    for i in $integrators; do
      [ -s "$scene-$i.points" ] || continue
      printf ', "%s-%s.points" using 1:2:3:4 with yerrorbars lw 1 %s notitle' "$scene" "$i" "$(style_of "$i")"
      printf ', "" using 1:2 with lines lw 2 %s notitle' "$(style_of "$i" | sed 's/ pt .*//')"
    done
    printf '\n'
  done
  # The last cell holds the key alone.
  printf '%s\n' 'unset title' 'unset xlabel' 'unset ylabel' 'unset tics' 'unset border' 'unset grid' \
    'set key center center spacing 1.5 samplen 3 Left reverse'
  printf 'plot [1:2] [1:2] '
  for i in $integrators; do
    printf 'NaN with linespoints lw 2 %s title "%s", ' "$(style_of "$i")" "$i"
  done
  printf 'NaN with lines dt 3 lw 1.2 lc rgb "#666666" title "all black"\n'
} >plot.gnuplot
gnuplot plot.gnuplot

. "$here/bench/efficiency-page.sh" >efficiency.md
cp efficiency.csv efficiency.md efficiency.png "$doc/"
say "efficiency: $doc/efficiency.md"
