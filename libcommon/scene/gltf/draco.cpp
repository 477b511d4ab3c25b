// Primitives compressed by KHR_draco_mesh_compression: the only caller of Draco. It is given any
// bytes: it checks them itself, and no more than accessors declare is taken of the result.
#include <draco/compression/decode.h>
#include <fmt/format.h>
#include <algorithm>
#include <exception>
#include <tuple>

#include "libcommon/base/file.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {
namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// A compressed mesh, and what to decode of it.
struct DracoRequest {
  struct Attribute {
    uint32_t id;         ///< Draco's unique id
    int component_type;  ///< glTF's code of the type to convert to
    size_t components;
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

// Encoders split vertices where attributes meet, and some exporters do not update the counts;
// others count triangles instead of corners. Viewers use what Draco contains.
size_t most_corners(const DracoRequest& request) {
  return 3 * request.corners;
}
size_t most_vertices(const DracoRequest& request) {
  return std::max(request.vertices, std::min(2 * request.vertices, most_corners(request)));
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
  for (const DracoRequest::Attribute& a : request.attributes) {
    const draco::PointAttribute* from = mesh.GetAttributeByUniqueId(a.id);
    if (!from) return fmt::format("holds no attribute {}", a.id);
    if (static_cast<size_t>(from->num_components()) != a.components ||
        !convert(*from, a.component_type, out.vertices, out.attributes.emplace_back()))
      return fmt::format("its attribute {} has other components than its accessor", a.id);
  }
  return "";
}

/// Bytes of the mesh with the vertices and corners that accessors declare.
size_t declared_bytes(const DracoRequest& request) {
  size_t of_vertex = 0;
  for (const DracoRequest::Attribute& a : request.attributes)
    of_vertex += bytes_of_component(a.component_type) * a.components;
  return request.vertices * of_vertex + 4 * request.corners;
}

/// Whether it has more than those.
bool exceeds(const DracoMesh& mesh, const DracoRequest& request) {
  return mesh.vertices > request.vertices || mesh.corners > request.corners;
}

/// The mesh; if it cannot be decoded, `fault` says why, else it is empty. Indices are not checked
/// against the number of vertices.
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

// Draco has no bound on its expansion. A flat grid of a million vertices, the most regular mesh
// with an area, is 700 times as large as its compressed bytes.
constexpr size_t kAlways = size_t{1} << 26, kMostOfAByte = 1024;
constexpr size_t kMost = size_t{1} << 33;  // bytes of the largest scene

class DracoReader {
 public:
  explicit DracoReader(Document& d)
      : d_(d), most_(std::min(kAlways + kMostOfAByte * bytes_of_buffers(d), kMost)) {}

  void run() {
    for (size_t mesh = 0; mesh < d_.meshes.size(); ++mesh)
      for (size_t k = 0; k < d_.meshes[mesh].primitives.size(); ++k) collect(mesh, k);
    for (const Job& job : jobs_) {
      std::string fault;
      DracoMesh decoded = decode_draco(job.request, fault);
      if (!fault.empty()) d_.fail(job.where, fault);
      put_in_place(job, decoded);
    }
    if (more_ > 0)
      d_.warnings.push_back(counted(more_, "mesh",
                                    "of Draco holds more than its accessors say: all is read",
                                    "of Draco hold more than their accessors say: all is read"));
  }

 private:
  struct Job {
    std::string where;
    DracoRequest request;
    std::vector<std::string> attributes;  ///< names, parallel to the request's attributes
    std::vector<Primitive*> users;
  };

  const Accessor& accessor(int index) const { return d_.accessors[static_cast<size_t>(index)]; }

  /// Adds a primitive to those to be decoded. Primitives with the same description share one mesh.
  void collect(size_t mesh, size_t k) {
    Primitive& p = d_.meshes[mesh].primitives[k];
    if (!p.draco || (!d_.draco_required && is_plain(p))) return;
    const auto [it, is_new] =
        known_.try_emplace({*p.draco, p.attributes, p.indices, p.mode}, jobs_.size());
    if (is_new) {
      Job& job = jobs_.emplace_back();
      job.where = place("meshes", mesh) + "." + place("primitives", k) + ".extensions." + kDraco;
      ask(p, job);
    }
    jobs_[it->second].users.push_back(&p);
  }

  bool is_plain(const Primitive& p) const {
    bool plain = accessor(p.indices).view >= 0;
    for (const auto& [name, id] : p.draco->ids) plain &= accessor(p.attributes.at(name)).view >= 0;
    return plain;
  }

  void ask(const Primitive& p, Job& job) {
    if (!p.draco->ids.contains("POSITION")) d_.fail(job.where, "has no attribute POSITION");
    DracoRequest& r = job.request;
    r.bytes = view_bytes(d_, p.draco->view);
    r.vertices = accessor(p.attributes.at("POSITION")).count;
    const size_t corners = accessor(p.indices).count;
    r.corners = p.mode == kTriangles ? corners : 3 * corners;
    for (const auto& [name, id] : p.draco->ids) {
      const Accessor& a = accessor(p.attributes.at(name));
      job.attributes.push_back(name);
      r.attributes.push_back({id, a.component_type, components_of(a.type)});
    }
    // Checks the counts first, so that their product cannot overflow.
    if (r.vertices > most_ || r.corners > most_ || (all_ += declared_bytes(r)) > most_)
      d_.fail(
          job.where,
          fmt::format("declares {} vertices and {} corners of triangles, which brings the scene "
                      "to more than the {} bytes expected at most",
                      r.vertices, r.corners, most_));
    expect_memory(d_.file, job.where,
                  fmt::format("{} vertices and {} corners of triangles, with those before,",
                              r.vertices, r.corners),
                  all_);
  }

  void put_in_place(const Job& job, DracoMesh& mesh) {
    more_ += exceeds(mesh, job.request);
    Primitive p = *job.users.front();
    p.mode = kTriangles;
    put_in_place(p.indices, mesh.corners, mesh.indices).component_type = kU32;
    for (size_t i = 0; i < job.attributes.size(); ++i)
      put_in_place(p.attributes.at(job.attributes[i]), mesh.vertices, mesh.attributes[i]);
    for (Primitive* user : job.users) {
      user->mode = p.mode, user->indices = p.indices, user->attributes = p.attributes;
    }
  }

  /// Makes the accessor, or a copy if it is used already, refer to `bytes`.
  Accessor& put_in_place(int& index, size_t count, std::string& bytes) {
    if (accessor(index).view >= 0) {
      d_.accessors.push_back(Accessor(accessor(index)));
      index = static_cast<int>(d_.accessors.size()) - 1;
    }
    Accessor& a = d_.accessors[static_cast<size_t>(index)];
    a.view = static_cast<int>(d_.views.size());
    a.offset = 0;
    a.count = count;
    d_.views.push_back({d_.buffers.size(), 0, bytes.size(), 0, {}});
    d_.owned.push_back(std::move(bytes));
    d_.buffers.push_back(d_.owned.back());
    return a;
  }

  Document& d_;
  const size_t most_;  // bytes of all meshes
  size_t all_ = 0;     // bytes so far
  size_t more_ = 0;    // meshes that contain more than their accessors declare
  std::vector<Job> jobs_;
  // By the extension, attributes, indices and mode.
  std::map<std::tuple<Draco, Attributes, int, size_t>, size_t> known_;
};

}  // namespace

std::optional<Draco> read_draco(const Value& primitive, const Primitive& read) {
  const Value extension = primitive.extension(kDraco);
  if (!extension) return {};
  Draco out;
  out.view = static_cast<size_t>(extension["bufferView"].needed().index("bufferViews"));
  for (const auto& [name, id] : extension["attributes"].needed().members()) {
    if (!is_read_attribute(name)) continue;
    out.ids[name] = static_cast<uint32_t>(id.integer(0, 0, 4294967295.0));
    if (!read.attributes.contains(name))
      primitive["attributes"][name.c_str()].needed("but is compressed by Draco");
  }
  if (read.indices < 0 && read.is_surface())
    primitive["indices"].needed("meshes compressed by Draco have some");
  return out;
}

void decode_draco_primitives(Document& d) {
  DracoReader(d).run();
}

}  // namespace tdpt::gltf
