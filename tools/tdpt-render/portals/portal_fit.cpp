#include "tools/tdpt-render/portals/portal_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tools/tdpt-render/portals/facets.h"

namespace tdpt {
namespace {

constexpr int kRays = 32;
constexpr double kNearest = 0.5, kFarthest = 1.5;  // of the rim's distance
constexpr double kFits = 0.5;

struct Unit {
  double factor;
  const char* words;
};
constexpr std::array kUnits{
    Unit{0.01, "seems drawn in centimetres"},
    Unit{0.001, "seems drawn in millimetres"},
    Unit{0.0254, "seems drawn in inches"},
    Unit{0.3048, "seems drawn in feet"},
    Unit{100, "seems drawn for the same scene in a hundredth of its size"},
    Unit{1000, "seems drawn for the same scene in a thousandth of its size"},
    Unit{1 / 0.0254, "seems drawn for the same scene in 1/39.37 of its size"}};

bool within(const Vec3d& p, const Corners& t, const Vec3d& n) {
  for (size_t i = 0; i < 3; ++i)
    if (dot(cross(t[(i + 1) % 3] - t[i], p - t[i]), n) < 0) return false;
  return true;
}

// Distance from `from` along unit w, in the plane of normal n, to the rim of the triangles around
// it.
double rim_along(const Vec3d& from, const Vec3d& w, const Vec3d& n,
                 const std::vector<Corners>& triangles) {
  const Vec3d side = cross(n, w);
  std::vector<double> ends;
  for (const Corners& t : triangles)
    for (size_t i = 0; i < 3; ++i) {
      const Vec3d a = t[i] - from, b = t[(i + 1) % 3] - from;
      const double u = dot(side, a), v = dot(side, b);
      if ((u < 0) == (v < 0)) continue;
      const double distance = dot(w, a + (b - a) * (u / (u - v)));
      if (distance > 0) ends.push_back(distance);
    }
  std::sort(ends.begin(), ends.end());
  for (const double end : ends) {
    const Vec3d beyond = from + w * (end * (1 + 1e-6));
    if (std::none_of(triangles.begin(), triangles.end(),
                     [&](const Corners& t) { return within(beyond, t, n); }))
      return end;
  }
  return 0;
}

}  // namespace

double fit_of(const Portal& portal, double factor, const Tracer& tracer, const Frame& frame) {
  std::vector<Corners> triangles;
  Vec3d normal, middle;
  for (const auto& t : portal.triangles) {
    Corners& c = triangles.emplace_back();
    for (size_t i = 0; i < 3; ++i) c[i] = frame.to_canonical(portal.vertices[t[i]] * factor);
    const Vec3d n = cross(c[1] - c[0], c[2] - c[0]);
    if (length(n) <= length(normal)) continue;
    normal = n;
    middle = (c[0] + c[1] + c[2]) / 3;
  }
  if (!(length(normal) > 0)) return 0;
  const Onb<double> axes(normalize(normal));
  int fitting = 0;
  for (int i = 0; i < kRays; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / kRays;
    const Vec3d w = axes.to_world({std::cos(angle), std::sin(angle), 0});
    Hit hit;
    if (!tracer.closest({middle}, w, hit)) continue;
    const double rim = rim_along(middle, w, normalize(normal), triangles);
    fitting += hit.distance > kNearest * rim && hit.distance < kFarthest * rim;
  }
  return static_cast<double>(fitting) / kRays;
}

std::string unit_words(const Portal& portal, const Tracer& tracer, const Frame& frame) {
  double best = std::max(kFits, fit_of(portal, 1, tracer, frame));
  std::string words;
  for (const Unit& unit : kUnits)
    if (const double fit = fit_of(portal, unit.factor, tracer, frame); fit > best) {
      best = fit;
      words = unit.words;
    }
  return words;
}

}  // namespace tdpt
