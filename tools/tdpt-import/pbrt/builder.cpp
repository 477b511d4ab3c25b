#include "tools/tdpt-import/pbrt/builder.h"

#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/pbrt/camera.h"
#include "tools/tdpt-import/pbrt/directives.h"
#include "tools/tdpt-import/pbrt/transforms.h"

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

}  // namespace tdpt::foreign::pbrt
