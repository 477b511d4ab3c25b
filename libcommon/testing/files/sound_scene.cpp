#include "libcommon/testing/files/sound_scene.h"

#include <cmath>

#include "libcommon/scene/texture.h"

namespace tdpt::testing {
namespace {

bool is_share(float v) {
  return v >= 0 && v <= 1;
}

template <class Values>
bool are_shares(const Values& values) {
  for (float v : values)
    if (!is_share(v)) return false;
  return true;
}

bool has_attributes_of_all_vertices(const Scene& s) {
  for (size_t size :
       {s.normals.size(), s.tangents.size(), s.uv[0].size(), s.uv[1].size(), s.colours.size()})
    if (size != 0 && size != s.positions.size()) return false;
  return s.smooth.empty() || s.smooth.size() == s.triangles.size();
}

bool has_triangles_of_its_vertices(const Scene& s) {
  for (const Triangle& t : s.triangles) {
    if (t.material >= s.materials.size()) return false;
    for (uint32_t v : t.vertex) {
      if (v >= s.positions.size()) return false;
      for (int c = 0; c < 3; ++c)
        if (!(std::abs(s.positions[v][c]) <= 2e9)) return false;  // at the horizon
    }
  }
  return true;
}

std::string fault_at(const Scene& s, const SurfacePlace& place, const Vec3d& geometric) {
  if (!are_shares(base_color_at(s, place))) return "a colour is a share";
  if (!is_finite(emission_at(s, place))) return "emission is finite";
  if (!is_share(coverage_at(s, place))) return "coverage is a share";
  const Vec3d normal = shading_normal_at(s, place, geometric);
  if (!(std::abs(length(normal) - 1) < 1e-9)) return "a normal has length 1";
  if (!(dot(normal, geometric) >= 0.99e-3)) return "a normal is in front";
  const Material& m = s.material_of(place.triangle);
  for (const TextureMap* map : {&m.maps[MAP_METALLIC_ROUGHNESS], &m.maps[MAP_SPECULAR],
                                &m.maps[MAP_SPECULAR_COLOR], &m.maps[MAP_TRANSMISSION]})
    if (!are_shares(lookup(s, *map, place))) return "a texel is a share";
  if (!is_finite(m.absorption) || !is_finite(m.specular_color)) return "a material is finite";
  if (!(m.ior >= 1 && is_share(static_cast<float>(m.roughness)))) return "a material is in range";
  return "";
}

std::string fault_of(const PunctualLight& l) {
  if (!is_finite(l.intensity) || !is_finite(l.position)) return "a lamp is finite";
  if (!(std::abs(length(l.direction) - 1) < 1e-9)) return "a lamp's direction has length 1";
  return l.cos_inner >= l.cos_outer ? "" : "a lamp's inner cone lies in its outer";
}

std::string fault_of(const SceneDefaults& d) {
  const auto is_size = [](int pixels) { return pixels >= 0 && pixels <= 65536; };
  if (!is_size(d.width) || !is_size(d.height)) return "a picture's size is in range";
  if (!(std::abs(d.rotation.value_or(0)) <= 360)) return "a rotation is in range";
  if (!(d.scale.value_or(1) >= 1e-9 && d.scale.value_or(1) <= 1e9)) return "a scale is in range";
  return d.environment_file.empty() || d.has_environment() ? "" : "what is named is a file";
}

}  // namespace

std::string fault_of(const Scene& s) {
  if (const std::string fault = fault_of(s.defaults); !fault.empty()) return fault;
  if (!has_attributes_of_all_vertices(s)) return "each vertex has its attributes";
  if (!has_triangles_of_its_vertices(s)) return "corners and materials exist";
  for (uint32_t t = 0; t < s.triangles.size(); ++t) {
    const Vec3d geometric = shape_of(s, t).normal;
    for (const SurfacePlace& place : {SurfacePlace{t, 0, 0}, {t, 1, 0}, {t, 0.3, 0.6}})
      if (const std::string fault = fault_at(s, place, geometric); !fault.empty()) return fault;
  }
  for (const PunctualLight& l : s.lights)
    if (const std::string fault = fault_of(l); !fault.empty()) return fault;
  for (const AreaLight& l : s.area_lights)
    if (l.material >= s.materials.size() || !(l.area >= 0)) return "an area light has a material";
  return "";
}

}  // namespace tdpt::testing
