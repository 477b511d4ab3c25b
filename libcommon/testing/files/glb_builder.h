// Builds small glTF files in memory, for tests and for the scenes in testdata.
#pragma once
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace tdpt::testing {

/// The JSON is public, so that tests can corrupt it. Members keep their order, so the same calls
/// give the same bytes.
class GlbBuilder {
 public:
  nlohmann::ordered_json json;
  std::string bin;

  GlbBuilder();
  /// Of a whole file with a binary chunk.
  static GlbBuilder of(const std::string& glb);

  /// Appends `data`, aligned to 4 bytes; returns the bufferView.
  int view(std::string_view data, int stride = 0);
  /// An accessor over a new bufferView. `components`: 1 SCALAR, 2 to 4 VEC.
  int floats(const std::vector<float>& values, int components);
  int indices_u8(const std::vector<uint8_t>& values);
  int indices_u16(const std::vector<uint16_t>& values);
  int indices_u32(const std::vector<uint32_t>& values);
  /// An accessor over an existing bufferView.
  int accessor(int view, int component_type, const std::string& type, size_t count,
               size_t offset = 0);

  /// A texture whose image, PNG or JPEG, is stored in a new bufferView; {} is the default sampler.
  int texture(std::string_view image, nlohmann::ordered_json sampler = {});

  int material(nlohmann::ordered_json m);
  /// A mesh with one primitive.
  int mesh(nlohmann::ordered_json primitive, const std::string& name = "");
  /// Adds a root node to scene 0.
  int node(nlohmann::ordered_json n);
  /// A perspective camera and its root node, looking from `from` to `to` with +Y up.
  int camera(const std::string& name, std::array<double, 3> from, std::array<double, 3> to,
             double yfov, double aspect);

  nlohmann::ordered_json document() const;  ///< with its buffers
  std::string glb() const;
  /// JSON text with the buffer as a data URI.
  std::string gltf() const;

 private:
  int indices(int view, int component_type, size_t count);
  void extend_limits(nlohmann::ordered_json& accessor, const std::vector<float>& values,
                     int components);
};

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A .glb of this JSON text and binary chunk, valid or not.
std::string glb_of(std::string json_text, std::string bin);
std::string base64(std::string_view bytes);

/// An uncompressed PNG of RGBA texels, the top row first. `bits`: 8, or 16 with the high byte
/// first.
std::string png_of(int width, int height, std::string_view texels, int bits = 8);

}  // namespace tdpt::testing
