// Meshes compressed by Draco, in memory, from anywhere. Internal to this room.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tdpt::gltf {

/// A mesh, and what is asked of it.
struct DracoRequest {
  struct Attribute {
    uint32_t id;         ///< Draco's unique one
    int component_type;  ///< of glTF, to be converted to
    int components;
  };
  std::string_view bytes;
  std::vector<Attribute> attributes;
  size_t vertices = 0, corners = 0;  ///< as accessors declare
};

struct DracoMesh {
  size_t vertices = 0, corners = 0;
  std::string indices;                  ///< 32 bits for each corner, triangle by triangle
  std::vector<std::string> attributes;  ///< without gaps
};

/// Bytes of the mesh if it has all the vertices and corners that accessors declare.
size_t declared_bytes(const DracoRequest& request);

/// Whether it has more than that.
bool exceeds(const DracoMesh& mesh, const DracoRequest& request);

/// All meshes, or those before the first that cannot be decoded; `fault` says what is wrong with
/// it. The indices are as they come, not necessarily of vertices that there are.
std::vector<DracoMesh> decode_draco(const std::vector<DracoRequest>& requests, std::string& fault);

}  // namespace tdpt::gltf
