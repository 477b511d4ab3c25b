#include "libcommon/testing/rooms/room_plan.h"

#include <algorithm>
#include <cmath>

#include "libcommon/math/rng.h"
#include "libcommon/testing/files/glb_builder.h"

namespace tdpt::testing {
namespace {
using Json = nlohmann::ordered_json;
using Corners = std::array<Vec3d, 3>;

// Splits a triangle into n x n small ones.
void split_evenly(const Corners& t, int n, std::vector<Corners>& out) {
  const auto at = [&](int i, int j) {
    return t[0] + (t[1] - t[0]) * (double(i) / n) + (t[2] - t[0]) * (double(j) / n);
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      out.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + j + 1 < n) out.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
}

// Strips of very different widths between two opposite sides, each split along its diagonal.
void split_in_slivers(const RoomPlan::Quad& q, std::vector<Corners>& out) {
  const double cuts[] = {0, 0.001, 0.37, 0.372, 0.9, 0.9995, 1};
  for (size_t k = 0; k + 1 < std::size(cuts); ++k) {
    const auto lerp = [&](size_t a, size_t b, double s) { return q[a] + (q[b] - q[a]) * s; };
    const Vec3d a = lerp(0, 1, cuts[k]), b = lerp(0, 1, cuts[k + 1]);
    const Vec3d c = lerp(3, 2, cuts[k + 1]), d = lerp(3, 2, cuts[k]);
    out.push_back({a, b, c});
    out.push_back({a, c, d});
  }
}

std::vector<Corners> triangles_of(const RoomPlan::Part& part, const Writing& writing) {
  std::vector<Corners> out;
  for (const RoomPlan::Quad& q : part.quads) {
    if (writing.splitting == Splitting::slivers) {
      split_in_slivers(q, out);
      continue;
    }
    const int n = writing.splitting == Splitting::in_4     ? 2
                  : writing.splitting == Splitting::in_144 ? 12
                                                           : 1;
    split_evenly({q[0], q[1], q[2]}, n, out);
    split_evenly({q[0], q[2], q[3]}, n, out);
  }
  if (writing.shuffle != 0)
    for (size_t i = out.size(); i > 1; --i) {
      Rng rng(writing.shuffle, 1, i);
      std::swap(out[i - 1], out[rng.below(static_cast<uint32_t>(i))]);
      std::rotate(out[i - 1].begin(), out[i - 1].begin() + rng.below(3), out[i - 1].end());
    }
  return out;
}

int glass_of(GlbBuilder& b, const RoomPlan::Part& part) {
  Json m = {{"name", part.name},
            {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
            {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}}},
            {"doubleSided", part.stuff == RoomPlan::Stuff::sheet}};
  if (part.stuff == RoomPlan::Stuff::glass)
    m["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 1}};
  for (const auto& [name, values] : m["extensions"].items())
    b.json["extensionsUsed"].push_back(name);
  return b.material(m);
}

int material_of(GlbBuilder& b, const RoomPlan::Part& part, const Writing& writing) {
  using Stuff = RoomPlan::Stuff;
  if (part.stuff == Stuff::sheet || part.stuff == Stuff::glass) return glass_of(b, part);
  const double grey = part.radiance > 0 ? 0 : 0.7;
  Json m = {
      {"name", part.name},
      {"pbrMetallicRoughness", {{"baseColorFactor", {grey, grey, grey, 1}}, {"metallicFactor", 0}}},
      {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}};
  if (part.radiance > 0) {
    m["emissiveFactor"] = {1, 1, 1};
    m["extensions"]["KHR_materials_emissive_strength"] = {
        {"emissiveStrength", part.radiance * writing.power}};
  } else {
    m["doubleSided"] = true;
  }
  if (part.stuff == Stuff::cloth) {
    m["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.5;
    m["alphaMode"] = "BLEND";
  }
  return b.material(m);
}

void write_part(GlbBuilder& b, const RoomPlan::Part& part, const Writing& writing) {
  std::vector<float> positions;
  std::vector<uint32_t> indices;
  for (const Corners& t : triangles_of(part, writing))
    for (const Vec3d& p : t) {
      for (int c = 0; c < 3; ++c) positions.push_back(static_cast<float>(p[c]));
      indices.push_back(static_cast<uint32_t>(indices.size()));
    }
  const int position = b.floats(positions, 3);
  const Json primitive = {{"attributes", {{"POSITION", position}}},
                          {"indices", b.indices_u32(indices)},
                          {"material", material_of(b, part, writing)}};
  b.node({{"name", part.name}, {"mesh", b.mesh(primitive, part.name)}});
}

void write_sun(GlbBuilder& b, const Vec3d& towards, const Writing& writing) {
  b.json["extensionsUsed"].push_back("KHR_lights_punctual");
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"intensity", 10 * writing.power}}};
  const Vec3d x = normalize(cross(Vec3d{0.1, 1, 0.2}, towards)), y = cross(towards, x);
  b.node({{"name", "sun"},
          {"matrix",
           {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, towards.x, towards.y, towards.z, 0, 0, 0, 0, 1}},
          {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
}

}  // namespace

Vec3d Placement::turned(const Vec3d& v) const {
  const Vec3d k = normalize(axis);
  return v * std::cos(angle) + cross(k, v) * std::sin(angle) +
         k * (dot(k, v) * (1 - std::cos(angle)));
}

KnownAperture Placement::operator()(const KnownAperture& aperture) const {
  KnownAperture placed = aperture;
  for (Vec3d& p : placed.outline) p = (*this)(p);
  for (Vec3d& p : placed.mouth) p = (*this)(p);
  for (Quad& q : placed.obstacles)
    for (Vec3d& p : q) p = (*this)(p);
  for (KnownAperture& pane : placed.panes) pane = (*this)(pane);
  placed.normal = turned(aperture.normal);
  placed.thickness *= scale;
  return placed;
}

std::string RoomPlan::glb(const Writing& writing) const {
  GlbBuilder b;
  b.json["extensionsUsed"] = {"KHR_materials_emissive_strength", "KHR_materials_specular"};
  for (const Part& part : parts) write_part(b, part, writing);
  if (length(sun) > 0) write_sun(b, sun, writing);
  b.camera("camera", {camera.x, camera.y, camera.z}, {look_at.x, look_at.y, look_at.z}, 1.0,
           4.0 / 3);
  // All under one node, so that nothing is rounded far away.
  const Placement& p = writing.placement;
  const Vec3d k = normalize(p.axis) * std::sin(0.5 * p.angle);
  const Json children = b.json["scenes"][0]["nodes"];
  b.json["scenes"][0]["nodes"] = Json::array();
  b.node({{"name", "world"},
          {"children", children},
          {"translation", {p.move.x, p.move.y, p.move.z}},
          {"rotation", {k.x, k.y, k.z, std::cos(0.5 * p.angle)}},
          {"scale", {p.scale, p.scale, p.scale}}});
  return b.glb();
}

std::vector<RoomPlan::Quad> box(const Vec3d& low, const Vec3d& high, double turn,
                                const Vec3d& hinge) {
  const auto at = [&](int x, int y, int z) {
    const Vec3d p{x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z};
    const Vec3d d = p - hinge;
    const double c = std::cos(turn), s = std::sin(turn);
    return hinge + Vec3d{c * d.x + s * d.z, d.y, -s * d.x + c * d.z};
  };
  return {{at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0)},
          {at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1)},
          {at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)},
          {at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0)},
          {at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0)},
          {at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)}};
}

}  // namespace tdpt::testing
