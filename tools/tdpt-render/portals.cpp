#include "tools/tdpt-render/portals.h"

#include <algorithm>
#include <numbers>

#include "libcommon/math/warp.h"

namespace tdpt {

PortalSet::PortalSet(const std::vector<Portal>& portals, const Frame& frame) {
  std::vector<double> areas;
  double total = 0;
  for (const Portal& portal : portals) {
    for (const auto& t : portal.triangles) {
      Polygon q;
      q.portal = static_cast<uint32_t>(portals_);
      q.p0 = frame.to_canonical(portal.vertices[t[0]]);
      q.e1 = frame.to_canonical(portal.vertices[t[1]]) - q.p0;
      q.e2 = frame.to_canonical(portal.vertices[t[2]]) - q.p0;
      const Vec3d n = cross(q.e1, q.e2);
      const double twice_area = length(n);
      if (!(twice_area > 1e-24)) continue;
      q.normal = n / twice_area;
      q.grad1 = cross(q.e2, q.normal) / twice_area;
      q.grad2 = cross(q.normal, q.e1) / twice_area;
      polygons_.push_back(q);
      areas.push_back(0.5 * twice_area);
      total += areas.back();
    }
    ++portals_;
  }
  // p(q) = A_q / total, so p(q) / (A_q pi) is the same for every triangle.
  for (Polygon& q : polygons_) q.density = 1 / (total * std::numbers::pi);
  if (!polygons_.empty()) table_ = AliasTable(areas);
  make_facets();
  make_pairs();
}

void PortalSet::make_facets() {
  constexpr double kSamePlane = 1e-6;
  std::vector<double> areas;
  for (uint32_t i = 0; i < polygons_.size(); ++i) {
    Polygon& q = polygons_[i];
    const double area = 0.5 * length(cross(q.e1, q.e2));
    const bool joins = i > 0 && polygons_[i - 1].portal == q.portal &&
                       dot(facets_.back().normal, q.normal) > 1 - kSamePlane * kSamePlane &&
                       std::abs(dot(facets_.back().normal, q.p0 - facets_.back().p0)) < kMargin;
    if (!joins) {
      facets_.emplace_back();
      facets_.back().p0 = q.p0;
      facets_.back().normal = q.normal;
      facets_.back().first = i;
      areas.clear();
    }
    Facet& f = facets_.back();
    q.facet = static_cast<uint32_t>(facets_.size() - 1);
    f.centre = (f.centre * f.area + (q.p0 + (q.e1 + q.e2) / 3) * area) / (f.area + area);
    f.area += area;
    f.end = i + 1;
    for (const Vec3d& corner : {q.p0, q.p0 + q.e1, q.p0 + q.e2})
      if (std::none_of(f.corners.begin(), f.corners.end(),
                       [&](const Vec3d& c) { return length(c - corner) < 1e-9; }))
        f.corners.push_back(corner);
    areas.push_back(area);
    f.table = AliasTable(areas);
  }
}

void PortalSet::make_pairs() {
  constexpr size_t kMostFacets = 16;
  constexpr double kShare = 0.25;  // c
  if (facets_.size() > kMostFacets) return;
  const auto all = [](const Facet& of, const Facet& f, double side) {
    return std::all_of(of.corners.begin(), of.corners.end(), [&](const Vec3d& corner) {
      return side * dot(f.normal, corner - f.p0) > kMargin;
    });
  };
  std::vector<double> etendue;
  for (uint32_t i = 0; i < facets_.size(); ++i)
    for (uint32_t j = 0; j < facets_.size(); ++j) {
      const Facet &f = facets_[i], &g = facets_[j];
      if (i == j || !all(g, f, 1) || !all(f, g, -1)) continue;
      const Vec3d d = g.centre - f.centre;
      const double d2 = dot(d, d);
      pairs_.push_back({i, j, 0});
      etendue.push_back(f.area * g.area * dot(f.normal, d) * dot(g.normal, d) / (d2 * d2));
    }
  if (pairs_.empty()) return;
  pair_table_ = AliasTable(etendue);
  for (uint32_t i = 0; i < pairs_.size(); ++i)
    pairs_[i].pdf = kShare * pair_table_.pdf_1(i) /
                    (facets_[pairs_[i].first].area * facets_[pairs_[i].second].area);
  pair_share_ = kShare;
  for (Polygon& q : polygons_) q.density *= 1 - kShare;
}

Vec3d PortalSet::point_in(int triangle, double u, double v) const {
  const Polygon& q = polygon(triangle);
  double b1, b2;
  uniform_triangle(u, v, b1, b2);
  return q.p0 + q.e1 * b1 + q.e2 * b2;
}

Vec3d PortalSet::point_on(const Facet& f, double pick, double u, double v, int& triangle) const {
  triangle = static_cast<int>(f.first + f.table.sample(pick));
  return point_in(triangle, u, v);
}

double PortalSet::weight(const Facet& f, const Vec3d& v) const {
  if (facets_.size() == 1) return 1;
  const Vec3d d = f.centre - v;
  const double d2 = dot(d, d), distance = std::sqrt(d2);
  // Seen at a grazing angle a facet keeps a tenth of the weight.
  const double height = std::max(std::abs(dot(f.normal, d)), 0.1 * distance);
  const double reach = d2 + f.area / std::numbers::pi;
  return f.area * height / (reach * std::sqrt(reach));
}

bool PortalSet::aimable(const Facet& f, const Vec3d& v, const Vec3d& facing, Way way) {
  const double height = dot(f.normal, v - f.p0);
  if (!(way == Way::with_light ? height < -kMargin : height > kMargin)) return false;
  if (facing == Vec3d()) return true;
  for (const Vec3d& corner : f.corners)
    if (dot(facing, corner - v) > 0) return true;
  return false;
}

double PortalSet::aims(const Vec3d& v, const Vec3d& facing, Way way) const {
  double sum = 0;
  for (const Facet& f : facets_)
    if (aimable(f, v, facing, way)) sum += weight(f, v);
  return sum;
}

int PortalSet::aim(const Vec3d& v, const Vec3d& facing, Way way, double W,
                   const std::array<double, 3>& u, Vec3d& w) const {
  double rest = u[2] * W;
  const Facet* chosen = nullptr;
  for (const Facet& f : facets_) {
    if (!aimable(f, v, facing, way)) continue;
    chosen = &f;
    rest -= weight(f, v);
    if (rest < 0) break;
  }
  // What chose the facet within W chooses the triangle within the facet.
  const double within = std::clamp(1 + rest / weight(*chosen, v), 0.0, 1.0);
  int triangle;
  w = normalize(point_on(*chosen, within, u[0], u[1], triangle) - v);
  return triangle;
}

int PortalSet::crossed(const Facet& f, const Vec3d& at, const Drawn& drawn) const {
  constexpr double kBorder = 1e-4;
  const auto within = [&](int triangle) {
    return triangle >= static_cast<int>(f.first) && triangle < static_cast<int>(f.end);
  };
  const int here = within(drawn.polygon) ? drawn.polygon : within(drawn.second) ? drawn.second : -1;
  int n = 0;
  for (int i = static_cast<int>(f.first); i < static_cast<int>(f.end); ++i)
    n += i == here || polygon(i).holds(at, here >= 0 ? kBorder : 0);
  return n;
}

double PortalSet::density(const Vec3d& from, const Vec3d& to, const Drawn& drawn) const {
  double sum = 0;
  const Vec3d d = to - from;
  for (const Facet& f : facets_) {
    const double before = dot(f.normal, from - f.p0);  // < 0 on the light's side
    const double slope = dot(f.normal, d);
    if (!(before < -kMargin && before + slope > kMargin)) continue;
    sum += polygons_[f.first].density * crossed(f, from - d * (before / slope), drawn);
  }
  return sum > 0 && !pairs_.empty() ? sum + pair_density(from, d, drawn) : sum;
}

double PortalSet::pair_density(const Vec3d& from, const Vec3d& d, const Drawn& drawn) const {
  double sum = 0;
  for (const Pair& pair : pairs_) {
    double t[2], slope[2];
    int ways = 1;  // choices of triangles that give this line
    for (int i = 0; i < 2 && ways > 0; ++i) {
      const Facet& f = facets_[i == 0 ? pair.first : pair.second];
      const double before = dot(f.normal, from - f.p0);
      slope[i] = dot(f.normal, d);
      if (!(before < -kMargin && before + slope[i] > kMargin)) {
        ways = 0;
        break;
      }
      t[i] = -before / slope[i];
      ways *= crossed(f, from + d * t[i], drawn);
    }
    if (ways == 0) continue;
    // Distance and cosines by parts of d: (t1 - t0) |d| and slope / |d|.
    const double d2 = dot(d, d), part = t[1] - t[0];
    sum += ways * pair.pdf * part * part * d2 * d2 / (slope[0] * slope[1]);
  }
  return sum;
}

bool PortalSet::spans(const Drawn& drawn, const Vec3d& x_l, const Vec3d& x_c) const {
  for (const int triangle : {drawn.polygon, drawn.second}) {
    if (triangle < 0) continue;
    const Facet& f = facets_[polygon(triangle).facet];
    if (!(dot(f.normal, x_l - f.p0) < -kMargin && dot(f.normal, x_c - f.p0) > kMargin))
      return false;
  }
  return true;
}

PortalSet::Crossing PortalSet::crossing(const Vec3d& from, const Vec3d& to,
                                        const Drawn& drawn) const {
  Crossing c{};
  const Vec3d d = to - from;
  for (const Facet& f : facets_) {
    const double before = dot(f.normal, from - f.p0);
    const double slope = dot(f.normal, d);
    const bool begins = before < -kMargin;
    const bool ends = before + slope > kMargin;
    if (!(slope > 0) || !(begins || ends)) continue;
    const double t = -before / slope;
    const int n = crossed(f, from + d * t, drawn);
    if (n == 0) continue;
    if (begins && ends) c.density += n * polygons_[f.first].density;
    // d^2 / (cos A), the distance along the edge t or 1 - t of it.
    const double length2 = dot(d, d);
    const double per_area = n * length2 * std::sqrt(length2) / (slope * f.area);
    if (begins) c.from_light += weight(f, from) * t * t * per_area;
    if (ends) c.from_camera += weight(f, to) * (1 - t) * (1 - t) * per_area;
  }
  if (c.density > 0 && !pairs_.empty()) c.density += pair_density(from, d, drawn);
  return c;
}

PortalSet::Sample PortalSet::sample(Rng& rng) const {
  std::array<double, 7> u;
  for (double& x : u) x = rng.uniform();
  return sample(u);
}

PortalSet::Sample PortalSet::sample(const std::array<double, 7>& numbers) const {
  const auto [u, v, s, t, pick, kind, other] = numbers;
  Sample sample;
  if (kind < pair_share_) {
    const Pair& pair = pairs_[pair_table_.sample(kind / pair_share_)];
    sample.position = point_on(facets_[pair.first], pick, u, v, sample.drawn.polygon);
    const Vec3d to = point_on(facets_[pair.second], other, s, t, sample.drawn.second);
    sample.direction = normalize(to - sample.position);
    return sample;
  }
  const int i = static_cast<int>(table_.sample(pick));
  sample.drawn.polygon = i;
  sample.position = point_in(i, u, v);
  sample.direction = normalize(Onb<double>(polygon(i).normal).to_world(cosine_hemisphere(s, t)));
  return sample;
}

}  // namespace tdpt
