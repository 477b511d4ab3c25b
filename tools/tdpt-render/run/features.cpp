#include "tools/tdpt-render/run/features.h"

#include <algorithm>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/sequence.h"
#include "libcommon/math/streams.h"
#include "tools/tdpt-render/path/sample/surface.h"

namespace tdpt {
namespace {

constexpr uint64_t kRays = 32;     // per pixel
constexpr int kMostSurfaces = 16;  // that a ray meets, the last included

struct Seen {
  Vec3d albedo, normal, position;
  double depth = 0;
  uint64_t met = 0;
};

Vec3d rgb_albedo(const Point& p, const Incidence& in) {
  return Vec3d(p.simple ? p.color : min(albedo_of(p, in), Rgb(1.0f)));
}

Vec3d normal_towards(const Point& p, const Vec3d& back) {
  const Vec3d normal = p.simple ? p.normal : p.shading;
  return dot(p.normal, back) < 0 ? -normal : normal;
}

double index_at(const Point& p, const Vec3d& w) {
  return surfaces().index_at(p.bsdf, {0, 0, dot(p.normal, w)});
}

// Adds albedo and normal for the camera's ray along w, which has hit `hit`. It goes on by Dirac
// lobes, where there are no others; one number chooses between reflection and transmission.
void look_on(const World& world, Hit hit, Vec3d w, Sequence& numbers, Seen& seen) {
  Point here, from;
  from.position = world.film.position();
  Vec3d tint(1), first;
  for (int met = 0; met < kMostSurfaces; ++met) {
    place_on_surface(world, hit, here);
    const Incidence in(here, -w);
    tint = tint / hit.opacity;
    if (world.absorbing) tint = tint * Vec3d(transmittance(from, here, w, hit.distance));
    if (met == 0) first = normal_towards(here, in.back);
    if (here.connectible || here.source) {
      seen.albedo += tint * rgb_albedo(here, in);
      seen.normal += normal_towards(here, in.back);
      return;
    }
    Turn t;
    if (!turn(here, From::camera, in, {0, 0, numbers.uniform()}, t)) break;
    // Without the n^2 that radiance gains in a solid.
    const double n = index_at(here, t.w) / index_at(here, in.back);
    tint = tint * t.weight * (n * n);
    w = t.w;
    std::swap(here, from);
    hit = {};
    if (!world.tracer.closest(from.origin(), w, hit)) break;
  }
  seen.normal += first;
}

void look(const World& world, double x, double y, bool on, Sequence& numbers, Seen& seen) {
  const Vec3d w = world.film.direction(x, y);
  Hit hit;
  if (!world.tracer.first_seen(world.film.position(), w, hit)) return;
  ++seen.met;
  seen.position += hit.position;
  seen.depth += dot(hit.position - world.film.position(), world.film.forward());
  if (on) look_on(world, hit, w, numbers, seen);
}

Seen look(const World& world, size_t x, size_t y, bool on, uint64_t seed) {
  Seen seen;
  const uint64_t pixel = y << 32 | x;
  for (uint64_t i = 0; i < kRays; ++i) {
    Sequence numbers(seed, kFeaturePlaces.first, pixel, i);
    const double u = numbers.uniform(), v = numbers.uniform();
    look(world, static_cast<double>(x) + u, static_cast<double>(y) + v, on, numbers, seen);
  }
  const double met = static_cast<double>(std::max<uint64_t>(seen.met, 1));
  const Frame& frame = world.scene.frame;
  // Lobes are chosen by the sum of their colour, so one component may exceed 1 by chance.
  seen.albedo = min(seen.albedo / static_cast<double>(kRays), Vec3d(1));
  seen.normal = seen.normal / met;
  seen.position = seen.met > 0 ? frame.to_metres(seen.position / met) : Vec3d();
  seen.depth = seen.met > 0 ? seen.depth / met / frame.scale : 1e10;
  return seen;
}

}  // namespace

Channels features(const World& world, const std::vector<std::string>& names, uint64_t seed) {
  const auto width = static_cast<size_t>(world.film.width());
  const auto height = static_cast<size_t>(world.film.height());
  Channels channels;
  const auto channel = [&](const char* name, const char* part) -> float* {
    if (std::find(names.begin(), names.end(), name) == names.end()) return nullptr;
    std::vector<float>& values = channels[std::string(name) + "." + part];
    values.resize(width * height);
    return values.data();
  };
  struct Target {
    float* to;
    double (*of)(const Seen&);
  };
  const Target targets[] = {
      {channel("albedo", "R"), [](const Seen& s) { return s.albedo.x; }},
      {channel("albedo", "G"), [](const Seen& s) { return s.albedo.y; }},
      {channel("albedo", "B"), [](const Seen& s) { return s.albedo.z; }},
      {channel("normal", "X"), [](const Seen& s) { return s.normal.x; }},
      {channel("normal", "Y"), [](const Seen& s) { return s.normal.y; }},
      {channel("normal", "Z"), [](const Seen& s) { return s.normal.z; }},
      {channel("position", "X"), [](const Seen& s) { return s.position.x; }},
      {channel("position", "Y"), [](const Seen& s) { return s.position.y; }},
      {channel("position", "Z"), [](const Seen& s) { return s.position.z; }},
      {channel("depth", "Z"), [](const Seen& s) { return s.depth; }},
  };
  if (channels.empty()) return channels;
  const bool on = targets[0].to || targets[3].to;
  tbb::parallel_for(size_t{0}, height, [&](size_t y) {
    for (size_t x = 0; x < width; ++x) {
      const Seen seen = look(world, x, y, on, seed);
      for (const Target& target : targets)
        if (target.to) target.to[y * width + x] = static_cast<float>(target.of(seen));
    }
  });
  return channels;
}

}  // namespace tdpt
