#!/bin/sh
# shader-tables.sh OUT TABLES HEADER... : GLSL that reads records as texels, each with one fetch for four words. Some devices
# read those several times as fast as buffers, all at least as fast.
#
# TABLES has lines "BINDING TYPE NAME", # and what follows it is left out; TYPE is uint, float, uvec4, or a struct of one of
# the headers whose members are vec3, uint, int, float or such structs and lie as in std430. Written is, for each,
#   layout(binding = BINDING) uniform usamplerBuffer NAME_texels;
#   TYPE load_NAME(uint i)
# Texels have four words (tdpt::gpu::Texels::quads), those of records that are no multiple of four words one (words).
set -e
out=${1:?usage: shader-tables.sh OUT TABLES HEADER...}
tables=${2:?}
shift 2
cat "$@" | awk -v tables="$tables" '
  function fail(text) { print tables ": " text >"/dev/stderr"; failed = 1; exit 1 }
  function as(type, words) {
    return type ~ /^u/ ? words : type == "int" ? "int(" words ")" : "uintBitsToFloat(" words ")"
  }
  function add(name, member_type, member_name,   k) {
    if (member_type == "vec3") size[name] = int((size[name] + 3) / 4) * 4
    k = members[name]++
    type[name, k] = member_type
    member[name, k] = member_name
    at[name, k] = size[name]
    size[name] += member_type == "vec3" ? 3 : 1
  }
  { sub(/\/\/.*/, "") }
  /^struct / { name = $(NF - 1); members[name] = 0; size[name] = 0; next }
  /^};/ { name = ""; next }
  name != "" && NF >= 2 {
    line = $0
    gsub(/[;,]/, " ", line)
    n = split(line, word, " ")
    for (i = 2; i <= n; ++i) {
      if (word[1] in members) {
        for (j = 0; j < members[word[1]]; ++j) add(name, type[word[1], j], word[i] "." member[word[1], j])
      } else {
        if (line !~ /^ *(vec3|uint|int|float) [A-Za-z0-9_ ]+$/) other[name] = line
        add(name, word[1], word[i])
      }
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
      if (t == "uint" || t == "float" || t == "uvec4") {
        print "  return " as(t, "texelFetch(" texels ", int(i))" (t == "uvec4" ? "" : ".x")) ";\n}"
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
  }' >"$out.part"
mv "$out.part" "$out"
