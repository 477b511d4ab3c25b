// Checks lights and the nodes that hold them: see gltf/checker.h.
#include <fmt/format.h>
#include <numbers>
#include <utility>

#include "libcommon/scene/gltf/checker.h"

namespace tdpt::gltf {
namespace {

constexpr const char *kLights = "KHR_lights_punctual", *kProfiles = "EXT_lights_ies",
                     *kAreas = "EXT_lights_area";
/// Extensions with the sections that track the uses of their lights.
constexpr std::pair<const char*, const char*> kLists[] = {
    {kLights, "lights"}, {kProfiles, kProfiles}, {kAreas, kAreas}};

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

// Checks profiles used by visible nodes; others are not read.
void check_profiles(Checker& c, Json& root) {
  if (!root.contains("extensions") || !root["extensions"].contains(kProfiles)) return;
  Json& profiles = root["extensions"][kProfiles]["lights"];
  const std::string where = fmt::format("extensions.{}.lights", kProfiles);
  for (size_t i = 0; i < profiles.size(); ++i) {
    if (!c.uses.has(kProfiles, i)) continue;
    Json& p = profiles[i];
    const std::string at = place(where.c_str(), i);
    c.check(p, at, {text("uri"), index("bufferView", "bufferViews")});
    if (p.contains("bufferView"))
      c.uses.mark("bufferViews", p["bufferView"].get<size_t>());
    else if (!p.contains("uri"))
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
  c.each(root["extensions"][kAreas], where, "lights", kAreas, [&](Json& l, const std::string& at) {
    c.check(l, at,
            {name_of("name"), text("type", true), numbers("color", 3, 0),
             number("intensity", false, 0), number("size")});
    const auto type = l["type"].get<std::string>();
    if (type != "rect" && type != "disk") c.fail(at + ".type", l["type"], "rect or disk");
    check_more_than_0(c, l, at, "size");
    if (type == "rect") return check_rect(c, l, at);
    if (!c.tolerate([&] { check_rect(c, l, at); })) l.erase("rect");
  });
}

void check_index_of_light(Checker& c, const Json& light, const std::string& at, const char* list) {
  const size_t n = c.uses.of(list).size();
  if (light.get<uint64_t>() >= n) c.fail(at, light, fmt::format("an index into the {} lights", n));
}

}  // namespace

void count_lights(Checker& c, Json& root) {
  for (const auto& [name, list] : kLists) {
    const Json* const owner = c.check_extension(root, "", name, {objects("lights")});
    c.uses.count(list, owner ? owner->value("lights", Json::array()).size() : 0);
  }
}

void check_lights(Checker& c, Json& root) {
  check_profiles(c, root);
  check_areas(c, root);
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
  for (const auto& [name, list] : {kLists[0], kLists[2]})
    if (const Json* e = c.check_extension(n, at, name, {integer("light", true)}))
      check_index_of_light(c, (*e)["light"], at + ".extensions." + name + ".light", list);
  if (const Json* e = c.check_extension(
          n, at, kProfiles,
          {integer("light", true), number("multiplier", false, 0), numbers("color", 3, 0)}))
    check_index_of_light(c, (*e)["light"], at + ".extensions." + kProfiles + ".light", kProfiles);
}

void mark_light_of_node(Uses& uses, const Json& n) {
  const Json extensions = n.value("extensions", Json::object());
  for (const auto& [name, list] : kLists)
    if (extensions.contains(name)) uses.mark(list, extensions[name]["light"].get<size_t>());
}

void leave_out_light(Json& n) {
  for (const auto& [name, list] : kLists) n["extensions"].erase(name);
}

}  // namespace tdpt::gltf
