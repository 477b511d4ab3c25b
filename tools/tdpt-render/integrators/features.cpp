#include "tools/tdpt-render/integrators/features.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/sequence.h"
#include "libcommon/math/streams.h"

namespace tdpt {
namespace {

constexpr uint64_t kRays = 32;     // per pixel
constexpr int kMostSurfaces = 16;  // that turn a ray
// A ray splits as long as each part has this share of it; else one part is chosen by chance.
constexpr double kLeastShare = 1.0 / 32;

// Sums over rays.
struct Seen {
  Vec3d albedo, normal, position;
  double depth = 0, met = 0;
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

// Probability of a Dirac lobe.
double chance_of(const Point& p, const Incidence& in, const Vec3d& w) {
  const double n = index_at(p, w), cos = std::abs(dot(p.shading, w));
  return scatter_pdf_w(p, in, w, true) / std::max(n * n * cos, 1e-30);
}

struct Ray {
  Point from;
  Vec3d w, tint{1};
  double share = 1;
  int turns = 0;
  Vec3d first;  ///< normal of the first surface, after a turn
};

// Follows rays, and what they split into, until they meet a surface at which they end.
class Sight {
 public:
  Sight(const Vista& vista, const FilmPlane& film, bool on, Sequence& numbers, Seen& seen)
      : vista_(vista), film_(film), on_(on), numbers_(numbers), seen_(seen) {}

  void follow(Ray ray) {
    std::vector<uint32_t> passed;  // sheets that stop a part of the ray
    Tracer::Sheet sheet;
    while (finds(ray, passed, sheet)) {
      const double stopped = first_share(ray.share, sheet.coverage);
      if (stopped > 0) {
        Ray part = ray;
        part.share *= stopped;
        meet(part, sheet.hit);
      }
      if (stopped == 1) return;
      ray.share *= 1 - stopped;
      passed.push_back(sheet.hit.triangle);
    }
    seen_.normal += ray.first * ray.share;
  }

 private:
  bool finds(const Ray& ray, const std::vector<uint32_t>& passed, Tracer::Sheet& sheet) const {
    const Tracer& tracer = vista_.world->tracer;
    return ray.turns == 0 ? tracer.first_sheet_seen(ray.from.position, ray.w, passed, sheet)
                          : tracer.first_sheet(ray.from.origin(), ray.w, passed, sheet);
  }

  // Of two parts of a ray, the first with that probability.
  double first_share(double share, double chance) {
    if (chance <= 0 || chance >= 1) return chance <= 0 ? 0 : 1;
    if (share * std::min(chance, 1 - chance) >= kLeastShare) return chance;
    return numbers_.uniform() < chance ? 1 : 0;
  }

  void meet(Ray& ray, const Hit& hit) {
    if (ray.turns == 0) {
      const Vec3d away = hit.position - film_.position();
      seen_.met += ray.share;
      seen_.position += hit.position * ray.share;
      seen_.depth += dot(away, film_.forward()) * ray.share;
    }
    if (!on_) return;
    Point here;
    place_on_surface(*vista_.world, hit, here);
    const Incidence in(here, -ray.w);
    ray.tint = ray.tint / hit.opacity;
    if (vista_.world->absorbing)
      ray.tint = ray.tint * Vec3d(transmittance(ray.from, here, ray.w, hit.distance));
    const Vec3d normal = normal_towards(here, in.back);
    if (ray.turns == 0) ray.first = normal;
    if (here.connectible || here.source) {
      seen_.albedo += ray.tint * rgb_albedo(here, in) * ray.share;
      seen_.normal += normal * ray.share;
    } else if (++ray.turns == kMostSurfaces) {
      seen_.normal += ray.first * ray.share;
    } else {
      ray.from = here;
      turn_at(ray, in);
    }
  }

  // There are one or two Dirac lobes, reflection first.
  void turn_at(const Ray& ray, const Incidence& in) {
    constexpr double kLast = 1 - 0x1p-24;
    Turn first, last;
    const bool reflects = turn(ray.from, From::camera, in, {0, 0, 0}, first);
    const bool passes = turn(ray.from, From::camera, in, {0, 0, kLast}, last) &&
                        !(reflects && dot(first.w, last.w) > 1 - 1e-9);
    const double chance = !passes    ? 1
                          : reflects ? chance_of(ray.from, in, first.w)
                                     : 1 - chance_of(ray.from, in, last.w);
    const double part = first_share(ray.share, chance);
    if (part > 0) go_on(ray, in, reflects, first, part);
    if (part < 1) go_on(ray, in, passes, last, 1 - part);
  }

  void go_on(Ray ray, const Incidence& in, bool turns, const Turn& t, double part) {
    ray.share *= part;
    if (!turns) {
      seen_.normal += ray.first * ray.share;
      return;
    }
    // Without the n^2 that radiance gains in a solid.
    const double n = index_at(ray.from, t.w) / index_at(ray.from, in.back);
    ray.tint = ray.tint * t.weight * (n * n);
    ray.w = t.w;
    follow(ray);
  }

  const Vista& vista_;
  const FilmPlane& film_;
  const bool on_;  // beyond the first surface
  Sequence& numbers_;
  Seen& seen_;
};

Seen sums_of_pixel(const Vista& vista, size_t x, size_t y, bool on, uint64_t seed) {
  Seen seen;
  const uint64_t pixel = y << 32 | x;
  Ray ray;
  for (uint64_t i = 0; i < kRays; ++i) {
    Sequence numbers(seed, kFeaturePlaces.first, pixel, i);
    const double u = numbers.uniform(), v = numbers.uniform();
    const FilmPlane film = vista.view.of_sample(numbers);
    ray.from.position = film.position();
    ray.w = film.direction(static_cast<double>(x) + u, static_cast<double>(y) + v);
    Sight(vista, film, on, numbers, seen).follow(ray);
  }
  const double met = seen.met > 0 ? seen.met : 1;
  const Frame& frame = vista.world->scene.frame;
  seen.albedo = min(seen.albedo / static_cast<double>(kRays), Vec3d(1));
  seen.normal = seen.normal / met;
  seen.position = seen.met > 0 ? frame.to_metres(seen.position / met) : Vec3d();
  seen.depth = seen.met > 0 ? seen.depth / met / frame.scale : 1e10;
  return seen;
}

}  // namespace

Channels features(const Vista& vista, const std::vector<std::string>& names, uint64_t seed) {
  const auto width = static_cast<size_t>(vista.view.film.width());
  const auto height = static_cast<size_t>(vista.view.film.height());
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
      const Seen seen = sums_of_pixel(vista, x, y, on, seed);
      for (const Target& target : targets)
        if (target.to) target.to[y * width + x] = static_cast<float>(target.of(seen));
    }
  });
  return channels;
}

}  // namespace tdpt
