#include "tools/lightgrid/preview.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "libcommon/math/reach.h"

namespace tdpt {
namespace {

using namespace draw;

constexpr double kTallest = 1000, kGap = 56;  // of all views; between them [pixels]
constexpr double kNarrowestPanel = 260;       // of a panel, for its caption
constexpr size_t kMostCubes = 4000, kMostPoints = 60000, kMostLines = 400;
constexpr double kCubesFrom = 0.25, kPointsFrom = 0.02;  // of the largest count

double shade_of(float count, float most) {
  return most > 0 ? std::log1p(static_cast<double>(count)) / std::log1p(static_cast<double>(most))
                  : 0;
}

size_t fullest(const LightGrid& grid) {
  return static_cast<size_t>(std::max_element(grid.count.begin(), grid.count.end()) -
                             grid.count.begin());
}

// Each pixel shows the fullest voxel in its row, and how much of the row is geometry.
void draw_counts(Panel& panel, const LightGrid& grid, float most) {
  int along = 0;
  while (!(std::abs(panel.view.forward[along]) > 0.5)) ++along;
  const FlatGrid flat = flattened(grid, along);
  fill_backdrop(panel, 1, [&](const Vec3d& place) {
    const Vec3d q = (place - grid.origin) / grid.voxel;
    const int u = std::clamp(static_cast<int>(q[(along + 1) % 3]), 0, flat.width - 1),
              v = std::clamp(static_cast<int>(q[(along + 2) % 3]), 0, flat.height - 1);
    const auto at = static_cast<size_t>(u + flat.width * v);
    const double shade = shade_of(flat.most[at], most);
    // Floors and ceilings fill two voxels of each row; only what stands upright is to show.
    const double solid = std::pow(static_cast<double>(flat.solid[at]), 1.5);
    Ink c = mix(ink(0xffffff), ink(0x8a8f98), solid);
    c = mix(c, heat(shade), std::pow(shade, 0.7));
    return c * static_cast<float>(1 - 0.25 * solid);
  });
}

// As the views of a technical drawing: in plan x runs to the right and z down, as in every stage's.
std::vector<Panel> views_of(const LightGrid& grid) {
  const double nx = grid.dim[0], ny = grid.dim[1], nz = grid.dim[2];
  const double scale = std::min((kSheetWidth - 2 * kMargin - kGap) / (nx + nz),
                                (kTallest - kCaptionRoom) / (nz + ny));
  const double w = std::max(std::round(nx * scale), kNarrowestPanel), h = std::round(ny * scale),
               d = std::round(nz * scale), e = std::max(d, kNarrowestPanel);
  const double lower = kHeading + d + kCaptionRoom;
  const Vec3d size = Vec3d(nx, ny, nz) * grid.voxel, middle = grid.origin + size * 0.5;
  const auto view = [&](const Rectangle& r, const Vec3d& right, const Vec3d& up) {
    Projection p = Projection::flat(middle, right, up, 0, 0, r);
    p.half_width = 0.5 * r.width * grid.voxel / scale;
    return p;
  };
  return {{.view = view({kMargin, kHeading, w, d}, {1, 0, 0}, {0, 0, -1}), .caption = "from above"},
          {.view = view({kMargin, lower, w, h}, {1, 0, 0}, {0, 1, 0}), .caption = "from the front"},
          {.view = view({kMargin + w + kGap, lower, e, h}, {0, 0, -1}, {0, 1, 0}),
           .caption = "from the right"}};
}

}  // namespace

FlatGrid flattened(const LightGrid& grid, int axis) {
  const int u_axis = (axis + 1) % 3, v_axis = (axis + 2) % 3;
  FlatGrid flat;
  flat.width = grid.dim[static_cast<size_t>(u_axis)];
  flat.height = grid.dim[static_cast<size_t>(v_axis)];
  const auto size = static_cast<size_t>(flat.width) * static_cast<size_t>(flat.height);
  flat.most.assign(size, 0);
  flat.solid.assign(size, 0);
  const float one = 1 / static_cast<float>(grid.dim[static_cast<size_t>(axis)]);
  std::array<int, 3> at{};
  size_t voxel = 0;
  for (at[2] = 0; at[2] < grid.dim[2]; ++at[2])
    for (at[1] = 0; at[1] < grid.dim[1]; ++at[1])
      for (at[0] = 0; at[0] < grid.dim[0]; ++at[0], ++voxel) {
        const auto pixel = static_cast<size_t>(at[static_cast<size_t>(u_axis)] +
                                               flat.width * at[static_cast<size_t>(v_axis)]);
        flat.most[pixel] = std::max(flat.most[pixel], grid.count[voxel]);
        if (!grid.air.empty() && !grid.air[voxel]) flat.solid[pixel] += one;
      }
  return flat;
}

draw::Drawing grid_preview(const LightGrid& grid, const std::string& name) {
  Drawing drawing{
      .title = "lightgrid   " + base_name(name),
      .sentence = grid.bottleneck
                      ? fmt::format("{} x {} x {} voxels of {} m; each pixel shows the fullest "
                                    "voxel behind it; geometry grey",
                                    grid.dim[0], grid.dim[1], grid.dim[2], number_words(grid.voxel))
                      : "no light grid: " + grid.reason};
  if (grid.count.empty()) return drawing;
  const float most = grid.count[fullest(grid)];
  drawing.panels = views_of(grid);
  for (Panel& panel : drawing.panels) draw_counts(panel, grid, most);
  if (most > 0) {
    const Vec3d place = centre_of(grid, fullest(grid));
    const std::string segments = number(static_cast<double>(most));
    drawing.labels = {{place, segments + " segments"}};
    std::vector<Ink> inks;
    for (int k = 0; k <= 30; ++k) inks.push_back(heat(k / 30.0));
    drawing.key = {{inks, fmt::format("0 to {} segments through a voxel (log scale)", segments)}};
    drawing.notes = {fmt::format("The fullest voxel is at ({}, {}, {}) m; {} lines of light kept",
                                 number_words(place.x), number_words(place.y),
                                 number_words(place.z),
                                 number(static_cast<double>(grid.lines.size())))};
  }
  return drawing;
}

std::string grid_debug_glb(const LightGrid& grid) {
  std::vector<size_t> order;
  const float most = grid.count.empty() ? 0 : grid.count[fullest(grid)];
  for (size_t i = 0; i < grid.count.size(); ++i)
    if (grid.count[i] > 0 && grid.count[i] >= kPointsFrom * most) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return grid.count[a] != grid.count[b] ? grid.count[a] > grid.count[b] : a < b;
  });
  order.resize(std::min(order.size(), kMostCubes + kMostPoints));
  Shape cubes{.name = "fullest voxels"}, points{.name = "voxels", .kind = Shape::Kind::points},
      lines{.name = "lines of light", .kind = Shape::Kind::lines};
  for (size_t k = 0; k < order.size(); ++k) {
    const size_t i = order[k];
    const Ink c = heat(shade_of(grid.count[i], most));
    if (k < kMostCubes && grid.count[i] >= kCubesFrom * most)
      cubes.cube(centre_of(grid, i), 0.8 * grid.voxel, c);
    else
      points.point(centre_of(grid, i), c);
  }
  for (const LightLine& l : thinned(grid.lines, kMostLines))
    lines.line(l.light, l.camera, kLight, kCamera);
  return debug_glb_bytes({cubes, points, lines}, grid.provenance);
}

}  // namespace tdpt
