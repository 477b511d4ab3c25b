#include "libcommon/scene/gltf_cameras.h"

#include <algorithm>
#include <cmath>

namespace tdpt::gltf {
std::optional<Camera> read_camera(const Document& d, const PlacedNode& n, DistinctNames& names) {
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
  out.name = names.take(c.name, node.name, "camera");
  return out;
}

}  // namespace tdpt::gltf
