#include "tools/tdpt-import/mitsuba/lights.h"

#include <fmt/format.h>

#include <numbers>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"
#include "tools/tdpt-import/mitsuba/transforms.h"

namespace tdpt::foreign::mitsuba {
namespace {

// Mitsuba's maps have +z, not -z, in their centre.
constexpr Affine kHalfTurn{{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {}};

class Lights {
 public:
  Lights(const Object& emitter, Described& scene, Source& source, Textures& textures)
      : e_(emitter), scene_(scene), source_(source), textures_(textures) {}

  void add() {
    if (e_.type == "point")
      point();
    else if (e_.type == "spot")
      spot();
    else if (e_.type == "directional")
      sun();
    else if (e_.type == "constant")
      constant();
    else if (e_.type == "envmap")
      envmap();
    else if (e_.type == "portal")
      portal();
    else
      return source_.lose(e_.place, fmt::format("emitters of type \"{}\" are not read and left out",
                                                shown(e_.type, 40)));
    e_.ignore({"sampling_weight", "mis_compensation", "cache"});  // how it is sampled and kept
    for (const Object* medium : e_.nested("medium"))
      source_.lose(medium->place, "media (fog, absorption, scattering) are left out");
  }

 private:
  Lamp lamp(Lamp::Kind kind, const char* strength) {
    Lamp out;
    out.kind = kind;
    out.name = e_.id.empty() ? e_.type : e_.id;
    out.intensity = textures_.plain_colour(e_, strength, Rgb(1), Of::light);
    return out;
  }

  void point() {
    Lamp out = lamp(Lamp::Kind::point, "intensity");
    const Affine map = e_.map("to_world", source_);
    out.at = e_.vector("position").value_or(map.t);
    scene_.lamps.push_back(out);
  }

  void spot() {
    Lamp out = lamp(Lamp::Kind::spot, "intensity");
    const Affine map = e_.map("to_world", source_);
    out.at = map.t;
    out.towards = axes_of(map, e_.place).z;
    const double outer = e_.number("cutoff_angle", 20),
                 inner = e_.number("beam_width", outer * 0.75);
    if (!(outer > 0 && outer <= 180 && inner >= 0 && inner <= outer))
      e_.fail(fmt::format("a spot of beam_width {} and cutoff_angle {}", inner, outer));
    out.outer = outer * std::numbers::pi / 180, out.inner = inner * std::numbers::pi / 180;
    if (inner < outer)
      source_.lose(e_.place,
                   "between beam_width and cutoff_angle spots fade as glTF has it, "
                   "not linearly in the angle");
    if (e_.find("texture")) source_.lose(e_.place, "the textures of spots are left out");
    scene_.lamps.push_back(out);
  }

  void sun() {
    Lamp out = lamp(Lamp::Kind::sun, "irradiance");
    const auto direction = e_.vector("direction");
    out.towards = direction ? *direction : axes_of(e_.map("to_world", source_), e_.place).z;
    if (!(length(out.towards) > 0)) e_.fail("a direction of length 0");
    scene_.lamps.push_back(out);
  }

  void keep(const Sky& sky) {
    if (scene_.sky) return source_.lose(e_.place, "of several skies the first is taken");
    scene_.sky = sky;
  }

  void constant() {
    Sky sky;
    sky.colour = textures_.plain_colour(e_, "radiance", Rgb(1), Of::light);
    e_.ignore({"to_world"});  // the same all around
    keep(sky);
  }

  void envmap() {
    Sky sky;
    const std::string file = e_.needed_text("filename");
    sky.image = textures_.image(file, e_.find("filename")->place);
    sky.colour = Rgb(static_cast<float>(e_.number("scale", 1)));
    if (e_.number("gamma", 0) != 0) source_.lose(e_.place, "the gamma of an envmap is left out");
    sky.to_map = kHalfTurn * inverse(axes_of(e_.map("to_world", source_), e_.place), e_.place);
    keep(sky);
  }

  // The square of a rectangle; +z leads into the room.
  void portal() {
    Shape out;
    out.mesh = scene_.meshes.size();
    out.to_world = e_.map("to_world", source_);
    scene_.meshes.push_back(square());
    scene_.portals.push_back(out);
  }

  const Object& e_;
  Described& scene_;
  Source& source_;
  Textures& textures_;
};

}  // namespace

void add_light(const Object& emitter, Described& scene, Source& source, Textures& textures) {
  Lights(emitter, scene, source, textures).add();
}

}  // namespace tdpt::foreign::mitsuba
