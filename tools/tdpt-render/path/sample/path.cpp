// A finished path, and the densities of its vertices in walks from both ends, from which its MIS
// weights are made [shaders/shared/path/weight.h].
#include "tools/tdpt-render/path/sample/path.h"

#include <algorithm>
#include <limits>

#include "shaders/shared/path/render_layout.h"
#include "shaders/shared/scaled.h"

namespace tdpt::shader {

// The shared code in doubles, over densities `walks` of a path. A slot names a vertex and the half
// it belongs to: i for x_i on the light's, i + kOfCamera on the camera's.
template <bool has_portals, bool any_dirac>
struct PathWeights {
  using Real = double;
  // R is a ratio that involves only the joints of two strategies: no path length takes it out of a
  // double's range.
  using Scaled = double;
  static double scaled(double x) { return x; }
  static double product(double a, double b) { return a * b; }
  static double quotient(double a, double b) { return a / b; }
  static double sum(double a, double b) { return a + b; }
  static double narrowed(double x) { return x; }
  struct PathDensity {
    double own_A, other_A, pair_A, nee_A, other_survival;
    uint prev, flags;
  };
  static constexpr uint kOfCamera = 2 * kMaxDepth;

  const tdpt::Path& path;
  const WalkDensities& walks;
  const Mixture& render;
  bool power_heuristic;
  uint mixture_techniques = render.techniques.bits();
  static constexpr bool scene_has_portals = has_portals;

  double nee_A() const { return path.next_event_.of(render.through_windows); }
  double pair_A(int i) const { return scene_has_portals ? path.pair_A(i) : 0; }
  PathDensity load_path_density(uint slot) const {
    const bool of_light = slot < kOfCamera;
    const int i = static_cast<int>(of_light ? slot : slot - kOfCamera), k = path.k_;
    const auto& [light_A, camera_A] = walks[i];
    const uint flags = any_dirac && path.dirac(i) ? VERTEX_DIRAC : 0u;
    // The densities include survival as a factor.
    if (of_light)
      return {light_A,  camera_A, i > 0 ? pair_A(i - 1) : 0, i == 1 ? nee_A() : 0, 1,
              slot - 1, flags};
    return {camera_A, light_A, i + 1 < k ? pair_A(i) : 0, i == 0 ? nee_A() : 0, 1, slot + 1, flags};
  }

#include "shaders/shared/path/weight.h"

  // Halves x_{s-1} to x_0, and x_s to x_{k-1}.
  Half<double> light_half(int s) const {
    if (s == 0) return {kNoVertex, 0, 0};
    return {static_cast<uint>(s - 1), walks[s - 1].camera_A, s > 1 ? walks[s - 2].camera_A : 0};
  }
  Half<double> camera_half(int s) const {
    const int k = path.k_;
    if (s == k) return {kNoVertex, 0, 0};
    return {kOfCamera + static_cast<uint>(s), walks[s].light_A,
            s + 1 < k ? walks[s + 1].light_A : 0};
  }
  [[gnu::flatten]] double strategies(Strategy used) const {
    const int s = used.split, k = path.k_;
    const uint edges = static_cast<uint>(k);
    if (used.technique == Technique::direct)
      return strategies_of_next_event(camera_half(1), edges, nee_A(), walks[0].light_A,
                                      walks[0].camera_A, pair_A(0));
    if (used.technique == Technique::portal) {
      const SegmentDensities<double> x{path.pair_A(s),
                                       walks[s].light_A,
                                       walks[s + 1].light_A,
                                       walks[s].camera_A,
                                       walks[s + 1].camera_A,
                                       s > 0 ? pair_A(s - 1) : 0,
                                       s + 2 < k ? pair_A(s + 1) : 0,
                                       nee_A()};
      return strategies_of_segment(light_half(s), camera_half(s + 2), static_cast<uint>(s), edges,
                                   x);
    }
    return strategies_of_connected(light_half(s), camera_half(s), static_cast<uint>(s), edges,
                                   s > 0 && s < k ? pair_A(s - 1) : 0);
  }
};

}  // namespace tdpt::shader

namespace tdpt {
namespace {

size_t u(int i) {
  return static_cast<size_t>(i);
}

}  // namespace

Path::Path(const Vista& vista, const Guide& guide, const Walk& y, int s, const Walk& z, int t,
           RayCounts& rays)
    : guide_(guide), film_(z.film) {
  fill(vista, y, s, z, t, nullptr, rays);
}

Path::Path(const Vista& vista, const Guide& guide, const Walk& y, int s, const Vertex& x_l,
           const Vertex& x_c, const SegmentCrossings& segment, const Walk& z, int t,
           RayCounts& rays)
    : guide_(guide), film_(z.film) {
  place(s).x = &x_l;
  place(s + 1).x = &x_c;
  fill(vista, y, s, z, t, &segment, rays);
}

void Path::fill(const Vista& vista, const Walk& y, int s, const Walk& z, int t,
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
    connection_ = guide_.crossing(x(s - 1), x(s), rays.portal);
    place(s - 1).crossing = &connection_;
  }
  fill_joint(vista, s, first_z);
  if (k_ > 1) next_event_ = vista.next_events().pdf(x(1), x(0));
}

// The walk knows both densities of all vertices but its last two; it has scattered at all but the
// last.
void Path::take_light_prefix(const Walk& y, int s) {
  for (int i = s - 1; i >= 0; --i) {
    const WalkState& state = y.state(i);
    VertexFacts& here = place(i);
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
    VertexFacts& here = place(i);
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

// Densities and survival that the walks do not know, from the finished path: neither walk left x_s
// to x_{first_z}.
void Path::fill_joint(const Vista& vista, int s, int first_z) {
  std::array<Edge, 5> edges;  // and none outside the path
  const auto at = [&](int i) -> Edge& { return edges[u(i - (s - 2))]; };  // x_i -> x_{i+1}
  if (s > 1) at(s - 2) = *place(s - 2).edge;
  for (int i = std::max(s - 1, 0); i < first_z; ++i) {
    at(i) = joint_[u(i - (s - 1))] = edge(i);
    place(i).edge = &joint_[u(i - (s - 1))];
  }
  if (first_z < k_) at(first_z) = reversed(*place(first_z).edge);
  walks_[0].light_A = plain_light_A(vista, 0, nullptr, {});  // by a walk, whoever placed x_0
  if (s <= 1)
    walks_[1].light_A =
        directed_light_A(guide_, 1, plain_light_A(vista, 1, nullptr, at(0)), nullptr, at(0));
  if (first_z == k_)
    walks_[k_ - 1].camera_A = camera_survival(k_ - 1) * plain_camera_A(k_ - 1, at(k_ - 1), nullptr);
  for (int i = std::max(s - 1, 1); i <= first_z && i < k_; ++i) {
    const Edge &before = at(i - 1), &after = at(i);
    const Incidence from_light(x(i), -before.w), from_camera(x(i), after.w);
    if (i >= s && i >= 2)
      place(i).survival[0] = guide_.survival(From::light, x(i), albedo_at(x(i), from_light));
    if (i < first_z && !always_goes_on(k_ - i))
      place(i).survival[1] = guide_.survival(From::camera, x(i), albedo_at(x(i), from_camera));
    if (i + 1 < k_) {
      const double plain = plain_light_A(vista, i + 1, &from_light, after);
      walks_[i + 1].light_A =
          light_survival(i + 1) * directed_light_A(guide_, i + 1, plain, &from_light, after);
    }
    const double plain = plain_camera_A(i - 1, before, &from_camera);
    walks_[i - 1].camera_A =
        camera_survival(i - 1) * directed_camera_A(guide_, i - 1, plain, before, &from_camera);
  }
}

double Path::plain_light_A(const Vista& vista, int i, const Incidence* in, const Edge& e) const {
  if (i == 0)
    return vista.openings.selection.pdf(*x(0).source, x(0).triangle, x(0).position, x(0).in_sky);
  if (i == 1) return emission_pdf_A(x(0), e, x(1));
  return scatter_pdf_A(x(i - 1), *in, e, x(i), dirac(i - 1));
}

double Path::directed_light_A(const Guide& guide, int i, double plain, const Incidence* in,
                              const Edge& e) const {
  if (!guide.active() || i == 0 || dirac(i - 1)) return plain;
  return guide.pdf_A(From::light, x(i - 1), in, e, x(i), plain, *place(i - 1).crossing);
}

double Path::plain_camera_A(int i, const Edge& e, const Incidence* in) const {
  if (!x(i).met()) return 0;
  if (i < k_ - 1) return scatter_pdf_A(x(i + 1), *in, reversed(e), x(i), dirac(i + 1));
  return to_area(film_->pdf_w(-e.w), e, x(i));
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

double Path::survival(int i, const std::optional<Incidence>& in, const Guide* guide,
                      From from) const {
  if (!in || always_goes_on(from == From::light ? i : k_ - i)) return 1;
  const double albedo = albedo_at(x(i), *in);
  return guide ? guide->survival(from, x(i), albedo) : albedo;
}

void Path::plain_densities(const Vista& vista, WalkDensities& d) const {
  const auto given = [](const std::optional<Incidence>& in) { return in ? &*in : nullptr; };
  for (int i = 0; i < k_; ++i) {
    const auto light = from_light(i - 1), camera = from_camera(i + 1);
    d[i].light_A = survival(i - 1, light, nullptr, From::light) *
                   plain_light_A(vista, i, given(light), edge(i - 1));
    d[i].camera_A =
        survival(i + 1, camera, nullptr, From::camera) * plain_camera_A(i, edge(i), given(camera));
  }
}

void Path::directed_densities(const Guide& guide, const WalkDensities& plain,
                              WalkDensities& d) const {
  const auto given = [](const std::optional<Incidence>& in) { return in ? &*in : nullptr; };
  for (int i = 0; i < k_; ++i) {
    const auto light = from_light(i - 1), camera = from_camera(i + 1);
    const auto by = [&](const Guide* walks_of, const std::optional<Incidence>& in, From from) {
      return survival(from == From::light ? i - 1 : i + 1, in, walks_of, from);
    };
    const double light_A = plain[i].light_A / by(nullptr, light, From::light);
    const double camera_A = plain[i].camera_A / by(nullptr, camera, From::camera);
    d[i].light_A = by(&guide, light, From::light) *
                   directed_light_A(guide, i, light_A, given(light), edge(i - 1));
    d[i].camera_A = by(&guide, camera, From::camera) *
                    directed_camera_A(guide, i, camera_A, edge(i), given(camera));
  }
}

double Path::pair_A(int i) const {
  const double density = place(i).crossing->density;
  return density > 0 ? density * geometry(x(i), x(i + 1), *place(i).edge) : 0;
}

double Path::strategies(const Mixture& mixture, const WalkDensities& d, Strategy used,
                        bool power) const {
  // Specialised: most paths need neither portals nor Dirac lobes.
  const auto of = [&]<bool portals, bool any_dirac>() {
    return shader::PathWeights<portals, any_dirac>{*this, d, mixture, power}.strategies(used);
  };
  if (mixture.has(Technique::portal))
    return any_dirac_ ? of.operator()<true, true>() : of.operator()<true, false>();
  return any_dirac_ ? of.operator()<false, true>() : of.operator()<false, false>();
}

double Path::weight(const Mixture& mixture, Strategy used, double beta) const {
  if (k_ < 2) return 1;  // a light seen directly: only the camera technique makes it
  const double total = strategies(mixture, walks_, used, beta == 2);
  // Infinite or NaN: divided by a density of 0.
  if (!mixture.has(used.technique) || !std::isfinite(total))
    return std::numeric_limits<double>::quiet_NaN();
  const double n = mixture.sample_weight(used.technique, used.split, k_);
  return (beta == 2 ? n * n : n) / total;
}

StrategySums Path::sums(const Mixture& mixture, const WalkDensities& d, const WalkDensities& unit,
                        Strategy used) const {
  const auto over_unit = [&](Strategy strategy) {
    const auto [technique, s] = strategy;
    const bool direct = technique == Technique::direct, portal = technique == Technique::portal;
    double p = direct ? next_event_.of(mixture.through_windows) / unit[0].common() : 1;
    if (portal) p = pair_A(s) / unit[s].common() / unit[s + 1].common();
    for (int i = 0; i < (direct ? 0 : s); ++i) p *= d[i].light_A / unit[i].common();
    for (int i = portal ? s + 2 : s; i < k_; ++i) p *= d[i].camera_A / unit[i].common();
    return p;
  };
  const double p = over_unit(used);
  if (!(p > 0)) return {};
  StrategySums sums;
  sums.counted = p * strategies(mixture, d, used, false);
  sums.squares = sums.counted;
  if (mixture.has(used.technique))
    sums.used = p * mixture.samples_of(used.technique, used.split, k_);
  // v_s / n_s is 1 for all other strategies.
  const double v = mixture.sample_weight(Technique::direct, 1, k_);
  if (mixture.has(Technique::direct) && v != 1 && !dirac(1))
    sums.squares += v * (v - 1) * over_unit({Technique::direct, 1});
  return sums;
}

}  // namespace tdpt
