// Renders a scene in a panel of a canvas, in perspective or orthographic projection: surfaces in
// colours given by the caller, with light shading and dark edges; lines and points over them, paler
// where hidden.
#pragma once
#include <functional>

#include "libcommon/draw/canvas.h"
#include "libcommon/scene/scene.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::draw {

/// Maps canonical points to pixels of `panel`. `forward`, `right`, `up` are unit and orthogonal.
struct Projection {
  Box panel;
  Vec3d eye, right, up, forward;
  double half_width = 1;  ///< half the panel's width: in perspective at distance 1, else canonical
  bool pinhole = true;

  /// Shows the camera's whole vertical angle; the panel should have its aspect.
  static Projection of_camera(const Camera& camera, const Box& panel);
  /// Orthographic along unit `forward`, with `middle` at the panel's centre; the plane through
  /// `middle` clips what is behind it.
  static Projection flat(const Vec3d& middle, const Vec3d& right, const Vec3d& up,
                         double half_width, const Box& panel);

  double pixels_per_unit() const { return 0.5 * panel.width / half_width; }
  /// Distance from the eye along forward.
  double depth(const Vec3d& place) const { return dot(place - eye, forward); }
  /// Undefined in perspective if depth() <= 0.
  Point project(const Vec3d& place) const;
  /// Origin and unit direction of the ray through a point of the canvas.
  void ray(const Point& at, Vec3d& from, Vec3d& w) const;
};

/// Colour of a surface at `place` (canonical) on face 2 * triangle + side.
using Colouring = std::function<Ink(uint32_t face, const Vec3d& place)>;

class SceneView {
 public:
  /// Keeps references.
  SceneView(Canvas& canvas, const Tracer& tracer, const Projection& projection);

  const Projection& projection() const { return projection_; }

  /// Four rays per pixel; `nothing` where there is no surface. `over` may change the pixels of the
  /// panel before they are drawn.
  void paint(const Colouring& colour, const Ink& nothing,
             const std::function<void(Raster&)>& over = {});

  /// Canonical end points. `hidden`: factor of alpha where a surface occludes the line.
  void line(const Vec3d& a, const Vec3d& b, double width, const Ink& c, double alpha = 1,
            double hidden = 0.3);
  void dot_at(const Vec3d& place, double radius, const Ink& c, double alpha = 1,
              double hidden = 0.3);
  /// Whether a point is unoccluded; only after paint().
  bool in_sight(const Vec3d& place) const;

 private:
  struct Sample {
    Vec3f place, normal;  ///< normal 0: no surface
  };
  void darken_edges(Raster& seen) const;
  bool hides(const Point& at, double depth) const;

  Canvas& canvas_;
  const Tracer& tracer_;
  Projection projection_;
  int left_, top_, columns_, rows_;
  std::vector<Sample> samples_;
};

}  // namespace tdpt::draw
