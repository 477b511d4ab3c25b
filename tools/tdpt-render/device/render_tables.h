// Everything kernels know of a world, as flat tables.
#pragma once
#include <span>

#include "libcommon/scene/surface_tables.h"
#include "libcommon/trace/bvh.h"
#include "shaders/shared/path/tables.h"
#include "tools/tdpt-render/device/light_tables.h"
#include "tools/tdpt-render/device/portal_tables.h"

namespace tdpt {

struct RenderTables {
  /// Of the world as it is now: if portals or light probabilities change later, call follow().
  explicit RenderTables(const World& world);
  /// Updates the portals and light probabilities; the rest of the world must be unchanged.
  void follow(const World& world);

  double radiance_unit;  ///< divisor of radiance in the tables, a power of two
  SurfaceTables surfaces;
  std::vector<float> surface_curves, sheen_curves;  ///< the latter if there is sheen
  LightTables lights;
  PortalTables portals;
  Bvh bvh;
};

namespace shader {
/// Each table of a scene, by the name that kernels use.
struct SceneSpans {
  explicit SceneSpans(const RenderTables& tables);
#define SPAN(type, name, array) std::span<const type> array;
  SCENE_TABLES(SPAN)
#undef SPAN
};
}  // namespace shader

}  // namespace tdpt
