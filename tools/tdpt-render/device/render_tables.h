// Everything kernels know of a vista, as flat tables.
#pragma once
#include <span>

#include "libcommon/scene/surface_tables.h"
#include "libcommon/trace/bvh.h"
#include "shaders/shared/path/tables.h"
#include "tools/tdpt-render/device/light_tables.h"
#include "tools/tdpt-render/device/portal_tables.h"

namespace tdpt {

struct RenderTables {
  explicit RenderTables(const Vista& vista);
  /// Takes over the openings of `vista`; its world must be the same.
  void follow(const Vista& vista);

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
