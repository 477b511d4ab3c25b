// The directives of a scene, and whether it is one of pbrt-v3 or pbrt-v4.
#include "tools/tdpt-import/pbrt/pbrt.h"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"

namespace tdpt::foreign::pbrt {
namespace {

// Whose defaults "Attribute" sets.
enum Attribute : size_t { kShape, kLight, kMaterial, kMedium, kTexture, kNone };
constexpr std::string_view kAttributes[] = {"shape", "light", "material", "medium", "texture"};

// Integrators that find all light.
constexpr std::string_view kWhole[] = {"bdpt",          "lightpath",  "metropolis", "mlt",
                                       "path",          "pathtracer", "randomwalk", "simplepath",
                                       "simplevolpath", "sppm",       "volpath"};

template <size_t n>
bool holds(const std::string_view (&list)[n], std::string_view word) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

// Carries out directives.
struct Builder {
  enum class Saved { attributes, transform, object, import };
  struct Save {
    Saved kind;
    State state;
    Place place;
    size_t depth = 0;  // of an imported file
  };

  Context context;
  Tokens tokens;
  std::string directive, whose;  // that is carried out; with the last name after it
  State state{};
  std::vector<Save> saved{};
  std::map<std::string, Affine> systems{};  // CoordinateSystem
  std::map<std::string, std::vector<Shape>> objects{};
  std::optional<std::string> object{};  // being defined
  size_t shapes = 0;
  std::optional<Entity> camera{}, film{};
  Affine camera_from_world{};
  bool in_world = false, is_done = false;

  template <class... A>
  [[noreturn]] void fail(fmt::format_string<const A&...> message, const A&... values) const {
    Source::fail(tokens.place(), fmt::format(message, values...));
  }
  template <class... A>
  void lose(fmt::format_string<const A&...> sentence, const A&... values) {
    context.source.lose(tokens.place(), fmt::format(sentence, values...));
  }

  // ---- Of the tokens that follow ----

  std::string name() {
    const std::optional<Token> token = tokens.next();
    if (!token || token->kind != Token::Kind::quoted) fail("a name in quotes should follow");
    whose = fmt::format("{} \"{}\"", directive, shown(token->text));
    return token->text;
  }
  double number() {
    const std::optional<Token> token = tokens.next();
    if (!token) fail("the file ends where a number should follow");
    return number_of(*token, tokens.place());
  }
  Vec3d three() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  std::vector<double> numbers(size_t count) {
    std::optional<Token> token = tokens.next();
    const bool in_brackets = token && token->kind == Token::Kind::open;
    if (token && !in_brackets) tokens.back(std::move(*token));
    std::vector<double> out;
    while (out.size() < count) out.push_back(number());
    if (in_brackets) {
      token = tokens.next();
      if (!token || token->kind != Token::Kind::close)
        fail("a ']' should follow the {} numbers", count);
    }
    return out;
  }
  Affine matrix() {
    const std::vector<double> m = numbers(16);
    return affine_of_matrix(m, tokens.place());
  }
  Entity list(const std::string& kind, Key key = {}, Attribute attribute = kNone) {
    Entity e{context, kind, tokens.place(), key};
    e.read(tokens, whose);
    if (attribute != kNone && state.attributes[attribute]) e.defaults(*state.attributes[attribute]);
    return e;
  }
  Entity entity(Attribute attribute = kNone) {
    const std::string kind = name();
    return list(kind, {}, attribute);
  }
  /// One that others may name: nobody misses what it holds before.
  Entity waiting(Attribute attribute) {
    const std::string kind = name();
    return list(kind, context.source.enter({}, tokens.place(), ""), attribute);
  }

  // ---- The state ----

  void set_transform(const Affine& to) {
    if (!state.is_active)
      return lose("movement is left out: the transformations at the start are kept");
    if (!is_bounded(to)) fail("the transformation is too large");
    state.to_world = to;
  }
  void transform(const Affine& by) { set_transform(state.to_world * by); }

  void save(Saved kind) {
    constexpr size_t kDeepest = 10000;
    if (saved.size() >= kDeepest) fail("more than {} states are saved", kDeepest);
    saved.push_back({kind, state, tokens.place(), tokens.depth()});
  }
  void restore(Saved kind) {
    if (saved.empty() || saved.back().kind != kind) fail("\"{}\" without its beginning", directive);
    const State& before = saved.back().state;
    if (kind == Saved::transform) {
      state.to_world = before.to_world;
      state.is_active = before.is_active;
    } else {
      state = before;
    }
    saved.pop_back();
  }
  // An imported file ends when a token of the file that imported it comes.
  void end_imports() {
    const auto is_import = [](const Save& s) { return s.kind == Saved::import; };
    while (true) {
      const auto import = std::find_if(saved.rbegin(), saved.rend(), is_import);
      if (import == saved.rend() || tokens.depth() > import->depth) return;
      if (import != saved.rbegin())
        Source::fail(saved.back().place, "what begins here does not end in the imported file");
      restore(Saved::import);
    }
  }

  void attribute() {
    const std::string target = name();
    const auto* at = std::find(std::begin(kAttributes), std::end(kAttributes), target);
    if (at == std::end(kAttributes)) fail("\"{}\" has no attributes", shown(target));
    auto& shared = state.attributes[static_cast<size_t>(at - std::begin(kAttributes))];
    auto all = shared ? *shared : std::vector<Parameter>();
    for (Parameter& p : list("").all) all.push_back(std::move(p));
    constexpr size_t kMost = 1000;  // they are copied to every directive
    size_t values = all.size();
    for (const Parameter& p : all) values += p.numbers.size() + p.strings.size() + p.flags.size();
    if (values > kMost) fail("attributes of more than {} values", kMost);
    shared = std::make_shared<const std::vector<Parameter>>(std::move(all));
  }

  // ---- What a picture is made with ----

  void ignored() {
    const Entity e = entity();
    e.ignore({"jitter", "dimensions", "pixelsamples", "randomization", "samplepixelcenter", "seed",
              "xsamples", "ysamples"});  // of samplers
    e.ignore({"B", "C", "alpha", "sigma", "tau", "xradius", "yradius", "xwidth", "ywidth"});
    e.ignore({"emptybonus", "intersectcost", "maxdepth", "maxnodeprims", "maxprims", "splitmethod",
              "traversalcost"});  // filters and accelerators
  }
  void integrator() {
    const Entity e = entity();
    if (!holds(kWhole, e.kind)) {
      e.lose("the integrator \"{}\", which shows other light than all that there is, is left out",
             shown(e.kind));
      return e.ignore_all();
    }
    if (e.find("maxdepth"))  // counts bounces
      context.source.lose_longer_paths(e.place, e.integer("maxdepth", 5) + 1.0);
    if (e.flag("regularize", false)) e.lose("the smoothing of caustics (regularize) is left out");
    e.ignore({"bootstrapsamples", "chains", "cossample", "imagefilename", "imagewritefrequency",
              "iterations", "largestepprobability", "lightsampler", "lightsamplestrategy",
              "mutationsperpixel", "nsamples", "numiterations", "photonsperiteration", "radius",
              "rrthreshold", "samplebsdf", "samplelights", "seed"});  // how it samples
    e.ignore({"strategy", "visualizestrategies", "visualizeweights"});
  }
  void option() {
    const Entity e = list("");
    e.ignore({"disablepixeljitter", "disabletexturefiltering", "disablewavelengthjitter",
              "displacementedgescale", "msereferenceimage", "msereferenceout", "pixelstats",
              "rendercoordsys", "seed", "wavefront"});  // how it samples
    if (e.flag("forcediffuse", false))
      e.lose("materials that are all diffuse (forcediffuse) are not");
  }

  // ---- The world ----

  size_t add_surface(Surface&& surface, const std::string& name) {
    surface.material.name = name;
    context.surfaces.push_back(std::move(surface));
    return context.surfaces.size() - 1;
  }
  void make_named_material() {
    Entity e = waiting(kMaterial);
    const std::string name = std::exchange(e.kind, e.text("type"));
    context.named_surfaces[name] = add_surface(surface_of(e), name);
  }
  void named_material() {
    const std::string wanted = name();
    const auto it = context.named_surfaces.find(wanted);
    if (it == context.named_surfaces.end()) lose("no material is named \"{}\"", shown(wanted));
    state.surface = it == context.named_surfaces.end() ? 0 : it->second;
  }
  void medium_interface() {
    state.inside = state.outside = name();
    std::optional<Token> second = tokens.next();
    if (second && second->kind == Token::Kind::quoted)
      state.outside = second->text;
    else if (second)
      tokens.back(std::move(*second));
  }
  void keep(Shape&& shape) {
    constexpr size_t kMostShapes = 1000000;
    if (++shapes > kMostShapes) fail("more than {} shapes", kMostShapes);
    (object ? objects[*object] : context.scene.shapes).push_back(std::move(shape));
  }
  void object_begin() {
    const std::string begun = name();
    if (object) fail("an object within an object");
    save(Saved::object);
    object = begun;
    objects[begun].clear();
  }
  void object_instance() {
    const std::string wanted = name();
    if (object) fail("an instance within an object");
    const auto it = objects.find(wanted);
    if (it == objects.end()) return lose("no object is named \"{}\"", shown(wanted));
    for (Shape shape : it->second) {
      shape.to_world = state.to_world * shape.to_world;
      keep(std::move(shape));
    }
  }

  Described run();
};

struct Directive {
  std::string_view name;
  void (*run)(Builder&);
};
constexpr Directive kDirectives[] = {
    {"Accelerator", [](Builder& b) { b.ignored(); }},
    {"ActiveTransform",
     [](Builder& b) {
       const std::optional<Token> which = b.tokens.next();
       const std::string word = which ? which->text : "";
       if (word != "All" && word != "StartTime" && word != "EndTime")
         b.fail("All, StartTime or EndTime should follow");
       b.state.is_active = word != "EndTime";
     }},
    {"AreaLightSource", [](Builder& b) { b.state.area = area_light(b.entity(kLight)); }},
    {"Attribute", [](Builder& b) { b.attribute(); }},
    {"AttributeBegin", [](Builder& b) { b.save(Builder::Saved::attributes); }},
    {"AttributeEnd", [](Builder& b) { b.restore(Builder::Saved::attributes); }},
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
    {"Import",
     [](Builder& b) {
       const std::string name = b.name();
       b.save(Builder::Saved::import);
       b.tokens.include(b.context.source, name);
     }},
    {"Include", [](Builder& b) { b.tokens.include(b.context.source, b.name()); }},
    {"Integrator", [](Builder& b) { b.integrator(); }},
    {"LightSource", [](Builder& b) { add_light(b.entity(kLight), b.state.to_world); }},
    {"LookAt",
     [](Builder& b) {
       const Vec3d from = b.three(), at = b.three(), up = b.three();
       b.transform(looking(from, at, up, b.tokens.place()));
     }},
    {"MakeNamedMaterial", [](Builder& b) { b.make_named_material(); }},
    {"MakeNamedMedium",
     [](Builder& b) {
       const Entity e = b.entity(kMedium);
       add_medium(e, e.kind);
     }},
    {"Material",
     [](Builder& b) {
       const Entity e = b.waiting(kMaterial);
       b.state.surface = b.add_surface(surface_of(e), e.kind);
     }},
    {"MediumInterface", [](Builder& b) { b.medium_interface(); }},
    {"NamedMaterial", [](Builder& b) { b.named_material(); }},
    {"ObjectBegin", [](Builder& b) { b.object_begin(); }},
    {"ObjectEnd",
     [](Builder& b) {
       b.restore(Builder::Saved::object);
       b.object.reset();
     }},
    {"ObjectInstance", [](Builder& b) { b.object_instance(); }},
    {"Option", [](Builder& b) { b.option(); }},
    {"PixelFilter", [](Builder& b) { b.ignored(); }},
    {"ReverseOrientation", [](Builder& b) { b.state.is_reversed = !b.state.is_reversed; }},
    {"Rotate",
     [](Builder& b) {
       const double degrees = b.number();
       b.transform(rotated(degrees, b.three()));
     }},
    {"Sampler", [](Builder& b) { b.ignored(); }},
    {"Scale", [](Builder& b) { b.transform(scaled_by(b.three())); }},
    {"Shape",
     [](Builder& b) {
       if (std::optional<Shape> shape = shape_of(b.entity(kShape), b.state, b.object.has_value()))
         b.keep(std::move(*shape));
     }},
    {"SurfaceIntegrator", [](Builder& b) { b.integrator(); }},
    {"Texture",
     [](Builder& b) {
       const std::string name = b.name(), type = b.name();
       add_texture(b.waiting(kTexture), name, type);
     }},
    {"Transform", [](Builder& b) { b.set_transform(b.matrix()); }},
    {"TransformBegin", [](Builder& b) { b.save(Builder::Saved::transform); }},
    {"TransformEnd", [](Builder& b) { b.restore(Builder::Saved::transform); }},
    {"TransformTimes", [](Builder& b) { b.numbers(2); }},
    {"Translate", [](Builder& b) { b.transform(translated(b.three())); }},
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
       if (b.tokens.next()) b.lose("what follows the end of the first world is left out");
     }},
};

Described Builder::run() {
  add_surface({diffuse({Rgb(0.5f), {}, {}})}, "default");
  const std::string& path = context.source.path();
  context.scene.title = std::filesystem::path(path).stem().string();
  while (!is_done) {
    const std::optional<Token> token = tokens.next();
    end_imports();
    if (!token) break;
    if (token->kind != Token::Kind::word)
      fail("\"{}\" where a directive should be", shown(token->text));
    const auto* known = std::find_if(std::begin(kDirectives), std::end(kDirectives),
                                     [&](const Directive& d) { return d.name == token->text; });
    if (known == std::end(kDirectives)) fail("\"{}\" is not a directive", shown(token->text));
    directive = whose = known->name;
    known->run(*this);
  }
  if (context.v4 && !saved.empty())
    Source::fail(saved.back().place, "what begins here does not end");
  if (!in_world && context.scene.shapes.empty())
    Source::fail({path, ""}, "no WorldBegin: this is no scene of pbrt");
  if (!camera) camera.emplace(context, "perspective", Place{path, ""});
  if (!film) film.emplace(context, context.v4 ? "rgb" : "image", Place{path, ""});
  add_camera(*camera, *film, camera_from_world);
  return std::move(context.scene);
}

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
constexpr std::string_view kTypesV3[] = {"point", "vector", "color", "xyz"};

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
      if (const size_t space = t.find(' '); space != t.npos)
        v3 += holds(kTypesV3, t.substr(0, space));
    }
    if (token->kind != Token::Kind::open) before = t;
  }
  return v4 >= v3;
}

}  // namespace
}  // namespace tdpt::foreign::pbrt

namespace tdpt::foreign {

Described read_pbrt(Source& source) {
  return pbrt::Builder{{source, pbrt::is_v4(source)}, {source.text(), source.path()}, {}, {}}.run();
}

}  // namespace tdpt::foreign
