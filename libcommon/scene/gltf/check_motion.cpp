// Checks nodes, instances, skins, morph targets and animations: see gltf/checker.h.
#include <fmt/format.h>
#include <algorithm>
#include <set>

#include "libcommon/scene/gltf/checker.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"

namespace tdpt::gltf {
namespace {

constexpr const char* kInstances = "EXT_mesh_gpu_instancing";

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check_node(Checker& c, const Json& root, Json& n, const std::string& at) {
  c.check(n, at,
          {text("name"), indices("children", "nodes"), index("camera", "cameras"),
           index("mesh", "meshes"), index("skin", "skins"), numbers("matrix", 16),
           numbers("translation", 3), numbers("rotation", 4), numbers("scale", 3)});
  check_weights(c, n, at);
  c.check_extension(n, at, kVisibility, {boolean("visible")});
  check_light_of_node(c, root, n, at);
  if (Json* e = c.check_extension(n, at, kInstances, {object("attributes", true)}))
    c.check((*e)["attributes"], at + ".extensions." + kInstances + ".attributes",
            {index("TRANSLATION", "accessors"), index("ROTATION", "accessors"),
             index("SCALE", "accessors")});
}

}  // namespace

void check_weights(Checker& c, Json& owner, const std::string& at) {
  if (!owner.contains("weights")) return;
  Json& weights = owner["weights"];
  if (!weights.is_array()) c.fail(at + ".weights", weights, "an array of numbers");
  c.check(owner, at, {numbers("weights", weights.size())});
}

void check_nodes(Checker& c, Json& root) {
  c.each(root, "", "scenes",
         [&](Json& s, const std::string& at) { c.check(s, at, {indices("nodes", "nodes")}); });
  c.each(root, "", "nodes", [&](Json& n, const std::string& at) { check_node(c, root, n, at); });
}

void check_skins(Checker& c, Json& root) {
  c.each(root, "", "skins", [&](Json& s, const std::string& at) {
    c.check(s, at, {indices("joints", "nodes"), index("inverseBindMatrices", "accessors")});
    if (!s.contains("joints") || s["joints"].empty())
      c.fail_because(at + ".joints", "is missing or empty, expected at least one joint");
  });
}

void check_attributes(Checker& c, Json& attributes, const std::string& at) {
  std::erase_if(attributes.get_ref<Json::object_t&>(),
                [](const auto& a) { return !is_read_attribute(a.first); });
  for (const auto& [name, value] : attributes.items())
    c.check(attributes, at, {index(name.c_str(), "accessors")});
}

void check_targets(Checker& c, Json& p, const std::string& at) {
  c.check(p, at, {objects("targets")});
  c.each(p, at, "targets", [&](Json& t, const std::string& here) { check_attributes(c, t, here); });
}

namespace {

/// Gives each animation a name of its own and keeps those in `wanted`; the others lose their
/// channels.
void select_animations(Checker& c, Json& root, const std::vector<std::string>& wanted) {
  DistinctNames distinct;
  std::vector<std::string> names;
  c.each(root, "", "animations", [&](Json& a, const std::string& at) {
    c.check(a, at, {text("name")});
    names.push_back(distinct.take(a.value("name", ""), "", "animation"));
    a["name"] = names.back();
    if (wanted.empty() || has(wanted, names.back())) return;
    a = {{"name", names.back()}, {"channels", Json::array()}};
  });
  for (const std::string& name : wanted)
    if (!has(names, name))
      c.fail_because("animations", names.empty()
                                       ? fmt::format("there is none, expected \"{}\"", name)
                                       : fmt::format("none is called \"{}\", expected one of {}",
                                                     name, fmt::join(names, ", ")));
}

/// Checks the channels of the animations, and drops those that move nothing.
class AnimationCheck {
 public:
  AnimationCheck(Checker& c, Json& root) : c_(c), root_(root) {}

  void run() {
    c_.each(root_, "", "animations", [&](Json& a, const std::string& at) {
      c_.check(a, at, {objects("channels"), objects("samplers")});
      Json kept = Json::array();
      c_.each(a, at, "channels", [&](Json& channel, const std::string& here) {
        if (moves(a, channel, here)) kept.push_back(channel);
      });
      a["channels"] = kept;
    });
    if (again_ > 0)
      c_.note(counted(again_, "animation channel",
                      "moves what one before it moves, and is left out",
                      "move what others before them move, and are left out") +
              ": --animation names the animations that count");
  }

 private:
  /// Whether the channel moves a node's property that none before it moves.
  bool moves(Json& animation, Json& channel, const std::string& at) {
    c_.check(channel, at, {object("target", true), integer("sampler", true)});
    Json& target = channel["target"];
    c_.check(target, at + ".target", {text("path", true), index("node", "nodes")});
    const auto path = target["path"].get<std::string>();
    if (path == "pointer") return true;
    if (path != "translation" && path != "rotation" && path != "scale" && path != "weights")
      c_.fail(at + ".target.path", target["path"], "translation, rotation, scale or weights");
    const Json samplers = animation.value("samplers", Json::array());
    if (channel["sampler"].get<uint64_t>() >= samplers.size())
      c_.fail(at + ".sampler", channel["sampler"],
              fmt::format("an index into the {} samplers", samplers.size()));
    check_sampler(animation["samplers"][channel["sampler"].get<size_t>()], at + ".sampler");
    if (!target.contains("node")) return false;  // an extension says what it moves
    if (moved_.insert({target["node"].get<size_t>(), path}).second) return true;
    return ++again_, false;
  }

  void check_sampler(Json& sampler, const std::string& at) {
    c_.check(sampler, at,
             {index("input", "accessors", true), index("output", "accessors", true),
              text("interpolation")});
    const std::string way = sampler.value("interpolation", "LINEAR");
    if (way != "LINEAR" && way != "STEP" && way != "CUBICSPLINE")
      c_.fail(at + ".interpolation", sampler["interpolation"], "LINEAR, STEP or CUBICSPLINE");
    sampler["interpolation"] = way;
  }

  Checker& c_;
  Json& root_;
  std::set<std::pair<size_t, std::string>> moved_;
  size_t again_ = 0;
};

}  // namespace

void check_animations(Checker& c, Json& root, const std::vector<std::string>& wanted) {
  select_animations(c, root, wanted);
  AnimationCheck(c, root).run();
}

}  // namespace tdpt::gltf
