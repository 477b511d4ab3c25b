// Window panes: thin, smooth, colourless and uniform sheets. Light that is not reflected continues
// straight, so a ray may pass the pane with the probability of transmission. So not only rays that
// scatter at the glass but also connections, shadow rays and portals work through a glazed window.
#pragma once
#include <cmath>

#include "libcommon/scene/scene.h"

namespace tdpt {

struct Pane {
  float share = 0;        ///< of the light that is not reflected, transmitted; 0: not a pane
  float f0 = 0, f90 = 0;  ///< reflectance at normal and at grazing incidence (Schlick)

  explicit operator bool() const { return share > 0; }
  /// Probability that a ray hits the pane: 1 - share (1 - F); cos is its cosine to the normal.
  double opacity(double cos) const {
    const double m = 1 - std::abs(cos);
    const double f = f0 + (double{f90} - f0) * m * m * m * m * m;
    return 1 - share * (1 - f);
  }
};

inline Pane pane_of(const Material& m) {
  const auto grey = [](const Rgb& c) { return c.x == c.y && c.y == c.z; };
  const bool textured = m.maps[MAP_BASE] || m.maps[MAP_METALLIC_ROUGHNESS] || m.maps[MAP_NORMAL] ||
                        m.maps[MAP_SPECULAR] || m.maps[MAP_SPECULAR_COLOR] ||
                        m.maps[MAP_TRANSMISSION];
  if (!(m.transmission > 0) || m.solid || m.coloured || m.metallic != 0 || m.roughness >= 0.01f ||
      textured || m.alpha_mode != Material::Alpha::opaque || max_component(m.emission) > 0 ||
      !grey(m.base_color) || !grey(m.specular_color) || m.coat > 0 || m.sheened())
    return {};
  const float r = (m.ior - 1) / (m.ior + 1);
  const float f0 = std::min(r * r * m.specular_color.x, 1.0f) * m.specular;
  return {m.transmission * m.base_color.x, f0, m.ior == 1 ? 0.0f : m.specular};
}

}  // namespace tdpt
