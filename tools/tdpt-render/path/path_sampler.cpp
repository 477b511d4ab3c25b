#include "tools/tdpt-render/path/path_sampler.h"

#include "tools/tdpt-render/path/surface.h"

namespace tdpt {
namespace {

bool black(const Rgb& c) {
  return !(c.x != 0 || c.y != 0 || c.z != 0);
}

/// Unit direction from walk vertex i back to the vertex before it.
Vec3d back(const Walk& walk, int i) {
  return between(walk[i], walk[i - 1]).w;
}

}  // namespace

PathSampler::PathSampler(const World& world, const SampleSettings& settings, const Guide& guide,
                         Film& film, Tally& tally, const PathObserver* observer)
    : world_(world),
      settings_(settings),
      guide_(guide),
      film_(film),
      tally_(tally),
      observer_(observer) {}

Sequence PathSampler::numbers(Purpose purpose) const {
  const uint64_t pixel = static_cast<uint64_t>(y_) << 32 | static_cast<uint64_t>(x_);
  return Sequence(settings_.seed, settings_.stream * 16 + purpose, pixel, sample_);
}

void PathSampler::begin(int x, int y, uint64_t sample) {
  x_ = x;
  y_ = y;
  sample_ = sample;
  coins_ = mix64(mix64(sample) + (static_cast<uint64_t>(y) << 32 | static_cast<uint64_t>(x)));
  layer_coins_ = coins_;
  pixel_ = {};
}

void PathSampler::run() {
  if (has_light_phase()) light_phase(light_walk_);
  camera_phase(light_walk_);
}

void PathSampler::light_phase(Walk& y) {
  tdpt::walk_from_light(world_, guide_, settings_.max_depth - 1, numbers(light_walk), y,
                        tally_.rays);
}

void PathSampler::camera_phase(const Walk& y) {
  light_ = &y;
  const TechniqueSet& techniques = settings_.mixture.techniques;
  walk_from_camera();
  for (int i = 0; i < kTechniques; ++i)
    if (const auto t = static_cast<Technique>(i); techniques.has(t)) run(t);
}

void PathSampler::run(Technique technique) {
  switch (technique) {
    case Technique::camera:
      return camera();
    case Technique::direct:
      return direct();
    case Technique::light:
      return light();
    case Technique::bi:
      return bi();
    case Technique::portal:
      return portal();
  }
}

void PathSampler::end() {
  if (pixel_ != Vec3d() && !film_.add(x_, y_, pixel_, coin())) leave_out();
}

void PathSampler::walk_from_camera() {
  Sequence place = numbers(film_place);
  const double x = x_ + place.uniform();
  const double y = y_ + place.uniform();
  tdpt::walk_from_camera(world_, guide_, x, y, settings_.max_depth, numbers(camera_walk),
                         camera_walk_, tally_.rays);
}

void PathSampler::walk_from_light() {
  light_phase(light_walk_);
  light_ = &light_walk_;
}

uint64_t PathSampler::coin() {
  return mix64(coins_++);
}
uint64_t PathSampler::layer_coin() {
  return mix64(~layer_coins_++);
}

bool PathSampler::weigh(const Path& path, Strategy strategy, const Rgb& value, Rgb& weighted) {
  if (observer_) (*observer_)(path, strategy, value);
  const double w = path.weight(settings_.mixture, strategy, settings_.beta);
  weighted = value * static_cast<float>(w);  // [eq. 5]: `value` is contribution over density
  if (is_finite(weighted)) return true;
  leave_out();
  return false;
}

double PathSampler::to_pixel(const Path& path, Strategy strategy, const Rgb& value) {
  Rgb weighted;
  if (!weigh(path, strategy, value, weighted)) return 0;
  const auto technique = static_cast<size_t>(strategy.technique);
  pixel_ += Vec3d(weighted);
  if (film_.has_layer(technique))
    film_.add_to_layer(technique, x_, y_, Vec3d(weighted), layer_coin());
  const double brought = luminance(weighted);
  tally_.energy[technique].add(brought);
  return brought;
}

double PathSampler::to_film(const Path& path, Strategy strategy, double raster_x, double raster_y,
                            const Rgb& value) {
  Rgb weighted;
  if (!weigh(path, strategy, value, weighted)) return 0;
  const auto technique = static_cast<size_t>(strategy.technique);
  const int x = static_cast<int>(raster_x), y = static_cast<int>(raster_y);
  if (!film_.add(x, y, Vec3d(weighted), coin())) {
    leave_out();
    return 0;
  }
  if (film_.has_layer(technique))
    film_.add_to_layer(technique, x, y, Vec3d(weighted), layer_coin());
  const double brought = luminance(weighted);
  tally_.energy[technique].add(brought);
  return brought;
}

bool PathSampler::visible(const Point& a, const Point& b) {
  ++tally_.rays.shadow;
  // No two places of a scene are further apart than its ball's diameter, 2 sqrt 3 (canonical).
  constexpr double kOutside = 4;
  const auto origin = [](const Point& p, const Point& other) {
    if (!p.at_infinity()) return p.origin();
    return Tracer::Origin{other.position - p.source->direction() * kOutside};
  };
  return world_.tracer.visible(origin(a, b), origin(b, a));
}

Rgb PathSampler::geometry(const Point& a, const Point& b, const Edge& e) const {
  const auto g = static_cast<float>(tdpt::geometry(a, b, e));
  return world_.absorbing ? transmittance(a, b, e.w, std::sqrt(e.d2)) * g : Rgb(g);
}

bool PathSampler::project(const Point& p, Vec3d& to_camera, Rgb& factor, double& x,
                          double& y) const {
  const Edge e = between(camera_walk_[0], p);
  if (!world_.film.raster(e.w, x, y)) return false;
  to_camera = -e.w;
  factor = geometry(camera_walk_[0], p, e) * static_cast<float>(world_.film.pdf_w(e.w));
  return true;
}

void PathSampler::camera() {
  const Walk& z = camera_walk_;
  for (int j = 1; j < z.size; ++j) {
    if (!z[j].source) continue;
    const Rgb Le = emitted(z[j], back(z, j));
    if (black(Le)) continue;
    to_pixel(Path(world_, guide_, *light_, 0, z, j + 1, tally_.rays), {Technique::camera, 0},
             z.state(j).throughput * Le);
  }
}

void PathSampler::direct() {
  const Walk& z = camera_walk_;
  if (world_.lights.empty()) return;
  Sequence random = numbers(next_event);
  for (int j = 1; j < z.size && j < settings_.max_depth; ++j) {
    if (!z[j].connectible) continue;
    random.seek(4 * static_cast<uint32_t>(j));
    const auto [u, v, pick, side] = random.uniforms<4>();
    begin_at_light(world_, guide_, world_.lights.sample_for(z[j].position, pick, u, v, side),
                   light_point_);
    const Vertex& y0 = light_point_[0];
    const Edge e = between(z[j], y0);
    const Rgb Le = emitted(y0, -e.w);
    if (black(Le)) continue;
    const Rgb f = bsdf_at(z[j], e.w, back(z, j));
    const Rgb value =
        z.state(j).throughput * f * Le * light_point_.state(0).throughput * geometry(z[j], y0, e);
    if (black(value) || !visible(z[j], y0)) continue;
    to_pixel(Path(world_, guide_, light_point_, 1, z, j + 1, tally_.rays), {Technique::direct, 1},
             value);
  }
}

void PathSampler::light() {
  const Walk& y = *light_;
  for (int i = 1; i < y.size; ++i) {
    if (!y[i].connectible) continue;
    Vec3d to_camera;
    Rgb factor;
    double raster_x, raster_y;
    if (!project(y[i], to_camera, factor, raster_x, raster_y)) continue;
    const Rgb value = y.state(i).throughput * bsdf_at(y[i], back(y, i), to_camera) * factor;
    if (black(value) || !visible(y[i], camera_walk_[0])) continue;
    to_film(Path(world_, guide_, y, i + 1, camera_walk_, 1, tally_.rays), {Technique::light, i + 1},
            raster_x, raster_y, value);
  }
}

void PathSampler::bi() {
  const Walk& y = *light_;
  const Walk& z = camera_walk_;
  for (int t = 2; t <= z.size; ++t) {
    const Vertex& b = z[t - 1];
    if (!b.connectible) continue;
    for (int s = 2; s <= y.size && s + t - 1 <= settings_.max_depth; ++s) {
      const Vertex& a = y[s - 1];
      if (!a.connectible) continue;
      const Edge e = between(a, b);
      const Rgb value = y.state(s - 1).throughput * bsdf_at(a, back(y, s - 1), e.w) *
                        z.state(t - 1).throughput * bsdf_at(b, -e.w, back(z, t - 1)) *
                        geometry(a, b, e);
      if (black(value) || !visible(a, b)) continue;
      to_pixel(Path(world_, guide_, y, s, z, t, tally_.rays), {Technique::bi, s}, value);
    }
  }
}

bool PathSampler::portal_segment(const PortalSet::Sample& sample, Vertex& x_l, Vertex& x_c,
                                 PortalSet::Crossing& crossing, double& presence) {
  // Both rays start at one place, behind the portal by more than rounding: what lies in its plane,
  // a pane as like as not, is met by one of them alone, and a segment that a wall there stops ends
  // too near the plane to have a density.
  presence = 1;
  const Vec3f from(sample.position - world_.portals.polygon(sample.drawn.polygon).normal *
                                         (0.5 * PortalSet::kMargin));
  const auto end = [&](const Vec3d& w, Vertex& v) {
    Hit hit;
    ++tally_.rays.closest;
    if (!world_.tracer.closest_from(from, w, hit)) return false;
    place_on_surface(world_, hit, v);
    presence *= hit.presence;
    return true;
  };
  if (!end(sample.direction, x_c) || !x_c.connectible) return false;
  if (!end(-sample.direction, x_l)) return false;
  // A lamp may be black or a mirror otherwise: light that begins there is not scattered there.
  if (!x_l.connectible && black(emitted(x_l, sample.direction))) return false;
  if (!(between(x_l, x_c).d2 > 0)) return false;
  if (!world_.portals.spans(sample.drawn, x_l.position, x_c.position)) return false;
  if (guide_.active()) {
    guide_.aim_at_surface(sample.direction, x_l);
    guide_.aim_at_surface(-sample.direction, x_c);
  }
  crossing = guide_.crossing(x_l, x_c, tally_.rays.portal, sample.drawn);
  return crossing.density > 0;
}

void PathSampler::portal() {
  if (world_.portals.empty()) return;
  const Walk& y = *light_;
  const Walk& z = camera_walk_;
  const int D = settings_.max_depth;
  if (D < 2) return;
  tally_.begin_portals(world_.portals.portals());
  Sequence random = numbers(segment);
  const PortalSet::Sample sample = world_.portals.sample(random.uniforms<7>());
  const double share = settings_.mixture.segments;
  if (!(random.uniform() < share)) return;
  Tally::OfPortal& of_portal = tally_.portals[world_.portals.polygon(sample.drawn.polygon).portal];
  ++of_portal.drawn;
  Vertex x_l, x_c;
  PortalSet::Crossing crossing{};
  double presence;
  if (!portal_segment(sample, x_l, x_c, crossing, presence)) return;

  // One throughput for both ends, the G of edge C2 of [eq. 2] over its density: G / p_AA = 1 / D; a
  // share of the samples stands for all.
  const Edge middle = between(x_l, x_c);
  const Vec3d& w = middle.w;
  Rgb through(static_cast<float>(1 / (share * crossing.density * presence)));
  if (world_.absorbing) through = through * transmittance(x_l, x_c, w, std::sqrt(middle.d2));

  // Light sides: [eq. 1] with edge C1 of [eq. 2], over its density. [a] with a prefix vertices
  // y_0..y_{a-1}; arriving at x_l and scattered along w.
  // Each end's edges are tested against the portals once, for all paths that have them.
  std::array<Rgb, kMaxDepth> light_side;
  std::array<PortalSet::Crossing, kMaxDepth> before;  // of meaning where light_side is not black
  light_side[0] = emitted(x_l, w);
  int last_a = 0;
  for (int a = 1; a <= D - 2 && a <= y.size; ++a) {
    const Vertex& v = y[a - 1];
    Rgb& value = light_side[static_cast<size_t>(a)];
    value = {};
    last_a = a;
    if (!v.connectible) continue;
    const Edge e = between(v, x_l);
    const Rgb f = a == 1 ? emitted(v, e.w) : bsdf_at(v, back(y, a - 1), e.w);
    value = y.state(a - 1).throughput * f * bsdf_at(x_l, -e.w, w) * geometry(v, x_l, e);
    if (!black(value) && !visible(v, x_l)) value = {};
    if (!black(value)) before[static_cast<size_t>(a)] = guide_.crossing(v, x_l, tally_.rays.portal);
  }

  double brought = 0;
  // Camera sides: [eq. 3] with edge C3 of [eq. 2], over its density. b prefix vertices
  // z_0..z_{b-1}; leaving x_c, scattered from -w.
  for (int b = 1; b <= D - 1 && b <= std::max(z.size, 1); ++b) {
    const Vertex& v = z[b - 1];
    Rgb camera_side;
    double raster_x = 0, raster_y = 0;
    if (b == 1) {
      Vec3d to_camera;
      Rgb factor;
      if (!project(x_c, to_camera, factor, raster_x, raster_y)) continue;
      camera_side = bsdf_at(x_c, -w, to_camera) * factor;
    } else {
      if (!v.connectible) continue;
      const Edge e = between(x_c, v);
      camera_side = bsdf_at(x_c, -w, e.w) * bsdf_at(v, -e.w, back(z, b - 1)) *
                    z.state(b - 1).throughput * geometry(x_c, v, e);
    }
    if (black(camera_side) || !visible(x_c, v)) continue;
    const PortalSet::Crossing after = guide_.crossing(x_c, v, tally_.rays.portal);
    for (int a = 0; a <= last_a && a + b <= D - 1; ++a) {
      const Rgb value = light_side[static_cast<size_t>(a)] * camera_side * through;
      if (black(value)) continue;
      const SegmentCrossings crossings{crossing, before[static_cast<size_t>(a)], after};
      const Path path(world_, guide_, y, a, x_l, x_c, crossings, z, b, tally_.rays);
      const Strategy strategy{Technique::portal, a};
      brought += b == 1 ? to_film(path, strategy, raster_x, raster_y, value)
                        : to_pixel(path, strategy, value);
    }
  }
  of_portal.lit += brought > 0;
  of_portal.energy.add(brought);
}

}  // namespace tdpt
