// A sheet with two views of a scene: from its camera, and a plan with everything above a cut
// removed.
#pragma once
#include <string>

#include "libcommon/draw/scene_view.h"
#include "libcommon/draw/sheet.h"

namespace tdpt::draw {

class SceneSheet {
 public:
  /// `cut`: height of the plan [metres]; outside the scene, its middle height is used. `legend`:
  /// height reserved below the panels. Keeps a reference to `scene`.
  SceneSheet(const Scene& scene, const Camera& camera, const std::string& title,
             const std::string& sentence, double cut, double legend);

  /// First the surfaces, with camera and lamps as marks in the plan...
  void paint(const Colouring& colour);
  /// ...then lines over them (metres)...
  void line(const Vec3d& a, const Vec3d& b, double width, const Ink& c, double alpha);
  void dot(const Vec3d& place, double radius, const Ink& c, double alpha);
  /// ...finally marks, captions and scale. Moves the drawing out: the sheet is then unusable.
  Canvas finish();

  Canvas& canvas() { return canvas_; }
  /// Area of the legend.
  const Box& legend() const { return legend_; }
  const SceneView& camera_view() const { return camera_view_; }
  const SceneView& plan() const { return plan_; }

 private:
  struct Layout {
    Box camera, plan, legend;
    double cut;  // canonical height
    int height;
  };
  static Layout layout(const Scene& scene, const Camera& camera, double cut, double legend);
  SceneSheet(const Scene& scene, const Camera& camera, const std::string& title,
             const std::string& sentence, const Layout& where);
  void mark_lamps();
  void mark_camera();

  const Scene& scene_;
  const Camera& camera_;
  double cut_;
  Tracer tracer_;
  Canvas canvas_;
  SceneView camera_view_, plan_;
  Box legend_;
};

}  // namespace tdpt::draw
