#include "tools/tdpt-render/run/features.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/sequence.h"
#include "libcommon/math/streams.h"
#include "tools/tdpt-render/path/sample/surface.h"

namespace tdpt {
namespace {

constexpr uint64_t kRays = 32;  // per pixel

struct Seen {
  Vec3d albedo, normal, position;
  double depth = 0;
  uint64_t met = 0;
};

Vec3d albedo_at(const Point& p, const Vec3d& back) {
  if (p.simple) return Vec3d(p.color);
  return Vec3d(min(albedo_of(p, Incidence(p, back)), Rgb(1.0f)));
}

void look(const World& world, double x, double y, Seen& seen) {
  const Vec3d w = world.film.direction(x, y);
  Hit hit;
  if (!world.tracer.first_seen(world.film.position(), w, hit)) return;
  Point p;
  place_on_surface(world, hit, p);
  const Vec3d normal = p.simple ? p.normal : p.shading;
  ++seen.met;
  seen.albedo += albedo_at(p, -w) / hit.opacity;
  seen.normal += dot(p.normal, w) > 0 ? -normal : normal;
  seen.position += hit.position;
  seen.depth += dot(hit.position - world.film.position(), world.film.forward());
}

Seen look(const World& world, size_t x, size_t y, uint64_t seed) {
  Seen seen;
  const uint64_t pixel = y << 32 | x;
  for (uint64_t i = 0; i < kRays; ++i) {
    Sequence place(seed, kFeaturePlaces.first, pixel, i);
    const double u = place.uniform(), v = place.uniform();
    look(world, static_cast<double>(x) + u, static_cast<double>(y) + v, seen);
  }
  const double met = static_cast<double>(std::max<uint64_t>(seen.met, 1));
  const Frame& frame = world.scene.frame;
  seen.albedo = seen.albedo / static_cast<double>(kRays);
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
  tbb::parallel_for(size_t{0}, height, [&](size_t y) {
    for (size_t x = 0; x < width; ++x) {
      const Seen seen = look(world, x, y, seed);
      for (const Target& target : targets)
        if (target.to) target.to[y * width + x] = static_cast<float>(target.of(seen));
    }
  });
  return channels;
}

}  // namespace tdpt
