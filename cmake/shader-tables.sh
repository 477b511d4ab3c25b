#!/bin/sh
# shader-tables.sh OUT TABLES HEADER... : GLSL that reads records as texels, one fetch for four words. Some devices read
# those several times as fast as storage buffers, and all tables of a file need no more than a binding or two.
#
# TABLES has lines, in which # and what follows it is left out,
#   texels BINDING NAME   the tables that follow lie in one buffer, `usamplerBuffer NAME_texels` with four words a texel
#   NAME TYPE             TYPE is uint, float, uvec4, or a struct of one of the headers whose members are vec3, uint, int,
#                         float or such structs, which lie as in std430 and in C++, in whole texels
# OUT gets, for the table of number n (from 0, through the file), TYPE load_NAME(uint i); it is read behind
#   uint first_texel(uint n), where table n begins in its buffer.
set -e
fail() { echo "$1" >&2; exit 1; }
out=${1:?usage: shader-tables.sh OUT TABLES HEADER...}
tables=${2:?}
shift 2
for file in "$tables" "$@"; do [ -r "$file" ] || fail "$file: cannot be read"; done
cat "$@" | awk -v tables="$tables" '
  function fail(text) { print tables ": " text >"/dev/stderr"; failed = 1; exit 1 }
  function as(type, words) {
    return type ~ /^u/ ? words : type == "int" ? "int(" words ")" : "uintBitsToFloat(" words ")"
  }
  function fetch(place) { return "texelFetch(" texels ", int(" place "))" }
  function add(name, member_type, member_name,   k) {
    if (member_type == "vec3") {
      size[name] = int((size[name] + 3) / 4) * 4
      has_vec3[name] = 1
    }
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
    if (!(word[1] in members) && line !~ /^ *(vec3|uint|int|float) [A-Za-z0-9_ ]+$/) other[name] = line
    for (i = 2; i <= n; ++i) {
      # What has a vec3 begins a texel, and ends one.
      if (has_vec3[word[1]] && (size[name] % 4 != 0 || size[word[1]] % 4 != 0)) other[name] = line
      if (word[1] in members)
        for (j = 0; j < members[word[1]]; ++j) add(name, type[word[1], j], word[i] "." member[word[1], j])
      else
        add(name, word[1], word[i])
    }
  }
  END {
    if (failed) exit 1
    while ((getline line <tables) > 0) {
      sub(/#.*/, "", line)
      if (split(line, word, " ") == 0) continue
      if (word[1] == "texels") {
        texels = word[3] "_texels"
        print "layout(binding = " word[2] ") uniform usamplerBuffer " texels ";"
        continue
      }
      t = word[2]
      if (texels == "") fail(word[1] " stands before any texels")
      first = "first_texel(" number++ "u)"
      print t " load_" word[1] "(uint i) {"
      if (t == "uvec4") {
        print "  return " fetch(first " + i") ";\n}"
        continue
      }
      if (t == "uint" || t == "float") {
        print "  uvec4 w = " fetch(first " + (i >> 2)") ";\n  return " as(t, "w[i & 3u]") ";\n}"
        continue
      }
      if (!(t in members)) fail("no header has a struct " t)
      if (t in other) fail("in " t ": \"" other[t] "\" is nothing that a table holds")
      if (size[t] % 4 != 0) fail(t " has " size[t] " words, which is no whole number of texels")
      n = size[t] / 4
      print "  uint at = " first " + i * " n "u;"
      for (k = 0; k < n; ++k) print "  uvec4 w" k " = " fetch("at + " k "u") ";"
      print "  " t " r;"
      for (k = 0; k < members[t]; ++k) {
        w = at[t, k]
        words = "w" int(w / 4) "." (type[t, k] == "vec3" ? "xyz" : substr("xyzw", w % 4 + 1, 1))
        print "  r." member[t, k] " = " as(type[t, k], words) ";"
      }
      print "  return r;\n}"
    }
  }' >"$out.part"
mv "$out.part" "$out"
