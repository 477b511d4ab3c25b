// The sub-paths of bidirectional path tracing: random walks from the camera and from a light. Each
// vertex has its throughput, its density in this walk, and its density in a walk from the other
// end. Section 3.1.2, eqs. 1 and 3.
//
// Method: BSDF sampling, mixed with path guiding by the portals [guide.h] if the integrator has it.
// The density from the other end depends on two more vertices and is filled in when they are known;
// throughputs and densities of unguided sampling are computed first and then replaced by the guided
// ones.
#include "tools/tdpt-render/path/sample/walk.h"

#include <utility>

#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {
namespace {

// Random dimensions of a walk: those of its start, then those of each bounce, used or not, so that
// a dimension means the same in every sample: the place on a light (pick, place, side) or the
// scattering at a surface; then the guiding.
constexpr uint32_t kPerBounce = 8, kDirection = 4;

class Walker {
 public:
  Walker(const Vista& vista, const Guide& guide, From from, const Sequence& numbers, Walk& walk,
         RayCounts& rays)
      : vista_(vista), guide_(guide), from_(from), numbers_(numbers), walk_(walk), rays_(rays) {}

  Sequence& numbers() { return numbers_; }

  /// Extends the walk, whose last vertex is v, along unit w from `origin`: finds the first hit and
  /// its densities, and completes the two vertices before it. `throughput`: of an unguided walk.
  /// `plain_A(v, e, hit)`: density of the hit in an unguided walk. `triangle`: the portal triangle
  /// aimed at.
  template <class PlainPdf>
  bool extend(const Tracer::Origin& origin, const Vec3d& w, const Rgb& throughput,
              const PlainPdf& plain_A, int triangle);

  /// Continues until the walk has that many edges or ends.
  void scatter(int edges);

 private:
  PortalSet::CrossingDensity crossing(const Vertex& v, const Vertex& next, int triangle);

  const Vista& vista_;
  const Guide& guide_;
  From from_;
  Sequence numbers_;
  Walk& walk_;
  RayCounts& rays_;
  Edge last_{};  ///< to the walk's last vertex; 0 if the walk begins there
  /// Incidence at that vertex and at the one before, by turns.
  std::array<Incidence, 2> come_to_;
  Incidence& come_to(int vertex) { return come_to_[static_cast<size_t>(vertex) & 1]; }
};

PortalSet::CrossingDensity Walker::crossing(const Vertex& v, const Vertex& next, int triangle) {
  return from_ == From::light ? guide_.crossing(v, next, rays_.portal, {triangle, -1})
                              : guide_.crossing(next, v, rays_.portal, {triangle, -1});
}

template <class PlainPdf>
bool Walker::extend(const Tracer::Origin& origin, const Vec3d& w, const Rgb& throughput,
                    const PlainPdf& plain_A, int triangle) {
  const auto n = static_cast<size_t>(walk_.size);
  Hit hit;
  ++rays_.closest;
  const bool by_film = n == 1 && from_ == From::camera;
  const bool leaves = by_film ? !vista_.world->tracer.first_seen(origin.position, w, hit)
                              : !vista_.world->tracer.closest(origin, w, hit);
  if (leaves && (from_ == From::light || !vista_.world->lights.sky() || hit.triangle != ~0u))
    return false;
  walk_.make_place();
  Vertex& v = walk_.v[n - 1];
  Vertex& next = walk_.v[n];
  leaves ? place_in_sky(vista_.openings.selection, w, next)
         : place_on_surface(*vista_.world, hit, next);
  const Edge e = between(v, next);
  const double plain = plain_A(v, e, next);
  if (!(plain > 0)) return false;
  WalkState& here = walk_.states[n - 1];
  const bool known = n >= 2 && walk_.v[n - 2].met();
  Incidence before_next;
  if (n >= 2) before_next.become(v, e.w);
  const double other =
      known ? scatter_pdf_A(v, before_next, reversed(last_), walk_.v[n - 2], here.dirac) : 0;
  if (known) walk_.states[n - 2].pdf_other_A = other;
  WalkState& state = walk_.states[n];
  if (guide_.active())
    leaves ? guide_.set_totals_at_light(next) : guide_.set_totals_at_surface(-w, next);
  // For light walks only the first vertex: it may be x_1.
  if (guide_.looks_out() && !leaves && (from_ == From::camera || n == 1)) {
    vista_.next_events().look_out(-w, next);
    if (from_ == From::light) vista_.next_events().look_at_rect_lights(next);
  }
  const From reverse = from_ == From::light ? From::camera : From::light;
  if (n >= 2) here.other_survival = guide_.survival(reverse, v, albedo_at(v, before_next));
  Incidence& arrived = come_to(walk_.size);
  arrived.become(next, -e.w);
  state.own_survival = guide_.survival(from_, next, albedo_at(next, arrived));
  state.other_survival = 1;
  const double went_on = always_goes_on(static_cast<int>(n) - 1) ? 1 : here.own_survival;
  state.throughput =
      hit.opacity < 1 ? throughput * static_cast<float>(1 / hit.opacity) : throughput;
  state.pdf_own_A = went_on * plain;
  state.pdf_other_A = 0;
  state.edge = e;
  state.crossing = crossing(v, next, triangle);
  state.dirac = false;
  if (vista_.world->absorbing && !leaves)
    state.throughput = state.throughput * transmittance(v, next, w, hit.distance);
  ++walk_.size;
  const Edge before = std::exchange(last_, e);
  if (!guide_.active()) return true;

  if (here.dirac || by_film) return true;
  const double directed =
      guide_.pdf_A(from_, v, n >= 2 ? &come_to(static_cast<int>(n) - 1) : nullptr, e, next, plain,
                   state.crossing);
  state.pdf_own_A = went_on * directed;
  state.throughput *= static_cast<float>(plain / directed);
  if (known)
    walk_.states[n - 2].pdf_other_A = guide_.pdf_A(reverse, v, &before_next, reversed(before),
                                                   walk_.v[n - 2], other, here.crossing);
  return true;
}

void Walker::scatter(int edges) {
  while (walk_.size <= edges && !walk_[walk_.size - 1].at_infinity()) {
    walk_.make_place();
    const Vertex& v = walk_[walk_.size - 1];
    WalkState& state = walk_.states[static_cast<size_t>(walk_.size) - 1];
    const Incidence& here = come_to(walk_.size - 1);
    numbers_.seek(kPerBounce * static_cast<uint32_t>(walk_.size - 1));
    const auto [a, b, lobe, roulette] = numbers_.uniforms<4>();
    const double chance = always_goes_on(walk_.size - 1) ? 1 : state.own_survival;
    if (!(roulette < chance)) return;
    Turn t;
    const bool scatters = turn(v, from_, here, {a, b, lobe}, t);
    const bool tried_dirac = t.dirac;
    Vec3d towards;
    int triangle = -1;
    bool guided = false;
    if (guide_.active() && guide_.may_guide(v, from_)) {
      numbers_.seek(kPerBounce * static_cast<uint32_t>(walk_.size - 1) + kDirection);
      guided = guide_.draw(v, &here, from_, numbers_.uniforms<4>(), towards, triangle);
    }
    if (guided && !tried_dirac) {
      if (!turn_towards(v, from_, here, towards, t)) return;
    } else if (!scatters) {
      return;
    }
    // One more factor f cos / pdf_w of [eq. 1] or [eq. 3] over its density.
    const Rgb throughput = state.throughput * Rgb(t.weight) * static_cast<float>(1 / chance);
    if (max_component(throughput) <= 0) return;
    state.dirac = t.dirac;
    const auto pdf_A = [&](const Vertex& at, const Edge& e, const Vertex& to) {
      return scatter_pdf_A(at, here, e, to, t.dirac);
    };
    if (!extend(v.origin(), t.w, throughput, pdf_A, tried_dirac ? -1 : triangle)) {
      state.dirac = false;
      return;
    }
  }
}

}  // namespace

void begin_at_light(const World& world, const Lights::Point& light, Walk& walk) {
  walk.size = 0;
  walk.make_place();
  walk.size = 1;
  place_on_light(world, light, walk.v[0]);
  walk.states[0] = {};
  walk.states[0].throughput = Rgb(static_cast<float>(1 / light.pdf));
  walk.states[0].pdf_own_A = light.pdf;
}

void walk_from_camera(const Vista& vista, const Guide& guide, const FilmPlane& film, double x,
                      double y, int edges, Sequence numbers, Walk& walk, RayCounts& rays) {
  walk.size = 0;
  walk.make_place();
  walk.size = 1;
  walk.v[0] = {};
  walk.film = &film;
  walk.v[0].position = film.position();
  walk.states[0] = {};
  walk.states[0].pdf_own_A = 1;
  const Vec3d w = film.direction(x, y);
  const auto pdf_A = [&](const Vertex&, const Edge& e, const Vertex& to) {
    return to_area(film.pdf_w(w), {w, e.d2}, to);
  };
  Walker walker(vista, guide, From::camera, numbers, walk, rays);
  const Tracer::Origin pinhole = walk.v[0].origin();
  if (walker.extend(pinhole, w, Rgb(1.0f), pdf_A, -1)) walker.scatter(edges);
}

void walk_from_light(const Vista& vista, const Guide& guide, int edges, Sequence numbers,
                     Walk& walk, RayCounts& rays) {
  walk.size = 0;
  if (vista.world->lights.empty()) return;
  Walker walker(vista, guide, From::light, numbers, walk, rays);
  walker.numbers().seek(0);
  const auto [u, v, pick, side] = walker.numbers().uniforms<4>();
  const Lights::Point light = vista.openings.selection.sample(pick, u, v, side);
  begin_at_light(*vista.world, light, walk);
  if (guide.active()) guide.set_totals_at_light(walk.v[0]);
  if (edges < 1) return;
  const Vertex& y0 = walk[0];
  const std::array<double, 4> direction = walker.numbers().uniforms<4>();
  Lights::Ray ray = vista.world->lights.leave(light, direction[0], direction[1]);
  int triangle = -1;
  if (guide.active()) guide.leave(y0, direction, ray, triangle);
  // Rounding may have put the direction beside the light's cone: black, with a density of 0.
  const Rgb Le = emitted(y0, ray.direction);
  if (max_component(Le) <= 0) return;
  const Rgb throughput = walk.state(0).throughput * Le *
                         static_cast<float>(light.source->cos_per_pdf_w(ray.direction));
  if (max_component(throughput) <= 0) return;
  // A guided walk begins before the frame, but some of the scene may lie beyond.
  if (y0.at_infinity() && vista.world->tracer.reach() > 2)
    ray.origin = before_the_scene(ray.origin, ray.direction, 2 * vista.world->tracer.reach());
  const Tracer::Origin origin{ray.origin, y0.normal, y0.triangle};
  if (walker.extend(origin, ray.direction, throughput, emission_pdf_A, triangle))
    walker.scatter(edges);
}

}  // namespace tdpt
