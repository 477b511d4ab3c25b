#include "tools/ffgraph/walks.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/streams.h"
#include "libcommon/math/warp.h"
#include "libcommon/scene/film_plane.h"
#include "libcommon/scene/lights.h"
#include "tools/ffgraph/patch_map.h"

namespace tdpt {
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

// How a light walk begins.
struct Start {
  Tracer::Origin from;
  Vec3d direction;
  double power = 0;
  uint32_t bin = kSkyBins;
  WalkHit at{kNoFace, {}};
};

Start leave_light(const Scene& scene, const LightSelection& selection, const SkyLines* lines,
                  Rng& rng) {
  const Lights::Point point = selection.sample(rng);
  Start start;
  if (lines && point.source->at_infinity()) {
    const SkyLines::Line line = lines->draw(rng);
    start.from = {line.origin, {}};
    start.direction = line.direction;
    start.bin = line.bin;
    start.power = line.power / (selection.shares().parallel + selection.shares().sky);
    return start;
  }
  const double u = rng.uniform();
  const double v = rng.uniform();
  const Lights::Ray ray = selection.lights().leave(point, u, v);
  start.from = {ray.origin, point.normal};
  start.direction = ray.direction;
  Rgb radiance{};
  Vec3d front{};
  if (point.source->is_surface()) {
    front = shape_of(scene, point.triangle).normal;
    radiance = scene.materials[scene.triangles[point.triangle].material].emission;
    const bool back = dot(point.normal, front) < 0;
    start.at = {2 * point.triangle + (back ? 1 : 0), Vec3f(point.position)};
  }
  start.power = luminance(point.source->emitted(front, radiance, ray.direction)) *
                point.source->cos_per_pdf_w(ray.direction) / point.pdf;
  return start;
}

}  // namespace

LightWalks light_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& settings,
                       const SkyLines* lines) {
  LightWalks walks;
  const Lights lights(scene);
  if (lights.empty()) return walks;
  const LightSelection selection(lights);
  std::vector<Start> starts(settings.walks);
  walks.hits = run_walks(scene, tracer, settings, kWalksFromLight,
                         [&](uint32_t i, Rng& rng, Tracer::Origin& from) {
                           starts[i] = leave_light(scene, selection, lines, rng);
                           from = starts[i].from;
                           return starts[i].direction;
                         });
  for (uint32_t i = 0; i < starts.size(); ++i) {
    walks.power.push_back(starts[i].power);
    if (starts[i].at.face != kNoFace) walks.starts.push_back({i, starts[i].at});
    if (lines) walks.bin.push_back(starts[i].bin);
  }
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

}  // namespace tdpt
