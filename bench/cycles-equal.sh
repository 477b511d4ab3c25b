#!/bin/sh
# cycles-equal.sh BIN [FOLDER]: what tdpt-render makes with the portals that the stages find, beside what Cycles makes
# with portals drawn by hand, in equal CPU time. Rooms (sky_rooms.py) x skies, several seeds taking turns, one thread
# each. Prints the tables of doc/cycles.md; a room and a sky take four minutes. What was measured stays in FOLDER, a
# file for each room and sky, and is not measured again: another size wants another folder.
# The environment may set
#   ROOMS     of: window windows skylight behind (all)
#   SKIES     of: overcast clear sun (all)
#   SECONDS_EACH, SEEDS   CPU seconds of a picture (4), and pictures of each kind (4)
#   REF       how many times as long each half of a reference takes (6)
#   WIDTH, HEIGHT   (96 x 72)
#   BLENDER
#
# CPU seconds are those of rendering. Cycles: of Blender's process in bpy.ops.render.render, less those of a picture of
# one sample. tdpt-render: cpu_seconds of its summary, the time that auto takes to choose included. Loading the scene is
# in neither.
# A program's pictures are held against its own reference, in two halves A, B, made with its portals. A picture x is off
# by (d(x,A) + d(x,B) - d(A,B)) / 2, d = relMSE or MSE, to which the noise of neither half contributes on average.
# shellcheck disable=SC2086  # unquoted variables are lists
set -eu
export LC_ALL=C
bin=$(cd "${1:-build/bin}" && pwd) out=${2:-cycles-equal}
here=$(cd "$(dirname "$0")/.." && pwd)
seconds=${SECONDS_EACH:-4} seeds=${SEEDS:-4} reference_factor=${REF:-6} turn=-45
width=${WIDTH:-96} height=${HEIGHT:-72} blender=${BLENDER:-blender}
for program in jq "$blender"; do
  command -v "$program" >/dev/null || { echo "cycles-equal: $program is missing" >&2; exit 5; }
done
mkdir -p "$out/rooms"
out=$(cd "$out" && pwd)
sh "$here/bench/python.sh" "$here/bench/sky_rooms.py" "$out/rooms"
# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"

environment() {
  case $1 in
    overcast) echo 1,1,1 ;;
    clear | sun) echo "$here/testdata/environments/clear$([ "$1" = clear ] || echo -sun).exr" ;;
    *) echo "cycles-equal: SKIES: $1 is none of overcast, clear, sun" >&2; return 2 ;;
  esac
}
stage() {
  program=$1
  shift
  case $program in
    ffgraph | lightgrid) set -- "$@" --environment "$sky" --environment-rotation "$turn" ;;
    portalfit) set -- "$@" --json ;;
  esac
  "$bin/$program" --quiet "$@"
}
# made METHOD SEED AMOUNT: $stem-METHOD-SEED.exr, of Cycles or ours as METHOD begins; a line "SEED SAMPLES CPU" in .cpu.
# AMOUNT: --spp N, or --cpu-seconds S.
made() {
  method=$1 number=$2 amount=$3 picture=$stem-$1-$2
  set -- "$scene" --threads 1 --width "$width" --height "$height" --environment "$sky" --environment-rotation "$turn"
  case $method in
    cycles-hand) set -- "$@" --script "$out/rooms/$room.portals.py" ;;
    cycles-found) set -- "$@" --script "$stem.portals.py" ;;
    ours-nee) set -- "$@" --integrator nee ;;
    ours-auto) set -- "$@" --portal "$stem.portal.glb" ;;
  esac
  case $method in
    cycles*)
      scene_file=$1
      shift
      "$blender" -b --factory-startup --python-exit-code 1 --python "$here/bench/cycles-render.py" -- "$scene_file" \
        "$picture.exr" "$@" --first-seed "$number" $amount --cpu "$picture.cpu" --max-depth 1026 >"$picture.log" 2>&1 ||
        { cat "$picture.log" >&2; exit 1; } ;;
    *)
      set -- "$@" --seed "$number" --quiet --json -o "$picture.exr"
      case $amount in
        --cpu-seconds*)
          "$bin/tdpt-render" "$@" --spp 16 >"$picture.json"
          amount="--spp $(jq "(16 * ${amount#* } / .cpu_seconds) | round | if . < 1 then 1 else . end" "$picture.json")" ;;
      esac
      "$bin/tdpt-render" "$@" $amount >"$picture.json"
      jq -r '"'"$number"' \(.spp) \(.cpu_seconds)"' "$picture.json" >"$picture.cpu" ;;
  esac
}
distance() { "$bin/exrdiff" --quiet --json "$1" "$2"; }
# run METHOD SEED: a line "run ROOM SKY METHOD SEED SPP CPU RELMSE MSE CHOSEN".
run() {
  chosen=-
  case $1 in cycles*) own=cycles-hand ;; *) own=ours-auto chosen=$(jq -r '.chosen // "-" | gsub(" "; "_")' "$stem-$1-$2.json") ;; esac
  { for half in 1 2; do distance "$stem-$1-$2.exr" "$stem-$own-100000$half.exr"; done; cat "$stem-$own.distance"; } |
    jq -rs --arg of "$room $light $1 $(cat "$stem-$1-$2.cpu")" --arg chosen "$chosen" '. as [$a, $b, $d] |
      "run \($of) \(($a.relmse + $b.relmse - $d.relmse) / 2) \(($a.mse + $b.mse - $d.mse) / 2) \($chosen)"'
}
# The room's cell: its line "cell ROOM SKY PORTALS BLACK_RELMSE BLACK_PSNR PEAK OFF", and those of run. PEAK:
# squared, as PSNR has it; OFF: by which share Cycles' mean differs.
cell() {
  find_portals "$scene" "$stem" >"$stem.found" || { echo "cycles-equal: $room, $light: no portals" >&2; exit 1; }
  stage portalfit "$stem.vdb" --for cycles -o "$stem.portals.py" >"$stem.text"
  methods="cycles-hand cycles-found cycles ours-nee ours-auto"
  for own in cycles-hand ours-auto; do
    made $own 1000001 "--cpu-seconds $((reference_factor * seconds))"
    made $own 1000002 "--spp $(cut -d' ' -f2 "$stem-$own-1000001.cpu")"
    { distance "$stem-$own-1000001.exr" "$stem-$own-1000002.exr"
      distance "$stem-$own-1000002.exr" "$stem-$own-1000001.exr"; } |
      jq -s '{relmse: (map(.relmse) | add / 2), mse: (map(.mse) | add / 2), mean: (map(.mean) | add / 2),
              black: .[0].black, peak: (.[0].mse * pow(10; .[0].psnr / 10))}' >"$stem-$own.distance"
  done
  jq -rs --arg of "$room $light $(jq '.portals | length' "$stem.found")" '. as [$ours, $cycles] |
    "cell \($of) \($ours.black.relmse) \($ours.black.psnr) \($ours.peak) \($cycles.mean / $ours.mean - 1)"' \
    "$stem-ours-auto.distance" "$stem-cycles-hand.distance" >"$stem.part"
  for n in $(seq "$seeds"); do
    for method in $methods; do
      amount="--cpu-seconds $seconds"
      [ "$n" = 1 ] || amount="--spp $(cut -d' ' -f2 "$stem-$method-1.cpu")"
      made "$method" "$n" "$amount"
      run "$method" "$n" >>"$stem.part"
    done
    methods=$(set -- $methods; first=$1; shift; echo "$* $first")  # another one goes first
  done
  mv "$stem.part" "$stem.runs"
}

: >"$out/all"
for room in ${ROOMS:-window windows skylight behind}; do
  for light in ${SKIES:-overcast clear sun}; do
    scene=$out/rooms/$room.gltf stem=$out/$room-$light sky=$(environment "$light")
    [ -s "$scene" ] || { echo "cycles-equal: ROOMS: there is no $room" >&2; exit 2; }
    [ -s "$stem.runs" ] || { echo "cycles-equal: $room, $light" >&2; cell; }
    cat "$stem.runs" >>"$out/all"
  done
done
sh "$here/bench/python.sh" "$here/bench/cycles_equal.py" "$out/all"
