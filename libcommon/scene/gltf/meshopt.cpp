// The only caller of meshoptimizer. It checks what it decodes, given the size of the result, so
// only that size is left to check. One byte of its vertex stream decodes to at most 64 (two bits
// per byte of 16 vertices), one byte of its index stream to a triangle.
#include "libcommon/scene/gltf/compression.h"

#include <fmt/format.h>
#include <meshoptimizer.h>
#include <algorithm>

#include "libcommon/base/file.h"

namespace tdpt::gltf {
namespace {

using Json = nlohmann::json;

constexpr size_t kMostOfAByte = 64;

/// The extension of a buffer or bufferView; null if it has none.
const Json* extension_of(const Json& owner, std::string* name = nullptr) {
  const auto extensions = owner.find("extensions");
  if (extensions == owner.end()) return nullptr;
  for (const char* known : kMeshopt)
    if (const auto it = extensions->find(known); it != extensions->end()) {
      if (name) *name = known;
      return &*it;
    }
  return nullptr;
}

const Json* extension_of_view(const Document& d, size_t view, std::string* name = nullptr) {
  const auto views = d.json.find("bufferViews");
  if (views == d.json.end() || view >= views->size()) return nullptr;
  return extension_of((*views)[view], name);
}

bool decode(const Json& e, std::string_view bytes, size_t count, size_t stride, std::string& out) {
  const auto mode = e["mode"].get<std::string>(), filter = e.value("filter", "NONE");
  const auto* in = reinterpret_cast<const unsigned char*>(bytes.data());
  if (mode == "TRIANGLES")
    return meshopt_decodeIndexBuffer(out.data(), count, stride, in, bytes.size()) == 0;
  if (mode == "INDICES")
    return meshopt_decodeIndexSequence(out.data(), count, stride, in, bytes.size()) == 0;
  if (meshopt_decodeVertexBuffer(out.data(), count, stride, in, bytes.size()) != 0) return false;
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), count, stride);
  return true;
}

}  // namespace

bool is_meshopt_fallback(const Json& buffer) {
  const Json* e = extension_of(buffer);
  return e && e->value("fallback", false);
}

bool is_meshopt_view(const Document& d, size_t view) {
  return extension_of_view(d, view) != nullptr;
}

std::string unpack_meshopt_view(const Document& d, size_t view) {
  std::string name;
  const Json& e = *extension_of_view(d, view, &name);
  const std::string where = place("bufferViews", view) + ".extensions." + name;
  const std::string_view bytes =
      buffer_bytes(d, where, e["buffer"].get<size_t>(), e.value("byteOffset", size_t{0}),
                   e["byteLength"].get<size_t>());
  const auto count = e["count"].get<size_t>(), stride = e["byteStride"].get<size_t>();
  if (count * stride > kMostOfAByte * bytes.size())
    d.fail(where, fmt::format("declares {} elements of {} bytes, expected at most {} bytes from {}",
                              count, stride, kMostOfAByte * bytes.size(), bytes.size()));
  const size_t all = d.bytes_unpacked + count * stride;
  size_t buffers = 0;
  for (const std::string_view b : d.buffers) buffers += b.size();
  if (all > kMostOfAByte * buffers)  // bufferViews may share compressed bytes
    d.fail(where, fmt::format("brings the scene to {} bytes, expected at most {} from {}", all,
                              kMostOfAByte * buffers, buffers));
  expect_memory(d.file, where,
                fmt::format("{} elements of {} bytes, with those before,", count, stride), all);
  const size_t size = d.model.bufferViews[view].byteLength;
  if (size > count * stride)
    d.fail(where, fmt::format("declares {} elements of {} bytes, expected {} bytes as the "
                              "bufferView has",
                              count, stride, size));
  std::string out(count * stride, '\0');
  if (!decode(e, bytes, count, stride, out))
    d.fail(where, "cannot be decoded, expected data of meshoptimizer, version 0");
  out.resize(size);
  d.bytes_unpacked = all;
  return out;
}

size_t most_bytes_of_meshopt(const Document& d) {
  size_t most = 0;
  for (size_t view = 0; view < d.model.bufferViews.size(); ++view) {
    const Json* e = extension_of_view(d, view);
    if (!e) continue;
    const auto declared = (*e)["count"].get<size_t>() * (*e)["byteStride"].get<size_t>();
    const size_t buffer = d.buffers[(*e)["buffer"].get<size_t>()].size();
    most += std::min(declared, kMostOfAByte * buffer);
  }
  return most;
}

}  // namespace tdpt::gltf
