// Checks lights and the nodes that hold them: see gltf/checker.h.
#include <fmt/format.h>
#include <numbers>
#include <utility>

#include "libcommon/scene/gltf/checker.h"

namespace tdpt::gltf {
namespace {

constexpr const char *kLights = "KHR_lights_punctual", *kProfiles = "EXT_lights_ies",
                     *kAreas = "EXT_lights_area";

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

void check_profiles(Checker& c, Json& root) {
  if (!root.contains("extensions") || !root["extensions"].contains(kProfiles)) return;
  Json& profiles = root["extensions"][kProfiles]["lights"];
  const std::string where = fmt::format("extensions.{}.lights", kProfiles);
  for (size_t i = 0; i < profiles.size(); ++i) {
    Json& p = profiles[i];
    const std::string at = place(where.c_str(), i);
    c.check(p, at, {text("uri"), index("bufferView", "bufferViews")});
    if (!p.contains("bufferView") && !p.contains("uri"))
      c.fail_missing(at + ".uri", "a profile needs one or a bufferView");
  }
}

void check_more_than_0(Checker& c, const Json& owner, const std::string& at, const char* name) {
  if (owner.contains(name) && !(owner[name].get<double>() > 0))
    c.fail(at + "." + name, owner[name], "more than 0");
}

void check_rect(Checker& c, Json& light, const std::string& at) {
  c.check(light, at, {object("rect")});
  if (!light.contains("rect")) return;
  c.check(light["rect"], at + ".rect", {number("aspect")});
  check_more_than_0(c, light["rect"], at + ".rect", "aspect");
}

void check_areas(Checker& c, Json& root) {
  if (!root.contains("extensions") || !root["extensions"].contains(kAreas)) return;
  const std::string where = std::string("extensions.") + kAreas;
  c.each(root["extensions"][kAreas], where, "lights", [&](Json& l, const std::string& at) {
    c.check(l, at,
            {text("name"), text("type", true), numbers("color", 3, 0),
             number("intensity", false, 0), number("size")});
    const auto type = l["type"].get<std::string>();
    if (type != "rect" && type != "disk") c.fail(at + ".type", l["type"], "rect or disk");
    check_more_than_0(c, l, at, "size");
    check_rect(c, l, at);
  });
}

/// The index of a light in the list of an extension.
void check_index_of_light(Checker& c, const Json& root, const Json& node, const std::string& at,
                          const char* name) {
  const Json& light = node["extensions"][name]["light"];
  const Json::json_pointer list(std::string("/extensions/") + name + "/lights");
  const size_t n = root.contains(list) ? root[list].size() : 0;
  if (light.get<uint64_t>() >= n)
    c.fail(at + ".extensions." + name + ".light", light,
           fmt::format("an index into the {} lights", n));
}

}  // namespace

void check_lights(Checker& c, Json& root) {
  check_profiles(c, root);
  check_areas(c, root);
  if (!root.contains("extensions") || !root["extensions"].contains(kLights)) return;
  Json& owner = root["extensions"][kLights];
  const std::string where = std::string("extensions.") + kLights;
  c.each(owner, where, "lights", [&](Json& l, const std::string& at) {
    c.check(
        l, at,
        {text("name"), text("type", true), numbers("color", 3, 0), number("intensity", false, 0)});
    const auto type = l["type"].get<std::string>();
    if (type != "point" && type != "spot" && type != "directional")
      c.fail(at + ".type", l["type"], "point, spot or directional");
    if (type == "spot") check_spot(c, l, at);
  });
}

void check_light_of_node(Checker& c, const Json& root, Json& n, const std::string& at) {
  for (const char* name : {kLights, kAreas})
    if (c.check_extension(n, at, name, {integer("light", true)}))
      check_index_of_light(c, root, n, at, name);
  if (c.check_extension(
          n, at, kProfiles,
          {integer("light", true), number("multiplier", false, 0), numbers("color", 3, 0)}))
    check_index_of_light(c, root, n, at, kProfiles);
}

}  // namespace tdpt::gltf
