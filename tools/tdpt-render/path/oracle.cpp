#include "tools/tdpt-render/path/oracle.h"

#include <limits>

namespace tdpt::oracle {
namespace {

using std::numbers::pi;

Vec3d unit(const Vertex& from, const Vertex& to) {
  return normalize(to.position - from.position);
}

double distance2(const Vertex& a, const Vertex& b) {
  const Vec3d d = b.position - a.position;
  return dot(d, d);
}

double cosine_at(const Vertex& at, const Vertex& other) {
  return std::abs(dot(at.normal, unit(at, other)));
}

/// Direction density at `at` [1/sr]: cos/pi on the side of `from`.
double pdf_w(const Vertex& from, const Vertex& at, const Vertex& to) {
  const bool same = dot(at.normal, unit(at, from)) * dot(at.normal, unit(at, to)) > 0;
  return same ? cosine_at(at, to) / pi : 0;
}

bool emits(const Vertex& x0, const Vertex& x1) {
  return luminance(x0.material->emission) > 0 &&
         (x0.material->double_sided || dot(x0.normal, unit(x0, x1)) > 0);
}

double film_pdf_w(const World& world, const Vertex& camera, const Vertex& x) {
  return world.film.pdf_w(unit(camera, x));
}

/// p_AA of eq. 4, polygon by polygon with its cosines written out.
double segment_pdf(const World& world, const Vertex& a, const Vertex& b) {
  const Vec3d w = unit(a, b);
  const double G = cosine_at(a, b) * cosine_at(b, a) / distance2(a, b);
  double total_area = 0, sum = 0;
  for (size_t i = 0; i < world.portals.size(); ++i) {
    const PortalSet::Polygon& q = world.portals.polygon(static_cast<int>(i));
    total_area += 0.5 * length(cross(q.e1, q.e2));
  }
  for (size_t i = 0; i < world.portals.size(); ++i) {
    const PortalSet::Polygon& q = world.portals.polygon(static_cast<int>(i));
    const double cos_q = dot(q.normal, w);
    if (cos_q <= 0) continue;
    const double t = dot(q.normal, q.p0 - a.position) / cos_q;
    if (t < 0 || t > std::sqrt(distance2(a, b))) continue;
    // Inside: the point is left of all three edges.
    const Vec3d at = a.position + w * t;
    const Vec3d p[3] = {q.p0, q.p0 + q.e1, q.p0 + q.e2};
    bool inside = true;
    for (int e = 0; e < 3; ++e)
      inside = inside && dot(q.normal, cross(p[(e + 1) % 3] - p[e], at - p[e])) >= 0;
    if (!inside) continue;
    const double area = 0.5 * length(cross(q.e1, q.e2));
    const double p_q = area / total_area, p_A = 1 / area, p_w = cos_q / pi;
    sum += p_q * p_A * p_w / cos_q * G;
  }
  return sum;
}

}  // namespace

std::vector<StrategyDensity> densities(const World& world, const Path& path, TechniqueSet set,
                                       Fault fault) {
  const int k = path.k();
  std::vector<double> from_light(static_cast<size_t>(k)), from_camera(static_cast<size_t>(k));
  for (int i = 0; i < k; ++i) {
    const Vertex& x = path.vertex(i);
    double& P_light = from_light[static_cast<size_t>(i)];
    double& P_camera = from_camera[static_cast<size_t>(i)];
    if (i == 0) {
      P_light = world.emitters.pdf_A(x.triangle);
    } else {
      const Vertex& before = path.vertex(i - 1);
      const double p =
          i == 1 ? (emits(before, x)
                        ? cosine_at(before, x) / (before.material->double_sided ? 2 * pi : pi)
                        : 0)
                 : pdf_w(path.vertex(i - 2), before, x);
      P_light = p * cosine_at(x, before) / distance2(before, x);
      if (fault == Fault::missing_cosine && i == 2) P_light /= cosine_at(x, before);
    }
    const Vertex& after = path.vertex(i + 1);
    const double p = i == k - 1 ? film_pdf_w(world, after, x) : pdf_w(path.vertex(i + 2), after, x);
    P_camera = p * cosine_at(x, after) / distance2(after, x);
  }

  std::vector<StrategyDensity> result;
  const auto add = [&](Technique technique, int split) {
    if (!set.has(technique)) return;
    const bool portal = technique == Technique::portal;
    double log_p = 0;
    for (int i = 0; i < split; ++i) log_p += std::log(from_light[static_cast<size_t>(i)]);
    for (int i = portal ? split + 2 : split; i < k; ++i)
      log_p += std::log(from_camera[static_cast<size_t>(i)]);
    if (portal) {
      double p = segment_pdf(world, path.vertex(split), path.vertex(split + 1));
      if (fault == Fault::portal_density_5_percent) p *= 1.05;
      log_p += std::log(p);
    }
    result.push_back({{technique, split}, log_p});
  };
  add(Technique::camera, 0);
  if (k >= 2) {
    add(Technique::direct, 1);
    add(Technique::light, k);
    for (int s = 2; s <= k - 1; ++s) add(Technique::bi, s);
    for (int a = 0; a <= k - 2; ++a) add(Technique::portal, a);
  }
  return result;
}

double weight(const std::vector<StrategyDensity>& densities, Strategy used) {
  double largest = -std::numeric_limits<double>::infinity(), mine = largest, total = 0;
  for (const StrategyDensity& d : densities) {
    largest = std::max(largest, d.log_p);
    if (d.strategy.technique == used.technique && d.strategy.split == used.split) mine = d.log_p;
  }
  for (const StrategyDensity& d : densities) total += std::exp(d.log_p - largest);
  return std::exp(mine - largest) / total;
}

Vec3d contribution(const World& world, const Path& path) {
  const int k = path.k();
  const Vertex& x0 = path.vertex(0);
  if (!emits(x0, path.vertex(1))) return {};
  Vec3d value(x0.material->emission);
  for (int i = 0; i + 1 < k; ++i) {
    const Vertex& a = path.vertex(i);
    const Vertex& b = path.vertex(i + 1);
    value *= cosine_at(a, b) * cosine_at(b, a) / distance2(a, b);
    const bool reflects =
        dot(b.normal, unit(b, a)) * dot(b.normal, unit(b, path.vertex(i + 2))) > 0;
    value = value * Vec3d(b.material->base_color) * (reflects ? 1 / pi : 0);
  }
  const Vertex& last = path.vertex(k - 1);
  const Vertex& camera = path.vertex(k);
  return value *
         (film_pdf_w(world, camera, last) * cosine_at(last, camera) / distance2(camera, last));
}

}  // namespace tdpt::oracle
