#include "tools/tdpt-import/gltf/buffer.h"

#include <limits>

#include "libcommon/base/error.h"

namespace tdpt::foreign {
namespace {

constexpr uint32_t kGlbMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;
constexpr int kFloat = 5126, kShort = 5123, kInt = 5125, kVertices = 34962, kIndices = 34963;

template <class T>
void append(std::string& bin, const T& value) {
  bin.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

size_t Buffer::view(size_t offset, int target) {
  GltfJson v = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bin_.size() - offset}};
  if (target) v["target"] = target;
  root_["bufferViews"].push_back(std::move(v));
  bin_.resize((bin_.size() + 3) / 4 * 4);
  return root_["bufferViews"].size() - 1;
}

size_t Buffer::accessor(size_t view, int type, size_t count, const char* shape) {
  root_["accessors"].push_back(
      {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}});
  return root_["accessors"].size() - 1;
}

size_t Buffer::positions(const std::vector<Vec3f>& values) {
  const size_t offset = bin_.size();
  Vec3f low(std::numeric_limits<float>::infinity()), high = -low;
  for (const Vec3f& p : values) {
    low = min(low, p), high = max(high, p);
    append(bin_, std::array<float, 3>{p.x, p.y, p.z});
  }
  const size_t at = accessor(view(offset, kVertices), kFloat, values.size(), "VEC3");
  root_["accessors"][at]["min"] = {low.x, low.y, low.z};
  root_["accessors"][at]["max"] = {high.x, high.y, high.z};
  return at;
}

size_t Buffer::normals(const std::vector<Vec3f>& values) {
  const size_t offset = bin_.size();
  for (const Vec3f& n : values) append(bin_, std::array<float, 3>{n.x, n.y, n.z});
  return accessor(view(offset, kVertices), kFloat, values.size(), "VEC3");
}

size_t Buffer::uv(const std::vector<std::array<float, 2>>& values) {
  const size_t offset = bin_.size();
  for (const auto& t : values) append(bin_, t);
  return accessor(view(offset, kVertices), kFloat, values.size(), "VEC2");
}

size_t Buffer::indices(const std::vector<std::array<uint32_t, 3>>& triangles, size_t vertices) {
  const size_t offset = bin_.size();
  const bool small = vertices <= 65535;
  for (const auto& t : triangles)
    for (const uint32_t i : t) {
      if (small)
        append(bin_, static_cast<uint16_t>(i));
      else
        append(bin_, i);
    }
  return accessor(view(offset, kIndices), small ? kShort : kInt, 3 * triangles.size(), "SCALAR");
}

size_t Buffer::bytes(std::string_view bytes) {
  const size_t offset = bin_.size();
  bin_ += bytes;
  return view(offset, 0);
}

std::string Buffer::glb() {
  if (!bin_.empty()) root_["buffers"] = GltfJson::array({{{"byteLength", bin_.size()}}});
  std::string text = root_.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const size_t total = 12 + 8 + text.size() + (bin_.empty() ? 0 : 8 + bin_.size());
  if (total > std::numeric_limits<uint32_t>::max())
    throw Error(Exit::bad_input, "the scene takes more than 4 GiB, which no .glb holds");
  std::string glb;
  glb.reserve(total);
  const auto word = [&](size_t v) { append(glb, static_cast<uint32_t>(v)); };
  word(kGlbMagic), word(2), word(total), word(text.size()), word(kJsonChunk);
  glb += text;
  if (!bin_.empty()) {
    word(bin_.size()), word(kBinChunk);
    glb += bin_;
  }
  return glb;
}

}  // namespace tdpt::foreign
