// Portal segments: drawn and connected with the light's side in one phase of a sample, with the
// camera's in the next [path_sampler.h]. Sections 3.1.1 and 3.2.
//
// A segment that has found light is worth more than the one sample that drew it can use, so the
// camera vertices of all samples of a cache are connected with it: of all pairs of a vertex and a
// segment only the few with the largest estimates get their ray. At depth 6, for equal numbers of
// samples: 0.5 and 0.55 times the relMSE in the room with the door ajar and in three rooms, and
// 1.25 times the CPU time; with half of the segments 0.6 times, at 1.1 times the time.
#include <algorithm>

#include "tools/tdpt-render/path/sample/path_sampler.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

void PathSampler::segment_phase(const Walk& y, LightVertexCache& cache) {
  connect_with(y, cache);
  if (vista_.openings.portals.empty() || settings_.max_depth < 2) return;
  tally_.begin_portals(vista_.openings.portals.portals());
  Sequence random = numbers(shader::PURPOSE_SEGMENT);
  const PortalSet::SegmentDraw sample = vista_.openings.portals.sample(random.uniforms<7>());
  const double share = settings_.mixture.segments;
  if (!(random.uniform() < share)) return;
  PortalSegment& segment = cache.place_for_segment();
  segment.portal = sample.portal;
  ++tally_.portals[segment.portal].drawn;
  if (!draw_segment(sample, segment)) return;

  random.seek(8);
  connect_with_light(segment, random.uniforms<2>());
  if (segment.light.empty()) return;
  const Edge middle = between(segment.x_l, segment.x_c);
  segment.through =
      Rgb(static_cast<float>(1 / (share * segment.crossing.density * segment.opacity)));
  if (vista_.world->absorbing)
    segment.through =
        segment.through * transmittance(segment.x_l, segment.x_c, middle.w, std::sqrt(middle.d2));
  segment.x = x_, segment.y = y_, segment.sample = sample_;
  segment.lit = false;
  cache.keep_segment();
}

bool PathSampler::draw_segment(const PortalSet::SegmentDraw& sample, PortalSegment& segment) {
  // Both rays start at one point, behind the portal by more than rounding. A surface in the
  // portal's plane, often a pane, is then hit by only one of them, and a segment stopped by a wall
  // there ends too near the plane to have a density.
  Vertex &x_l = segment.x_l, &x_c = segment.x_c;
  x_l = x_c = {};
  segment.opacity = 1;
  const Vec3f from(vista_.openings.portals.segment_start(sample));
  const auto end = [&](const Vec3d& w, Vertex& v) {
    Hit hit;
    ++tally_.rays.closest;
    if (vista_.world->tracer.closest_from(from, w, hit)) {
      place_on_surface(*vista_.world, hit, v);
      segment.opacity *= hit.opacity;
      return true;
    }
    if (hit.triangle != ~0u || !vista_.world->lights.sky()) return false;
    place_in_sky(vista_.openings.selection, w, v);
    return true;
  };
  if (!end(sample.direction, x_c) || !x_c.connectible || !end(-sample.direction, x_l)) return false;
  // The surface of a lamp may be black or a mirror: light that begins there is not scattered there.
  if (!x_l.connectible && black(emitted(x_l, sample.direction))) return false;
  const Edge middle = between(x_l, x_c);
  if (!(middle.d2 > 0)) return false;
  const Vec3d begin =
      x_l.at_infinity() ? before_the_scene(x_c.position, x_l.position) : x_l.position;
  if (!vista_.openings.portals.segment_spans(sample.drawn, begin, x_c.position)) return false;
  if (guide_.active()) {
    if (x_l.at_infinity())
      guide_.set_totals_at_light(x_l);
    else
      guide_.set_totals_at_surface(sample.direction, x_l);
    guide_.set_totals_at_surface(-sample.direction, x_c);
  }
  if (guide_.looks_out()) {
    // If light begins at x_l, x_c may be x_1.
    if (!x_l.at_infinity()) vista_.next_events().look_out(sample.direction, x_l);
    if (x_l.source) vista_.next_events().look_out(-sample.direction, x_c);
  }
  segment.w = middle.w;
  segment.crossing = guide_.crossing(x_l, x_c, tally_.rays.portal, sample.drawn);
  return segment.crossing.density > 0;
}

// [eq. 1] with edge C1 of [eq. 2], over its density: a prefix vertices y_0..y_{a-1}, arriving at
// x_l and scattered along w. Each end's edges are tested against the portals once, for all paths
// that contain them.
void PathSampler::connect_with_light(PortalSegment& segment, const std::array<double, 2>& u) {
  const Vertex& x_l = segment.x_l;
  segment.light.clear();
  if (const Rgb Le = emitted(x_l, segment.w); !black(Le))
    segment.light.push_back({light_, 0, Le, 1});
  if (x_l.at_infinity()) return;
  const double times = cache_->draw(true, u[0], drawn_);
  const End end(x_l, segment.w, Rgb(1.0f));
  connect_drawn(end, 3);
  for (const auto& [c, chance] : resampling_.choose(shader::kLightSides, u[1])) {
    const LightVertex& y = *drawn_[c];
    if (!visible(*y.vertex, x_l)) continue;
    const double n = times * chance;
    segment.light.push_back({y.walk, y.index + 1, connected(y, end, c) * static_cast<float>(1 / n),
                             n, guide_.crossing(*y.vertex, x_l, tally_.rays.portal)});
  }
}

Rgb PathSampler::light_of(const PortalSegment& segment, int t) const {
  Rgb sum;
  for (const Side& before : segment.light)
    if (before.prefix + t + 1 <= settings_.max_depth) sum += before.value;
  return sum;
}

void PathSampler::through(PortalSegment& segment, int t, const Rgb& value, double times,
                          const std::array<double, 2>& raster) {
  const Vertex &x_l = segment.x_l, &x_c = segment.x_c;
  const Walk& z = camera_walk_;
  const PortalSet::CrossingDensity after = guide_.crossing(x_c, z[t - 1], tally_.rays.portal);
  double brought = 0;
  for (const Side& before : segment.light) {
    if (before.prefix + t + 1 > settings_.max_depth) continue;
    const Rgb all = before.value * value;
    if (black(all)) continue;
    const SegmentCrossings crossings{segment.crossing, before.crossing, after};
    const Path path(vista_, guide_, *before.walk, before.prefix, x_l, x_c, crossings, z, t,
                    tally_.rays);
    const Contribution found{path, {Technique::portal, before.prefix}, all, times * before.chance};
    brought += t == 1 ? to_film(found, raster[0], raster[1]) : to_pixel(found);
  }
  Tally::OfPortal& of_portal = tally_.portals[segment.portal];
  of_portal.energy.add(brought);
  of_portal.lit += brought > 0 && !segment.lit;
  segment.lit |= brought > 0;
}

void PathSampler::see(PortalSegment& segment) {
  Vec3d to_camera;
  Rgb factor;
  std::array<double, 2> raster;
  if (!project(segment.x_c, to_camera, factor, raster[0], raster[1])) return;
  const Rgb value = bsdf_at(segment.x_c, -segment.w, to_camera) * factor * segment.through;
  if (black(value) || !seen(segment.x_c)) return;
  through(segment, 1, value, settings_.mixture.segments, raster);
}

void PathSampler::estimate_segments(int t) {
  const std::span<PortalSegment> segments = cache_->segments();
  const size_t first = static_cast<size_t>(t - 2) * Ends::room(segments.size());
  const End& c = camera_end(t - 1);
  const auto of_t = std::span(estimates_).subspan(first, segments.size());
  if (!camera_walk_[t - 1].connectible) {
    std::fill(of_t.begin(), of_t.end(), 0.0);
    return;
  }
  const bool in_columns = Ends::has(c) && !vista_.world->absorbing;
  Ends& columns = cache_->segment_columns();
  if (in_columns && settings_.max_depth < kMaxDepth)
    for (size_t i = 0; i < segments.size(); ++i) columns.set_light(i, light_of(segments[i], t));
  if (in_columns) columns.estimate(c, of_t.data());
  for (size_t i = 0; i < segments.size(); ++i) {
    const End& l = cache_->segment_end(i);
    if (in_columns && Ends::has(l)) continue;
    values_[first + i] = connect(*vista_.world, l, c);
    of_t[i] = luminance(values_[first + i] * light_of(segments[i], t));
  }
}

// [eq. 3] with edge C3 of [eq. 2], over its density: t prefix vertices z_0..z_{t-1}, leaving x_c,
// scattered from -w.
void PathSampler::connect_with_segments() {
  const Walk& z = camera_walk_;
  const std::span<PortalSegment> segments = cache_->segments();
  const int of_each = std::min(z.size, settings_.max_depth - 1) - 1;
  if (of_each < 1 || segments.empty()) return;
  cache_->prepare_segments();
  const size_t n = segments.size(), ends = static_cast<size_t>(of_each), row = Ends::room(n);
  values_.resize(std::max(values_.size(), row * ends));
  estimates_.resize(std::max(estimates_.size(), row * ends));
  for (int t = 2; t < 2 + of_each; ++t) estimate_segments(t);
  resampling_.clear(n * ends);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < ends; ++j) resampling_.add(estimates_[j * row + i]);
  tally_.rays.connect += n * ends;
  Sequence random = numbers(shader::PURPOSE_SEGMENT);
  random.seek(12);
  for (const auto& [chosen, chance] : resampling_.choose(shader::kPairs, random.uniform())) {
    const size_t i = chosen / ends, j = chosen % ends;
    PortalSegment& segment = segments[i];
    const int t = 2 + static_cast<int>(j);
    if (!visible(segment.x_c, z[t - 1])) continue;
    const Rgb value = connected(cache_->segment_end(i), camera_end(t - 1), j * row + i);
    const double times = cache_->samples() * chance;
    through(segment, t, value * static_cast<float>(1 / times), settings_.mixture.segments * times,
            {});
  }
}

void PathSampler::portal() {
  for (PortalSegment& segment : cache_->segments())
    if (segment.sample == sample_ && segment.x == x_ && segment.y == y_) see(segment);
  connect_with_segments();
}

}  // namespace tdpt
