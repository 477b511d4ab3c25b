#include "libcommon/scene/sky.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "libcommon/math/warp.h"

namespace tdpt {
namespace {

using std::numbers::pi;

// Versine of the half angle: solid angle over 2 pi, without loss for small ones.
double height_of(const Sky::Sun& sun) {
  const double s = std::sin(0.5 * sun.half_angle);
  return 2 * s * s;
}

bool holds(const Sky::Sun& sun, const Vec3d& towards) {
  const Vec3d d = towards - sun.towards;  // |d| = 2 sin(angle / 2)
  return 0.5 * dot(d, d) <= height_of(sun);
}

}  // namespace

Sky::Sky(Map map, double rotation, std::vector<Sun> suns)
    : map_(std::move(map)),
      cos_(std::cos(rotation)),
      sin_(std::sin(rotation)),
      suns_(std::move(suns)) {}

void Sky::raster(const Vec3d& w, double& x, double& y) const {
  // Turned back about +y.
  const double wx = cos_ * w.x - sin_ * w.z, wz = sin_ * w.x + cos_ * w.z;
  const double u = 0.5 + std::atan2(wx, -wz) * (0.5 * std::numbers::inv_pi);
  const double v = std::acos(std::clamp(w.y, -1.0, 1.0)) * std::numbers::inv_pi;
  x = std::min(u * map_.width, std::nextafter(static_cast<double>(map_.width), 0.0));
  y = std::min(v * map_.height, std::nextafter(static_cast<double>(map_.height), 0.0));
}

Vec3d Sky::towards(double x, double y) const {
  const double phi = (x / map_.width - 0.5) * 2 * pi, theta = y / map_.height * pi;
  const double s = std::sin(theta), wx = s * std::sin(phi), wz = -s * std::cos(phi);
  return {cos_ * wx + sin_ * wz, std::cos(theta), -sin_ * wx + cos_ * wz};
}

Rgb Sky::radiance(const Vec3d& w) const {
  Rgb sum{};
  if (one_colour()) {
    sum = map_.texels[0];
  } else if (!map_.texels.empty()) {
    double x, y;
    raster(w, x, y);
    sum = map_.texels[static_cast<size_t>(y) * static_cast<size_t>(map_.width) +
                      static_cast<size_t>(x)];
  }
  for (const Sun& sun : suns_)
    if (holds(sun, w)) sum += sun.radiance;
  return sum;
}

SkyDirections::SkyDirections(const Sky& sky,
                             const std::function<double(const Vec3d& towards)>& weight)
    : sky_(&sky) {
  constexpr int kColumns = 128, kRows = 64;  // at least
  const Sky::Map& map = sky.map();
  if (map.width > 0) {
    columns_ = map.width * std::max(1, kColumns / map.width);
    rows_ = map.height * std::max(1, kRows / map.height);
  }
  for (int i = 0; i <= rows_ && rows_ > 0; ++i)
    cos_of_row_.push_back(i == rows_ ? -1 : std::cos(pi * i / rows_));
  std::vector<double> weights;
  const auto add = [&](const Vec3d& towards, double luminance, double solid_angle) {
    double w = luminance * solid_angle;
    if (w > 0 && weight) w *= weight(towards);
    weights.push_back(w);
    total_ += w;
  };
  for (int i = 0; i < rows_; ++i) {
    const double solid_angle =
        (cos_of_row_[static_cast<size_t>(i)] - cos_of_row_[static_cast<size_t>(i) + 1]) * 2 * pi /
        columns_;
    const int row = i * map.height / rows_;
    for (int j = 0; j < columns_; ++j) {
      const int column = j * map.width / columns_;
      const Rgb& texel = map.texels[static_cast<size_t>(row) * static_cast<size_t>(map.width) +
                                    static_cast<size_t>(column)];
      add(sky.towards((j + 0.5) * map.width / columns_, (i + 0.5) * map.height / rows_),
          luminance(texel), solid_angle);
    }
  }
  for (const Sky::Sun& sun : sky.suns())
    add(sun.towards, luminance(sun.radiance), 2 * pi * height_of(sun));
  if (total_ > 0) table_ = AliasTable(weights);
}

Vec3d SkyDirections::sample(double pick, double u, double v) const {
  const uint32_t i = table_.sample(pick);
  const auto cells = static_cast<uint32_t>(columns_ * rows_);
  if (i >= cells) {
    const Sky::Sun& sun = sky_->suns()[i - cells];
    const double h = v * height_of(sun);  // 1 - cos
    const double r = std::sqrt(h * (2 - h)), phi = 2 * pi * u;
    const Vec3d at(r * std::cos(phi), r * std::sin(phi), 1 - h);
    return normalize(Onb<double>(sun.towards).to_world(at));
  }
  const uint32_t row = i / static_cast<uint32_t>(columns_),
                 column = i % static_cast<uint32_t>(columns_);
  const double z = cos_of_row_[row] + v * (cos_of_row_[row + 1] - cos_of_row_[row]);
  return normalize(sky_->towards((column + u) * sky_->map().width / columns_,
                                 std::acos(z) / pi * sky_->map().height));
}

double SkyDirections::pdf_w(const Vec3d& towards) const {
  if (empty()) return 0;
  double sum = 0;
  const auto cells = static_cast<uint32_t>(columns_ * rows_);
  if (cells > 0) {
    double x, y;
    sky_->raster(towards, x, y);
    const auto row = static_cast<uint32_t>(y * rows_ / sky_->map().height);
    const auto column = static_cast<uint32_t>(x * columns_ / sky_->map().width);
    sum = table_.pdf_1(row * static_cast<uint32_t>(columns_) + column) * columns_ /
          (2 * pi * (cos_of_row_[row] - cos_of_row_[row + 1]));
  }
  for (uint32_t i = 0; i < sky_->suns().size(); ++i)
    if (const Sky::Sun& sun = sky_->suns()[i]; holds(sun, towards))
      sum += table_.pdf_1(cells + i) / (2 * pi * height_of(sun));
  return sum;
}

}  // namespace tdpt
