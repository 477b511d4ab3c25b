#include "libcommon/formats/viewpoint.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/text_lines.h"

namespace tdpt {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kUnit = 1e-6;  // tolerance for unit vectors and right angles

// A portal fits also a camera that is this close to the original one.
constexpr double kSamePlace = 1e-3;           // relative to the scene's size
constexpr double kSameAngle = 0.5 * kDegree;  // of directions and of the field of view

// On one line.
std::string plain(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
  const size_t first = name.find_first_not_of(' ');
  return first == std::string::npos ? ""
                                    : name.substr(first, name.find_last_not_of(' ') + 1 - first);
}

bool is_camera(const Viewpoint& v) {
  const auto unit = [](const Vec3d& w) { return std::abs(dot(w, w) - 1) < kUnit; };
  return unit(v.forward) && unit(v.up) && std::abs(dot(v.forward, v.up)) < kUnit && v.yfov > 0 &&
         v.yfov < std::numbers::pi && v.aspect >= 0;
}

// Between unit vectors [rad]; accurate for small angles.
double angle(const Vec3d& a, const Vec3d& b) {
  return 2 * std::atan2(length(a - b), length(a + b));
}

}  // namespace

Viewpoint viewpoint_of(const Frame& frame, const Camera& camera) {
  return {frame.to_metres(camera.position),
          camera.forward,
          camera.up,
          camera.yfov,
          camera.aspect,
          camera.culls,
          plain(camera.name)};
}

Camera camera_of(const Frame& frame, const Viewpoint& v) {
  return {v.name,
          frame.to_canonical(v.position),
          cross(v.forward, v.up),
          v.up,
          v.forward,
          v.yfov,
          v.aspect,
          v.culls};
}

std::string viewpoint_text(const Viewpoint& v) {
  // Nine digits: more than that is rounding noise of the frame.
  std::string text;
  for (const Vec3d& a : {v.position, v.forward, v.up})
    for (int c = 0; c < 3; ++c) text += fmt::format("{:.9g} ", a[c] + 0.0);  // -0 is 0
  text += fmt::format("{:.9g} {:.9g} {}", v.yfov, v.aspect, v.culls ? "fronts" : "all");
  return v.name.empty() ? text : text + " " + v.name;
}

std::string words_of(const Viewpoint& v) {
  const auto triple = [](const Vec3d& a) {
    return fmt::format("{} {} {}", number_words(a.x + 0.0, 6), number_words(a.y + 0.0, 6),
                       number_words(a.z + 0.0, 6));  // -0 is 0
  };
  std::string words = v.name.empty() ? "" : v.name + ": ";
  words +=
      fmt::format("eye {} m, direction {}, up {}, field of view {} degrees", triple(v.position),
                  triple(v.forward), triple(v.up), number_words(v.yfov / kDegree, 6));
  if (v.aspect > 0) words += fmt::format(", aspect {}", number_words(v.aspect, 6));
  return words + (v.culls ? ", backs are passed (--cull)" : "");
}

std::optional<Viewpoint> parse_viewpoint(std::string_view line) {
  TextLines in(line, "");
  if (!in.next()) return {};
  Viewpoint v;
  try {
    for (Vec3d* to : {&v.position, &v.forward, &v.up})
      for (int c = 0; c < 3; ++c) (*to)[c] = in.real("");
    v.yfov = in.real("");
    v.aspect = in.real("");
  } catch (const InputError&) {
    return {};
  }
  const std::string_view sides = in.word();
  v.culls = sides == "fronts";
  v.name = plain(std::string(in.rest()));
  if (!(v.culls || sides == "all") || !is_camera(v)) return {};
  return v;
}

std::string words_of_difference(const Viewpoint& made_for, const Viewpoint& used, double size) {
  std::vector<std::string> words;
  const double away = length(used.position - made_for.position);
  if (away > kSamePlace * size) words.push_back(fmt::format("{} m away", number_words(away, 2)));
  const double turned =
      std::max(angle(used.forward, made_for.forward), angle(used.up, made_for.up));
  if (turned > kSameAngle)
    words.push_back(fmt::format("turned by {:.0f} degrees", turned / kDegree));
  if (std::abs(used.yfov - made_for.yfov) > kSameAngle)
    words.push_back(fmt::format("of {} in the place of {} degrees",
                                number_words(used.yfov / kDegree),
                                number_words(made_for.yfov / kDegree)));
  if (used.culls != made_for.culls)
    words.push_back(used.culls ? "passing backs (--cull)" : "not passing backs (--cull)");
  return fmt::format("{}", fmt::join(words, " and "));
}

}  // namespace tdpt
