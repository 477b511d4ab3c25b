#include "tools/tdpt-import/gltf/sky.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "libcommon/formats/picture.h"
#include "libcommon/formats/radiance_hdr.h"
#include "tools/tdpt-import/images.h"

namespace tdpt::foreign {
namespace {

using std::numbers::pi;

constexpr int kWidest = 8192;  // of an environment

// The texels of a map as directions: u from the left, v from the top, both in 0..1. Octahedral: the
// square of Clarberg's equal-area map ("Fast equal-area mapping of the (hemi)sphere using SIMD",
// 2008), as pbrt-v4 has it: +z at the centre, -z at the corners.
Vec3d direction_of(Sky::Layout layout, double u, double v) {
  if (layout == Sky::Layout::latlong) {
    const double phi = (u - 0.5) * 2 * pi, s = std::sin(v * pi);
    return {s * std::sin(phi), std::cos(v * pi), -s * std::cos(phi)};
  }
  u = 2 * u - 1, v = 2 * v - 1;
  const double x = std::abs(u), y = std::abs(v), r = 1 - std::abs(1 - x - y);
  const double phi = (r > 0 ? (y - x) / r + 1 : 1) * pi / 4, s = r * std::sqrt(2 - r * r);
  return {std::copysign(s * std::cos(phi), u), std::copysign(s * std::sin(phi), v),
          std::copysign(1 - r * r, 1 - x - y)};
}

// [sr]
double solid_angle(Sky::Layout layout, double u0, double v0, double u1, double v1) {
  return layout == Sky::Layout::latlong
             ? 2 * pi * (u1 - u0) * (std::cos(v0 * pi) - std::cos(v1 * pi))
             : 4 * pi * (u1 - u0) * (v1 - v0);
}

// A convex polygon of columns (x) and cosines from the pole (y), in which areas are solid angles.
struct Polygon {
  std::array<std::array<double, 2>, 10> p{};
  size_t n = 0;

  double area() const {
    double sum = 0;
    for (size_t i = 0; i < n; ++i) {
      const auto &a = p[i], &b = p[(i + 1) % n];
      sum += (a[0] - p[0][0]) * (b[1] - p[0][1]) - (b[0] - p[0][0]) * (a[1] - p[0][1]);
    }
    return std::abs(sum) / 2;
  }
  std::array<double, 2> range(size_t axis) const {
    const auto by = [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; };
    const auto [low, high] = std::minmax_element(p.begin(), p.begin() + n, by);
    return {(*low)[axis], (*high)[axis]};
  }
  // The part where sign * coordinate <= sign * limit.
  Polygon within(size_t axis, double limit, double sign) const {
    Polygon out;
    for (size_t i = 0; i < n && out.n + 2 <= p.size(); ++i) {
      const auto &a = p[i], &b = p[(i + 1) % n];
      const double from = sign * (limit - a[axis]), to = sign * (limit - b[axis]);
      if (from >= 0) out.p[out.n++] = a;
      if ((from > 0 && to < 0) || (from < 0 && to > 0)) {
        const double t = from / (from - to);
        out.p[out.n++] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
      }
    }
    return out;
  }
};

// A map turned and mirrored: each texel's light goes to the texels that it covers, by the solid
// angles that they have in common, so that a sun keeps its power and one colour stays one colour.
// The new map's rows part halfway in the cosine, as the renderer reads them (scene/sky.h).
class Turned {
 public:
  Turned(const Texels& from, const Sky& sky, const Affine& to_scene, int width)
      : from_(from), sky_(sky), to_scene_(to_scene), width_(width), height_(width / 2) {
    const auto centre = [&](int row) { return std::cos(pi * (row + 0.5) / height_); };
    edges_.push_back(1);
    for (int row = 1; row < height_; ++row) edges_.push_back((centre(row - 1) + centre(row)) / 2);
    edges_.push_back(-1);
    pixels_.resize(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  }

  Picture picture() {
    std::vector<Spot> above, below;
    for (int y = 0; y <= from_.height; ++y) {
      std::swap(above, below);
      below.clear();
      const double v = static_cast<double>(y) / from_.height;
      for (int x = 0; x <= from_.width; ++x) {
        const double u = static_cast<double>(x) / from_.width;
        below.push_back(spot(u, v));
        if (x == 0 || y == 0) continue;
        const auto i = static_cast<size_t>(x);
        const Rgb& texel =
            from_.rgb[static_cast<size_t>(y - 1) * static_cast<size_t>(from_.width) + i - 1];
        if (max_component(texel) > 0)
          share({above[i - 1], above[i], below[i], below[i - 1]}, texel * sky_.colour, 0);
      }
    }
    for (int row = 0; row < height_; ++row) {
      const auto per = static_cast<float>(width_ / (2 * pi * height_of(row)));
      for (int x = 0; x < width_; ++x) pixel(x, row) = pixel(x, row) * per;
    }
    return {width_, height_, std::move(pixels_), {}};
  }

 private:
  struct Spot {
    double u, v;  // in the map that is given
    Vec3d towards;
    double column;  // in the new one
  };
  Spot spot(double u, double v) const {
    const Vec3d d = to_scene_.vector(direction_of(sky_.layout, u, v));
    return {u, v, d, (0.5 + std::atan2(d.x, -d.z) / (2 * pi)) * width_};
  }
  double height_of(int row) const {
    return edges_[static_cast<size_t>(row)] - edges_[static_cast<size_t>(row) + 1];
  }
  Rgb& pixel(int column, int row) {
    return pixels_[static_cast<size_t>(row) * static_cast<size_t>(width_) +
                   static_cast<size_t>(column)];
  }
  int row_of(double cosine) const {
    const auto below = std::upper_bound(edges_.begin(), edges_.end(), cosine, std::greater<>());
    return std::clamp(static_cast<int>(below - edges_.begin()) - 1, 0, height_ - 1);
  }

  // Of a rectangle of the given map, its corners from the upper left clockwise.
  void share(const std::array<Spot, 4>& corners, const Rgb& radiance, int depth) {
    constexpr double kStraight = 0.05;  // [rad] up to which edges count as straight
    constexpr int kDeepest = 8;
    Polygon quad;
    double left = corners[0].column, right = left;
    for (const Spot& c : corners) {
      const double x = c.column - std::round((c.column - corners[0].column) / width_) * width_;
      quad.p[quad.n++] = {x, c.towards.y};
      left = std::min(left, x), right = std::max(right, x);
    }
    const auto& [a, b, c, d] = corners;
    const bool bent =
        (right - left) * 2 * pi / width_ > kStraight || length(a.towards - c.towards) > kStraight;
    const double u = (a.u + c.u) / 2, v = (a.v + c.v) / 2;
    const Spot middle = spot(u, v);
    if (bent && depth < kDeepest) {
      const Spot top = spot(u, a.v), bottom = spot(u, c.v), west = spot(a.u, v),
                 east = spot(c.u, v);
      share({a, top, middle, west}, radiance, depth + 1);
      share({top, b, east, middle}, radiance, depth + 1);
      share({middle, east, c, bottom}, radiance, depth + 1);
      share({west, middle, bottom, d}, radiance, depth + 1);
      return;
    }
    const Rgb light = radiance * static_cast<float>(solid_angle(sky_.layout, a.u, a.v, c.u, c.v));
    const double area = quad.area();
    if (bent || !(area > 0)) {  // next to a pole
      Rgb& to = pixel(std::clamp(static_cast<int>(middle.column), 0, width_ - 1),
                      row_of(middle.towards.y));
      to = to + light;
    } else {
      spread(quad, light / static_cast<float>(area));
    }
  }

  void spread(const Polygon& quad, const Rgb& per_area) {
    const auto [low, high] = quad.range(1);
    for (int row = row_of(high); row < height_ && edges_[static_cast<size_t>(row)] > low; ++row) {
      const Polygon strip = quad.within(1, edges_[static_cast<size_t>(row)], 1)
                                .within(1, edges_[static_cast<size_t>(row) + 1], -1);
      if (strip.n < 3) continue;
      const auto [left, right] = strip.range(0);
      for (double x = std::floor(left); x < right; ++x) {
        Rgb& to = pixel((static_cast<int>(x) % width_ + width_) % width_, row);
        to = to + per_area * static_cast<float>(strip.within(0, x + 1, 1).within(0, x, -1).area());
      }
    }
  }

  const Texels& from_;
  const Sky& sky_;
  const Affine& to_scene_;
  int width_, height_;
  std::vector<double> edges_;  // cosines between rows
  std::vector<Rgb> pixels_;    // power per texel until the end
};

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
  const std::string name = source.shown_name(image.name);
  Texels t = image.texels.empty() ? decode(image.bytes, name)
                                  : Texels{image.width, image.height, false, image.texels, {}};
  if (t.is_8bit)
    for (Rgb& c : t.rgb) c = linear_of(c);
  bool negative = false;
  for (size_t i = 0; i < t.rgb.size(); ++i) {
    if (!(max_component(t.rgb[i]) <= 1e30f) || !is_finite(t.rgb[i]))
      throw InputError(name,
                       fmt::format("pixel {} {}", i % static_cast<size_t>(t.width),
                                   i / static_cast<size_t>(t.width)),
                       "is no radiance of a sky, expected finite numbers up to 1e30");
    negative |= std::min({t.rgb[i].x, t.rgb[i].y, t.rgb[i].z}) < 0;
    t.rgb[i] = max(t.rgb[i], Rgb(0));
  }
  if (negative) source.lose({source.path(), ""}, "negative radiances of the sky become 0");
  if (std::all_of(t.rgb.begin(), t.rgb.end(), [](const Rgb& c) { return !(max_component(c) > 0); }))
    return out;

  const Affine to_map = sky.to_map * frame.to_gltf.transposed();
  const bool grey = sky.colour.x == sky.colour.y && sky.colour.y == sky.colour.z;
  const bool turned = is_near(to_map.y, {0, 1, 0}) && !to_map.mirrors();
  const bool plain = sky.layout == Sky::Layout::latlong && t.width == 2 * t.height &&
                     t.width <= kWidest && !negative;
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
  // As fine as the given one; equal-area squares have texels of 3.5 rad / width.
  const int width =
      std::clamp(sky.layout == Sky::Layout::octahedral ? 2 * t.width : t.width, 4, kWidest);
  ExrFile file;
  file.picture = Turned(t, sky, to_map.transposed(), width / 2 * 2).picture();
  out.suffix = ".exr";
  out.bytes = exr_bytes(file);
  return out;
}

}  // namespace tdpt::foreign
