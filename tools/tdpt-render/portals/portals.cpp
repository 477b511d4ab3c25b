#include "tools/tdpt-render/portals/portals.h"

#include <algorithm>
#include <numbers>

#include "libcommon/math/warp.h"

namespace tdpt {

namespace {

constexpr double kLeastTwiceArea = 1e-24;  // canonical; less is degenerate

double twice_area(const Corners& t) {
  return length(cross(t[1] - t[0], t[2] - t[0]));
}

PlanarFacet turned_round(PlanarFacet facet) {
  facet.normal = -facet.normal;
  for (Corners& t : facet.triangles) std::swap(t[1], t[2]);
  return facet;
}

// How far the corners of a polygon may lie from its plane (canonical). A file's rounding is that of
// its last digit; programs that turned or scaled the vertices before have rounded a few times.
double planarity(const Portal& portal, const Frame& frame) {
  constexpr double kRoundings = 4;
  double largest = 0;
  for (const Vec3d& v : portal.vertices)
    largest = std::max(largest, length(v) + length(frame.centre));
  return frame.scale * (kRoundings * portal.rounding + std::ldexp(largest, -46));
}

}  // namespace

PortalSet::PortalSet(const std::vector<Portal>& portals, const Frame& frame) {
  for (const Portal& portal : portals) {
    std::vector<Corners> triangles;
    for (const auto& t : portal.triangles) {
      Corners corners;
      for (size_t i = 0; i < 3; ++i) corners[i] = frame.to_canonical(portal.vertices[t[i]]);
      if (twice_area(corners) > kLeastTwiceArea) triangles.push_back(corners);
    }
    const auto facets = planar_facets(triangles, planarity(portal, frame));
    for (const PlanarFacet& facet : facets) add_facet(facet, static_cast<uint32_t>(portals_));
    if (portal.both_ways)
      for (const PlanarFacet& facet : facets)
        add_facet(turned_round(facet), static_cast<uint32_t>(portals_));
    ++portals_;
  }
  if (empty()) return;
  std::vector<double> areas;
  double total = 0;
  for (const Polygon& q : polygons_) {
    areas.push_back(0.5 * length(cross(q.e1, q.e2)));
    total += areas.back();
  }
  // p(q) = A_q / total, so p(q) / (A_q pi) is the same for every triangle.
  for (Polygon& q : polygons_) q.density = 1 / (total * std::numbers::pi);
  table_ = CumulativeTable(areas);
  make_pairs();
}

void PortalSet::add_facet(const PlanarFacet& facet, uint32_t portal) {
  Facet f;
  f.normal = facet.normal;
  f.first = static_cast<uint32_t>(polygons_.size());
  std::vector<double> areas;
  for (const Corners& corners : facet.triangles) {
    const double twice = twice_area(corners);
    if (!(twice > kLeastTwiceArea)) continue;
    Polygon q;
    q.portal = portal;
    q.facet = static_cast<uint32_t>(facets_.size());
    q.p0 = corners[0];
    q.e1 = corners[1] - q.p0;
    q.e2 = corners[2] - q.p0;
    q.normal = f.normal;
    q.grad1 = cross(q.e2, q.normal) / twice;
    q.grad2 = cross(q.normal, q.e1) / twice;
    polygons_.push_back(q);
    const double area = 0.5 * twice;
    f.centre = (f.centre * f.area + (q.p0 + (q.e1 + q.e2) / 3) * area) / (f.area + area);
    f.area += area;
    for (const Vec3d& corner : corners)
      if (std::none_of(f.corners.begin(), f.corners.end(),
                       [&](const Vec3d& c) { return length(c - corner) < 1e-9; }))
        f.corners.push_back(corner);
    areas.push_back(area);
  }
  f.end = static_cast<uint32_t>(polygons_.size());
  if (f.end == f.first) return;
  for (const Vec3d& corner : f.corners)
    f.reach2 = std::max(f.reach2, dot(corner - f.centre, corner - f.centre));
  f.p0 = polygons_[f.first].p0;
  f.table = CumulativeTable(areas);
  facets_.push_back(std::move(f));
}

std::vector<PortalSet::Outline> PortalSet::outlines() const {
  std::vector<Outline> all;
  for (const Facet& f : facets_) all.push_back({f.normal, f.centre, f.area, f.corners});
  return all;
}

void PortalSet::make_pairs() {
  constexpr double kShare = 0.25;  // c
  const auto all = [](const Facet& of, const Facet& f, double side) {
    return std::all_of(of.corners.begin(), of.corners.end(), [&](const Vec3d& corner) {
      return side * dot(f.normal, corner - f.p0) > kMargin;
    });
  };
  // A heap, the weakest of the kept on top.
  const auto stronger = [](const Pair& a, const Pair& b) { return a.etendue > b.etendue; };
  for (uint32_t i = 0; i < facets_.size(); ++i)
    for (uint32_t j = 0; j < facets_.size(); ++j) {
      const Facet &f = facets_[i], &g = facets_[j];
      const Vec3d d = g.centre - f.centre;
      const double cos_f = dot(f.normal, d), cos_g = dot(g.normal, d), d2 = dot(d, d);
      if (!(cos_f > 0 && cos_g > 0)) continue;
      const double etendue = f.area * g.area * cos_f * cos_g / (d2 * d2);
      const bool full = pairs_.size() == kMostPairs;
      if ((full && etendue <= pairs_[0].etendue) || !all(g, f, 1) || !all(f, g, -1)) continue;
      if (full) {
        std::pop_heap(pairs_.begin(), pairs_.end(), stronger);
        pairs_.pop_back();
      }
      pairs_.push_back({i, j, etendue, 0});
      std::push_heap(pairs_.begin(), pairs_.end(), stronger);
    }
  if (pairs_.empty()) return;
  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
  std::vector<double> etendues;
  for (const Pair& pair : pairs_) etendues.push_back(pair.etendue);
  pair_table_ = CumulativeTable(etendues);
  for (uint32_t i = 0; i < pairs_.size(); ++i) {
    Facet& first = facets_[pairs_[i].first];
    pairs_[i].pdf = kShare * pair_table_.pdf_1(i) / (first.area * facets_[pairs_[i].second].area);
    if (first.end_pair == 0) first.first_pair = i;
    first.end_pair = i + 1;
  }
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
  const double d2 = dot(d, d);
  // Seen at a grazing angle a facet keeps a tenth of the weight.
  double height = std::abs(dot(f.normal, d));
  if (height * height < 0.01 * d2) height = 0.1 * std::sqrt(d2);
  const double reach = d2 + f.area / std::numbers::pi;
  return f.area * height / (reach * std::sqrt(reach));
}

bool PortalSet::aimable(const Facet& f, const Vec3d& v, const Vec3d& facing, Way way) {
  const double height = dot(f.normal, v - f.p0);
  if (!(way == Way::with_light ? height < -kMargin : height > kMargin)) return false;
  if (facing == Vec3d()) return true;
  // Where the middle is, a corner is: but for rounding.
  if (dot(facing, f.centre - v) > kMargin) return true;
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

double PortalSet::aims_along(const Vec3d& d) const {
  double sum = 0;
  for (const Facet& f : facets_) sum += across(f, d);
  return sum;
}

int PortalSet::aim_along(const Vec3d& d, double W, const std::array<double, 3>& u,
                         Vec3d& at) const {
  double rest = u[2] * W;
  const Facet* chosen = nullptr;
  for (const Facet& f : facets_) {
    if (!(across(f, d) > 0)) continue;
    chosen = &f;
    rest -= across(f, d);
    if (rest < 0) break;
  }
  const double within = std::clamp(1 + rest / across(*chosen, d), 0.0, 1.0);
  int triangle;
  at = point_on(*chosen, within, u[0], u[1], triangle);
  return triangle;
}

int PortalSet::crossed_along(const Vec3d& d, const Vec3d& to, const Drawn& drawn) const {
  int n = 0;
  for (const Facet& f : facets_) {
    if (!(across(f, d) > 0)) continue;
    const double t = dot(f.normal, f.p0 - to) / dot(f.normal, d);
    n += crossed(f, to + d * t, drawn);
  }
  return n;
}

double PortalSet::across(const Facet& f, const Vec3d& d) {
  constexpr double kEdgeOn = 1e-6;
  const double cos = dot(f.normal, d);
  return cos > kEdgeOn ? f.area * cos : 0;
}

int PortalSet::crossed(const Facet& f, const Vec3d& at, const Drawn& drawn) const {
  constexpr double kBorder = 1e-4;
  const auto within = [&](int triangle) {
    return triangle >= static_cast<int>(f.first) && triangle < static_cast<int>(f.end);
  };
  const int here = within(drawn.polygon) ? drawn.polygon : within(drawn.second) ? drawn.second : -1;
  if (here < 0 && dot(at - f.centre, at - f.centre) > f.reach2 * (1 + kBorder)) return 0;
  int n = 0;
  for (int i = static_cast<int>(f.first); i < static_cast<int>(f.end); ++i)
    n += i == here || polygon(i).holds(at, here >= 0 ? kBorder : 0);
  return n;
}

// D of [eq. 4].
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

PortalSet::Passage PortalSet::passage(const Facet& f, const Vec3d& from, const Vec3d& d,
                                      const Drawn& drawn) const {
  const double before = dot(f.normal, from - f.p0);
  const double slope = dot(f.normal, d);
  if (!(before < -kMargin && before + slope > kMargin)) return {0, 0, 0};
  const double t = -before / slope;
  return {t, slope, crossed(f, from + d * t, drawn)};
}

double PortalSet::pair_density(const Vec3d& from, const Vec3d& d, const Drawn& drawn) const {
  double all = 0;
  for (const Facet& f : facets_) {
    if (f.first_pair == f.end_pair) continue;
    const Passage of_f = passage(f, from, d, drawn);
    double sum = 0;
    for (uint32_t i = f.first_pair; i < f.end_pair && of_f.triangles > 0; ++i) {
      const Passage of_g = passage(facets_[pairs_[i].second], from, d, drawn);
      const int ways = of_f.triangles * of_g.triangles;  // choices of triangles that give this line
      if (ways == 0) continue;
      // Distance and cosines by parts of d: (t1 - t0) |d| and slope / |d|.
      const double d2 = dot(d, d), part = of_g.t - of_f.t;
      sum += ways * pairs_[i].pdf * part * part * d2 * d2 / (of_f.slope * of_g.slope);
    }
    all += sum;
  }
  return all;
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

// x_p and w of [eq. 4].
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
