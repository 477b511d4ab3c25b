#include "tools/lightgrid/testing/scalar_lines.h"

#include "libcommon/scene/surface_tables.h"
#include "libcommon/trace/bvh.h"
#include "shaders/shared/bvh.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/tables.h"
#include "shaders/shared/texels.h"
#include "tools/lightgrid/line_kernel.h"

namespace tdpt {
namespace shader {
namespace {

struct ScalarRays {
  LIGHT_TABLES(REFERS_TO)
  bool scene_has_coverage, coverage_has_textures;
  static constexpr bool scene_has_panes = false;

  static float opacity_at(uint, const vec3&) { return 1; }

#include "shaders/shared/coverage.h"

#include "shaders/shared/traversal.h"
};

}  // namespace
}  // namespace shader

namespace {

// Owns what its rays look at.
struct ScalarRays : shader::ScalarRays {
  const Bvh bvh;
  const CoverageTables coverage_tables;

  explicit ScalarRays(const Scene& scene)
      : bvh(build_bvh(scene)), coverage_tables(make_coverages(scene)) {
    bvh_nodes = bvh.nodes.data();
    bvh_triangles = bvh.triangles.data();
    coverage_of = coverage_tables.coverage_of.data();
    coverages = coverage_tables.coverages.data();
    texel_words = coverage_tables.texels.data();
    scene_has_coverage = !coverage_tables.coverages.empty();
    coverage_has_textures = coverage_tables.textured();
  }
};

}  // namespace

std::unique_ptr<LineTracer> make_scalar_lines(const Scene& scene, const LineTables& tables,
                                              const LightGrid& grid, uint64_t seed) {
  return std::make_unique<CpuLines<ScalarRays>>(scene, tables, grid, seed);
}

}  // namespace tdpt
