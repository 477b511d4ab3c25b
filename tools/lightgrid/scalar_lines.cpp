#include "tools/lightgrid/scalar_lines.h"

#include "libcommon/trace/bvh.h"
#include "shaders/shared/triangle.h"
#include "tools/lightgrid/cpu_lines.h"
#include "tools/lightgrid/veils.h"

namespace tdpt {
namespace shader {
namespace {

struct ScalarRays {
  const BvhNode* bvh_nodes;
  const BvhTriangle* bvh_triangles;
  const uint* veil_of;
  const Veil* veils;
  const float* texels;
  bool scene_has_veils, veils_have_textures;

#include "shaders/shared/veil.h"

#include "shaders/shared/traversal.h"
};

}  // namespace
}  // namespace shader

namespace {

// Owns what its rays look at.
struct ScalarRays : shader::ScalarRays {
  std::shared_ptr<const Bvh> bvh;
  std::shared_ptr<const VeilTables> veil_tables;

  explicit ScalarRays(const Scene& scene)
      : bvh(std::make_shared<Bvh>(build_bvh(scene))),
        veil_tables(std::make_shared<VeilTables>(make_veils(scene))) {
    bvh_nodes = bvh->nodes.data();
    bvh_triangles = bvh->triangles.data();
    veil_of = veil_tables->veil_of.data();
    veils = veil_tables->veils.data();
    texels = veil_tables->texels.data();
    scene_has_veils = !veil_tables->veils.empty();
    veils_have_textures = !veil_tables->texels.empty();
  }
};

}  // namespace

std::unique_ptr<LineTracer> make_scalar_lines(const Scene& scene, const LineTables& tables,
                                              const LightGrid& grid, uint64_t seed) {
  return std::make_unique<CpuLines<ScalarRays>>(ScalarRays(scene), scene, tables, grid, seed);
}

}  // namespace tdpt
