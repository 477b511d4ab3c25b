#include "tools/tdpt-render/film.h"

#include <cmath>

namespace tdpt {

Film::Film(int width, int height, double power)
    : width_(width),
      height_(height),
      unit_(std::exp2(std::ceil(std::log2(power > 0 ? power : 1.0)) - 40)),
      camera_(static_cast<size_t>(width) * static_cast<size_t>(height)),
      splats_(std::make_unique<Splats[]>(camera_.size())) {}

bool Film::splat(int x, int y, const Rgb& radiance) {
  if (!(max_component(radiance) / unit_ < 0x1p63)) return false;
  Splats& sums = splats_[index(x, y)];
  for (int c = 0; c < 3; ++c) {
    const int64_t units = std::llround(radiance[c] / unit_);
    const auto i = static_cast<size_t>(c);
    if (units >> 32) sums.high[i].fetch_add(units >> 32, std::memory_order_relaxed);
    sums.low[i].fetch_add(units & 0xffffffff, std::memory_order_relaxed);
  }
  return true;
}

Picture Film::resolve(uint64_t spp) const {
  Picture picture{width_, height_, {}};
  picture.pixels.reserve(camera_.size());
  const double share = spp > 0 ? 1.0 / static_cast<double>(spp) : 0;
  for (size_t i = 0; i < camera_.size(); ++i) {
    const auto splat = [&](size_t c) {
      const auto high = static_cast<double>(splats_[i].high[c].load(std::memory_order_relaxed));
      const auto low = static_cast<double>(splats_[i].low[c].load(std::memory_order_relaxed));
      return unit_ * (0x1p32 * high + low);
    };
    const Vec3d sum = camera_[i] + Vec3d{splat(0), splat(1), splat(2)};
    picture.pixels.push_back(Vec3f(sum * share));
  }
  return picture;
}

}  // namespace tdpt
