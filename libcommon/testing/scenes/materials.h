// Materials of a file made for a test, and images for them.
#pragma once
#include <cmath>

#include "libcommon/base/error.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::testing {

using Json = nlohmann::ordered_json;
using Sentences = std::vector<std::string>;
using Wrap = TextureMap::Wrap;

inline const Json kLambert = {{"KHR_materials_specular", {{"specularFactor", 0}}}};

inline Json lambert(double r, double g, double blue) {
  return {{"pbrMetallicRoughness",
           {{"baseColorFactor", {r, g, blue, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
          {"extensions", kLambert}};
}

inline Scene load(const GlbBuilder& b) {
  const TempFolder folder;
  return read_gltf(folder.write("scene.glb", b.glb()));
}

/// The error of reading it, without the file's name; "" if there is none.
inline std::string refusal(const GlbBuilder& b) {
  try {
    load(b);
  } catch (const InputError& e) {
    const std::string what = e.what();
    return what.substr(what.find("scene.glb:") + 10);
  }
  return "";
}

/// One triangle per material, with both sets of texture coordinates.
inline Scene scene_with(const std::vector<Json>& materials, GlbBuilder b = {}) {
  const int p = b.floats({0, 0, 0, 2, 0, 0, 0, 1, 0}, 3);
  const int uv = b.floats({0, 0, 1, 0, 0, 1}, 2);
  const Json at = {{"POSITION", p}, {"TEXCOORD_0", uv}, {"TEXCOORD_1", uv}};
  for (const Json& m : materials) {
    const int index = b.material(m);
    b.node({{"mesh", b.mesh({{"attributes", at}, {"material", index}})}});
  }
  return load(b);
}
inline Material material(const Json& m, const GlbBuilder& b = {}) {
  return scene_with({m}, b).materials[0];
}

// Two texels; the second is black and half transparent.
inline const std::string kTwoTexels("\xff\x80\x33\xff\0\0\0\x80", 8);
inline const std::string kTwo = png_of(2, 1, kTwoTexels);
inline const std::string kTwoOpaque = png_of(2, 1, std::string("\xff\x80\x33\xff\0\0\0\xff", 8));
// One colour: 1, 0.2, 0.4 of 255, alpha 0.6.
inline const std::string kOne =
    png_of(2, 2, "\xff\x33\x66\x99\xff\x33\x66\x99\xff\x33\x66\x99\xff\x33\x66\x99");
// 16 x 8 texels, red on the left, blue on the right, as a baseline JPEG.
inline const char* const kJpeg =
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wCEAAIBAQEBAQIBAQECAgICAgQDAgICAgUEBAMEBgUGBgYFBgYGBwkIBgcJBw"
    "YGCAsICQoKCgoKBggLDAsKDAkKCgoBAgICAgICBQMDBQoHBgcKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoK"
    "CgoKCgoKCgoKCgoKCgoKCgoKCv/AABEIAAgAEAMBEQACEQEDEQH/xAGiAAABBQEBAQEBAQAAAAAAAAAAAQIDBAUGBw"
    "gJCgsQAAIBAwMCBAMFBQQEAAABfQECAwAEEQUSITFBBhNRYQcicRQygZGhCCNCscEVUtHwJDNicoIJChYXGBkaJSYn"
    "KCkqNDU2Nzg5OkNERUZHSElKU1RVVldYWVpjZGVmZ2hpanN0dXZ3eHl6g4SFhoeIiYqSk5SVlpeYmZqio6Slpqeoqa"
    "qys7S1tre4ubrCw8TFxsfIycrS09TV1tfY2drh4uPk5ebn6Onq8fLz9PX29/j5+gEAAwEBAQEBAQEBAQAAAAAAAAEC"
    "AwQFBgcICQoLEQACAQIEBAMEBwUEBAABAncAAQIDEQQFITEGEkFRB2FxEyIygQgUQpGhscEJIzNS8BVictEKFiQ04S"
    "XxFxgZGiYnKCkqNTY3ODk6Q0RFRkdISUpTVFVWV1hZWmNkZWZnaGlqc3R1dnd4eXqCg4SFhoeIiYqSk5SVlpeYmZqi"
    "o6Slpqeoqaqys7S1tre4ubrCw8TFxsfIycrS09TV1tfY2dri4+Tl5ufo6ery8/T19vf4+fr/2gAMAwEAAhEDEQA/AP"
    "jCv5TP9/j5Cr/qqP8AmuP/2Q==";

inline double linear(double encoded) {
  return std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// textures[0] is `image`.
inline GlbBuilder with(const std::string& image, const Json& sampler = {}) {
  GlbBuilder b;
  b.texture(image, sampler);
  return b;
}

}  // namespace tdpt::testing
