// For tests: small scenes with a picture known in closed form, to be made extreme.
//
// The white room: its ceiling is black and emits radiance L, all other surfaces reflect all light.
// Whatever its shape, contents, unit and place, and wherever the camera looks, it shows L
// everywhere.
//
// The dark chamber: an infinitely thin wall with a hole stands at distance d in front of a grey
// patch; behind it everything emits L. The patch shows albedo L F, F the form factor from the patch
// to the hole.
#pragma once
#include <functional>
#include <numbers>

#include "libcommon/formats/portal.h"
#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-render/testing/means.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt {

struct Cornered {
  Vec3d a, b, c;
};
using Mesh = std::vector<Cornered>;

/// p, p+u, p+u+v, p+v; front along cross(u, v).
inline Mesh sheet(const Vec3d& p, const Vec3d& u, const Vec3d& v) {
  return {{p, p + u, p + u + v}, {p, p + u + v, p + v}};
}
inline Mesh operator+(Mesh a, const Mesh& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
/// The inner faces of a box, without its ceiling.
inline Mesh open_box(const Vec3d& low, const Vec3d& high) {
  const Vec3d d = high - low, x{d.x, 0, 0}, y{0, d.y, 0}, z{0, 0, d.z};
  return sheet(low, y, z) + sheet(low + x, z, y) + sheet(low, z, x) + sheet(low, x, y) +
         sheet(low + z, y, x);
}
inline Mesh ceiling(const Vec3d& low, const Vec3d& high) {
  return sheet({low.x, high.y, low.z}, {high.x - low.x, 0, 0}, {0, 0, high.z - low.z});
}
/// An infinitely thin wall at x = 0, y 0..2, z -1..1, with a hole; visible from both sides.
inline Mesh wall_with_hole(double y0, double y1, double z0, double z1) {
  const auto part = [](double a, double b, double c, double d) {
    return b > a && d > c ? sheet({0, a, c}, {0, 0, d - c}, {0, b - a, 0}) : Mesh();
  };
  return part(0, y0, -1, 1) + part(y1, 2, -1, 1) + part(y0, y1, -1, z0) + part(y0, y1, z1, 1);
}

/// Builds a scene and reads it back as a file.
class SceneParts {
 public:
  using Json = nlohmann::ordered_json;

  /// `more`: members of pbrMetallicRoughness.
  int material(double albedo, const Json& more = Json::object()) {
    Json pbr = {{"baseColorFactor", {albedo, albedo, albedo, 1}}, {"metallicFactor", 0}};
    pbr.update(more);
    return glb_.material({{"pbrMetallicRoughness", pbr}, {"extensions", matt()}});
  }
  /// A black emitter.
  int lamp(double radiance, bool both_sides = false) {
    Json extensions = matt();
    extensions["KHR_materials_emissive_strength"] = {{"emissiveStrength", radiance}};
    return glb_.material(
        {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}, {"metallicFactor", 0}}},
         {"emissiveFactor", {1, 1, 1}},
         {"doubleSided", both_sides},
         {"extensions", extensions}});
  }
  void add(const Mesh& mesh, int material, Json node = {}) {
    std::vector<float> places;
    for (const Cornered& t : mesh)
      for (const Vec3d& p : {t.a, t.b, t.c})
        for (int i = 0; i < 3; ++i) places.push_back(static_cast<float>(p[i]));
    node["mesh"] =
        glb_.mesh({{"attributes", {{"POSITION", glb_.floats(places, 3)}}}, {"material", material}});
    glb_.node(node);
  }
  void camera(const Vec3d& from, const Vec3d& to, double yfov = 1) {
    glb_.camera("", {from.x, from.y, from.z}, {to.x, to.y, to.z}, yfov, 4.0 / 3);
  }
  /// Puts all nodes below one node.
  void below(Json node) {
    auto& roots = glb_.json["scenes"][0]["nodes"];
    node["children"] = roots;
    roots = Json::array();
    glb_.node(node);
  }
  Scene read() const {
    const testing::TempFolder folder;
    return read_gltf(folder.write("scene.glb", glb_.glb()));
  }

 private:
  static Json matt() { return {{"KHR_materials_specular", {{"specularFactor", 0}}}}; }
  testing::GlbBuilder glb_;
};

/// Form factor from a patch to a parallel rectangle at distance d with one corner straight in front
/// of it; sides a and b and the result are signed.
inline double corner_form_factor(double d, double a, double b) {
  const double p = std::hypot(d, a), q = std::hypot(d, b);
  return 0.5 * std::numbers::inv_pi * (a / p * std::atan(b / p) + b / q * std::atan(a / q));
}
/// To the rectangle from (-h,-w) to (h,w) from the point (y,z).
inline double form_factor(double d, double h, double w, double y = 0, double z = 0) {
  return corner_form_factor(d, h - y, w - z) - corner_form_factor(d, -h - y, w - z) -
         corner_form_factor(d, h - y, -w - z) + corner_form_factor(d, -h - y, -w - z);
}

}  // namespace tdpt
