// Meshes in the formats of other renderers, and shapes that become meshes. All readers throw
// InputError with `name` for malformed files; sizes are checked before memory is taken.
#pragma once
#include <bit>
#include <cstring>
#include <string>
#include <string_view>

#include "tools/tdpt-import/described.h"

namespace tdpt::foreign {

/// Wavefront OBJ: all faces of all groups as one mesh, polygons cut into triangles; materials are
/// ignored. v of texture coordinates grows upwards in the file and downwards in the mesh.
Mesh read_obj(std::string_view bytes, const std::string& name);
/// PLY, ASCII or binary of either endianness: x y z, nx ny nz, u v or s t; faces of any number of
/// corners. v is as in the file: see flip_v().
Mesh read_ply(std::string_view bytes, const std::string& name);
/// Mitsuba's .serialized, shape number `index` of the file. v as in the file.
Mesh read_serialized(std::string_view bytes, const std::string& name, size_t index);
/// Tungsten's .wo3. v grows upwards in the file and downwards in the mesh.
Mesh read_wo3(std::string_view bytes, const std::string& name);

/// v becomes 1 - v.
void flip_v(Mesh& mesh);
inline Mesh flipped(Mesh mesh) {
  flip_v(mesh);
  return mesh;
}
/// Its surface after the map.
double area_of(const Mesh& mesh, const Affine& map);
/// Smooth normals: at each position, or at each vertex unless `across_seams`, the mean of its
/// triangles' normals, weighted by their angles.
void smooth(Mesh& mesh, bool across_seams = true);

/// The square [-1, 1]^2 at z = 0, front +z, uv (0, 1) at its corner (-1, -1): an image stands
/// upright.
Mesh square();
/// The cube [-1, 1]^3, front outside. Each face shows a whole image, turned as on Mitsuba's cube.
Mesh cube();
/// The unit sphere about +z with smooth normals, front outside; its area is that of the sphere.
/// u = phi / (2 pi) from +x towards +y, as of all round ones; v = 0 at +z.
Mesh sphere();
/// The disc of radius 1 at z = 0, front +z; its area is that of the disc. v = 1 at the rim.
Mesh disc();
/// The open cylinder of radius 1 about z from 0 to 1, front outside; its area is that of a round
/// one. v = 0 at z = 1.
Mesh cylinder();

// What all mesh readers need: values of either endianness, and the checks that every mesh passes.

/// The bytes of a zlib or gzip stream at the beginning of `packed`. Throws InputError if it is
/// broken, or inflates to more than memory_limit().
std::string inflated(std::string_view packed, const std::string& name, const std::string& place);

/// The T that begins at `bytes`.
template <class T>
T value_at(const char* bytes, std::endian order = std::endian::little) {
  char in_order[sizeof(T)];
  std::memcpy(in_order, bytes, sizeof(T));
  if (order != std::endian::native)
    for (size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(in_order[i], in_order[sizeof(T) - 1 - i]);
  T value;
  std::memcpy(&value, in_order, sizeof(T));
  return value;
}

/// The words of a line of text, between white space.
std::vector<std::string_view> words_of(std::string_view line);
/// The number that is all of `word`, perhaps after a plus; infinite or 0 if it is out of range.
std::optional<double> number_in(std::string_view word);

inline Vec3d in_double(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
inline Vec3f in_single(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// Twice the area of a triangle, along its front.
inline Vec3d front_of(const Mesh& mesh, const std::array<uint32_t, 3>& corners) {
  const Vec3d a = in_double(mesh.positions[corners[0]]);
  return cross(in_double(mesh.positions[corners[1]]) - a,
               in_double(mesh.positions[corners[2]]) - a);
}

/// Throws InputError unless there are triangles, all of them with existing corners, and all
/// positions are finite. Scales normals to length 1; those that have no direction become 0, and if
/// none has one, there are none. Coordinates of textures that are not finite become 0.
void check(Mesh& mesh, const std::string& name);

}  // namespace tdpt::foreign
