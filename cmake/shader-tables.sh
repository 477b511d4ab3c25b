#!/bin/sh
# shader-tables.sh TABLES HEADER... : GLSL that reads records as texels, each with one fetch for four words. Some devices
# read those several times as fast as buffers, all at least as fast.
#
# TABLES has lines "BINDING TYPE NAME", # and what follows it is left out; TYPE is uint, float, or a struct of one of
# the headers whose members are vec3, uint, int or float and lie as in std430. Written is, for each,
#   layout(binding = BINDING) uniform usamplerBuffer NAME_texels;
#   TYPE load_NAME(uint i)
# Texels have four words (tdpt::gpu::Texels::quads), those of records that are no multiple of four words one (words).
set -e
tables=${1:?usage: shader-tables.sh TABLES HEADER...}
shift
cat "$@" | awk -v tables="$tables" '
  function fail(text) { print tables ": " text >"/dev/stderr"; failed = 1; exit 1 }
  function as(type, words) {
    return type == "uint" ? words : type == "int" ? "int(" words ")" : "uintBitsToFloat(" words ")"
  }
  { sub(/\/\/.*/, "") }
  /^struct / { name = $(NF - 1); members[name] = 0; size[name] = 0; next }
  /^};/ { name = ""; next }
  name != "" && NF >= 2 {
    line = $0
    gsub(/[;,]/, " ", line)
    n = split(line, word, " ")
    for (i = 2; i <= n; ++i) {
      long = word[1] == "vec3" ? 3 : 1
      if (long == 3) size[name] = int((size[name] + 3) / 4) * 4
      if (line !~ /^ *(vec3|uint|int|float) [a-z0-9_ ]+$/) other[name] = line
      k = members[name]++
      type[name, k] = word[1]
      member[name, k] = word[i]
      at[name, k] = size[name]
      size[name] += long
    }
  }
  END {
    if (failed) exit 1
    while ((getline line <tables) > 0) {
      sub(/#.*/, "", line)
      if (split(line, word, " ") == 0) continue
      t = word[2]
      texels = word[3] "_texels"
      print "layout(binding = " word[1] ") uniform usamplerBuffer " texels ";"
      print t " load_" word[3] "(uint i) {"
      if (t == "uint" || t == "float") {
        print "  return " as(t, "texelFetch(" texels ", int(i)).x") ";\n}"
        continue
      }
      if (!(t in members)) fail("no header has a struct " t)
      if (t in other) fail("in " t ": \"" other[t] "\" is nothing that a table holds")
      quads = size[t] % 4 == 0
      n = quads ? size[t] / 4 : size[t]
      for (k = 0; k < n; ++k)
        print "  " (quads ? "uvec4 w" : "uint w") k " = texelFetch(" texels ", int(i * " n "u + " k "u))" (quads ? "" : ".x") ";"
      print "  " t " r;"
      for (k = 0; k < members[t]; ++k) {
        w = at[t, k]
        if (quads)
          words = "w" int(w / 4) "." (type[t, k] == "vec3" ? "xyz" : substr("xyzw", w % 4 + 1, 1))
        else
          words = "w" w
        if (!quads && type[t, k] == "vec3") fail("in " t ": a vec3 in a record of no whole number of texels")
        print "  r." member[t, k] " = " as(type[t, k], words) ";"
      }
      print "  return r;\n}"
    }
  }'
