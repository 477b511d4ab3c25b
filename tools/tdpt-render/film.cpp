#include "tools/tdpt-render/film.h"

#include <cmath>

namespace tdpt {

Film::Film(int width, int height, double power, TechniqueSet layers)
    : width_(width),
      height_(height),
      unit_(std::exp2(std::ceil(std::log2(power > 0 ? power : 1.0)) - 40)),
      picture_(make_plane()) {
  for (size_t i = 0; i < kTechniques; ++i)
    if (layers.has(static_cast<Technique>(i))) layers_[i] = make_plane();
}

Film::Plane Film::make_plane() const {
  return {std::vector<Vec3d>(pixels()), std::make_unique<Splats[]>(pixels()), {}};
}

void Film::clear() {
  const auto clear_plane = [this](Plane& plane) {
    if (!plane.splats) return;
    std::vector<Vec3d> others = std::move(plane.others);
    plane = make_plane();
    plane.others = std::move(others);
  };
  clear_plane(picture_);
  for (Plane& layer : layers_) clear_plane(layer);
}

void Film::add_other(const Film& other, double weight) {
  const auto add_plane = [&](Plane& to, const Plane& from) {
    if (!to.splats || !from.splats) return;
    to.others.resize(pixels());
    for (size_t i = 0; i < pixels(); ++i) to.others[i] += sum(from, i) * weight;
  };
  add_plane(picture_, other.picture_);
  for (size_t t = 0; t < kTechniques; ++t) add_plane(layers_[t], other.layers_[t]);
}

std::vector<Vec3d> Film::sums() const {
  std::vector<Vec3d> all(pixels());
  for (size_t i = 0; i < pixels(); ++i) all[i] = sum(picture_, i);
  return all;
}

bool Film::splat(Technique technique, int x, int y, const Rgb& radiance) {
  if (!(max_component(radiance) / unit_ < 0x1p76)) return false;
  std::array<double, 3> units;
  for (int c = 0; c < 3; ++c) units[static_cast<size_t>(c)] = std::round(radiance[c] / unit_);
  add_splat(picture_.splats[index(x, y)], units);
  Plane& layer = layers_[static_cast<size_t>(technique)];
  if (layer.splats) add_splat(layer.splats[index(x, y)], units);
  return true;
}

void Film::add_splat(Splats& sums, const std::array<double, 3>& units) {
  for (size_t c = 0; c < 3; ++c) {
    const double high = std::floor(units[c] * 0x1p-32);
    const auto low = static_cast<int64_t>(units[c] - high * 0x1p32);  // exact
    if (high > 0) sums.high[c].fetch_add(static_cast<int64_t>(high), std::memory_order_relaxed);
    sums.low[c].fetch_add(low, std::memory_order_relaxed);
  }
}

Vec3d Film::sum(const Plane& plane, size_t i) const {
  const Splats& sums = plane.splats[i];
  const auto splat = [&](size_t c) {
    const auto high = static_cast<double>(sums.high[c].load(std::memory_order_relaxed));
    const auto low = static_cast<double>(sums.low[c].load(std::memory_order_relaxed));
    return unit_ * (0x1p32 * high + low);
  };
  return plane.camera[i] + Vec3d{splat(0), splat(1), splat(2)};
}

Rgb Film::pixel(const Plane& plane, size_t i, const Shares& shares) const {
  const Vec3d own = sum(plane, i) * shares.samples;
  return Vec3f(plane.others.empty() ? own : own + plane.others[i] * shares.others);
}

Picture Film::resolve(const Plane& plane, const Shares& shares) const {
  Picture picture{width_, height_, {}};
  if (!plane.splats) {
    picture.pixels.resize(pixels());
    return picture;
  }
  picture.pixels.reserve(pixels());
  for (size_t i = 0; i < pixels(); ++i) picture.pixels.push_back(pixel(plane, i, shares));
  return picture;
}

Film::Measure Film::measure(const Shares& shares) const {
  Vec3d sum;
  size_t nonzero = 0;
  for (size_t i = 0; i < pixels(); ++i) {
    const Rgb p = pixel(picture_, i, shares);
    sum += Vec3d(p);
    nonzero += p != Rgb{};
  }
  const auto n = static_cast<double>(pixels());
  return {sum / n, static_cast<double>(nonzero) / n};
}

}  // namespace tdpt
