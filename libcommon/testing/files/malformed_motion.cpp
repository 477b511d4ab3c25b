#include <limits>

#include "libcommon/testing/files/malformed_list.h"

namespace tdpt::testing {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Json& primitive(GlbBuilder& b) {
  return b.json["meshes"][0]["primitives"][0];
}

void instances(MalformedList& l) {
  const std::string at = "nodes[0].extensions.EXT_mesh_gpu_instancing";
  /// The square, instanced by some attributes.
  const auto instanced = [&](const std::string& file,
                             const std::function<void(GlbBuilder&, Json&)>& set,
                             const std::string& expected) {
    l.spoil(
        "instances-" + file,
        [&](GlbBuilder& b) {
          set(b, b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]);
        },
        expected);
  };
  instanced(
      "counts",
      [](GlbBuilder& b, Json& a) {
        a["TRANSLATION"] = b.floats({0, 0, 0, 1, 0, 0}, 3);
        a["SCALE"] = b.floats({1, 1, 1}, 3);
      },
      at + ".attributes.SCALE: count is 1, expected 2 as of TRANSLATION");
  instanced(
      "vec4",
      [](GlbBuilder& b, Json& a) {
        a["TRANSLATION"] = b.floats({0, 0, 0, 1}, 4);
      },
      "accessors[2].type: translations are not VEC3");
  instanced(
      "integers",
      [](GlbBuilder& b, Json& a) {
        a["ROTATION"] = b.accessor(b.view(std::string(8, '\1')), 5122, "VEC4", 1);
      },
      "accessors[2].componentType: rotations are of type 5122, expected 5126 (float), or 5120 to "
      "5123, normalized");
  instanced(
      "rotation",
      [](GlbBuilder& b, Json& a) {
        a["ROTATION"] = b.floats({0, 0, 0, 0}, 4);
      },
      "accessors[2]: rotation 0 is zero, expected a unit quaternion");
  instanced(
      "nan",
      [](GlbBuilder& b, Json& a) {
        a["SCALE"] = b.floats({1, 1, 1, 1, kNan, 1}, 3);
      },
      "accessors[2]: element 1 of scales is not finite");
  instanced(
      "beyond",
      [](GlbBuilder& b, Json& a) {
        a["SCALE"] = b.floats({1, 1, 1}, 3);
        b.json["accessors"][2]["count"] = 3;
      },
      "accessors[2]: 3 elements, 12 bytes apart, from byte 0 reach beyond bufferViews[2] of 12 "
      "bytes");
  instanced(
      "nowhere", [](GlbBuilder&, Json& a) { a["SCALE"] = 7; },
      at + ".attributes.SCALE: is 7, expected an index into the 2 accessors");
  l.replace("instances-none", "/nodes/0/extensions", {{"EXT_mesh_gpu_instancing", Json::object()}},
            at + ".attributes: is missing");
  l.replace("visible-text", "/nodes/0/extensions", {{"KHR_node_visibility", {{"visible", "no"}}}},
            "nodes[0].extensions.KHR_node_visibility.visible: is \"no\", expected true or false");
}

/// The square follows one joint.
void add_skin(GlbBuilder& b) {
  b.node({{"translation", {0, 0, 1}}});
  b.json["skins"] = Json::array({{{"joints", {2}}}});
  b.json["nodes"][0]["skin"] = 0;
  primitive(b)["attributes"]["JOINTS_0"] =
      b.accessor(b.view(std::string(16, '\0')), 5121, "VEC4", 4);
  primitive(b)["attributes"]["WEIGHTS_0"] =
      b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4);
}

/// The square with a corrupted skin.
void skinned(MalformedList& l, const std::string& file,
             const std::function<void(GlbBuilder&)>& spoil, const std::string& expected) {
  l.spoil(
      "skin-" + file,
      [&](GlbBuilder& b) {
        add_skin(b);
        spoil(b);
      },
      expected);
}

void skins(MalformedList& l) {
  skinned(
      l, "missing", [](GlbBuilder& b) { b.json["nodes"][0]["skin"] = 1; },
      "nodes[0].skin: is 1, expected an index into the 1 skins");
  skinned(
      l, "no-joints", [](GlbBuilder& b) { b.json["skins"][0]["joints"] = Json::array(); },
      "skins[0].joints: is missing or empty, expected at least one joint");
  skinned(
      l, "joint-missing", [](GlbBuilder& b) { b.json["skins"][0]["joints"] = {5}; },
      "skins[0].joints[0]: is 5, expected an index into the 3 nodes");
  skinned(
      l, "joint-in-a-cycle",
      [](GlbBuilder& b) {
        b.json["nodes"].push_back({{"children", {4}}});
        b.json["nodes"].push_back({{"children", {3}}});
        b.json["skins"][0]["joints"] = {3};
      },
      "nodes[3]: is its own ancestor, expected a tree of nodes");
  skinned(
      l, "matrices-few",
      [](GlbBuilder& b) {
        b.json["skins"][0]["joints"] = {2, 1};
        b.json["skins"][0]["inverseBindMatrices"] =
            b.accessor(b.view(std::string(64, '\0')), 5126, "MAT4", 1);
      },
      "accessors[4]: count is 1, expected at least 2 inverse bind matrices");
  skinned(
      l, "matrices-vec4",
      [](GlbBuilder& b) {
        b.json["skins"][0]["inverseBindMatrices"] = b.floats({1, 0, 0, 0}, 4);
      },
      "accessors[4].type: inverse bind matrices are not MAT4");
}

void joints(MalformedList& l) {
  skinned(
      l, "joint-beyond", [](GlbBuilder& b) { b.bin[60 + 5] = '\1', b.bin[76 + 16 + 4] = '\1'; },
      "accessors[2]: joint 1 of vertex 1 is out of range, the skin has 1 joints");
  skinned(
      l, "joints-float", [](GlbBuilder& b) { primitive(b)["attributes"]["JOINTS_0"] = 3; },
      "accessors[3].componentType: joints are of type 5126, expected 5121, 5123 or 5125");
  skinned(
      l, "joints-count", [](GlbBuilder& b) { b.json["accessors"][2]["count"] = 3; },
      "accessors[2]: count is 3, expected at least 4 joints");
  skinned(
      l, "weights-count", [](GlbBuilder& b) { b.json["accessors"][3]["count"] = 3; },
      "accessors[3]: count is 3, expected at least 4 weights");
  skinned(
      l, "weights-integers", [](GlbBuilder& b) { primitive(b)["attributes"]["WEIGHTS_0"] = 2; },
      "accessors[2].componentType: weights are of type 5121, expected 5126 (float), or 5120 to "
      "5123, normalized");
  skinned(
      l, "weights-nan",
      [](GlbBuilder& b) {
        primitive(b)["attributes"]["WEIGHTS_0"] =
            b.floats({1, 0, 0, 0, 1, 0, 0, kNan, 1, 0, 0, 0, 1, 0, 0, 0}, 4);
      },
      "accessors[4]: element 1 of weights is not finite");
}

/// Adds a morph target of weight 1 to the square.
void add_target(GlbBuilder& b, int delta) {
  primitive(b)["targets"] = Json::array({{{"POSITION", delta}}});
  b.json["meshes"][0]["weights"] = {1};
}

void morphs(MalformedList& l) {
  l.spoil(
      "target-count",
      [](GlbBuilder& b) {
        add_target(b, b.floats({0, 0, 1}, 3));
      },
      "accessors[2]: count is 1, expected at least 4 positions");
  l.spoil(
      "target-vec2",
      [](GlbBuilder& b) {
        add_target(b, b.floats({0, 0, 0, 0, 0, 0, 0, 0}, 2));
      },
      "accessors[2].type: positions are not VEC3");
  l.spoil(
      "target-missing", [](GlbBuilder& b) { add_target(b, 9); },
      "meshes[0].primitives[0].targets[0].POSITION: is 9, expected an index into the 2 accessors");
  l.spoil(
      "targets-type", [](GlbBuilder& b) { primitive(b)["targets"] = 1; },
      "meshes[0].primitives[0].targets: is 1, expected an array");
  l.replace("weights-type", "/nodes/0/weights", {"1"},
            "nodes[0].weights[0]: is \"1\", expected a number");
  l.replace("weights-no-array", "/meshes/0/weights", 1,
            "meshes[0].weights: is 1, expected an array of numbers");
}

void animations(MalformedList& l) {
  /// The square's node is animated by accessors[2], which holds one VEC3.
  const auto animated = [&](const std::string& file, const std::function<void(Json&)>& spoil,
                            const std::string& expected) {
    l.spoil(
        "animation-" + file,
        [&](GlbBuilder& b) {
          const int output = b.floats({0, 0, 1}, 3), input = b.floats({0}, 1);
          Json animation = {
              {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
              {"samplers", {{{"input", input}, {"output", output}}}}};
          spoil(animation);
          b.json["animations"] = Json::array({animation});
        },
        expected);
  };
  const std::string channel = "animations[0].channels[0]";
  animated(
      "sampler", [](Json& a) { a["channels"][0]["sampler"] = 1; },
      channel + ".sampler: is 1, expected an index into the 1 samplers");
  animated(
      "node", [](Json& a) { a["channels"][0]["target"]["node"] = 7; },
      channel + ".target.node: is 7, expected an index into the 2 nodes");
  animated(
      "output", [](Json& a) { a["samplers"][0]["output"] = 7; },
      "animations[0].samplers[0].output: is 7, expected an index into the 4 accessors");
  animated(
      "rotation", [](Json& a) { a["channels"][0]["target"]["path"] = "rotation"; },
      "accessors[2].type: rotations are not VEC4");
  animated(
      "input", [](Json& a) { a["samplers"][0].erase("input"); },
      "animations[0].samplers[0].input: is missing");
  animated(
      "times", [](Json& a) { a["samplers"][0]["input"] = 2; },
      "accessors[2].type: times are not SCALAR");
  l.spoil(
      "animation-times-back",
      [](GlbBuilder& b) {
        const int output = b.floats({0, 0, 1, 0, 0, 2, 0, 0, 3}, 3), input = b.floats({0, 2, 1}, 1);
        b.json["animations"] = Json::array(
            {{{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
              {"samplers", {{{"input", input}, {"output", output}}}}}});
      },
      "accessors[3]: key 2 lies at 1 s, before key 1 at 2 s, expected times in order");
  animated(
      "spline", [](Json& a) { a["samplers"][0]["interpolation"] = "CUBICSPLINE"; },
      "accessors[2]: count is 1, expected at least 3 translations");
}

}  // namespace

void add_malformed_motion(MalformedList& l) {
  instances(l);
  skins(l);
  joints(l);
  morphs(l);
  animations(l);
}

}  // namespace tdpt::testing
