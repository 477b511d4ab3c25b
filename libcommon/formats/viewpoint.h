// Which camera a file was made for, in one line of text that a network hands on to its cut, its
// grid and its portals. Grammar: man 5 max.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "libcommon/scene/scene.h"

namespace tdpt {

/// A camera in the metres and axes of the scene's file.
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
/// The same for people: place, direction and up in three numbers each, the angle in degrees.
std::string words_of(const Viewpoint& viewpoint);
/// Nothing where the line is none: too few numbers, none that a camera has, or neither `all` nor
/// `fronts` behind them.
std::optional<Viewpoint> parse_viewpoint(std::string_view line);
inline constexpr const char* kViewpointExpected =
    "expected a place, a direction, a direction up, an angle, an aspect, all or fronts, and a name";

/// How far `used` is from `made_for`, in words: "2.1 m away and turned by 35 degrees"; empty where
/// both show the same. `size`: of the scene [m].
std::string words_of_difference(const Viewpoint& made_for, const Viewpoint& used, double size);

}  // namespace tdpt
