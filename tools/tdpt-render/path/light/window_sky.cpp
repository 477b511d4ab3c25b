#include "tools/tdpt-render/path/light/window_sky.h"

#include <algorithm>
#include <numbers>

namespace tdpt {
namespace {

using std::numbers::pi;

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
  const auto between = [](const double* sums, double t) {
    return sums[0] + t * (sums[1] - sums[0]);
  };
  const auto below = [&](const double* sums) {
    return between(sums + high.j, high.t) - between(sums + low.j, low.t);
  };
  const auto column = [&](double a) {
    const auto [i, s] = place(a);
    const double* const sums = &sums_[static_cast<size_t>(i * (n_ + 1))];
    const double here = below(sums), next = below(sums + n_ + 1);
    return here + s * (next - here);
  };
  return column(r.a1) - column(r.a0);
}

namespace {

// Where a function that grows, linear between whole numbers, has grown by `share` of what it does
// from `low` to `high`. By halves, and at last by counting: nothing branches on what was found,
// which is as hard to predict as the share is random.
template <class Function>
double grown_by(double share, double low, double high, const Function& at_whole) {
  const auto at = [&](double x) {
    const int i = static_cast<int>(x);
    const double here = at_whole(i);
    return x == i ? here : here + (x - i) * (at_whole(i + 1) - here);
  };
  const double begin = at(low), end = at(high), wanted = begin + share * (end - begin);
  int first = static_cast<int>(low), more = static_cast<int>(std::ceil(high)) - 1 - first;
  constexpr int kFew = 12;
  while (more > kFew) {
    const int half = (more + 1) / 2;
    first = at_whole(first + half) < wanted ? first + half : first;
    more -= half;
  }
  int before = 0;
  for (int i = 1; i <= more; ++i) before += at_whole(first + i) < wanted;
  first += before;
  const double from = std::max<double>(first, low), to = std::min<double>(first + 1, high);
  const double f = first < low ? begin : at_whole(first);
  const double g = first + 1 > high ? end : at_whole(first + 1);
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
  return normalize(x_ * tangent(a) + y_ * tangent(b) + z_);
}

double RectifiedSky::density(const Vec3d& w) const {
  const auto cell = [&](double x) { return std::min(static_cast<int>(in_cells(x, w.z)), n_ - 1); };
  const int i = cell(w.x), j = cell(w.y);
  return content(i, j) * (0.25 * n_ * n_) * per_solid_angle(w);
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
    w.z = dot(w.sky->z(), w.centre);
    for (const Vec3d& corner : outline.corners) {
      const double x = dot(w.sky->x(), corner), y = dot(w.sky->y(), corner);
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
    const RectifiedSky& sky = *w.sky;
    openings.push_back({sky.x() * w.x0 + sky.y() * w.y0 + sky.z() * w.z, sky.x() * (w.x1 - w.x0),
                        sky.y() * (w.y1 - w.y0), sky.z()});
  }
  views_ = before.views_.are_of(openings) ? before.views_ : WindowViews(tracer, openings);
}

std::shared_ptr<const RectifiedSky> WindowSky::laid_out(const Vec3d& x, const Vec3d& z,
                                                        const WindowSky& before) const {
  // A rectangle has four axes; windows of one wall share a table.
  std::shared_ptr<const RectifiedSky> same;
  for (const Window& w : windows_) {
    constexpr double kAlike = 1e-6;
    if (length(w.sky->z() - z) > kAlike) continue;
    const double along = std::abs(dot(w.sky->x(), x)), across = std::abs(dot(w.sky->y(), x));
    if (std::min(along, across) < kAlike) same = w.sky;
  }
  if (same) return same;
  // The very same: a picture must not tell what was looked at before.
  for (const Window& w : before.windows_)
    if (before.sky_ == sky_ && w.sky->x() == x && w.sky->z() == z) return w.sky;
  const int cells =
      sky_->one_colour() && sky_->suns().empty() ? 64 : std::clamp(sky_->map().height, 128, 256);
  return std::make_shared<RectifiedSky>(*sky_, x, z, cells);
}

namespace {

// A point as the windows of one frame see it, for one after the other.
class Eye {
 public:
  Eye(const Vec3d& p, const Vec3d& facing)
      : p_(p), facing_(facing), both_sides_(facing == Vec3d()) {}

  // True if the frame is another than before.
  bool turn_to(const RectifiedSky& frame) {
    if (frame_ == &frame) return false;
    frame_ = &frame;
    at_ = frame.to_local(p_);
    if (!both_sides_) front_ = frame.to_local(facing_);
    return true;
  }
  const Vec3d& at() const { return at_; }
  // From inside, a corner above the horizon.
  bool sees(const WindowSky::Window& w) const {
    const double height = w.z - at_.z;
    if (!(height > PortalSet::kMargin)) return false;
    return both_sides_ || front_.x * ((front_.x > 0 ? w.x1 : w.x0) - at_.x) +
                                  front_.y * ((front_.y > 0 ? w.y1 : w.y0) - at_.y) +
                                  front_.z * height >
                              0;
  }
  // S_F, and the rectangle where it is more than 0.
  double seen_through(const WindowSky::Window& w, RectifiedSky::Rect& r) {
    const RectifiedSky& sky = *w.sky;
    turn_to(sky);
    if (!sees(w)) return 0;
    const double height = w.z - at_.z;
    r = {sky.in_cells(w.x0 - at_.x, height), sky.in_cells(w.x1 - at_.x, height),
         sky.in_cells(w.y0 - at_.y, height), sky.in_cells(w.y1 - at_.y, height)};
    if (!(r.a0 < r.a1 && r.b0 < r.b1)) return 0;
    // Beside a sun, all that a window without it shows may be the rounding of the sums over both.
    constexpr double kRounding = 1e-12;
    const double seen = sky.sum(r);
    return seen > kRounding * sky.total() ? seen : 0;
  }

 private:
  const Vec3d &p_, &facing_;
  bool both_sides_;
  const RectifiedSky* frame_ = nullptr;
  Vec3d at_{}, front_{};
};

}  // namespace

double WindowSky::seen(const Vec3d& p, const Vec3d& facing) const {
  double sum = 0;
  RectifiedSky::Rect r;
  Eye eye(p, facing);
  for_each(p, [&](const Window& w) { sum += eye.seen_through(w, r); });
  return sum;
}

Vec3d WindowSky::sample(const Vec3d& p, const Vec3d& facing, double seen, double pick, double u,
                        double v) const {
  double rest = pick * seen;
  const Window* chosen = nullptr;
  RectifiedSky::Rect r, of_chosen{};
  Eye eye(p, facing);
  for_each(p, [&](const Window& w) {
    if (rest < 0) return;
    const double through = eye.seen_through(w, r);
    if (!(through > 0)) return;
    chosen = &w;
    of_chosen = r;
    rest -= through;
  });
  return chosen->sky->sample(of_chosen, u, v);
}

double WindowSky::pdf_w(const Vec3d& p, const Vec3d& facing, double seen,
                        const Vec3d& towards) const {
  double sum = 0, density = -1;  // of the frame's; -1: not known yet
  Eye eye(p, facing);
  Vec3d local;
  for_each(p, [&](const Window& w) {
    if (eye.turn_to(*w.sky)) local = w.sky->to_local(towards), density = -1;
    if (!(local.z > 0)) return;
    // Where the plane is passed, times local.z.
    const double height = w.z - eye.at().z;
    const double x = local.x * height + eye.at().x * local.z;
    const double y = local.y * height + eye.at().y * local.z;
    if (!(x >= w.x0 * local.z && x <= w.x1 * local.z && y >= w.y0 * local.z &&
          y <= w.y1 * local.z && eye.sees(w)))
      return;
    if (density < 0) density = w.sky->density(local);
    sum += density;
  });
  return sum / seen;
}

}  // namespace tdpt
