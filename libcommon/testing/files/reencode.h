// Writes one scene in the many equivalent encodings of glTF 2.0.
#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/testing/rooms/rooms.h"

namespace tdpt::testing {

/// Quads of one material: four vertices each, counter-clockwise seen from the front, split from the
/// first to the third.
struct QuadPart {
  std::string name;
  int material = 0;  ///< kGrey ...
  std::vector<Vec3f> positions, normals;
  std::vector<std::array<float, 2>> uv;

  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
};

/// A closed room of 2 x 2 x 2 m, x and z -1..1, y 0..2, with a lamp, a textured wall and a block.
/// Vertices at y = 0 stay fixed; the block's last vertex can move.
std::vector<QuadPart> simple_room();

enum class Encoding {
  indices_u8,
  indices_u16,
  indices_u32,
  no_indices,
  interleaved,  ///< one bufferView with byteStride
  sparse,       ///< every third position is substituted
  data_uri,     ///< .gltf with everything inside
  external,     ///< .gltf with a .bin beside it
  many_primitives,
  strip,  ///< connected by degenerate triangles
  fans,
  mirrored,   ///< below a node with negative scale
  nested,     ///< below three nodes with translation, rotation and scale
  matrices,   ///< the same as matrices
  quantized,  ///< KHR_mesh_quantization
  instanced,  ///< each mesh by EXT_mesh_gpu_instancing: half as large, rotated
  skinned,    ///< the same by a joint
  morphed,    ///< half of each position comes from a morph target
};
/// What an encoding preserves of indices_u16: every bit of positions and the order; everything but
/// the rounding of positions; everything but the order of triangles and their vertices.
enum class Same { bits, but_rounding, but_order };
struct NamedEncoding {
  Encoding encoding;
  const char* name;
  Same same;
};
extern const std::vector<NamedEncoding> kEncodings;

/// Files by name; the first is "scene.glb" or "scene.gltf".
struct EncodedScene {
  std::string file;  ///< the name of the scene file
  std::map<std::string, std::string> files;
};
EncodedScene encode(const std::vector<QuadPart>& parts, Encoding encoding);

/// The files of testdata/encodings: simple_room() as a single file each, by name.
std::vector<NamedScene> encoded_rooms();

}  // namespace tdpt::testing
