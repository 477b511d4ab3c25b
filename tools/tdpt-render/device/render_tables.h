// All that kernels know of a world, as flat tables.
#pragma once
#include "libcommon/scene/surface_tables.h"
#include "libcommon/trace/bvh.h"
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
  std::vector<float> curves;  ///< surface_curves[]
  LightTables lights;
  PortalTables portals;
  Bvh bvh;
};

}  // namespace tdpt
