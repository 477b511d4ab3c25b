#!/bin/sh
# target-error.sh BIN [CACHE]: how many of the pictures that tdpt-render renders to a relMSE (--target-error) have it,
# as exrdiff says against the mean of the other seeds' pictures, and how much better they are than asked:
# doc/target-error.md. Ten minutes of CPU time. What was measured stays in CACHE under keys that hold program, scene and
# options.
# The environment may set
#   SCENES         folder of the paper's scenes (../shared/scenes), with interiors/; one that is not there is left out
#   ONLY           names of the scenes to measure; default all
#   SEEDS          pictures of each scene (100)
#   PORTALS        folder with portals that are there already, SCENE.portal.glb; others are found
#   DOC            where target-error.md goes (doc)
#   JOBS           scenes at a time, one thread each (all cores)
# shellcheck disable=SC2086  # unquoted variables are lists
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) cache=${2:-build/target-error}
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} doc=${DOC:-$here/doc} seeds=${SEEDS:-100} portals=${PORTALS:-}
jobs=${JOBS:-$(nproc 2>/dev/null || echo 1)}
# Scene, width, height, target, whether portals are looked for.
list='
two-rooms 32 24 0.01 portals
veach-ajar 32 18 0.03 portals
cornell-box-portal 32 32 0.05 portals
cornell-box 32 32 0.013 -
kitchen 40 24 0.013 -
'
say() { printf '%s\n' "$*"; }
about() { say "$list" | awk -v s="$1" -v f="$2" '$1 == s { print $f }'; }
command -v jq >/dev/null || { say "target-error: jq is missing" >&2; exit 5; }
sh "$here/bench/python.sh" -c '' || { say "target-error: python3 with numpy is missing" >&2; exit 5; }
mkdir -p "$cache" "$doc"

# made FILE KEY: FILE is there and was made with KEY. After making it: keep FILE KEY.
made() { [ -s "$1" ] && [ "$(cat "$1.key" 2>/dev/null)" = "$2" ]; }
keep() { printf '%s\n' "$2" >"$1.key"; }
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() { program=$1; shift; "$bin/$program" --quiet "$@"; }
renderer=$(cksum <"$bin/target_bench")

# measure NAME FILE: $cache/NAME.runs, a line for each picture.
measure() {
  stem=$cache/$1 portal=""
  if [ "$(about "$1" 5)" = portals ]; then
    portal=$stem.portal.glb
    if [ -s "$portals/$1.portal.glb" ]; then
      cp "$portals/$1.portal.glb" "$portal"
    else
      key="$(cd "$bin" && cat ffgraph mincut lightgrid portalfit | cksum) $(cksum <"$2")"
      made "$portal" "$key" || { find_portals "$2" "$stem"; keep "$portal" "$key"; }
    fi
  fi
  options="--width $(about "$1" 2) --height $(about "$1" 3) --target $(about "$1" 4) --integrator auto"
  key="$renderer $(cat "$2" $portal | cksum) $options $seeds"
  made "$stem.runs" "$key" && return
  rm -f "$stem.runs"
  mkdir -p "$stem"
  # Scenes take turns on the cores.
  "$bin/target_bench" "$2" "$stem" $portal $options --threads 1 --seeds "$seeds" >"$stem.told"
  while read -r seed told; do
    difference=$("$bin/exrdiff" --quiet --json "$stem/$seed.exr" "$stem/$seed.reference.exr")
    relmse=$(say "$difference" | jq .relmse)
    say "$1 $(($(about "$1" 2) * $(about "$1" 3))) $(about "$1" 4) $relmse $seed $told"
  done <"$stem.told" >"$stem.measured"
  rm -r "$stem"
  mv "$stem.measured" "$stem.runs"
  keep "$stem.runs" "$key"
}

# finish: waits for the scenes under way, and ends where one of them could not be measured.
finish() {
  failed=0
  for job in $jobs_now; do
    wait "${job#*:}" || { failed=$?; say "target-error: ${job%:*} could not be measured" >&2; }
  done
  jobs_now=""
  [ "$failed" = 0 ] || exit "$failed"
}

names="" jobs_now=""
for name in $(say "$list" | cut -d ' ' -f 1); do
  case " ${ONLY:-$name} " in *" $name "*) ;; *) continue ;; esac
  file=$here/testdata/scenes/$name.glb
  [ -s "$file" ] || file=$scenes/$name.glb
  [ -s "$file" ] || file=$scenes/interiors/$name.glb
  [ -s "$file" ] || { say "$name: there is no $name.glb in SCENES, left out" >&2; continue; }
  names="$names $name"
  measure "$name" "$file" &
  jobs_now="$jobs_now $name:$!"
  [ "$(say "$jobs_now" | wc -w)" -lt "$jobs" ] || finish
done
finish
[ -n "$names" ] || { say "target-error: none of the scenes is there" >&2; exit 3; }
for name in $names; do cat "$cache/$name.runs"; done >"$cache/runs"
{
  cat <<INTRO
# Does \`--target-error\` keep its word?

Written by \`make target-error\` ($("$bin/tdpt-render" --version | head -1)). Each scene is rendered by \`auto\` with \`--target-error E\` and
$seeds seeds, in small pictures since so many are needed; each picture's relMSE is what exrdiff says against the mean of all
others, which are independent of it and whose noise counts against it. Asked for: 90 % of the pictures meet their target, and the
median picture is at most 2.5 times too good.

Sizes and targets are such that pictures take about a hundred samples. Not all do as well: in a trial of cornell-box at 28 x 28
and E = 0.02, where a few pixels on the rim of the lamp hold most of the error, pictures were about four times too good, and 2
of 20 missed, one of them sevenfold.

INTRO
  sh "$here/bench/python.sh" "$here/bench/target_error.py" "$cache/runs"
} >"$cache/page"
mv "$cache/page" "$doc/target-error.md"
say "target-error: $doc/target-error.md"
