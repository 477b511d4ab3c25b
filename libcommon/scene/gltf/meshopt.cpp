// The only caller of meshoptimizer. It checks what it decodes, given the size of the result, so
// only that size is left to check. One byte of its vertex stream decodes to at most 64 (two bits
// per byte of 16 vertices), one byte of its index stream to a triangle.
#include <fmt/format.h>
#include <meshoptimizer.h>
#include <algorithm>

#include "libcommon/base/file.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {
namespace {

constexpr const char* kMeshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};
constexpr size_t kMostPerMeshoptByte = 64;

using Mode = Meshopt::Mode;
using Filter = Meshopt::Filter;

/// Element sizes that meshoptimizer requires in its modes and filters.
void expect_stride(const Meshopt& e, const Value& v) {
  const size_t stride = e.stride;
  const auto expect = [&](bool right, const char* expected) {
    if (!right) v["byteStride"].fail(expected);
  };
  if (e.mode != Mode::attributes) {
    expect(stride == 2 || stride == 4, "2 or 4, the bytes of an index");
    if (e.filter != Filter::none) v["filter"].fail("NONE where there are indices");
    return;
  }
  expect(stride % 4 == 0, "a multiple of 4");
  if (e.filter == Filter::octahedral) expect(stride == 4 || stride == 8, "4 or 8 with this filter");
  if (e.filter == Filter::quaternion) expect(stride == 8, "8 with this filter");
}

Meshopt read_extension(const Value& v, const char* name, size_t stride) {
  Meshopt e;
  e.extension = name;
  e.buffer = v["buffer"].needed().index("buffers");
  e.offset = v["byteOffset"].integer(0);
  e.length = v["byteLength"].needed().integer(0, 1);
  e.stride = v["byteStride"].needed().integer(0, 1, 256);
  e.count = v["count"].needed().integer(0, 1);
  e.mode = static_cast<Mode>(v["mode"].needed().one_of({"ATTRIBUTES", "TRIANGLES", "INDICES"}, 0));
  e.filter = static_cast<Filter>(
      v["filter"].one_of({"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"}, 0));
  expect_stride(e, v);
  if (stride > 0 && stride != e.stride)
    v["byteStride"].fail(fmt::format("{} as of the bufferView", stride));
  if (e.mode == Mode::triangles && e.count % 3 != 0) v["count"].fail("a multiple of 3");
  return e;
}

bool decode(const Meshopt& e, std::string_view bytes, std::string& out) {
  const auto* in = reinterpret_cast<const unsigned char*>(bytes.data());
  if (e.mode == Mode::triangles)
    return meshopt_decodeIndexBuffer(out.data(), e.count, e.stride, in, bytes.size()) == 0;
  if (e.mode == Mode::indices)
    return meshopt_decodeIndexSequence(out.data(), e.count, e.stride, in, bytes.size()) == 0;
  if (meshopt_decodeVertexBuffer(out.data(), e.count, e.stride, in, bytes.size()) != 0)
    return false;
  if (e.filter == Filter::octahedral) meshopt_decodeFilterOct(out.data(), e.count, e.stride);
  if (e.filter == Filter::quaternion) meshopt_decodeFilterQuat(out.data(), e.count, e.stride);
  if (e.filter == Filter::exponential) meshopt_decodeFilterExp(out.data(), e.count, e.stride);
  return true;
}

}  // namespace

bool is_meshopt_fallback(const Value& buffer) {
  bool fallback = false;
  for (const char* name : kMeshopt) fallback |= buffer.extension(name)["fallback"].boolean(false);
  return fallback;
}

std::optional<Meshopt> read_meshopt(const Value& view, size_t stride) {
  std::optional<Meshopt> out;
  for (const char* name : kMeshopt)
    if (const Value extension = view.extension(name)) out = read_extension(extension, name, stride);
  return out;
}

std::string unpack_meshopt_view(const Document& d, size_t view) {
  const Meshopt& e = *d.views[view].meshopt;
  const std::string where = place("bufferViews", view) + ".extensions." + e.extension;
  const std::string_view bytes = buffer_bytes(d, where, e.buffer, e.offset, e.length);
  const size_t count = e.count, stride = e.stride;
  if (count * stride > kMostPerMeshoptByte * bytes.size())
    d.fail(where, fmt::format("declares {} elements of {} bytes, expected at most {} bytes from {}",
                              count, stride, kMostPerMeshoptByte * bytes.size(), bytes.size()));
  const size_t all = d.bytes_unpacked + count * stride;
  const size_t buffers = bytes_of_buffers(d);
  if (all > kMostPerMeshoptByte * buffers)  // bufferViews may share compressed bytes
    d.fail(where, fmt::format("brings the scene to {} bytes, expected at most {} from {}", all,
                              kMostPerMeshoptByte * buffers, buffers));
  expect_memory(d.file, where,
                fmt::format("{} elements of {} bytes, with those before,", count, stride), all);
  const size_t size = d.views[view].length;
  if (size > count * stride)
    d.fail(where, fmt::format("declares {} elements of {} bytes, expected {} bytes as the "
                              "bufferView has",
                              count, stride, size));
  std::string out(count * stride, '\0');
  if (!decode(e, bytes, out))
    d.fail(where, "cannot be decoded, expected data of meshoptimizer, version 0");
  out.resize(size);
  d.bytes_unpacked = all;
  return out;
}

size_t most_bytes_of_meshopt(const Document& d) {
  size_t most = 0;
  for (const BufferView& v : d.views)
    if (v.meshopt)
      most += std::min(v.meshopt->count * v.meshopt->stride,
                       kMostPerMeshoptByte * d.buffers[v.meshopt->buffer].size());
  return most;
}

}  // namespace tdpt::gltf
