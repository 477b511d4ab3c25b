// By pbrt-v3's lights/*.cpp and pbrt-v4's lights.cpp. In pbrt-v4, an `rgb` stands for that colour
// in daylight, and "scale" is divided by the daylight's luminance: rgb 1 1 1 is radiance 1 1 1.
#include "tools/tdpt-import/pbrt/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/images.h"
#include "tools/tdpt-import/pbrt/context.h"
#include "tools/tdpt-import/pbrt/textures.h"

namespace tdpt::foreign::pbrt {
namespace {

constexpr double kPi = std::numbers::pi;

Rgb times(const Rgb& c, double k) {
  return c * static_cast<float>(k);
}

// "scale" is a spectrum in pbrt-v3.
Rgb light_colour(Context& context, const Parameters& list, const std::string& name) {
  Rgb colour = colour_of(context, list, name, Use::light, Rgb(1));
  list.ignore({"samples", "nsamples"});  // how it is sampled
  colour = context.v4 ? times(colour, list.number("scale", 1))
                      : colour * colour_of(context, list, "scale", Use::light, Rgb(1));
  if (!is_finite(colour)) Source::fail(list.place, "the light is too bright");
  return colour;
}

// What a light of `per_unit` must be multiplied by to have the power or illuminance `name`.
double to_reach(const Parameters& list, const std::string& name, double per_unit) {
  const double wanted = list.number(name, -1);
  constexpr double kMost = 1e30;
  if (wanted > kMost) Source::fail(list.place, fmt::format("\"{}\" is above 1e30", name));
  return wanted > 0 && per_unit > 0 ? wanted / per_unit : 1;
}

Vec3d position(const Context& context, const Parameters& list, const Affine& to_world) {
  const Vec3d from = list.point("from", {});
  // pbrt-v3 moves its point lights after the transformation.
  return context.v4 ? to_world.point(from) : to_world.t + from;
}

void add_point(Context& context, const Parameters& list, const Affine& to_world) {
  Lamp lamp;
  lamp.name = "point";
  lamp.at = position(context, list, to_world);
  lamp.intensity = times(light_colour(context, list, "I"), to_reach(list, "power", 4 * kPi));
  context.scene.lamps.push_back(lamp);
}

void add_spot(Context& context, const Parameters& list, const Affine& to_world) {
  Lamp lamp;
  lamp.kind = Lamp::Kind::spot;
  lamp.name = "spot";
  const Vec3d from = list.point("from", {}), to = list.point("to", {0, 0, 1});
  lamp.at = to_world.point(from);
  lamp.towards = to_world.vector(to - from);
  const double cone = std::clamp(list.number("coneangle", 30), 0.0, 180.0);
  const double delta = std::clamp(list.number("conedeltaangle", 5), 0.0, cone);
  lamp.outer = cone * kPi / 180;
  lamp.inner = (cone - delta) * kPi / 180;
  const double start = std::cos(lamp.inner), end = std::cos(lamp.outer);
  lamp.intensity = times(light_colour(context, list, "I"),
                         to_reach(list, "power", 2 * kPi * ((1 - start) + (start - end) / 2)));
  if (delta > 0)
    context.source.lose(list.place,
                        "the course of a spot's intensity between its two cones "
                        "becomes glTF's");
  if (!(length(lamp.towards) > 0)) Source::fail(list.place, "the spot has no direction");
  context.scene.lamps.push_back(lamp);
}

void add_distant(Context& context, const Parameters& list, const Affine& to_world) {
  Lamp lamp;
  lamp.kind = Lamp::Kind::sun;
  lamp.name = "distant";
  lamp.towards = to_world.vector(list.point("to", {0, 0, 1}) - list.point("from", {}));
  if (!(length(lamp.towards) > 0)) Source::fail(list.place, "the distant light has no direction");
  lamp.intensity = times(light_colour(context, list, "L"), to_reach(list, "illuminance", 1));
  context.scene.lamps.push_back(lamp);
}

// The upper half of the equal-area square about +z: its inner diamond |2u-1| + |2v-1| < 1.
// Cosine there: 1 - r^2 with r = |2u-1| + |2v-1| (Clarberg 2008).
double illuminance_of_square(const Context& context, const Image& image) {
  const Texels t = decode(image.bytes, context.source.shown_name(image.name));
  double sum = 0;
  for (int y = 0; y < t.height; ++y)
    for (int x = 0; x < t.width; ++x) {
      const double u = 2 * (x + 0.5) / t.width - 1, v = 2 * (y + 0.5) / t.height - 1;
      const double r = std::abs(u) + std::abs(v);
      if (r < 1)
        sum += luminance(t.rgb[static_cast<size_t>(y) * static_cast<size_t>(t.width) +
                               static_cast<size_t>(x)]) *
               (1 - r * r);
    }
  return sum * 4 * kPi / (static_cast<double>(t.width) * t.height);
}

bool is_alike(const Sky& a, const Sky& b) {
  const auto near = [](const auto& x, const auto& y) { return length(x - y) <= 1e-5f * length(x); };
  return a.image == b.image && near(a.colour, b.colour) &&
         (!a.image || (near(a.to_map.x, b.to_map.x) && near(a.to_map.y, b.to_map.y) &&
                       near(a.to_map.z, b.to_map.z)));
}

// pbrt-v4's window for a light, in the world's own coordinates. Corners run counter-clockwise as
// seen from the room [PortalImageInfiniteLight: Frame::FromXY(p03, p01), whose z leads out].
bool add_portal(Context& context, const Parameters& list) {
  const std::vector<double>* p = context.v4 ? list.tuples("portal", 3) : nullptr;
  if (!p || p->empty()) return false;
  if (p->size() != 12)
    Source::fail(list.place, fmt::format("a portal of {} corners, expected 4", p->size() / 3));
  Mesh mesh;
  for (size_t i = 0; i < 12; i += 3)
    mesh.positions.push_back({static_cast<float>((*p)[i]), static_cast<float>((*p)[i + 1]),
                              static_cast<float>((*p)[i + 2])});
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  Shape portal;
  portal.mesh = context.scene.meshes.size();
  context.scene.meshes.push_back(std::move(mesh));
  context.scene.portals.push_back(portal);
  return true;
}

void add_infinite(Context& context, const Parameters& list, const Affine& to_world) {
  Sky sky;
  sky.colour = light_colour(context, list, "L");
  const bool has_portal = add_portal(context, list);
  Affine from_world = inverse(to_world, list.place);
  const double size = length(from_world.x);
  from_world = {from_world.x / size, from_world.y / size, from_world.z / size, {}};
  for (const Vec3d& axis : {from_world.y, from_world.z})
    if (std::abs(length(axis) - 1) > 1e-5 || std::abs(dot(axis, from_world.x)) > 1e-5) {
      context.source.lose(list.place, "a sky that is stretched or sheared is not turned");
      from_world = {};
      break;
    }
  const std::string file = list.text(context.v4 ? "filename" : "mapname");
  if (!file.empty()) sky.image = context.image(file, list.place);
  if (context.v4) {
    // pbrt scales by the mean over the square, which counts the upper half alone: 2 pi, not 4 pi.
    // One colour behind a portal is a square of one texel, at the zenith.
    const double per_unit =
        sky.image && list.find("illuminance")
            ? illuminance_of_square(context, context.scene.images[*sky.image]) / 2
        : has_portal && !sky.image
            ? 2 * kPi * luminance(colour_of(context, list, "L", Use::light, Rgb(1)))
            : kPi;
    sky.colour = times(sky.colour, to_reach(list, "illuminance", per_unit));
    sky.layout = Sky::Layout::octahedral;
    sky.to_map = from_world;
  } else {
    // u = phi / 2 pi about +z from +x, v = theta / pi from +z: (x, y, z) -> (-y, z, x).
    Affine turn;
    turn.x = {0, 0, 1};
    turn.y = {-1, 0, 0};
    turn.z = {0, 1, 0};
    sky.to_map = turn * from_world;
    sky.srgb = false;
  }
  if (has_portal)
    context.source.lose(list.place,
                        "in pbrt the light of a sky with portals comes in by these alone, here by "
                        "every opening");
  if (has_portal && context.portals_sky) {  // seen through another window
    if (!is_alike(*context.portals_sky, sky))
      context.source.lose(list.place, "all portals lead to the sky of the first one");
    return;
  }
  if (has_portal) context.portals_sky = sky;
  if (!context.scene.sky) {
    context.scene.sky = sky;
  } else if (!sky.image && !context.scene.sky->image) {
    context.scene.sky->colour = context.scene.sky->colour + sky.colour;
  } else {
    context.source.lose(list.place, "infinite lights after the first are left out");
  }
}

void add_goniometric(Context& context, const Parameters& list, const Affine& to_world) {
  context.source.lose(list.place, "a goniometric light becomes a point that shines evenly");
  list.ignore({"filename", "mapname"});
  add_point(context, list, to_world);
}

void add_projection(Context& context, const Parameters& list, const Affine& to_world) {
  context.source.lose(list.place, "a projector becomes a spot without its image");
  list.ignore({"filename", "mapname"});
  Lamp lamp;
  lamp.kind = Lamp::Kind::spot;
  lamp.name = "projection";
  lamp.at = to_world.t;
  lamp.towards = to_world.z;
  lamp.outer = lamp.inner =
      std::clamp(list.number("fov", context.v4 ? 90 : 45), 0.0, 179.0) * kPi / 360;
  lamp.intensity = light_colour(context, list, "I");
  context.scene.lamps.push_back(lamp);
}

struct Kind {
  const char* name;
  void (*add)(Context&, const Parameters&, const Affine&);
};
constexpr Kind kKinds[] = {{"point", add_point},          {"spot", add_spot},
                           {"distant", add_distant},      {"infinite", add_infinite},
                           {"exinfinite", add_infinite},  {"goniometric", add_goniometric},
                           {"projection", add_projection}};

}  // namespace

void add_light(Context& context, const std::string& kind, const Parameters& list,
               const Affine& to_world) {
  for (const Kind& known : kKinds)
    if (kind == known.name) return known.add(context, list, to_world);
  context.source.lose(list.place,
                      fmt::format("the light \"{}\" is not known and left out", shown(kind)));
  list.ignore_all();
}

AreaLight area_light(Context& context, const std::string& kind, const Parameters& list) {
  AreaLight light;
  if (kind != "diffuse" && kind != "area") {
    context.source.lose(
        list.place, fmt::format("the area light \"{}\" is not known and left out", shown(kind)));
    list.ignore_all();
    return light;
  }
  light.emission.radiance.factor = light_colour(context, list, "L");
  light.emission.both_sides = list.flag("twosided", false);
  if (context.v4) {
    light.power = std::max(list.number("power", -1), 0.0);
    const std::string file = list.text("filename");
    if (!file.empty()) {
      light.emission.radiance.texture = picture(context, file, list.place, true);
      light.emission.radiance.texture->wrap_u = light.emission.radiance.texture->wrap_v =
          Texture::Wrap::clamp;
      if (light.power > 0) {  // the power is that of the mean luminance of the image
        const Image& image = context.scene.images[light.emission.radiance.texture->image];
        const Texels t = decode(image.bytes, context.source.shown_name(image.name));
        double mean = 0;
        for (const Rgb& texel : t.rgb) mean += luminance(texel) / static_cast<double>(t.rgb.size());
        if (mean > 0) light.power /= mean;
      }
    }
  }
  return light;
}

}  // namespace tdpt::foreign::pbrt
