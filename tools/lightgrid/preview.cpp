#include "tools/lightgrid/preview.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "libcommon/draw/sheet.h"
#include "libcommon/formats/debug_glb.h"
#include "libcommon/math/reach.h"

namespace tdpt {
namespace {

using namespace draw;

constexpr double kTallest = 1060, kLegendWidth = 330, kGap = 56;
constexpr size_t kMostCubes = 4000, kMostPoints = 60000, kMostLines = 400;
constexpr double kCubesFrom = 0.25, kPointsFrom = 0.02;  // of the largest count

double shade_of(float count, float most) {
  return most > 0 ? std::log1p(static_cast<double>(count)) / std::log1p(static_cast<double>(most))
                  : 0;
}

// One view: `right` and `down` say which axes of the grid run that way, and whether backwards.
struct Axis {
  int axis;
  bool backwards;
};
struct View {
  Box panel;
  Axis right, down;
  std::string words;
};

int voxel_at(const LightGrid& grid, const Axis& a, double share) {
  const int n = grid.dim[static_cast<size_t>(a.axis)];
  const int i = std::clamp(static_cast<int>(share * n), 0, n - 1);
  return a.backwards ? n - 1 - i : i;
}

void draw_counts(Canvas& canvas, const LightGrid& grid, const View& view, float most) {
  const int along = 3 - view.right.axis - view.down.axis;
  const FlatGrid flat = flattened(grid, along);
  const bool right_is_u = view.right.axis == (along + 1) % 3;
  Raster counts(static_cast<int>(view.panel.width), static_cast<int>(view.panel.height));
  for (int y = 0; y < counts.height(); ++y)
    for (int x = 0; x < counts.width(); ++x) {
      const int r = voxel_at(grid, view.right, (x + 0.5) / view.panel.width),
                d = voxel_at(grid, view.down, (y + 0.5) / view.panel.height);
      const int u = right_is_u ? r : d, v = right_is_u ? d : r;
      const auto at = static_cast<size_t>(u + flat.width * v);
      const double shade = shade_of(flat.most[at], most);
      // Floors and ceilings fill two voxels of each row; only what stands upright is to show.
      const double solid = std::pow(static_cast<double>(flat.solid[at]), 1.5);
      Ink c = mix(ink(0xffffff), ink(0x8a8f98), solid);
      c = mix(c, heat(shade), std::pow(shade, 0.7));
      counts.at(x, y) = c * static_cast<float>(1 - 0.25 * solid);
    }
  canvas.raster({view.panel.x, view.panel.y}, 1, counts);
}

Point pixel_of(const LightGrid& grid, const View& view, const Vec3d& metres) {
  const auto share = [&](const Axis& a) {
    const double s = (metres[a.axis] - grid.origin[a.axis]) /
                     (grid.voxel * grid.dim[static_cast<size_t>(a.axis)]);
    return a.backwards ? 1 - s : s;
  };
  return {view.panel.x + share(view.right) * view.panel.width,
          view.panel.y + share(view.down) * view.panel.height};
}

// Two arrows from the view's lower left corner, outside of it.
void draw_axes(Canvas& canvas, const View& view) {
  static constexpr const char* kNames[] = {"x", "y", "z"};
  const Box& p = view.panel;
  const double length = 34;
  const auto arrow = [&](Point from, double dx, double dy) {
    const Point to{from.x + dx * length, from.y + dy * length};
    canvas.line(from, to, 1.6, kInk);
    canvas.polygon({{to.x + dx * 5, to.y + dy * 5},
                    {to.x - dx * 4 + dy * 3.5, to.y - dy * 4 + dx * 3.5},
                    {to.x - dx * 4 - dy * 3.5, to.y - dy * 4 - dx * 3.5}},
                   kInk);
    return to;
  };
  const Point across = view.right.backwards ? arrow({p.right(), p.bottom() + 14}, -1, 0)
                                            : arrow({p.x, p.bottom() + 14}, 1, 0);
  canvas.text({across.x + (view.right.backwards ? -16 : 11), across.y + 4}, kNames[view.right.axis],
              {kTextSize, kInk});
  const Point upright =
      view.down.backwards ? arrow({p.x - 14, p.bottom()}, 0, -1) : arrow({p.x - 14, p.y}, 0, 1);
  canvas.text({upright.x, upright.y + (view.down.backwards ? -12 : 20)}, kNames[view.down.axis],
              {kTextSize, kInk, Align::middle});
  canvas.text({view.right.backwards ? p.x : p.x + 72, p.bottom() + 18}, view.words,
              {kTextSize, kMuted});
}

size_t fullest(const LightGrid& grid) {
  return static_cast<size_t>(std::max_element(grid.count.begin(), grid.count.end()) -
                             grid.count.begin());
}

// Where the three views stand, and the legend to the right of the one from above.
struct Layout {
  double scale;         // pixels of a voxel
  double height, side;  // of the sheet; of the legend's left border
  std::array<View, 3> views;
};

Layout layout_of(const LightGrid& grid) {
  // In plan x runs to the right and z down, as in every stage's.
  const double nx = grid.dim[0], ny = grid.dim[1], nz = grid.dim[2];
  // The legend stands beside the view from above and may need more room than the side view.
  const double room = kSheetWidth - 2 * kMargin - 20 - kGap;
  const double scale =
      std::min({room / (nx + nz), (room - kLegendWidth) / nx, (kTallest - kGap) / (nz + ny)});
  const double w = std::round(nx * scale), h = std::round(ny * scale), d = std::round(nz * scale);
  const double left = kMargin + 20, lower = kHeading + d + kGap;
  const Box above{left, kHeading, w, d}, front{left, lower, w, h},
      right{left + w + kGap, lower, d, h};
  return {scale,
          lower + h + kGap,
          left + w + kGap,
          {{{above, {0, false}, {2, false}, "from above"},
            {front, {0, false}, {1, true}, "from the front"},
            {right, {2, true}, {1, true}, "from the right"}}}};
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

Canvas grid_preview(const LightGrid& grid, const std::string& name) {
  if (grid.count.empty()) {
    Canvas canvas(kSheetWidth, static_cast<int>(kHeading), kPaper);
    heading(canvas, "lightgrid   " + base_name(name), "no light grid: " + grid.reason);
    return canvas;
  }
  const auto [scale, height, side, views] = layout_of(grid);
  const float most = grid.count[fullest(grid)];
  Canvas canvas(kSheetWidth, static_cast<int>(height), kPaper);
  heading(canvas, "lightgrid   " + base_name(name),
          grid.bottleneck
              ? fmt::format("{} x {} x {} voxels of {} m; each pixel shows the fullest voxel "
                            "behind it; geometry grey",
                            grid.dim[0], grid.dim[1], grid.dim[2], number_words(grid.voxel))
              : "no light grid: " + grid.reason);
  for (const View& view : views) {
    draw_counts(canvas, grid, view, most);
    canvas.frame(view.panel, 1, kFaint);
    draw_axes(canvas, view);
    if (most > 0) {
      const Point at = pixel_of(grid, view, centre_of(grid, fullest(grid)));
      canvas.ring(at, 8.7, 1.3, kInk);
      canvas.ring(at, 8, 1.3, ink(0xffffff));
    }
  }
  if (most > 0) {
    const Vec3d place = centre_of(grid, fullest(grid));
    heat_bar(canvas, {side, kHeading + 28, kLegendWidth - 60, 16},
             "segments through a voxel (log scale)", "0", number(static_cast<double>(most)));
    canvas.text({side, kHeading + 96},
                fmt::format("Ring: the fullest, {} segments", number(static_cast<double>(most))),
                {kTextSize, kInk});
    canvas.text({side, kHeading + 118},
                fmt::format("at ({}, {}, {}) m", number_words(place.x), number_words(place.y),
                            number_words(place.z)),
                {kTextSize, kInk});
    canvas.text(
        {side, kHeading + 140},
        fmt::format("{} lines of light kept", number(static_cast<double>(grid.lines.size()))),
        {kTextSize, kMuted});
  }
  scale_bar(canvas, {side + 162, kHeading + 186}, scale / grid.voxel);
  return canvas;
}

std::string grid_debug_glb(const LightGrid& grid, DebugLines as) {
  std::vector<size_t> order;
  const float most = grid.count.empty() ? 0 : grid.count[fullest(grid)];
  for (size_t i = 0; i < grid.count.size(); ++i)
    if (grid.count[i] > 0 && grid.count[i] >= kPointsFrom * most) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return grid.count[a] != grid.count[b] ? grid.count[a] > grid.count[b] : a < b;
  });
  order.resize(std::min(order.size(), kMostCubes + kMostPoints));
  DebugMesh cubes{.name = "fullest voxels"},
      points{.name = "voxels", .kind = DebugMesh::Kind::points},
      lines{.name = "lines of light", .kind = DebugMesh::Kind::lines};
  for (size_t k = 0; k < order.size(); ++k) {
    const size_t i = order[k];
    const auto colour = bytes_of(heat(shade_of(grid.count[i], most)));
    if (k < kMostCubes && grid.count[i] >= kCubesFrom * most)
      cubes.cube(centre_of(grid, i), 0.8 * grid.voxel, colour);
    else
      points.point(centre_of(grid, i), colour);
  }
  for (const LightLine& l : thinned(grid.lines, kMostLines))
    lines.line(l.light, l.camera, bytes_of(kLight), bytes_of(kCamera));
  return debug_glb_bytes({cubes, points, lines}, grid.provenance, as);
}

}  // namespace tdpt
