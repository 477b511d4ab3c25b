// Parses arbitrary bytes as a mesh of the format that the first one names. A mesh that was read
// must be one that glTF can hold.
#include <cmath>

#include <zlib.h>

#include "libcommon/testing/files/fuzz.h"
#include "tools/tdpt-import/meshes/meshes.h"

using namespace tdpt;

namespace {

foreign::Mesh read(uint8_t format, std::string_view bytes) {
  const std::string name = "mesh";
  switch (format % 6) {
    case 0:
      return foreign::read_obj(bytes, name);
    case 1:
      return foreign::read_ply(bytes, name);
    case 2:
      return foreign::read_wo3(bytes, name);
    case 3:
      return foreign::read_serialized(bytes, name, 0);
    case 4:
      return foreign::read_serialized(bytes, name, 1);
    default:
      break;
  }
  // Mutated compressed bytes rarely inflate: here the mutated ones are compressed.
  uLongf size = compressBound(bytes.size());
  std::string file(size, 0);
  compress(reinterpret_cast<Bytef*>(file.data()), &size,
           reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  file.resize(size);
  return foreign::read_serialized(std::string("\x1c\x04\x04\0", 4) + file, name, 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  foreign::Mesh mesh;
  if (!testing::reads([&] { mesh = read(data[0], testing::text_of(data + 1, size - 1)); }))
    return 0;
  using testing::require;
  const size_t n = mesh.positions.size();
  require(n > 0 && !mesh.triangles.empty(), "a mesh is not empty");
  require(mesh.normals.empty() || mesh.normals.size() == n, "all vertices have normals, or none");
  require(mesh.uv.empty() || mesh.uv.size() == n, "all vertices have uv, or none");
  for (const auto& corners : mesh.triangles)
    for (const uint32_t corner : corners) require(corner < n, "corners exist");
  for (const Vec3f& p : mesh.positions) require(is_finite(p), "positions are finite");
  for (const auto& [u, v] : mesh.uv) require(std::isfinite(u) && std::isfinite(v), "uv are finite");
  const auto is_unit = [](const Vec3f& v) { return std::abs(length(v) - 1) < 1e-5f; };
  for (const Vec3f& normal : mesh.normals)
    require(is_unit(normal) || normal == Vec3f{}, "normals have length 1 or 0");
  foreign::smooth(mesh);
  require(mesh.normals.size() == n, "a smooth mesh has normals");
  for (const Vec3f& normal : mesh.normals) require(is_unit(normal), "smooth normals have length 1");
  return 0;
}
