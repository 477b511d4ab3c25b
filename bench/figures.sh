#!/bin/sh
# figures.sh BIN CACHE: the paper's Figs 5 to 7 from our own renders, as doc/figures.md and
# doc/figures/. Renders and portals are kept in CACHE under names and keys that hold program,
# scene, portal and options, so that a run that was stopped goes on where it was.
# The environment may set
#   SCENES   folder of the five scenes; one that is not there is left out, with a word
#   DOC      where figures.md goes; default doc
#   WIDTH, HEIGHT      of the pictures; one follows from the other and the camera; default 120 high
#   SPP, REF_SPP       samples per pixel of Fig 7's pictures and of their references
#   FRAMES             samples per pixel of Fig 5
#   SEED
set -eu
bin=${1:-build/bin} cache=${2:-build/figures}
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} doc=${DOC:-$here/doc}
spp=${SPP:-16} frames=${FRAMES:-128} reference_spp=${REF_SPP:-512} seed=${SEED:-1}
[ -n "${WIDTH:-}" ] || HEIGHT=${HEIGHT:-120}
size="${WIDTH:+--width $WIDTH }${HEIGHT:+--height $HEIGHT}"
all="cornell-box-portal veach-ajar veach-ajar-flip bathroom2 bathroom2-channel"
integrators="pt nee bdpt tdpt-org tdpt"

say() { printf '%s\n' "$*"; }
for program in jq gnuplot; do
  command -v $program >/dev/null || { say "figures: $program is missing" >&2; exit 5; }
done
mkdir -p "$cache" "$doc/figures"
for folder in bin scenes doc cache; do
  eval "path=\$$folder"
  path=$(cd "$path" 2>/dev/null && pwd) || { say "figures: there is no folder $path" >&2; exit 3; }
  eval "$folder=\$path"
done
cd "$cache"

# made FILE KEY: FILE is there and was made with KEY. After making it: keep FILE KEY.
made() { [ -s "$1" ] && [ "$(cat "$1.key" 2>/dev/null)" = "$2" ]; }
keep() { printf '%s\n' "$2" >"$1.key"; }
# quietly LOG COMMAND...: stderr to LOG, shown when the command fails.
quietly() {
  log=$1
  shift
  "$@" 2>"$log" || { status=$?; cat "$log" >&2; exit $status; }
}

# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
# The summary that stays is the last one's.
stage() {
  program=$1
  shift
  quietly "$scene.$program.log" "$bin/$program" "$@" --seed "$seed" --json >"$scene.portal.json"
}
portal_programs=$(cd "$bin" && cat ffgraph mincut lightgrid portalfit | cksum)
# portal SCENE: SCENE.portal.glb and what portalfit says of it, SCENE.portal.json.
portal() {
  scene=$1
  key="$portal_programs $(cksum <"$scenes/$scene.glb") $seed"
  made "$scene.portal.glb" "$key" && return
  say "$scene: portal"
  find_portals "$scenes/$scene.glb" "$scene"
  rm -f "$scene.max" "$scene.vdb"
  keep "$scene.portal.glb" "$key"
}

renderer=$(cksum <"$bin/tdpt-render")
# render NAME SCENE INTEGRATOR OPTION...: NAME.exr, NAME.json (--stats), NAME.log
render() {
  name=$1 scene=$2 integrator=$3
  shift 3
  case $integrator in tdpt*) set -- --portal "$scene.portal.glb" "$@" ;; esac
  # shellcheck disable=SC2086  # several options
  set -- --integrator "$integrator" $size "$@"
  key="$renderer $(cat "$scenes/$scene.glb" "$scene.portal.glb" | cksum) $*"
  made "$name.exr" "$key" && return
  say "$name: $*"
  rm -f "$name.exr.key"
  quietly "$name.log" "$bin/tdpt-render" "$scenes/$scene.glb" "$@" --stats "$name.json" -o "$name.exr"
  keep "$name.exr" "$key"
}
# of FILE FILTER [FORMAT]: a number out of a JSON file; "-" where it is null.
of() { jq -r "$2" "$1" | awk -v f="${3:-%.3g}" '{ if ($1 == "null") print "-"; else printf f "\n", $1 }'; }

there=
for scene in $all; do
  if [ -s "$scenes/$scene.glb" ]; then
    there="$there $scene"
  else
    say "$scene: there is no $scene.glb in SCENES, left out"
  fi
done
[ -n "$there" ] || { say "figures: none of the scenes is in $scenes" >&2; exit 3; }
for scene in $there; do portal "$scene"; done

# ---- Fig 5: how the picture of the Cornell box with a hole forms ----
figure5() {
  for i in $integrators; do
    render "fig5-$i" cornell-box-portal "$i" --spp "$frames" --max-depth 6 --seed "$seed"
    # Samples, non-zero share [%], mean, CPU seconds of this frame.
    jq -r '([0] + [.frames[].cpu_seconds]) as $t | .frames | to_entries[] |
      [.value.spp, 100 * .value.nonzero, (.value.mean | add / 3),
       $t[.key + 1] - $t[.key]] | @tsv' "fig5-$i.json" >"fig5-$i.dat"
  done
  {
    cat <<'PLOT'
set terminal svg size 960,330 font "sans-serif,12" background "white"
set output "fig5.svg"
set multiplot layout 1,3
set style data lines
set xlabel "samples per pixel"
set grid
set logscale x 2
PLOT
    plot() {
      printf 'plot'
      separator=
      for i in $integrators; do
        printf '%s "fig5-%s.dat" using 1:%s title "%s" lw 2' "$separator" "$i" "$1" "$i"
        separator=,
      done
      printf '\n'
    }
    printf '%s\n' 'set title "a  non-zero pixels [%]"' 'set yrange [0:*]' 'set key off'
    plot 2
    printf '%s\n' 'set title "b  mean of the picture"' 'set key right bottom'
    plot 3
    printf '%s\n' 'set key off' 'set title "c  CPU seconds per frame"'
    plot 4
  } >fig5.gnuplot
  gnuplot fig5.gnuplot
  cp fig5.svg "$doc/figures/"
}

# ---- Fig 6: non-zero pixels of one sample per pixel ----
figure6() {
  for i in bdpt tdpt-org tdpt; do
    name=fig6-$i
    [ -s "$name.png" ] || rm -f "$name.exr.key"
    render "$name" veach-ajar-flip "$i" --spp 1 --max-depth 5 --seed "$seed" --nonzero "$name.png"
    cp "$name.png" "$doc/figures/"
  done
}

# ---- Fig 7: the same samples for everyone, against a long rendering ----
figure7() {
  for scene in $there; do
    render "$scene-reference" "$scene" tdpt-org --spp "$reference_spp" --max-depth 5 \
      --seed $((seed + 1))
    for i in $integrators; do
      render "$scene-$i" "$scene" "$i" --spp "$spp" --max-depth 5 --seed "$seed"
      "$bin/exrdiff" "$scene-$i.exr" "$scene-reference.exr" --json \
        --side-by-side "fig7-$scene-$i.png" >"$scene-$i.error.json"
    done
    for i in bdpt tdpt; do cp "fig7-$scene-$i.png" "$doc/figures/"; done
  done
}

has() { case " $there " in *" $1 "*) ;; *) return 1 ;; esac; }
if has cornell-box-portal; then figure5; fi
if has veach-ajar-flip; then figure6; fi
figure7
. "$here/bench/figures-page.sh" >"$doc/figures.md.new"
mv "$doc/figures.md.new" "$doc/figures.md"
say "figures: $doc/figures.md"
