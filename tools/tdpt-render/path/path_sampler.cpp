#include "tools/tdpt-render/path/path_sampler.h"

#include "tools/tdpt-render/path/surface.h"

namespace tdpt {
namespace {

// Connections of z_{t-1}: fewer where a walk is long, since most of what the picture shows has been
// told before. Measured without limit: 1 for all costs 10 to 15 % of the efficiency, 2 for all 5 to
// 15 % with directed walks.
constexpr int connections(int t) {
  return t <= 3 ? 2 : 1;
}
constexpr int kSides = 2;  // of either end of a portal segment

bool black(const Rgb& c) {
  return !(c.x != 0 || c.y != 0 || c.z != 0);
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
  own_pool_.clear();
  if (has_light_phase()) walk_from_light();
  camera_phase(light_walk_, own_pool_);
}

void PathSampler::light_phase(Walk& y) {
  tdpt::walk_from_light(world_, guide_, settings_.max_depth - 1, numbers(light_walk), y,
                        tally_.rays);
}

void PathSampler::join_with(const Walk& y, const LightPool& pool) {
  light_ = &y;
  pool_ = &pool;
}

void PathSampler::camera_phase(const Walk& y, const LightPool& pool) {
  join_with(y, pool);
  const TechniqueSet& techniques = settings_.mixture.techniques;
  walk_from_camera();
  if (film_.has_alpha() && !looks_out()) film_.meet(x_, y_);
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
  camera_ends_.clear();
  for (int j = 1; j < camera_walk_.size; ++j)
    camera_ends_.emplace_back(camera_walk_[j], back(camera_walk_, j),
                              camera_walk_.state(j).throughput);
}

void PathSampler::walk_from_light() {
  light_phase(light_walk_);
  own_pool_.clear();
  own_pool_.add(light_walk_);
  join_with(light_walk_, own_pool_);
}

uint64_t PathSampler::coin() {
  return mix64(coins_++);
}
uint64_t PathSampler::layer_coin() {
  return mix64(~layer_coins_++);
}

bool PathSampler::weigh(const Contribution& found, Rgb& weighted) {
  if (observer_) (*observer_)(found);
  const double w = found.path.weight(settings_.mixture, found.strategy, settings_.beta);
  weighted = found.value * static_cast<float>(w);  // [eq. 5]
  if (is_finite(weighted)) {
    tally_.count_length(found.path.k(), luminance(weighted));
    return true;
  }
  leave_out();
  return false;
}

double PathSampler::to_pixel(const Contribution& found) {
  Rgb weighted;
  if (!weigh(found, weighted)) return 0;
  const auto technique = static_cast<size_t>(found.strategy.technique);
  pixel_ += Vec3d(weighted);
  if (film_.has_layer(technique))
    film_.add_to_layer(technique, x_, y_, Vec3d(weighted), layer_coin());
  const double brought = luminance(weighted);
  tally_.energy[technique].add(brought);
  return brought;
}

double PathSampler::to_film(const Contribution& found, double raster_x, double raster_y) {
  Rgb weighted;
  if (!weigh(found, weighted)) return 0;
  const auto technique = static_cast<size_t>(found.strategy.technique);
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
  const auto origin = [](const Point& p, const Point& other) {
    if (!p.at_infinity()) return p.origin();
    return Tracer::Origin{before_the_scene(other.position, p.position)};
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
  if (film_.has_alpha() && looks_out()) return;
  for (int j = 1; j < z.size; ++j) {
    if (!z[j].source) continue;
    const Rgb Le = emitted(z[j], back(z, j));
    if (black(Le)) continue;
    const Path path(world_, guide_, *light_, 0, z, j + 1, tally_.rays);
    to_pixel({path, {Technique::camera, 0}, z.state(j).throughput * Le, 1});
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
    const Lights::Point point =
        world_.next_events.sample(z[j], settings_.mixture.through_windows, pick, u, v, side);
    begin_at_light(world_, point, light_point_);
    const Vertex& y0 = light_point_[0];
    const Edge e = between(z[j], y0);
    const Rgb Le = emitted(y0, -e.w);
    if (black(Le)) continue;
    const Rgb f = bsdf_at(z[j], e.w, back(z, j));
    const Rgb sent = z.state(j).throughput * f * Le;
    if (black(sent) || !visible(z[j], y0)) continue;
    // What many do not need: half of them and more are hidden.
    const double pdf = world_.next_events.pdf(z[j], y0).of(settings_.mixture.through_windows);
    const Rgb value = sent * Rgb(static_cast<float>(1 / pdf)) * geometry(z[j], y0, e);
    if (black(value)) continue;
    if (guide_.active()) guide_.aim_at_light(light_point_.v[0]);
    const Path path(world_, guide_, light_point_, 1, z, j + 1, tally_.rays);
    to_pixel({path, {Technique::direct, 1}, value, 1});
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
    const Path path(world_, guide_, y, i + 1, camera_walk_, 1, tally_.rays);
    to_film({path, {Technique::light, i + 1}, value, 1}, raster_x, raster_y);
  }
}

void PathSampler::join_drawn(const End& end, int edges) {
  few_.clear();
  values_.resize(drawn_.size());
  for (size_t c = 0; c < drawn_.size(); ++c) {
    const LightVertex& y = *drawn_[c];
    values_[c] = y.index + edges <= settings_.max_depth ? join(world_, y, end) : Rgb{};
    few_.add(luminance(values_[c]));
  }
}

void PathSampler::bi() {
  const Walk& z = camera_walk_;
  Sequence random = numbers(choices);
  for (int t = 2; t <= z.size; ++t) {
    if (!z[t - 1].connectible) continue;
    random.seek(2 * static_cast<uint32_t>(t));
    const auto [u_candidates, u_few] = random.uniforms<2>();
    const double times = pool_->draw(false, u_candidates, drawn_);
    join_drawn(camera_end(t - 1), t);
    for (const auto& [c, chance] : few_.choose(connections(t), u_few)) {
      const LightVertex& y = *drawn_[c];
      if (!visible(*y.vertex, z[t - 1])) continue;
      const double n = times * chance;
      const Path path(world_, guide_, *y.walk, y.index + 1, z, t, tally_.rays);
      to_pixel({path, {Technique::bi, y.index + 1}, values_[c] * static_cast<float>(1 / n), n});
    }
  }
}

bool PathSampler::draw_segment(const PortalSet::Sample& sample, Segment& segment) {
  // Both rays start at one place, behind the portal by more than rounding: what lies in its plane,
  // a pane as like as not, is met by one of them alone, and a segment that a wall there stops ends
  // too near the plane to have a density.
  auto& [x_l, x_c, crossing, presence] = segment;
  const Vec3f from(sample.position - world_.portals.polygon(sample.drawn.polygon).normal *
                                         (0.5 * PortalSet::kMargin));
  const auto end = [&](const Vec3d& w, Vertex& v) {
    Hit hit;
    ++tally_.rays.closest;
    if (world_.tracer.closest_from(from, w, hit)) {
      place_on_surface(world_, hit, v);
      segment.presence *= hit.presence;
      return true;
    }
    if (hit.triangle != ~0u || !world_.lights.sky()) return false;
    place_in_sky(world_, w, v);
    return true;
  };
  if (!end(sample.direction, x_c) || !x_c.connectible || !end(-sample.direction, x_l)) return false;
  // A lamp may be black or a mirror otherwise: light that begins there is not scattered there.
  if (!x_l.connectible && black(emitted(x_l, sample.direction))) return false;
  if (!(between(x_l, x_c).d2 > 0)) return false;
  const Vec3d begin =
      x_l.at_infinity() ? before_the_scene(x_c.position, x_l.position) : x_l.position;
  if (!world_.portals.spans(sample.drawn, begin, x_c.position)) return false;
  if (guide_.active()) {
    if (x_l.at_infinity())
      guide_.aim_at_light(x_l);
    else
      guide_.aim_at_surface(sample.direction, x_l);
    guide_.aim_at_surface(-sample.direction, x_c);
  }
  if (guide_.looks_out()) {
    // Where light begins at x_l, x_c may be x_1.
    if (!x_l.at_infinity()) world_.next_events.look_out(sample.direction, x_l);
    if (x_l.source) world_.next_events.look_out(-sample.direction, x_c);
  }
  crossing = guide_.crossing(x_l, x_c, tally_.rays.portal, sample.drawn);
  return crossing.density > 0;
}

// [eq. 1] with edge C1 of [eq. 2], over its density: a prefix vertices y_0..y_{a-1}, arriving at
// x_l and scattered along w. Each end's edges are tested against the portals once, for all paths
// that have them.
void PathSampler::light_sides(const Segment& segment, const Vec3d& w,
                              const std::array<double, 2>& u) {
  const Vertex& x_l = segment.x_l;
  light_sides_.clear();
  if (const Rgb Le = emitted(x_l, w); !black(Le)) light_sides_.push_back({light_, 0, Le, 1});
  if (x_l.at_infinity()) return;
  const double times = pool_->draw(true, u[0], drawn_);
  join_drawn(End(x_l, w, Rgb(1.0f)), 3);
  for (const auto& [c, chance] : few_.choose(kSides, u[1])) {
    const LightVertex& y = *drawn_[c];
    if (!visible(*y.vertex, x_l)) continue;
    const double n = times * chance;
    light_sides_.push_back({y.walk, y.index + 1, values_[c] * static_cast<float>(1 / n), n,
                            guide_.crossing(*y.vertex, x_l, tally_.rays.portal)});
  }
}

void PathSampler::splat_side(const Segment& segment, const Vec3d& w) {
  Vec3d to_camera;
  Rgb factor;
  Side side{&camera_walk_, 1, {}, 1};
  if (!project(segment.x_c, to_camera, factor, side.raster_x, side.raster_y)) return;
  side.value = bsdf_at(segment.x_c, -w, to_camera) * factor;
  if (black(side.value) || !visible(segment.x_c, camera_walk_[0])) return;
  side.crossing = guide_.crossing(segment.x_c, camera_walk_[0], tally_.rays.portal);
  camera_sides_.push_back(side);
}

// [eq. 3] with edge C3 of [eq. 2], over its density: b prefix vertices z_0..z_{b-1}, leaving x_c,
// scattered from -w.
void PathSampler::camera_sides(const Segment& segment, const Vec3d& w, double u) {
  const Walk& z = camera_walk_;
  const Vertex& x_c = segment.x_c;
  camera_sides_.clear();
  splat_side(segment, w);
  few_.clear();
  values_.clear();
  const End end(x_c, -w, Rgb(1.0f));
  for (int b = 2; b <= settings_.max_depth - 1 && b <= z.size; ++b) {
    values_.push_back(z[b - 1].connectible ? join(world_, end, camera_end(b - 1)) : Rgb{});
    few_.add(luminance(values_.back()));
  }
  for (const auto& [c, chance] : few_.choose(kSides, u)) {
    const int b = static_cast<int>(c) + 2;
    if (!visible(x_c, z[b - 1])) continue;
    camera_sides_.push_back({&z, b, values_[c] * static_cast<float>(1 / chance), chance,
                             guide_.crossing(x_c, z[b - 1], tally_.rays.portal)});
  }
}

void PathSampler::portal() {
  if (world_.portals.empty() || settings_.max_depth < 2) return;
  tally_.begin_portals(world_.portals.portals());
  Sequence random = numbers(segment_place);
  const PortalSet::Sample sample = world_.portals.sample(random.uniforms<7>());
  const double share = settings_.mixture.segments;
  if (!(random.uniform() < share)) return;
  Tally::OfPortal& of_portal = tally_.portals[world_.portals.polygon(sample.drawn.polygon).portal];
  ++of_portal.drawn;
  Segment segment;
  if (!draw_segment(sample, segment)) return;

  const auto& [x_l, x_c, crossing, presence] = segment;
  const Edge middle = between(x_l, x_c);
  random.seek(8);
  const auto [u_candidates, u_light, u_camera] = random.uniforms<3>();
  light_sides(segment, middle.w, {u_candidates, u_light});
  if (light_sides_.empty()) return;
  camera_sides(segment, middle.w, u_camera);

  // One throughput for both ends, the G of edge C2 of [eq. 2] over its density: G / p_AA = 1 / D; a
  // share of the samples stands for all.
  Rgb through(static_cast<float>(1 / (share * crossing.density * presence)));
  if (world_.absorbing) through = through * transmittance(x_l, x_c, middle.w, std::sqrt(middle.d2));
  double brought = 0;
  for (const Side& after : camera_sides_)
    for (const Side& before : light_sides_) {
      if (before.prefix + after.prefix + 1 > settings_.max_depth) continue;
      const Rgb value = before.value * after.value * through;
      if (black(value)) continue;
      const SegmentCrossings crossings{crossing, before.crossing, after.crossing};
      const Path path(world_, guide_, *before.walk, before.prefix, x_l, x_c, crossings, *after.walk,
                      after.prefix, tally_.rays);
      const Contribution found{
          path, {Technique::portal, before.prefix}, value, share * before.chance * after.chance};
      brought +=
          after.prefix == 1 ? to_film(found, after.raster_x, after.raster_y) : to_pixel(found);
    }
  of_portal.lit += brought > 0;
  of_portal.energy.add(brought);
}

}  // namespace tdpt
