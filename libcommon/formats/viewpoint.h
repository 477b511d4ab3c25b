// The camera that a file was made for, as one line of text that is passed from network to cut, grid
// and portals. Grammar: man 5 max.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "libcommon/scene/scene.h"

namespace tdpt {

/// A camera in metres and in the axes of the scene's file.
struct Viewpoint {
  Vec3d position{}, forward{}, up{};  ///< metres; unit
  double yfov = 0;                    ///< full vertical angle [rad]
  double aspect = 0;                  ///< width / height; 0: unknown
  bool culls = false;                 ///< Camera::culls
  std::string name;
};

Viewpoint viewpoint_of(const Frame& frame, const Camera& camera);
Camera camera_of(const Frame& frame, const Viewpoint& viewpoint);

std::string viewpoint_text(const Viewpoint& viewpoint);
inline std::string viewpoint_text(const Frame& frame, const Camera& camera) {
  return viewpoint_text(viewpoint_of(frame, camera));
}
/// The same for people: position, direction and up as three numbers each, the angle in degrees.
std::string words_of(const Viewpoint& viewpoint);
/// Empty if the line is malformed: too few numbers, numbers that no camera has, or neither `all`
/// nor `fronts` after them.
std::optional<Viewpoint> parse_viewpoint(std::string_view line);
inline constexpr const char* kViewpointExpected =
    "expected a place, a direction, a direction up, an angle, an aspect, all or fronts, and a name";

/// How `used` differs from `made_for`: "2.1 m away and turned by 35 degrees"; empty if both show
/// the same. `size`: of the scene [m].
std::string words_of_difference(const Viewpoint& made_for, const Viewpoint& used, double size);

}  // namespace tdpt
