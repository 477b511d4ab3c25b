// pbrt's camera looks along +z, +x right, +y up. Its screen is at distance 1 / tan(fov / 2), and is
// [-1, 1] along the shorter side of the picture, or "screenwindow": x0 x1 y0 y1.
#include "tools/tdpt-import/pbrt/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/pbrt/transforms.h"

namespace tdpt::foreign::pbrt {
namespace {

constexpr int kMostPixels = 65536;  // of one side

struct Box {
  double x0, x1, y0, y1;
};

// Part of the film that is kept, in pixels from its top left.
struct Film {
  int width, height;
  Box kept;
};

Film read_film(Context& context, const std::string& kind, const Parameters& list,
               double exposure_time) {
  Film f{list.integer("xresolution", 1280), list.integer("yresolution", 720), {}};
  if (f.width < 1 || f.height < 1 || f.width > kMostPixels || f.height > kMostPixels)
    Source::fail(list.place, fmt::format("a picture of {} x {} pixels", f.width, f.height));
  f.kept = {0, static_cast<double>(f.width), 0, static_cast<double>(f.height)};
  if (const std::vector<double>* crop = list.floats("cropwindow"); crop && crop->size() == 4) {
    const auto at = [](double share, int size) {
      return std::ceil(std::clamp(share, 0.0, 1.0) * size);
    };
    const auto [x0, x1] = std::minmax((*crop)[0], (*crop)[1]);
    const auto [y0, y1] = std::minmax((*crop)[2], (*crop)[3]);
    f.kept = {at(x0, f.width), at(x1, f.width), at(y0, f.height), at(y1, f.height)};
  }
  if (const std::vector<double>* pixels = list.integers("pixelbounds");
      pixels && pixels->size() == 4)
    f.kept = {std::clamp((*pixels)[0], 0.0, f.kept.x1), std::clamp((*pixels)[1], 0.0, f.kept.x1),
              std::clamp((*pixels)[2], 0.0, f.kept.y1), std::clamp((*pixels)[3], 0.0, f.kept.y1)};
  if (!(f.kept.x1 > f.kept.x0 && f.kept.y1 > f.kept.y0))
    Source::fail(list.place, "the part of the film that is kept is empty");
  double scale = 1;
  if (context.v4) {
    scale = exposure_time * list.number("iso", 100) / 100;
    const std::string sensor = list.text("sensor", "cie1931");
    if (sensor != "cie1931" || list.number("whitebalance", 0) != 0)
      context.source.lose(
          list.place, "the film's sensor and white balance, which change colours, are left out");
  } else {
    scale = list.number("scale", 1);
  }
  if (std::abs(scale - 1) > 1e-6)
    context.source.lose(list.place, fmt::format("the film's exposure, which multiplies the picture "
                                                "by {:.6g}, is left out",
                                                scale));
  if (kind != "image" && kind != "rgb" && kind != "gbuffer" && kind != "spectral")
    context.source.lose(list.place, fmt::format("the film \"{}\" is not known", shown(kind)));
  for (const char* limit : {"maxcomponentvalue", "maxsampleluminance"})
    if (list.number(limit, HUGE_VAL) < 1e30)
      context.source.lose(list.place, "the film's limit on bright samples is left out");
  list.ignore({"coordinatesystem", "diagonal", "filename", "lambdamax", "lambdamin", "nbuckets",
               "savefp16"});  // of the file that is written
  return f;
}

}  // namespace

void add_camera(Context& context, const std::string& kind, const Parameters& list,
                const Affine& from_world, const std::string& film_kind,
                const Parameters& film_list) {
  const double open = list.number("shutteropen", 0), close = list.number("shutterclose", 1);
  const Film film = read_film(context, film_kind, film_list, std::abs(close - open));
  if (kind != "perspective") {
    context.source.lose(list.place,
                        fmt::format("the camera \"{}\" is left out, as only perspective ones "
                                    "can be written",
                                    shown(kind)));
    return list.ignore_all();
  }
  const double aspect = static_cast<double>(film.width) / film.height;
  const double frame = list.number("frameaspectratio", aspect);
  if (!(frame > 0)) Source::fail(list.place, "the frame's aspect ratio is not above 0");
  Box screen = frame > 1 ? Box{-frame, frame, -1, 1} : Box{-1, 1, -1 / frame, 1 / frame};
  if (const std::vector<double>* w = list.floats("screenwindow")) {
    if (w->size() != 4 || !((*w)[1] > (*w)[0]) || !((*w)[3] > (*w)[2]))
      Source::fail(list.place, "the screen window must be two growing pairs of numbers");
    screen = {(*w)[0], (*w)[1], (*w)[2], (*w)[3]};
  }
  double fov = list.number("fov", 90);
  if (const double half = list.number("halffov", -1); half > 0) fov = 2 * half;
  if (!(fov > 0 && fov < 180)) Source::fail(list.place, "the field of view is not in 0 to 180");
  const double reach = std::tan(fov * std::numbers::pi / 360);
  const double per_x = (screen.x1 - screen.x0) / film.width;
  const double per_y = (screen.y1 - screen.y0) / film.height;
  if (std::abs(per_x / per_y - 1) > 1e-3)
    context.source.lose(list.place, "pixels that are not square become so");
  const Box kept{screen.x0 + film.kept.x0 * per_x, screen.x0 + film.kept.x1 * per_x,
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

  const Affine to_world = inverse(from_world, list.place);
  const double scale = length(to_world.z);
  if (std::abs(length(to_world.x) / scale - 1) > 1e-3 ||
      std::abs(length(to_world.y) / scale - 1) > 1e-3 ||
      std::abs(dot(to_world.x, to_world.y)) + std::abs(dot(to_world.y, to_world.z)) +
              std::abs(dot(to_world.z, to_world.x)) >
          1e-3 * scale * scale)
    context.source.lose(list.place, "the camera's transformation stretches the picture");
  camera.to_world.x = normalize(to_world.x);
  camera.to_world.y = normalize(to_world.y);
  camera.to_world.z = normalize(to_world.z) * -1.0;
  camera.to_world.t = to_world.t;
  camera.lens_radius = std::max(list.number("lensradius", 0), 0.0) * scale;
  camera.focus_distance = std::max(list.number("focaldistance", 1e6), 0.0) * scale;
  context.scene.cameras.push_back(camera);
}

}  // namespace tdpt::foreign::pbrt
