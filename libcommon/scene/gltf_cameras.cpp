#include "libcommon/scene/gltf_cameras.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace tdpt::gltf {
namespace {

/// The camera's name, else its node's; a number is added to one that is taken.
std::string name_of(const std::string& camera, const std::string& node,
                    const std::vector<Camera>& others) {
  const auto taken = [&](const std::string& name) {
    return std::any_of(others.begin(), others.end(),
                       [&](const Camera& c) { return c.name == name; });
  };
  for (const std::string& name : {camera, node})
    if (!name.empty() && !taken(name)) return name;
  const std::string base = !camera.empty() ? camera : !node.empty() ? node : "camera";
  std::string name = base;
  for (size_t k = 1; taken(name); ++k) name = fmt::format("{}.{}", base, k);
  return name;
}

}  // namespace

std::optional<Camera> read_camera(const Document& d, const PlacedNode& n,
                                  const std::vector<Camera>& others) {
  const tinygltf::Node& node = d.model.nodes[n.node];
  if (node.camera < 0) return {};
  const tinygltf::Camera& c = d.model.cameras[static_cast<size_t>(node.camera)];
  if (c.type != "perspective") return {};
  const Affine& a = n.to_world;
  Camera out;
  out.position = a.t;
  const auto direction = [&](const Vec3d& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    const Vec3d scaled = v / largest;
    if (!(largest > 0) || !is_finite(scaled) || !(length(scaled) > 1e-9))
      d.fail(place("nodes", n.node), "holds a camera, but its transform is flat");
    return normalize(scaled);
  };
  out.forward = direction(-a.z);
  out.right = direction(cross(out.forward, direction(a.y)));
  out.up = cross(out.right, out.forward);
  out.yfov = c.perspective.yfov;
  out.aspect = c.perspective.aspectRatio;
  out.name = name_of(c.name, node.name, others);
  return out;
}

}  // namespace tdpt::gltf
