// Fits the least tube: position, orientation and thickness of an opening's wall, from lines that
// pass it.
//
// Method: minimum etendue, by coordinate search (each coordinate has its own step, which grows by
// success and shrinks by failure). The objective is
//
//   log(A F) - p log(n / N) + s mean(log cos)
//
// A  area of the outline of the lines' crossings with both faces of the tube [m2]: that within
//    kSides tangents, each of which leaves the share `outside` of the crossings outside
// F  form factor between its two faces; pi A F is the etendue of all lines through the tube
// n  lines that the tube holds: those that come within its slab, along its normal; of N
// p  penalty for lines that miss it: 1 would minimise etendue per line
// s  1: maximum likelihood for any distribution of directions; 0: for light from all directions
//    alike. Lines have density 1/A per etendue dA cos dw times that of their directions, so where
//    these favour one side, A alone falls as the plane turns to face it
#include "tools/portalfit/opening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include "libcommon/math/reach.h"

namespace tdpt {
namespace {

constexpr int kSides = 16;          // of an outline
constexpr double kInner = 0.97;     // of the nearest tangent: crossings within it are skipped
constexpr double kRounding = 1e-9;  // relative tolerance of products of lengths

// Share of the lines that is next to none: beyond each side of a plane's outline, and too few that
// pass both faces of a tube.
constexpr double kHardlyAny = 0.002;
constexpr size_t kMany = 500;        // lines that tell their mean direction
constexpr size_t kFineLines = 8192;  // of the searches that are not rough
constexpr double kTurn = 0.25;       // tangent between the starts of a search
// Steps of a search, in shorter sides: the first, which is also the largest tilt of a step, that of
// a search that goes on, and the last steps.
constexpr double kFirstStep = 0.3, kFineStep = 0.1, kRoughLast = 0.05, kFineLast = 0.004;
constexpr double kBlindEnd = 0.1;     // of a tube's depth: lines end on the end of a room behind it
constexpr double kMostInWall = 0.15;  // of the etendue, by which it may be the larger in a wall

// Evaluation of a tube.
struct Measured {
  double cost = INFINITY;        // the objective; infinite if invalid
  size_t held = 0, through = 0;  // number of lines; of those that pass both faces
  double slant = 0;              // mean(log cos)
  Extents extents{};             // of the crossings
  double size = 0;               // A [m2]
  std::array<double, 2> box{};  // sides of the rectangle of area A in the outline's proportions [m]
};

struct Fitted {
  Tube tube;
  Measured measured;
};

double form_factor(const Fitted& f) {
  return facing_rectangles(f.measured.box[0], f.measured.box[1], 2 * f.tube.half);
}

enum class Shape { tube, plane };

// Parameters of the objective, symbols as above.
struct Goal {
  Shape shape;
  double penalty;  // p
  double outside;  // share of the crossings beyond each side
  double slant;    // s
};
constexpr Goal kTubes{Shape::tube, 2, 0.0006, 0};
constexpr Goal kNarrowestPlane{Shape::plane, 2, 0.0006, 0};
// Planes where there is no prism, as beside a door ajar; the mean(log cos) of few lines is noise.
constexpr Goal kPlaneOfMany{Shape::plane, 2, kHardlyAny, 1};
constexpr Goal kPlaneOfFew{Shape::plane, 0.3, 0.0006, 0};
// Planes for lines that are known except for leaks.
constexpr Goal kPlaneOfKnown{Shape::plane, kWorthOfKnown, kHardlyAny, 1};

// Coordinates of a tube: position along n, depth of both faces or of either, and two tilts.
enum Move { slide, both, front, rear, long_tilt, short_tilt, moves };

// The tube moved by `by` [metres] along one coordinate; a tilt about its middle's `o` moves its far
// ends by that.
Tube moved(Tube tube, const Extents& e, Move move, double by, double most_tilt) {
  constexpr double kAlong[] = {1, 0, 0.5, 0.5, 0, 0}, kDeeper[] = {0, 0.5, 0.5, -0.5, 0, 0};
  const Vec3d n = tube.middle.n;
  const Onb<double> frame(n);
  if (move == long_tilt || move == short_tilt) {
    const Vec3d towards = move == long_tilt ? frame.x * e.axis.x + frame.y * e.axis.y
                                            : frame.y * e.axis.x - frame.x * e.axis.y;
    const double side = move == long_tilt ? e.longer : e.shorter;
    const double tilt = by / std::hypot(side, 2 * tube.half);
    tube.middle.n = normalize(n + towards * std::clamp(tilt, -most_tilt, most_tilt));
  }
  tube.middle.o += n * (kAlong[move] * by);
  tube.half = std::max(tube.half + kDeeper[move] * by, 0.0);
  return tube;
}

class Search {
 public:
  Search(std::span<const LightLine> lines, const Goal& goal) : lines_(lines), goal_(goal) {
    if (goal.slant > 0)
      for (const LightLine& line : lines) length_.push_back(length(line.camera - line.light));
  }

  // `faces`: heights of the outlines, in half depths of the tube.
  Measured measure(const Tube& tube, std::array<double, 2> faces = {-1, 1}) {
    Measured measured;
    take_places(tube, faces, measured);
    const auto held = static_cast<double>(measured.held), all = static_cast<double>(lines_.size());
    if (held < 0.5 * all ||
        static_cast<double>(measured.through) < std::max(8.0, kHardlyAny * held))
      return measured;
    measured.extents = extents_of(places_);
    if (!(measured.extents.shorter > 0) || !measure_outline(measured)) return measured;
    measured.cost = std::log(measured.size *
                             facing_rectangles(measured.box[0], measured.box[1], 2 * tube.half)) -
                    goal_.penalty * std::log(held / all) + goal_.slant * measured.slant;
    return measured;
  }

  // Steps shrink from `first` to `last`, in shorter sides of the start's extents.
  Fitted run(const Tube& start, double first, double last, bool turns = true) {
    Fitted best{start, measure(start)};
    if (!std::isfinite(best.measured.cost)) return best;
    const double unit = best.measured.extents.shorter;
    std::array<double, moves> step;
    step.fill(first);
    if (goal_.shape == Shape::plane) step[both] = step[front] = step[rear] = 0;
    if (!turns) step[long_tilt] = step[short_tilt] = 0;
    while (*std::max_element(step.begin(), step.end()) > last)
      for (int m = 0; m < moves; ++m) {
        double& s = step[static_cast<size_t>(m)];
        if (s > 0.5 * last) s *= improved(best, static_cast<Move>(m), s * unit) ? 1.5 : 0.5;
      }
    best.tube.middle.o = to_space(best.tube.middle, best.measured.extents.mean);
    return best;
  }

  double density(const Fitted& f) const {
    if (!std::isfinite(f.measured.cost)) return 0;
    return static_cast<double>(f.measured.through) / static_cast<double>(lines_.size()) /
           (f.measured.size * form_factor(f));
  }

  // Area of the outline on the faces over that in the middle.
  double waistedness(const Fitted& f) { return f.measured.size / measure(f.tube, {0, 0}).size; }

 private:
  // Points of the held lines that are nearest to the two faces.
  void take_places(const Tube& tube, std::array<double, 2> faces, Measured& measured) {
    const Slab slab(tube);
    places_.clear();
    for (size_t i = 0; i < lines_.size(); ++i)
      if (const auto passage = slab.passage(lines_[i])) {
        measured.through += passage->through(tube.half);
        if (goal_.slant > 0)
          measured.slant += std::log(std::max(kGrazing, passage->along / length_[i]));
        for (const double face : faces) places_.push_back(passage->at(face * tube.half));
      }
    measured.held = places_.size() / 2;
    measured.slant /= static_cast<double>(std::max<size_t>(measured.held, 1));
  }

  // A and the box; false if there is no outline. Leaves the crossings whitened.
  bool measure_outline(Measured& measured) {
    const Whitening whitening = measured.extents.whitening();
    for (Vec2d& p : places_) p = whitening(p);
    outer_.clear();
    for (const Vec2d& p : places_)
      if (dot(p, p) >= inner_ * inner_) outer_.push_back(p);
    double nearest = INFINITY;
    Polygon outline{{-100, -100}, {100, -100}, {100, 100}, {-100, 100}};
    double least[2] = {0, 0}, most[2] = {0, 0};
    const auto beyond = static_cast<size_t>(goal_.outside * static_cast<double>(places_.size()));
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2 * std::numbers::pi * side / kSides;
      const Vec2d axis{std::cos(angle), std::sin(angle)};
      // The crossings skipped reach no farther than inner_.
      double limit = reach_of(outer_, axis, beyond);
      if (!(limit > inner_ * (1 + kRounding))) limit = reach_of(places_, axis, beyond);
      nearest = std::min(nearest, limit);
      if (side % (kSides / 4) == 0)
        (side < kSides / 2 ? most : least)[side / (kSides / 4) % 2] = limit;
      outline = clipped(outline, axis, limit);
    }
    inner_ = kInner * std::max(nearest, 0.0);
    measured.size = area(outline) * measured.extents.longer * measured.extents.shorter;
    const double a = (most[0] + least[0]) * measured.extents.longer,
                 b = (most[1] + least[1]) * measured.extents.shorter;
    if (!(measured.size > 0 && a > 0 && b > 0)) return false;
    const double grow = std::sqrt(measured.size / (a * b));
    measured.box = {a * grow, b * grow};
    return true;
  }

  // Extent along the axis without the `beyond` farthest crossings; -INFINITY if there are no more.
  double reach_of(const std::vector<Vec2d>& places, Vec2d axis, size_t beyond) {
    if (places.size() <= beyond) return -INFINITY;
    heights_.clear();
    for (const Vec2d& p : places) heights_.push_back(dot(p, axis));
    farthest_.resize(beyond + 1);
    std::partial_sort_copy(heights_.begin(), heights_.end(), farthest_.begin(), farthest_.end(),
                           std::greater<>());
    return farthest_.back();
  }

  bool improved(Fitted& best, Move move, double by) {
    const Extents e = best.measured.extents;
    Tube from = best.tube;
    from.middle.o = to_space(best.tube.middle, e.mean);  // centre of rotation
    for (const double way : {by, -by}) {
      const Tube next = moved(from, e, move, way, kFirstStep);
      const Measured there = measure(next);
      if (!(there.cost < best.measured.cost)) continue;
      best = {next, there};
      return true;
    }
    return false;
  }

  std::span<const LightLine> lines_;
  Goal goal_;
  std::vector<double> length_;  // of the lines, if needed [m]
  std::vector<Vec2d> places_;   // crossings of the last measurement, both faces
  std::vector<Vec2d> outer_;    // those not within inner_, which may matter to the outline
  double inner_ = 0;            // radius within all tangents of the previous, similar measurement
  std::vector<double> heights_, farthest_;
};

Fitted least_plane(std::span<const LightLine> lines, Tube start, const Goal& goal) {
  start.half = 0;
  return Search(lines, goal).run(start, kFirstStep, kFineLast);
}

// Whether the tube is a room and not an opening: its lines begin or end where it does.
bool is_blind(std::span<const LightLine> lines, const Tube& tube) {
  const Slab slab(tube);
  const double close = kBlindEnd * 2 * tube.half;
  size_t through = 0, begin = 0, end = 0;
  for (const LightLine& line : lines)
    if (const auto p = slab.passage(line); p && p->through(tube.half)) {
      ++through;
      begin += p->from > -tube.half - close;
      end += p->from + p->along < tube.half + close;
    }
  return 2 * std::max(begin, end) > through;
}

// Searches with few lines from several starts, since the objective has several valleys.
std::array<Fitted, 5> rough_tubes(const std::vector<LightLine>& lines, const Tube& start) {
  const std::array<Vec2d, 5> turns{{{0, 0}, {kTurn, 0}, {-kTurn, 0}, {0, kTurn}, {0, -kTurn}}};
  const Onb<double> frame(start.middle.n);
  std::array<Fitted, 5> rough;
  tbb::parallel_for(size_t{0}, turns.size(), [&](size_t k) {
    Tube from = start;
    from.middle.n = normalize(start.middle.n + frame.x * turns[k].x + frame.y * turns[k].y);
    rough[k] = Search(lines, kTubes).run(from, kFirstStep, kRoughLast);
  });
  return rough;
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
  const std::vector<LightLine> fine = thinned(lines, kFineLines);
  const Goal flat = lines.size() < kMany ? kPlaneOfFew : kPlaneOfMany;
  if (near && start.half == 0) return least_plane(fine, start, flat).tube;
  const std::vector<LightLine> few = thinned(lines, kRoughLines);
  Search search(fine, kTubes);
  Fitted narrowest, found;
  std::array<Fitted, 5> rough;
  tbb::parallel_invoke(
      [&] {
        narrowest = Search(few, kNarrowestPlane).run({start.middle, 0}, kFirstStep, kRoughLast);
      },
      [&] {
        if (near)
          found = search.run(start, kFineStep, kFineLast);
        else
          rough = rough_tubes(few, start);
      });
  // If the whole tube passes light, its density of lines per etendue is that of its narrowest
  // plane.
  Search rough_search(few, kTubes);
  const double enough = kMost * rough_search.density(narrowest);
  const auto narrow = [&] {
    return Search(fine, kNarrowestPlane).run(narrowest.tube, kFineStep, kFineLast).tube;
  };
  if (!near) {
    Fitted best;
    best.tube = start;
    for (const Fitted& f : rough)
      if (f.measured.cost < best.measured.cost && rough_search.density(f) >= enough &&
          rough_search.waistedness(f) < kWidening)
        best = f;
    found = search.run(best.tube, kFineStep, kFineLast);
  }
  if (search.density(found) < enough || is_blind(fine, found.tube)) return narrow();
  const double waistedness = search.waistedness(found);
  if (!(waistedness < kWidening)) return narrow();
  if (waistedness < kSimilarArea || form_factor(found) <= kMost) return found.tube;
  // If the opening is no prism, as beside a door ajar, its narrowest plane is the portal.
  const Fitted plane = least_plane(fine, found.tube, flat);
  const bool holds_too_few = static_cast<double>(plane.measured.held) <
                             kPlaneHolds * static_cast<double>(found.measured.held);
  return holds_too_few ? found.tube : plane.tube;
}

Tube turned_into_wall(const std::vector<LightLine>& lines, const Tube& tube,
                      std::span<const Vec3d> walls) {
  const std::vector<LightLine> fine = thinned(lines, kFineLines);
  Search search(fine, tube.half > 0 ? kTubes : kNarrowestPlane);
  double most = search.measure(tube).cost + kMostInWall;
  Tube best = tube;
  for (const Vec3d& wall : walls) {
    const double cosine = dot(wall, tube.middle.n);
    if (std::abs(cosine) < kNearlyParallel) continue;
    Tube start = tube;
    start.middle.n = cosine < 0 ? -wall : wall;
    const Fitted found = search.run(start, kFineStep, kFineLast, false);
    if (found.measured.cost < most) most = found.measured.cost, best = found.tube;
  }
  return best;
}

Tube holding_plane(const std::vector<LightLine>& lines, const Tube& start) {
  const auto fine = thinned(lines, kFineLines);
  return least_plane(fine, start, kPlaneOfKnown).tube;
}

}  // namespace tdpt
