#include "tools/tdpt-render/testing/oracle.h"

#include <limits>
#include <optional>

#include "libcommon/scene/scene.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/testing/oracle_bsdf.h"

namespace tdpt::oracle {
namespace {

using std::numbers::pi;

/// From a to b; light from infinity travels along its direction.
Vec3d unit(const Vertex& from, const Vertex& to) {
  if (from.at_infinity()) return from.position;
  if (to.at_infinity()) return -to.position;
  return normalize(to.position - from.position);
}

double distance2(const Vertex& a, const Vertex& b) {
  if (a.at_infinity() || b.at_infinity()) return 1;
  const Vec3d d = b.position - a.position;
  return dot(d, d);
}

double cosine_at(const Vertex& at, const Vertex& other) {
  return at.on_surface() ? std::abs(dot(at.normal, unit(at, other))) : 1;
}

/// Lobes and shading normal, without the shortcut of simple vertices.
struct Surface {
  explicit Surface(const Vertex& v)
      : bsdf(v.bsdf), normal(v.normal), onb(v.simple ? v.normal : v.shading) {
    if (!v.simple) return;
    bsdf = surfaces().diffuse_bsdf(v.material->base_color);
  }
  Vec3d local(const Vec3d& w) const { return {dot(onb.x, w), dot(onb.y, w), dot(onb.z, w)}; }
  /// Above both normals or below both.
  bool valid(const Vec3d& w) const { return dot(normal, w) * local(w).z > 0; }

  Bsdf bsdf;
  Vec3d normal;
  Onb<double> onb;
};

bool coated(const Vertex& v) {
  return !v.simple && v.bsdf.coat.strength > 0;
}

/// Density at `at` [1/sr]; for a Dirac lobe per n^2 |cos| dw.
double pdf_w(const Vertex& from, const Vertex& at, const Vertex& to, bool dirac) {
  const Surface s(at);
  const Vec3d wi = unit(at, from), wo = unit(at, to);
  if (coated(at)) return CoatedSurface(at).pdf_w(wi, wo, dirac);
  if (!s.valid(wi) || !s.valid(wo)) return 0;
  const Vec3d i = s.local(wi), o = s.local(wo);
  if (!dirac) return bsdf::pdf_w(s.bsdf, i, o);
  const double n = bsdf::index(s.bsdf, o);
  return bsdf::dirac_probability(s.bsdf, i, o) * n * n * std::abs(o.z);
}

/// Radiance BSDF with geometric cosines; for a Dirac lobe without its delta.
Vec3d scattering(const Vertex& light_side, const Vertex& at, const Vertex& camera_side,
                 bool dirac) {
  const Surface s(at);
  const Vec3d wl = unit(at, light_side), wc = unit(at, camera_side);
  if (coated(at)) return CoatedSurface(at).scattering(wl, wc, dirac);
  if (!s.valid(wl) || !s.valid(wc)) return {};
  const Vec3d l = s.local(wl), c = s.local(wc);
  const double n = bsdf::index(s.bsdf, c);
  const Vec3d f = dirac ? bsdf::dirac_reflectance(s.bsdf, l, c) : bsdf::f(s.bsdf, l, c);
  return f * (n * n * std::abs(l.z) / std::abs(dot(at.normal, wl)));
}

Vec3d emission(const Vertex& x0, const Vertex& x1) {
  if (!x0.on_surface()) return Vec3d(x0.source->emitted({}, {}, unit(x0, x1)));
  if (!x0.material->double_sided && dot(x0.normal, unit(x0, x1)) <= 0) return {};
  const double share = coated(x0) ? CoatedSurface(x0).emission_share(unit(x0, x1)) : 1;
  return Vec3d(x0.simple ? x0.material->emission : x0.emission) * share;
}

bool in_the_sky(const Vertex& x) {
  return x.at_infinity() && x.met();
}

/// Area of the disc, perpendicular to light from infinity, that covers the scene.
double disc_of(const Scene& scene) {
  double radius = 0;
  for (const Triangle& t : scene.triangles)
    for (const uint32_t v : t.vertex) radius = std::max(radius, length(Vec3d(scene.positions[v])));
  return pi * std::pow(1.0001 * radius, 2);
}

/// P>(x_0).
double light_pdf(const Vista& vista, const SkyLight* sky, const Vertex& x0, Fault fault) {
  if (x0.on_surface()) return vista.openings.selection.pdf_A(x0.triangle);
  if (!in_the_sky(x0)) return vista.openings.selection.pdf(*x0.source, ~0u, {}, {});
  const double spoilt = fault == Fault::sky_5_percent ? 1.05 : 1;
  return spoilt * vista.openings.selection.sky_pdf_1() * sky->start_pdf_w(-x0.position);
}

/// p_nee(x_0) of a next event at x_1.
double next_event_pdf(const Vista& vista, const SkyLight* sky, const Path& path,
                      double through_windows, Fault fault) {
  const Vertex& x0 = path.vertex(0);
  if (x0.on_surface() && !vista.world->rect_lights.empty())
    return (fault == Fault::rect_light_5_percent ? 1.05 : 1) *
           vista.openings.selection.shares().surfaces *
           rect_light_pdf_A(vista, x0, path.vertex(1), path.vertex(2));
  if (!in_the_sky(x0)) return light_pdf(vista, sky, x0, fault);
  const double spoilt = fault == Fault::sky_5_percent ? 1.05 : 1;
  const double through = fault == Fault::window_5_percent ? 1.05 : 1;
  return spoilt * vista.openings.selection.sky_pdf_1() *
         sky->next_event_pdf_w(path.vertex(1), path.vertex(2), -x0.position, through_windows,
                               through);
}

/// For surfaces, points and spots [1/sr]; for light from infinity [1/area across it].
double emission_pdf_w(const Vista& vista, const Vertex& x0, const Vertex& x1) {
  if (luminance(Vec3f(emission(x0, x1))) <= 0) return 0;
  if (x0.at_infinity()) return 1 / disc_of(vista.world->scene);
  if (!x0.on_surface()) return 1 / x0.source->cos_per_pdf_w(unit(x0, x1));
  return cosine_at(x0, x1) / (x0.material->double_sided ? 2 * pi : pi);
}

/// Uniform on the part of a plane across the view, at distance 1, that the film covers.
double film_pdf_w(const FilmPlane& film, const Vertex& camera, const Vertex& x) {
  const auto corner = [&](double across, double down) {
    const Vec3d w = film.direction(across * film.width(), down * film.height());
    return w / dot(w, film.forward());
  };
  const double area = length(cross(corner(1, 0) - corner(0, 0), corner(0, 1) - corner(0, 0)));
  return 1 / (area * std::pow(dot(unit(camera, x), film.forward()), 3));
}

using Triangles = std::vector<std::array<Vec3d, 3>>;

/// The triangles of a portal in one direction, all in one plane, and the rectangle around them that
/// counts, too.
struct Facet {
  Triangles triangles;
  std::array<Vec3d, 4> surround;
  Vec3d n, centre;
  double area = 0;

  void add(const PortalSet::Polygon& q) {
    triangles.push_back({q.p0, q.p0 + q.e1, q.p0 + q.e2});
    centre = (centre * area + (q.p0 + (q.e1 + q.e2) / 3) * q.area) / (area + q.area);
    area += q.area;
  }
};

std::vector<Facet> facets(const Vista& vista) {
  std::vector<Facet> all;
  bool complete = true;
  for (size_t i = 0; i < vista.openings.portals.size(); ++i) {
    const PortalSet::Polygon& q = vista.openings.portals.polygon(static_cast<int>(i));
    if (complete) all.emplace_back().n = q.normal;
    complete = q.surround;
    if (complete)
      all.back().surround = {q.p0, q.p0 + q.e1, q.p0 + q.e1 + q.e2, q.p0 + q.e2};
    else
      all.back().add(q);
  }
  return all;
}

/// Whether a point of the plane is left of all edges of a convex polygon.
template <size_t N>
bool holds(const std::array<Vec3d, N>& corners, const Vec3d& n, const Vec3d& at) {
  bool inside = true;
  for (size_t e = 0; e < N; ++e)
    inside = inside && dot(n, cross(corners[(e + 1) % N] - corners[e], at - corners[e])) >= 0;
  return inside;
}

/// Density, times the area of the facet, of the point that the line through `a` along `w` crosses,
/// and its distance.
double coverage(const Facet& f, const Vec3d& a, const Vec3d& w, double& distance,
                Fault fault = Fault::none) {
  const double e = shader::kSurroundShare;
  distance = dot(f.n, f.triangles[0][0] - a) / dot(f.n, w);
  const Vec3d at = a + w * distance;
  int number = 0;
  for (const auto& t : f.triangles) number += holds(t, f.n, at);
  if (fault == Fault::no_surround) return number;
  const double area = length(cross(f.surround[1] - f.surround[0], f.surround[3] - f.surround[0]));
  return (1 - e) * number + (holds(f.surround, f.n, at) ? e * f.area / area : 0);
}

/// Length of the edge from a to b.
double long_is(const Vertex& a, const Vertex& b) {
  return a.at_infinity() ? std::numeric_limits<double>::infinity() : std::sqrt(distance2(a, b));
}

/// Density, over p(F,G), with which the pair of portals makes the line from a to b: per product of
/// area and projected solid angle.
double pair_pdf(const Vertex& a, const Vertex& b, const Facet& F, const Facet& G, double& etendue,
                Fault fault) {
  etendue = 0;
  for (const auto& t : G.triangles)
    for (const Vec3d& corner : t)
      if (dot(F.n, corner - F.triangles[0][0]) <= 0) return 0;
  for (const auto& t : F.triangles)
    for (const Vec3d& corner : t)
      if (dot(G.n, corner - G.triangles[0][0]) >= 0) return 0;
  const Vec3d d = G.centre - F.centre;
  etendue = F.area * G.area * dot(F.n, d) * dot(G.n, d) / std::pow(dot(d, d), 2);
  const Vec3d w = unit(a, b);
  double s, t;  // distances from b; negative in front of it
  const double ways = coverage(F, b.position, w, s, fault) * coverage(G, b.position, w, t, fault);
  // Beside the portals, G may lie before F.
  if (dot(F.n, w) <= 0 || dot(G.n, w) <= 0) return 0;
  if (-std::min(s, t) > long_is(a, b) || std::max(s, t) > 0) return 0;
  return ways / (F.area * G.area) * std::pow(t - s, 2) / (dot(F.n, w) * dot(G.n, w));
}

/// p_AA [eq. 4], facet by facet with its cosines written out, and for pairs of portals. From
/// the sky: per solid angle of its direction and area at b.
double segment_pdf(const Vista& vista, const Vertex& a, const Vertex& b, Fault fault) {
  if (!a.on_surface() && !in_the_sky(a)) return 0;
  const Vec3d w = unit(a, b);
  const double G = cosine_at(a, b) * cosine_at(b, a) / distance2(a, b);
  double total_area = 0, sum = 0;
  const std::vector<Facet> all = facets(vista);
  for (const Facet& f : all) total_area += f.area;
  double pairs = 0, etendues = 0;
  for (size_t i = 0; i < all.size(); ++i)
    for (size_t j = 0; j < all.size(); ++j) {
      if (i == j) continue;
      double etendue;
      const double p = pair_pdf(a, b, all[i], all[j], etendue, fault);
      pairs += etendue * p * G;
      etendues += etendue;
    }
  const double c = etendues > 0 ? 0.25 : 0;
  if (c > 0) sum += c * pairs / etendues;
  for (const Facet& f : all) {
    const double cos_f = dot(f.n, w);
    if (cos_f <= 0) continue;
    double t;  // from b; negative in front of it
    const double ways = coverage(f, b.position, w, t, fault);
    if (t > 0 || -t > long_is(a, b)) continue;
    const double p_f = f.area / total_area, p_A = ways / f.area, p_w = cos_f / pi;
    double p_AA = p_f * p_A * p_w / cos_f * G;
    if (a.at_infinity()) {
      // The portal's area is projected along the line to that at b.
      p_AA = p_f * p_A * p_w * (cosine_at(b, a) / cos_f);
      if (fault == Fault::sky_segment_distance) p_AA /= t * t;
      if (fault == Fault::sky_segment_cosine) p_AA *= cos_f;
    }
    sum += (1 - c) * p_AA;
  }
  return sum;
}

/// Density of the parallel light's line to `to`, among those guided through portals [1/area
/// across].
double guide_line_pdf(const Vista& vista, const Vec3d& d, const Vertex& to) {
  double total = 0, ways = 0;
  for (const Facet& f : facets(vista)) {
    if (dot(f.n, d) <= 0) continue;
    total += f.area * dot(f.n, d);
    double distance;
    ways += coverage(f, to.position, d, distance);
  }
  return total > 0 ? ways / total : -1;
}

/// Density [1/sr] with which guiding of a walk at `at`, coming from `back`, chooses the direction
/// of `to`; null: the walk begins there.
double guide_pdf_w(const Vista& vista, From from, const Vertex* back, const Vertex& at,
                   const Vertex& to) {
  const Vec3d w = unit(at, to);
  double total = 0, sum = 0;
  for (const Facet& f : facets(vista)) {
    bool above = false;
    const double side = dot(f.n, at.position - f.triangles[0][0]);
    if (from == From::light ? side >= 0 : side <= 0) continue;
    // A portal below the surface's horizon is not aimed at.
    const bool one_sided = at.on_surface() && (back ? at.simple || !bsdf::transmits(at.bsdf)
                                                    : !at.material->double_sided);
    const double facing = back && dot(at.normal, unit(at, *back)) < 0 ? -1 : 1;
    for (const auto& t : f.triangles)
      for (const Vec3d& corner : t)
        above |= !one_sided || facing * dot(at.normal, corner - at.position) > 0;
    if (!above) continue;
    // About its solid angle.
    const double d = length(f.centre - at.position);
    const double height = std::max(std::abs(dot(f.n, f.centre - at.position)), 0.1 * d);
    const double weight = f.area * height * std::pow(d * d + f.area / pi, -1.5);
    total += weight;
    double distance;
    const double ways = coverage(f, at.position, w, distance);
    if (distance > 0) sum += ways * weight * distance * distance / (std::abs(dot(f.n, w)) * f.area);
  }
  return total > 0 ? sum / total : -1;
}

/// Largest component of the albedo of `at` as seen from `back`, clamped to [0.05, 1].
double albedo(const Vertex& back, const Vertex& at) {
  const Surface s(at);
  double share = coated(at) ? CoatedSurface(at).albedo(unit(at, back))
                            : max_component(bsdf::albedo(s.bsdf, s.local(unit(at, back))));
  if (const Pane pane = pane_of(*at.material)) share /= pane.opacity(cosine_at(at, back));
  return std::clamp(share, 0.05, 1.0);
}

/// Guiding of a walk at a vertex.
struct Directed {
  double chance = 0;    ///< probability that it aims, if it may
  double survival = 1;  ///< where it scatters
  double matt = 1, broad = 1;
  double aimed = -1;  ///< density [1/sr] of aiming; negative: nothing to aim at

  Directed(const Vista& vista, const Guiding& guiding, From from, const Vertex* back,
           const Vertex& at, const Vertex& to)
      : chance(guiding.chance[static_cast<size_t>(from)]) {
    if (back) survival = albedo(*back, at);
    if (back && !at.connectible) return;
    aimed = at.at_infinity() ? guide_line_pdf(vista, unit(at, to), to)
                             : guide_pdf_w(vista, from, back, at, to);
    if (!back) return;
    if (aimed < 0) return;
    // Of the walks that would end, three in ten aim.
    const double aims = std::min(chance, 0.3) * (1 - survival);
    survival += aims;
    chance = aims / survival;
    if (at.simple) return;
    if (coated(at)) {
      double dirac;
      CoatedSurface(at).odds(unit(at, *back), dirac, broad);
      matt -= dirac;
      return;
    }
    const Surface s(at);
    const Vec3d local = s.local(unit(at, *back));
    matt -= bsdf::dirac_probability(at.bsdf, local, local);
    matt -= bsdf::dirac_probability(at.bsdf, local, -local);
    const bool narrow = matt == 1 && at.bsdf.alpha < 0.3f && !bsdf::only_diffuse(at.bsdf);
    if (narrow) broad = bsdf::diffuse_probability(at.bsdf, local);
  }
};

/// Density of the direction of a guided walk.
double guided_pdf_w(const Directed& d, bool dirac, double plain, Fault fault) {
  if (dirac || plain == 0 || d.aimed < 0) return plain;
  const double matt = fault == Fault::guide_5_percent ? 1.05 * d.matt : d.matt;
  return (1 - d.chance * d.broad) * plain + d.chance * d.broad * matt * d.aimed;
}

/// Survival probability of a walk at its i-th vertex.
double survival(const Directed& d, int i, Fault fault) {
  return i < 2 || fault == Fault::immortal ? 1 : d.survival;
}

/// P>(x_i) and P<(x_i) of all vertices except the camera.
struct Densities {
  std::vector<double> from_light, from_camera;
};
Densities of_walks(const Vista& vista, const SkyLight* sky, const Path& path,
                   const Guiding& guiding, Fault fault) {
  const int k = path.k();
  const FilmPlane& film = fault == Fault::film_of_the_middle ? vista.view.film : path.film();
  Densities all{std::vector<double>(static_cast<size_t>(k)),
                std::vector<double>(static_cast<size_t>(k))};
  for (int i = 0; i < k; ++i) {
    const Vertex& x = path.vertex(i);
    double& P_light = all.from_light[static_cast<size_t>(i)];
    double& P_camera = all.from_camera[static_cast<size_t>(i)];
    if (i == 0) {
      P_light = light_pdf(vista, sky, x, fault);
    } else {
      const Vertex& before = path.vertex(i - 1);
      const Vertex* back = i == 1 ? nullptr : &path.vertex(i - 2);
      const bool dirac = i > 1 && path.dirac(i - 1);
      const double p = i == 1 ? emission_pdf_w(vista, before, x) : pdf_w(*back, before, x, dirac);
      const Directed directed(vista, guiding, From::light, back, before, x);
      double per_area = cosine_at(x, before) / distance2(before, x);
      if (fault == Fault::missing_cosine && i == 2) per_area /= cosine_at(x, before);
      P_light =
          survival(directed, i - 1, fault) * guided_pdf_w(directed, dirac, p, fault) * per_area;
    }
    const Vertex& after = path.vertex(i + 1);
    double q = film_pdf_w(film, after, x);
    if (i < k - 1) {
      const Vertex& back = path.vertex(i + 2);
      const double p = pdf_w(back, after, x, path.dirac(i + 1));
      const Directed directed(vista, guiding, From::camera, &back, after, x);
      q = survival(directed, k - i - 1, fault) *
          guided_pdf_w(directed, path.dirac(i + 1), p, fault);
    }
    // For the sky per solid angle: its cosine and distance are 1.
    const bool met = x.on_surface() || in_the_sky(x);
    P_camera = met ? q * cosine_at(x, after) / distance2(after, x) : 0;
  }
  return all;
}

}  // namespace

std::vector<StrategyDensity> densities(const Vista& vista, const Path& path, const Mixture& mixture,
                                       Fault fault, const SkyLight* sky) {
  const int k = path.k();
  std::optional<SkyLight> own;
  if (!sky && vista.world->scene.sky) sky = &own.emplace(vista);
  const auto [from_light, from_camera] = of_walks(vista, sky, path, mixture.guiding, fault);
  std::vector<StrategyDensity> result;
  const auto add = [&, &from_light = from_light, &from_camera = from_camera](Technique technique,
                                                                             int split) {
    if (!mixture.has(technique)) return;
    const bool portal = technique == Technique::portal;
    // Each connection of the technique needs both ends free of Dirac lobes.
    const auto connects = [&](int i) { return !path.dirac(i) && !path.dirac(i + 1); };
    bool possible = true;
    if (portal) possible = connects(split) && connects(split + 1);
    if (split > 0) possible = possible && connects(split - 1);
    if (!possible && fault != Fault::connection_at_a_mirror) return;
    double log_p = 0;
    for (int i = 0; i < split; ++i)
      log_p += std::log(technique == Technique::direct
                            ? next_event_pdf(vista, sky, path, mixture.through_windows, fault)
                            : from_light[static_cast<size_t>(i)]);
    for (int i = portal ? split + 2 : split; i < k; ++i)
      log_p += std::log(from_camera[static_cast<size_t>(i)]);
    if (portal) {
      double p = segment_pdf(vista, path.vertex(split), path.vertex(split + 1), fault);
      p *= mixture.segments * (split > 0 ? mixture.connected_to_segments : 1);
      // The camera sees only a sample's own segment; its vertices are connected with those of all
      // samples.
      if (split + 2 < k) p *= mixture.segments_connected;
      const bool to_x = path.vertex(split).position.x < path.vertex(split + 1).position.x;
      if (fault == Fault::portal_density_5_percent) p *= 1.05;
      if (fault == Fault::one_way_5_percent && to_x) p *= 1.05;
      log_p += std::log(p);
    }
    if (technique == Technique::bi) log_p += std::log(mixture.connected);
    if (technique == Technique::light) log_p += std::log(mixture.light_walks);
    const double sample_weight = technique != Technique::direct ? 1
                                 : k == 2                       ? mixture.first_direct
                                                                : mixture.later_direct;
    result.push_back({{technique, split}, log_p, sample_weight});
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

double weight(const std::vector<StrategyDensity>& densities, Strategy used, double beta) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const StrategyDensity& d : densities) largest = std::max(largest, d.log_p);
  double mine = 0, total = 0;
  for (const StrategyDensity& d : densities) {
    const double p = std::pow(d.sample_weight * std::exp(d.log_p - largest), beta);
    total += p;
    if (d.strategy == used) mine = p;
  }
  return mine / total;
}

Vec3d contribution(const Path& path) {
  const int k = path.k();
  Vec3d value = emission(path.vertex(0), path.vertex(1));
  for (int i = 0; i + 1 < k; ++i) {
    const Vertex& a = path.vertex(i);
    const Vertex& b = path.vertex(i + 1);
    value *= cosine_at(a, b) * cosine_at(b, a) / distance2(a, b);
    value = value * scattering(a, b, path.vertex(i + 2), path.dirac(i + 1));
  }
  const Vertex& last = path.vertex(k - 1);
  const Vertex& camera = path.vertex(k);
  return value * (film_pdf_w(path.film(), camera, last) * cosine_at(last, camera) /
                  distance2(camera, last));
}

}  // namespace tdpt::oracle
