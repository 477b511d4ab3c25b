#include "libcommon/testing/files/split.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <unordered_map>
#include <vector>

#include "libcommon/testing/files/glb_builder.h"

namespace tdpt::testing {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kU8 = 5121, kU16 = 5123, kU32 = 5125, kFloat = 5126, kTriangles = 4;

void expect(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(std::string("split_in_four: ") + what);
}

uint32_t word(const std::string& bytes, size_t at) {
  expect(at + 4 <= bytes.size(), "the file is cut short");
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

/// Attributes shared by primitives are split once for each of them.
class Splitter {
 public:
  explicit Splitter(const std::string& glb) {
    const size_t json_size = word(glb, 12);
    builder_.json = Json::parse(glb.substr(20, json_size));
    const size_t bin_size = word(glb, 20 + json_size);
    builder_.bin = glb.substr(28 + json_size, bin_size);
  }

  std::string run() {
    for (Json& mesh : builder_.json["meshes"])
      for (Json& primitive : mesh["primitives"]) split(primitive);
    return builder_.glb();
  }

 private:
  struct View {
    const char* data;
    size_t stride, count;
  };

  View elements(const Json& accessor, size_t size) const {
    expect(accessor.contains("bufferView") && !accessor.contains("sparse"), "a sparse accessor");
    const Json& view = builder_.json["bufferViews"][accessor["bufferView"].get<size_t>()];
    const size_t at = view.value("byteOffset", size_t{0}) + accessor.value("byteOffset", size_t{0});
    const View v{builder_.bin.data() + at, view.value("byteStride", size), accessor["count"]};
    expect(v.count == 0 || at + (v.count - 1) * v.stride + size <= builder_.bin.size(),
           "an accessor reaches out of the buffer");
    return v;
  }

  std::vector<uint32_t> indices(const Json& accessor) const {
    const int type = accessor["componentType"];
    const size_t size = type == kU8 ? 1 : type == kU16 ? 2 : 4;
    expect(type == kU8 || type == kU16 || type == kU32, "indices of another type");
    const View v = elements(accessor, size);
    std::vector<uint32_t> out(v.count, 0);
    for (size_t i = 0; i < v.count; ++i) std::memcpy(&out[i], v.data + i * v.stride, size);
    return out;
  }

  std::vector<float> floats(const Json& accessor, size_t components) const {
    expect(accessor["componentType"] == kFloat, "an attribute that is not of floats");
    const View v = elements(accessor, 4 * components);
    std::vector<float> out(v.count * components);
    for (size_t i = 0; i < v.count; ++i)
      std::memcpy(&out[i * components], v.data + i * v.stride, 4 * components);
    return out;
  }

  void split(Json& primitive) {
    expect(primitive.value("mode", kTriangles) == kTriangles, "a primitive that is no triangles");
    expect(!primitive.contains("targets"), "morph targets");
    // Copied, since adding accessors reallocates.
    const Json position =
        builder_.json["accessors"][primitive["attributes"]["POSITION"].get<int>()];
    const size_t vertices = position["count"];
    std::vector<uint32_t> corner(vertices);
    std::iota(corner.begin(), corner.end(), 0u);
    if (primitive.contains("indices"))
      corner = indices(builder_.json["accessors"][primitive["indices"].get<int>()]);

    std::vector<std::pair<uint32_t, uint32_t>> edges;
    std::unordered_map<uint64_t, uint32_t> known;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [low, high] = std::minmax(a, b);
      const auto [entry, is_new] = known.try_emplace(
          uint64_t{low} << 32 | high, static_cast<uint32_t>(vertices + edges.size()));
      if (is_new) edges.emplace_back(low, high);
      return entry->second;
    };
    std::vector<uint32_t> fine;
    fine.reserve(4 * corner.size());
    for (size_t i = 0; i + 2 < corner.size(); i += 3) {
      const uint32_t a = corner[i], b = corner[i + 1], c = corner[i + 2];
      expect(std::max({a, b, c}) < vertices, "an index beyond the vertices");
      const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      fine.insert(fine.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }

    for (auto& [name, index] : primitive["attributes"].items()) {
      const Json accessor = builder_.json["accessors"][index.get<int>()];
      const std::string type = accessor["type"];
      expect(type == "VEC2" || type == "VEC3" || type == "VEC4", "an attribute that is no vector");
      const auto components = static_cast<size_t>(type.back() - '0');
      std::vector<float> values = floats(accessor, components);
      for (const auto& [a, b] : edges)
        for (size_t k = 0; k < components; ++k)
          values.push_back(0.5f * (values[a * components + k] + values[b * components + k]));
      index = builder_.floats(values, static_cast<int>(components));
    }
    primitive["indices"] = builder_.indices_u32(fine);
  }

  GlbBuilder builder_;
};

}  // namespace

std::string split_in_four(const std::string& glb) {
  return Splitter(glb).run();
}

}  // namespace tdpt::testing
