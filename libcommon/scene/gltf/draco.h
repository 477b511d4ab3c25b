// Decodes Draco meshes in memory, from untrusted sources. Internal to this room.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tdpt::gltf {

/// A compressed mesh, and what to decode of it.
struct DracoRequest {
  struct Attribute {
    uint32_t id;         ///< Draco's unique id
    int component_type;  ///< glTF's code of the type to convert to
    int components;
  };
  std::string_view bytes;
  std::vector<Attribute> attributes;
  size_t vertices = 0, corners = 0;  ///< as declared by accessors
};

struct DracoMesh {
  size_t vertices = 0, corners = 0;
  std::string indices;                  ///< 32 bits per corner, triangle by triangle
  std::vector<std::string> attributes;  ///< tightly packed
};

/// Bytes of the mesh with the vertices and corners that accessors declare.
size_t declared_bytes(const DracoRequest& request);

/// Whether it has more than those.
bool exceeds(const DracoMesh& mesh, const DracoRequest& request);

/// All meshes, or those before the first that cannot be decoded; then `fault` says why. Indices are
/// not checked against the number of vertices.
std::vector<DracoMesh> decode_draco(const std::vector<DracoRequest>& requests, std::string& fault);

}  // namespace tdpt::gltf
