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
#include "tools/tdpt-render/path/sample/path.h"

#include <algorithm>
#include <limits>

#include "tools/tdpt-render/path/sample/roulette.h"

namespace tdpt {
namespace {

size_t u(int i) {
  return static_cast<size_t>(i);
}

// Prefixes and suffixes of a path of k edges, densities `d` over the q_i of `unit`.
class Products {
 public:
  Products(const WalkDensities& d, const WalkDensities& unit, int k) {
    // Running products in variables: through memory each would wait for the one before.
    double of_light = 1, of_camera = 1;
    at_[0].light = at_[u(k)].camera = 1;
    for (int i = 0, j = k - 1; i < k; ++i, --j) {
      of_light *= d[i].light_A / unit[i].common();
      of_camera *= d[j].camera_A / unit[j].common();
      at_[u(i + 1)].light = of_light;
      at_[u(j)].camera = of_camera;
    }
  }
  double light(int s) const { return at_[u(s)].light; }    // prod_{i<s} P>(x_i)/q_i
  double camera(int s) const { return at_[u(s)].camera; }  // prod_{i>=s} P<(x_i)/q_i

 private:
  struct At {
    double light, camera;
  };
  std::array<At, kMaxDepth + 2> at_;
};

}  // namespace

Path::Path(const World& world, const Guide& guide, const Walk& y, int s, const Walk& z, int t,
           RayCounts& rays)
    : guide_(guide) {
  fill(world, y, s, z, t, nullptr, rays);
}

Path::Path(const World& world, const Guide& guide, const Walk& y, int s, const Vertex& x_l,
           const Vertex& x_c, const SegmentCrossings& segment, const Walk& z, int t,
           RayCounts& rays)
    : guide_(guide) {
  place(s).x = &x_l;
  place(s + 1).x = &x_c;
  fill(world, y, s, z, t, &segment, rays);
}

void Path::fill(const World& world, const Walk& y, int s, const Walk& z, int t,
                const SegmentCrossings* segment, RayCounts& rays) {
  const int middle = segment ? 2 : 0;
  k_ = s + middle + t - 1;
  const int first_z = k_ - (t - 1);  // index of z_{t-1}
  take_light_prefix(y, s);
  take_camera_prefix(z, t);
  if (segment) {
    for (const int i : {s, s + 1}) {
      place(i).dirac = false;
      place(i).survival = {1, 1};
    }
    place(s).crossing = &segment->own;
    place(s + 1).crossing = &segment->after;
    if (s > 0) place(s - 1).crossing = &segment->before;
  } else if (s > 0 && t > 1) {
    joining_ = guide_.crossing(x(s - 1), x(s), rays.portal);
    place(s - 1).crossing = &joining_;
  }
  fill_joint(world, s, first_z);
  if (k_ > 1) next_event_ = world.next_events.pdf(x(1), x(0));
}

// The walk knows both densities of all but its last two vertices, and turned at all but the last.
void Path::take_light_prefix(const Walk& y, int s) {
  for (int i = s - 1; i >= 0; --i) {
    const WalkState& state = y.state(i);
    Place& here = place(i);
    here.x = &y[i];
    here.dirac = i + 1 < s && state.dirac;
    any_dirac_ |= here.dirac;
    if (i > 0) {
      place(i - 1).crossing = &state.crossing;
      place(i - 1).edge = &state.edge;
    }
    here.survival[0] = always_goes_on(i) ? 1 : state.own_survival;
    here.survival[1] = always_goes_on(k_ - i) || i == 0 ? 1 : state.other_survival;
    walks_[i].light_A = state.pdf_own_A;
    if (i <= s - 3) walks_[i].camera_A = camera_survival(i) * state.pdf_other_A;
  }
}

void Path::take_camera_prefix(const Walk& z, int t) {
  for (int j = t - 1; j >= 0; --j) {
    const WalkState& state = z.state(j);
    const int i = k_ - j;
    Place& here = place(i);
    here.x = &z[j];
    here.dirac = j + 1 < t && state.dirac;
    any_dirac_ |= here.dirac;
    if (j > 0) {
      here.crossing = &state.crossing;
      here.edge = &state.edge;
    }
    here.survival[1] = always_goes_on(j) || i == 0 ? 1 : state.own_survival;
    here.survival[0] = always_goes_on(i) || j == 0 ? 1 : state.other_survival;
    walks_[i].camera_A = state.pdf_own_A;
    if (j <= t - 3) walks_[i].light_A = light_survival(i) * state.pdf_other_A;
  }
}

// Densities and survival that the walks do not know, from the finished path: x_s to x_{first_z} are
// those that neither left.
void Path::fill_joint(const World& world, int s, int first_z) {
  std::array<Edge, 5> edges;  // and none beyond the path's ends
  const auto at = [&](int i) -> Edge& { return edges[u(i - (s - 2))]; };  // x_i -> x_{i+1}
  if (s > 1) at(s - 2) = *place(s - 2).edge;
  for (int i = std::max(s - 1, 0); i < first_z; ++i) {
    at(i) = joint_[u(i - (s - 1))] = edge(i);
    place(i).edge = &joint_[u(i - (s - 1))];
  }
  if (first_z < k_) at(first_z) = reversed(*place(first_z).edge);
  walks_[0].light_A = plain_light_A(world, 0, nullptr, {});  // of walks, whoever placed x_0
  if (s <= 1)
    walks_[1].light_A =
        directed_light_A(guide_, 1, plain_light_A(world, 1, nullptr, at(0)), nullptr, at(0));
  if (first_z == k_)
    walks_[k_ - 1].camera_A =
        camera_survival(k_ - 1) * plain_camera_A(world, k_ - 1, at(k_ - 1), nullptr);
  for (int i = std::max(s - 1, 1); i <= first_z && i < k_; ++i) {
    const Edge &before = at(i - 1), &after = at(i);
    const Incidence from_light(x(i), -before.w), from_camera(x(i), after.w);
    if (i >= s && i >= 2) place(i).survival[0] = albedo_at(x(i), from_light);
    if (i < first_z && !always_goes_on(k_ - i)) place(i).survival[1] = albedo_at(x(i), from_camera);
    if (i + 1 < k_) {
      const double plain = plain_light_A(world, i + 1, &from_light, after);
      walks_[i + 1].light_A =
          light_survival(i + 1) * directed_light_A(guide_, i + 1, plain, &from_light, after);
    }
    const double plain = plain_camera_A(world, i - 1, before, &from_camera);
    walks_[i - 1].camera_A =
        camera_survival(i - 1) * directed_camera_A(guide_, i - 1, plain, before, &from_camera);
  }
}

double Path::plain_light_A(const World& world, int i, const Incidence* in, const Edge& e) const {
  if (i == 0) return world.lights.pdf(*x(0).source, x(0).triangle, x(0).position, x(0).in_sky);
  if (i == 1) return emission_pdf_A(x(0), e, x(1));
  return scatter_pdf_A(x(i - 1), *in, e, x(i), dirac(i - 1));
}

double Path::directed_light_A(const Guide& guide, int i, double plain, const Incidence* in,
                              const Edge& e) const {
  if (!guide.active() || i == 0 || dirac(i - 1)) return plain;
  return guide.pdf_A(From::light, x(i - 1), in, e, x(i), plain, *place(i - 1).crossing);
}

double Path::plain_camera_A(const World& world, int i, const Edge& e, const Incidence* in) const {
  if (!x(i).met()) return 0;
  if (i < k_ - 1) return scatter_pdf_A(x(i + 1), *in, reversed(e), x(i), dirac(i + 1));
  return to_area(world.film.pdf_w(-e.w), e, x(i));
}

double Path::directed_camera_A(const Guide& guide, int i, double plain, const Edge& e,
                               const Incidence* in) const {
  if (!guide.active() || !x(i).met() || i == k_ - 1 || dirac(i + 1)) return plain;
  return guide.pdf_A(From::camera, x(i + 1), in, reversed(e), x(i), plain, *place(i).crossing);
}

std::optional<Incidence> Path::from_light(int i) const {
  if (i < 1 || i >= k_) return std::nullopt;
  return Incidence(x(i), -edge(i - 1).w);
}
std::optional<Incidence> Path::from_camera(int i) const {
  if (i < 1 || i >= k_) return std::nullopt;
  return Incidence(x(i), edge(i).w);
}

void Path::plain_densities(const World& world, WalkDensities& d) const {
  const auto given = [](const std::optional<Incidence>& in) { return in ? &*in : nullptr; };
  for (int i = 0; i < k_; ++i) {
    const auto light = from_light(i - 1), camera = from_camera(i + 1);
    d[i].light_A = light_survival(i) * plain_light_A(world, i, given(light), edge(i - 1));
    d[i].camera_A = camera_survival(i) * plain_camera_A(world, i, edge(i), given(camera));
  }
}

void Path::directed_densities(const Guide& guide, const WalkDensities& plain,
                              WalkDensities& d) const {
  const auto given = [](const std::optional<Incidence>& in) { return in ? &*in : nullptr; };
  for (int i = 0; i < k_; ++i) {
    const auto light = from_light(i - 1), camera = from_camera(i + 1);
    const double on_light = light_survival(i), on_camera = camera_survival(i);
    d[i].light_A = on_light * directed_light_A(guide, i, plain[i].light_A / on_light, given(light),
                                               edge(i - 1));
    d[i].camera_A = on_camera * directed_camera_A(guide, i, plain[i].camera_A / on_camera, edge(i),
                                                  given(camera));
  }
}

// Densities as products of parts: prefix and suffix are the caller's, the rest is given to `add`.
template <class Add>
void Path::for_each_strategy(const Mixture& mixture, const WalkDensities& unit,
                             const Add& add) const {
  const auto joins = [&](int s) { return !any_dirac_ || s == 0 || !(dirac(s - 1) || dirac(s)); };
  const auto join = [&](Technique technique, int s) {
    if (mixture.has(technique) && joins(s))
      add(Strategy{technique, s}, s, s, mixture.sample_weight(technique, s, k_));
  };
  join(Technique::camera, 0);
  if (mixture.has(Technique::direct) && joins(1))
    add(Strategy{Technique::direct, 1}, 0, 1,
        next_event_.of(mixture.through_windows) * (1 / unit[0].common()) *
            mixture.sample_weight(Technique::direct, 1, k_));
  for (int s = 0; s <= k_ - 2; ++s) {
    if (s >= 2) join(Technique::bi, s);
    if (!mixture.has(Technique::portal)) continue;
    const double density = place(s).crossing->density;
    if (!(density > 0)) continue;
    if (any_dirac_ && (!joins(s) || dirac(s) || dirac(s + 1) || dirac(s + 2))) continue;
    // [eq. 8], p_AA = G D as in [eq. 4].
    const double g = geometry(x(s), x(s + 1), *place(s).edge);
    add(Strategy{Technique::portal, s}, s, s + 2,
        mixture.samples_of(Technique::portal, s, k_) * density * (g / unit[s].common()) /
            unit[s + 1].common());
  }
  if (k_ > 2) join(Technique::bi, k_ - 1);
  join(Technique::light, k_);
}

double Path::weight(const Mixture& mixture, Strategy used, double beta) const {
  if (k_ < 2) return 1;  // a light seen directly: only the camera technique makes it
  const std::optional<double> weight = weight_by_products(mixture, used, beta);
  return weight ? *weight : weight_by_logarithms(mixture, used, beta);
}

constexpr double kTiny = 1e-250;

// What most paths take: by the same sums, without asking of each strategy what it is.
std::optional<double> Path::balanced_weight(const Mixture& mixture, Strategy used) const {
  const Products products(walks_, walks_, k_);
  const auto product = [&](int prefix, int rest, double extra) {
    return products.light(prefix) * extra * products.camera(rest);
  };
  const auto portal = [&](int s) {
    const double g = geometry(x(s), x(s + 1), *place(s).edge);
    const double extra = mixture.samples_of(Technique::portal, s, k_) * place(s).crossing->density *
                         (g / walks_[s].common()) / walks_[s + 1].common();
    return product(s, s + 2, extra);
  };
  const double direct = next_event_.of(mixture.through_windows) * (1 / walks_[0].common()) *
                        mixture.sample_weight(Technique::direct, 1, k_);
  const double joined = mixture.samples_of(Technique::bi, 0, k_);
  double total = 0, of_split = 0;  // the latter: of the portal segment used
  if (mixture.has(Technique::camera)) total += product(0, 0, 1);
  if (mixture.has(Technique::direct)) total += product(0, 1, direct);
  const bool joins = mixture.has(Technique::bi), crosses = mixture.has(Technique::portal);
  for (int s = 0; s <= k_ - 2; ++s) {
    if (joins && s >= 2) total += product(s, s, joined);
    if (!crosses || !(place(s).crossing->density > 0)) continue;
    const double p = portal(s);
    total += p;
    if (s == used.split) of_split = p;
  }
  if (joins && k_ > 2) total += product(k_ - 1, k_ - 1, joined);
  const double splats = mixture.samples_of(Technique::light, k_, k_);
  if (mixture.has(Technique::light)) total += product(k_, k_, splats);
  const auto [technique, split] = used;
  if (!mixture.has(technique)) return std::nullopt;
  const double mine = technique == Technique::portal   ? of_split
                      : technique == Technique::direct ? product(0, 1, direct)
                      : technique == Technique::bi     ? product(split, split, joined)
                      : technique == Technique::light  ? product(k_, k_, splats)
                                                       : product(0, 0, 1);
  if (!(total > kTiny && mine > 0)) return std::nullopt;
  return mine / total;
}

std::optional<double> Path::weight_by_products(const Mixture& mixture, Strategy used,
                                               double beta) const {
  if (beta == 1 && !any_dirac_) return balanced_weight(mixture, used);
  const Products products(walks_, walks_, k_);
  double total = 0, mine = 0;
  for_each_strategy(mixture, walks_, [&](Strategy strategy, int prefix, int rest, double extra) {
    // [eq. 7], and [eq. 8] with p_AA in `extra`, over prod q_i.
    double p = products.light(prefix) * extra * products.camera(rest);
    if (beta != 1) p = std::pow(p, beta);
    total += p;
    if (strategy == used) mine = p;
  });
  if (!(total > kTiny && mine > 0)) return std::nullopt;
  return mine / total;  // the balance heuristic [eq. 6] for beta = 1
}

StrategySums Path::sums(const Mixture& mixture, const WalkDensities& d, const WalkDensities& unit,
                        Strategy used) const {
  const Products products(d, unit, k_);
  StrategySums sums;
  for_each_strategy(mixture, unit, [&](Strategy strategy, int prefix, int rest, double extra) {
    const double counted = products.light(prefix) * extra * products.camera(rest);
    const double per_sample =
        mixture.sample_weight(strategy.technique, strategy.split, k_) /
        mixture.samples_of(strategy.technique, strategy.split, k_);  // v_s / n_s
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
    light_part[u(i + 1)] = light_part[u(i)] + std::log(walks_[i].light_A / walks_[i].common());
  for (int i = k_ - 1; i >= 0; --i)
    camera_part[u(i)] = camera_part[u(i + 1)] + std::log(walks_[i].camera_A / walks_[i].common());
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
