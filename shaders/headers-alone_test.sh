#!/bin/sh
# headers-alone_test.sh ROOT CXX: each header of shaders/shared that has an include guard must include what it needs: it must
# compile alone, and included twice, as C++ and as GLSL. The others are included in a scope that their first lines describe.
root=${1:?usage: headers-alone_test.sh ROOT CXX}
cxx=${2:?}
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0
for header in $(cd "$root" && grep -lE '^#ifndef TDPT_SHADERS_' shaders/shared/*.h shaders/shared/*/*.h 2>"$work/none"); do
  printf '#include "%s"\n#include "%s"\n' "$header" "$header" >"$work/alone.cpp"
  {
    printf '#version 460\n#extension GL_GOOGLE_include_directive : require\n'
    cat "$work/alone.cpp"
    echo 'void main() {}'
  } >"$work/alone.comp"
  "$cxx" -std=c++20 -w -fsyntax-only -I "$root" "$work/alone.cpp" &&
    glslc --target-env=vulkan1.2 -O0 -I "$root" -o "$work/alone.spv" "$work/alone.comp" || {
    echo "$header does not compile alone"
    failed=1
  }
done
[ -e "$work/alone.comp" ] || { echo "headers-alone: no headers under $root"; exit 2; }
exit $failed
