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
      hits[k].face = sky ? kWalkToSky + sky_bin(w) : kWalkLeft;
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

// The first ray of a light walk from any lamp; light from infinity uses `lines` if given.
Vec3d leave_light(const Lights& lights, const SkyLines* lines, Rng& rng, Tracer::Origin& from,
                  uint32_t& bin) {
  const Lights::Point point = lights.sample(rng);
  if (lines && point.source->at_infinity()) {
    const SkyLines::Line line = lines->draw(rng);
    from = {line.origin, {}};
    bin = line.bin;
    return line.direction;
  }
  const double u = rng.uniform();
  const double v = rng.uniform();
  const Lights::Ray ray = lights.leave(point, u, v);
  from = {ray.origin, point.normal};
  return ray.direction;
}

}  // namespace

Walks light_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& settings) {
  const Lights lights(scene);
  if (lights.empty()) return {};
  return run_walks(scene, tracer, settings, kWalksFromLight,
                   [&](uint32_t, Rng& rng, Tracer::Origin& from) {
                     uint32_t none;
                     return leave_light(lights, nullptr, rng, from, none);
                   });
}

Walks light_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& settings,
                  const SkyLines& lines, SkyStarts& starts) {
  const Lights lights(scene);
  starts.begun.assign(kSkyBins, 0);
  if (lights.empty()) return {};
  std::vector<uint32_t> bin(settings.walks, kSkyBins);
  const Walks walks = run_walks(scene, tracer, settings, kWalksFromLight,
                                [&](uint32_t i, Rng& rng, Tracer::Origin& from) {
                                  return leave_light(lights, &lines, rng, from, bin[i]);
                                });
  size_t walk = 0;
  for (size_t k = 0; k < walks.size(); ++k) {
    const bool first = k == 0 || !is_hit(walks[k - 1]);
    if (first && k > 0) ++walk;
    if (!is_hit(walks[k]) || bin[walk] == kSkyBins) continue;
    if (first) starts.begun[bin[walk]] += 1;
    starts.hits.push_back(k);
  }
  return walks;
}

std::vector<WalkHit> light_starts(const Scene& scene, const WalkSettings& settings) {
  const Lights lights(scene);
  if (lights.empty()) return {};
  std::vector<WalkHit> starts(settings.walks, WalkHit{kNoFace, {}});
  tbb::parallel_for(uint32_t{0}, settings.walks, [&](uint32_t i) {
    Rng rng(settings.seed, kWalksFromLight.first, i);
    const Lights::Point point = lights.sample(rng);
    if (!point.source->is_surface()) return;
    const bool back = dot(point.normal, shape_of(scene, point.triangle).normal) < 0;
    starts[i] = {2 * point.triangle + (back ? 1 : 0), Vec3f(point.position)};
  });
  std::erase_if(starts, [](const WalkHit& h) { return h.face == kNoFace; });
  return starts;
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
