// Scenes compressed by the reference encoders of the formats that glTF's extensions name, and
// decoded again by their reference decoders.
#pragma once
#include <string>
#include <vector>

namespace tdpt::testing {

enum class Compression {
  draco_sequential,   ///< KHR_draco_mesh_compression of floats, in their order
  draco_edgebreaker,  ///< quantized, in an order of its own
  meshopt,            ///< EXT_meshopt_compression
  meshopt_khr,        ///< the same as KHR_meshopt_compression
  meshopt_triangles,  ///< where a triangle may begin at another corner; of quads none does
  meshopt_filters,    ///< positions exponential, normals octahedral
  webp_lossless,      ///< EXT_texture_webp
  webp_lossy,
};
struct NamedCompression {
  Compression compression;
  const char* name;
  bool exact;  ///< every bit of places and texels, and the order, is kept
};
extern const std::vector<NamedCompression> kCompressions;

/// The scene of `glb`, of GlbBuilder, compressed: triangles of floats in bufferViews of their own,
/// with indices of 16 bits; images that are PNG of png_of(). Throws std::invalid_argument for
/// others.
std::string compress(const std::string& glb, Compression compression);

/// The plain scene that the reference decoders make of it.
std::string decompress(const std::string& glb);

}  // namespace tdpt::testing
