#include "tools/ffgraph/walks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/flow/potential_sweep.h"
#include "libcommon/math/streams.h"
#include "libcommon/scene/film_plane.h"
#include "libcommon/scene/lights.h"

namespace tdpt {
namespace {

constexpr double kByLight = 0.5;               // share of the lines chosen in proportion to light
constexpr double kAimed = 0.5, kWider = 0.25;  // shares aimed at the first and second ball
constexpr double kAround = 1.1;  // factor on a ball's radius, so that outer walls are hit, too

SkyLines::Ball ball_about(const Extent& box) {
  return {(box.low + box.high) * 0.5, kAround * 0.5 * length(box.size())};
}

}  // namespace

std::vector<double> sky_grades(const std::vector<double>& light) {
  std::vector<double> sr;  // solid angles
  for (uint32_t k = 0; k < light.size(); ++k) sr.push_back(sky_bin_solid_angle(k));
  return terminal_grades(light, sr, sr);
}

SkyLines::SkyLines(const Scene& scene, const Extent& aim, const Extent& wider) {
  Extent whole;
  for (const Vec3f& p : scene.positions) whole.add(Vec3d(p));
  balls_ = {ball_about(aim.empty() ? whole : aim), ball_about(wider.empty() ? whole : wider),
            ball_about(whole)};
  for (const PunctualLight& l : scene.lights) {
    if (l.kind != PunctualLight::Kind::directional) continue;
    parallel_.push_back(-l.direction);
    irradiance_.push_back(luminance(l.intensity));
  }
  std::vector<double> weights = irradiance_;
  if (scene.sky) directions_ = SkyDirections(*scene.sky), sky_ = scene.sky.get();
  weights.push_back(directions_.total());
  lights_ = AliasTable(weights);
  weights = sky_grades(sky_bin_light(scene));
  for (uint32_t k = 0; k < kSkyBins; ++k) weights[k] *= sky_bin_solid_angle(k);
  bins_ = AliasTable(weights);
}

SkyLines::Towards SkyLines::towards(Rng& rng) const {
  const bool by_light = rng.uniform() < kByLight;
  const double pick = rng.uniform();
  const double part = rng.uniform();
  const double u = rng.uniform();
  const double v = rng.uniform();
  Vec3d w;
  if (by_light) {
    const uint32_t i = lights_.sample(pick);
    if (i < parallel_.size()) return {parallel_[i], irradiance_[i] / (kByLight * lights_.pdf_1(i))};
    w = directions_.sample(part, u, v);
  } else {
    const std::array<Vec3d, 3>& c = sky_bin_corners(bins_.sample(pick));
    double b1, b2;
    uniform_triangle(u, v, b1, b2);
    w = normalize(c[0] + (c[1] - c[0]) * b1 + (c[2] - c[0]) * b2);
  }
  if (!sky_) return {w, 0};
  const uint32_t bin = sky_bin(w);
  const auto sky = static_cast<uint32_t>(parallel_.size());
  const double pdf_w = kByLight * lights_.pdf_1(sky) * directions_.pdf_w(w) +
                       (1 - kByLight) * bins_.pdf_1(bin) / sky_bin_solid_angle(bin);
  return {w, luminance(sky_->radiance(w)) / pdf_w};
}

// The density of lines along w through this place [1/canonical area].
double SkyLines::density_across(const Vec3d& through, const Vec3d& w) const {
  constexpr std::array<double, 3> kShares{kAimed, kWider, 1 - kAimed - kWider};
  double density = 0;
  for (size_t k = 0; k < balls_.size(); ++k) {
    const double area = std::numbers::pi * balls_[k].radius * balls_[k].radius;
    const Vec3d off = cross(through - balls_[k].centre, w);
    if (std::numbers::pi * dot(off, off) <= area * (1 + 1e-9)) density += kShares[k] / area;
  }
  return density;
}

SkyLines::Line SkyLines::draw(Rng& rng) const {
  const double which = rng.uniform();
  const Ball& ball = balls_[which < kAimed ? 0 : which < kAimed + kWider ? 1 : 2];
  const Towards from = towards(rng);
  const Vec3d w = -from.w;
  const double phi = 2 * std::numbers::pi * rng.uniform();
  const double r = ball.radius * std::sqrt(rng.uniform());
  // Starts outside everything that may occlude the line.
  const double far = length(ball.centre - balls_[2].centre) + balls_[2].radius + ball.radius;
  const Onb<double> onb(w);
  const Vec3d origin = ball.centre + onb.to_world({r * std::cos(phi), r * std::sin(phi), -far});
  return {origin, w, sky_bin(-w), from.per_pdf / density_across(origin, w)};
}

namespace {

Vec3d cosine_direction(Rng& rng, const Vec3d& normal) {
  const double u = rng.uniform();
  const double v = rng.uniform();
  return Onb<double>(normal).to_world(cosine_hemisphere(u, v));
}

// Follows one walk from its first ray; writes at most `bounces` hits and an end mark.
void follow(const Tracer& tracer, const Streams& streams, bool sky, Rng& rng, Tracer::Origin from,
            Vec3d w, WalkHit* hits, uint32_t bounces) {
  for (uint32_t k = 0; k < bounces; ++k) {
    Hit hit;
    if (k == 0 && streams.first == kWalksFromCamera.first
            ? !tracer.first_seen(from.position, w, hit)
            : !tracer.closest(from, w, hit)) {
      hits[k].face = sky && hit.triangle == ~0u ? kWalkToSky + sky_bin(w) : kWalkLeft;
      return;
    }
    const bool back = dot(hit.normal, w) > 0;
    hits[k] = {2 * hit.triangle + (back ? 1 : 0), Vec3f(hit.position)};
    from = {hit.position, back ? -hit.normal : hit.normal};
    w = cosine_direction(rng, from.normal);
  }
  hits[bounces].face = kWalkStopped;
}

template <class Begin>
Walks run_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& s,
                const Streams& streams, const Begin& begin) {
  const bool sky = lit_from_infinity(scene);
  const size_t slots = size_t{s.bounces} + 1;
  Walks hits(s.walks * slots, WalkHit{kNoFace, {}});
  tbb::parallel_for(uint32_t{0}, s.walks, [&](uint32_t i) {
    Rng rng(s.seed, streams.first, i);
    Tracer::Origin from;
    const Vec3d w = begin(i, rng, from);
    follow(tracer, streams, sky, rng, from, w, &hits[i * slots], s.bounces);
  });
  std::erase_if(hits, [](const WalkHit& h) { return h.face == kNoFace; });
  return hits;
}

// Begins light walk i from `from`; returns its direction.
Vec3d leave_light(const Scene& scene, const LightSelection& selection, const SkyLines* lines,
                  uint32_t i, Rng& rng, LightWalks& walks, Tracer::Origin& from) {
  const Lights::Point point = selection.sample(rng);
  if (lines && point.source->at_infinity()) {
    const SkyLines::Line line = lines->draw(rng);
    walks.bin[i] = line.bin;
    walks.power[i] = line.power / (selection.shares().parallel + selection.shares().sky);
    from = {line.origin, {}};
    return line.direction;
  }
  const double u = rng.uniform();
  const double v = rng.uniform();
  const Lights::Ray ray = selection.lights().leave(point, u, v);
  Rgb radiance{};
  Vec3d front{};
  if (point.source->is_surface()) {
    front = shape_of(scene, point.triangle).normal;
    radiance = scene.materials[scene.triangles[point.triangle].material].emission;
    const bool back = dot(point.normal, front) < 0;
    walks.start[i] = {2 * point.triangle + (back ? 1 : 0), Vec3f(point.position)};
  }
  walks.power[i] = luminance(point.source->emitted(front, radiance, ray.direction)) *
                   point.source->cos_per_pdf_w(ray.direction) / point.pdf;
  from = {ray.origin, point.normal};
  return ray.direction;
}

}  // namespace

LightWalks light_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& settings,
                       const SkyLines* lines) {
  LightWalks walks;
  const Lights lights(scene);
  if (lights.empty()) return walks;
  const LightSelection selection(lights);
  walks.power.resize(settings.walks);
  walks.start.resize(settings.walks, {kNoFace, {}});
  if (lines) walks.bin.resize(settings.walks, kSkyBins);
  walks.hits = run_walks(scene, tracer, settings, kWalksFromLight,
                         [&](uint32_t i, Rng& rng, Tracer::Origin& from) {
                           return leave_light(scene, selection, lines, i, rng, walks, from);
                         });
  return walks;
}

Walks camera_walks(const Scene& scene, const Camera& camera, const Tracer& tracer,
                   const WalkSettings& settings) {
  const double aspect = camera.aspect > 0 ? camera.aspect : 16.0 / 9;
  const int height = 4096;
  const int width = static_cast<int>(std::clamp(std::round(height * aspect), 1.0, 1e6));
  const FilmPlane film(camera, width, height);
  return run_walks(scene, tracer, settings, kWalksFromCamera,
                   [&](uint32_t, Rng& rng, Tracer::Origin& from) {
                     const double x = rng.uniform() * width;
                     const double y = rng.uniform() * height;
                     from = {film.position(), {}};
                     return film.direction(x, y);
                   });
}

size_t hits_in(const Walks& walks) {
  return static_cast<size_t>(std::count_if(walks.begin(), walks.end(), is_hit));
}

namespace {

constexpr double kMargin = 0.5;  // of the diagonal: fine cells extend this far around the region
// Share of the diagonal of all regions that a camera's has at least: a camera in a closet does not
// make the whole house fine.
constexpr double kSmallest = 0.5;
constexpr int kMostLevels = 6;         // of cells between the region and the whole scene
constexpr size_t kMostPlaces = 40000;  // per set of walks, used to find the region

// Metres.
Extent reach_of_walks(const Scene& scene, const Walks& walks) {
  std::vector<Vec3d> places;
  const size_t step = walks.size() / kMostPlaces + 1;
  for (size_t k = 0; k < walks.size(); k += step)
    if (is_hit(walks[k])) places.push_back(scene.frame.to_metres(Vec3d(walks[k].position)));
  return reach_of(places);
}

}  // namespace

GridOfWalks grid_for(const Scene& scene, const Walks& light, const std::vector<Walks>& cameras,
                     double cells) {
  Extent whole;
  for (const Triangle& t : scene.triangles)
    for (const uint32_t v : t.vertex) whole.add(scene.frame.to_metres(Vec3d(scene.positions[v])));
  if (whole.empty()) whole.add(Vec3d{});
  // Sky light matters only where it reaches rooms, wherever else it falls.
  const Extent of_light = lit_from_infinity(scene) ? Extent() : reach_of_walks(scene, light);
  Extent region;
  std::vector<double> diagonals;
  for (const Walks& camera : cameras) {
    Extent own = reach_of_walks(scene, camera);
    own.add(of_light);
    if (own.empty()) continue;
    own = own.within(whole);
    diagonals.push_back(length(own.size()));
    region.add(own);
  }
  if (region.empty()) region = whole, diagonals = {length(whole.size())};

  const auto median = diagonals.begin() + static_cast<std::ptrdiff_t>((diagonals.size() - 1) / 2);
  std::nth_element(diagonals.begin(), median, diagonals.end());
  const double diagonal =
      std::max({*median, kSmallest * length(region.size()), 1e-6 / scene.frame.scale});
  GridOfWalks g;
  g.grid.base_cell = diagonal / cells;
  while (cells * g.grid.base_cell < (1 - 1e-9) * length(whole.size()) &&
         g.fine.level < kMostLevels) {
    g.grid.base_cell *= 4;
    ++g.fine.level;
  }
  const Extent around = region.widened(Vec3d(kMargin * diagonal));
  g.fine.low = around.low;
  g.fine.high = around.high;
  // Walls often coincide with the bounding box: keep them off the cell faces.
  const double cell = diagonal / cells;
  g.grid.origin = region.low - Vec3d(0.3819, 0.3453, 0.4142) * cell;
  return g;
}

}  // namespace tdpt
