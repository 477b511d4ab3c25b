#include "tools/tdpt-render/path/light/window_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tdpt {
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
Vec3d axis_of(const PortalSet::Outline& outline) {
  Vec3d best;
  double least = HUGE_VAL;
  for (const Vec3d& p : outline.corners)
    for (const Vec3d& q : outline.corners) {
      const Vec3d d = q - p;
      if (!(dot(d, d) > 0)) continue;
      const Vec3d x = normalize(d), y = cross(outline.normal, x);
      double x0 = HUGE_VAL, x1 = -HUGE_VAL, y0 = HUGE_VAL, y1 = -HUGE_VAL;
      for (const Vec3d& corner : outline.corners) {
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

WindowSky::WindowSky(const Sky* sky, const Tracer& tracer, const PortalSet& portals,
                     const WindowSky& before)
    : sky_(sky) {
  if (!sky) return;
  std::vector<PortalSet::Outline> outlines = portals.outlines();
  std::stable_sort(outlines.begin(), outlines.end(),
                   [](const auto& a, const auto& b) { return a.area > b.area; });
  if (outlines.size() > kMostWindows) outlines.resize(kMostWindows);
  for (const PortalSet::Outline& outline : outlines) {
    Window w{laid_out(axis_of(outline), -outline.normal, before),
             outline.centre,
             HUGE_VAL,
             -HUGE_VAL,
             HUGE_VAL,
             -HUGE_VAL,
             0};
    w.z = dot(w.frame->z, w.centre);
    for (const Vec3d& corner : outline.corners) {
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

std::shared_ptr<const WindowFrame> WindowSky::laid_out(const Vec3d& x, const Vec3d& z,
                                                       const WindowSky& before) const {
  // A rectangle has four axes; windows of one wall share a table.
  std::shared_ptr<const WindowFrame> same;
  for (const Window& w : windows_) {
    constexpr double kAlike = 1e-6;
    if (length(w.frame->z - z) > kAlike) continue;
    const double along = std::abs(dot(w.frame->x, x)), across = std::abs(dot(w.frame->y, x));
    if (std::min(along, across) < kAlike) same = w.frame;
  }
  if (same) return same;
  // Only an identical one: the picture must not depend on what was rendered before.
  for (const Window& w : before.windows_)
    if (before.sky_ == sky_ && w.frame->x == x && w.frame->z == z) return w.frame;
  const int cells =
      sky_->one_colour() && sky_->suns().empty() ? 64 : std::clamp(sky_->map().height, 128, 256);
  return std::make_shared<WindowFrame>(*sky_, x, z, cells);
}

}  // namespace tdpt

namespace tdpt::shader {
namespace {

// The shared code in doubles.
struct Windows {
  using Real = double;
  using SkyWindow = WindowSky::Window;
  using WindowFrame = tdpt::WindowFrame;

  explicit Windows(const WindowSky& all) : all_(all) {}
  uint windows_in_view(const Vec3d& position) const { return all_.in_view(position); }
  const SkyWindow& load_sky_window(uint i) const { return all_.windows()[i]; }
  static const WindowFrame& load_window_frame(const std::shared_ptr<const WindowFrame>& frame) {
    return *frame;
  }
  static uint window_sum(const WindowFrame& frame, uint i) { return frame.sums[i]; }

 private:
  const WindowSky& all_;

 public:
#include "shaders/shared/path/window_sky.h"
};

}  // namespace
}  // namespace tdpt::shader

namespace tdpt {

[[gnu::flatten]] double WindowSky::seen(const Vec3d& x, const Vec3d& facing) const {
  return shader::Windows(*this).seen_through_windows(x, facing);
}

[[gnu::flatten]] Vec3d WindowSky::sample(const Vec3d& x, const Vec3d& facing, double seen,
                                         double pick, double u, double v) const {
  return shader::Windows(*this).towards_window(x, facing, seen, pick, u, v);
}

[[gnu::flatten]] double WindowSky::pdf_w(const Vec3d& x, const Vec3d& facing, double seen,
                                         const Vec3d& towards) const {
  return shader::Windows(*this).windows_pdf_w(x, facing, seen, towards);
}

}  // namespace tdpt
