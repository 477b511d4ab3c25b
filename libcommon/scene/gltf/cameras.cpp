#include "libcommon/scene/gltf/cameras.h"

#include <algorithm>
#include <cmath>

namespace tdpt::gltf {

namespace {

/// `v` normalised, even if very long or short; 0 if it has no direction.
Vec3d direction_of(const Vec3d& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  const Vec3d scaled = v / largest;
  if (!(largest > 0) || !is_finite(scaled) || !(length(scaled) > 1e-9)) return {};
  return normalize(scaled);
}

}  // namespace

std::optional<Camera> read_camera(const Document& d, const PlacedNode& n, DistinctNames& names,
                                  size_t& flat) {
  const tinygltf::Node& node = d.model.nodes[n.node];
  if (node.camera < 0) return {};
  const tinygltf::Camera& c = d.model.cameras[static_cast<size_t>(node.camera)];
  if (c.type != "perspective") return {};
  Camera out;
  out.fault = n.fault;
  if (const auto it = d.camera_faults.find(node.camera); it != d.camera_faults.end())
    out.fault = it->second;
  // A flat camera takes a name, too: at another time it may not be flat.
  out.name = names.take(c.name, node.name, "camera");
  if (out.fault) return out;
  const Affine& a = n.to_world();
  out.position = a.t;
  out.forward = direction_of(-a.z);
  out.right = direction_of(cross(out.forward, direction_of(a.y)));
  if (out.right == Vec3d()) {
    ++flat;
    return {};
  }
  out.up = cross(out.right, out.forward);
  out.yfov = c.perspective.yfov;
  out.aspect = c.perspective.aspectRatio;
  return out;
}

}  // namespace tdpt::gltf
