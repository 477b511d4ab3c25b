// The plan of a storey, as architects draw it: what is cut at eye height is dark, what lies below
// is seen from above. x runs to the right, z down. Places are in metres.
#pragma once
#include <string>
#include <vector>

#include "libcommon/draw/scene_view.h"
#include "libcommon/draw/section.h"
#include "libcommon/draw/storeys.h"

namespace tdpt::draw {

/// The part of the plane that the plans of these storeys show, each the same: their extents, and
/// the `places` that are not far away.
struct Extent {
  double low_x = 0, low_z = 0, high_x = 1, high_z = 1;
  double aspect() const { return (high_x - low_x) / (high_z - low_z); }
};
Extent extent_of(const std::vector<Storey>& storeys, const std::vector<Vec3d>& places);

/// A portal, or what could have been one.
struct Opening {
  std::vector<Vec3d> outline;
  Vec3d way{};        ///< unit normal; of a portal the way of the light
  std::string label;  ///< beside it, with a line that leads to it; empty: none
  bool refused = false;
};

class Plan {
 public:
  /// Room below a panel for caption and scale [pixels].
  static constexpr double kCaptionRoom = 44;

  /// Keeps references. The extent lies in the middle of `panel`, which shows what is around it too.
  Plan(Canvas& canvas, const Scene& scene, const Tracer& tracer, Storey storey,
       const Extent& extent, const Box& panel);

  /// Surfaces below the cut, what is cut, and lamps...
  void paint(const Colouring& colour, const Ink& nothing);
  /// ...then what lies over them, as far as it is within the storey...
  void line(const Vec3d& a, const Vec3d& b, double width, const Ink& c, double alpha);
  void dot(const Vec3d& place, double radius, const Ink& c, double alpha);
  void openings(const std::vector<Opening>& openings);
  void camera(const Camera& camera);
  /// ...finally labels, frame, caption, axes and scale.
  void finish();

  const Storey& storey() const { return storey_; }
  const Projection& projection() const { return view_.projection(); }
  bool holds(const Vec3d& place) const {
    return place.y >= storey_.bottom && place.y < storey_.top;
  }
  /// Whether a fifth of an outline's height is.
  bool holds(const std::vector<Vec3d>& outline) const;

 private:
  struct Label {
    Point at;
    std::string words;
    Ink ink;
  };
  Point project(const Vec3d& place) const;
  void darken_solid(Raster& seen);
  bool within_earth(const Segment& s) const;
  void draw_section();
  void draw_axes(Point corner);
  void draw_lamps();
  void draw_labels();

  Canvas& canvas_;
  const Scene& scene_;
  Storey storey_;
  const Tracer& tracer_;
  std::vector<Segment> section_;
  SceneView view_;
  CellGrid grid_;
  std::vector<Filled> cells_;
  std::vector<Label> labels_;
  std::vector<Box> taken_;  ///< by marks and labels
};

}  // namespace tdpt::draw
