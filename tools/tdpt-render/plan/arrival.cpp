#include "tools/tdpt-render/plan/arrival.h"

#include <algorithm>

namespace tdpt {
namespace {

constexpr double kByPower = 0.1;
constexpr double kBrightest = 0.1;  // largest share of the total that one path counts for

void add(Lights::KindProbabilities& sum, const Lights::KindProbabilities& s, double factor) {
  sum.surfaces += factor * s.surfaces;
  sum.lamps += factor * s.lamps;
  sum.parallel += factor * s.parallel;
  sum.sky += factor * s.sky;
}

}  // namespace

void ArrivingLight::see(const Path& path, double light) {
  if (path.k() >= 2) found_.push_back({path.vertex(0).source, light});
}

void ArrivingLight::merge(const ArrivingLight& other) {
  found_.insert(found_.end(), other.found_.begin(), other.found_.end());
}

Lights::KindProbabilities ArrivingLight::shares(const Lights::KindProbabilities& by_power) const {
  double all = 0, sum = 0;
  for (const auto& [source, light] : found_) all += light;
  Lights::KindProbabilities arrived, shares;
  for (const auto& [source, light] : found_) {
    const double told = std::min(light, kBrightest * all);
    arrived.of(*source) += told;
    sum += told;
  }
  if (!(sum > 0)) return by_power;
  add(shares, by_power, kByPower);
  add(shares, arrived, (1 - kByPower) / sum);
  return shares;
}

}  // namespace tdpt
