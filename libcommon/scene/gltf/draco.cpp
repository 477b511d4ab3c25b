// The only caller of Draco, in a child process: it allocates whatever numbers of faces and vertices
// a header declares, and may compute for long before it finds an error. The decoded meshes return
// through a pipe, one by one.
#include "libcommon/scene/gltf/compression.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>
#include <algorithm>
#include <cstdio>

#include "libcommon/base/child_process.h"
#include "libcommon/base/file.h"

namespace tdpt::gltf {
namespace {

using Attribute = DracoRequest::Attribute;

/// What is wrong with a mesh; from `attribute` on a number follows.
enum class Fault : uint32_t { none, undecodable, vertices, corners, attribute, components };

// Extra memory for decoding, measured: at most 8 times the result for large meshes.
constexpr size_t kRoom = size_t{32} << 20, kRoomOfAByte = 16;
// Measured: 1e8 bytes of result per second.
constexpr unsigned kSeconds = 2;
constexpr size_t kBytesInASecond = size_t{1} << 22;

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

Fault decode(const DracoRequest& request, DracoMesh& out, uint32_t& number) {
  draco::DecoderBuffer buffer;
  buffer.Init(request.bytes.data(), request.bytes.size());
  const auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok() || !decoded.value()) return Fault::undecodable;
  const draco::Mesh& mesh = *decoded.value();
  out.vertices = mesh.num_points();
  out.corners = size_t{3} * mesh.num_faces();
  if (out.vertices > most_vertices(request)) return number = mesh.num_points(), Fault::vertices;
  if (out.corners > most_corners(request)) return number = 3 * mesh.num_faces(), Fault::corners;
  for (uint32_t f = 0; f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
      const uint32_t index = corner.value();
      out.indices.append(reinterpret_cast<const char*>(&index), sizeof index);
    }
  for (const Attribute& a : request.attributes) {
    number = a.id;
    const draco::PointAttribute* from = mesh.GetAttributeByUniqueId(a.id);
    if (!from) return Fault::attribute;
    if (from->num_components() != a.components ||
        !convert(*from, a.component_type, out.vertices, out.attributes.emplace_back()))
      return Fault::components;
  }
  return Fault::none;
}

void put(std::FILE* file, uint32_t value) {
  std::fwrite(&value, sizeof value, 1, file);
}

bool get(std::FILE* file, uint32_t& value) {
  return std::fread(&value, sizeof value, 1, file) == 1;
}

bool get(std::FILE* file, size_t size, std::string& out) {
  out.resize(size);
  return std::fread(out.data(), 1, size, file) == size;
}

void put(std::FILE* file, Fault fault, uint32_t number, const DracoMesh& mesh) {
  put(file, static_cast<uint32_t>(fault)), put(file, number);
  if (fault == Fault::none) {
    put(file, static_cast<uint32_t>(mesh.vertices));
    put(file, static_cast<uint32_t>(mesh.corners));
    std::fwrite(mesh.indices.data(), 1, mesh.indices.size(), file);
    for (const std::string& a : mesh.attributes) std::fwrite(a.data(), 1, a.size(), file);
  }
  std::fflush(file);
}

/// Reads a mesh from the pipe. The other process may have gone wrong, so nothing beyond the request
/// is trusted.
bool get(std::FILE* file, const DracoRequest& request, Fault& fault, uint32_t& number,
         DracoMesh& mesh) {
  uint32_t word = 0, vertices = 0, corners = 0;
  if (!get(file, word) || !get(file, number)) return false;
  fault = static_cast<Fault>(word);
  if (fault != Fault::none) return false;
  if (!get(file, vertices) || !get(file, corners)) return false;
  if (vertices > most_vertices(request) || corners > most_corners(request)) return false;
  mesh.vertices = vertices, mesh.corners = corners;
  bool whole = get(file, size_t{4} * corners, mesh.indices);
  for (const Attribute& a : request.attributes)
    whole = whole &&
            get(file, vertices * bytes_of(a.component_type) * static_cast<size_t>(a.components),
                mesh.attributes.emplace_back());
  return whole;
}

std::string text_of(Fault fault, uint32_t number, const DracoRequest& request) {
  switch (fault) {
    case Fault::vertices:
      return fmt::format("holds {} vertices, expected at most {}, as POSITION has {}", number,
                         most_vertices(request), request.vertices);
    case Fault::corners:
      return fmt::format(
          "holds {} corners of triangles, expected at most {}, as the indices are {}", number,
          most_corners(request), request.corners);
    case Fault::attribute:
      return fmt::format("holds no attribute {}", number);
    case Fault::components:
      return fmt::format("its attribute {} has other components than its accessor", number);
    default:
      return "cannot be decoded, expected a mesh of Draco, version 2.2 at most";
  }
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

std::vector<DracoMesh> decode_draco(const std::vector<DracoRequest>& requests, std::string& fault) {
  std::vector<DracoMesh> meshes;
  size_t declared = 0;
  for (const DracoRequest& r : requests) declared += declared_bytes(r);
  fault.clear();
  Fault found = Fault::none;
  uint32_t number = 0;
  const bool whole = in_another_process(
      [&](std::FILE* file) {
        limit_this_process(kRoom + kRoomOfAByte * declared,
                           kSeconds + static_cast<unsigned>(declared / kBytesInASecond));
        for (const DracoRequest& r : requests) {
          DracoMesh mesh;
          uint32_t of_fault = 0;
          const Fault f = decode(r, mesh, of_fault);
          put(file, f, of_fault, mesh);
          if (f != Fault::none) return;
        }
      },
      [&](std::FILE* file) {
        for (const DracoRequest& r : requests) {
          DracoMesh mesh;
          if (!get(file, r, found, number, mesh)) return false;
          meshes.push_back(std::move(mesh));
        }
        return true;
      });
  if (!whole && meshes.size() == requests.size()) meshes.pop_back();  // the last mesh is incomplete
  if (meshes.size() == requests.size()) return meshes;
  const bool limited = kRoom + kRoomOfAByte * declared > memory_limit();
  fault = limited && found == Fault::none
              ? "cannot be decoded in the " + size_words(memory_limit()) + " of --max-memory"
              : text_of(found, number, requests[meshes.size()]);
  return meshes;
}

}  // namespace tdpt::gltf
