#include "tools/tdpt-render/path/sample/world.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <set>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "libcommon/base/words.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/streams.h"
#include "libcommon/scene/texture.h"

namespace tdpt {
namespace {

void add_lobes(const Scene& scene, const Material& m, const SurfacePlace& place, Point& p) {
  p.simple = false;
  p.shading = shading_normal_at(scene, place, p.normal);
  const shader::Surfaces& text = surfaces();
  if (m.plain) {
    p.bsdf = text.diffuse_bsdf(m.base_color);
    return;
  }
  const bool bent_coat = m.coat > 0 && (m.maps[MAP_NORMAL] || m.maps[MAP_COAT_NORMAL]);
  text.put_material(material_at(scene, place), bent_coat,
                    bent_coat ? coat_normal_at(scene, place, p.normal) : p.normal, p);
}

bool emits(const Material& m) {
  return !(m.emission.x + m.emission.y + m.emission.z <= 0);  // true for NaN, so it is reported
}

// Out of line, so that surfaces that need neither stay fast.
[[gnu::noinline]] void add_emission(const World& world, const Material& m, const Hit& hit,
                                    Point& p) {
  p.emission = m.plain ? m.emission : emission_at(world.scene, {hit.triangle, hit.b1, hit.b2});
  if (p.emission != Rgb{}) p.source = &world.lights.surface(m.double_sided);
}
[[gnu::noinline]] void add_layers(const World& world, const Material& m, const Hit& hit, Point& p) {
  const Scene& scene = world.scene;
  const bool flat = scene.smooth.empty() || !scene.smooth[hit.triangle];
  if (!(m.plain && flat)) add_lobes(scene, m, {hit.triangle, hit.b1, hit.b2}, p);
  if (emits(m)) add_emission(world, m, hit, p);
}

}  // namespace

void place_on_surface(const World& world, const Hit& hit, Point& p) {
  const Material& m = world.scene.material_of(hit.triangle);
  p.position = hit.position;
  p.normal = hit.normal;
  p.triangle = hit.triangle;
  p.material = &m;
  p.simple = true;
  p.connectible = true;
  p.color = m.base_color;
  p.source = nullptr;
  if (world.layered)
    add_layers(world, m, hit, p);
  else if (emits(m))
    add_emission(world, m, hit, p);
}

void place_in_sky(const LightSelection& selection, const Vec3d& w, Point& p) {
  p = {};
  p.position = -w;
  p.source = selection.lights().sky();
  p.in_sky = selection.look(w);
  p.connectible = false;
}

void place_on_light(const World& world, const Lights::Point& light, Point& p) {
  if (light.source->is_surface()) {
    Hit hit;
    hit.triangle = light.triangle;
    hit.b1 = light.b1;
    hit.b2 = light.b2;
    hit.position = light.position;
    hit.normal = world.tracer.shape(light.triangle).normal;
    place_on_surface(world, hit, p);
    if (p.material->alpha_mode != Material::Alpha::opaque)
      p.emission *= coverage_at(world.scene, {light.triangle, light.b1, light.b2});
    p.connectible = true;
  } else {
    p = {};
    p.position = light.position;
    p.in_sky = light.in_sky;
  }
  p.source = light.source;
}

namespace {

// Canonical units. Twice the offset of ray origins [tracer.cpp], so that rays to one surface stop
// in front of the other.
constexpr double kCoverOffset = 1e-6;
// Several rounds: of three coincident lamps two are moved, and then one of those again. A triangle
// missed by the rays of one round may be found in the next.
constexpr uint32_t kRounds = 8;
// A ray misses the cover in a quarter of the triangles that lie wholly in another surface.
constexpr size_t kFewestRays = 8, kMostRays = 256, kAllRays = size_t{1} << 16;

bool emits(const Scene& scene, uint32_t triangle) {
  return max_component(scene.material_of(triangle).emission) > 0;
}

/// Whether the point, which lies in the triangle's plane, lies within it.
bool holds(const TriangleShape& s, const Vec3d& place) {
  const Vec3d at = place - s.p0;
  const double twice = 2 * s.area;
  const double b1 = dot(cross(at, s.e2), s.normal) / twice;
  const double b2 = dot(cross(s.e1, at), s.normal) / twice;
  return b1 > 0 && b2 > 0 && b1 + b2 < 1;
}

/// What a ray hits at a random point of the triangle: another triangle, or `triangle` if there is
/// none. The ray starts in front (or behind) at a random distance, since the rounding, and with it
/// the hit, depends on the distance.
uint32_t found_at(const Tracer& tracer, uint32_t triangle, bool behind, Rng& rng) {
  const double u = rng.uniform(), v = rng.uniform();
  const double a = rng.uniform(), b = rng.uniform();
  const double way = rng.uniform();
  double b1, b2;
  uniform_triangle(u, v, b1, b2);
  constexpr double rim = 0.05;  // keeps off neighbours
  b1 = rim + (1 - 3 * rim) * b1, b2 = rim + (1 - 3 * rim) * b2;
  const TriangleShape& s = tracer.shape(triangle);
  const Vec3d place = s.p0 + s.e1 * b1 + s.e2 * b2;
  const Vec3d up = behind ? -s.normal : s.normal;
  const Vec3d w = normalize(Onb<double>(up).to_world(cosine_hemisphere(a, b)));
  Hit hit;
  const double free = tracer.closest({place, s.normal}, w, hit) ? hit.distance : 2;
  const bool there = tracer.closest({place + w * (free * way), {}}, -w, hit) &&
                     std::abs(dot(hit.normal, s.normal)) > 0.999 &&
                     std::abs(dot(hit.position - place, s.normal)) < 0.5 * kCoverOffset &&
                     holds(tracer.shape(hit.triangle), place);
  return there ? hit.triangle : triangle;
}

/// Gives the triangle vertices of its own, moved by kCoverOffset along its normal.
void move(Scene& scene, uint32_t triangle) {
  const Vec3d by = shape_of(scene, triangle).normal * kCoverOffset;
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

using OneSided = std::map<uint32_t, uint32_t>;

/// The single-sided copy of a material.
uint32_t one_sided(Scene& scene, uint32_t material, OneSided& known) {
  const auto [it, fresh] = known.try_emplace(material, scene.materials.size());
  if (fresh) {
    Material front = scene.materials[material];
    front.double_sided = false;
    scene.materials.push_back(std::move(front));
  }
  return it->second;
}

/// Moves the triangle. A double-sided one becomes two, one moved to each side, since its winding
/// does not say which side faces a room, and both may.
void uncover(Scene& scene, uint32_t triangle, OneSided& known) {
  if (scene.material_of(triangle).double_sided) {
    Triangle back = scene.triangles[triangle];
    back.material = one_sided(scene, back.material, known);
    scene.triangles[triangle].material = back.material;
    std::swap(back.vertex[1], back.vertex[2]);
    scene.triangles.push_back(back);
    if (!scene.smooth.empty()) scene.smooth.push_back(scene.smooth[triangle]);
    move(scene, static_cast<uint32_t>(scene.triangles.size() - 1));
    if (!scene.normals.empty())
      for (const uint32_t vertex : scene.triangles.back().vertex)
        scene.normals[vertex] = -scene.normals[vertex];
  }
  move(scene, triangle);
}

}  // namespace

std::vector<uint32_t> covered_lamps(const Scene& scene, const Tracer& tracer, uint32_t seed) {
  std::vector<uint32_t> lamps, covered;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t)
    if (emits(scene, t)) lamps.push_back(t);
  if (lamps.empty()) return {};
  const size_t rays = std::clamp(kAllRays / lamps.size(), kFewestRays, kMostRays);
  std::vector<uint8_t> is_covered(scene.triangles.size());
  tbb::parallel_for(size_t{0}, lamps.size(), [&](size_t k) {
    const uint32_t lamp = lamps[k];
    const bool both = scene.material_of(lamp).double_sided;
    for (uint64_t i = 0; i < rays; ++i) {
      Rng rng(seed, kCoveredLamps.first + lamp, i);
      const uint32_t found = found_at(tracer, lamp, both && i % 2 == 1, rng);
      if (found == lamp) continue;
      const uint32_t later = emits(scene, found) ? std::max(found, lamp) : lamp;
      std::atomic_ref(is_covered[later]).store(1, std::memory_order_relaxed);
    }
  });
  for (const uint32_t lamp : lamps)
    if (is_covered[lamp]) covered.push_back(lamp);
  return covered;
}

OpenWorld open_world(Scene& scene, bool culls) {
  std::set<uint32_t> moved;
  OneSided known;
  const size_t before = scene.triangles.size();
  std::shared_ptr<const World> world;
  for (uint32_t round = 0;; ++round) {
    world = std::make_shared<World>(scene, culls);
    if (round == kRounds) break;
    const std::vector<uint32_t> covered = covered_lamps(scene, world->tracer, round);
    if (covered.empty()) break;
    world.reset();  // it reads the scene in place
    for (const uint32_t triangle : covered) {
      uncover(scene, triangle, known);
      if (triangle < before) moved.insert(triangle);
    }
  }
  return {std::move(world), moved.size()};
}

std::string uncovered_sentence(size_t triangles, const Frame& frame) {
  return fmt::format("{} of lamps {} in another surface: moved {} m before it",
                     triangles == 1 ? "1 triangle" : fmt::format("{} triangles", triangles),
                     triangles == 1 ? "lies" : "lie", number_words(kCoverOffset / frame.scale, 1));
}

}  // namespace tdpt
