#!/bin/sh
# efficiency.sh BIN [CACHE]: how efficient the integrators are, 1 / (relMSE x CPU seconds), with portals that the
# four stages find: doc/efficiency.{csv,md,png}. An hour and a half of CPU time, with BASELINE two, and 25 minutes
# more (50 with both of Veach, Ajar) for references that are not stored. --time is time on the clock: a busy machine
# makes pictures that are worse than they might be, which the page tells. Pictures and references stay in CACHE under
# names and keys that hold program, scene, portal and options, so that a run that was stopped goes on where it was.
# The environment may set
#   BASELINE       another tdpt-render, of an older commit: gains are over its bdpt and nee, which take turns with the
#                  others as bdpt-before and nee-before; BASELINE_NAME: what the page calls it ("an older program")
#   SCENES         folder of the paper's scenes, with interiors/; one that is not there is left out, with a word
#   ONLY           names of the scenes to measure, the page has no others; default all
#   INTEGRATORS    default "nee bdpt tdpt-org tdpt tdpt-guided auto"; without a limit of depth only the last two and bdpt
#   SECONDS_EACH   CPU seconds of a picture (4); at a depth also rendered: a quarter and a sixteenth of it
#   SEEDS          pictures of each kind (8)
#   LONG_SCENES    of these also long pictures, of the integrator that aims are asked of and of the one that gains are
#                  over (those whose relMSE after a minute is asked for); LONG_SECONDS, LONG_SEEDS (60, 3; no seeds: none)
#   DEPTH          edges of the longest path, as the paper's figures have it (6); none: no limit, the whole light, in all
#                  scenes. Scenes NAME-whole have no limit in any case
#   REFERENCES     stored (the default): those of REFERENCE_FOLDER that fit, others are rendered; render: none of them;
#                  make: those that do not fit are rendered and stored there, and nothing else (COMMIT: words for the
#                  program, its commit for example)
#   REFERENCE_FOLDER   default testdata/references/efficiency
#   REF_INTEGRATOR of the references (tdpt-guided)
#   REF_SECONDS    CPU seconds of a reference, in two halves (100); half of it without an aim, eight times it at
#                  320 x 180, so that its relMSE is a tenth of what it judges
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
baseline=${BASELINE:-} baseline_name=${BASELINE_NAME:-an older program}
references=${REFERENCES:-stored} stored=${REFERENCE_FOLDER:-$here/testdata/references/efficiency}
reference_integrator=${REF_INTEGRATOR:-tdpt-guided} reference_seconds=${REF_SECONDS:-100}
long=${LONG_SECONDS:-60} long_seeds=${LONG_SEEDS:-3}
jobs=${JOBS:-$(nproc 2>/dev/null || echo 1)} depth=${DEPTH:-6}

# Scene, width, height, kind (efficiency_tables.py); of the gain: aim, moonshot; relMSE wanted after a minute, its
# moonshot; PSNR in the same time, over that which the gain is over.
list='
two-rooms 128 96 door 40 - - - -0.3
small-hole 128 96 door 60 - - - -0.3
door-ajar 128 96 door 15 - - - -0.3
half-metre-hole 128 96 door - - - - -0.3
three-rooms 128 96 door 60 - - - -0.3
window 128 96 door 2 - - - -0.3
veach-ajar 320 180 door 6 12 0.012 - -0.3
veach-ajar-flip 320 180 door 12 25 0.025 - -0.3
bathroom2-channel 128 72 door 5 - - - 0
cornell-box-portal 96 96 door - - - - -0.3
kitchen 128 72 interior 1 - - - -
bathroom 128 128 interior 1 - - - -
living-room-lamps 128 72 interior 1 - - - -
classroom-lamps 128 72 interior 1 - - - -
bathroom2 128 72 open - - - - -
cornell-box 128 128 open - - - - -
veach-ajar-whole 128 72 whole - - - - -
two-rooms-whole 128 96 whole - - - - -
kitchen-whole 128 72 whole - - - - -
bathroom2-whole 128 72 whole - - - - -
'
say() { printf '%s\n' "$*"; }
calculate() { awk -v a="$1" -v b="$2" "BEGIN { printf \"%.6g\", $3 }"; }
# about SCENE FIELD: of its line in the list.
about() { say "$list" | awk -v s="$1" -v f="$2" '$1 == s { print $f }'; }
kind_of() { about "$1" 4; }
# What of SCENE does not depend on depth has the name of its file.
file_of() { say "${1%-whole}"; }
depth_of() { if [ "$(kind_of "$1")" = whole ]; then say none; else say "$depth"; fi; }
depth_option() { [ "$1" = none ] || say "--max-depth $1"; }

for program in jq gnuplot; do
  command -v $program >/dev/null || { say "efficiency: $program is missing" >&2; exit 5; }
done
sh "$here/bench/python.sh" -c '' || { say "efficiency: python3 with numpy is missing" >&2; exit 5; }
long_scenes=$(set -- ${LONG_SCENES-$(say "$list" | awk '$7 > 0 { print $1 }')}; say "$*")
for name in ${ONLY:-} $long_scenes; do
  [ -n "$(about "$name" 1)" ] || { say "efficiency: $name is none of the scenes" >&2; exit 2; }
done
for number in "$each" "$seeds" "$reference_seconds" "$long" "$long_seeds" "$jobs"; do
  say "$number" | grep -qxE '[0-9]+(\.[0-9]+)?' || { say "efficiency: $number is no number" >&2; exit 2; }
done
case $depth in
  none) depth_words='no limit of depth' ;;
  *[!0-9]*) say "efficiency: DEPTH=$depth is neither a number nor none" >&2; exit 2 ;;
  *) depth_words="depth $depth" ;;
esac
case $references in
  stored | render | make) ;;
  *) say "efficiency: REFERENCES=$references is none of stored, render, make" >&2; exit 2 ;;
esac
if [ -n "$baseline" ]; then
  [ -x "$baseline" ] || { say "efficiency: BASELINE: $baseline is no program" >&2; exit 2; }
  [ "$depth" != none ] || { say "efficiency: BASELINE is for a limited DEPTH" >&2; exit 2; }
  baseline=$(cd "$(dirname "$baseline")" && pwd)/$(basename "$baseline")
fi
measured="${baseline:+nee-before bdpt-before }$integrators"
mkdir -p "$cache" "$doc"
[ "$references" != make ] || mkdir -p "$stored"
bin=$(cd "$bin" && pwd) cache=$(cd "$cache" && pwd) doc=$(cd "$doc" && pwd)
[ ! -d "$stored" ] || stored=$(cd "$stored" && pwd)
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
  for folder in "$here/testdata/scenes" "$scenes/interiors" "$scenes"; do
    path=$folder/$(file_of "$1").glb
    [ ! -e "$path" ] || break
  done
  say "$path"
}
there=
for scene in $(say "$list" | cut -d ' ' -f 1); do
  case " ${ONLY:-$scene} " in *" $scene "*) ;; *) continue ;; esac
  [ "$depth $(kind_of "$scene")" != 'none whole' ] || continue
  if [ -s "$(path_of "$scene")" ]; then
    there="$there $scene"
  else
    say "$scene: there is no $(file_of "$scene").glb in SCENES, left out"
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
for scene in $(for s in $there; do file_of "$s"; done | sort -u); do
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
program_of() { case $1 in *-before) say "$baseline" ;; *) say "$bin/tdpt-render" ;; esac; }
renderer=$(cksum <"$bin/tdpt-render") old_renderer=$([ -z "$baseline" ] || cksum <"$baseline")
size_of() {
  if [ -n "${WIDTH:-}${HEIGHT:-}" ]; then
    say "${WIDTH:+--width $WIDTH }${HEIGHT:+--height $HEIGHT}"
  else
    say "--width $(about "$1" 2) --height $(about "$1" 3)"
  fi
}
# draw NAME SCENE KEY PROGRAM OPTION...: what the background does; ended, it ends the renderer as well.
draw() {
  name=$1 file=$(path_of "$2") key=$3 program=$4
  shift 4
  child=
  trap 'kill $child 2>/dev/null; exit 143' TERM
  python3 -B "$here/bench/peak.py" "$name.peak" "$program" "$file" "$@" --json -o "$name.exr" >"$name.json" \
    2>"$name.log" &
  child=$!
  wait $child || { status=$?; cat "$name.log" >&2; exit $status; }
  rm -f "$name.log"
  keep "$name.exr" "$key"
}
# render NAME SCENE INTEGRATOR SEED SECONDS: NAME.exr, and its statistics NAME.json; starts, does not wait.
render() {
  options="--integrator ${3%-before} --time $5 --seed $4 $(depth_option "$(depth_of "$2")") --threads 1 $(size_of "$2")"
  portal=$(file_of "$2").portal.glb
  key="$renderer $(cat "$(file_of "$2").sum")"
  case $3 in
    *-before) key="$old_renderer $(cat "$(file_of "$2").sum")" ;;
    pt | nee | bdpt) ;;
    *) options="$options --portal $portal" key="$key $(cksum <"$portal")" ;;
  esac
  key="$key $options"
  made "$1.exr" "$key" && return
  say "$1: $(program_of "$3") $options"
  rm -f "$1.exr.key"
  start draw "$1" "$2" "$key" "$(program_of "$3")" --quiet $options
}

. "$here/bench/efficiency-references.sh"

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
    say scene,integrator,seed,seconds,spp,cpu_seconds,relmse,psnr,mape,mean,mse,peak_mib
    for r in $(printf '%s\n' $rows | awk '!seen[$0]++'); do
      name=$(say "$r" | tr , -) scene=${r%%,*}
      key="$(cat "$name.exr.key") $(cat "$scene.reference.json.key")"
      if ! made "$name.row" "$key"; then
        { cat "$name.json" "$name.peak"; for h in 1 2; do compare "$name.exr" "$scene.reference-$h.exr"; done
          cat "$scene.reference.json"; } | jq -rs '
          . as [$stats, $peak, $a, $b, $r] |
          def free(f): ([$a, $b | f] | add - ($r | f)) / 2;
          free(.mse) as $mse |
          [$stats.spp, $stats.cpu_seconds, free(.relmse),
            (if $mse > 0 then 10 * ($r.peak * $r.peak / $mse | log10) else null end),
            ($a.mape + $b.mape) / 2, $a.mean, $mse, $peak] |
            map(if . == null then "" else tostring end) | join(",")' |
          awk -F , -v OFS=, '{ for (i = 1; i <= NF; ++i) if ($i != "") $i = sprintf("%.6g", $i); print }' >"$name.row"
        [ -s "$name.row" ] || { say "efficiency: $name cannot be judged" >&2; exit 1; }
        keep "$name.row" "$key"
      fi
      say "$r,$(cat "$name.row")"
    done
  } >efficiency.csv
  for scene in $there; do
    jq -r --arg line "$(about "$scene" 0 | cut -d ' ' -f 1,4-9)" --argjson a "$(cat "$scene.reference-1.json")" \
      --argjson b "$(cat "$scene.reference-2.json")" '
      ($line | split(" ")) + [.mean, .half, .relmse / 4, $a.cpu_seconds + $b.cpu_seconds,
      .black.relmse, .black.psnr, .black.mape, $a.integrator, $a.spp + $b.spp] | @tsv' "$scene.reference.json"
  done >scenes.tsv
}
# table NAME SECONDS [ARGUMENT...]
table() {
  name=$1
  shift
  sh "$here/bench/python.sh" "$here/bench/efficiency_tables.py" "$name" scenes.tsv efficiency.csv "$@"
}

integrators_of() {
  [ "$(kind_of "$1")" = whole ] || { say "$measured"; return; }
  for i in $measured; do
    case $i in bdpt | tdpt-guided | auto) say "$i" ;; esac
  done
}
# Pictures of one seed begin with the same samples: each length has its own seeds, from 1, 1001, 2001 and 3001.
times="$each $(calculate "$each" 4 a/b) $(calculate "$each" 16 a/b)"
for scene in $there; do
  before=0
  for seconds in $times; do
    order=$(integrators_of "$scene")
    for seed in $(seq "$seeds"); do
      for i in $order; do row "$scene" "$i" $((before + seed)) "$seconds"; done
      # Another one goes first.
      order=$(set -- $order; first=$1; shift; say "$* $first")
    done
    before=$((before + 1000))
    [ "$(kind_of "$scene")" != whole ] || break
  done
done
judge
for scene in $there; do
  case " $long_scenes " in *" $scene "*) ;; *) continue ;; esac
  order=$(table pair "$each" "$scene")
  for seed in $(seq "$long_seeds"); do
    for i in $order; do row "$scene" "$i" $((3000 + seed)) "$long"; done
  done
done
judge

. "$here/bench/efficiency-plot.sh"
. "$here/bench/efficiency-page.sh" >efficiency.md
cp efficiency.csv efficiency.md efficiency.png "$doc/"
say "efficiency: $doc/efficiency.md"
