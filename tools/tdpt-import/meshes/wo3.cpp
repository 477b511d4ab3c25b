// Tungsten's .wo3, little-endian: a count (64 bits) of vertices and these, each a position, a
// normal and uv as 8 floats; a count of triangles and these, each 3 corners and a material as 4
// integers.
#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/checked.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign {
namespace {

// Takes a count and that many records off the front of `bytes`.
std::string_view records(std::string_view& bytes, size_t size, const char* what,
                         const std::string& name) {
  if (bytes.size() < 8) throw InputError(name, "", fmt::format("ends before its {}", what));
  const auto count = value_at<uint64_t>(bytes.data());
  bytes.remove_prefix(8);
  if (count > bytes.size() / size)
    throw InputError(name, "",
                     fmt::format("has {} {} by its count, but bytes for only {}", count, what,
                                 bytes.size() / size));
  const std::string_view taken = bytes.substr(0, count * size);
  bytes.remove_prefix(taken.size());
  return taken;
}

}  // namespace

Mesh read_wo3(std::string_view bytes, const std::string& name) {
  constexpr size_t vertex_size = 32, triangle_size = 16;
  const std::string_view vertices = records(bytes, vertex_size, "vertices", name);
  const std::string_view triangles = records(bytes, triangle_size, "triangles", name);
  if (!bytes.empty())
    throw InputError(name, "", counted(bytes.size(), "byte") + " after the last triangle");
  Mesh mesh;
  for (size_t at = 0; at < vertices.size(); at += vertex_size) {
    const auto f = [&](size_t i) { return value_at<float>(vertices.data() + at + 4 * i); };
    mesh.positions.push_back({f(0), f(1), f(2)});
    mesh.normals.push_back({f(3), f(4), f(5)});
    mesh.uv.push_back({f(6), f(7)});
  }
  for (size_t at = 0; at < triangles.size(); at += triangle_size) {
    const auto corner = [&](size_t i) { return value_at<uint32_t>(triangles.data() + at + 4 * i); };
    mesh.triangles.push_back({corner(0), corner(1), corner(2)});
  }
  check(mesh, name);
  flip_v(mesh);
  return mesh;
}

}  // namespace tdpt::foreign
