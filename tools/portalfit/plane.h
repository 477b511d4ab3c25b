// Plane geometry: convex polygons, the spread of points, crossings of light lines with a plane and
// their passage through the slab between two parallel planes, and portals as flat shapes.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/formats/portal.h"
#include "libcommon/math/vec.h"

namespace tdpt {

// The numbers that decide in several chapters; each is a ratio unless a unit is given.

/// Most of a thing is more than half of it.
inline constexpr double kMost = 0.5;
/// Share that stands for the whole: open of a joint outline, then panes are joined across mullions;
/// light of two cameras that passes both portals, then they are one; support, and with less one of
/// two windows may be the opening.
inline constexpr double kMostly = 0.8;
/// Share of an area or of lines that does not matter: what one corner fewer adds, or strays; and
/// lines that two openings share.
inline constexpr double kSlight = 0.01;
/// Ratio of areas up to which they are similar: of a prism's faces and middle, of an outline and
/// one that takes all of its lines.
inline constexpr double kSimilarArea = 1.08;
/// Ratio of areas from which one is clearly the wider: of a tube's faces over its middle, of what
/// is near an outline over the outline.
inline constexpr double kWidening = 1.5;
/// Voxels: narrower bars do not show, nor do edges of what is less than twice as wide.
inline constexpr double kResolved = 2;
/// How far what belongs to an opening may be from it, of its shorter side or its size: lines that
/// end before it or behind it, mullions within it, panes that are not quite in one plane; a room
/// that it opens into goes on farther than that.
inline constexpr double kBeside = 0.2;
/// Cosine between planes that may be one, such as a tube's and a wall's; others bound each other.
inline constexpr double kNearlyParallel = 0.966;
/// Cosine with the normal: a crossing with less is not clear, and counts as this where slants are
/// averaged.
inline constexpr double kGrazing = 0.05;
/// Worth of a line that passes for certain against area, in logarithms.
inline constexpr double kWorthOfKnown = 3;
/// Share of an opening's lines with which another plane or outline takes its place.
inline constexpr double kPlaneHolds = 0.97;
/// Lines of a first, rough search.
inline constexpr size_t kRoughLines = 2000;
/// Lines, or probes, that tell anything.
inline constexpr size_t kFewestLines = 30;

struct Vec2d {
  double x = 0, y = 0;
  friend constexpr Vec2d operator+(Vec2d a, Vec2d b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2d operator-(Vec2d a, Vec2d b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec2d operator*(Vec2d a, double s) { return {a.x * s, a.y * s}; }
};
constexpr double dot(Vec2d a, Vec2d b) {
  return a.x * b.x + a.y * b.y;
}
constexpr double cross(Vec2d a, Vec2d b) {
  return a.x * b.y - a.y * b.x;
}

/// Corners counter-clockwise.
using Polygon = std::vector<Vec2d>;

/// Convex hull, counter-clockwise; fewer than three corners if the points are collinear (CGAL).
Polygon convex_hull(const std::vector<Vec2d>& points);
/// Delaunay triangulation of a convex polygon's corners, counter-clockwise (CGAL).
std::vector<std::array<uint32_t, 3>> triangulate(const Polygon& polygon);

double area(const Polygon& polygon);
/// Whether the convex polygon contains p, border included.
bool contains(const Polygon& polygon, Vec2d p);
/// Scales about the centre of mass until the area has grown by the factor `growth`.
Polygon enlarged(const Polygon& polygon, double growth);
/// The part of the convex polygon with dot(axis, p) <= limit.
Polygon clipped(const Polygon& polygon, Vec2d axis, double limit);
/// A convex polygon around `polygon` with fewer corners: edges are removed by extending their
/// neighbours, the one that adds least area first, until the next would add more than `tolerance`
/// of the area.
Polygon simplified(const Polygon& polygon, double tolerance);

// Spread of points in a plane: mean and covariance, and the rectangle with the same moments.

struct Moments {
  double n = 0;  ///< points
  Vec2d mean;
  double xx = 0, xy = 0, yy = 0;  ///< covariance [m2]
  double determinant() const { return xx * yy - xy * xy; }
};

/// Moments without the points farther than 3 standard deviations (a uniform rectangle reaches
/// 2.45); `n` counts all.
Moments trimmed_moments(const std::vector<Vec2d>& points);

/// Coordinates along u and v from an origin.
struct Whitening {
  Vec2d origin, u{1, 0}, v{0, 1};
  Vec2d operator()(Vec2d p) const { return {dot(p - origin, u), dot(p - origin, v)}; }
};

/// The rectangle whose uniform distribution has these moments.
struct Extents {
  Vec2d mean, axis;  ///< axis: unit, of the longer side
  double longer = 0, shorter = 0;
  /// In these coordinates the rectangle is a unit square, so that slits are described as well as
  /// squares.
  Whitening whitening() const {
    return {mean, axis * (1 / longer), Vec2d{-axis.y, axis.x} * (1 / shorter)};
  }
};
/// Needs a point.
Extents extents_of(const std::vector<Vec2d>& points);

// Crossings of light lines with a plane, and their passage through the slab between two parallel
// planes.
//
// Symbols: o a point in the plane, n its unit normal, the way the light goes, (u, v) coordinates in
// the plane along the axes of Onb(n); all lengths in metres.

struct Plane {
  Vec3d o, n;
};

/// The slab between the planes `half` before and `half` behind `middle`; with an outline in the
/// middle it is a tube, the prism that an opening cuts into its wall.
struct Tube {
  Plane middle;
  double half = 0;
};

/// A line relative to a slab: it starts at height `from` above the middle and rises by `along` > 0.
struct Passage {
  double from, along;
  Vec2d start, way;  ///< of the whole line, projected into the middle plane

  /// Its point nearest to the height `offset`, projected: where it passes there, or its end before
  /// that, as on a jamb.
  Vec2d at(double offset) const {
    return start + way * std::clamp((offset - from) / along, 0.0, 1.0);
  }
  /// Whether it passes both faces of a slab of this half thickness.
  bool through(double half) const { return from <= -half && from + along >= half; }
};

/// A slab with its frame, for processing many lines.
class Slab {
 public:
  explicit Slab(const Tube& tube) : tube_(tube), frame_(tube.middle.n) {}

  /// Nothing if the line stays outside or does not run along the normal.
  std::optional<Passage> passage(const LightLine& line) const {
    const Vec3d a = line.light - tube_.middle.o, d = line.camera - line.light;
    const double from = dot(a, tube_.middle.n), along = dot(d, tube_.middle.n);
    if (!(along > 0) || from > tube_.half || from + along < -tube_.half) return {};
    return Passage{
        from, along, {dot(a, frame_.x), dot(a, frame_.y)}, {dot(d, frame_.x), dot(d, frame_.y)}};
  }

 private:
  Tube tube_;
  Onb<double> frame_;
};

/// Where `line` crosses the plane along n.
std::optional<Vec2d> crossing(const Plane& plane, const LightLine& line);
/// The same, but nothing at grazing angles, where the crossing is ill-defined.
std::optional<Vec2d> clear_crossing(const Plane& plane, const LightLine& line);

Vec3d to_space(const Plane& plane, Vec2d at);
/// The inverse, for the foot of the perpendicular from `place`.
Vec2d in_plane(const Plane& plane, const Vec3d& place);

// A portal as a flat shape: its plane, and its triangles within it.

struct PortalShape {
  double area = 0;                 ///< [m2]; 0: all triangles are degenerate, there is no plane
  Plane plane{};                   ///< through the centroid, with the triangles' normal
  std::vector<Polygon> triangles;  ///< in the plane, without degenerate ones
};
PortalShape shape_of(const Portal& portal);

/// Whether some triangle contains `p`, a point of the plane.
bool contains(const PortalShape& shape, Vec2d p);

}  // namespace tdpt
