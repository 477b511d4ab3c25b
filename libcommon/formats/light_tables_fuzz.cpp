// Parses arbitrary bytes as a table of a light grid. A table that was read must lie in its box and
// round-trip.
#include "libcommon/formats/light_tables.h"

#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

namespace {

bool same(const LightLine& a, const LightLine& b) {
  return a.cut == b.cut && a.light == b.light && a.camera == b.camera;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using testing::require;
  const std::string text(testing::text_of(data, size));
  LightGrid a;
  if (!testing::reads([&] { a = parse_light_tables({{"input", text}}); })) return 0;
  size_t voxels = 1;
  for (const int side : a.dim) voxels *= static_cast<size_t>(side);
  require(a.count.size() == voxels && a.air.size() == voxels && a.direction.size() == voxels,
          "a voxel has all three values");
  if (voxels > 4096) return 0;  // larger grids take too long
  for (size_t v = 0; v < voxels; ++v)
    require(a.count[v] >= 0 && is_finite(a.direction[v]), "counts and directions are finite");
  std::vector<TableText> texts;
  for (const std::string& name : light_table_names())
    texts.push_back({name, light_table_text(a, name)});
  const LightGrid b = parse_light_tables(texts);
  require(a.dim == b.dim && a.voxel == b.voxel && a.origin == b.origin && a.count == b.count &&
              a.air == b.air && a.direction == b.direction,
          "voxels come back");
  require(a.cuts == b.cuts && a.bottleneck == b.bottleneck && a.reason == b.reason &&
              a.scene_hash == b.scene_hash && a.cameras == b.cameras,
          "what is said of the grid comes back");
  require(a.lines.size() == b.lines.size() && a.probes.size() == b.probes.size(),
          "lines come back");
  for (size_t l = 0; l < a.lines.size(); ++l)
    require(same(a.lines[l], b.lines[l]), "a line comes back");
  for (size_t l = 0; l < a.probes.size(); ++l)
    require(same(a.probes[l].line, b.probes[l].line) && a.probes[l].joins == b.probes[l].joins,
            "a probe comes back");
  return 0;
}
