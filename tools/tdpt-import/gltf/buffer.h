// The binary part of a .glb and the JSON that describes it.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tools/tdpt-import/described.h"

namespace tdpt::foreign {

using GltfJson = nlohmann::ordered_json;

class Buffer {
 public:
  explicit Buffer(GltfJson& root) : root_(root) {}

  // Each returns the index of its accessor.
  size_t positions(const std::vector<Vec3f>& values);
  size_t normals(const std::vector<Vec3f>& values);
  size_t uv(const std::vector<std::array<float, 2>>& values);
  size_t indices(const std::vector<std::array<uint32_t, 3>>& triangles, size_t vertices);
  /// The index of its bufferView.
  size_t bytes(std::string_view bytes);

  /// The whole file.
  std::string glb();

 private:
  size_t view(size_t offset, int target);
  size_t accessor(size_t view, int type, size_t count, const char* shape);

  GltfJson& root_;
  std::string bin_;
};

}  // namespace tdpt::foreign
