// For tests: the scalar build of the kernels' code on portals, and portals to test it with.
#pragma once
#include "libcommon/math/rng.h"
#include "shaders/shared/path/words_test.h"
#include "shaders/shared/tables.h"
#include "tools/tdpt-render/device/tables.h"

namespace tdpt::shader {

/// Refers to the tables.
struct ScalarPortals {
  using Real = float;
  TABLES_OF_PORTALS(REFERS_TO)
  GuideParameters guiding;
  TrialParameters render{0.7f, 0.4f};
  bool scene_has_portals, portals_have_pairs, guide_active = true;

  explicit ScalarPortals(const PortalTables& t)
      : portal_facets(t.facets.data()),
        portal_polygons(t.polygons.data()),
        portal_corners(t.corners.data()),
        portal_pairs(t.pairs.data()),
        guiding(t.guiding),
        scene_has_portals(!t.facets.empty()),
        portals_have_pairs(!t.pairs.empty()) {}

#include "shaders/shared/path/portals.h"
  // A separate block of includes: each begins with language.h.
#include "shaders/shared/path/portals_test.h"
};

}  // namespace tdpt::shader

namespace tdpt {

/// Parallelogram about `centre` with half sides u and v; light crosses it along cross(u, v).
inline Portal plate(const Vec3d& centre, const Vec3d& u, const Vec3d& v) {
  const Vec3d p = centre - u - v;
  return {"plate", {p, p + u * 2, p + u * 2 + v * 2, p + v * 2}, {{0, 1, 2}, {0, 2, 3}}, {}};
}

/// In [-1,1]^3.
struct NamedPortals {
  std::string name;
  PortalSet set;
};
inline std::vector<NamedPortals> portals_to_try() {
  const Frame canonical{};
  const std::vector<Portal> one{plate({0.2, 0.1, 0.3}, {0, 0.25, 0}, {0.2, 0, 0.05})};
  std::vector<Portal> aside = one;
  aside.push_back(plate({-0.5, 0, 0.4}, {0, 0.3, 0}, {0, 0, 0.4}));
  aside.push_back(plate({-0.1, 0.6, 0.1}, {0.45, 0, 0}, {0, 0, 0.3}));
  aside.back().both_ways = true;
  // A slit of 1 to 80, in 12 triangles.
  Portal slit{"slit", {}, {}, {}};
  const Onb<double> onb(normalize(Vec3d(0.3, 0.8, -0.5)));
  for (int i = 0; i <= 6; ++i)
    for (const double across : {-0.005, 0.005})
      slit.vertices.push_back(onb.to_world({across, 0.8 * (i / 3.0 - 1), 0.1}));
  for (uint32_t i = 0; i < 6; ++i) {
    slit.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    slit.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  // Two layers of five by `rows` portals, one after the other on the light's way: each with each is
  // a pair.
  const auto layers = [](int rows) {
    std::vector<Portal> portals;
    for (int i = 0; i < 10 * rows; ++i)
      portals.push_back(
          plate({0.32 * (i / 2 % 5) - 0.64, 0.4 * (i / 10) - 0.2 * (rows - 1), 0.5 * (i % 2) - 0.2},
                {0.12, 0.01, 0}, {0, 0.15, 0.02}));
    return portals;
  };
  return {{"one", PortalSet(one, canonical)},
          {"aside and both ways", PortalSet(aside, canonical)},
          {"slit", PortalSet({slit}, canonical)},
          {"layers", PortalSet(layers(2), canonical)},
          {"more than a word has bits", PortalSet(layers(4), canonical)}};
}

}  // namespace tdpt
