#!/bin/sh
# limit.sh BIN [CACHE [DOC]]: how far the renderer is from casting its rays and nothing else: DOC/limit.md. Frames of two
# scenes with the portals that the stages find, no limit of depth, by limit_bench; and a profile of what the rest is,
# by perf, or by callgrind of a small picture where perf does not work. Four minutes on two quiet cores.
# The environment may set
#   SCENES       folder of the paper's scenes (../shared/scenes); without veach-ajar.glb it is left out, with a word
#   INTEGRATORS  of the frames (nee,bdpt,tdpt-org,tdpt-guided); THREADS (1,2); SEEDS (5), one frame each
#   WIDTH, SPP   of the frames (240, 8)
#   PROFILED     integrators with a profile ("bdpt tdpt-guided"); PROFILE_SPP (32)
#   PERF         perf; anything else than a program that works: callgrind
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) cache=${2:-build/limit}
here=$(cd "$(dirname "$0")/.." && pwd)
doc=${3:-$here/doc}
scenes=${SCENES:-$here/../shared/scenes} width=${WIDTH:-240} perf=${PERF:-perf}
sh "$here/bench/python.sh" -c '' || { echo "limit: python3 with numpy is missing" >&2; exit 5; }
mkdir -p "$cache" "$doc"
cache=$(cd "$cache" && pwd)
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() { program=$1; shift; "$bin/$program" --quiet "$@"; }
# perf is often there and not allowed, or not made for the kernel.
if "$perf" record -q -e cpu-clock -o "$cache/perf.data" true >"$cache/perf.err" 2>&1; then
  counter=perf
elif command -v valgrind >/dev/null; then
  counter=callgrind
else
  echo "limit: $perf does not work and valgrind is missing, no profile can be made" >&2
  exit 5
fi
# made FILE KEY: FILE is there and was made with KEY. After making it: keep FILE KEY.
made() { [ -s "$1" ] && [ "$(cat "$1.key" 2>/dev/null)" = "$2" ]; }
keep() { printf '%s\n' "$2" >"$1.key"; }
# load: processes that want a core, about, and cores.
load() { echo "load $(cut -d ' ' -f 1 /proc/loadavg 2>/dev/null || echo 0) $(nproc)"; }

# profile SCENE INTEGRATOR: lines COUNT|OBJECT|FUNCTION, and how they were counted.
profile() {
  name=$(basename "$1" .glb)
  echo "profile $name $2 $counter"
  set -- "$bin/tdpt-render" --quiet "$1" --portal "$cache/$name.portal.glb" --integrator "$2" --threads 1 -o "$cache/picture.exr"
  if [ "$counter" = perf ]; then
    "$perf" record -q -e cpu-clock -F 997 -o "$cache/perf.data" "$@" --spp "${PROFILE_SPP:-32}" --width "$width"
    "$perf" report --stdio -q -i "$cache/perf.data" --no-children -F sample,dso,sym -t '|' 2>"$cache/perf.err"
  else
    valgrind --quiet --tool=callgrind --callgrind-out-file="$cache/callgrind.out" "$@" --spp 4 --width 32
    callgrind_annotate --threshold=100 --show-percs=no "$cache/callgrind.out" |
      sed -n 's/^ *\([0-9][0-9,]*\)  [^:]*:\(.*\) \[\(.*\)\]$/\1|\3|\2/p' | sed ':again
        s/^\([0-9]*\),/\1/
        t again'
  fi
}

: >"$cache/lines"
for scene in "$here/testdata/scenes/two-rooms.glb" "$scenes/veach-ajar.glb"; do
  [ -r "$scene" ] || { echo "limit: $scene is not there, its rows are left out" >&2; continue; }
  name=$(basename "$scene" .glb)
  key="$(cd "$bin" && cat ffgraph mincut lightgrid portalfit | cksum) $(cksum <"$scene")"
  portal=$cache/$name.portal.glb
  made "$portal" "$key" || { find_portals "$scene" "$cache/$name"; keep "$portal" "$key"; }
  {
    load
    "$bin/limit_bench" "$scene" "$portal" --integrators "${INTEGRATORS:-nee,bdpt,tdpt-org,tdpt-guided}" \
      --threads "${THREADS:-1,2}" --seeds "${SEEDS:-5}" --width "$width" --spp "${SPP:-8}"
    load
    for integrator in ${PROFILED:-bdpt tdpt-guided}; do profile "$scene" "$integrator"; done
  } >>"$cache/lines"
done
sh "$here/bench/python.sh" "$here/bench/limit.py" <"$cache/lines" >"$cache/limit.md"
mv "$cache/limit.md" "$doc/limit.md"
