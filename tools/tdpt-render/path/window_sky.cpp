#include "tools/tdpt-render/path/window_sky.h"

#include <algorithm>
#include <numbers>

namespace tdpt {
namespace {

using std::numbers::pi;

double luminance_towards(const Sky& sky, const Vec3d& w) {
  return luminance(sky.radiance(w));
}

// Of unit w with w.z > 0: da db / dw.
double per_solid_angle(const Vec3d& w) {
  const double across = (std::abs(w.x) + w.z) * (std::abs(w.y) + w.z);
  return w.z / (across * across);
}

// c and its inverse.
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

  // The sky itself, at a few places of each cell.
  void gather() {
    constexpr int kPlaces = 2;
    const double step = 2.0 / n_;
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j)
        for (int k = 0; k < kPlaces * kPlaces; ++k) {
          const double a = (i + (k % kPlaces + 0.5) / kPlaces) * step - 1;
          const double b = (j + (k / kPlaces + 0.5) / kPlaces) * step - 1;
          const Vec3d w = normalize(Vec3d(stretched(a), stretched(b), 1));
          cells_[static_cast<size_t>(i * n_ + j)] +=
              luminance_towards(sky_, x_ * w.x + y_ * w.y + z_ * w.z) / per_solid_angle(w) * step *
              step / (kPlaces * kPlaces);
        }
  }

  // And what those may have missed: texels much brighter than most, and suns.
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
  // As far as it reaches between the middles of its neighbours.
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

RectifiedSky::RectifiedSky(const Sky& sky, const Vec3d& x, const Vec3d& z, int cells)
    : x_(x), y_(cross(z, x)), z_(z), n_(cells) {
  Cells content(sky, x_, y_, z_, n_);
  content.gather();
  content.add_bright();
  const auto n = static_cast<size_t>(n_);
  sums_.assign((n + 1) * (n + 1), 0);
  for (size_t i = 0; i < n; ++i) {
    double column = 0;
    for (size_t j = 0; j < n; ++j) {
      column += content.cells()[i * n + j];
      sums_[(i + 1) * (n + 1) + j + 1] = sums_[i * (n + 1) + j + 1] + column;
    }
  }
}

RectifiedSky::Place RectifiedSky::place(double b) const {
  const int j = std::min(static_cast<int>(b), n_ - 1);
  return {j, b - j};
}

double RectifiedSky::sum(const Rect& r) const {
  const Place low = place(r.b0), high = place(r.b1);
  const auto column = [&](double a) {
    const auto [i, s] = place(a);
    const double here = at(i, high) - at(i, low), next = at(i + 1, high) - at(i + 1, low);
    return here + s * (next - here);
  };
  return column(r.a1) - column(r.a0);
}

namespace {

// Where a function that grows, linear between whole numbers, has grown by `share` of what it does
// from `low` to `high`.
template <class Function>
double grown_by(double share, double low, double high, const Function& at_whole) {
  const auto at = [&](double x) {
    const int i = static_cast<int>(x);
    const double here = at_whole(i);
    return x == i ? here : here + (x - i) * (at_whole(i + 1) - here);
  };
  const double begin = at(low), end = at(high), wanted = begin + share * (end - begin);
  int first = static_cast<int>(low), last = static_cast<int>(std::ceil(high)) - 1;
  while (first < last) {
    const int middle = (first + last) / 2;
    (at_whole(middle + 1) < wanted ? first = middle + 1 : last = middle);
  }
  const double from = std::max<double>(first, low), to = std::min<double>(first + 1, high);
  const double f = at(from), g = at(to);
  return g > f ? from + (to - from) * std::clamp((wanted - f) / (g - f), 0.0, 1.0) : from;
}

}  // namespace

Vec3d RectifiedSky::sample(const Rect& r, double u, double v) const {
  const Place low = place(r.b0), high = place(r.b1);
  const double a = grown_by(u, r.a0, r.a1, [&](int i) { return at(i, high) - at(i, low); });
  const int column = std::min(static_cast<int>(a), n_ - 1);
  const double b =
      grown_by(v, r.b0, r.b1, [&](int j) { return at(column + 1, j) - at(column, j); });
  const auto tangent = [&](double cells) { return stretched(2 * cells / n_ - 1); };
  const Vec3d w = normalize(Vec3d(tangent(a), tangent(b), 1));
  return normalize(x_ * w.x + y_ * w.y + z_ * w.z);
}

double RectifiedSky::density(const Vec3d& w) const {
  const auto cell = [&](double t) { return std::min(static_cast<int>(in_cells(t)), n_ - 1); };
  const int i = cell(w.x / w.z), j = cell(w.y / w.z);
  const double content = at(i + 1, j + 1) - at(i, j + 1) - at(i + 1, j) + at(i, j);
  return content * (0.25 * n_ * n_) * per_solid_angle(w);
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
      // Of those alike the first.
      if (const double area = (x1 - x0) * (y1 - y0); area < least * (1 - 1e-9))
        least = area, best = x;
    }
  return best;
}

}  // namespace

WindowSky::WindowSky(const Sky* sky, const PortalSet& portals) {
  if (!sky) return;
  std::vector<PortalSet::Outline> outlines = portals.outlines();
  std::stable_sort(outlines.begin(), outlines.end(),
                   [](const auto& a, const auto& b) { return a.area > b.area; });
  if (outlines.size() > kMostWindows) outlines.resize(kMostWindows);
  std::vector<std::shared_ptr<const RectifiedSky>> skies;
  for (const PortalSet::Outline& outline : outlines) {
    const Vec3d z = -outline.normal;
    Vec3d x = axis_of(outline);
    std::shared_ptr<const RectifiedSky> same;
    // A rectangle has four axes; windows of one wall share a table.
    for (const auto& s : skies) {
      constexpr double kAlike = 1e-6;
      if (length(s->z() - z) > kAlike) continue;
      const double along = std::abs(dot(s->x(), x)), across = std::abs(dot(s->y(), x));
      if (std::min(along, across) < kAlike) same = s;
    }
    if (!same) {
      const int cells =
          sky->one_colour() && sky->suns().empty() ? 64 : std::clamp(sky->map().height, 128, 256);
      same = skies.emplace_back(std::make_shared<RectifiedSky>(*sky, x, z, cells));
    }
    Window w{same, outline.centre, HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL, {}};
    for (const Vec3d& corner : outline.corners) {
      const double cx = dot(same->x(), corner - w.centre), cy = dot(same->y(), corner - w.centre);
      w.x0 = std::min(w.x0, cx), w.x1 = std::max(w.x1, cx);
      w.y0 = std::min(w.y0, cy), w.y1 = std::max(w.y1, cy);
    }
    for (size_t k = 0; k < 4; ++k)
      w.corners[k] =
          w.centre + same->x() * (k % 2 ? w.x1 : w.x0) + same->y() * (k / 2 ? w.y1 : w.y0);
    windows_.push_back(w);
  }
}

void WindowSky::look_around(const Tracer& tracer) {
  std::vector<WindowViews::Opening> openings;
  for (const Window& w : windows_)
    openings.push_back(
        {w.corners[0], w.corners[1] - w.corners[0], w.corners[2] - w.corners[0], w.sky->z()});
  views_ = WindowViews(tracer, openings);
}

bool WindowSky::faces(const Window& w, const Vec3d& p, const Vec3d& facing) {
  if (!(dot(w.sky->z(), w.centre - p) > PortalSet::kMargin)) return false;
  return facing == Vec3d() ||
         std::any_of(w.corners.begin(), w.corners.end(),
                     [&](const Vec3d& corner) { return dot(facing, corner - p) > 0; });
}

double WindowSky::seen_through(const Window& w, const Vec3d& p, const Vec3d& facing,
                               RectifiedSky::Rect& r) {
  if (!faces(w, p, facing)) return 0;
  const Vec3d d = w.sky->to_local(w.centre - p);
  const auto cells = [&](double across) { return w.sky->in_cells(across / d.z); };
  r = {cells(d.x + w.x0), cells(d.x + w.x1), cells(d.y + w.y0), cells(d.y + w.y1)};
  if (!(r.a0 < r.a1 && r.b0 < r.b1)) return 0;
  // Beside a sun, all that a window without it shows may be the rounding of the sums over both.
  constexpr double kRounding = 1e-12;
  const double seen = w.sky->sum(r);
  return seen > kRounding * w.sky->total() ? seen : 0;
}

double WindowSky::seen(const Vec3d& p, const Vec3d& facing) const {
  double sum = 0;
  RectifiedSky::Rect r;
  for_each(p, [&](const Window& w) { sum += seen_through(w, p, facing, r); });
  return sum;
}

Vec3d WindowSky::sample(const Vec3d& p, const Vec3d& facing, double seen, double pick, double u,
                        double v) const {
  double rest = pick * seen;
  const Window* chosen = nullptr;
  RectifiedSky::Rect r, of_chosen{};
  for_each(p, [&](const Window& w) {
    if (rest < 0) return;
    const double through = seen_through(w, p, facing, r);
    if (!(through > 0)) return;
    chosen = &w;
    of_chosen = r;
    rest -= through;
  });
  return chosen->sky->sample(of_chosen, u, v);
}

double WindowSky::pdf_w(const Vec3d& p, const Vec3d& facing, double seen,
                        const Vec3d& towards) const {
  double sum = 0;
  for_each(p, [&](const Window& w) {
    const Vec3d local = w.sky->to_local(towards);
    if (!(local.z > 0)) return;
    const Vec3d d = w.sky->to_local(w.centre - p);
    const double t = d.z / local.z, x = local.x * t - d.x, y = local.y * t - d.y;
    if (t > 0 && x >= w.x0 && x <= w.x1 && y >= w.y0 && y <= w.y1 && faces(w, p, facing))
      sum += w.sky->density(local);
  });
  return sum / seen;
}

}  // namespace tdpt
