#include "libcommon/scene/texture.h"

#include <algorithm>

#include "libcommon/scene/surface_tables.h"
#include "shaders/shared/texels.h"
#include "shaders/shared/vector.h"

namespace tdpt::shader {
namespace {

// The shared source compiled for doubles.
struct Mapped {
  using Real = double;
#include "shaders/shared/path/mapped.h"
};
constexpr Mapped mapped{};

}  // namespace
}  // namespace tdpt::shader

namespace tdpt {
namespace {

using shader::mapped;
using Texel = std::array<float, 4>;

shader::Mapped::Texel text(const Texel& t) {
  return {{t[0], t[1], t[2]}, t[3]};
}

/// The two texels along one axis around a coordinate, and the weight of the second.
struct Span {
  int first, second;
  float share;
};

/// floor(u) for |u| below 2^62; std::floor is a library call on plain x86-64.
int64_t floor_of(double u) {
  const auto i = static_cast<int64_t>(u);
  return i - (static_cast<double>(i) > u ? 1 : 0);
}

Span span_of(double u, int n, TextureMap::Wrap wrap, bool nearest) {
  // Beyond this, neighbouring doubles are more than a millionth of an image apart. Catches NaN,
  // too.
  if (!(std::abs(u) < 1e9)) u = 0;
  if (wrap == TextureMap::Wrap::repeat)
    u -= static_cast<double>(floor_of(u));
  else if (wrap == TextureMap::Wrap::mirror)
    u -= 2 * static_cast<double>(floor_of(0.5 * u));
  else
    u = std::clamp(u, 0.0, 1.0);
  const double x = nearest ? u * n : u * n - 0.5;  // the centre of texel i is at i + 1/2
  const int i = static_cast<int>(floor_of(x));
  const bool mirror = wrap == TextureMap::Wrap::mirror, clamp = wrap == TextureMap::Wrap::clamp;
  const int first = shader::wrapped_texel(i, n, mirror, clamp);
  if (nearest) return {first, first, 0};
  return {first, shader::wrapped_texel(i + 1, n, mirror, clamp), static_cast<float>(x - i)};
}

/// Decodes texels: one table for RGB, one for alpha.
struct Decoder {
  const Image& image;
  const LinearTable &rgb, &alpha;
  Texel operator()(int x, int y) const {
    const uint8_t* t = image.texels.data() + 4 * (static_cast<size_t>(y) * image.width + x);
    return {rgb[t[0]], rgb[t[1]], rgb[t[2]], alpha[t[3]]};
  }
};

Texel mixed(const Texel& a, const Texel& b, float share) {
  Texel out;
  for (size_t c = 0; c < 4; ++c) out[c] = a[c] + (b[c] - a[c]) * share;
  return out;
}

template <size_t N>
std::array<double, N> interpolated(const std::vector<std::array<float, N>>& values,
                                   const Triangle& t, const SurfacePlace& place) {
  std::array<double, N> out;
  const auto &a = values[t.vertex[0]], &b = values[t.vertex[1]], &c = values[t.vertex[2]];
  const double b0 = 1 - place.b1 - place.b2;
  for (size_t k = 0; k < N; ++k) out[k] = b0 * a[k] + place.b1 * b[k] + place.b2 * c[k];
  return out;
}

Vec3d interpolated(const std::vector<Vec3f>& values, const Triangle& t, const SurfacePlace& place) {
  return Vec3d(values[t.vertex[0]]) * (1 - place.b1 - place.b2) +
         Vec3d(values[t.vertex[1]]) * place.b1 + Vec3d(values[t.vertex[2]]) * place.b2;
}

/// Interpolated vertex colour; white if the scene has none.
std::array<double, 4> colour_at(const Scene& scene, const SurfacePlace& place) {
  if (scene.colours.empty()) return {1, 1, 1, 1};
  return interpolated(scene.colours, scene.triangles[place.triangle], place);
}

struct Tangents {
  Vec3d u, v;  ///< along +X (right) and +Y (up) of the normal map; not unit. 0: no frame
};

/// From the corners' positions and texture coordinates: u along dP/du, v against dP/dv, because
/// images run downwards.
Tangents derived_tangents(const Scene& scene, const TextureMap& map, uint32_t triangle) {
  const auto& uv = scene.uv[map.uv_set];
  if (uv.empty()) return {};
  const Triangle& t = scene.triangles[triangle];
  const auto& a = uv[t.vertex[0]];
  std::array<double, 4> m;  // du, dv along the edges 1 and 2, after the map's transform
  for (size_t k = 0; k < 2; ++k) {
    const auto& b = uv[t.vertex[k + 1]];
    const double du = static_cast<double>(b[0]) - a[0], dv = static_cast<double>(b[1]) - a[1];
    m[2 * k] = map.transform[0] * du + map.transform[1] * dv;
    m[2 * k + 1] = map.transform[3] * du + map.transform[4] * dv;
  }
  const double determinant = m[0] * m[3] - m[1] * m[2];
  if (!std::isfinite(determinant) || determinant == 0) return {};
  const double sign = determinant > 0 ? 1 : -1;
  const TriangleShape s = shape_of(scene, triangle);
  return {(s.e1 * m[3] - s.e2 * m[1]) * sign, (s.e1 * m[2] - s.e2 * m[0]) * sign};
}

Vec3d bent(const Scene& scene, const TextureMap& map, float scale, const SurfacePlace& place,
           const Vec3d& n) {
  const Triangle& t = scene.triangles[place.triangle];
  Vec3d x{};
  double hand = 1;
  if (!scene.tangents.empty()) {
    const auto v = interpolated(scene.tangents, t, place);
    x = mapped.across({v[0], v[1], v[2]}, n);
    hand = scene.tangents[t.vertex[0]][3] < 0 ? -1 : 1;
  }
  if (x == Vec3d{}) {
    const Tangents d = derived_tangents(scene, map, place.triangle);
    x = mapped.across(d.u, n);
    hand = dot(cross(n, d.u), d.v) < 0 ? -1 : 1;
  }
  if (x == Vec3d{}) return n;
  return mapped.bent_by(text(lookup(scene, map, place)), scale, x, hand, n);
}

}  // namespace

Texel lookup(const Scene& scene, const TextureMap& map, const SurfacePlace& place) {
  if (!map) return {1, 1, 1, 1};
  std::array<double, 2> uv{};
  if (!scene.uv[map.uv_set].empty())
    uv = interpolated(scene.uv[map.uv_set], scene.triangles[place.triangle], place);
  const auto& m = map.transform;
  const Image& image = scene.images[static_cast<size_t>(map.image)];
  const Span x = span_of(m[0] * uv[0] + m[1] * uv[1] + m[2], image.width, map.wrap_u, map.nearest);
  const Span y = span_of(m[3] * uv[0] + m[4] * uv[1] + m[5], image.height, map.wrap_v, map.nearest);
  const Decoder texel{image, map.srgb ? linear_of_srgb() : linear_of_byte(), linear_of_byte()};
  const auto row = [&](int at) {
    const Texel first = texel(x.first, at);
    return x.share == 0 ? first : mixed(first, texel(x.second, at), x.share);
  };
  return y.share == 0 ? row(y.first) : mixed(row(y.first), row(y.second), y.share);
}

void multiply(shader::SurfaceMaterial& m, uint32_t map, const Texel& texel) {
  mapped.multiply(m, map, text(texel));
}

Texel base_color_at(const Scene& scene, const SurfacePlace& place) {
  const Material& m = scene.material_of(place.triangle);
  Texel out{m.base_color.x, m.base_color.y, m.base_color.z, m.alpha};
  if (m.plain) return out;
  const Texel texel = lookup(scene, m.maps[MAP_BASE], place);
  const auto colour = colour_at(scene, place);
  for (size_t c = 0; c < 4; ++c)
    out[c] = std::clamp(out[c] * texel[c] * static_cast<float>(colour[c]), 0.0f, 1.0f);
  return out;
}

shader::SurfaceMaterial material_at(const Scene& scene, const SurfacePlace& place) {
  const Material& m = scene.material_of(place.triangle);
  shader::SurfaceMaterial v = surface_material(m);
  const Texel base = base_color_at(scene, place);
  v.base_color = {base[0], base[1], base[2]};
  if (m.plain) return v;
  for (uint32_t k = MAP_BASE + 1; k < MAPS_OF_FACTORS; ++k)
    if (k != MAP_EMISSION && m.maps[k])
      mapped.multiply(v, k, text(lookup(scene, m.maps[k], place)));
  return v;
}

Rgb emission_at(const Scene& scene, const SurfacePlace& place) {
  const Material& m = scene.material_of(place.triangle);
  if (!m.maps[MAP_EMISSION]) return m.emission;
  const Texel texel = lookup(scene, m.maps[MAP_EMISSION], place);
  return m.emission * Rgb(texel[0], texel[1], texel[2]);
}

float coverage_at(const Scene& scene, const SurfacePlace& place) {
  const Material& m = scene.material_of(place.triangle);
  if (m.alpha_mode == Material::Alpha::opaque) return 1;
  const float alpha = base_color_at(scene, place)[3];
  if (m.alpha_mode == Material::Alpha::mask) return alpha >= m.alpha_cutoff ? 1.0f : 0.0f;
  return alpha;
}

namespace {

Vec3d normal_at(const Scene& scene, const TextureMap& map, float scale, const SurfacePlace& place,
                const Vec3d& geometric) {
  Vec3d n = geometric;
  const uint8_t how = scene.smooth.empty() ? 0 : scene.smooth[place.triangle];
  if (how != 0) {
    const Vec3d sum = interpolated(scene.normals, scene.triangles[place.triangle], place) *
                      (how == 2 ? -1.0 : 1.0);
    const double l = length(sum);
    if (l > 1e-6) n = sum / l;
  }
  if (map)
    n = bent(scene, map, scale, place, mapped.in_front(n, geometric));
  else if (how == 0)
    return geometric;
  return mapped.in_front(n, geometric);
}

}  // namespace

Vec3d shading_normal_at(const Scene& scene, const SurfacePlace& place, const Vec3d& geometric) {
  const Material& m = scene.material_of(place.triangle);
  return normal_at(scene, m.maps[MAP_NORMAL], m.normal_scale, place, geometric);
}

Vec3d coat_normal_at(const Scene& scene, const SurfacePlace& place, const Vec3d& geometric) {
  const Material& m = scene.material_of(place.triangle);
  return normal_at(scene, m.maps[MAP_COAT_NORMAL], m.coat_normal_scale, place, geometric);
}

}  // namespace tdpt
