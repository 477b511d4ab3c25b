#!/bin/sh
# configure_test.sh SOURCES: configuring reports everything that is missing in one sentence, and refuses a big-endian
# processor.
sources=${1:?usage: configure_test.sh SOURCES}
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0

# refused SENTENCE ARGUMENT...: cmake with these arguments fails and prints the sentence.
refused() {
  sentence=$1
  shift
  if cmake "$@" >"$work/said" 2>&1; then
    echo "not refused: cmake $*"
    failed=1
  elif ! tr -s ' \n' '  ' <"$work/said" | grep -qF "$sentence"; then
    echo "not said: $sentence"
    cat "$work/said"
    failed=1
  fi
}

refused 'This is missing, or is too old: OpenEXR 3.1, OpenMesh, embree 3.13 or 4. On Debian `make packages` installs it' \
  -S "$sources" -B "$work/build" -G Ninja -DBUILD_TESTING=OFF -DCMAKE_DISABLE_FIND_PACKAGE_OpenEXR=ON \
  -DCMAKE_DISABLE_FIND_PACKAGE_OpenMesh=ON -DCMAKE_DISABLE_FIND_PACKAGE_embree=ON
refused 'This processor is big-endian' -DCMAKE_CXX_BYTE_ORDER=BIG_ENDIAN -P "$sources/cmake/machine.cmake"
exit $failed
