#!/bin/sh
# compile-shader.sh OUT OPTION... FILE.comp: compiles a kernel to OUT.spv, to the numbers of a C array, OUT.inc, and to
# its dependencies, OUT.d. Its floating-point sums and products give the same bits on every device: each gets
# NoContraction before optimisation, as GLSL's `precise` would for single variables, so that none is fused with another.
# INEXACT=1 omits that. Options are glslc's.
set -e
out=${1:?usage: compile-shader.sh OUT OPTION... FILE.comp}
shift
trap 'rm -f "$out.text" "$out.plain"' EXIT
glslc --target-env=vulkan1.2 -O0 -Werror -MD -MF "$out.d" -MT "$out.inc" -o "$out.plain" "$@"
if [ "${INEXACT:-0}" = 0 ]; then
  spirv-dis --raw-id --no-color "$out.plain" -o "$out.text"
  # Two passes: decorations precede what they decorate.
  awk '
    NR == FNR { if ($3 ~ /^Op(FAdd|FSub|FMul|VectorTimesScalar)$/) exact[n++] = $1; next }
    !told && $3 ~ /^OpType/ {
      for (i = 0; i < n; ++i) print "OpDecorate " exact[i] " NoContraction"
      told = 1
    }
    $0 !~ / NoContraction$/' "$out.text" "$out.text" | spirv-as --target-env vulkan1.2 -o "$out.plain" -
fi
spirv-opt --target-env=vulkan1.2 -O "$out.plain" -o "$out.spv"
spirv-val --target-env vulkan1.2 "$out.spv"
{
  echo '{'
  od -An -v -t x4 "$out.spv" | sed 's/\([0-9a-f]\{8\}\)/0x\1,/g'
  echo '}'
} >"$out.inc"
