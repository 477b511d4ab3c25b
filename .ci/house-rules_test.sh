#!/bin/sh
# house-rules_test.sh: every rule of house-rules.sh detects a planted violation and accepts good code.
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0

# expect STATUS FILE INCLUDED ...
expect() {
  wanted=$1 file=$2
  shift 2
  rm -rf "$work/root"
  mkdir -p "$work/root/tools" "$work/root/libcommon" "$work/root/$(dirname "$file")"
  printf '#include %s\n' "$@" >"$work/root/$file"
  sh "$here/house-rules.sh" "$work/root" >"$work/said"
  status=$?
  if [ "$status" != "$wanted" ]; then
    echo "$file with $*: exit code $status, expected $wanted"
    cat "$work/said"
    failed=1
  fi
}

expect 0 tools/mincut/main.cpp '"libcommon/formats/cut.h"'
expect 0 tools/mincut/main.cpp '"tools/mincut/max_flow.h"'
expect 1 tools/mincut/main.cpp '"tools/ffgraph/patches.h"'
expect 1 tools/mincut/main.cpp '"libcommon/testing/rooms/rooms.h"'
expect 0 tools/mincut/max_flow_test.cpp '"libcommon/testing/rooms/rooms.h"'
expect 0 libcommon/testing/rooms/room_bench.h '"libcommon/testing/rooms/known_rooms.h"'
expect 1 libcommon/testing/rooms/portals_bench.cpp '"tools/portalfit/hull.h"'
expect 1 tools/mincut/main.cpp '"../ffgraph/patches.h"'
expect 1 libcommon/formats/cut.cpp '"tools/mincut/max_flow.h"'
expect 1 tools/lightgrid/lightgrid.cpp '"tools/lightgrid/testing/scalar_lines.h"'
expect 0 tools/lightgrid/line_tracer_test.cpp '"tools/lightgrid/testing/scalar_lines.h"'
expect 0 tools/tdpt-render/path/bsdf/coat.h '"tools/tdpt-render/path/bsdf/ggx.h"'
expect 0 tools/tdpt-render/path/light/window_sky.h '"tools/tdpt-render/path/bsdf/point.h"'
expect 1 tools/tdpt-render/path/bsdf/point.h '"tools/tdpt-render/path/light/next_event.h"'
expect 1 tools/tdpt-render/portals/portals.h '"tools/tdpt-render/path/bsdf/point.h"'
expect 1 tools/tdpt-render/plan/plan.h '"tools/tdpt-render/device/room.h"'
expect 1 tools/tdpt-render/run/job.h '"tools/tdpt-render/testing/oracle.h"'
expect 0 tools/tdpt-render/run/job_test.cpp '"tools/tdpt-render/testing/oracle.h"'
expect 0 tools/tdpt-render/main.cpp '"tools/tdpt-render/run/job.h"'
expect 0 libcommon/scene/scene.h '"libcommon/math/vec.h"'
expect 1 libcommon/math/vec.h '"libcommon/scene/scene.h"'
expect 0 libcommon/formats/dimacs.h '"libcommon/flow/max_flow.h"'
expect 1 libcommon/flow/series_cut.h '"libcommon/formats/dimacs.h"'
expect 0 libcommon/math/vec.h '"shaders/shared/vector.h"'
expect 1 shaders/shared/types.h '"libcommon/math/vec.h"'
expect 1 shaders/light_march.comp '"libcommon/math/vec.h"'
expect 1 shaders/light_bindings.glsl '"tools/lightgrid/line_kernel.h"'
expect 1 libcommon/gpu/gpu_test.comp '"libcommon/math/vec.h"'
expect 0 shaders/shared/shared_test.cpp '"libcommon/math/rng.h"'
expect 0 shaders/shared/warp.h '"shaders/shared/real.h"' '"shaders/shared/language.h"' '"shaders/shared/language_end.h"'
expect 1 shaders/shared/warp.h '"shaders/shared/language.h"'
expect 1 shaders/shared/warp.h '"shaders/shared/language.h"' '"shaders/shared/real.h"' '"shaders/shared/language_end.h"'
expect 1 libcommon/formats/cut.h '"libcommon/trace/tracer.h"'
expect 1 libcommon/base/file.cpp '"libcommon/cli/cli.h"'
expect 0 libcommon/trace/embree.h '<embree3/rtcore.h>'
expect 1 libcommon/trace/tracer.cpp '<embree4/rtcore.h>'
expect 1 tools/tdpt-render/run/render.cpp '<embree3/rtcore.h>'
expect 1 tools/ffgraph/main.cpp '<CGAL/convex_hull_2.h>'
expect 1 tools/portalfit/plane.cpp '<OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>'
expect 1 tools/lightgrid/march.cpp '<openvdb/openvdb.h>'
expect 1 tools/tdpt-render/film.cpp '<OpenEXR/ImfHeader.h>'
expect 1 tools/tdpt-render/main.cpp '<CLI/CLI.hpp>'
expect 0 libcommon/scene/gltf/draco.cpp '<draco/compression/decode.h>'
expect 1 libcommon/scene/gltf/meshopt.cpp '<draco/compression/decode.h>'
expect 1 libcommon/scene/gltf/document.cpp '<meshoptimizer.h>'
expect 1 libcommon/scene/gltf/textures.cpp '<webp/decode.h>'
expect 1 tools/lightgrid/gpu.cpp '<vulkan/vulkan.h>'
expect 0 libcommon/draw/canvas.cpp '<pango/pangocairo.h>'
expect 1 libcommon/draw/drawing.cpp '<cairo.h>'
expect 1 tools/portalfit/preview.cpp '<pango/pangocairo.h>'
expect 0 tools/tdpt-render/testing/faults.h '"tools/tdpt-render/portals/portals.h"
struct PortalSetFaults {'
expect 0 tools/tdpt-render/portals/portals.h '"libcommon/math/vec.h"
  friend struct PortalSetFaults;  // of tests'
expect 1 tools/tdpt-render/portals/portals.h '"libcommon/math/vec.h"
struct PortalSetFaults {'
expect 0 libcommon/math/vec_test.cpp '<gtest/gtest.h>
namespace tdpt::vec_test {
TEST(Vec, adds) {}'
expect 1 libcommon/math/vec_test.cpp '<gtest/gtest.h>
namespace tdpt {
TEST(Vec, adds) {}'
expect 0 libcommon/base/output_file.cpp '<fcntl.h>
const int fd = ::open(folder, O_TMPFILE);'
expect 1 libcommon/cli/told.cpp '<fcntl.h>
const int fd = ::open(folder, O_TMPFILE);'
exit $failed
