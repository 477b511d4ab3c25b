#include "tools/ffgraph/patch_grid.h"

#include <algorithm>

#include "libcommon/math/reach.h"

namespace tdpt {
namespace {

constexpr double kAround = 0.5;  // of the diagonal: fine cells extend this far around the region
// Of the diagonal of all regions: a camera in a closet does not make the whole house fine.
constexpr double kSmallest = 0.5;
constexpr int kMostLevels = 6;         // of cells between the region and the whole scene
constexpr size_t kMostPlaces = 40000;  // per set of walks, used to find the region

// Metres.
Extent reach_of_walks(const Scene& scene, const Walks& walks) {
  std::vector<WeightedPlace> places;
  const size_t step = walks.size() / kMostPlaces + 1;
  for (size_t k = 0; k < walks.size(); k += step)
    if (is_hit(walks[k])) places.push_back({scene.frame.to_metres(Vec3d(walks[k].position)), 1});
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
  const Extent around = region.widened(Vec3d(kAround * diagonal));
  g.fine.low = around.low;
  g.fine.high = around.high;
  // Walls often coincide with the bounding box: keep them off the cell faces.
  const double cell = diagonal / cells;
  g.grid.origin = region.low - Vec3d(0.3819, 0.3453, 0.4142) * cell;
  return g;
}

}  // namespace tdpt
