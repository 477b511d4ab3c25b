#include "tools/portalfit/tube.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt {
namespace {

constexpr int kSides = 16;
constexpr double kOutside = 0.0006;   // share of the lines beyond each side of the outline
constexpr double kPlaneHolds = 0.97;  // of the prism's lines
constexpr double kPrism = 1.08;       // most area of a prism's outline over that in its middle
constexpr double kThrough = 0.002;    // smallest share of the lines that pass both faces
constexpr double kLosing = 2, kLosingPlane = 0.3;  // weight of the lines that miss it
constexpr double kLosingKnown = 3;   // the same, of lines that are known to pass there
constexpr size_t kMostRough = 1500;  // lines for the first look
constexpr size_t kMostFine = 8192;
constexpr double kWidest =
    1.5;  // the same of anything: a room is a tube, too, and all lines end in it
constexpr double kDense = 0.6;  // least density in a tube over that in its narrowest plane
constexpr double kShort = 0.5;  // form factor of the faces below which a tube is long
constexpr double kMostTilt = 0.3;

struct Search {
  std::vector<LightLine> lines;
  bool flat = false;
  double losing = kLosing;                 // a plane, not a tube
  std::pair<double, double> faces{-1, 1};  // where the outline is taken, in halves of the tube
  std::vector<Vec2d> points{};             // of the last look, both faces
  std::vector<double> reach{};
  Extents extents{};
  std::array<double, 2> box{};  // sides of a rectangle like the outline [m]
  double size = 0;              // area of the outline [m2]
  double through = 0;           // lines that pass both faces

  // How far along the axis the points reach but for the `beyond` farthest: the least of a heap of
  // the farthest, which few of the points ever enter.
  double reach_of(Vec2d axis, size_t beyond) {
    reach.clear();
    for (const Vec2d& p : points) {
      const double at = p.x * axis.x + p.y * axis.y;
      if (reach.size() <= beyond) {
        reach.push_back(at);
        std::push_heap(reach.begin(), reach.end(), std::greater<>());
      } else if (at > reach.front()) {
        std::pop_heap(reach.begin(), reach.end(), std::greater<>());
        reach.back() = at;
        std::push_heap(reach.begin(), reach.end(), std::greater<>());
      }
    }
    return reach.front();
  }

  // Logarithm of the etendue per line held; without a common factor.
  double badness(const Tube& tube) {
    const Onb<double> frame(tube.middle.n);
    points.clear();
    through = 0;
    for (const LightLine& l : lines) {
      const Vec3d a = l.light - tube.middle.o, d = l.camera - l.light;
      const double from = dot(a, tube.middle.n), along = dot(d, tube.middle.n);
      if (!(along > 0) || from > tube.half || from + along < -tube.half) continue;
      through += from <= -tube.half && from + along >= tube.half;
      const double ax = dot(a, frame.x), ay = dot(a, frame.y);
      const double dx = dot(d, frame.x), dy = dot(d, frame.y);
      for (const double face : {faces.first * tube.half, faces.second * tube.half}) {
        const double t = std::clamp((face - from) / along, 0.0, 1.0);
        points.push_back({ax + dx * t, ay + dy * t});
      }
    }
    const double held = 0.5 * static_cast<double>(points.size()),
                 all = static_cast<double>(lines.size());
    if (held < 0.5 * all || through < std::max(8.0, kThrough * held)) return INFINITY;
    extents = extents_of(points);
    if (!(extents.shorter > 0)) return INFINITY;
    // In a frame where the points are round, so that slits are as well described as squares.
    const Vec2d u = extents.axis * (1 / extents.longer),
                v = Vec2d{-extents.axis.y, extents.axis.x} * (1 / extents.shorter);
    for (Vec2d& p : points) {
      const Vec2d d = p - extents.mean;
      p = {d.x * u.x + d.y * u.y, d.x * v.x + d.y * v.y};
    }
    Polygon outline{{-100, -100}, {100, -100}, {100, 100}, {-100, 100}};
    double least[2] = {0, 0}, most[2] = {0, 0};
    const auto beyond = static_cast<size_t>(kOutside * static_cast<double>(points.size()));
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2 * std::numbers::pi * side / kSides;
      const Vec2d axis{std::cos(angle), std::sin(angle)};
      const double limit = reach_of(axis, beyond);
      if (side % (kSides / 4) == 0)
        (side < kSides / 2 ? most : least)[side / (kSides / 4) % 2] = limit;
      outline = clipped(outline, axis, limit);
    }
    size = area(outline) * extents.longer * extents.shorter;
    if (!(size > 0)) return INFINITY;
    // The rectangle of this area in the proportions of the extents.
    const double a = (most[0] + least[0]) * extents.longer,
                 b = (most[1] + least[1]) * extents.shorter;
    if (!(a > 0 && b > 0)) return INFINITY;
    const double grow = std::sqrt(size / (a * b));
    box = {a * grow, b * grow};
    return std::log(size * facing_rectangles(a * grow, b * grow, 2 * tube.half)) -
           losing * std::log(held / all);
  }

  // Coordinate search: every coordinate keeps its own step.
  Tube run(Tube best, double first, double last) {
    double least = badness(best);
    if (!std::isfinite(least)) return best;
    const double unit = extents.shorter;
    enum Move { slide, both, front, rear, long_tilt, short_tilt, moves };
    std::array<double, moves> step;
    step.fill(first);
    if (flat) step[both] = step[front] = step[rear] = 0;
    while (*std::max_element(step.begin(), step.end()) > last) {
      for (int m = 0; m < moves; ++m) {
        auto& s = step[static_cast<size_t>(m)];
        if (s <= 0.5 * last || (flat && (m == both || m == front || m == rear))) continue;
        bool better = false;
        // The plane turns about the middle of its crossings.
        const Extents e = extents;
        const Onb<double> frame(best.middle.n);
        const Vec3d along = frame.x * e.axis.x + frame.y * e.axis.y,
                    across = frame.y * e.axis.x - frame.x * e.axis.y;
        Tube from = best;
        from.middle.o = to_space(best.middle, e.mean);
        for (const double way : {1.0, -1.0}) {
          Tube next = from;
          const double by = way * s * unit;
          if (m == slide || m == front || m == rear)
            next.middle.o += from.middle.n * (m == slide ? by : 0.5 * by);
          if (m == both || m == front) next.half += 0.5 * by;
          if (m == rear) next.half -= 0.5 * by;
          if (m == long_tilt)
            next.middle.n =
                normalize(from.middle.n + along * std::clamp(by / e.longer, -kMostTilt, kMostTilt));
          if (m == short_tilt)
            next.middle.n = normalize(from.middle.n +
                                      across * std::clamp(by / e.shorter, -kMostTilt, kMostTilt));
          next.half = std::max(next.half, 0.0);
          const double bad = badness(next);
          if (!(bad < least)) continue;
          best = next, least = bad, better = true;
          break;
        }
        if (!better) badness(best);
        s *= better ? 1.5 : 0.5;
      }
    }
    best.middle.o = to_space(best.middle, extents.mean);
    return best;
  }
};

std::vector<LightLine> every_kth(const std::vector<LightLine>& lines, size_t most) {
  if (lines.size() <= most) return lines;
  std::vector<LightLine> some;
  for (size_t i = 0; i < most; ++i) some.push_back(lines[i * lines.size() / most]);
  return some;
}

// Share of the lines through the tube per etendue [1/m2]: where all of a tube lets light through it
// is that of its narrowest plane.
double density(Search& search, const Tube& tube) {
  if (!std::isfinite(search.badness(tube))) return 0;
  return search.through / static_cast<double>(search.lines.size()) /
         (search.size * facing_rectangles(search.box[0], search.box[1], 2 * tube.half));
}

// Area of the outline at the tube's faces over that in its middle.
double waistedness(Search& search, const Tube& tube) {
  search.faces = {0, 0};
  search.badness(tube);
  const double middle = search.size;
  search.faces = {-1, 1};
  search.badness(tube);
  return search.size / middle;
}

}  // namespace

double facing_rectangles(double a, double b, double c) {
  if (!(c > 1e-6 * std::min(a, b))) return 1;
  const double x = a / c, y = b / c;
  if (std::max(x, y) < 1e-3) return x * y / std::numbers::pi;
  const double p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
  return 2 / (std::numbers::pi * x * y) *
         (0.5 * std::log(p * p * q * q / (1 + x * x + y * y)) + x * q * std::atan(x / q) +
          y * p * std::atan(y / p) - x * std::atan(x) - y * std::atan(y));
}

Tube least_tube(const std::vector<LightLine>& lines, const Tube& start, bool near) {
  const std::vector<LightLine> fine = every_kth(lines, kMostFine);
  Search prism{fine}, flat{fine, true};
  const auto flattened = [&](Tube plane, double losing) {
    plane.half = 0;
    flat.losing = losing;
    return flat.run(plane, 0.3, 0.004);
  };
  if (near && start.half == 0) return flattened(start, kLosingPlane);
  // From several starts: there are valleys.
  const Onb<double> frame(start.middle.n);
  constexpr double kTurn = 0.25;
  constexpr std::array<Vec2d, 5> turns{{{0, 0}, {kTurn, 0}, {-kTurn, 0}, {0, kTurn}, {0, -kTurn}}};
  struct Rough {
    Tube tube;
    double badness, density, waistedness;
  };
  std::array<Rough, turns.size()> rough;
  Tube narrowest, tube = start;
  tbb::parallel_for(size_t{0}, near ? 2 : turns.size() + 1, [&](size_t k) {
    if (k == 0) {
      narrowest = flattened(start, kLosing);
    } else if (near) {
      tube = prism.run(start, 0.1, 0.004);
    } else {
      Search search{every_kth(lines, kMostRough)};
      Tube from = start;
      from.middle.n =
          normalize(start.middle.n + frame.x * turns[k - 1].x + frame.y * turns[k - 1].y);
      from = search.run(from, 0.3, 0.05);
      const double dense = density(search, from), bad = search.badness(from);
      rough[k - 1] = {from, bad, dense, waistedness(search, from)};
    }
  });
  const double enough = kDense * density(flat, narrowest);
  double least = INFINITY;
  if (!near)
    for (const Rough& r : rough)
      if (r.density >= enough && r.badness < least && r.waistedness < kWidest)
        least = r.badness, tube = r.tube;
  if (!near) tube = prism.run(tube, 0.1, 0.004);
  if (density(prism, tube) < enough) return narrowest;
  const double waisted = waistedness(prism, tube);
  if (!(waisted < kWidest)) return narrowest;
  const bool is_short = facing_rectangles(prism.box[0], prism.box[1], 2 * tube.half) > kShort;
  if (waisted < kPrism || !is_short) return tube;
  // Where the opening is no prism, as beside a door ajar, its narrowest plane is the portal.
  const Tube plane = flattened(tube, kLosingPlane);
  flat.badness(plane);
  return flat.points.size() < kPlaneHolds * prism.points.size() ? tube : plane;
}

Tube holding_plane(const std::vector<LightLine>& lines, const Tube& start) {
  Search flat{every_kth(lines, kMostFine), true};
  flat.losing = kLosingKnown;
  Tube plane = start;
  plane.half = 0;
  return flat.run(plane, 0.3, 0.004);
}

}  // namespace tdpt
