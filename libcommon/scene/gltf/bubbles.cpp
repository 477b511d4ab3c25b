#include "libcommon/scene/gltf/bubbles.h"

#include <fmt/format.h>
#include <cmath>

#include "libcommon/base/counted.h"
#include "libcommon/base/shown.h"

namespace tdpt::gltf {
namespace {

constexpr double kOpen = 1e-4;  // share of the extent; above it the surface is open
// V / A^1.5 is 0.094 for a ball and 0.068 for a cube, but 0.0034 for a square pane, a box a
// hundredth as thick as wide: for that, a thin sheet on each side is right.
constexpr double kFlat = 0.01;

// A closed surface has no border: each edge is passed once each way, wherever the seams are, so the
// integral of any field along the edges of all triangles is 0. The field here is a wave that fits
// no symmetry: area vectors would cancel as well for panes in opposite walls, and for walls without
// a lid. Of a closed surface the volume does not depend on the origin.
bool encloses(const std::vector<uint32_t>& corners, const std::vector<Vec3d>& world,
              uint32_t first) {
  const Vec3d origin = world[first + corners[0]];
  const auto at = [&](size_t i) { return world[first + corners[i]] - origin; };
  double area = 0, volume = 0;
  for (size_t i = 0; i + 2 < corners.size(); i += 3) {
    const Vec3d p = at(i), twice = cross(at(i + 1) - p, at(i + 2) - p);
    area += 0.5 * length(twice);
    volume += dot(p, twice) / 6;
  }
  const double extent = std::sqrt(area);
  const Vec3d wave = Vec3d{1, 1.7, 2.6} / extent;
  Vec3d border(0);
  for (size_t i = 0; i + 2 < corners.size(); i += 3)
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d a = at(i + k), b = at(i + (k + 1) % 3);
      border += (b - a) * std::cos(dot(wave, a + b));
    }
  return length(border) <= kOpen * extent && std::abs(volume) > kFlat * std::pow(area, 1.5);
}

}  // namespace

void Bubbles::look_at(const Material& m, const std::vector<uint32_t>& corners,
                      const std::vector<Vec3d>& world, uint32_t first) {
  const bool thin_glass = m.transmission > 0 && !m.solid && m.ior != 1;
  if (!thin_glass || corners.empty() || !encloses(corners, world, first)) return;
  if (count_++ == 0) name_ = m.name.empty() ? "" : " (material \"" + shown(m.name, 60) + "\")";
}

std::string Bubbles::warning() const {
  if (count_ == 0) return "";
  return fmt::format(
      "{} {} light{} without a thickness (KHR_materials_volume): soap bubbles, as "
      "the format has it, not solid glass",
      tdpt::counted(count_, "closed mesh"), count_ == 1 ? "transmits" : "transmit", name_);
}

}  // namespace tdpt::gltf
