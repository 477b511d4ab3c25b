// Compresses scenes with the reference encoders of the formats in glTF's extensions, and decodes
// them with their reference decoders.
#pragma once
#include <string>
#include <vector>

namespace tdpt::testing {

enum class Compression {
  draco_sequential,   ///< KHR_draco_mesh_compression of floats, order kept
  draco_edgebreaker,  ///< quantized and reordered
  meshopt,            ///< EXT_meshopt_compression
  meshopt_khr,        ///< the same as KHR_meshopt_compression
  meshopt_triangles,  ///< a triangle may begin at another corner; for quads none does
  meshopt_filters,    ///< positions exponential, normals octahedral
  webp_lossless,      ///< EXT_texture_webp
  webp_lossy,
};
struct NamedCompression {
  Compression compression;
  const char* name;
  bool exact;  ///< every bit of positions and texels, and the order, is kept
};
extern const std::vector<NamedCompression> kCompressions;

/// Compresses the scene `glb`, made by GlbBuilder: triangles with float attributes in bufferViews
/// of their own, 16-bit indices, PNG images made by png_of(). Throws std::invalid_argument for any
/// other.
std::string compress(const std::string& glb, Compression compression);

/// The uncompressed scene that the reference decoders produce.
std::string decompress(const std::string& glb);

}  // namespace tdpt::testing
