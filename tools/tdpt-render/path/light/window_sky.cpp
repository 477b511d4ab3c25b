#include "tools/tdpt-render/path/light/window_sky.h"

#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/sequence.h"
#include "libcommon/math/streams.h"

namespace tdpt {
namespace {

constexpr size_t kLines = 1 << 16, kFewestLines = 1 << 13;  // in all, and at least per window
constexpr double kAcross = 64;                              // cells along the longest side
constexpr size_t kAround = 2;                               // extra cells on all sides
constexpr double kFar = 8;                                  // beyond the extent of any scene

}  // namespace

// From a point in a window along unit w, `length` long.
struct WindowViews::Line {
  Vec3d from, w;
  double length = 0;
  uint32_t window = 0;
  Vec3d end() const { return from + w * length; }
};

namespace {

using Opening = WindowViews::Opening;

// Distance along a ray at which it leaves by another window than `own`; infinite if it does not.
double way_out(const std::vector<Opening>& openings, size_t own, const Vec3d& from,
               const Vec3d& w) {
  double least = HUGE_VAL;
  for (size_t i = 0; i < openings.size(); ++i) {
    const auto& [corner, across, up, out] = openings[i];
    const double t = dot(out, corner - from) / dot(out, w);
    if (i == own || !(dot(out, w) > 0) || !(t > 0 && t < least)) continue;
    const Vec3d p = from + w * t - corner;
    const double x = dot(p, across), y = dot(p, up);
    if (x >= 0 && x <= dot(across, across) && y >= 0 && y <= dot(up, up)) least = t;
  }
  return least;
}

// Length of a line from opening i along unit w; kFar if it leaves by a hole without a window.
double reach(const Tracer& tracer, const std::vector<Opening>& openings, size_t i,
             const Vec3f& from, const Vec3d& w) {
  Hit hit;
  const double wall = tracer.closest_from(from, w, hit) ? hit.distance : kFar;
  return std::min(wall, way_out(openings, i, Vec3d(from), w));
}

// Uniform over the directions into the house: views at a slant through the window count, too.
Vec3d inwards(const Opening& opening, double u, double v) {
  const double z = 1 - u, r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * std::numbers::pi * v;
  return Onb<double>(-opening.out).to_world({r * std::cos(phi), r * std::sin(phi), z});
}

}  // namespace

WindowViews::WindowViews(const Tracer& tracer, const std::vector<Opening>& openings)
    : openings_(openings) {
  const size_t each = openings.empty() ? 0 : std::max(kFewestLines, kLines / openings.size());
  std::vector<Line> lines(each * openings.size());
  tbb::parallel_for(size_t{0}, lines.size(), [&](size_t k) {
    const size_t i = k / each;
    Sequence numbers(*kWindowViews.seed, kWindowViews.first, i, k % each);
    const auto [x, y, u, v] = numbers.uniforms<4>();
    const Vec3f from(openings[i].corner + openings[i].across * x + openings[i].up * y);
    const Vec3d w = inwards(openings[i], u, v);
    lines[k] = {Vec3d(from), w, reach(tracer, openings, i, from, w), static_cast<uint32_t>(i)};
  });
  std::erase_if(lines, [](const Line& line) { return !(line.length > 0); });
  beyond_ = 0;
  if (lines.empty()) return;
  lay_out(lines);
  mark(lines);
  widen();
}

// Lays a grid around the region where nearly all lines begin and end: the few that leave by holes
// without a portal would make its cells as large as houses.
void WindowViews::lay_out(const std::vector<Line>& lines) {
  constexpr double kLeftOut = 0.002;
  Vec3d high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> places;
    for (const Line& line : lines) {
      places.push_back(line.from[axis]);
      if (line.length < kFar) places.push_back(line.end()[axis]);
    }
    std::sort(places.begin(), places.end());
    const auto skipped = static_cast<size_t>(kLeftOut * static_cast<double>(places.size()));
    low_[axis] = places[skipped];
    high[axis] = places[places.size() - 1 - skipped];
  }
  const Vec3d extent = high - low_;
  const double width = std::max({extent.x, extent.y, extent.z}) / kAcross;
  per_width_ = 1 / width;
  low_ = low_ - Vec3d(1, 1, 1) * (kAround * width);
  for (int axis = 0; axis < 3; ++axis)
    size_[static_cast<size_t>(axis)] =
        static_cast<size_t>(extent[axis] * per_width_) + 1 + 2 * kAround;
}

void WindowViews::mark(const std::vector<Line>& lines) {
  std::vector<std::atomic<uint32_t>> masks(size_[0] * size_[1] * size_[2]);
  tbb::parallel_for(size_t{0}, lines.size(), [&](size_t k) {
    const Line& line = lines[k];
    const double cells = std::min(line.length * per_width_, 4 * kAcross);
    const auto steps = static_cast<int>(cells) + 1;
    for (int s = 0; s <= steps; ++s) {
      const Vec3d p = (line.from + line.w * (line.length * s / steps) - low_) * per_width_;
      std::array<size_t, 3> i;
      bool inside = true;
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<size_t>(axis);
        inside = inside && p[axis] >= 0 && p[axis] < static_cast<double>(size_[a]);
        i[a] = inside ? static_cast<size_t>(p[axis]) : 0;
      }
      if (inside) masks[index(i)].fetch_or(1u << line.window, std::memory_order_relaxed);
    }
  });
  masks_.assign(masks.begin(), masks.end());
}

// Extends masks to the neighbours of each cell, one axis after the other.
void WindowViews::widen() {
  size_t stride = 1;
  for (const size_t n : size_) {
    const std::vector<uint32_t> before = masks_;
    for (size_t i = 0; i < masks_.size(); ++i) {
      const size_t at = i / stride % n;
      if (at > 0) masks_[i] |= before[i - stride];
      if (at + 1 < n) masks_[i] |= before[i + stride];
    }
    stride *= n;
  }
}

namespace {

using std::numbers::pi;

// The map c of the shared code, and its inverse.
double compressed(double t) {
  return t / (1 + std::abs(t));
}
double stretched(double c) {
  return c / (1 - std::abs(c));
}

// Fills cells with luminance x solid angle.
class Cells {
 public:
  Cells(const Sky& sky, const Vec3d& x, const Vec3d& y, const Vec3d& z, int n)
      : sky_(sky), x_(x), y_(y), z_(z), n_(n), cells_(static_cast<size_t>(n * n)) {}

  // Samples the sky at a few points of each cell.
  void gather() {
    constexpr int kPlaces = 2;
    const int n = kPlaces * n_;
    const double step = 2.0 / n;
    std::vector<double> tangents;
    for (int i = 0; i < n; ++i) tangents.push_back(stretched((i + 0.5) * step - 1));
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double s = tangents[static_cast<size_t>(i)], t = tangents[static_cast<size_t>(j)];
        const double scale = 1 / std::sqrt(s * s + t * t + 1);
        const Vec3d towards = (x_ * s + y_ * t + z_) * scale;
        const double light = luminance(
            sky_.radiance(sky_.one_colour() ? Sky::Place{towards} : sky_.rough_place(towards)));
        const double across = (1 + std::abs(s)) * (1 + std::abs(t));
        const double solid_angle = across * across * scale * scale * scale;  // / (da db)
        cells_[static_cast<size_t>(i / kPlaces * n_ + j / kPlaces)] +=
            light * solid_angle * step * step;
      }
  }

  // Adds what those may have missed: texels much brighter than the mean, and suns.
  void add_bright() {
    const Sky::Map& map = sky_.map();
    if (!sky_.one_colour()) {
      double mean = 0;
      for (const Rgb& t : map.texels) mean += luminance(t);
      mean /= static_cast<double>(std::max<size_t>(map.texels.size(), 1));
      for (int row = 0; row < map.height; ++row)
        for (int column = 0; column < map.width; ++column) {
          const double y = luminance(map.texels[static_cast<size_t>(row * map.width + column)]);
          if (y > kBright * mean) add_texel(column, row, y);
        }
    }
    for (const Sky::Sun& sun : sky_.suns()) add_sun(sun);
  }

  const std::vector<double>& cells() const { return cells_; }

 private:
  static constexpr double kBright = 8;  // times the mean
  static constexpr int kLattice = 8;

  void add(const Vec3d& towards, double light) {
    const Vec3d w(dot(x_, towards), dot(y_, towards), dot(z_, towards));
    if (!(w.z > 0)) return;
    const auto cell = [&](double t) {
      return static_cast<size_t>(std::clamp((compressed(t) + 1) * 0.5 * n_, 0.0, n_ - 1.0));
    };
    cells_[cell(w.x / w.z) * static_cast<size_t>(n_) + cell(w.y / w.z)] += light;
  }
  // Over the texel's whole reach, between the centres of its neighbours.
  void add_texel(int column, int row, double y) {
    const Sky::Map& map = sky_.map();
    const double solid_angle =
        2 * pi / map.width *
        (std::cos(pi * row / map.height) - std::cos(pi * (row + 1) / map.height));
    for (int k = 0; k < kLattice * kLattice; ++k) {
      const double c = column + 0.5 + 2 * ((k % kLattice + 0.5) / kLattice - 0.5);
      const double r = row + 0.5 + 2 * ((k / kLattice + 0.5) / kLattice - 0.5);
      add(sky_.towards(c, std::clamp<double>(r, 0, map.height)),
          y * solid_angle / (kLattice * kLattice));
    }
  }
  // The disc, and a little around it.
  void add_sun(const Sky::Sun& sun) {
    const double light = luminance(sun.radiance) * pi * std::pow(std::sin(sun.half_angle), 2);
    const Onb<double> onb(sun.towards);
    constexpr int kPlaces = 32;
    for (int k = 0; k < kPlaces * kPlaces; ++k) {
      const double r = 1.05 * std::tan(sun.half_angle) * std::sqrt((k / kPlaces + 1.0) / kPlaces);
      const double phi = 2 * pi * (k % kPlaces + 0.5) / kPlaces;
      add(normalize(onb.to_world({r * std::cos(phi), r * std::sin(phi), 1})),
          light / (kPlaces * kPlaces));
    }
  }

  const Sky& sky_;
  const Vec3d &x_, &y_, &z_;
  int n_;
  std::vector<double> cells_;
};

}  // namespace

WindowFrame::WindowFrame(const Sky& sky, const Vec3d& x_, const Vec3d& z_, int n)
    : x(x_), y(cross(z_, x_)), z(z_), cells(static_cast<uint32_t>(n)) {
  Cells content(sky, x, y, z, n);
  content.gather();
  content.add_bright();
  double total = 0;
  for (size_t i = 0; i < cells; ++i) {
    double column = 0;
    for (size_t j = 0; j < cells; ++j) column += content.cells()[i * cells + j];
    total += column;
  }
  constexpr double kBlack = 1e-13;  // share of the total below which a cell counts as black
  unit = total / (0x1p32 - 1 - static_cast<double>(cells * cells));
  sums.assign((cells + 1) * (cells + 1), 0);
  for (size_t i = 0; i < cells; ++i) {
    uint32_t column = 0;
    for (size_t j = 0; j < cells; ++j) {
      const double light = content.cells()[i * cells + j];
      if (light > kBlack * total) column += 1 + static_cast<uint32_t>(light / unit);
      sums[(i + 1) * (cells + 1) + j + 1] = sums[i * (cells + 1) + j + 1] + column;
    }
  }
}

namespace {

// The direction in the facet's plane along which its rectangle is smallest.
Vec3d axis_of(const Vec3d& normal, const std::vector<Vec3d>& corners) {
  Vec3d best;
  double least = HUGE_VAL;
  for (const Vec3d& p : corners)
    for (const Vec3d& q : corners) {
      const Vec3d d = q - p;
      if (!(dot(d, d) > 0)) continue;
      const Vec3d x = normalize(d), y = cross(normal, x);
      double x0 = HUGE_VAL, x1 = -HUGE_VAL, y0 = HUGE_VAL, y1 = -HUGE_VAL;
      for (const Vec3d& corner : corners) {
        x0 = std::min(x0, dot(x, corner)), x1 = std::max(x1, dot(x, corner));
        y0 = std::min(y0, dot(y, corner)), y1 = std::max(y1, dot(y, corner));
      }
      // Of equals the first.
      if (const double area = (x1 - x0) * (y1 - y0); area < least * (1 - 1e-9))
        least = area, best = x;
    }
  return best;
}

}  // namespace
}  // namespace tdpt

namespace tdpt::shader {

WindowSky::WindowSky(const Sky* sky, const Tracer& tracer, const PortalSet& portals,
                     const WindowSky& before)
    : sky_(sky) {
  if (!sky) return;
  std::vector<uint> facets(portals.facets());
  std::iota(facets.begin(), facets.end(), 0u);
  std::stable_sort(facets.begin(), facets.end(), [&](uint a, uint b) {
    return portals.load_portal_facet(a).area > portals.load_portal_facet(b).area;
  });
  if (facets.size() > kMostWindows) facets.resize(kMostWindows);
  for (const uint i : facets) {
    const PortalSet::PortalFacet& facet = portals.load_portal_facet(i);
    const std::vector<Vec3d> corners = portals.corners_of(facet);
    Window w{laid_out(axis_of(facet.normal, corners), -facet.normal, before),
             facet.centre,
             HUGE_VAL,
             -HUGE_VAL,
             HUGE_VAL,
             -HUGE_VAL,
             0};
    w.z = dot(w.frame->z, w.centre);
    for (const Vec3d& corner : corners) {
      const double x = dot(w.frame->x, corner), y = dot(w.frame->y, corner);
      w.x0 = std::min(w.x0, x), w.x1 = std::max(w.x1, x);
      w.y0 = std::min(w.y0, y), w.y1 = std::max(w.y1, y);
    }
    windows_.push_back(w);
  }
  if (!windows_.empty()) look_around(tracer, before);
}

void WindowSky::look_around(const Tracer& tracer, const WindowSky& before) {
  std::vector<WindowViews::Opening> openings;
  for (const Window& w : windows_) {
    const Vec3d &x = w.frame->x, &y = w.frame->y, &z = w.frame->z;
    openings.push_back({x * w.x0 + y * w.y0 + z * w.z, x * (w.x1 - w.x0), y * (w.y1 - w.y0), z});
  }
  views_ = before.views_.are_of(openings) ? before.views_ : WindowViews(tracer, openings);
}

auto WindowSky::laid_out(const Vec3d& x, const Vec3d& z, const WindowSky& before) const
    -> std::shared_ptr<const WindowFrame> {
  // A rectangle has four axes; windows of one wall share a table.
  std::shared_ptr<const WindowFrame> same;
  for (const Window& w : windows_) {
    constexpr double kSameAxis = 1e-6;
    if (length(w.frame->z - z) > kSameAxis) continue;
    const double along = std::abs(dot(w.frame->x, x)), across = std::abs(dot(w.frame->y, x));
    if (std::min(along, across) < kSameAxis) same = w.frame;
  }
  if (same) return same;
  // Only an identical one: the picture must not depend on what was rendered before.
  for (const Window& w : before.windows_)
    if (before.sky_ == sky_ && w.frame->x == x && w.frame->z == z) return w.frame;
  const int cells =
      sky_->one_colour() && sky_->suns().empty() ? 64 : std::clamp(sky_->map().height, 128, 256);
  return std::make_shared<WindowFrame>(*sky_, x, z, cells);
}

}  // namespace tdpt::shader
