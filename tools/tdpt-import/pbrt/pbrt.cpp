#include "tools/tdpt-import/pbrt/builder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <numbers>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/pbrt/context.h"

namespace tdpt::foreign::pbrt {
namespace {

constexpr size_t kMostShapes = 1000000;
constexpr size_t kDeepest = 10000;

bool is_finite(const Affine& a) {
  return tdpt::is_finite(a.x) && tdpt::is_finite(a.y) && tdpt::is_finite(a.z) &&
         tdpt::is_finite(a.t);
}

}  // namespace

Builder::Builder(Source& source, bool is_v4)
    : context_(source, is_v4), tokens_(source.text(), source.path()) {
  Surface grey{diffuse({Rgb(0.5f), {}, {}})};
  grey.material.name = "default";
  state_.surface = painter_.add(std::move(grey));
  context_.scene.title = std::filesystem::path(source.path()).stem().string();
}

Described Builder::run() {
  while (!is_done_) {
    std::optional<Token> token = tokens_.next();
    end_imports();
    if (!token) break;
    const Place place = tokens_.place();
    if (token->kind != Token::Kind::word)
      Source::fail(place, fmt::format("\"{}\" where a directive should be", shown(token->text)));
    const Directive* directive = directive_of(token->text);
    if (!directive)
      Source::fail(place, fmt::format("\"{}\" is not a directive", shown(token->text)));
    directive_ = whose_ = directive->name;
    directive->run(*this);
  }
  if (context_.v4 && !saved_.empty())
    Source::fail(saved_.back().place, "what begins here does not end");
  if (!in_world_ && context_.scene.shapes.empty())
    Source::fail({context_.source.path(), ""}, "no WorldBegin: this is no scene of pbrt");
  finish_camera();
  return std::move(context_.scene);
}

std::string Builder::name() {
  const std::optional<Token> token = tokens_.next();
  if (!token || token->kind != Token::Kind::quoted)
    Source::fail(tokens_.place(), "a name in quotes should follow");
  whose_ = fmt::format("{} \"{}\"", directive_, shown(token->text));
  return token->text;
}

double Builder::number() {
  const std::optional<Token> token = tokens_.next();
  if (!token) Source::fail(tokens_.place(), "the file ends where a number should follow");
  return number_of(*token, tokens_.place());
}

std::vector<double> Builder::numbers(size_t count) {
  std::optional<Token> token = tokens_.next();
  const bool in_brackets = token && token->kind == Token::Kind::open;
  if (token && !in_brackets) tokens_.back(std::move(*token));
  std::vector<double> out;
  while (out.size() < count) out.push_back(number());
  if (in_brackets) {
    token = tokens_.next();
    if (!token || token->kind != Token::Kind::close)
      Source::fail(tokens_.place(), fmt::format("a ']' should follow the {} numbers", count));
  }
  return out;
}

Parameters Builder::parameters(size_t attribute, const Key& holder) {
  Parameters list = parameters(holder);
  if (const auto& defaults = state_.attributes[attribute]) list.defaults(*defaults);
  return list;
}

void Builder::set_transform(const Affine& to) {
  if (!state_.is_active) {
    context_.source.lose(tokens_.place(),
                         "movement is left out: the transformations at the start are kept");
    return;
  }
  if (!is_finite(to)) Source::fail(tokens_.place(), "the transformation is too large");
  state_.to_world = to;
}

void Builder::transform(const Affine& by) {
  set_transform(state_.to_world * by);
}

void Builder::save(Saved kind) {
  if (saved_.size() >= kDeepest)
    Source::fail(tokens_.place(), fmt::format("more than {} states are saved", kDeepest));
  saved_.push_back({kind, state_, tokens_.place(), tokens_.depth()});
}

void Builder::restore(Saved kind, const char* directive) {
  if (saved_.empty() || saved_.back().kind != kind)
    Source::fail(tokens_.place(), fmt::format("\"{}\" without its beginning", directive));
  const State& before = saved_.back().state;
  if (kind == Saved::transform) {
    state_.to_world = before.to_world;
    state_.is_active = before.is_active;
  } else {
    state_ = before;
  }
  saved_.pop_back();
}

// An imported file ends when a token of the file that imported it comes.
void Builder::end_imports() {
  while (!saved_.empty()) {
    const Save* import = nullptr;
    for (auto s = saved_.rbegin(); s != saved_.rend() && !import; ++s)
      if (s->kind == Saved::import) import = &*s;
    if (!import || tokens_.depth() > import->depth) return;
    if (saved_.back().kind != Saved::import)
      Source::fail(saved_.back().place, "what begins here does not end in the imported file");
    restore(Saved::import, "Import");
  }
}

namespace {

// ---- Cameras and films ----

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

// Adds the camera to the scene, or names it as lost. `from_world`: the transformation at the
// directive "Camera".
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

}  // namespace

void Builder::finish_camera() {
  Entity camera =
      camera_ ? *camera_ : Entity{"perspective", Parameters({context_.source.path(), ""})};
  Entity film =
      film_ ? *film_
            : Entity{context_.v4 ? "rgb" : "image", Parameters({context_.source.path(), ""})};
  add_camera(context_, camera.kind, camera.list, camera_from_world_, film.kind, film.list);
}

// pbrt-v4 gives every triangle of a mesh the whole power.
std::optional<Emission> Builder::emission(const Geometry& geometry, const Affine& to_world) {
  if (!state_.area) return {};
  Emission e = state_.area->emission;
  if (state_.area->power > 0) {
    const double area = area_of(context_.scene.meshes[geometry.mesh],
                                geometry.is_mesh ? to_world : geometry.to_object);
    if (geometry.faces > 2)
      context_.source.lose(tokens_.place(),
                           "an area light's power, the same of every face, is "
                           "spread evenly over its mesh");
    const double factor = state_.area->power * static_cast<double>(geometry.faces) /
                          (std::numbers::pi * area * (e.both_sides ? 2 : 1));
    if (!std::isfinite(factor)) return {};
    e.radiance.factor = e.radiance.factor * static_cast<float>(factor);
  }
  if (max_component(e.radiance.factor) <= 0) return {};
  return e;
}

void Builder::add_shape(const std::string& kind, const Parameters& list) {
  const std::optional<Geometry> geometry = geometries_.read(context_, kind, list);
  if (!geometry || context_.scene.meshes[geometry->mesh].triangles.empty())
    return list.ignore_all();
  Shape shape;
  shape.name = geometry->name;
  shape.mesh = geometry->mesh;
  shape.to_world = state_.to_world * geometry->to_object;
  if (!is_finite(shape.to_world)) Source::fail(list.place, "the transformation is too large");
  painter_[state_.surface].key.take();
  shape.material =
      painter_.material(context_, textures_, state_.surface, list, state_.inside, state_.outside);
  const bool is_body_turned = painter_[state_.surface].turned;
  shape.turned = state_.is_reversed != is_body_turned;
  if (state_.area && object_)
    context_.source.lose(list.place,
                         "the light of shapes of an object with instances is left out, as in pbrt");
  else
    shape.emission = emission(*geometry, shape.to_world);
  if (shape.emission && is_body_turned && !shape.emission->both_sides) {
    context_.source.lose(list.place, "the side from which a body of glass emits light is not kept");
    shape.emission->both_sides = true;
  }
  if (list.number("shadowalpha", 1) == 0 || !list.texture("shadowalpha").empty())
    context_.source.lose(list.place, "an alpha that counts for shadows alone is left out");
  keep(std::move(shape));
}

void Builder::keep(Shape&& shape) {
  if (++shapes_ > kMostShapes)
    Source::fail(tokens_.place(), fmt::format("more than {} shapes", kMostShapes));
  (object_ ? objects_[*object_] : context_.scene.shapes).push_back(std::move(shape));
}

namespace {

// ---- The version: pbrt-v3 or pbrt-v4 ----

// What only one of the two knows; a film or a material tells by its kind, a parameter by its type.
constexpr std::string_view kWordsV3[] = {"WorldEnd"};
constexpr std::string_view kWordsV4[] = {"Attribute", "ColorSpace", "Import",
                                         "Option",    "true",       "false"};
constexpr std::string_view kKindsV3[] = {"image",     "matte",       "plastic",      "uber",
                                         "substrate", "translucent", "glass",        "mirror",
                                         "metal",     "disney",      "kdsubsurface", "fourier"};
constexpr std::string_view kKindsV4[] = {
    "rgb",       "gbuffer",         "spectral",   "diffuse",        "coateddiffuse",
    "conductor", "coatedconductor", "dielectric", "thindielectric", "diffusetransmission",
    "measured",  "interface"};
constexpr std::string_view kTypesV3[] = {"point ", "vector ", "color ", "xyz "};

template <size_t n>
bool holds(const std::string_view (&list)[n], std::string_view word) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}
template <size_t n>
bool starts_with_any(const std::string_view (&list)[n], std::string_view word) {
  return std::any_of(std::begin(list), std::end(list),
                     [&](std::string_view s) { return word.starts_with(s); });
}

bool is_v4(const Source& source) {
  Tokens tokens(source.text(), source.path());
  size_t v3 = 0, v4 = 0;
  std::string before;  // of a token that may name a kind
  while (const std::optional<Token> token = tokens.next()) {
    const std::string& t = token->text;
    if (token->kind == Token::Kind::word) {
      v3 += holds(kWordsV3, t);
      v4 += holds(kWordsV4, t);
    } else if (token->kind == Token::Kind::quoted) {
      if (before == "Film" || before == "Material" || before == "string type") {
        v3 += holds(kKindsV3, t);
        v4 += holds(kKindsV4, t);
      }
      v3 += starts_with_any(kTypesV3, t);
    }
    if (token->kind != Token::Kind::open) before = t;
  }
  return v4 >= v3;
}

}  // namespace
}  // namespace tdpt::foreign::pbrt

namespace tdpt::foreign {

Described read_pbrt(Source& source) {
  return pbrt::Builder(source, pbrt::is_v4(source)).run();
}

}  // namespace tdpt::foreign
