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

/// Checks a node, except for its camera, on which the picture does not depend unless it is
/// selected.
void check_node(Checker& c, Json& n, const std::string& at, bool shown) {
  c.check(n, at,
          {name_of("name"), indices("children", "nodes"), index("camera", "cameras"),
           numbers("matrix", 16), numbers("translation", 3), numbers("rotation", 4),
           numbers("scale", 3)});
  c.check_extension(n, at, kVisibility, {boolean("visible")});
  const auto check_content = [&] {
    c.check(n, at, {index("mesh", "meshes"), index("skin", "skins")});
    check_weights(c, n, at);
    check_node_extensions(c, n, at);
  };
  if (shown && !is_hidden(n)) return check_content();
  if (c.tolerate(check_content)) return;
  for (const char* name : {"mesh", "skin", "weights"}) n.erase(name);
  if (!n.contains("extensions")) return;
  leave_out_light(n);
  n["extensions"].erase(kInstances);
}

void mark_accessors_of_instances(Uses& uses, const Json& extensions) {
  if (!extensions.contains(kInstances)) return;
  for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"})
    if (const Json& a = extensions[kInstances]["attributes"]; a.contains(name))
      uses.mark("accessors", a[name].get<size_t>());
}

/// Marks what a node in the scene holds; of a hidden one only its camera.
void mark_parts_of_node(Uses& uses, const Json& n, bool visible) {
  if (n.contains("camera")) uses.mark("cameras", n["camera"].get<size_t>());
  if (!visible) return;
  const Json extensions = n.value("extensions", Json::object());
  mark_light_of_node(uses, n);
  if (!n.contains("mesh")) return;
  uses.mark("meshes", n["mesh"].get<size_t>());
  if (n.contains("mesh") && n.contains("skin")) uses.mark("skins", n["skin"].get<size_t>());
  mark_accessors_of_instances(uses, extensions);
}

/// The roots of the scene, or all nodes if there is no scene.
std::vector<size_t> first_nodes(Checker& c, Json& root) {
  std::vector<size_t> out;
  if (c.size_of("scenes") == 0) {
    for (size_t i = 0; i < c.size_of("nodes"); ++i) out.push_back(i);
    return out;
  }
  const size_t scene = root.value("scene", size_t{0});
  c.uses.mark("scenes", scene);
  c.each(root, "", "scenes",
         [&](Json& s, const std::string& at) { c.check(s, at, {indices("nodes", "nodes")}); });
  for (const Json& n : root["scenes"][scene].value("nodes", Json::array()))
    out.push_back(n.get<size_t>());
  return out;
}

/// Visits all nodes below, each once, or again if only the second path makes it visible.
void visit_nodes(Checker& c, Json& root, const std::vector<size_t>& first) {
  struct Step {
    size_t node;
    bool visible;
  };
  std::vector<Step> next;
  for (const size_t n : first) next.push_back({n, true});
  std::vector<bool> seen(c.size_of("nodes"));
  while (!next.empty()) {
    const Step step = next.back();
    next.pop_back();
    Json& n = root["nodes"][step.node];
    const bool is_new = c.uses.mark("nodes", step.node);
    if (is_new) check_node(c, n, place("nodes", step.node), step.visible);
    const bool visible = step.visible && !is_hidden(n);
    if (!is_new && (seen[step.node] || !visible)) continue;
    if (visible) seen[step.node] = true;
    mark_parts_of_node(c.uses, n, visible);
    if (!n.contains("children")) continue;
    for (const Json& child : n["children"]) next.push_back({child.get<size_t>(), visible});
  }
}

bool joints_are_in_scene(Checker& c, const Json& root) {
  for (size_t i = 0; i < c.size_of("skins"); ++i)
    if (c.uses.has("skins", i))
      for (const Json& joint : root["skins"][i]["joints"])
        if (!c.uses.has("nodes", joint.get<size_t>())) return false;
  return true;
}

}  // namespace

void check_weights(Checker& c, Json& owner, const std::string& at) {
  if (!owner.contains("weights")) return;
  Json& weights = owner["weights"];
  if (!weights.is_array()) c.fail(at + ".weights", weights, "an array of numbers");
  c.check(owner, at, {numbers("weights", weights.size())});
}

void check_node_extensions(Checker& c, Json& n, const std::string& at) {
  check_light_of_node(c, n, at);
  if (Json* e = c.check_extension(n, at, kInstances, {object("attributes", true)}))
    c.check((*e)["attributes"], at + ".extensions." + kInstances + ".attributes",
            {index("TRANSLATION", "accessors"), index("ROTATION", "accessors"),
             index("SCALE", "accessors")});
}

void check_nodes(Checker& c, Json& root) {
  visit_nodes(c, root, first_nodes(c, root));
}

void check_nodes_outside(Checker& c, Json& root) {
  const std::vector<bool> checked = c.uses.of("nodes");
  if (!joints_are_in_scene(c, root))
    // Any node may be an ancestor of a joint, so all of them count.
    for (size_t i = 0; i < c.size_of("nodes"); ++i) c.uses.mark("nodes", i);
  size_t i = 0;
  c.each(root, "", "nodes", [&](Json& n, const std::string& at) {
    if (!checked[i++]) check_node(c, n, at, false);
  });
}

void check_skins(Checker& c, Json& root) {
  c.each(root, "", "skins", [&](Json& s, const std::string& at) {
    c.check(s, at, {indices("joints", "nodes"), index("inverseBindMatrices", "accessors")});
    if (!s.contains("joints") || s["joints"].empty())
      c.fail_because(at + ".joints", "is missing or empty, expected at least one joint");
  });
  for (size_t i = 0; i < c.size_of("skins"); ++i) {
    if (!c.uses.has("skins", i)) continue;
    const Json& s = root["skins"][i];
    if (s.contains("inverseBindMatrices"))
      c.uses.mark("accessors", s["inverseBindMatrices"].get<size_t>());
  }
}

void check_attributes(Checker& c, Json& attributes, const std::string& at) {
  for (const auto& [name, value] : attributes.items()) {
    const auto check = [&, &n = name] { c.check(attributes, at, {index(n.c_str(), "accessors")}); };
    if (is_read_attribute(name))
      check();
    else
      c.tolerate(check);
  }
  std::erase_if(attributes.get_ref<Json::object_t&>(),
                [](const auto& a) { return !is_read_attribute(a.first); });
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
    c.check(a, at, {name_of("name")});
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
      c_.check(a, at, {objects("channels")});
      if (!a.contains("channels")) ++idle_;
      Json kept = Json::array();
      c_.each(a, at, "channels", [&](Json& channel, const std::string& here) {
        if (counts(a, at, channel, here)) kept.push_back(channel);
      });
      a["channels"] = kept;
    });
    tell(idle_, "animation", "without channels");
    tell(aimless_, "animation channel", "without a target");
    tell(empty_, "animation channel", "without a key");
    if (again_ > 0)
      c_.note(counted(again_, "animation channel",
                      "moves what one before it moves, and is left out",
                      "move what others before them move, and are left out") +
              ": --animation names the animations that count");
    if (unknown_ > 0)
      c_.note(counted(unknown_, "interpolation",
                      "is not LINEAR, STEP or CUBICSPLINE: taken as LINEAR",
                      "are not LINEAR, STEP or CUBICSPLINE: taken as LINEAR"));
  }

 private:
  void tell(size_t n, const char* noun, const std::string& lack) {
    if (n > 0) c_.note(counted(n, noun, lack + " moves nothing", lack + " move nothing"));
  }

  /// Whether the channel moves something visible; checked only as far as that requires.
  bool counts(Json& animation, const std::string& owner, Json& channel, const std::string& at) {
    c_.check(channel, at, {object("target")});
    if (!channel.contains("target")) return ++aimless_, false;
    Json& target = channel["target"];
    const std::string where = at + ".target";
    c_.check(target, where, {text("path"), index("node", "nodes")});
    if (!target.contains("path") && !target.contains("node")) return ++aimless_, false;
    c_.check(target, where, {text("path", true)});
    const auto path = target["path"].get<std::string>();
    if (path == "pointer") return true;
    const bool known =
        path == "translation" || path == "rotation" || path == "scale" || path == "weights";
    if (!known || !target.contains("node")) return false;
    const auto node = target["node"].get<size_t>();
    if (!c_.uses.has("nodes", node)) return false;
    if (moved_.contains({node, path})) return ++again_, false;
    c_.check(channel, at, {integer("sampler", true)});
    c_.check(animation, owner, {objects("samplers", true)});
    Json& samplers = animation["samplers"];
    if (channel["sampler"].get<uint64_t>() >= samplers.size())
      c_.fail(at + ".sampler", channel["sampler"],
              fmt::format("an index into the {} samplers", samplers.size()));
    if (!has_keys(samplers[channel["sampler"].get<size_t>()], at + ".sampler"))
      return ++empty_, false;
    moved_.insert({node, path});
    return true;
  }

  bool has_keys(Json& sampler, const std::string& at) {
    c_.check(sampler, at, {index("input", "accessors", true), index("output", "accessors", true)});
    Json& way = sampler["interpolation"];
    if (!way.is_null() && way != "LINEAR" && way != "STEP" && way != "CUBICSPLINE") ++unknown_;
    if (way != "STEP" && way != "CUBICSPLINE") way = "LINEAR";
    for (const char* end : {"input", "output"})
      if (root_["accessors"][sampler[end].get<size_t>()].value("count", Json(1)) == 0) return false;
    for (const char* end : {"input", "output"})
      c_.uses.mark("accessors", sampler[end].get<size_t>());
    return true;
  }

  Checker& c_;
  Json& root_;
  std::set<std::pair<size_t, std::string>> moved_;
  size_t idle_ = 0, aimless_ = 0, empty_ = 0, again_ = 0, unknown_ = 0;
};

}  // namespace

void check_animations(Checker& c, Json& root, const std::vector<std::string>& wanted) {
  select_animations(c, root, wanted);
  AnimationCheck(c, root).run();
}

}  // namespace tdpt::gltf
