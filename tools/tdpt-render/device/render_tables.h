// All that kernels know of a world, as flat tables.
#pragma once
#include <span>

#include "libcommon/scene/surface_tables.h"
#include "libcommon/trace/bvh.h"
#include "shaders/shared/path/tables.h"
#include "tools/tdpt-render/device/light_tables.h"
#include "tools/tdpt-render/device/portal_tables.h"

namespace tdpt {

struct RenderTables {
  /// As the world is now: portals and shares of lights that change later need tables of their own.
  explicit RenderTables(const World& world);
  /// Takes the portals and the shares of lights that the world has now; the rest of it is as it
  /// was.
  void follow(const World& world);

  double radiance_unit;  ///< radiance in the tables is over it, a power of two
  SurfaceTables surfaces;
  std::vector<float> surface_curves, sheen_curves;  ///< the latter where there is sheen
  LightTables lights;
  PortalTables portals;
  Bvh bvh;
};

namespace shader {
/// Each of a scene's tables, by the name that kernels have for it.
struct SceneSpans {
  explicit SceneSpans(const RenderTables& tables);
#define SPAN(type, name, array) std::span<const type> array;
  SCENE_TABLES(SPAN)
#undef SPAN
};
}  // namespace shader

}  // namespace tdpt
