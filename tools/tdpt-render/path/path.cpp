// The MIS weight of a finished path: the share of the strategy that made it in the densities of all
// strategies that could have. Sections 3.1 and 3.3, eqs. 6 to 8.
//
// Method: multiple importance sampling (Veach), balance or power heuristic. Two arrays of densities
// along the path, of the walk from the light and of that from the camera; every strategy is a
// prefix of the one, a suffix of the other and what joins them, so running products give all.
//
// x_0 ... x_k  vertices, x_0 on a light, x_k on the camera; k edges
// P>, P<       density [per canonical area] of a vertex in a walk from the light, from the camera
// s, a         split: how many vertices come from the light
// p_AA = G D   density of a portal segment [eq. 4, portals.h]
//
//   camera    s=0        prod_{i>=0} P<(x_i)
//   direct    s=1        p_nee(x_0) prod_{i>=1} P<(x_i)         p_nee may depend on x_1
//   light     s=k        prod_{i<k} P>(x_i)
//   bi        s=2..k-1   prod_{i<s} P>(x_i) prod_{i>=s} P<(x_i)                             [eq. 7]
//   portal a  a=0..k-2   prod_{i<a} P>(x_i) p_AA(x_a,x_{a+1}) prod_{i>a+1} P<(x_i)          [eq. 8]
//
// At a vertex with a Dirac lobe on this path (a mirror, smooth glass) nothing can be connected: the
// techniques that would end a prefix or a segment there, or join one to it, have no density. A
// light without a surface has no P<(x_0).
//
// All are divided by the common factor prod q_i, q_i = P>(x_i) + P<(x_i): every factor then lies in
// [0,1] (but for p_AA / q_a q_{a+1}), so long paths neither overflow nor underflow where it
// matters. Where no walk can have made x_i, q_i = 1: techniques that skip it, by a segment that
// ends there or a next event, keep their density, and those of all others are 0.
#include "tools/tdpt-render/path/path.h"

#include <limits>

#include "tools/tdpt-render/path/roulette.h"

namespace tdpt {
namespace {

size_t u(int i) {
  return static_cast<size_t>(i);
}

// Prefixes and suffixes of a path of k edges, densities `d` over the q_i of `unit`.
struct Products {
  Products(const WalkDensities& d, const WalkDensities& unit, int k) {
    std::array<double, kMaxDepth + 1> per_common;  // 1/q_i
    camera[u(k)] = light[0] = 1;
    for (int i = 0; i < k; ++i) {
      per_common[u(i)] = 1 / unit.common(i);
      light[u(i + 1)] = light[u(i)] * (d.light_A[u(i)] * per_common[u(i)]);
    }
    for (int i = k - 1; i >= 0; --i)
      camera[u(i)] = camera[u(i + 1)] * (d.camera_A[u(i)] * per_common[u(i)]);
  }
  std::array<double, kMaxDepth + 2> light;   // [s] = prod_{i<s} P>(x_i)/q_i
  std::array<double, kMaxDepth + 2> camera;  // [s] = prod_{i>=s} P<(x_i)/q_i
};

}  // namespace

Path::Path(const World& world, const Guide& guide, const Walk& y, int s, const Walk& z, int t,
           RayCounts& rays)
    : guide_(guide) {
  for (int i = 0; i < s; ++i) x_[u(i)] = &y[i];
  fill(world, y, s, z, t, nullptr, rays);
}

Path::Path(const World& world, const Guide& guide, const Walk& y, int s, const Vertex& x_l,
           const Vertex& x_c, const SegmentCrossings& segment, const Walk& z, int t,
           RayCounts& rays)
    : guide_(guide) {
  for (int i = 0; i < s; ++i) x_[u(i)] = &y[i];
  x_[u(s)] = &x_l;
  x_[u(s + 1)] = &x_c;
  fill(world, y, s, z, t, &segment, rays);
}

void Path::fill(const World& world, const Walk& y, int s, const Walk& z, int t,
                const SegmentCrossings* segment, RayCounts& rays) {
  const int middle = segment ? 2 : 0;
  k_ = s + middle + t - 1;
  const int first_z = k_ - (t - 1);  // index of z_{t-1}
  for (int j = 0; j < t; ++j) x_[u(k_ - j)] = &z[j];
  // Walks turned at the inner vertices of their prefixes; at the others the path was connected.
  for (int i = 0; i <= k_; ++i)
    dirac_[u(i)] = (i + 1 < s && y.state(i).dirac) || (i > first_z && z.state(k_ - i).dirac);

  fill_survival(y, s, z, t);
  fill_crossings(y, s, z, first_z, segment, rays);
  // Inside a prefix the walk knows both densities; the two vertices at a prefix's end and the
  // segment's learn theirs from the finished path.
  for (int i = 0; i < k_; ++i) {
    const int j = k_ - i;  // index from the camera
    walks_.light_A[u(i)] =
        i == 0  ? plain_light_A(world, 0)  // of walks, whoever placed x_0
        : i < s ? y.state(i).pdf_own_A
                : light_survival(i) * (j <= t - 3
                                           ? z.state(j).pdf_other_A
                                           : directed_light_A(guide_, i, plain_light_A(world, i)));
    walks_.camera_A[u(i)] =
        i >= first_z ? z.state(j).pdf_own_A
                     : camera_survival(i) *
                           (i <= s - 3 ? y.state(i).pdf_other_A
                                       : directed_camera_A(guide_, i, plain_camera_A(world, i)));
  }
  if (k_ > 1) next_event_ = world.next_events.pdf(x(1), x(0));
}

void Path::fill_survival(const Walk& y, int s, const Walk& z, int t) {
  auto& [light, camera] = survival_;
  const int first_z = k_ - (t - 1);
  light[0] = camera[0] = light[u(k_)] = camera[u(k_)] = 1;
  for (int i = 1; i < k_; ++i) {
    const int j = k_ - i;
    light[u(i)] = always_goes_on(i) ? 1
                  : i < s           ? y.state(i).own_survival
                  : j + 1 < t       ? z.state(j).other_survival
                                    : albedo_at(x(i), between(x(i), x(i - 1)).w);
    camera[u(i)] = always_goes_on(j) ? 1
                   : i >= first_z    ? z.state(j).own_survival
                   : i + 1 < s       ? y.state(i).other_survival
                                     : albedo_at(x(i), between(x(i), x(i + 1)).w);
  }
}

void Path::fill_crossings(const Walk& y, int s, const Walk& z, int first_z,
                          const SegmentCrossings* segment, RayCounts& rays) {
  if (!guide_.sees_portals()) {
    for (int i = 0; i < k_; ++i) crossing_[u(i)] = {};
    return;
  }
  for (int i = 0; i + 1 < k_; ++i) {
    PortalSet::Crossing& c = crossing_[u(i)];
    if (i + 1 < s) {
      c = y.state(i + 1).crossing;
    } else if (i >= first_z) {
      c = z.state(k_ - i).crossing;
    } else if (segment) {
      c = i == s ? segment->own : i < s ? segment->before : segment->after;
    } else {
      c = guide_.crossing(x(i), x(i + 1), rays.portal);
    }
  }
}

double Path::plain_light_A(const World& world, int i) const {
  if (i == 0) return world.lights.pdf(*x(0).source, x(0).triangle, x(0).position, x(0).in_sky);
  return i == 1 ? emission_pdf_A(x(0), x(1))
                : scatter_pdf_A(x(i - 2), x(i - 1), x(i), dirac(i - 1));
}

double Path::directed_light_A(const Guide& guide, int i, double plain) const {
  if (!guide.active() || i == 0 || dirac(i - 1)) return plain;
  const Vec3d back = i == 1 ? Vec3d() : between(x(i - 1), x(i - 2)).w;
  return guide.pdf_A(From::light, x(i - 1), back, x(i), plain, crossing_[u(i - 1)]);
}

double Path::plain_camera_A(const World& world, int i) const {
  if (!x(i).met()) return 0;
  if (i < k_ - 1) return scatter_pdf_A(x(i + 2), x(i + 1), x(i), dirac(i + 1));
  const Edge e = between(x(k_), x(i));
  return to_area(world.film.pdf_w(e.w), e, x(i));
}

double Path::directed_camera_A(const Guide& guide, int i, double plain) const {
  if (!guide.active() || !x(i).met() || i == k_ - 1 || dirac(i + 1)) return plain;
  const Vec3d back = between(x(i + 1), x(i + 2)).w;
  return guide.pdf_A(From::camera, x(i + 1), back, x(i), plain, crossing_[u(i)]);
}

void Path::plain_densities(const World& world, WalkDensities& d) const {
  for (int i = 0; i < k_; ++i) {
    d.light_A[u(i)] = light_survival(i) * plain_light_A(world, i);
    d.camera_A[u(i)] = camera_survival(i) * plain_camera_A(world, i);
  }
}

void Path::directed_densities(const Guide& guide, const WalkDensities& plain,
                              WalkDensities& d) const {
  for (int i = 0; i < k_; ++i) {
    const double light = light_survival(i), camera = camera_survival(i);
    d.light_A[u(i)] = light * directed_light_A(guide, i, plain.light_A[u(i)] / light);
    d.camera_A[u(i)] = camera * directed_camera_A(guide, i, plain.camera_A[u(i)] / camera);
  }
}

// Densities as products of parts: prefix and suffix are the caller's, the rest is given to `add`.
template <class Add>
void Path::for_each_strategy(const Mixture& mixture, const WalkDensities& unit,
                             const Add& add) const {
  for (int s = 0; s <= k_; ++s) {
    const Technique technique = s == 0    ? Technique::camera
                                : s == 1  ? Technique::direct
                                : s == k_ ? Technique::light
                                          : Technique::bi;
    const bool joins = !(s > 0 && (dirac(s - 1) || dirac(s)));
    if (mixture.has(technique) && joins) {
      const double weight = mixture.sample_weight(technique, s, k_);
      if (s == 1)
        add(Strategy{technique, s}, 0, 1,
            next_event_.of(mixture.through_windows) * (1 / unit.common(0)) * weight);
      else
        add(Strategy{technique, s}, s, s, weight);
    }
    if (s <= k_ - 2 && crossing_[u(s)].density > 0 && mixture.has(Technique::portal) && joins &&
        !dirac(s) && !dirac(s + 1) && !dirac(s + 2)) {
      // [eq. 8], p_AA = G D as in [eq. 4].
      const double g = geometry(x(s), x(s + 1), between(x(s), x(s + 1)));
      add(Strategy{Technique::portal, s}, s, s + 2,
          mixture.samples_of(Technique::portal, s) * crossing_[u(s)].density *
              (g / unit.common(s)) / unit.common(s + 1));
    }
  }
}

double Path::weight(const Mixture& mixture, Strategy used, double beta) const {
  if (k_ < 2) return 1;  // a light seen directly: only the camera technique makes it
  const std::optional<double> weight = weight_by_products(mixture, used, beta);
  return weight ? *weight : weight_by_logarithms(mixture, used, beta);
}

std::optional<double> Path::weight_by_products(const Mixture& mixture, Strategy used,
                                               double beta) const {
  const Products products(walks_, walks_, k_);
  double total = 0, mine = 0;
  for_each_strategy(mixture, walks_, [&](Strategy strategy, int prefix, int rest, double extra) {
    // [eq. 7], and [eq. 8] with p_AA in `extra`, over prod q_i.
    double p = products.light[u(prefix)] * extra * products.camera[u(rest)];
    if (beta != 1) p = std::pow(p, beta);
    total += p;
    if (strategy == used) mine = p;
  });
  constexpr double kTiny = 1e-250;
  if (!(total > kTiny && mine > 0)) return std::nullopt;
  return mine / total;  // the balance heuristic [eq. 6] for beta = 1
}

StrategySums Path::sums(const Mixture& mixture, const WalkDensities& d, const WalkDensities& unit,
                        Strategy used) const {
  const Products products(d, unit, k_);
  StrategySums sums;
  for_each_strategy(mixture, unit, [&](Strategy strategy, int prefix, int rest, double extra) {
    const double counted = products.light[u(prefix)] * extra * products.camera[u(rest)];
    const double per_sample = mixture.sample_weight(strategy.technique, strategy.split, k_) /
                              mixture.samples_of(strategy.technique, strategy.split);  // v_s / n_s
    sums.counted += counted;
    sums.squares += counted * per_sample;
    if (strategy == used) sums.used = counted / per_sample;
  });
  return sums;
}

// Long paths whose edges are short and long by turns make every product tiny at once.
double Path::weight_by_logarithms(const Mixture& mixture, Strategy used, double beta) const {
  std::array<double, kMaxDepth + 2> light_part, camera_part;
  camera_part[u(k_)] = light_part[0] = 0;
  for (int i = 0; i < k_; ++i)
    light_part[u(i + 1)] = light_part[u(i)] + std::log(walks_.light_A[u(i)] / walks_.common(i));
  for (int i = k_ - 1; i >= 0; --i)
    camera_part[u(i)] = camera_part[u(i + 1)] + std::log(walks_.camera_A[u(i)] / walks_.common(i));
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  const auto log_p = [&](int prefix, int rest, double extra) {
    return light_part[u(prefix)] + std::log(extra) + camera_part[u(rest)];
  };
  double largest = kNone, mine = kNone;
  for_each_strategy(mixture, walks_, [&](Strategy strategy, int prefix, int rest, double extra) {
    const double l = log_p(prefix, rest, extra);
    largest = std::max(largest, l);
    if (strategy == used) mine = l;
  });
  if (mine == kNone) return std::numeric_limits<double>::quiet_NaN();
  double total = 0;
  for_each_strategy(mixture, walks_, [&](Strategy, int prefix, int rest, double extra) {
    total += std::exp(beta * (log_p(prefix, rest, extra) - largest));
  });
  return std::exp(beta * (mine - largest)) / total;
}

}  // namespace tdpt
