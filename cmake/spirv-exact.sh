#!/bin/sh
# spirv-exact.sh FILE.spv: checks that its floating-point arithmetic gives the same bits on every device. Prints every
# sum, difference and product that a device may fuse with another (it lacks NoContraction, GLSL's `precise`), and every
# operation whose rounding or order Vulkan leaves open (shaders/shared/real.h has substitutes); exit 1 if there are any.
text=$(spirv-dis --raw-id --no-color "${1:?usage: spirv-exact.sh FILE.spv}") || exit 2
printf '%s\n' "$text" | awk '
$1 == "OpDecorate" && $3 == "NoContraction" { exact[$2] = 1 }
{ why = "" }
$3 ~ /^Op(FAdd|FSub|FMul|VectorTimesScalar)$/ && !($1 in exact) { why = "may be fused" }
$3 ~ /^Op(FDiv|FRem|FMod|Dot|OuterProduct|(Matrix|Vector)Times(Matrix|Vector)|MatrixTimesScalar)$/ { why = "not exact" }
$3 == "OpExtInst" &&
  $6 !~ /^([FSU](Abs|Sign|Min|Max|Clamp)|Floor|Ceil|Trunc|Fract|Find[ISU].*|ModfStruct|FrexpStruct|Ldexp|N(Min|Max|Clamp)|Step)$/ { why = "not exact" }
$3 == "OpFunction" { functions++ }
why { print why ": " $0; found = 1 }
END {
  if (!functions) { print "no SPIR-V"; exit 2 }
  exit found
}'
