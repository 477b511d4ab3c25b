// Lights, by pbrt-v3's lights/*.cpp and pbrt-v4's lights.cpp. In pbrt-v4, an `rgb` stands for that
// colour in daylight, and "scale" is divided by the daylight's luminance: rgb 1 1 1 is radiance 1
// 1 1.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/pbrt/pbrt.h"

namespace tdpt::foreign::pbrt {
namespace {

constexpr double kPi = std::numbers::pi;

Rgb times(const Rgb& c, double k) {
  return c * static_cast<float>(k);
}

Rgb light_of(const Entity& e, const char* name) {
  return e.spectrum(name, Role::light).value_or(Rgb(1));
}

// "scale" is a spectrum in pbrt-v3.
Rgb scaled_light(const Entity& e, const char* name) {
  const Rgb colour = light_of(e, name);
  e.ignore({"samples", "nsamples"});  // how it is sampled
  const Rgb out =
      e.context.v4 ? times(colour, e.number("scale", 1)) : colour * light_of(e, "scale");
  if (!is_finite(out)) e.fail("the light is too bright");
  return out;
}

// What a light of `per_unit` must be multiplied by to have the power or illuminance `name`.
double to_reach(const Entity& e, const char* name, double per_unit) {
  const double wanted = e.number(name, -1);
  if (wanted > 1e30) e.fail("\"{}\" is above 1e30", name);
  return wanted > 0 && per_unit > 0 ? wanted / per_unit : 1;
}

void add_lamp(const Entity& e, const Affine& to_world) {
  const Vec3d from = e.point("from", {}), to = e.point("to", {0, 0, 1});
  Lamp lamp;
  if (e.kind == "distant") {
    lamp.kind = Lamp::Kind::sun;
    lamp.intensity = times(scaled_light(e, "L"), to_reach(e, "illuminance", 1));
  } else if (e.kind == "spot") {
    lamp.kind = Lamp::Kind::spot;
    lamp.at = to_world.point(from);
    const double cone = std::clamp(e.number("coneangle", 30), 0.0, 180.0);
    const double delta = std::clamp(e.number("conedeltaangle", 5), 0.0, cone);
    lamp.outer = cone * kPi / 180;
    lamp.inner = (cone - delta) * kPi / 180;
    const double start = std::cos(lamp.inner), end = std::cos(lamp.outer);
    lamp.intensity = times(scaled_light(e, "I"),
                           to_reach(e, "power", 2 * kPi * ((1 - start) + (start - end) / 2)));
    if (delta > 0) e.lose("the course of a spot's intensity between its two cones becomes glTF's");
  } else {
    // pbrt-v3 moves its point lights after the transformation.
    lamp.at = e.context.v4 ? to_world.point(from) : to_world.t + from;
    lamp.intensity = times(scaled_light(e, "I"), to_reach(e, "power", 4 * kPi));
  }
  if (e.kind == "goniometric") {
    e.lose("a goniometric light becomes a point that shines evenly");
    e.ignore({"filename", "mapname"});
  }
  lamp.name = e.kind == "goniometric" ? "point" : e.kind;
  if (lamp.kind != Lamp::Kind::point) lamp.towards = to_world.vector(to - from);
  if (!(length(lamp.towards) > 0)) e.fail("the light has no direction");
  e.context.scene.lamps.push_back(lamp);
}

// The upper half of the equal-area square about +z: its inner diamond |2u-1| + |2v-1| < 1.
// Cosine there: 1 - r^2 with r = |2u-1| + |2v-1| (Clarberg 2008).
double illuminance_of_square(const Texels& t) {
  double sum = 0;
  for (int y = 0; y < t.height; ++y)
    for (int x = 0; x < t.width; ++x) {
      const double u = 2 * (x + 0.5) / t.width - 1, v = 2 * (y + 0.5) / t.height - 1;
      const double r = std::abs(u) + std::abs(v);
      if (r < 1) sum += luminance(t.rgb[t.index(x, y)]) * (1 - r * r);
    }
  return sum * 4 * kPi / (static_cast<double>(t.width) * t.height);
}

// pbrt-v4's window for a light, in the world's own coordinates. Corners run counter-clockwise as
// seen from the room [PortalImageInfiniteLight: Frame::FromXY(p03, p01), whose z leads out].
bool add_portal(const Entity& e) {
  const std::vector<double>* p = e.context.v4 ? e.list("portal", {"point3"}, 3) : nullptr;
  if (!p || p->empty()) return false;
  if (p->size() != 12) e.fail("a portal of {} corners, expected 4", p->size() / 3);
  Mesh mesh;
  for (size_t i = 0; i < 4; ++i) mesh.positions.push_back(vec_at(*p, i));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  Shape portal;
  portal.mesh = e.context.scene.meshes.size();
  e.context.scene.meshes.push_back(std::move(mesh));
  e.context.scene.portals.push_back(portal);
  return true;
}

void add_infinite(const Entity& e, const Affine& to_world) {
  Context& context = e.context;
  Sky sky;
  sky.colour = scaled_light(e, "L");
  const bool has_portal = add_portal(e);
  Affine from_world = inverse(to_world, e.place);
  const double size = length(from_world.x);
  from_world = {from_world.x / size, from_world.y / size, from_world.z / size, {}};
  const auto is_skewed = [&](const Vec3d& axis) {
    return std::abs(length(axis) - 1) > 1e-5 || std::abs(dot(axis, from_world.x)) > 1e-5;
  };
  if (is_skewed(from_world.y) || is_skewed(from_world.z)) {
    e.lose("a sky that is stretched or sheared is not turned");
    from_world = {};
  }
  const std::string file = e.text(context.v4 ? "filename" : "mapname");
  if (!file.empty()) sky.image = context.image(file, e.place);
  if (context.v4) {
    // pbrt scales by the mean over the square, which counts the upper half alone: 2 pi, not 4 pi.
    // One colour behind a portal is a square of one texel, at the zenith.
    const double per_unit = sky.image && e.has("illuminance")
                                ? illuminance_of_square(context.texels(*sky.image)) / 2
                            : has_portal && !sky.image ? 2 * kPi * luminance(light_of(e, "L"))
                                                       : kPi;
    sky.colour = times(sky.colour, to_reach(e, "illuminance", per_unit));
    sky.layout = Sky::Layout::octahedral;
    sky.to_map = from_world;
  } else {
    // u = phi / 2 pi about +z from +x, v = theta / pi from +z: (x, y, z) -> (-y, z, x).
    sky.to_map = Affine{{0, 0, 1}, {-1, 0, 0}, {0, 1, 0}, {}} * from_world;
    sky.srgb = false;
  }
  if (has_portal) {
    e.lose(
        "in pbrt the light of a sky with portals comes in by these alone, here by every opening");
    if (const auto& first = context.portals_sky) {  // seen through another window
      if (sky.image != first->image || sky.colour != first->colour)
        e.lose("all portals lead to the sky of the first one");
      return;
    }
    context.portals_sky = sky;
  }
  std::optional<Sky>& first = context.scene.sky;
  if (!first)
    first = sky;
  else if (!sky.image && !first->image)
    first->colour = first->colour + sky.colour;
  else
    e.lose("infinite lights after the first are left out");
}

}  // namespace

void add_light(const Entity& e, const Affine& to_world) {
  if (e.kind == "infinite" || e.kind == "exinfinite") return add_infinite(e, to_world);
  for (const char* kind : {"point", "spot", "distant", "goniometric"})
    if (e.kind == kind) return add_lamp(e, to_world);
  e.lose("lights of the kind \"{}\" are left out", shown(e.kind));
  e.ignore();
}

AreaLight area_light(const Entity& e) {
  AreaLight light;
  Colour& radiance = light.emission.radiance;
  radiance.factor = scaled_light(e, "L");
  light.emission.both_sides = e.flag("twosided", false);
  if (!e.context.v4) return light;
  light.power = std::max(e.number("power", -1), 0.0);
  const std::string file = e.text("filename");
  if (file.empty()) return light;
  radiance.texture = picture(e, file, true);
  radiance.texture->wrap_u = radiance.texture->wrap_v = Texture::Wrap::clamp;
  if (light.power > 0) {  // the power is that of the mean luminance of the image
    const Texels t = e.context.texels(radiance.texture->image);
    double mean = 0;
    for (const Rgb& texel : t.rgb) mean += luminance(texel) / static_cast<double>(t.rgb.size());
    if (mean > 0) light.power /= mean;
  }
  return light;
}

}  // namespace tdpt::foreign::pbrt
