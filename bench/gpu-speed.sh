#!/bin/sh
# gpu-speed.sh BIN CACHE [DEVICE]: how fast tdpt-render is on a device, beside the CPU, and what its kernels take; prints
# doc/gpu-speed.md. Ten minutes on two quiet cores, most of them for kernels where the device is software. Portals are
# kept in CACHE.
#   DEVICE   gpu or gpu:WHICH, as tdpt-render --device has it (gpu)
# The environment may set
#   SCENES   folder of the paper's scenes (../shared/scenes); without veach-ajar.glb it is left out, with a word
#   ROUNDS   after the one in which kernels are made (5)
#   RADV     driver that tells of registers without a device: the file that the Vulkan loader reads for Mesa's RADV
set -eu
export LC_ALL=C
export MESA_SHADER_CACHE_DISABLE=true  # kernels are made, not taken from the run before
usage='usage: gpu-speed.sh BIN CACHE [DEVICE]'
bin=$(cd "${1:?$usage}" && pwd) cache=${2:?$usage} device=${3:-gpu}
here=$(cd "$(dirname "$0")/.." && pwd)
radv=${RADV:-/usr/share/vulkan/icd.d/radeon_icd.x86_64.json}
mkdir -p "$cache"
cache=$(cd "$cache" && pwd)

# shellcheck source=bench/find-portals.sh
. "$here/bench/find-portals.sh"
stage() { program=$1; shift; "$bin/$program" --quiet "$@"; }

# measure SCENE: its tables.
measure() {
  name=$(basename "$1" .glb)
  if [ ! -e "$1" ]; then
    echo "gpu-speed: $name.glb is not there and stays out" >&2
    return
  fi
  key="$(cksum <"$1") $(cksum <"$bin/lightgrid") $(cksum <"$bin/portalfit")"
  if [ "$(cat "$cache/$name.key" 2>/dev/null)" != "$key" ]; then
    find_portals "$1" "$cache/$name"
    echo "$key" >"$cache/$name.key"
  fi
  echo
  echo "## $name"
  echo
  "$bin/device_bench" --device "$device" --rounds "${ROUNDS:-5}" "$1" "$cache/$name.portal.glb"
}

cat <<END
# How fast tdpt-render is on a device

Written by \`make gpu-speed\` ($("$bin/tdpt-render" --version | head -1)); [gpu.md](gpu.md) says what to make of it.
\`--device $device\` of those at hand, beside $(nproc 2>/dev/null || echo ?) cores of$(sed -n 's/^model name[[:space:]]*:/ /p;' /proc/cpuinfo | sort -u | tr -s ' '):

$("$bin/tdpt-render" --list-devices | sed 's/^/    /')

Pictures 160 pixels wide, 8 samples per pixel, paths of up to 6 edges, through the portals that the stages find. CPU and device
take turns; medians over ${ROUNDS:-5} rounds, least and largest, after one in which kernels are made. A device
that is a CPU is charged the time of all its cores, any other that of the clock. \`auto\` is what it chooses on the device.

Rays, estimates and bytes are those of one sample. Bytes: for each kernel the records that an invocation reads and writes
(shaders/shared/path/render_layout.h), each whole, times its invocations, as if there were no cache; not the scene, its
hierarchy, the film, nor what weights read along a path.
END
measure "${SCENES:-$here/../shared/scenes}/veach-ajar.glb"
measure "$here/testdata/scenes/two-rooms.glb"

cat <<END

## Registers

What Mesa's RADV says of the kernels for RDNA 2 (Navi 21; 32 invocations side by side, 1024 vector registers for each SIMD), which
needs no such device:

    VK_ICD_FILENAMES=radeon_icd.x86_64.json RADV_FORCE_FAMILY=navi21 device_bench --registers

Of scenes that have all that kernels are made for, and in brackets of diffuse rooms with portals.

END
VK_ICD_FILENAMES=$radv RADV_FORCE_FAMILY=navi21 "$bin/device_bench" --registers 2>"$cache/registers.log" ||
  { sed 's/^/gpu-speed: /' "$cache/registers.log" >&2; echo "Not measured: $(tail -1 "$cache/registers.log")"; }
