#include "libcommon/draw/storeys.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "libcommon/math/reach.h"

namespace tdpt::draw {
namespace {

// Metres.
constexpr double kLowestCeiling = 1.9, kHighestCeiling = 12;  // head room above a floor
constexpr double kEye = 1.5, kEyeOfRoom = 0.75;  // of the cut above the floor; of low head room
constexpr double kOneFloor = 0.05;               // floors that differ less are one
constexpr double kApart = 1.8;                   // storeys are further apart
constexpr double kSlab = 0.05;                   // of a storey's top, below the next floor
constexpr double kSteps = 1.0;                   // what is lower or higher still belongs to it
constexpr double kLeastFloor = 2;                // [m2]
constexpr double kLeastShare = 0.08;             // of the largest storey's floor
constexpr double kWalls = 0.5;                   // room for the walls beside the floors
constexpr double kPlane = 0.97,
                 kCeiling = 0.3;    // least |n.y| of floors, and of what hangs over them
constexpr double kPerSample = 0.1;  // [m2]
constexpr int kMostSamples = 400;   // of a triangle
constexpr double kStray = 0.003;    // share of the floor that may lie beyond the extent
constexpr size_t kMostAir = 500, kMostDrawn = 4;
constexpr double kTouched = 0.04;  // least share of the places on a storey that is drawn

// A place on a floor under a ceiling, metres.
struct FloorSample {
  Vec3d place;
  double head, area;
  bool from_front;  // not from within a body, as the bottom of the ground
};

// Seeks floors below everything that may be a ceiling: the ceilings of a building are no larger
// than it, the ground may be.
std::vector<FloorSample> floor_samples(const Scene& scene, const Tracer& tracer) {
  const auto end = std::min<size_t>(scene.triangles.size(), scene.dome);
  std::vector<std::vector<FloorSample>> found(end);
  const double scale = scene.frame.scale;
  tbb::parallel_for(size_t{0}, end, [&](size_t t) {
    const TriangleShape& shape = tracer.shape(static_cast<uint32_t>(t));
    const double level = std::abs(shape.normal.y);
    if (!(level >= kCeiling)) return;
    const double area = shape.area * level / (scale * scale);
    const int samples =
        static_cast<int>(std::clamp(std::ceil(area / kPerSample), 1.0, kMostSamples + 0.0));
    for (int k = 0; k < samples; ++k) {
      // Evenly spread over the triangle: the R2 sequence, folded.
      double u = std::fmod(0.5 + 0.7548776662466927 * (k + 1), 1.0),
             v = std::fmod(0.5 + 0.5698402909980532 * (k + 1), 1.0);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vec3d below = shape.normal * (shape.normal.y < 0 ? 1.0 : -1.0);
      Hit hit;
      if (!tracer.closest({shape.p0 + shape.e1 * u + shape.e2 * v, below}, {0, -1, 0}, hit) ||
          hit.triangle >= scene.dome)
        continue;
      const double head = hit.distance / scale;
      if (head >= kLowestCeiling && head <= kHighestCeiling && std::abs(hit.normal.y) >= kPlane)
        found[t].push_back(
            {scene.frame.to_metres(hit.position), head, area / samples, hit.normal.y > 0});
    }
  });
  std::vector<FloorSample> all;
  for (const auto& of : found) all.insert(all.end(), of.begin(), of.end());
  // Where no floor has its front upwards, normals say nothing.
  if (std::any_of(all.begin(), all.end(), [](const FloorSample& s) { return s.from_front; }))
    std::erase_if(all, [](const FloorSample& s) { return !s.from_front; });
  std::stable_sort(all.begin(), all.end(), [](const FloorSample& a, const FloorSample& b) {
    return a.place.y < b.place.y;
  });
  return all;
}

double area_of(const std::vector<FloorSample>& samples) {
  double sum = 0;
  for (const FloorSample& s : samples) sum += s.area;
  return sum;
}

// The value below which that share of the area lies.
template <class Value>
double quantile(const std::vector<FloorSample>& samples, double share, Value&& value) {
  std::vector<std::pair<double, double>> sorted;
  for (const FloorSample& s : samples) sorted.emplace_back(value(s), s.area);
  std::sort(sorted.begin(), sorted.end());
  double rest = share * area_of(samples);
  for (const auto& [v, area] : sorted)
    if ((rest -= area) < 0) return v;
  return sorted.back().first;
}

// The largest floor at one height.
std::vector<FloorSample> largest_level(const std::vector<FloorSample>& sorted) {
  size_t first = 0, best_first = 0, best_end = 0;
  double area = 0, most = 0;
  for (size_t end = 1; end <= sorted.size(); ++end) {
    area += sorted[end - 1].area;
    while (sorted[end - 1].place.y - sorted[first].place.y > 2 * kOneFloor)
      area -= sorted[first++].area;
    if (area > most) most = area, best_first = first, best_end = end;
  }
  return {sorted.begin() + static_cast<std::ptrdiff_t>(best_first),
          sorted.begin() + static_cast<std::ptrdiff_t>(best_end)};
}

// Whether a level ray from a place meets the back of a surface, as it does within a body.
bool sees_back(const Scene& scene, const Tracer& tracer, const Vec3d& place) {
  for (const Vec3d& way : {Vec3d{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}}) {
    Hit hit;
    if (tracer.closest({scene.frame.to_canonical(place)}, way, hit) && dot(hit.normal, way) > 0)
      return true;
  }
  return false;
}

Storey storey_of(const Scene& scene, const Tracer& tracer, const std::vector<FloorSample>& level,
                 const std::vector<FloorSample>& all) {
  Storey storey;
  storey.floor = quantile(level, 0.5, [](const FloorSample& s) { return s.place.y; });
  const double head = quantile(level, 0.5, [](const FloorSample& s) { return s.head; });
  storey.cut = *storey.floor + std::min(kEye, kEyeOfRoom * head);
  std::vector<FloorSample> near;
  for (const FloorSample& s : all)
    if (s.place.y > *storey.floor - kSteps && s.place.y < *storey.floor + kSteps) near.push_back(s);
  const auto x = [](const FloorSample& s) { return s.place.x; };
  const auto z = [](const FloorSample& s) { return s.place.z; };
  storey.low = Vec3d{quantile(near, kStray, x), 0, quantile(near, kStray, z)} - Vec3d(kWalls);
  storey.high =
      Vec3d{quantile(near, 1 - kStray, x), 0, quantile(near, 1 - kStray, z)} + Vec3d(kWalls);
  for (size_t k = 0; k < level.size(); k += level.size() / kMostAir + 1)
    if (level[k].head > storey.cut - *storey.floor)
      storey.air.push_back({level[k].place.x, storey.cut, level[k].place.z});
  // Floors and ceilings go on within walls. Where all places see backs, normals say nothing.
  const auto in_bodies =
      std::stable_partition(storey.air.begin(), storey.air.end(),
                            [&](const Vec3d& place) { return !sees_back(scene, tracer, place); });
  if (in_bodies != storey.air.begin()) storey.air.erase(in_bodies, storey.air.end());
  return storey;
}

}  // namespace

std::vector<Storey> storeys_of(const Scene& scene, const Tracer& tracer) {
  const std::vector<FloorSample> all = floor_samples(scene, tracer);
  std::vector<FloorSample> left = all;
  std::vector<Storey> storeys;
  double largest = 0;
  while (!left.empty()) {
    const std::vector<FloorSample> level = largest_level(left);
    const double area = area_of(level);
    largest = std::max(largest, area);
    if (area < std::max(kLeastFloor, kLeastShare * largest)) break;
    storeys.push_back(storey_of(scene, tracer, level, all));
    const double floor = *storeys.back().floor;
    std::erase_if(left, [&](const FloorSample& s) { return std::abs(s.place.y - floor) < kApart; });
  }
  std::sort(storeys.begin(), storeys.end(),
            [](const Storey& a, const Storey& b) { return *a.floor < *b.floor; });
  for (size_t k = 0; k < storeys.size(); ++k) {
    storeys[k].bottom = k > 0 ? *storeys[k].floor - 0.5 : -INFINITY;
    storeys[k].top = k + 1 < storeys.size() ? *storeys[k + 1].floor - kSlab : INFINITY;
  }
  return storeys;
}

namespace {

// The whole scene as one, cut at `height`, at its middle if that is not within it.
Storey whole_scene(const Scene& scene, double height) {
  Extent extent;
  const auto end = std::min<size_t>(scene.triangles.size(), scene.dome);
  for (uint32_t t = 0; t < end; ++t)
    for (int k = 0; k < 3; ++k) extent.add(scene.frame.to_metres(Vec3d(scene.vertex(t, k))));
  Storey all;
  all.cut = height > extent.low.y && height < extent.high.y ? height
                                                            : 0.5 * (extent.low.y + extent.high.y);
  all.low = extent.low - extent.size() * 0.03;
  all.high = extent.high + extent.size() * 0.03;
  all.bottom = -INFINITY;
  all.top = INFINITY;
  return all;
}

// Index of the storey whose floor is the next below a place [metres]; of the lowest if none is.
size_t storey_at(const std::vector<Storey>& storeys, const Vec3d& place) {
  constexpr double kBelow = 0.3;  // how far below its floor something still belongs to it
  size_t at = 0;
  for (size_t k = 0; k < storeys.size(); ++k)
    if (place.y >= *storeys[k].floor - kBelow) at = k;
  return at;
}

}  // namespace

std::vector<Storey> storeys_to_draw(const Scene& scene, const Tracer& tracer, const Vec3d& camera,
                                    const std::vector<Vec3d>& places) {
  const std::vector<Storey> all = storeys_of(scene, tracer);
  if (all.empty()) {
    double height = 0;
    for (const Vec3d& p : places) height += p.y / static_cast<double>(places.size());
    return {whole_scene(scene, places.empty() ? camera.y : height)};
  }
  std::vector<size_t> times(all.size());
  for (const Vec3d& p : places) ++times[storey_at(all, p)];
  const size_t here = storey_at(all, camera);
  // Those between as well, but no more than are legible.
  size_t first = here, last = here;
  for (size_t k = 0; k < all.size(); ++k)
    if (static_cast<double>(times[k]) > kTouched * static_cast<double>(places.size()))
      first = std::min(first, k), last = std::max(last, k);
  while (last - first >= kMostDrawn) last - here > here - first ? --last : ++first;
  return {all.begin() + static_cast<std::ptrdiff_t>(first),
          all.begin() + static_cast<std::ptrdiff_t>(last) + 1};
}

}  // namespace tdpt::draw
