#include "tools/tdpt-import/pbrt/builder.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/pbrt/context.h"

namespace tdpt::foreign::pbrt {

enum Attribute : size_t { kShape, kLight, kMaterial, kMedium, kTexture };
constexpr const char* kAttributes[] = {"shape", "light", "material", "medium", "texture"};

// Integrators that find all light.
constexpr std::string_view kWhole[] = {"bdpt",          "lightpath",  "metropolis", "mlt",
                                       "path",          "pathtracer", "randomwalk", "simplepath",
                                       "simplevolpath", "sppm",       "volpath"};

struct Directives {
  // Transformations.
  static void identity(Builder& b) { b.set_transform({}); }
  static Vec3d three(Builder& b) {
    const double x = b.number(), y = b.number();
    return {x, y, b.number()};
  }
  static void translate(Builder& b) { b.transform(translated(three(b))); }
  static void scale(Builder& b) { b.transform(scaled_by(three(b))); }
  static void rotate(Builder& b) {
    const double degrees = b.number();
    b.transform(rotated(degrees, three(b)));
  }
  static void look_at(Builder& b) {
    const Vec3d from = three(b), at = three(b), up = three(b);
    b.transform(looking(from, at, up, b.tokens_.place()));
  }
  static Affine matrix(Builder& b) {
    const std::vector<double> m = b.numbers(16);
    return affine_of_matrix(m, b.tokens_.place());
  }
  static void set_matrix(Builder& b) { b.set_transform(matrix(b)); }
  static void concat_matrix(Builder& b) { b.transform(matrix(b)); }
  static void coordinate_system(Builder& b) {
    const std::string name = b.name();
    b.systems_[name] = b.state_.to_world;
  }
  static void use_coordinate_system(Builder& b) {
    const auto it = b.systems_.find(b.name());
    if (it == b.systems_.end())
      b.context_.source.lose(b.tokens_.place(),
                             "a coordinate system that was not defined is ignored");
    else
      b.set_transform(it->second);
  }
  static void active_transform(Builder& b) {
    const std::optional<Token> which = b.tokens_.next();
    const std::string word = which ? which->text : "";
    if (word != "All" && word != "StartTime" && word != "EndTime")
      Source::fail(b.tokens_.place(), "All, StartTime or EndTime should follow");
    b.state_.is_active = word != "EndTime";
  }
  static void transform_times(Builder& b) { b.numbers(2); }

  // States.
  static void attribute_begin(Builder& b) { b.save(Builder::Saved::attributes); }
  static void attribute_end(Builder& b) { b.restore(Builder::Saved::attributes, "AttributeEnd"); }
  static void transform_begin(Builder& b) { b.save(Builder::Saved::transform); }
  static void transform_end(Builder& b) { b.restore(Builder::Saved::transform, "TransformEnd"); }
  static void reverse_orientation(Builder& b) { b.state_.is_reversed = !b.state_.is_reversed; }
  static void attribute(Builder& b) {
    const std::string target = b.name();
    const auto* at = std::find(std::begin(kAttributes), std::end(kAttributes), target);
    if (at == std::end(kAttributes))
      Source::fail(b.tokens_.place(), fmt::format("\"{}\" has no attributes", shown(target)));
    auto& shared = b.state_.attributes[static_cast<size_t>(at - std::begin(kAttributes))];
    auto all = shared ? *shared : std::vector<Parameter>();
    for (Parameter& p : b.parameters().all) all.push_back(std::move(p));
    constexpr size_t kMost = 1000;  // they are copied to every directive
    size_t values = all.size();
    for (const Parameter& p : all) values += p.numbers.size() + p.strings.size() + p.flags.size();
    if (values > kMost)
      Source::fail(b.tokens_.place(), fmt::format("attributes of more than {} values", kMost));
    shared = std::make_shared<const std::vector<Parameter>>(std::move(all));
  }
  static void colour_space(Builder& b) {
    const std::string name = b.name();
    if (name != "srgb")
      b.context_.source.lose(
          b.tokens_.place(),
          fmt::format("colours in the space \"{}\" are taken for sRGB", shown(name)));
  }

  // What a picture is made with.
  static void ignored(Builder& b) {
    b.name();
    const Parameters list = b.parameters();
    list.ignore({"jitter", "dimensions", "pixelsamples", "randomization", "samplepixelcenter",
                 "seed", "xsamples", "ysamples"});  // of samplers
    list.ignore({"B", "C", "alpha", "sigma", "tau", "xradius", "yradius", "xwidth", "ywidth"});
    list.ignore({"emptybonus", "intersectcost", "maxdepth", "maxnodeprims", "maxprims",
                 "splitmethod", "traversalcost"});  // filters and accelerators
  }
  static void integrator(Builder& b) {
    const std::string kind = b.name();
    const Parameters list = b.parameters();
    if (std::find(std::begin(kWhole), std::end(kWhole), kind) == std::end(kWhole)) {
      b.context_.source.lose(list.place,
                             fmt::format("the integrator \"{}\", which shows other light than "
                                         "all that there is, is left out",
                                         shown(kind)));
      return list.ignore_all();
    }
    if (list.find("maxdepth"))  // counts bounces
      b.context_.source.lose_longer_paths(list.place, list.integer("maxdepth", 5) + 1.0);
    if (list.flag("regularize", false))
      b.context_.source.lose(list.place, "the smoothing of caustics (regularize) is left out");
    list.ignore({"bootstrapsamples", "chains", "cossample", "imagefilename", "imagewritefrequency",
                 "iterations", "largestepprobability", "lightsampler", "lightsamplestrategy",
                 "mutationsperpixel", "nsamples", "numiterations", "photonsperiteration", "radius",
                 "rrthreshold", "samplebsdf", "samplelights", "seed"});  // how it samples
    list.ignore({"strategy", "visualizestrategies", "visualizeweights"});
  }
  static void option(Builder& b) {
    const Parameters list = b.parameters();
    list.ignore({"disablepixeljitter", "disabletexturefiltering", "disablewavelengthjitter",
                 "displacementedgescale", "msereferenceimage", "msereferenceout", "pixelstats",
                 "rendercoordsys", "seed", "wavefront"});  // how it samples
    if (list.flag("forcediffuse", false))
      b.context_.source.lose(list.place, "materials that are all diffuse (forcediffuse) are not");
  }
  static void camera(Builder& b) {
    const std::string kind = b.name();
    b.camera_ = Builder::Entity{kind, b.parameters()};
    b.camera_from_world_ = b.state_.to_world;
    b.systems_["camera"] = inverse(b.state_.to_world, b.camera_->list.place);
  }
  static void film(Builder& b) {
    const std::string kind = b.name();
    b.film_ = Builder::Entity{kind, b.parameters()};
  }
  static void world_begin(Builder& b) {
    b.in_world_ = true;
    b.state_.to_world = {};
    b.state_.is_active = true;
    b.systems_["world"] = {};
  }
  static void world_end(Builder& b) {
    b.is_done_ = true;
    const std::optional<Token> more = b.tokens_.next();
    if (more)
      b.context_.source.lose(b.tokens_.place(),
                             "what follows the end of the first world is left out");
  }

  // The world.
  static void texture(Builder& b) {
    const std::string name = b.name(), type = b.name(), kind = b.name();
    const Key key = b.waiting();
    b.textures_.make(b.context_, name, type, kind, b.parameters(kTexture, key), key);
  }
  static size_t painted(Builder& b, Surface surface, const std::string& name) {
    surface.material.name = name;
    return b.painter_.add(std::move(surface));
  }
  static void material(Builder& b) {
    const std::string kind = b.name();
    const Key key = b.waiting();
    const Parameters list = b.parameters(kMaterial, key);
    Surface surface = surface_of(b.context_, b.textures_, b.named_, kind, list);
    surface.key = key;
    b.state_.surface = painted(b, surface, kind);
  }
  static void make_named_material(Builder& b) {
    const std::string name = b.name();
    const Key key = b.waiting();
    const Parameters list = b.parameters(kMaterial, key);
    const std::string kind = list.text("type");
    Surface surface = surface_of(b.context_, b.textures_, b.named_, kind, list);
    surface.key = key;
    b.painted_[name] = painted(b, surface, name);
    b.named_[name] = surface;
  }
  static void named_material(Builder& b) {
    const std::string name = b.name();
    const auto it = b.painted_.find(name);
    if (it != b.painted_.end()) {
      b.state_.surface = it->second;
      return;
    }
    b.context_.source.lose(b.tokens_.place(),
                           fmt::format("no material is named \"{}\"", shown(name)));
    b.state_.surface = 0;
  }
  static void make_named_medium(Builder& b) {
    const std::string name = b.name();
    b.painter_.add_medium(b.context_, name, b.parameters(kMedium));
  }
  static void medium_interface(Builder& b) {
    b.state_.inside = b.state_.outside = b.name();
    std::optional<Token> second = b.tokens_.next();
    if (second && second->kind == Token::Kind::quoted)
      b.state_.outside = second->text;
    else if (second)
      b.tokens_.back(std::move(*second));
  }
  static void light_source(Builder& b) {
    const std::string kind = b.name();
    add_light(b.context_, kind, b.parameters(kLight), b.state_.to_world);
  }
  static void area_light_source(Builder& b) {
    const std::string kind = b.name();
    b.state_.area =
        std::make_shared<const AreaLight>(area_light(b.context_, kind, b.parameters(kLight)));
  }
  static void shape(Builder& b) {
    const std::string kind = b.name();
    b.add_shape(kind, b.parameters(kShape));
  }
  static void object_begin(Builder& b) {
    const std::string name = b.name();
    if (b.object_) Source::fail(b.tokens_.place(), "an object within an object");
    b.save(Builder::Saved::object);
    b.object_ = name;
    b.objects_[name].clear();
  }
  static void object_end(Builder& b) {
    b.restore(Builder::Saved::object, "ObjectEnd");
    b.object_.reset();
  }
  static void object_instance(Builder& b) {
    const std::string name = b.name();
    if (b.object_) Source::fail(b.tokens_.place(), "an instance within an object");
    const auto it = b.objects_.find(name);
    if (it == b.objects_.end()) {
      b.context_.source.lose(b.tokens_.place(),
                             fmt::format("no object is named \"{}\"", shown(name)));
      return;
    }
    for (const Shape& part : it->second) {
      Shape shape = part;
      shape.to_world = b.state_.to_world * part.to_world;
      b.keep(std::move(shape));
    }
  }
  static void include(Builder& b) { b.tokens_.include(b.context_.source, b.name()); }
  static void import(Builder& b) {
    const std::string name = b.name();
    b.save(Builder::Saved::import);
    b.tokens_.include(b.context_.source, name);
  }
};

namespace {

constexpr Directive kDirectives[] = {
    {"Accelerator", Directives::ignored},
    {"ActiveTransform", Directives::active_transform},
    {"AreaLightSource", Directives::area_light_source},
    {"Attribute", Directives::attribute},
    {"AttributeBegin", Directives::attribute_begin},
    {"AttributeEnd", Directives::attribute_end},
    {"Camera", Directives::camera},
    {"ColorSpace", Directives::colour_space},
    {"ConcatTransform", Directives::concat_matrix},
    {"CoordSysTransform", Directives::use_coordinate_system},
    {"CoordinateSystem", Directives::coordinate_system},
    {"Film", Directives::film},
    {"Identity", Directives::identity},
    {"Import", Directives::import},
    {"Include", Directives::include},
    {"Integrator", Directives::integrator},
    {"LightSource", Directives::light_source},
    {"LookAt", Directives::look_at},
    {"MakeNamedMaterial", Directives::make_named_material},
    {"MakeNamedMedium", Directives::make_named_medium},
    {"Material", Directives::material},
    {"MediumInterface", Directives::medium_interface},
    {"NamedMaterial", Directives::named_material},
    {"ObjectBegin", Directives::object_begin},
    {"ObjectEnd", Directives::object_end},
    {"ObjectInstance", Directives::object_instance},
    {"Option", Directives::option},
    {"PixelFilter", Directives::ignored},
    {"ReverseOrientation", Directives::reverse_orientation},
    {"Rotate", Directives::rotate},
    {"Sampler", Directives::ignored},
    {"Scale", Directives::scale},
    {"Shape", Directives::shape},
    {"SurfaceIntegrator", Directives::integrator},
    {"Texture", Directives::texture},
    {"Transform", Directives::set_matrix},
    {"TransformBegin", Directives::transform_begin},
    {"TransformEnd", Directives::transform_end},
    {"TransformTimes", Directives::transform_times},
    {"Translate", Directives::translate},
    {"WorldBegin", Directives::world_begin},
    {"WorldEnd", Directives::world_end},
};

}  // namespace

const Directive* directive_of(const std::string& name) {
  const auto* it = std::find_if(std::begin(kDirectives), std::end(kDirectives),
                                [&](const Directive& d) { return name == d.name; });
  return it == std::end(kDirectives) ? nullptr : it;
}

}  // namespace tdpt::foreign::pbrt
