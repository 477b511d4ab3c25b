#!/bin/sh
# shader-tables_test.sh: what shader-tables.sh makes of a few records, and that it refuses what texels cannot hold.
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0

cat >"$work/records.h" <<'EOF'
/// Members in whole texels.
struct Place {
  vec3 at;  ///< a place
  float far;
};
struct Record {
  uint first;
  int second, third;  // two
  float fourth;
  Place place;
  vec3 alone;
  uint last;
};
struct Short {
  vec3 two_texels;
  float and_a_word;
  uint more;
};
struct Lone {
  float a;
  vec3 b;
};
struct Holds {
  uint x;
  Lone lone;
};
struct Many {
  uint words[4];
};
EOF

# made TABLES: into $work/out; what was said into $work/said.
made() {
  printf '%s\n' "$1" >"$work/some.tables"
  rm -f "$work/out"
  sh "$here/shader-tables.sh" "$work/out" "$work/some.tables" "$work/records.h" 2>"$work/said"
}
# has LINE...: one behind the other.
has() {
  for line in "$@"; do
    grep -qxF -- "$line" "$work/out" || { echo "missing: $line"; cat "$work/out"; failed=1; }
  done
}
# refused TABLES PATTERN: a line that matches is said, and nothing made.
refused() {
  if made "$1" || [ -e "$work/out" ] || ! grep -q "$2" "$work/said"; then
    echo "'$1' is not refused by: $2"
    cat "$work/said"
    failed=1
  fi
}

made '# Of the scene.
texels 3 scene
word uint  # one of four
share float
four uvec4
record Record
texels 4 other
place Place' || { cat "$work/said"; failed=1; }
has 'layout(binding = 3) uniform usamplerBuffer scene_texels;' \
  'layout(binding = 4) uniform usamplerBuffer other_texels;' \
  'uint load_word(uint i) {' \
  '  uvec4 w = texelFetch(scene_texels, int(first_texel(0u) + (i >> 2)));' \
  '  return w[i & 3u];' \
  'float load_share(uint i) {' \
  '  return uintBitsToFloat(w[i & 3u]);' \
  '  return texelFetch(scene_texels, int(first_texel(2u) + i));' \
  'Record load_record(uint i) {' \
  '  uint at = first_texel(3u) + i * 3u;' \
  '  r.first = w0.x;' \
  '  r.second = int(w0.y);' \
  '  r.third = int(w0.z);' \
  '  r.fourth = uintBitsToFloat(w0.w);' \
  '  r.place.at = uintBitsToFloat(w1.xyz);' \
  '  r.place.far = uintBitsToFloat(w1.w);' \
  '  r.alone = uintBitsToFloat(w2.xyz);' \
  '  r.last = w2.w;' \
  'Place load_place(uint i) {' \
  '  uvec4 w0 = texelFetch(other_texels, int(at + 0u));'

refused 'texels 0 t
a Absent' 'no header has a struct Absent'
refused 'texels 0 t
a Short' 'Short has 5 words, which is no whole number of texels'
refused 'texels 0 t
a Many' 'in Many: .*words.4.* is nothing that a table holds'
refused 'texels 0 t
a Holds' 'in Holds: .*Lone lone.* is nothing that a table holds'
refused 'a uint' 'a stands before any texels'
rm "$work/records.h"
refused 'texels 0 t
a uint' 'records.h: cannot be read'
if sh "$here/shader-tables.sh" "$work/out" "$work/absent.tables" "$work/some.tables" 2>"$work/said" ||
    ! grep -q 'absent.tables: cannot be read' "$work/said"; then
  echo "tables that are not there are read"
  failed=1
fi
exit $failed
