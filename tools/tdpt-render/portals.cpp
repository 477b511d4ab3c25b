#include "tools/tdpt-render/portals.h"

#include <numbers>

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
    for (const Vec3d& corner : {q.p0, q.p0 + q.e1, q.p0 + q.e2}) f.corners.push_back(corner);
    areas.push_back(area);
    f.table = AliasTable(areas);
  }
}

double PortalSet::weight(const Facet& f, const Vec3d& v) {
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

int PortalSet::aim(const Vec3d& v, const Vec3d& facing, Way way, double W, Rng& rng,
                   Vec3d& w) const {
  double rest = rng.uniform() * W;
  const double s = rng.uniform();
  const double t = rng.uniform();
  const Facet* chosen = nullptr;
  for (const Facet& f : facets_) {
    if (!aimable(f, v, facing, way)) continue;
    chosen = &f;
    rest -= weight(f, v);
    if (rest < 0) break;
  }
  // What chose the facet within W chooses the triangle within the facet.
  const double within = std::clamp(1 + rest / weight(*chosen, v), 0.0, 1.0);
  const int i = static_cast<int>(chosen->first + chosen->table.sample(within));
  const Polygon& q = polygon(i);
  double b1, b2;
  uniform_triangle(s, t, b1, b2);
  w = normalize(q.p0 + q.e1 * b1 + q.e2 * b2 - v);
  return i;
}

PortalSet::Crossing PortalSet::crossing(const Vec3d& from, const Vec3d& to, int sampled) const {
  Crossing c;
  const Vec3d d = to - from;
  const double length2 = dot(d, d), whole = std::sqrt(length2);
  for (size_t i = 0; i < polygons_.size(); ++i) {
    const Polygon& q = polygons_[i];
    const Vec3d o = from - q.p0;
    const double before = dot(q.normal, o);
    const double slope = dot(q.normal, d);
    const double after = before + slope;
    const bool begins = before < -kMargin, ends = after > kMargin;
    if (!(slope > 0) || !(begins || ends)) continue;
    const double t = -before / slope;
    if (!crossed(i, o + d * t, sampled)) continue;
    if (begins && ends) c.density += q.density;
    // d^2 / (cos A), the distance along the edge t or 1 - t of it.
    const Facet& f = facets_[q.facet];
    const double per_area = length2 * whole / (slope * f.area);
    if (begins) c.from_light += weight(f, from) * t * t * per_area;
    if (ends) c.from_camera += weight(f, to) * (1 - t) * (1 - t) * per_area;
  }
  return c;
}

double PortalSet::density(const Vec3d& from, const Vec3d& to, int sampled) const {
  double sum = 0;
  const Vec3d d = to - from;
  for (size_t i = 0; i < polygons_.size(); ++i) {
    const Polygon& q = polygons_[i];
    const Vec3d o = from - q.p0;
    const double before = dot(q.normal, o);  // < 0 on the light's side
    const double slope = dot(q.normal, d);
    if (!(before < -kMargin && before + slope > kMargin)) continue;
    if (crossed(i, o - d * (before / slope), sampled)) sum += q.density;
  }
  return sum;
}

PortalSet::Sample PortalSet::sample(Rng& rng) const {
  const double pick = rng.uniform();
  const double u = rng.uniform();
  const double v = rng.uniform();
  const double s = rng.uniform();
  const double t = rng.uniform();
  const int i = static_cast<int>(table_.sample(pick));
  const Polygon& q = polygons_[static_cast<size_t>(i)];
  double b1, b2;
  uniform_triangle(u, v, b1, b2);
  return {i, q.p0 + q.e1 * b1 + q.e2 * b2,
          normalize(Onb<double>(q.normal).to_world(cosine_hemisphere(s, t)))};
}

}  // namespace tdpt
