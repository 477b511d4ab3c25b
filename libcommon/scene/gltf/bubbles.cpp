#include "libcommon/scene/gltf/bubbles.h"

#include <fmt/format.h>
#include <cmath>

#include "libcommon/base/counted.h"
#include "libcommon/base/shown.h"

namespace tdpt::gltf {
namespace {

constexpr double kOpen = 1e-4;  // share of the area; above it the surface is open
// V / A^1.5 is 0.094 for a ball and 0.068 for a cube, but 0.0034 for a square pane, a box a
// hundredth as thick as wide: for that, a thin sheet on each side is right.
constexpr double kFlat = 0.01;

// The area vectors of a closed surface cancel, wherever its seams are; then the volume does not
// depend on the origin.
bool encloses(const std::vector<uint32_t>& corners, const std::vector<Vec3d>& world,
              uint32_t first) {
  Vec3d sum(0);
  double area = 0, volume = 0;
  const Vec3d origin = world[first + corners[0]];
  for (size_t i = 0; i + 2 < corners.size(); i += 3) {
    const Vec3d p = world[first + corners[i]] - origin;
    const Vec3d twice = cross(world[first + corners[i + 1]] - origin - p,
                              world[first + corners[i + 2]] - origin - p);
    sum = sum + twice * 0.5;
    area += 0.5 * length(twice);
    volume += dot(p, twice) / 6;
  }
  return length(sum) <= kOpen * area && std::abs(volume) > kFlat * std::pow(area, 1.5);
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
