#!/bin/sh
# light-grid-speed.sh BIN [DEVICE]: how fast each back end of lightgrid is; prints doc/light-grid-speed.md.
# Two minutes on two quiet cores.
#   DEVICE   gpu or gpu:WHICH, as lightgrid --device has it (gpu)
# The environment may set
#   SCENES   folder of the paper's scenes (../shared/scenes)
set -eu
export LC_ALL=C
bin=$(cd "${1:?usage: light-grid-speed.sh BIN [DEVICE]}" && pwd) device=${2:-gpu}
here=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() { program=$1; shift; "$bin/$program" --quiet "$@"; }

set --
for scene in "${SCENES:-$here/../shared/scenes}/veach-ajar.glb" "$here/testdata/scenes/two-rooms.glb" \
  "$here/testdata/scenes/half-metre-hole.glb"; do
  [ -e "$scene" ] || { echo "light-grid-speed: $(basename "$scene") is not there and stays out" >&2; continue; }
  cut=$work/$(basename "$scene" .glb).cut
  find_cut "$scene" "${cut%.cut}"
  set -- "$@" "$scene" "$cut"
done
cat <<END
# How fast the light is counted

Written by \`make grid-speed\` ($("$bin/lightgrid" --version | head -1)). Segments between pivot patches, drawn, tested for visibility,
judged by the votes around both their ends and marched through the grid. The back ends take turns in one run; medians of
five rounds. \`--device\`s at hand, beside $(nproc 2>/dev/null || echo ?) cores of$(sed -n 's/^model name[[:space:]]*:/ /p;' /proc/cpuinfo | sort -u | tr -s ' '):

$("$bin/lightgrid" --list-devices | sed 's/^/    /')

Embree and the twin run on all cores through TBB, and so does a software device on its own threads. Segments per second, and the
last column, go by the clock; those per CPU second hold on a machine that has other work, too.

END
"$bin/lightgrid_bench" "$device" 128 "$@" 2>"$work/128"
"$bin/lightgrid_bench" "$device" 256 "$@" 2>"$work/256" | sed '1,2d'
cat <<END

Where the device's time goes, and what becomes of the segments:

$(sed '1d; s/^/* 128 voxels, /' "$work/128")
$(sed '1d; s/^/* 256 voxels, /' "$work/256")

Votes are closest-hit rays in all directions, up to 32 for each segment that is free: where they take most of the time, the
speed is that of incoherent rays. The scalar twin walks the device's own hierarchy one ray at a time, without vector
instructions. With eight times the voxels the counts no longer fit the caches, and the march begins to show.

END
case $(sed -n '1p' "$work/128") in
*'(cpu)') cat <<'END' ;;
The device here is software. It runs several invocations side by side, each waiting for the longest of them, takes both
sides of every branch and keeps each stack in memory; it is there for tests. What a GPU is for, 20 times the speed of two
cores, is not measured by this page: `make grid-speed DEVICE=gpu:NAME` measures it where there is one.
END
esac
