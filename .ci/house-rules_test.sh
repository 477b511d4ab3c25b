#!/bin/sh
# house-rules_test.sh: every rule of house-rules.sh detects a planted violation and accepts good code.
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0

# planted TREE FILE LINE ...: appends lines to a file of a tree.
planted() {
  tree=$work/$1 file=$2
  shift 2
  mkdir -p "$tree/$(dirname "$file")"
  printf '%s\n' "$@" >>"$tree/$file"
}
# good FILE INCLUDED ...; bad FILE INCLUDED: the include is to be found.
good() {
  file=$1
  shift
  for included in "$@"; do planted good "$file" "#include $included"; done
}
bad() {
  planted bad "$1" "#include $2"
  echo "$1:$(wc -l <"$work/bad/$1"):" >>"$work/expected"
}

good tools/mincut/main.cpp '"libcommon/formats/cut.h"' '"tools/mincut/max_flow.h"'
bad tools/mincut/main.cpp '"tools/ffgraph/patches.h"'
bad tools/mincut/main.cpp '"libcommon/testing/rooms/rooms.h"'
bad tools/mincut/main.cpp '"../ffgraph/patches.h"'
good tools/mincut/preview_test.cpp '"libcommon/testing/rooms/rooms.h"'
good libcommon/testing/rooms/portal_score.h '"libcommon/testing/rooms/room_plan.h"'
bad libcommon/testing/rooms/portals_bench.cpp '"tools/portalfit/hull.h"'
bad libcommon/formats/cut.cpp '"tools/mincut/max_flow.h"'
bad tools/lightgrid/lightgrid.cpp '"tools/lightgrid/testing/scalar_lines.h"'
good tools/lightgrid/line_tracer_test.cpp '"tools/lightgrid/testing/scalar_lines.h"'
good tools/tdpt-render/path/bsdf/coat.h '"tools/tdpt-render/path/bsdf/ggx.h"'
good tools/tdpt-render/path/light/window_sky.h '"tools/tdpt-render/path/bsdf/point.h"'
bad tools/tdpt-render/path/bsdf/point.h '"tools/tdpt-render/path/light/next_event.h"'
bad tools/tdpt-render/portals/portals.h '"tools/tdpt-render/path/bsdf/point.h"'
bad tools/tdpt-render/plan/plan.h '"tools/tdpt-render/device/room.h"'
bad tools/tdpt-render/run/job.h '"tools/tdpt-render/testing/oracle.h"'
good tools/tdpt-render/run/job_test.cpp '"tools/tdpt-render/testing/oracle.h"'
good tools/tdpt-render/main.cpp '"tools/tdpt-render/run/job.h"'
good libcommon/scene/scene.h '"libcommon/math/vec.h"'
bad libcommon/math/vec.h '"libcommon/scene/scene.h"'
good libcommon/formats/dimacs.h '"libcommon/flow/max_flow.h"'
bad libcommon/flow/series_cut.h '"libcommon/formats/dimacs.h"'
good libcommon/math/vec.h '"shaders/shared/vector.h"'
bad shaders/shared/types.h '"libcommon/math/vec.h"'
bad shaders/light_march.comp '"libcommon/math/vec.h"'
bad shaders/light_bindings.glsl '"tools/lightgrid/line_kernel.h"'
good shaders/shared/shared_test.cpp '"libcommon/math/rng.h"'
good shaders/shared/warp.h '"shaders/shared/real.h"' '"shaders/shared/language.h"' '"shaders/shared/language_end.h"'
bad shaders/shared/open.h '"shaders/shared/language.h"'
planted bad shaders/shared/early.h '#include "shaders/shared/language.h"'
bad shaders/shared/early.h '"shaders/shared/real.h"'
bad libcommon/formats/cut.h '"libcommon/trace/tracer.h"'
bad libcommon/base/file.cpp '"libcommon/cli/cli.h"'
good libcommon/trace/embree.h '<embree3/rtcore.h>'
bad libcommon/trace/tracer.cpp '<embree4/rtcore.h>'
bad tools/ffgraph/main.cpp '<CGAL/convex_hull_2.h>'
bad tools/portalfit/plane.cpp '<OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>'
bad tools/lightgrid/march.cpp '<openvdb/openvdb.h>'
bad tools/tdpt-render/film.cpp '<OpenEXR/ImfHeader.h>'
bad tools/tdpt-render/main.cpp '<CLI/CLI.hpp>'
good libcommon/scene/gltf/draco.cpp '<draco/compression/decode.h>'
bad libcommon/scene/gltf/document.cpp '<meshoptimizer.h>'
bad libcommon/scene/gltf/textures.cpp '<webp/decode.h>'
bad tools/lightgrid/gpu.cpp '<vulkan/vulkan.h>'
good libcommon/draw/canvas.cpp '<pango/pangocairo.h>'
bad libcommon/draw/drawing.cpp '<cairo.h>'

# found FILE LINE: a line that is no include is found.
found() {
  planted bad "$1" "$2"
  echo "$1:" >>"$work/expected"
}
planted good tools/tdpt-render/testing/faults.h 'struct PortalSetFaults {'
planted good tools/tdpt-render/portals/portals.h '  friend struct PortalSetFaults;  // of tests'
found tools/tdpt-render/portals/set.h 'struct PortalSetFaults {'
planted good libcommon/math/vec_test.cpp 'namespace tdpt::vec_test {' 'TEST(Vec, adds) {}'
found libcommon/math/rng_test.cpp 'TEST(Vec, adds) {}'
planted good libcommon/base/output_file.cpp 'const int fd = ::open(folder, O_TMPFILE);'
found libcommon/cli/told.cpp 'const int fd = ::open(folder, O_TMPFILE);'

sh "$here/house-rules.sh" "$work/good" >"$work/said" || { echo "good code is refused:"; cat "$work/said"; failed=1; }
sh "$here/house-rules.sh" "$work/bad" >"$work/said" && { echo "bad code is accepted"; failed=1; }
while read -r place; do
  grep -qF "$place" "$work/said" || { echo "not found: $place"; failed=1; }
done <"$work/expected"
exit $failed
