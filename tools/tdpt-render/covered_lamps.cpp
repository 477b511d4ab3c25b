#include "tools/tdpt-render/covered_lamps.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"

namespace tdpt {
namespace {

// Canonical. Twice the step off a surface [tracer.cpp]: rays to the one stop before the other.
constexpr double kHair = 1e-6;
// Of three lamps in one place two are moved, and then one of those.
constexpr int kRounds = 4;

bool emits(const Scene& scene, uint32_t triangle) {
  return max_component(scene.material_of(triangle).emission) > 0;
}

/// Whether the place, which lies in its plane, lies within the triangle.
bool holds(const TriangleShape& s, const Vec3d& place) {
  const Vec3d at = place - s.p0;
  const double twice = 2 * s.area;
  const double b1 = dot(cross(at, s.e2), s.normal) / twice;
  const double b2 = dot(cross(s.e1, at), s.normal) / twice;
  return b1 > 0 && b2 > 0 && b1 + b2 < 1;
}

/// What a ray from before the triangle, somewhere between it and what it shines on, to a place
/// within it finds there; the triangle where that is nothing else. Near and far it may be another
/// one, as roundings differ.
uint32_t found_at(const Tracer& tracer, uint32_t triangle, Rng& rng) {
  const double u = rng.uniform(), v = rng.uniform();
  const double a = rng.uniform(), b = rng.uniform();
  const double way = rng.uniform();
  double b1, b2;
  uniform_triangle(u, v, b1, b2);
  constexpr double rim = 0.05;  // where neighbours may be met
  b1 = rim + (1 - 3 * rim) * b1, b2 = rim + (1 - 3 * rim) * b2;
  const TriangleShape& s = tracer.shape(triangle);
  const Vec3d place = s.p0 + s.e1 * b1 + s.e2 * b2;
  const Vec3d w = normalize(Onb<double>(s.normal).to_world(cosine_hemisphere(a, b)));
  Hit hit;
  const double free = tracer.closest({place, s.normal}, w, hit) ? hit.distance : 2;
  const bool there = tracer.closest({place + w * (free * way), {}}, -w, hit) &&
                     std::abs(dot(hit.normal, s.normal)) > 0.999 &&
                     std::abs(dot(hit.position - place, s.normal)) < 0.5 * kHair &&
                     holds(tracer.shape(hit.triangle), place);
  return there ? hit.triangle : triangle;
}

void move(Scene& scene, uint32_t triangle) {
  const Vec3d by = shape_of(scene, triangle).normal * kHair;
  const auto again = [](auto& list, uint32_t vertex) {
    if (!list.empty()) list.push_back(list[vertex]);
  };
  for (uint32_t& vertex : scene.triangles[triangle].vertex) {
    const auto moved = static_cast<uint32_t>(scene.positions.size());
    scene.positions.push_back(Vec3f(Vec3d(scene.positions[vertex]) + by));
    again(scene.normals, vertex);
    again(scene.tangents, vertex);
    for (auto& uv : scene.uv) again(uv, vertex);
    again(scene.colours, vertex);
    vertex = moved;
  }
}

}  // namespace

std::vector<uint32_t> covered_lamps(const Scene& scene, const Tracer& tracer) {
  std::vector<uint32_t> lamps;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t)
    if (emits(scene, t)) lamps.push_back(t);
  if (lamps.empty()) return {};
  const size_t rays = std::clamp<size_t>((size_t{1} << 16) / lamps.size(), 1, 256);
  std::set<uint32_t> covered;
  for (const uint32_t lamp : lamps)
    for (uint64_t i = 0; i < rays; ++i) {
      Rng rng(1, lamp, i);
      const uint32_t found = found_at(tracer, lamp, rng);
      if (found != lamp) covered.insert(emits(scene, found) ? std::max(found, lamp) : lamp);
    }
  return {covered.begin(), covered.end()};
}

OpenWorld open_world(Scene& scene, const Camera& camera, int width, int height,
                     const std::vector<Portal>& portals) {
  std::set<uint32_t> moved;
  const auto make = [&] { return std::make_unique<World>(scene, camera, width, height, portals); };
  std::unique_ptr<World> world = make();
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<uint32_t> covered = covered_lamps(scene, world->tracer);
    if (covered.empty()) break;
    for (const uint32_t triangle : covered) move(scene, triangle);
    moved.insert(covered.begin(), covered.end());
    world = make();
  }
  return {std::move(world), moved.size()};
}

std::string uncovered_sentence(size_t triangles, const Frame& frame) {
  return fmt::format("{} of lamps {} in another surface: moved {:.1g} m before it",
                     triangles == 1 ? "1 triangle" : fmt::format("{} triangles", triangles),
                     triangles == 1 ? "lies" : "lie", kHair / frame.scale);
}

}  // namespace tdpt
