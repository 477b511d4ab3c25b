#!/bin/sh
# shards.sh BIN [FOLDER]: what it costs to render a picture in shards. CPU seconds of whole processes on one thread: the
# plan, the shards and their merge, over those of the undivided run, which takes turns with them; the bytes must be the
# same. Prints doc/shards.md. A quarter of an hour. What was measured stays in FOLDER, and is not measured again.
# The environment may set
#   SCENES        folder of the paper's scenes (../shared/scenes); a scene that is not there is left out, with a word
#   PICTURES      "SCENE WIDTH HEIGHT SPP", one a line
#   SHARDS        shards of each picture (16)
#   RUNS          times that everything is done (3)
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) out=${2:-build/shards}
here=$(cd "$(dirname "$0")/.." && pwd)
scenes=${SCENES:-$here/../shared/scenes} n=${SHARDS:-16} runs=${RUNS:-3}
pictures=${PICTURES:-two-rooms 320 240 64
veach-ajar 320 180 64}
mkdir -p "$out"
cd "$out"
measured=runs.$n.$(cat "$bin/tdpt-render" "$bin/exrmerge" | cksum | cut -d ' ' -f 1)
touch "$measured"
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() { program=$1; shift; "$bin/$program" --quiet "$@"; }

# cpu PROGRAM ARGUMENT...: CPU seconds of the process, as its shell is told.
cpu() {
  (
    program=$1
    shift
    "$bin/$program" --quiet --threads 1 "$@" || exit
    # The second line is of children: user and system, as 1m2.34s. Not into a pipe, whose shell has had no children.
    times >times.txt
    tail -n 1 times.txt | tr ms '  ' | awk '{ printf "%.2f\n", 60 * $1 + $2 + 60 * $3 + $4 }'
  )
}
rendering() { sed 's/.*"cpu_seconds":\([0-9.]*\),"mean".*/\1/' "$1"; }
sum() { echo "$@" | awk '{ for (i = 1; i <= NF; ++i) s += $i; print s }'; }

# measure FILE SCENE WIDTH HEIGHT SPP: one run, a line of $measured: what it is of; CPU seconds undivided, of them
# rendering; of the plan; of all shards, of them rendering; of the merge.
measure() {
  file=$1 name="$2 $3 $4 $5"
  set -- "$file" --portal "$2.portal.glb" --width "$3" --height "$4" --spp "$5"
  whole=$(cpu tdpt-render "$@" --stats whole.json -o whole.exr)
  plan=$(cpu tdpt-render "$@" --plan plan.json)
  parts=0 rendered=0 i=0
  while [ "$i" -lt "$n" ]; do
    part=$(cpu tdpt-render "$@" --plan plan.json --shard "$i/$n" --stats part.json -o "part.$i.exr")
    parts=$(sum "$parts" "$part")
    rendered=$(sum "$rendered" "$(rendering part.json)")
    i=$((i + 1))
  done
  merge=$(cpu exrmerge part.*.exr -o merged.exr)
  cmp whole.exr merged.exr
  rm part.*.exr
  echo "$name $whole $(rendering whole.json) $plan $parts $rendered $merge" >>"$measured"
}

echo "$pictures" | while read -r scene width height spp; do
  file=$here/testdata/scenes/$scene.glb
  [ -s "$file" ] || file=$scenes/$scene.glb
  [ -s "$file" ] || { echo "shards: there is no $scene.glb in SCENES, left out" >&2; continue; }
  [ -s "$scene.portal.glb" ] || find_portals "$file" "$scene"
  run=$(grep -c "^$scene $width $height $spp " "$measured" || true)
  while [ "$run" -lt "$runs" ]; do
    measure "$file" "$scene" "$width" "$height" "$spp"
    run=$((run + 1))
  done
done
[ -s "$measured" ] || { echo "shards: none of the scenes is there" >&2; exit 3; }

cat <<PAGE
# What it costs to render in shards

Written by \`make shards\` ($("$bin/tdpt-render" --version | head -n 1); \`bench/shards.sh\`): a plan, $n shards and their merge beside the undivided
run, by turns, each process on one thread. CPU seconds of whole processes, loading, deciding and writing among them;
medians, and least and largest of the ratios. Every merged picture had the bytes of the undivided one.

| scene | picture | samples | runs | undivided | plan | $n shards | merge | all over undivided | a shard beside rendering |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
PAGE
awk -v n="$n" '
function sorted(list, key, count,  i, j, t) {
  for (i = 1; i <= count; ++i) v[i] = list[key, i]
  for (i = 2; i <= count; ++i)
    for (j = i; j > 1 && v[j] < v[j - 1]; --j) { t = v[j]; v[j] = v[j - 1]; v[j - 1] = t }
}
function median(list, key) {
  sorted(list, key, count[key])
  return (v[int((count[key] + 1) / 2)] + v[int(count[key] / 2) + 1]) / 2
}
{
  key = $1 " | " $2 " x " $3 " | " $4
  if (!(key in count)) keys[++kinds] = key
  i = ++count[key]
  whole[key, i] = $5; plan[key, i] = $7; parts[key, i] = $8; merge[key, i] = $10
  ratio[key, i] = ($7 + $8 + $10) / $5
  beside[key, i] = ($8 - $9) / n
}
END {
  for (k = 1; k <= kinds; ++k) {
    key = keys[k]
    middle = median(ratio, key)
    printf "| %s | %d | %.1f | %.2f | %.1f | %.2f | %.3f (%.3f to %.3f) | %.2f |\n", key, count[key], median(whole, key), median(plan, key),
      median(parts, key), median(merge, key), middle, least(ratio, key), largest(ratio, key), median(beside, key)
  }
}
function least(list, key) { sorted(list, key, count[key]); return v[1] }
function largest(list, key) { sorted(list, key, count[key]); return v[count[key]] }' "$measured"
cat <<'PAGE'

What shards cost more: each loads the scene, builds its hierarchy and writes a film, the last column; the plan is made once
more; films are read and added. None of that grows with the samples, so the more of them a shard has, the less it matters.
[farm.md](farm.md) says how to render in shards.
PAGE
