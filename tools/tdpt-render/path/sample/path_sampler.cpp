#include "tools/tdpt-render/path/sample/path_sampler.h"

#include "libcommon/math/streams.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

PathSampler::PathSampler(const Vista& vista, const SampleSettings& settings, const Guide& guide,
                         Film& film, Tally& tally, const PathObserver* observer)
    : vista_(vista),
      settings_(settings),
      guide_(guide),
      film_(film),
      tally_(tally),
      observer_(observer),
      drawn_film_(vista.view.film) {}

Sequence PathSampler::numbers(uint32_t purpose) const {
  const uint64_t pixel = static_cast<uint64_t>(y_) << 32 | static_cast<uint64_t>(x_);
  return Sequence(settings_.seed, settings_.stream * kPurposes + purpose, pixel,
                  shader::number_in_half(sample_));
}

void PathSampler::begin(int x, int y, uint64_t sample) {
  x_ = x;
  y_ = y;
  sample_ = sample;
  coins_ = mix64(mix64(mix64(settings_.seed) + sample) +
                 (static_cast<uint64_t>(y) << 32 | static_cast<uint64_t>(x)));
  layer_coins_ = coins_;
  pixel_ = {};
}

void PathSampler::run() {
  own_cache_.clear();
  if (has_light_phase()) walk_from_light();
  camera_phase(light_walk_, own_cache_);
}

void PathSampler::light_phase(Walk& y) {
  tdpt::walk_from_light(vista_, guide_, settings_.max_depth - 1,
                        numbers(shader::PURPOSE_LIGHT_WALK), y, tally_.rays);
}

void PathSampler::connect_with(const Walk& y, LightVertexCache& cache) {
  light_ = &y;
  cache_ = &cache;
}

void PathSampler::camera_phase(const Walk& y, LightVertexCache& cache) {
  connect_with(y, cache);
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
  if (pixel_ != Vec3d() && !film_.add(x_, y_, pixel_, coin(), sample_)) leave_out();
}

void PathSampler::walk_from_camera() {
  Sequence place = numbers(shader::PURPOSE_FILM);
  const double x = x_ + place.uniform();
  const double y = y_ + place.uniform();
  drawn_film_ = vista_.view.of_sample(place);
  tdpt::walk_from_camera(vista_, guide_, drawn_film_, x, y, settings_.max_depth,
                         numbers(shader::PURPOSE_CAMERA_WALK), camera_walk_, tally_.rays);
  camera_ends_.clear();
  for (int j = 1; j < camera_walk_.size; ++j)
    camera_ends_.emplace_back(camera_walk_[j], way_back(camera_walk_, j),
                              camera_walk_.state(j).throughput);
}

void PathSampler::walk_from_light() {
  light_phase(light_walk_);
  own_cache_.clear();
  own_cache_.add(light_walk_);
  if (has_segment_phase()) segment_phase(light_walk_, own_cache_);
  connect_with(light_walk_, own_cache_);
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
  if (!film_.add(x, y, Vec3d(weighted), coin(), sample_)) {
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
  const double before = std::max<double>(shader::kBeforeTheScene, 2 * vista_.world->tracer.reach());
  const auto origin = [&](const Point& p, const Point& other) {
    if (!p.at_infinity()) return p.origin();
    return Tracer::Origin{before_the_scene(other.position, p.position, before)};
  };
  return vista_.world->tracer.visible(origin(a, b), origin(b, a));
}

bool PathSampler::seen(const Point& p) {
  const Vec3d& camera = camera_walk_[0].position;
  if (!vista_.world->tracer.draws(p.triangle, p.position - camera)) return false;
  ++tally_.rays.shadow;
  return vista_.world->tracer.sees(camera, p.origin());
}

Rgb PathSampler::geometry(const Point& a, const Point& b, const Edge& e) const {
  const auto g = static_cast<float>(tdpt::geometry(a, b, e));
  return vista_.world->absorbing ? transmittance(a, b, e.w, std::sqrt(e.d2)) * g : Rgb(g);
}

bool PathSampler::project(const Point& p, Vec3d& to_camera, Rgb& factor, double& x,
                          double& y) const {
  const Edge e = between(camera_walk_[0], p);
  if (!camera_walk_.film->raster(e.w, x, y)) return false;
  to_camera = -e.w;
  factor = geometry(camera_walk_[0], p, e) * static_cast<float>(camera_walk_.film->pdf_w(e.w));
  return true;
}

void PathSampler::camera() {
  const Walk& z = camera_walk_;
  if (film_.has_alpha() && looks_out()) return;
  for (int j = 1; j < z.size; ++j) {
    if (!z[j].source) continue;
    const Rgb Le = emitted(z[j], way_back(z, j));
    if (black(Le)) continue;
    const Path path(vista_, guide_, *light_, 0, z, j + 1, tally_.rays);
    to_pixel({path, {Technique::camera, 0}, z.state(j).throughput * Le, 1});
  }
}

void PathSampler::direct() {
  const Walk& z = camera_walk_;
  if (vista_.world->lights.empty()) return;
  Sequence random = numbers(shader::PURPOSE_NEXT_EVENT);
  for (int j = 1; j < z.size && j < settings_.max_depth; ++j) {
    if (!z[j].connectible) continue;
    random.seek(4 * static_cast<uint32_t>(j));
    const auto [u, v, pick, side] = random.uniforms<4>();
    const Lights::Point point =
        vista_.next_events().sample(camera_walk_.v[static_cast<size_t>(j)],
                                    settings_.mixture.through_windows, pick, u, v, side);
    if (!point.source) continue;
    begin_at_light(*vista_.world, point, light_point_);
    const Vertex& y0 = light_point_[0];
    const Edge e = between(z[j], y0);
    const Rgb Le = emitted(y0, -e.w);
    if (black(Le)) continue;
    const Rgb f = bsdf_at(z[j], e.w, way_back(z, j));
    const Rgb sent = z.state(j).throughput * f * Le;
    if (black(sent) || !visible(z[j], y0)) continue;
    // Computed only after the visibility test: at least half of the points are hidden.
    const double pdf =
        point.pdf > 0 ? point.pdf
                      : vista_.next_events().pdf(z[j], y0).of(settings_.mixture.through_windows);
    const Rgb value = sent * Rgb(static_cast<float>(1 / pdf)) * geometry(z[j], y0, e);
    if (black(value)) continue;
    if (guide_.active()) guide_.set_totals_at_light(light_point_.v[0]);
    const Path path(vista_, guide_, light_point_, 1, z, j + 1, tally_.rays);
    to_pixel({path, {Technique::direct, 1}, value, 1});
  }
}

void PathSampler::light() {
  const Walk& y = *light_;
  const double times = cache_->walks_per_sample();
  for (int i = 1; i < y.size; ++i) {
    if (!y[i].connectible) continue;
    Vec3d to_camera;
    Rgb factor;
    double raster_x, raster_y;
    if (!project(y[i], to_camera, factor, raster_x, raster_y)) continue;
    const Rgb value = y.state(i).throughput * bsdf_at(y[i], way_back(y, i), to_camera) * factor *
                      static_cast<float>(1 / times);
    if (black(value) || !seen(y[i])) continue;
    const Path path(vista_, guide_, y, i + 1, camera_walk_, 1, tally_.rays);
    to_film({path, {Technique::light, i + 1}, value, times}, raster_x, raster_y);
  }
}

void PathSampler::connect_drawn(const End& end, int edges) {
  resampling_.clear(drawn_.size());
  values_.resize(drawn_.size());
  tally_.rays.connect += drawn_.size();
  const bool in_columns = Ends::has(end) && !vista_.world->absorbing;
  if (in_columns) cache_->estimate(drawn_, end, estimates_);
  for (size_t c = 0; c < drawn_.size(); ++c) {
    const LightVertex& y = *drawn_[c];
    if (y.index + edges > settings_.max_depth) {
      resampling_.add(0);
    } else if (in_columns && Ends::has(y)) {
      resampling_.add(estimates_[c]);
    } else {
      values_[c] = connect(*vista_.world, y, end);
      resampling_.add(luminance(values_[c]));
    }
  }
}

// Contributions that were only estimated in columns are computed when they are chosen.
Rgb PathSampler::connected(const End& l, const End& c, size_t number) const {
  const bool in_columns = Ends::has(l) && Ends::has(c) && !vista_.world->absorbing;
  return in_columns ? connect(*vista_.world, l, c) : values_[number];
}

void PathSampler::bi() {
  const Walk& z = camera_walk_;
  Sequence random = numbers(shader::PURPOSE_CHOICES);
  for (int t = 2; t <= z.size; ++t) {
    if (!z[t - 1].connectible) continue;
    random.seek(2 * static_cast<uint32_t>(t));
    const auto [u_candidates, u_resampling] = random.uniforms<2>();
    const double times = cache_->draw(false, u_candidates, drawn_);
    const End& end = camera_end(t - 1);
    connect_drawn(end, t);
    for (const auto& [c, chance] : resampling_.choose(shader::connections_of(t), u_resampling)) {
      const LightVertex& y = *drawn_[c];
      if (!visible(*y.vertex, z[t - 1])) continue;
      const double n = times * chance;
      const Path path(vista_, guide_, *y.walk, y.index + 1, z, t, tally_.rays);
      const Rgb value = connected(y, end, c) * static_cast<float>(1 / n);
      to_pixel({path, {Technique::bi, y.index + 1}, value, n});
    }
  }
}

}  // namespace tdpt
