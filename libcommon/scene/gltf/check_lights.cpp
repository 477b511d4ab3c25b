// Lights and the nodes that hold them: see gltf/checker.h.
#include <fmt/format.h>
#include <numbers>

#include "libcommon/scene/gltf/checker.h"

namespace tdpt::gltf {
namespace {

constexpr const char* kLights = "KHR_lights_punctual";

void check_spot(Checker& c, Json& light, const std::string& at) {
  c.check(light, at, {object("spot")});
  if (!light.contains("spot")) return;
  Json& s = light["spot"];
  c.check(s, at + ".spot", {number("innerConeAngle"), number("outerConeAngle")});
  const double inner = s.value("innerConeAngle", 0.0);
  const double outer = s.value("outerConeAngle", std::numbers::pi / 4);
  // Files round pi/2 to single precision.
  if (!(inner >= 0 && inner <= outer && outer > 0 && outer <= std::numbers::pi / 2 + 1e-6))
    c.fail_because(at + ".spot",
                   fmt::format("has an inner cone of {} and an outer one of {}, expected "
                               "0 <= inner <= outer, 0 < outer <= pi/2",
                               inner, outer));
}

}  // namespace

void count_lights(Checker& c, Json& root) {
  const Json* const owner = c.check_extension(root, "", kLights, {objects("lights")});
  c.uses.count("lights", owner ? owner->value("lights", Json::array()).size() : 0);
}

void check_lights(Checker& c, Json& root) {
  if (!root.contains("extensions") || !root["extensions"].contains(kLights)) return;
  Json& owner = root["extensions"][kLights];
  const std::string where = std::string("extensions.") + kLights;
  c.each(owner, where, "lights", [&](Json& l, const std::string& at) {
    c.check(l, at,
            {name_of("name"), text("type", true), numbers("color", 3, 0),
             number("intensity", false, 0)});
    const auto type = l["type"].get<std::string>();
    if (type != "point" && type != "spot" && type != "directional")
      c.fail(at + ".type", l["type"], "point, spot or directional");
    if (type == "spot") return check_spot(c, l, at);
    if (!c.tolerate([&] { check_spot(c, l, at); })) l.erase("spot");
  });
}

void check_light_of_node(Checker& c, Json& n, const std::string& at) {
  if (const Json* e = c.check_extension(n, at, kLights, {integer("light", true)})) {
    const Json& light = (*e)["light"];
    const size_t lights = c.uses.of("lights").size();
    if (light.get<uint64_t>() >= lights)
      c.fail(at + ".extensions." + kLights + ".light", light,
             fmt::format("an index into the {} lights", lights));
  }
}

void mark_light_of_node(Uses& uses, const Json& n) {
  const Json extensions = n.value("extensions", Json::object());
  if (extensions.contains(kLights)) uses.mark("lights", extensions[kLights]["light"].get<size_t>());
}

void leave_out_light(Json& n) {
  n["extensions"].erase(kLights);
}

}  // namespace tdpt::gltf
