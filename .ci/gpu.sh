#!/bin/sh
# gpu.sh pack | gpu.sh run OUT: checks that need a real GPU, within ten minutes, on a machine with a copy of this
# folder, a Vulkan driver and nothing else installed.
#   pack   here: puts the programs, two more that test and measure, and the libraries they need into build/gpu-kit.tar.gz
#   run    there: writes to OUT
#            bytes.txt       whether the device gives the bytes of the scalar build of its kernels
#            registers.txt   statistics of each kernel from the driver's compiler
#            frame.txt       the paper's frame: 1280 x 720, 32 samples, paths of 4 edges, compared with all CPU cores
# SCENE=FILE for pack: the frame's scene, by default the room of testdata.
set -eu
cd "$(dirname "$0")/.."
kit=build/gpu-kit

pack() {
  rm -rf $kit
  mkdir -p $kit/tools
  make tarball
  cmake --preset release --log-level=WARNING
  cmake --build --preset release --target device_test device_bench
  tar xf build/tdpt-*-linux-*.tar.gz -C $kit --strip-components 1
  for tool in device_test device_bench; do
    strip -o $kit/tools/$tool build/bin/$tool
    # Libraries that only these two need.
    ldd build/bin/$tool | awk '$2 == "=>" { print $1, $3 }' | grep -vE '^(linux-vdso|ld-linux|lib(c|m|dl|rt|pthread|gcc_s|stdc[+][+])[.]so)' |
      while read -r name path; do
        [ -e "$kit/lib/tdpt/$name" ] || cp -L "$path" "$kit/lib/tdpt/$name"
      done
    patchelf --set-rpath '$ORIGIN/../lib/tdpt' $kit/tools/$tool
  done
  cp "${SCENE:-testdata/scenes/two-rooms.glb}" $kit/scene.glb
  pwd >$kit/sources  # where tests look for testdata
  tar czf $kit.tar.gz $kit
}

# Time limit of a part, its name, and its command.
part() {
  limit=$1 name=$2
  shift 2
  echo "gpu.sh: $name, up to $limit s"
  timeout "$limit" "$@" >"$out/$name.txt" 2>&1 || echo "gpu.sh: $name ended with $?" | tee -a "$out/$name.txt"
}

run() {
  out=$1
  tar xzf $kit.tar.gz
  sources=$(cat $kit/sources)
  if [ ! -e "$sources" ]; then
    mkdir -p "$(dirname "$sources")"
    ln -s "$PWD" "$sources"
  fi
  PATH=$PWD/$kit/bin:$PWD/$kit/tools:$PATH
  ffgraph $kit/scene.glb -o "$out/a.max"
  mincut "$out/a.max" -o "$out/a.cut"
  lightgrid $kit/scene.glb "$out/a.cut" -o "$out/a.vdb"
  portalfit "$out/a.vdb" -o "$out/a.portal.glb"
  part 200 bytes device_test --gtest_filter="${TESTS:-device_bytes.*}"
  part 60 registers device_bench --registers
  part 280 frame device_bench --integrators bdpt,tdpt,tdpt-guided --width "${WIDTH:-1280}" --spp "${SPP:-32}" --max-depth 4 \
    --rounds 1 $kit/scene.glb "$out/a.portal.glb"
}

case ${1:-} in
  pack) pack ;;
  run) run "${2:?usage: gpu.sh run OUT}" ;;
  *) echo "usage: gpu.sh pack | gpu.sh run OUT" >&2; exit 2 ;;
esac
