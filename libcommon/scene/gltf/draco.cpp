// Primitives compressed by KHR_draco_mesh_compression: the only caller of Draco. It is given any
// bytes: it checks them itself, and no more than accessors declare is taken of the result.
#include <draco/compression/decode.h>
#include <fmt/format.h>
#include <algorithm>
#include <exception>
#include <memory>
#include <tuple>

#include "libcommon/base/file.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {
namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

// Draco has no bound on its expansion. A flat grid of a million vertices, the most regular mesh
// with an area, is 700 times as large as its compressed bytes.
constexpr size_t kAlwaysDecoded = size_t{1} << 26, kMostPerDracoByte = 1024;
constexpr size_t kMost = size_t{1} << 33;  // bytes of the largest scene

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
    case kI8:
      return convert<int8_t>(from, points, out);
    case kU8:
      return convert<uint8_t>(from, points, out);
    case kI16:
      return convert<int16_t>(from, points, out);
    case kU16:
      return convert<uint16_t>(from, points, out);
    case kU32:
      return convert<uint32_t>(from, points, out);
    default:
      return convert<float>(from, points, out);
  }
}

/// The mesh in `bytes`; null if it cannot be decoded.
std::unique_ptr<draco::Mesh> decode(std::string_view bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  try {
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (decoded.ok()) return std::move(decoded).value();
  } catch (const std::exception&) {  // a header that declares more than the memory holds
  }
  return nullptr;
}

std::string indices_of(const draco::Mesh& mesh) {
  std::string out;
  for (uint32_t f = 0; f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
      const uint32_t index = corner.value();
      out.append(reinterpret_cast<const char*>(&index), sizeof index);
    }
  return out;
}

class DracoReader {
 public:
  explicit DracoReader(Document& d)
      : d_(d), most_(std::min(kAlwaysDecoded + kMostPerDracoByte * bytes_of_buffers(d), kMost)) {}

  /// Primitives with the same description share one mesh.
  void run() {
    for (size_t mesh = 0; mesh < d_.meshes.size(); ++mesh)
      for (size_t k = 0; k < d_.meshes[mesh].primitives.size(); ++k) {
        Primitive& p = d_.meshes[mesh].primitives[k];
        if (!p.draco) continue;
        const auto [known, is_new] =
            known_.try_emplace({*p.draco, p.attributes, p.indices, p.mode}, p);
        const std::string where = place("meshes", mesh) + "." + place("primitives", k);
        if (is_new) decode_primitive(known->second, where + ".extensions." + kDraco);
        p.mode = kTriangles;
        p.indices = known->second.indices;
        p.attributes = known->second.attributes;
      }
  }

 private:
  const Accessor& accessor(size_t index) const { return d_.accessors[index]; }

  /// Checks what the accessors declare, before any of it is decoded.
  void check_size(const Primitive& p, size_t vertices, size_t corners, const std::string& where) {
    size_t bytes_of_vertex = 0;
    for (const auto& [name, id] : p.draco->ids) {
      const Accessor& a = accessor(p.attributes.at(name));
      bytes_of_vertex += bytes_of_component(a.component_type) * components_of(a.type);
    }
    // Checks the counts first, so that their product cannot overflow.
    if (vertices > most_ || corners > most_ ||
        (all_ += vertices * bytes_of_vertex + 4 * corners) > most_)
      d_.fail(where, fmt::format("declares {} vertices and {} corners of triangles, which brings "
                                 "the scene to more than the {} bytes expected at most",
                                 vertices, corners, most_));
    expect_memory(d_.file, where,
                  fmt::format("{} vertices and {} corners of triangles, with those before,",
                              vertices, corners),
                  all_);
  }

  /// Makes the accessors of a primitive hold its mesh. Its indices are not checked against the
  /// number of vertices.
  void decode_primitive(Primitive& p, const std::string& where) {
    if (!p.draco->ids.contains("POSITION")) d_.fail(where, "has no attribute POSITION");
    const size_t declared_vertices = accessor(p.attributes.at("POSITION")).count;
    const size_t declared_corners = accessor(p.indices).count * (p.mode == kTriangles ? 1 : 3);
    check_size(p, declared_vertices, declared_corners, where);
    const auto mesh = decode(view_bytes(d_, p.draco->view));
    if (!mesh) d_.fail(where, "cannot be decoded, expected a mesh of Draco, version 2.2 at most");
    // Encoders split vertices where attributes meet, and some exporters do not update the counts;
    // others count triangles instead of corners. Viewers use what Draco contains.
    const size_t vertices = mesh->num_points(), corners = size_t{3} * mesh->num_faces();
    const size_t most_corners = 3 * declared_corners;
    const size_t most_vertices =
        std::max(declared_vertices, std::min(2 * declared_vertices, most_corners));
    if (vertices > most_vertices)
      d_.fail(where, fmt::format("holds {} vertices, expected at most {}, as POSITION has {}",
                                 vertices, most_vertices, declared_vertices));
    if (corners > most_corners)
      d_.fail(where, fmt::format("holds {} corners of triangles, expected at most {}, as the "
                                 "indices are {}",
                                 corners, most_corners, declared_corners));
    for (const auto& [name, id] : p.draco->ids) {
      const draco::PointAttribute* from = mesh->GetAttributeByUniqueId(id);
      if (!from) d_.fail(where, fmt::format("holds no attribute {}", id));
      size_t& index = p.attributes.at(name);
      std::string bytes;
      if (static_cast<size_t>(from->num_components()) != components_of(accessor(index).type) ||
          !convert(*from, accessor(index).component_type, vertices, bytes))
        d_.fail(where, fmt::format("its attribute {} has other components than its accessor", id));
      replace(index, vertices, std::move(bytes));
    }
    replace(p.indices, corners, indices_of(*mesh)).component_type = kU32;
  }

  /// Makes the accessor, or a copy if it refers to other data already, refer to `bytes`.
  Accessor& replace(size_t& index, size_t count, std::string bytes) {
    if (accessor(index).view != kNone) {
      d_.accessors.push_back(Accessor(accessor(index)));
      index = d_.accessors.size() - 1;
    }
    Accessor& a = d_.accessors[index];
    a.view = d_.views.size();
    a.offset = 0;
    a.count = count;
    a.sparse.reset();
    d_.views.push_back({d_.buffers.size(), 0, bytes.size(), 0, {}});
    d_.owned.push_back(std::move(bytes));
    d_.buffers.push_back(d_.owned.back());
    return a;
  }

  Document& d_;
  const size_t most_;                                                         // bytes of all meshes
  size_t all_ = 0;                                                            // bytes so far
  std::map<std::tuple<Draco, Attributes, size_t, size_t>, Primitive> known_;  // decoded
};

}  // namespace

std::optional<Draco> read_draco(const Value& primitive, const Primitive& read) {
  const Value extension = primitive.extension(kDraco);
  if (!extension) return {};
  Draco out;
  out.view = extension["bufferView"].needed().index("bufferViews");
  for (const auto& [name, id] : extension["attributes"].needed().members()) {
    if (!is_read_attribute(name)) continue;
    out.ids[name] = static_cast<uint32_t>(id.integer(0, 0, 4294967295.0));
    if (!read.attributes.contains(name))
      primitive["attributes"][name.c_str()].needed("but is compressed by Draco");
  }
  if (read.indices == kNone && read.is_surface())
    primitive["indices"].needed("meshes compressed by Draco have some");
  return out;
}

void decode_draco_primitives(Document& d) {
  DracoReader(d).run();
}

}  // namespace tdpt::gltf
