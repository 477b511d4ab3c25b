#!/bin/sh
# house-rules.sh ROOT: checks who may include whom. Prints every line that breaks a rule; exit 1 if any.
#   A tool includes libcommon, shaders/shared and itself, never another tool.
#   shaders/ is below them all: kernels and the headers they share with C++ include only shaders/, and every
#   shared header undefines the macros of language.h.
#   A room of libcommon includes itself and rooms before it; testing is for tests and bench.
#   So do the rooms of tdpt-render; testing/ and bench/ of any tool are included by tests only.
#   Each heavy library has one home.
#   Functions that only Linux has are called in libcommon/base only (doc/systems.md).
#   A planted fault, struct ...Faults, is defined by tests only; the class that it modifies declares it a friend.
#   A test has a namespace of its own, NAME_test: the tests of a program are compiled six files at a time.
cd "${1:?usage: house-rules.sh ROOT}" || exit 2
found=$(mktemp) && all=$(mktemp) || exit 2
trap 'rm -f "$found" "$all"' EXIT

# Lines "file:number:included", without quotes and angle brackets.
grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<]' --include='*.h' --include='*.cpp' \
  --include='*.inl' --include='*.comp' --include='*.glsl' tools libcommon shaders bench 2>/dev/null |
  sed -E 's/^([^:]*:[0-9]+:)[^"<]*["<]([^">]*)[">].*/\1\2/' >"$all"
[ -s "$all" ] || { echo "house-rules: no sources under $1"; exit 2; }

awk -F: '
# The room, such as path/bsdf of tools/tdpt-render/path/bsdf/coat.h; `part` holds the components of that path.
function room_of(part) { return part[3] == "path" ? part[3] "/" part[4] : part[3] }
function bad(why) { print $1 ":" $2 ": " $3 " is included, but " why }
BEGIN {
  before["base"] = " "
  before["cli"] = " base "
  before["math"] = " base "
  before["scene"] = " base cli math "
  before["flow"] = " base math "
  before["formats"] = before["trace"] = before["gpu"] = " base cli math scene flow "
  before["film"] = " base math formats "
  before["denoise"] = " base math scene formats film "
  before["draw"] = " base cli math scene formats trace "
  before["options"] = " base cli math scene formats "
  before["testing"] = " base cli math scene flow formats trace gpu denoise film draw options "
  inside["portals"] = " "
  inside["path/bsdf"] = " portals "
  inside["path/light"] = " portals path/bsdf "
  inside["path/sample"] = " portals path/bsdf path/light "
  inside["integrators"] = " portals path/bsdf path/light path/sample "
  inside["plan"] = inside["device"] = inside["integrators"] "integrators "
  inside["run"] = inside["plan"] "plan device "
  inside["main.cpp"] = inside["run"] "run "
  # Included header -> where it may be included.
  home["^draco/"] = "^libcommon/(scene/gltf/draco[.]cpp$|testing/files/compress)"
  home["^meshoptimizer[.]h"] = "^libcommon/(scene/gltf/meshopt[.]cpp$|testing/files/compress)"
  home["^webp/"] = "^libcommon/(scene/gltf/images[.]cpp$|testing/files/compress)"
  home["^embree"] = "^libcommon/trace/embree[.]h$"
  home["^vulkan/"] = "^libcommon/gpu/"
  home["^openvdb/"] = "^libcommon/formats/light_grid"
  home["^(OpenEXR/|Imf)"] = "^libcommon/formats/picture"
  home["^CLI/"] = "^libcommon/cli/"
  home["^(cairo|pango)"] = "^libcommon/draw/canvas[.]cpp$"
  home["^OpenMesh/"] = "^tools/ffgraph/"
  home["^CGAL/"] = "^tools/portalfit/"
  home["^pugixml"] = "^tools/tdpt-import/mitsuba/"
}
{
  split($1, from, "/")
  split($3, to, "/")
  test = $1 ~ /_(test|bench|fuzz)\.cpp$/ || $1 ~ /^bench\/|\/(testing|bench)\// || $1 ~ /\/test_[^\/]*\.h$/
  if (to[1] == "tools") {
    if (from[1] != "tools") bad("nothing outside a tool includes a tool")
    else if (from[2] != to[2]) bad("a tool never includes another")
    else if (to[3] ~ /^(testing|bench)$/ && !test) bad(to[3] "/ is for tests only")
    else if (to[2] == "tdpt-render" && !test) {
      here = room_of(from)
      there = room_of(to)
      if (here != there && index(inside[here], " " there " ") == 0)
        bad("tdpt-render/" here " may only include rooms before it")
    }
  }
  if (($1 ~ /^shaders\// && !test || $1 ~ /\.(comp|glsl)$/) && (to[1] == "libcommon" || to[1] == "tools"))
    bad("shaders/ is below libcommon and the tools")
  if ($1 ~ /^shaders\/.*\.h$/) {
    if ($3 ~ /\/language_end\.h$/) delete open[$1]
    else if ($1 in open) bad("language.h comes last: others end its macros")
    if ($3 ~ /\/language\.h$/) open[$1] = $2
  }
  if (to[1] == "bench" && from[1] != "bench") bad("nothing outside bench includes bench")
  if (to[1] == "libcommon") {
    if (to[2] == "testing") {
      if (!test) bad("testing is for tests only")
    } else if (from[1] == "libcommon" && from[2] != to[2] && !test &&
               index(before[from[2]], " " to[2] " ") == 0)
      bad("libcommon/" from[2] " may only include rooms before it")
  }
  if (to[1] == ".." || $3 ~ /\/\.\.\//) bad("includes are written from the root")
  for (library in home)
    if ($3 ~ library && $1 !~ home[library]) bad("its home is " home[library])
}
END {
  for (file in open) print file ":" open[file] ": language.h is included, but language_end.h is not"
}' "$all" >"$found"
{
  grep -rnE '(struct|class) +[A-Za-z]*Faults[^;]*$' --include='*.h' --include='*.cpp' tools libcommon shaders 2>/dev/null |
    grep -vE '^[^:]*(/testing/|_test[.])'
  grep -rlE '^(TEST|TEST_[FP])\(' --include='*_test.cpp' tools libcommon shaders 2>/dev/null | while read -r file; do
    name=$(basename "$file" .cpp | tr - _)
    grep -qE "^namespace ([a-z:]*::)?$name \{" "$file" || echo "$file:1: has no namespace $name of its own"
  done
  grep -rnE '"/proc/|O_TMPFILE|::(pipe2|prctl|syscall|renameat2)\(' --include='*.h' --include='*.cpp' tools libcommon shaders 2>/dev/null |
    grep -vE '^(libcommon/base/|[^:]*(/testing/|_test[.]))' | sed 's/$/  [only Linux has that: libcommon\/base]/'
} >>"$found"
cat "$found"
[ ! -s "$found" ]
