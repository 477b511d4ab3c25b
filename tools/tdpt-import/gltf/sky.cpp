#include "tools/tdpt-import/gltf/sky.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcommon/formats/picture.h"
#include "libcommon/formats/radiance_hdr.h"
#include "tools/tdpt-import/images.h"

namespace tdpt::foreign {
namespace {

using std::numbers::pi;

constexpr int kWidest = 8192;  // of an environment

// Texel at continuous coordinates, bilinear; columns wrap, rows end.
Rgb sample_latlong(const Texels& t, const Vec3d& d) {
  const double u = 0.5 + std::atan2(d.x, -d.z) / (2 * pi);
  const double v = std::acos(std::clamp(d.y, -1.0, 1.0)) / pi;
  const double x = u * t.width - 0.5, y = std::clamp(v * t.height - 0.5, 0.0, t.height - 1.0);
  const double x0 = std::floor(x), y0 = std::min(std::floor(y), t.height - 1.0);
  const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
  const auto at = [&](double i, double j) {
    const auto column = static_cast<size_t>((static_cast<long>(i) % t.width + t.width) % t.width);
    const auto row = static_cast<size_t>(std::min(j, t.height - 1.0));
    return t.rgb[row * static_cast<size_t>(t.width) + column];
  };
  return (at(x0, y0) * (1 - fx) + at(x0 + 1, y0) * fx) * (1 - fy) +
         (at(x0, y0 + 1) * (1 - fx) + at(x0 + 1, y0 + 1) * fx) * fy;
}

// The square of Clarberg's equal-area map ("Fast equal-area mapping of the (hemi)sphere using
// SIMD", 2008), as pbrt-v4 has it: +z at the centre, -z at the corners; the nearest texel.
Rgb sample_octahedral(const Texels& t, const Vec3d& d) {
  const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
  const double r = std::sqrt(std::max(0.0, 1 - z));
  const double a = std::max(x, y), b = a == 0 ? 0 : std::min(x, y) / a;
  double phi = std::atan(b) * 2 / pi;
  if (x < y) phi = 1 - phi;
  double v = phi * r, u = r - v;
  if (d.z < 0) {
    std::swap(u, v);
    u = 1 - u, v = 1 - v;
  }
  u = (std::copysign(u, d.x) + 1) / 2, v = (std::copysign(v, d.y) + 1) / 2;
  const auto cell = [](double f, int n) {
    return static_cast<size_t>(std::clamp(f * n, 0.0, n - 1.0));
  };
  return t.rgb[cell(v, t.height) * static_cast<size_t>(t.width) + cell(u, t.width)];
}

Picture resampled(const Texels& t, const Sky& sky, const Affine& to_map) {
  const bool square = sky.layout == Sky::Layout::octahedral;
  Picture out;
  out.width = std::min(kWidest, square ? 2 * t.width : t.width);
  out.height = std::max(1, out.width / 2);
  out.pixels.reserve(static_cast<size_t>(out.width) * static_cast<size_t>(out.height));
  // A map of the same layout and size is sampled at its texels' centres; squares more densely.
  const int n = square ? 4 : 1;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      Rgb sum(0);
      for (int k = 0; k < n * n; ++k) {
        const double phi = ((x + (k % n + 0.5) / n) / out.width - 0.5) * 2 * pi;
        const double theta = (y + (k / n + 0.5) / n) / out.height * pi, s = std::sin(theta);
        const Vec3d d = to_map.vector({s * std::sin(phi), std::cos(theta), -s * std::cos(phi)});
        sum = sum + (square ? sample_octahedral(t, d) : sample_latlong(t, d));
      }
      out.pixels.push_back(sum * (sky.colour / static_cast<float>(n * n)));
    }
  return out;
}

bool is_near(const Vec3d& a, const Vec3d& b) {
  return length(a - b) < 1e-6;
}

}  // namespace

WrittenSky written_sky(const Described& scene, const Frame& frame, Source& source) {
  WrittenSky out;
  if (!scene.sky || !(max_component(scene.sky->colour) > 0)) return out;
  const Sky& sky = *scene.sky;
  if (!sky.image) {
    out.extras["tdpt_environment"] = {sky.colour.x, sky.colour.y, sky.colour.z};
    return out;
  }
  const Image& image = scene.images[*sky.image];
  Texels t = image.bytes.empty() ? Texels{image.width, image.height, false, image.texels, {}}
                                 : decode(image.bytes, source.shown_name(image.name));
  if (t.is_8bit)
    for (Rgb& c : t.rgb) c = linear_of(c);
  for (Rgb& c : t.rgb) c = max(c, Rgb(0));

  const Affine to_map = sky.to_map * frame.to_gltf.transposed();
  const bool grey = sky.colour.x == sky.colour.y && sky.colour.y == sky.colour.z;
  const bool turned = is_near(to_map.y, {0, 1, 0}) && !to_map.mirrors();
  const bool plain =
      sky.layout == Sky::Layout::latlong && t.width == 2 * t.height && t.width <= kWidest;
  const bool exr = image.bytes.starts_with("\x76\x2f\x31\x01"), hdr = is_radiance_hdr(image.bytes);
  if (grey && turned && plain && (exr || hdr)) {
    out.suffix = exr ? ".exr" : ".hdr";
    out.bytes = image.bytes;
    // The map's -z lies at to_map's inverse of it; a positive rotation is counter-clockwise from
    // above.
    const Vec3d centre = to_map.transposed().vector({0, 0, -1});
    const double degrees = std::atan2(-centre.x, -centre.z) * 180 / pi;
    if (std::abs(degrees) > 1e-9) out.extras["tdpt_environment_rotation"] = degrees;
    if (sky.colour.x != 1) out.extras["tdpt_environment_scale"] = sky.colour.x;
    return out;
  }
  ExrFile file;
  file.picture = resampled(t, sky, to_map);
  out.suffix = ".exr";
  out.bytes = exr_bytes(file);
  return out;
}

}  // namespace tdpt::foreign
