#!/bin/sh
# portals-bench.sh BIN: how long finding the portals takes, and how much memory, on veach-ajar and on
# the same scene with each of its triangles split in four, beside a rendering of one sample per pixel.
# Prints a table of medians and one of ratios. Runs take turns, so that a busy machine slows all down.
# The environment may set
#   SCENES   folder of the paper's scenes; without veach-ajar.glb a small scene of our own is taken
#   RUNS     of each program, 3
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd)
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} runs=${RUNS:-3}
command -v jq >/dev/null || { echo "portals-bench: jq is missing" >&2; exit 5; }
name=veach-ajar scene=$scenes/veach-ajar.glb
if [ ! -r "$scene" ]; then
  echo "portals-bench: $scene is not there, door-ajar.glb of testdata takes its place" >&2
  name=door-ajar scene=$here/testdata/scenes/door-ajar.glb
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$bin/split_scene" "$scene" "$work/split.glb"

# measured SCENE STAGE COMMAND...: runs it; adds a line of scene, stage, wall, CPU, CPU of loading the
# scene and of its BVH, peak MiB. The last two come from the summary, where there is one.
measured() {
  of=$1 stage=$2
  shift 2
  times >"$work/before"  # not in a pipe: a subshell has children of its own
  began=$(date +%s%N)
  "$@" >"$work/json"
  ended=$(date +%s%N)
  times >"$work/after"
  cpu=$(awk 'FNR == 2 { s = -s; for (i = 1; i <= 2; i++) { split($i, t, /[ms]/); s += 60 * t[1] + t[2] } }
             END { print s }' "$work/before" "$work/after")
  aside=0
  case $stage in
    ffgraph | lightgrid)
      aside=$(jq '[.phases.load, .phases.bvh] | map(select(.) | .cpu_seconds) | add // 0' "$work/json")
      ;;
  esac
  peak=$(jq -rs '((.[0] // {}).peak_bytes // 0) / 1048576 | round' "$work/json")
  echo "$of $stage $(awk "BEGIN { print ($ended - $began) / 1e9 }") $cpu $aside $peak" >>"$work/runs"
}

# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() {
  program=$1
  shift
  measured "$of" "$program" "$bin/$program" --quiet --json "$@"
}

run=0
while [ $run -lt "$runs" ]; do
  run=$((run + 1))
  measured "$name" bdpt "$bin/tdpt-render" --quiet --integrator bdpt --spp 1 --width 1280 \
    --height 720 "$scene" -o "$work/a.exr"
  of=$name && find_portals "$scene" "$work/a"
  of=$name/4 && find_portals "$work/split.glb" "$work/a"
done

# Medians over the runs; the four stages together are summed within a run.
awk -v runs="$runs" -v name="$name" '
  function median(list, n, v, i, j, t) {
    n = split(list, v, " ")
    for (i = 2; i <= n; i++) {
      t = v[i] + 0
      for (j = i - 1; j > 0 && v[j] + 0 > t; j--) v[j + 1] = v[j]
      v[j + 1] = t
    }
    return v[int((n + 1) / 2)]
  }
  function take(key, wall, cpu, aside, peak) {
    if (!(key in seen)) { seen[key] = 1; keys[++count] = key }
    walls[key] = walls[key] " " wall
    cpus[key] = cpus[key] " " cpu
    asides[key] = asides[key] " " aside
    rests[key] = rests[key] " " cpu - aside
    if (peak > peaks[key]) peaks[key] = peak
  }
  {
    take($1 " " $2, $3, $4, $5, $6)
    if ($2 == "ffgraph") sum_wall = sum_cpu = sum_aside = most = 0
    sum_wall += $3; sum_cpu += $4; sum_aside += $5
    if ($6 > most) most = $6
    if ($2 == "portalfit") take($1 " all four", sum_wall, sum_cpu, sum_aside, most)
  }
  END {
    print "| scene | stage | wall s | CPU s | CPU s of loading and BVH | peak MiB |"
    print "|---|---|---|---|---|---|"
    for (i = 1; i <= count; i++) {
      key = keys[i]
      split(key, part, " ")
      stage = substr(key, length(part[1]) + 2)
      if (stage == "bdpt") stage = "tdpt-render bdpt, 1 spp, 1280x720"
      of = part[1]
      sub(/\/4$/, ", split in four", of)
      aside = stage !~ /ffgraph|lightgrid|all/ ? "-" : sprintf("%.2f", median(asides[key]))
      peak = peaks[key] > 0 ? sprintf("%d", peaks[key]) : "-"
      printf "| %s | %s | %.2f | %.2f | %s | %s |\n", of, stage, median(walls[key]), median(cpus[key]),
             aside, peak
    }
    print ""
    print "| ratio | measured | at most |"
    print "|---|---|---|"
    printf "| four stages to bdpt, wall | %.2f | 1 |\n",
           median(walls[name " all four"]) / median(walls[name " bdpt"])
    printf "| four stages to bdpt, CPU | %.2f | 1 |\n",
           median(cpus[name " all four"]) / median(cpus[name " bdpt"])
    printf "| split in four to whole, CPU without loading and BVH | %.2f | 1.5 |\n",
           median(rests[name "/4 all four"]) / median(rests[name " all four"])
  }' "$work/runs"
