// Where Tungsten's (u, v) grow, with v = 0 in an image's bottom row and phi = (u - 1/2) 2 pi:
// sphere: phi about z from x towards y, v = theta / pi from +z; disk: phi about the normal from the
// frame's bitangent towards its tangent, v = r / R; cylinder: phi about y from x towards z, v along
// y, on caps x and z; quad: x and z; cube: on the faces across axis i, axes i + 1 and i + 2.
#include "tools/tdpt-import/tungsten/shapes.h"

#include <cmath>
#include <numbers>

#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign::tungsten {
namespace {

using std::numbers::pi;

Mesh with_flipped_v(Mesh mesh) {
  flip_v(mesh);
  return mesh;
}

Mesh ball() {
  return with_flipped_v(sphere());
}

Mesh disk() {
  return with_flipped_v(disc());
}

std::array<float, 2> in_image(float u, float v) {  // of -1..1
  return {(1 + u) / 2, (1 - v) / 2};
}

Mesh box() {
  Mesh mesh = cube();
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3f p = mesh.positions[i], n = mesh.normals[i];
    mesh.uv[i] = n.x != 0 ? in_image(p.y, p.z) : n.y != 0 ? in_image(p.z, p.x) : in_image(p.x, p.y);
  }
  return mesh;
}

// Of diameter 1, from z = 0 to 1; caps are turned by half as the shape is [placed()].
Mesh tube(bool is_capped) {
  Mesh mesh = cylinder();
  for (const float z : {1.0f, 0.0f}) {
    const Mesh cap = is_capped ? disc() : Mesh{};
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const Vec3f& p : cap.positions) {
      mesh.positions.push_back({p.x, p.y, z});
      mesh.normals.push_back({0, 0, 2 * z - 1});
      mesh.uv.push_back(in_image(-p.x, -p.y));
    }
    for (auto [a, b, c] : cap.triangles) {
      if (z == 0) std::swap(b, c);
      mesh.triangles.push_back({first + a, first + b, first + c});
    }
  }
  for (Vec3f& p : mesh.positions) p.x /= 2, p.y /= 2;
  return mesh;
}

Mesh open_tube() {
  return tube(false);
}

Mesh capped_tube() {
  return tube(true);
}

}  // namespace

Affine rotation_in(const Affine& map, const Node& node) {
  for (const Vec3d& axis : {map.x, map.y, map.z})
    if (!(dot(axis, axis) > 0)) node.fail("has an axis of length 0");
  return {normalize(map.x), normalize(map.y), normalize(map.z), {}};
}

// The round meshes have phi = 0 where u = 0, so they are turned by half.
std::optional<Placed> placed(const Node& node, const std::string& type, const Affine& map) {
  if (type == "quad") return Placed{square, map * Affine{{.5, 0, 0}, {0, 0, .5}, {0, .5, 0}, {}}};
  if (type == "cube") return Placed{box, map * Affine{{.5, 0, 0}, {0, .5, 0}, {0, 0, .5}, {}}};
  if (type != "sphere" && type != "disk" && type != "cylinder") return {};
  const Affine turn = rotation_in(map, node);
  const double across = std::max(length(map.x), length(map.z)), along = length(map.y);
  if (type == "sphere") {
    const double r = std::max(across, along);
    return Placed{ball, {turn.x * -r, turn.y * -r, turn.z * r, map.t}};
  }
  if (type == "disk") {
    const Onb<double> frame(turn.y);
    return Placed{disk, {frame.y * -across, frame.x * -across, turn.y, map.t}};
  }
  const bool is_capped = node.flag("capped", true);
  return Placed{is_capped ? capped_tube : open_tube,
                {turn.x * -across, turn.z * -across, map.y, map.t - map.y / 2.0},
                is_capped ? 0 : pi / 2 * across * across};
}

}  // namespace tdpt::foreign::tungsten
