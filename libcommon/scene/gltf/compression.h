// Compressed primitives (KHR_draco_mesh_compression) and bufferViews (EXT_meshopt_compression and
// KHR_meshopt_compression). Internal to this room.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

bool is_draco(const nlohmann::json& primitive);

/// Decodes the primitives of all placed meshes, so that their accessors are like any others. A
/// primitive whose accessors all have a bufferView is used uncompressed, unless Draco is required.
/// Throws InputError.
void decode_draco_primitives(Document& document);

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

/// The mesh; if it cannot be decoded, `fault` says why, else it is empty. Indices are not checked
/// against the number of vertices.
DracoMesh decode_draco(const DracoRequest& request, std::string& fault);

constexpr const char* kMeshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

/// Whether a buffer is only a fallback for compressed bufferViews. It may have no bytes.
bool is_meshopt_fallback(const nlohmann::json& buffer);

bool is_meshopt_view(const Document& document, size_t view);

/// Decodes a compressed bufferView. Throws InputError if the data are invalid, shorter than the
/// bufferView or, together with everything decoded before, more than the buffers can hold.
std::string unpack_meshopt_view(const Document& document, size_t view);

/// Upper bound on the decoded bytes of all compressed bufferViews.
size_t most_bytes_of_meshopt(const Document& document);

}  // namespace tdpt::gltf
