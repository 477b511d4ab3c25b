#include "tools/lightgrid/embree_lines.h"

#include "libcommon/trace/tracer.h"
#include "tools/lightgrid/cpu_lines.h"

namespace tdpt {
namespace {

struct EmbreeRays {
  std::unique_ptr<Tracer> tracer;

  bool segment_blocked(const Vec3f& a, const Vec3f& b, uint32_t coin) const {
    return tracer->segment_blocked(a, b, coin);
  }
  bool first_hit(const Vec3f& origin, const Vec3f& w, uint32_t coin,
                 shader::SurfaceHit& hit) const {
    Tracer::FloatHit found;
    if (!tracer->first_hit(origin, w, coin, found)) return false;
    hit = {found.t, found.triangle, found.b1, found.b2, found.back ? 1u : 0u};
    return true;
  }
};

}  // namespace

std::unique_ptr<LineTracer> make_embree_lines(const Scene& scene, const LineTables& tables,
                                              const LightGrid& grid, uint64_t seed) {
  return std::make_unique<CpuLines<EmbreeRays>>(EmbreeRays{std::make_unique<Tracer>(scene)}, scene,
                                                tables, grid, seed);
}

}  // namespace tdpt
