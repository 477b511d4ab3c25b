// A sheet with the views of a scene: from its camera, and the plan of each storey.
#pragma once
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "libcommon/draw/plan.h"
#include "libcommon/draw/sheet.h"
#include "libcommon/formats/cut.h"
#include "libcommon/scene/scene.h"

namespace tdpt::draw {

class SceneSheet {
 public:
  /// The plans are those of the storeys with the camera and with many of `places` [metres]; of a
  /// scene without storeys there is one, at the mean height of the places, or the camera's.
  /// `legend`: height reserved below the panels. Keeps references.
  SceneSheet(const Scene& scene, const Camera& camera, const std::string& title,
             const std::string& sentence, const std::vector<Vec3d>& places, double legend);

  /// First the surfaces...
  void paint(const Colouring& colour);
  /// ...then lines over them (metres), in the plans as far as they are within the storey...
  void line(const Vec3d& a, const Vec3d& b, double width, const Ink& c, double alpha);
  void dot(const Vec3d& place, double radius, const Ink& c, double alpha);
  /// ...finally marks, captions and scale. Moves the drawing out: the sheet is then unusable.
  Canvas finish();

  Canvas& canvas() { return canvas_; }
  /// Area of the legend.
  const Box& legend() const { return legend_; }
  const SceneView& camera_view() const { return camera_view_; }
  /// The camera's storey first.
  const std::vector<Plan>& plans() const { return plans_; }

 private:
  struct Layout {
    std::vector<Storey> storeys;
    Extent extent;
    Box camera, legend;
    std::vector<Box> plans;
  };
  static Layout layout(const Scene& scene, const Camera& camera, const Tracer& tracer,
                       const std::vector<Vec3d>& places, double legend);

  const Scene& scene_;
  const Camera& camera_;
  Tracer tracer_;
  Layout layout_;
  Canvas canvas_;
  SceneView camera_view_;
  std::vector<Plan> plans_;
  Box legend_;
};

class PatchLookup {
 public:
  PatchLookup(const Frame& frame, const PatchGrid& grid, const std::vector<Patch>& patches);

  /// Index of the patch that contains canonical `place` on face 2 * triangle + side; empty if there
  /// is none (no walk has reached this surface).
  std::optional<uint32_t> at(uint32_t face, const Vec3d& place) const;

 private:
  struct Key {
    uint32_t face;
    int level;
    std::array<int32_t, 3> cell;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    size_t operator()(const Key& k) const;
  };

  Frame frame_;
  PatchGrid grid_;
  std::vector<int> levels_;  // levels in use, finest first
  std::unordered_map<Key, uint32_t, Hash> patch_;
};

}  // namespace tdpt::draw
