// The only caller of Draco. It is given any bytes: it checks them itself, and no more than the
// request declares is taken of the result.
#include "libcommon/scene/gltf/compression.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>
#include <algorithm>
#include <exception>

namespace tdpt::gltf {
namespace {

using Attribute = DracoRequest::Attribute;

// Encoders split vertices where attributes meet, and some exporters do not update the counts;
// others count triangles instead of corners. Viewers use what Draco contains.
size_t most_corners(const DracoRequest& request) {
  return 3 * request.corners;
}
size_t most_vertices(const DracoRequest& request) {
  return std::max(request.vertices, std::min(2 * request.vertices, most_corners(request)));
}

size_t bytes_of(int component_type) {
  return component_type == 5120 || component_type == 5121   ? 1
         : component_type == 5122 || component_type == 5123 ? 2
                                                            : 4;
}

template <class T>
bool convert(const draco::PointAttribute& from, size_t points, std::string& out) {
  const auto components = static_cast<size_t>(from.num_components());
  out.resize(points * components * sizeof(T));
  std::vector<T> value(components);
  for (uint32_t i = 0; i < points; ++i) {
    const draco::AttributeValueIndex at = from.mapped_index(draco::PointIndex(i));
    if (at.value() >= from.size()) return false;
    if (!from.ConvertValue<T>(at, from.num_components(), value.data())) return false;
    std::copy_n(reinterpret_cast<const char*>(value.data()), components * sizeof(T),
                out.data() + i * components * sizeof(T));
  }
  return true;
}

bool convert(const draco::PointAttribute& from, int type, size_t points, std::string& out) {
  switch (type) {
    case 5120:
      return convert<int8_t>(from, points, out);
    case 5121:
      return convert<uint8_t>(from, points, out);
    case 5122:
      return convert<int16_t>(from, points, out);
    case 5123:
      return convert<uint16_t>(from, points, out);
    case 5125:
      return convert<uint32_t>(from, points, out);
    default:
      return convert<float>(from, points, out);
  }
}

/// Reads what the request asks for from a decoded mesh. The result: what is wrong with it; empty:
/// nothing.
std::string copy(const draco::Mesh& mesh, const DracoRequest& request, DracoMesh& out) {
  out.vertices = mesh.num_points();
  out.corners = size_t{3} * mesh.num_faces();
  if (out.vertices > most_vertices(request))
    return fmt::format("holds {} vertices, expected at most {}, as POSITION has {}", out.vertices,
                       most_vertices(request), request.vertices);
  if (out.corners > most_corners(request))
    return fmt::format("holds {} corners of triangles, expected at most {}, as the indices are {}",
                       out.corners, most_corners(request), request.corners);
  for (uint32_t f = 0; f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
      const uint32_t index = corner.value();
      out.indices.append(reinterpret_cast<const char*>(&index), sizeof index);
    }
  for (const Attribute& a : request.attributes) {
    const draco::PointAttribute* from = mesh.GetAttributeByUniqueId(a.id);
    if (!from) return fmt::format("holds no attribute {}", a.id);
    if (from->num_components() != a.components ||
        !convert(*from, a.component_type, out.vertices, out.attributes.emplace_back()))
      return fmt::format("its attribute {} has other components than its accessor", a.id);
  }
  return "";
}

}  // namespace

size_t declared_bytes(const DracoRequest& request) {
  size_t of_vertex = 0;
  for (const Attribute& a : request.attributes)
    of_vertex += bytes_of(a.component_type) * static_cast<size_t>(a.components);
  return request.vertices * of_vertex + 4 * request.corners;
}

bool exceeds(const DracoMesh& mesh, const DracoRequest& request) {
  return mesh.vertices > request.vertices || mesh.corners > request.corners;
}

DracoMesh decode_draco(const DracoRequest& request, std::string& fault) {
  DracoMesh out;
  draco::DecoderBuffer buffer;
  buffer.Init(request.bytes.data(), request.bytes.size());
  fault = "cannot be decoded, expected a mesh of Draco, version 2.2 at most";
  try {
    const auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (decoded.ok() && decoded.value()) fault = copy(*decoded.value(), request, out);
  } catch (const std::exception&) {  // a header that declares more than the memory holds
  }
  return out;
}

}  // namespace tdpt::gltf
