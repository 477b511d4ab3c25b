// A .glb that is being written: its JSON, and the binary part that the JSON describes.
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libcommon/base/error.h"
#include "libcommon/math/vec.h"

namespace tdpt {

/// `Json` is nlohmann::json or ordered_json, and decides the order of the keys.
template <class Json>
class Glb {
 public:
  enum Target { none = 0, vertices = 34962, indices = 34963 };
  enum Component { byte = 5121, uint16 = 5123, uint32 = 5125, float32 = 5126 };

  Json root{};

  /// Appends an element to a list of the root; returns its index.
  size_t add(const char* section, Json element) {
    root[section].push_back(std::move(element));
    return root[section].size() - 1;
  }

  /// Appends bytes; returns the index of their bufferView.
  size_t add_bytes(std::string_view bytes, Target target = none) {
    Json view = {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}};
    if (target != none) view["target"] = target;
    bin_ += bytes;
    bin_.resize((bin_.size() + 3) / 4 * 4);
    return add("bufferViews", std::move(view));
  }

  /// Appends `count` elements, each of the glTF type `type`; returns the index of their accessor.
  template <class T>
  size_t add_accessor(const std::vector<T>& values, size_t count, const char* type,
                      Component component, Target target) {
    const size_t view = add_bytes(
        {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)}, target);
    return add(
        "accessors",
        {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
  }
  size_t add_vectors(const std::vector<Vec3f>& values) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    return add_accessor(values, values.size(), "VEC3", float32, vertices);
  }
  /// With their bounds, which glTF demands of positions.
  size_t add_positions(const std::vector<Vec3f>& values) {
    Vec3f low(std::numeric_limits<float>::infinity()), high = -low;
    for (const Vec3f& p : values) low = min(low, p), high = max(high, p);
    const size_t at = add_vectors(values);
    root["accessors"][at]["min"] = {low.x, low.y, low.z};
    root["accessors"][at]["max"] = {high.x, high.y, high.z};
    return at;
  }

  /// The whole file. Throws Error (bad_input) if it takes more than 4 GiB.
  std::string file() {
    if (!bin_.empty()) root["buffers"] = Json::array({{{"byteLength", bin_.size()}}});
    std::string text = root.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const size_t total = 12 + 8 + text.size() + (bin_.empty() ? 0 : 8 + bin_.size());
    if (total > UINT32_MAX)
      throw Error(Exit::bad_input, "the scene takes more than 4 GiB, which no .glb holds");
    std::string glb;
    glb.reserve(total);
    const auto add_word = [&](size_t v) {
      const auto word = static_cast<uint32_t>(v);
      glb.append(reinterpret_cast<const char*>(&word), sizeof word);
    };
    add_word(0x46546c67), add_word(2), add_word(total);  // "glTF", version
    add_word(text.size()), add_word(0x4e4f534a);         // "JSON"
    glb += text;
    if (bin_.empty()) return glb;
    add_word(bin_.size()), add_word(0x004e4942);  // "BIN"
    return glb += bin_;
  }

 private:
  std::string bin_;
};

}  // namespace tdpt
