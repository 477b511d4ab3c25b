// Writes the environment of a scene to a file beside it, and the keys that name the file.
#include "tools/tdpt-import/gltf/gltf.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "libcommon/formats/picture.h"

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

// The solid angle of a rectangle of a map [sr].
double solid_angle(Sky::Layout layout, double u0, double v0, double u1, double v1) {
  return layout == Sky::Layout::latlong
             ? 2 * pi * (u1 - u0) * (std::cos(v0 * pi) - std::cos(v1 * pi))
             : 4 * pi * (u1 - u0) * (v1 - v0);
}

// A polygon of columns (x) and cosines from the pole (y), in which areas are solid angles.
using Polygon = std::vector<std::array<double, 2>>;

double area_of(const Polygon& p) {
  double sum = 0;
  for (size_t i = 2; i < p.size(); ++i)
    sum += (p[i - 1][0] - p[0][0]) * (p[i][1] - p[0][1]) -
           (p[i][0] - p[0][0]) * (p[i - 1][1] - p[0][1]);
  return std::abs(sum) / 2;
}

std::array<double, 2> range_of(const Polygon& p, size_t axis) {
  const auto by = [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; };
  const auto [low, high] = std::minmax_element(p.begin(), p.end(), by);
  return {(*low)[axis], (*high)[axis]};
}

// The part of a polygon where sign * coordinate <= sign * limit (Sutherland and Hodgman).
const Polygon& cut(const Polygon& from, size_t axis, double limit, double sign, Polygon& to) {
  to.clear();
  for (size_t i = 0; i < from.size(); ++i) {
    const auto &a = from[i], &b = from[i + 1 == from.size() ? 0 : i + 1];
    const double within = sign * (limit - a[axis]), next = sign * (limit - b[axis]);
    if (within >= 0) to.push_back(a);
    if (within * next < 0) {
      const double t = within / (within - next);
      to.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
    }
  }
  return to;
}

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
    to_ = {width_, height_, false, {}, {}};
    to_.rgb.resize(to_.index(0, height_));
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
        const Rgb& texel = from_.rgb[from_.index(x - 1, y - 1)];
        if (max_component(texel) > 0)
          share({above[i - 1], above[i], below[i], below[i - 1]}, texel * sky_.colour);
      }
    }
    for (int row = 0; row < height_; ++row) {
      const auto per = static_cast<float>(width_ / (2 * pi * (edge(row) - edge(row + 1))));
      for (int x = 0; x < width_; ++x) pixel(x, row) = pixel(x, row) * per;
    }
    return {width_, height_, std::move(to_.rgb), {}};
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
  double edge(int row) const { return edges_[static_cast<size_t>(row)]; }
  Rgb& pixel(int column, int row) { return to_.rgb[to_.index(column, row)]; }
  int row_of(double cosine) const {
    const auto below = std::upper_bound(edges_.begin(), edges_.end(), cosine, std::greater<>());
    return std::clamp(static_cast<int>(below - edges_.begin()) - 1, 0, height_ - 1);
  }

  // Adds an edge without its end to the outline, as straight pieces that miss less than a ten
  // thousandth of the texel.
  void trace(const Spot& a, const Spot& b, int depth) {
    constexpr double kStraight = 0.05;  // [rad] of a piece
    constexpr int kDeepest = 16;
    const auto across = [&](const Spot& to) {
      const double columns = to.column - a.column;
      return (columns - std::round(columns / width_) * width_) * 2 * pi / width_;
    };
    const Spot middle = spot((a.u + b.u) / 2, (a.v + b.v) / 2);
    const double missed = std::abs(across(b) * (middle.towards.y - a.towards.y) -
                                   across(middle) * (b.towards.y - a.towards.y));
    if (depth < kDeepest && (std::abs(across(b)) > kStraight || missed > 1e-4 * solid_angle_ ||
                             length(a.towards - b.towards) > kStraight)) {
      trace(a, middle, depth + 1);
      trace(middle, b, depth + 1);
    } else {
      outline_.push_back({column_, a.towards.y});
      column_ += across(b) * width_ / (2 * pi);
    }
  }

  // Distributes the light of a texel; its corners are clockwise from the upper left.
  void share(const std::array<Spot, 4>& corners, const Rgb& radiance) {
    const auto& [first, b, last, d] = corners;
    solid_angle_ = solid_angle(sky_.layout, first.u, first.v, last.u, last.v);
    outline_.clear();
    column_ = first.column;
    trace(first, b, 0), trace(b, last, 0), trace(last, d, 0), trace(d, first, 0);
    if (std::abs(column_ - first.column) > width_ / 2.0) {  // all round a pole
      outline_.push_back({column_, first.towards.y});
      outline_.push_back({column_, std::copysign(1, first.towards.y)});
      outline_.push_back({first.column, std::copysign(1, first.towards.y)});
    }
    const double area = area_of(outline_);
    if (area > 0) spread(radiance * static_cast<float>(solid_angle_ / area));
  }

  void spread(const Rgb& per_area) {
    const auto [low, high] = range_of(outline_, 1);
    for (int row = row_of(high); row < height_ && edge(row) > low; ++row) {
      cut(cut(outline_, 1, edge(row), 1, part_), 1, edge(row + 1), -1, strip_);
      if (strip_.empty()) continue;
      const auto [left, right] = range_of(strip_, 0);
      for (double x = std::floor(left); x < right; ++x) {
        Rgb& to = pixel((static_cast<int>(x) % width_ + width_) % width_, row);
        const double common = area_of(cut(cut(strip_, 0, x + 1, 1, part_), 0, x, -1, cell_));
        to = to + per_area * static_cast<float>(common);
      }
    }
  }

  const Texels& from_;
  const Sky& sky_;
  const Affine& to_scene_;
  int width_, height_;
  std::vector<double> edges_;  // cosines between rows
  Texels to_;                  // power per texel until the end
  Polygon outline_, strip_, part_, cell_;
  double solid_angle_ = 0;  // of the texel [sr]
  double column_ = 0;       // where the outline is, without a seam
};

}  // namespace

void add_sky(GltfFile& f, GltfJson& extras) {
  if (!f.scene.sky || !(max_component(f.scene.sky->colour) > 0)) return;
  const Sky& sky = *f.scene.sky;
  const auto one_colour = [&](const Rgb& c) { extras["tdpt_environment"] = {c.x, c.y, c.z}; };
  if (!sky.image) return one_colour(sky.colour);
  const Image& image = f.scene.images[*sky.image];
  const std::string file = f.source.shown_name(image.name);
  Texels t = decode(image, f.source);
  if (t.is_8bit && sky.srgb)
    for (Rgb& c : t.rgb) c = linear_of(c);
  if (sky.layout == Sky::Layout::octahedral && t.width != t.height)
    throw InputError(file, "",
                     fmt::format("is {} x {} texels, expected a square, as pbrt-v4's skies are",
                                 t.width, t.height));
  bool negative = false;
  for (size_t i = 0; i < t.rgb.size(); ++i) {
    if (!(max_component(t.rgb[i]) <= 1e30f) || !is_finite(t.rgb[i]))
      throw InputError(file,
                       fmt::format("pixel {} {}", i % static_cast<size_t>(t.width),
                                   i / static_cast<size_t>(t.width)),
                       "is no radiance of a sky, expected finite numbers up to 1e30");
    negative |= std::min({t.rgb[i].x, t.rgb[i].y, t.rgb[i].z}) < 0;
    t.rgb[i] = max(t.rgb[i], Rgb(0));
  }
  if (negative) f.lose("negative radiances of the sky become 0");
  if (t.rgb.size() == 1) return one_colour(t.rgb[0] * sky.colour);
  if (std::all_of(t.rgb.begin(), t.rgb.end(), [](const Rgb& c) { return !(max_component(c) > 0); }))
    return;

  const Affine to_map = sky.to_map * f.out.frame.to_gltf.transposed();
  const bool grey = sky.colour.x == sky.colour.y && sky.colour.y == sky.colour.z;
  const bool turned = length(to_map.y - Vec3d(0, 1, 0)) < 1e-6 && !to_map.mirrors();
  const bool plain = sky.layout == Sky::Layout::latlong && t.width == 2 * t.height &&
                     t.width <= kWidest && !negative;
  const bool exr = image.bytes.starts_with("\x76\x2f\x31\x01"), hdr = is_radiance_hdr(image.bytes);
  const bool copied = grey && turned && plain && (exr || hdr);
  f.out.environment_suffix = copied && hdr ? ".hdr" : ".exr";
  extras["tdpt_environment"] = f.how.environment + f.out.environment_suffix;
  if (copied) {
    f.out.environment = image.bytes;
    // The map's -z lies at to_map's inverse of it; a positive rotation is counter-clockwise from
    // above.
    const Vec3d centre = to_map.transposed().vector({0, 0, -1});
    const double degrees = std::atan2(-centre.x, -centre.z) * 180 / pi;
    if (std::abs(degrees) > 1e-9) extras["tdpt_environment_rotation"] = degrees;
    if (sky.colour.x != 1) extras["tdpt_environment_scale"] = sky.colour.x;
    return;
  }
  // The new map is as fine as the old one; texels of equal-area squares have 3.5 rad / width.
  const int width =
      std::clamp(sky.layout == Sky::Layout::octahedral ? 2 * t.width : t.width, 4, kWidest);
  ExrFile resampled;
  resampled.picture = Turned(t, sky, to_map.transposed(), width / 2 * 2).picture();
  f.out.environment = exr_bytes(resampled);
}

}  // namespace tdpt::foreign
