// The directives of a scene, and whether it is one of pbrt-v3 or pbrt-v4.
#include "tools/tdpt-import/pbrt/pbrt.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <numbers>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"

namespace tdpt::foreign::pbrt {
namespace {

// Carries out directives.
struct Builder {
  enum class Scope { attributes, transform, object, import };
  struct SavedState {
    Scope kind;
    State state;
    Place place;
  };

  Context context;
  Tokens* tokens = nullptr;          // of the file that is read
  size_t open_files = 0, files = 0;  // now; so far
  std::string directive{}, owner{};  // that is carried out; with the last name after it
  State state{};
  std::vector<SavedState> saved{};
  std::map<std::string, Affine> systems{};  // CoordinateSystem
  std::map<std::string, std::vector<Shape>> objects{};
  std::optional<std::string> object{};  // being defined
  size_t shapes = 0;
  std::optional<Entity> camera{}, film{};
  Affine camera_from_world{};
  bool in_world = false, is_done = false;

  template <class... A>
  void lose(fmt::format_string<const A&...> sentence, const A&... values) {
    context.source.lose(tokens->place(), fmt::format(sentence, values...));
  }

  // ---- Of the tokens that follow ----

  std::string name() {
    const Token token = tokens->next();
    if (token.kind != Token::Kind::quoted) tokens->fail("a name in quotes should follow");
    owner = fmt::format("{} \"{}\"", directive, shown(token.text));
    return token.text;
  }
  std::vector<double> numbers(size_t count) {
    const bool in_brackets = tokens->peek().kind == Token::Kind::open;
    if (in_brackets) tokens->next();
    std::vector<double> out;
    while (out.size() < count) out.push_back(tokens->number_of(tokens->next()));
    if (in_brackets && tokens->next().kind != Token::Kind::close)
      tokens->fail("a ']' should follow the {} numbers", count);
    return out;
  }
  Vec3d vector() {
    const std::vector<double> v = numbers(3);
    return {v[0], v[1], v[2]};
  }
  Affine matrix() {
    const std::vector<double> m = numbers(16);  // column by column
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] == 0)
      tokens->fail("a transformation with perspective");
    const auto column = [&](size_t i) { return Vec3d(m[i], m[i + 1], m[i + 2]) / m[15]; };
    return {column(0), column(4), column(8), column(12)};
  }
  // About an axis; a zero axis turns nothing.
  Affine rotation() {
    const std::vector<double> v = numbers(4);
    const Vec3d axis(v[1], v[2], v[3]);
    const double l = length(axis), half = v[0] * std::numbers::pi / 360;
    if (!(l > 0)) return {};
    const double s = std::sin(half) / l;
    return affine_of({}, {axis.x * s, axis.y * s, axis.z * s, std::cos(half)}, Vec3d(1)).value();
  }
  // From the world to a camera that looks along +z.
  Affine view() {
    const Vec3d from = vector(), at = vector(), up = vector();
    const Vec3d along = at - from, side = cross(up, along);
    if (!(length(side) > 1e-12 * length(up) * length(along)))
      tokens->fail("the direction of view is zero or parallel to \"up\"");
    const Vec3d z = normalize(along), x = normalize(side);
    return inverse({x, cross(z, x), z, from}, tokens->place());
  }
  // A list of parameters; those that "Attribute" set for the `target` come after its own.
  Entity parameters(const std::string& kind, const char* target = "", Key key = {}) {
    Entity e{context, kind, tokens->place(), key};
    e.read(*tokens, owner);
    const std::vector<Parameter>& defaults = state.attributes[target];
    e.all.insert(e.all.end(), defaults.rbegin(), defaults.rend());
    return e;
  }
  Entity entity(const char* target = "") { return parameters(name(), target); }
  // One that others may name: nobody misses what it holds before.
  Entity definition(const char* target) {
    const std::string kind = name();
    return parameters(kind, target, context.source.enter({}, tokens->place(), ""));
  }

  // ---- The state ----

  void set_transform(const Affine& to) {
    if (!state.is_active)
      return lose("movement is left out: the transformations at the start are kept");
    require_finite(to, tokens->place());
    state.to_world = to;
  }
  void transform(const Affine& by) { set_transform(state.to_world * by); }

  void save(Scope kind) {
    constexpr size_t kDeepest = 10000;
    if (saved.size() >= kDeepest) tokens->fail("more than {} states are saved", kDeepest);
    saved.push_back({kind, state, tokens->place()});
  }
  void restore(Scope kind) {
    if (saved.empty() || saved.back().kind != kind)
      tokens->fail("\"{}\" without its beginning", directive);
    State& before = saved.back().state;
    if (kind == Scope::transform) {
      state.to_world = before.to_world;
      state.is_active = before.is_active;
    } else {
      state = std::move(before);
    }
    saved.pop_back();
  }

  void attribute() {
    const std::string target = name();
    std::vector<Parameter>& all = state.attributes[target];
    for (Parameter& p : parameters("").all) all.push_back(std::move(p));
    constexpr size_t kMost = 1000;  // they are copied to every directive
    size_t values = all.size();
    for (const Parameter& p : all) values += p.numbers.size() + p.strings.size();
    if (values > kMost) tokens->fail("attributes of more than {} values", kMost);
  }

  // ---- What a picture is made with ----

  void integrator() {
    const Entity e = entity();
    if (e.has("maxdepth"))  // counts bounces
      context.source.lose_longer_paths(e.place, e.integer("maxdepth", 5) + 1.0);
    if (e.flag("regularize", false)) e.lose("the smoothing of caustics (regularize) is left out");
    e.ignore();  // how it samples
  }
  // ---- The world ----

  size_t add_surface(Surface&& surface, const std::string& name) {
    surface.material.name = name;
    context.surfaces.push_back(std::move(surface));
    return context.surfaces.size() - 1;
  }
  void make_named_material() {
    Entity e = definition("material");
    const std::string name = std::exchange(e.kind, e.text("type"));
    context.named_surfaces[name] = add_surface(surface_of(e), name);
  }
  void named_material() {
    const std::string wanted = name();
    const auto it = context.named_surfaces.find(wanted);
    if (it == context.named_surfaces.end()) lose("no material is named \"{}\"", shown(wanted));
    state.surface = it == context.named_surfaces.end() ? 0 : it->second;
  }
  void add_shape(Shape&& shape) {
    constexpr size_t kMostShapes = 1000000;
    if (++shapes > kMostShapes) tokens->fail("more than {} shapes", kMostShapes);
    (object ? objects[*object] : context.scene.shapes).push_back(std::move(shape));
  }
  void object_begin() {
    const std::string begun = name();
    if (object) tokens->fail("an object within an object");
    save(Scope::object);
    object = begun;
    objects[begun].clear();
  }
  void object_instance() {
    const std::string wanted = name();
    if (object) tokens->fail("an instance within an object");
    const auto it = objects.find(wanted);
    if (it == objects.end()) return lose("no object is named \"{}\"", shown(wanted));
    for (Shape shape : it->second) {
      shape.to_world = state.to_world * shape.to_world;
      add_shape(std::move(shape));
    }
  }

  void include(const std::string& given) {
    constexpr size_t kDeepest = 16, kMostFiles = 10000;
    if (open_files >= kDeepest) tokens->fail("more than {} files include each other", kDeepest);
    if (++files > kMostFiles) tokens->fail("more than {} files are included", kMostFiles);
    const std::string file = std::filesystem::path(given).lexically_normal().string();
    const std::string shown_name = context.source.shown_name(file);
    read(unpacked(context.source.read(file, tokens->place()), shown_name), shown_name);
  }
  void import() {
    const std::string file = name();
    const size_t before = saved.size();
    save(Scope::import);
    include(file);
    if (saved.size() != before + 1)
      Source::fail(saved.back().place, "what begins here does not end in the imported file");
    restore(Scope::import);
  }

  void read(std::string_view text, const std::string& file);
  Described run();
};

struct Directive {
  std::string_view name;
  void (*run)(Builder&);
};
constexpr Directive kDirectives[] = {
    {"Accelerator", [](Builder& b) { b.entity().ignore(); }},
    {"ActiveTransform",
     [](Builder& b) {
       const std::string which = b.tokens->next().text;
       if (which != "All" && which != "StartTime" && which != "EndTime")
         b.tokens->fail("All, StartTime or EndTime should follow");
       b.state.is_active = which != "EndTime";
     }},
    {"AreaLightSource", [](Builder& b) { b.state.area = area_light(b.entity("light")); }},
    {"Attribute", [](Builder& b) { b.attribute(); }},
    {"AttributeBegin", [](Builder& b) { b.save(Builder::Scope::attributes); }},
    {"AttributeEnd", [](Builder& b) { b.restore(Builder::Scope::attributes); }},
    {"Camera",
     [](Builder& b) {
       b.camera.emplace(b.entity());
       b.camera_from_world = b.state.to_world;
       b.systems["camera"] = inverse(b.state.to_world, b.camera->place);
     }},
    {"ColorSpace",
     [](Builder& b) {
       const std::string name = b.name();
       if (name != "srgb") b.lose("colours in the space \"{}\" are taken for sRGB", shown(name));
     }},
    {"ConcatTransform", [](Builder& b) { b.transform(b.matrix()); }},
    {"CoordSysTransform",
     [](Builder& b) {
       const auto it = b.systems.find(b.name());
       if (it == b.systems.end())
         return b.lose("a coordinate system that was not defined is ignored");
       b.set_transform(it->second);
     }},
    {"CoordinateSystem", [](Builder& b) { b.systems[b.name()] = b.state.to_world; }},
    {"Film", [](Builder& b) { b.film.emplace(b.entity()); }},
    {"Identity", [](Builder& b) { b.set_transform({}); }},
    {"Import", [](Builder& b) { b.import(); }},
    {"Include", [](Builder& b) { b.include(b.name()); }},
    {"Integrator", [](Builder& b) { b.integrator(); }},
    {"LightSource", [](Builder& b) { add_light(b.entity("light"), b.state.to_world); }},
    {"LookAt", [](Builder& b) { b.transform(b.view()); }},
    {"MakeNamedMaterial", [](Builder& b) { b.make_named_material(); }},
    {"MakeNamedMedium",
     [](Builder& b) {
       const Entity e = b.entity("medium");
       add_medium(e, e.kind);
     }},
    {"Material",
     [](Builder& b) {
       const Entity e = b.definition("material");
       b.state.surface = b.add_surface(surface_of(e), e.kind);
     }},
    {"MediumInterface",
     [](Builder& b) {
       b.state.inside = b.state.outside = b.name();
       if (b.tokens->peek().kind == Token::Kind::quoted) b.state.outside = b.name();
     }},
    {"NamedMaterial", [](Builder& b) { b.named_material(); }},
    {"ObjectBegin", [](Builder& b) { b.object_begin(); }},
    {"ObjectEnd",
     [](Builder& b) {
       b.restore(Builder::Scope::object);
       b.object.reset();
     }},
    {"ObjectInstance", [](Builder& b) { b.object_instance(); }},
    {"Option", [](Builder& b) { b.parameters("").ignore(); }},
    {"PixelFilter", [](Builder& b) { b.entity().ignore(); }},
    {"ReverseOrientation", [](Builder& b) { b.state.is_reversed = !b.state.is_reversed; }},
    {"Rotate", [](Builder& b) { b.transform(b.rotation()); }},
    {"Sampler", [](Builder& b) { b.entity().ignore(); }},
    {"Scale",
     [](Builder& b) {
       const Vec3d by = b.vector();
       b.transform({{by.x, 0, 0}, {0, by.y, 0}, {0, 0, by.z}, {}});
     }},
    {"Shape",
     [](Builder& b) {
       if (std::optional<Shape> shape = shape_of(b.entity("shape"), b.state, b.object.has_value()))
         b.add_shape(std::move(*shape));
     }},
    {"SurfaceIntegrator", [](Builder& b) { b.integrator(); }},
    {"Texture",
     [](Builder& b) {
       const std::string name = b.name(), type = b.name();
       add_texture(b.definition("texture"), name, type);
     }},
    {"Transform", [](Builder& b) { b.set_transform(b.matrix()); }},
    {"TransformBegin", [](Builder& b) { b.save(Builder::Scope::transform); }},
    {"TransformEnd", [](Builder& b) { b.restore(Builder::Scope::transform); }},
    {"TransformTimes", [](Builder& b) { b.numbers(2); }},
    {"Translate",
     [](Builder& b) {
       b.transform({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, b.vector()});
     }},
    {"WorldBegin",
     [](Builder& b) {
       b.in_world = true;
       b.state.to_world = {};
       b.state.is_active = true;
       b.systems["world"] = {};
     }},
    {"WorldEnd",
     [](Builder& b) {
       b.is_done = true;
       if (b.tokens->peek().kind != Token::Kind::end)
         b.lose("what follows the end of the first world is left out");
     }},
};

void Builder::read(std::string_view text, const std::string& file) {
  Tokens of_file(text, file);
  Tokens* const before = std::exchange(tokens, &of_file);
  ++open_files;
  while (!is_done && tokens->peek().kind != Token::Kind::end) {
    directive = owner = tokens->next().text;
    const auto* known = std::find_if(std::begin(kDirectives), std::end(kDirectives),
                                     [&](const Directive& d) { return d.name == directive; });
    if (known == std::end(kDirectives)) tokens->fail("\"{}\" is not a directive", shown(directive));
    known->run(*this);
  }
  --open_files;
  tokens = before;
}

Described Builder::run() {
  const Source& source = context.source;
  const Place whole{source.path(), ""};
  add_surface({diffuse({Rgb(0.5f), {}, {}})}, "default");
  context.scene.title = std::filesystem::path(source.path()).stem().string();
  read(source.text(), source.path());
  if (context.v4 && !saved.empty())
    Source::fail(saved.back().place, "what begins here does not end");
  if (!in_world && context.scene.shapes.empty())
    Source::fail(whole, "no WorldBegin: this is no scene of pbrt");
  if (!camera) camera.emplace(context, "perspective", whole);
  if (!film) film.emplace(context, context.v4 ? "rgb" : "image", whole);
  add_camera(*camera, *film, camera_from_world);
  return std::move(context.scene);
}

// Scenes of pbrt-v3 end with "WorldEnd", and their film is an "image".
bool is_v3(const Source& source) {
  Tokens tokens(source.text(), source.path());
  bool is_film = false;  // the last token
  while (tokens.peek().kind != Token::Kind::end) {
    const Token token = tokens.next();
    if (token.text == "WorldEnd" || (is_film && token.text == "image")) return true;
    is_film = token.text == "Film";
  }
  return false;
}

}  // namespace
}  // namespace tdpt::foreign::pbrt

namespace tdpt::foreign {

Described read_pbrt(Source& source) {
  return pbrt::Builder{.context = {source, !pbrt::is_v3(source)}}.run();
}

}  // namespace tdpt::foreign
