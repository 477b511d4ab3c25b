#include "libcommon/testing/files/malformed_list.h"

namespace tdpt::testing {
namespace {

/// Two different texels, so that a material keeps the texture.
std::string two_texels() {
  return png_of(2, 1, std::string("\xff\xff\xff\xff\0\0\0\0", 8));
}

/// Gives the square's material a texture.
void add_texture(GlbBuilder& b, const Json& sampler = {}) {
  b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] =
      b.texture(two_texels(), sampler);
}

void attributes(MalformedList& l) {
  /// The square with one more attribute: an accessor of `count` elements over `bytes`.
  const auto attribute = [&](const std::string& file, const std::string& name, int type,
                             const std::string& shape, size_t count, size_t bytes,
                             const std::string& expected) {
    l.spoil(
        file,
        [&](GlbBuilder& b) {
          if (name == "TEXCOORD_0") add_texture(b);
          const int a = b.accessor(b.view(std::string(bytes, '\0')), type, shape, count);
          b.json["meshes"][0]["primitives"][0]["attributes"][name] = a;
        },
        expected);
  };
  attribute("normals-count", "NORMAL", 5126, "VEC3", 3, 36,
            "accessors[2]: count is 3, expected at least 4 normals");
  attribute("normals-vec4", "NORMAL", 5126, "VEC4", 4, 64,
            "accessors[2].type: normals are not VEC3");
  attribute("normals-beyond", "NORMAL", 5126, "VEC3", 4, 44,
            "accessors[2]: 4 elements, 12 bytes apart, from byte 0 reach beyond bufferViews[2] of "
            "44 bytes");
  attribute("texcoords-vec3", "TEXCOORD_0", 5126, "VEC3", 4, 48,
            "accessors[2].type: texture coordinates are not VEC2");
  attribute("texcoords-count", "TEXCOORD_0", 5126, "VEC2", 3, 24,
            "accessors[2]: count is 3, expected at least 4 texture coordinates");
  attribute("colours-vec2", "COLOR_0", 5126, "VEC2", 4, 32,
            "accessors[2].type: vertex colours are not VEC3 or VEC4");
  attribute("colours-signed", "COLOR_0", 5120, "VEC4", 4, 16,
            "accessors[2].componentType: vertex colours are of type 5120, expected 5126 (float), "
            "or 5120 to 5123, normalized");
  l.replace("attribute-missing", "/meshes/0/primitives/0/attributes/NORMAL", 9,
            "meshes[0].primitives[0].attributes.NORMAL: is 9, expected an index into the 2 "
            "accessors");
}

void materials(MalformedList& l) {
  const auto extension = [&](const std::string& file, const std::string& name, const Json& value,
                             const std::string& expected) {
    l.replace(file, "/materials/0/extensions/KHR_materials_" + name, value,
              "materials[0].extensions.KHR_materials_" + name + expected);
  };
  extension("ior-half", "ior", {{"ior", 0.5}},
            ".ior: is 0.5, expected 0 or a number from 1 to 1e6");
  extension("coat-range", "clearcoat", {{"clearcoatFactor", 2}},
            ".clearcoatFactor: is 2, expected a number from 0 to 1");
  extension("coat-rough", "clearcoat", {{"clearcoatRoughnessFactor", "very"}},
            ".clearcoatRoughnessFactor: is \"very\", expected a number");
  extension("sheen-colour", "sheen", {{"sheenColorFactor", {1, 1}}},
            ".sheenColorFactor: is an array of 2, expected an array of 3 numbers");
  extension("sheen-negative", "sheen", {{"sheenColorFactor", {1, -1, 1}}},
            ".sheenColorFactor[1]: is -1, expected a number of at least 0");
  extension("specular-range", "specular", {{"specularFactor", 2}},
            ".specularFactor: is 2, expected a number from 0 to 1");
  extension("transmission-range", "transmission", {{"transmissionFactor", -1}},
            ".transmissionFactor: is -1, expected a number from 0 to 1");
  extension("attenuation-distance", "volume", {{"attenuationDistance", 0}},
            ".attenuationDistance: is 0, expected more than 0");
  extension("attenuation-color", "volume", {{"attenuationColor", {1, 1, 2}}},
            ".attenuationColor[2]: is 2, expected a number from 0 to 1");
  l.replace("conductor-half", "/materials/0/extras", {{"tdpt_eta", {1, 1, 1}}},
            "materials[0].extras: has tdpt_eta without tdpt_k, expected both or neither");
  l.replace("conductor-range", "/materials/0/extras",
            {{"tdpt_eta", {1, 0, 1}}, {"tdpt_k", {1, 1, 1}}},
            "materials[0].extras.tdpt_eta[1]: is 0, expected a number from 0.001 to 1000");
  l.replace("alpha-mode", "/materials/0/alphaMode", "GLASS",
            "materials[0].alphaMode: is \"GLASS\", expected OPAQUE, MASK or BLEND");
  l.replace("texture-missing", "/materials/0/normalTexture", {{"index", 0}},
            "materials[0].normalTexture.index: is 0, expected an index into the 0 textures");
  l.spoil(
      "texture-transform",
      [](GlbBuilder& b) {
        add_texture(b);
        b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {
            {"KHR_texture_transform", {{"offset", {1, 2, 3}}}}};
      },
      "materials[0].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.offset: "
      "is an array of 3, expected an array of 2 numbers");
  l.spoil(
      "sampler-wrap",
      [](GlbBuilder& b) {
        add_texture(b, {{"wrapS", 1}});
      },
      "samplers[0].wrapS: is 1, expected 10497 (repeat), 33648 (mirrored repeat) or 33071 (clamp "
      "to edge)");
  l.spoil(
      "sampler-filter",
      [](GlbBuilder& b) {
        add_texture(b, {{"magFilter", 9987}});
      },
      "samplers[0].magFilter: is 9987, expected 9728 (nearest) or 9729 (linear)");
  l.spoil(
      "image-beyond",
      [](GlbBuilder& b) {
        add_texture(b);
        b.json["bufferViews"].back()["byteLength"] = 1000;
      },
      "bufferViews[2]: 1000 bytes from byte 60 reach beyond buffers[0] of 137 bytes");
  l.spoil(
      "image-outside",
      [](GlbBuilder& b) {
        add_texture(b);
        b.json["images"][0] = {{"uri", "../picture.png"}};
      },
      "images[0].uri: \"../picture.png\" is not a file in the scene's folder, which is all that is "
      "read");
}

void luminaires(MalformedList& l) {
  const auto luminaire = [&](const char* name, const Json& light, const Json& extension,
                             const std::string& error) {
    l.spoil(
        name,
        [light, extension](GlbBuilder& b) {
          b.json["extensions"]["EXT_lights_ies"]["lights"] = Json::array({light});
          b.node({{"extensions", {{"EXT_lights_ies", extension}}}});
        },
        error);
  };
  const std::string profile = "extensions.EXT_lights_ies.lights[0]", data = "data:;base64,";
  luminaire("luminaire-missing", Json::object(), {{"light", 1}},
            "nodes[2].extensions.EXT_lights_ies.light: is 1, expected an index into the 1 lights");
  luminaire(
      "luminaire-multiplier", Json::object(), {{"light", 0}, {"multiplier", -1}},
      "nodes[2].extensions.EXT_lights_ies.multiplier: is -1, expected a number of at least 0");
  luminaire("luminaire-without-profile", Json::object(), {{"light", 0}},
            profile + ".uri: is missing, a profile needs one or a bufferView");
  luminaire("luminaire-view", {{"bufferView", 99}}, {{"light", 0}},
            profile + ".bufferView: is 99, expected an index into the 2 bufferViews");
  luminaire("luminaire-no-ies", {{"uri", data + base64("a photo")}}, {{"light", 0}},
            profile + ", line 1: is no IES file: no line begins with TILT=");
  luminaire(
      "luminaire-outside", {{"uri", "../lamp.ies"}}, {{"light", 0}},
      profile +
          ".uri: \"../lamp.ies\" is not a file in the scene's folder, which is all that is read");
  luminaire("luminaire-too-bright",
            {{"uri", data + base64("TILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1 0 90 0 5 5")}},
            {{"light", 0}, {"multiplier", 1e30}},
            "nodes[2]: has an intensity of 5e+30, expected at most 1e30");
  luminaire("luminaire-infinitely-bright",
            {{"uri", data + base64("TILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1 0 90 0 5 5")}},
            {{"light", 0}, {"multiplier", 1e308}, {"color", {0, 0, 1}}},
            "nodes[2]: has an intensity of inf, expected at most 1e30");
}

void lights(MalformedList& l) {
  const std::string place = "extensions.KHR_lights_punctual";
  const auto light = [&](const std::string& file, const Json& value, const std::string& expected) {
    l.spoil(
        file,
        [&](GlbBuilder& b) {
          b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({value});
          b.node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"scale", {1, 1, 0}}});
        },
        expected);
  };
  light("light-type", {{"type", "area"}},
        place + ".lights[0].type: is \"area\", expected point, spot or directional");
  light("light-intensity", {{"type", "point"}, {"intensity", -1}},
        place + ".lights[0].intensity: is -1, expected a number of at least 0");
  light("light-cone",
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.6}, {"outerConeAngle", 0.5}}}},
        place +
            ".lights[0].spot: has an inner cone of 0.6 and an outer one of 0.5, expected 0 <= "
            "inner <= outer, 0 < outer <= pi/2");
  light("light-wide", {{"type", "spot"}, {"spot", {{"outerConeAngle", 1.6}}}},
        place +
            ".lights[0].spot: has an inner cone of 0 and an outer one of 1.6, expected 0 <= "
            "inner <= outer, 0 < outer <= pi/2");
  l.replace("light-missing", "/nodes/0/extensions", {{"KHR_lights_punctual", {{"light", 0}}}},
            "nodes[0].extensions.KHR_lights_punctual.light: is 0, expected an index into the 0 "
            "lights");
}

void area_lights(MalformedList& l) {
  const std::string place = "extensions.EXT_lights_area";
  const auto light = [&](const std::string& file, const Json& value, const std::string& expected) {
    l.spoil(
        file,
        [&](GlbBuilder& b) {
          b.json["extensions"]["EXT_lights_area"]["lights"] = Json::array({value});
          b.node({{"extensions", {{"EXT_lights_area", {{"light", 0}}}}}});
        },
        place + expected);
  };
  light("area-light-type", {{"type", "sphere"}},
        ".lights[0].type: is \"sphere\", expected rect or disk");
  light("area-light-untyped", Json::object(), ".lights[0].type: is missing");
  light("area-light-intensity", {{"type", "rect"}, {"intensity", -1}},
        ".lights[0].intensity: is -1, expected a number of at least 0");
  light("area-light-colour", {{"type", "rect"}, {"color", {1, 1, -1}}},
        ".lights[0].color[2]: is -1, expected a number of at least 0");
  light("area-light-size", {{"type", "disk"}, {"size", 0}},
        ".lights[0].size: is 0, expected more than 0");
  light("area-light-aspect", {{"type", "rect"}, {"rect", {{"aspect", -2}}}},
        ".lights[0].rect.aspect: is -2, expected more than 0");
  light("area-light-too-bright", {{"type", "disk"}, {"intensity", 1e31}},
        ".lights[0]: has an intensity of 1e+31, expected at most 1e30");
  l.replace("area-light-missing", "/nodes/0/extensions", {{"EXT_lights_area", {{"light", 3}}}},
            "nodes[0].extensions.EXT_lights_area.light: is 3, expected an index into the 0 lights");
  l.spoil(
      "area-light-far",
      [](GlbBuilder& b) {
        b.json["extensions"]["EXT_lights_area"]["lights"] =
            Json::array({{{"type", "disk"}, {"size", 1e300}}});
        b.node({{"scale", {1e100, 1, 1}}, {"extensions", {{"EXT_lights_area", {{"light", 0}}}}}});
      },
      "nodes[2]: its transform takes an area light beyond double precision");
}

}  // namespace

void add_malformed_surfaces(MalformedList& l) {
  attributes(l);
  materials(l);
  lights(l);
  area_lights(l);
  luminaires(l);
}

}  // namespace tdpt::testing
