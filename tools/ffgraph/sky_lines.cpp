#include "tools/ffgraph/sky_lines.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcommon/math/warp.h"

namespace tdpt {
namespace {

constexpr double kByLight = 0.5;               // share of the lines chosen in proportion to light
constexpr double kAimed = 0.5, kWider = 0.25;  // shares aimed at the first and second ball
constexpr double kAround = 1.1;  // factor on a ball's radius, so that outer walls are hit, too

SkyLines::Ball ball_about(const Extent& box) {
  return {(box.low + box.high) * 0.5, kAround * 0.5 * length(box.size())};
}

}  // namespace

std::vector<double> sky_grades(const std::vector<double>& light) {
  std::vector<std::pair<double, double>> shining;  // radiance, solid angle
  double total = 0, below = 0, median = 0;
  for (uint32_t k = 0; k < light.size(); ++k) {
    const double sr = sky_bin_solid_angle(k);
    if (light[k] > 0) shining.emplace_back(light[k] / sr, sr), total += sr;
  }
  std::sort(shining.begin(), shining.end());
  for (const auto& [radiance, sr] : shining) {
    median = radiance;
    if ((below += sr) >= 0.5 * total) break;
  }
  std::vector<double> grade(light.size(), 0);
  for (uint32_t k = 0; k < light.size(); ++k)
    if (light[k] > 0) grade[k] = std::min(1.0, light[k] / sky_bin_solid_angle(k) / (0.5 * median));
  return grade;
}

SkyLines::SkyLines(const Scene& scene, const Extent& aim, const Extent& wider) {
  Extent whole;
  for (const Vec3f& p : scene.positions) whole.add(Vec3d(p));
  balls_ = {ball_about(aim.empty() ? whole : aim), ball_about(wider.empty() ? whole : wider),
            ball_about(whole)};
  for (const PunctualLight& l : scene.lights) {
    if (l.kind != PunctualLight::Kind::directional) continue;
    parallel_.push_back(-l.direction);
    irradiance_.push_back(luminance(l.intensity));
  }
  std::vector<double> weights = irradiance_;
  if (scene.sky) directions_ = SkyDirections(*scene.sky), sky_ = scene.sky.get();
  weights.push_back(directions_.total());
  lights_ = AliasTable(weights);
  weights = sky_grades(sky_bin_light(scene));
  for (uint32_t k = 0; k < kSkyBins; ++k) weights[k] *= sky_bin_solid_angle(k);
  bins_ = AliasTable(weights);
}

SkyLines::Towards SkyLines::towards(Rng& rng) const {
  const bool by_light = rng.uniform() < kByLight;
  const double pick = rng.uniform();
  const double part = rng.uniform();
  const double u = rng.uniform();
  const double v = rng.uniform();
  Vec3d w;
  if (by_light) {
    const uint32_t i = lights_.sample(pick);
    if (i < parallel_.size()) return {parallel_[i], irradiance_[i] / (kByLight * lights_.pdf_1(i))};
    w = directions_.sample(part, u, v);
  } else {
    const std::array<Vec3d, 3>& c = sky_bin_corners(bins_.sample(pick));
    double b1, b2;
    uniform_triangle(u, v, b1, b2);
    w = normalize(c[0] + (c[1] - c[0]) * b1 + (c[2] - c[0]) * b2);
  }
  if (!sky_) return {w, 0};
  const uint32_t bin = sky_bin(w);
  const auto sky = static_cast<uint32_t>(parallel_.size());
  const double pdf_w = kByLight * lights_.pdf_1(sky) * directions_.pdf_w(w) +
                       (1 - kByLight) * bins_.pdf_1(bin) / sky_bin_solid_angle(bin);
  return {w, luminance(sky_->radiance(w)) / pdf_w};
}

// Of lines along w through this place [1/canonical area].
double SkyLines::density_across(const Vec3d& through, const Vec3d& w) const {
  constexpr std::array<double, 3> kShares{kAimed, kWider, 1 - kAimed - kWider};
  double density = 0;
  for (size_t k = 0; k < balls_.size(); ++k) {
    const double area = std::numbers::pi * balls_[k].radius * balls_[k].radius;
    const Vec3d off = cross(through - balls_[k].centre, w);
    if (std::numbers::pi * dot(off, off) <= area * (1 + 1e-9)) density += kShares[k] / area;
  }
  return density;
}

SkyLines::Line SkyLines::draw(Rng& rng) const {
  const double which = rng.uniform();
  const Ball& ball = balls_[which < kAimed ? 0 : which < kAimed + kWider ? 1 : 2];
  const Towards from = towards(rng);
  const Vec3d w = -from.w;
  const double phi = 2 * std::numbers::pi * rng.uniform();
  const double r = ball.radius * std::sqrt(rng.uniform());
  // Starts outside everything that may occlude the line.
  const double far = length(ball.centre - balls_[2].centre) + balls_[2].radius + ball.radius;
  const Onb<double> onb(w);
  const Vec3d origin = ball.centre + onb.to_world({r * std::cos(phi), r * std::sin(phi), -far});
  return {origin, w, sky_bin(-w), from.per_pdf / density_across(origin, w)};
}

}  // namespace tdpt
