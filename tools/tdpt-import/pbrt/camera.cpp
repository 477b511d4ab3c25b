// Cameras and films, by pbrt-v3's cameras/perspective.cpp and film.cpp, and pbrt-v4's cameras.cpp
// and film.cpp.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/pbrt/pbrt.h"

namespace tdpt::foreign::pbrt {
namespace {

struct Window {
  double x0, x1, y0, y1;
};

// Part of the film that is kept, in pixels from its top left.
struct Film {
  int width, height;
  Window kept;
};

Film read_film(const Entity& e, double exposure_time) {
  constexpr int kMostPixels = 65536;  // of one side
  Film f{e.integer("xresolution", 1280), e.integer("yresolution", 720), {}};
  if (f.width < 1 || f.height < 1 || f.width > kMostPixels || f.height > kMostPixels)
    e.fail("a picture of {} x {} pixels", f.width, f.height);
  f.kept = {0, static_cast<double>(f.width), 0, static_cast<double>(f.height)};
  if (const double* crop = e.numbers("cropwindow", {"float"}, 4)) {
    const auto at = [](double share, int size) {
      return std::ceil(std::clamp(share, 0.0, 1.0) * size);
    };
    const auto [x0, x1] = std::minmax(crop[0], crop[1]);
    const auto [y0, y1] = std::minmax(crop[2], crop[3]);
    f.kept = {at(x0, f.width), at(x1, f.width), at(y0, f.height), at(y1, f.height)};
  }
  if (const double* p = e.numbers("pixelbounds", {"integer"}, 4))
    f.kept = {std::clamp(p[0], 0.0, f.kept.x1), std::clamp(p[1], 0.0, f.kept.x1),
              std::clamp(p[2], 0.0, f.kept.y1), std::clamp(p[3], 0.0, f.kept.y1)};
  if (!(f.kept.x1 > f.kept.x0 && f.kept.y1 > f.kept.y0))
    e.fail("the part of the film that is kept is empty");
  const double scale =
      e.context.v4 ? exposure_time * e.number("iso", 100) / 100 : e.number("scale", 1);
  if (std::abs(scale - 1) > 1e-6)
    e.lose("the film's exposure, which multiplies the picture by {:.6g}, is left out", scale);
  e.ignore({"coordinatesystem", "diagonal", "filename", "lambdamax", "lambdamin", "nbuckets",
            "savefp16"});  // of the file that is written
  return f;
}

}  // namespace

void add_camera(const Entity& e, const Entity& film_entity, const Affine& from_world) {
  const double open = e.number("shutteropen", 0), close = e.number("shutterclose", 1);
  const Film film = read_film(film_entity, std::abs(close - open));
  if (e.kind != "perspective") {
    e.lose("the camera \"{}\" is left out, as only perspective ones can be written", shown(e.kind));
    return e.ignore();
  }
  const double aspect = static_cast<double>(film.width) / film.height;
  const double frame = e.number("frameaspectratio", aspect);
  if (!(frame > 0)) e.fail("the frame's aspect ratio is not above 0");
  Window screen = frame > 1 ? Window{-frame, frame, -1, 1} : Window{-1, 1, -1 / frame, 1 / frame};
  if (const double* w = e.numbers("screenwindow", {"float"}, 4)) {
    if (!(w[1] > w[0] && w[3] > w[2]))
      e.fail("the screen window must be two growing pairs of numbers");
    screen = {w[0], w[1], w[2], w[3]};
  }
  double fov = e.number("fov", 90);
  if (const double half = e.number("halffov", -1); half > 0) fov = 2 * half;
  if (!(fov > 0 && fov < 180)) e.fail("the field of view is not in 0 to 180");
  const double reach = std::tan(fov * std::numbers::pi / 360);
  const double per_x = (screen.x1 - screen.x0) / film.width;
  const double per_y = (screen.y1 - screen.y0) / film.height;
  if (std::abs(per_x / per_y - 1) > 1e-3) e.lose("pixels that are not square become so");
  const Window kept{screen.x0 + film.kept.x0 * per_x, screen.x0 + film.kept.x1 * per_x,
                    screen.y1 - film.kept.y1 * per_y, screen.y1 - film.kept.y0 * per_y};

  Camera camera;
  camera.name = "camera";
  camera.width = static_cast<int>(film.kept.x1 - film.kept.x0);
  camera.height = static_cast<int>(film.kept.y1 - film.kept.y0);
  camera.yfov = 2 * std::atan(reach * (kept.y1 - kept.y0) / 2);
  const auto shift = [](double low, double high) {
    const double share = (low + high) / (high - low);
    return std::abs(share) < 1e-9 ? 0 : share;
  };
  camera.shift_x = shift(kept.x0, kept.x1);
  camera.shift_y = shift(kept.y0, kept.y1);

  const auto [x, y, z, at] = inverse(from_world, e.place);
  const double scale = length(z);
  if (std::abs(length(x) / scale - 1) > 1e-3 || std::abs(length(y) / scale - 1) > 1e-3 ||
      std::abs(dot(x, y)) + std::abs(dot(y, z)) + std::abs(dot(z, x)) > 1e-3 * scale * scale)
    e.lose("the camera's transformation stretches the picture");
  camera.to_world = {normalize(x), normalize(y), normalize(z) * -1.0, at};
  camera.lens_radius = std::max(e.number("lensradius", 0), 0.0) * scale;
  camera.focus_distance = std::max(e.number("focaldistance", 1e6), 0.0) * scale;
  e.context.scene.cameras.push_back(camera);
}

}  // namespace tdpt::foreign::pbrt
