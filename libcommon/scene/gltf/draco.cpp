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
constexpr size_t kAlways = size_t{1} << 26, kMostOfAByte = 1024;
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
      : d_(d), most_(std::min(kAlways + kMostOfAByte * bytes_of_buffers(d), kMost)) {}

  void run() {
    for (size_t mesh = 0; mesh < d_.meshes.size(); ++mesh)
      for (size_t k = 0; k < d_.meshes[mesh].primitives.size(); ++k) collect(mesh, k);
    for (Job& job : jobs_) {
      decode_primitive(job);
      for (Primitive* user : job.users) {
        user->mode = job.primitive.mode;
        user->indices = job.primitive.indices;
        user->attributes = job.primitive.attributes;
      }
    }
  }

 private:
  struct Job {
    std::string where;
    Primitive primitive;
    std::vector<Primitive*> users;
    size_t vertices, corners;  ///< as accessors declare them
  };

  const Accessor& accessor(size_t index) const { return d_.accessors[index]; }

  /// Adds a primitive to those to be decoded. Primitives with the same description share one mesh.
  void collect(size_t mesh, size_t k) {
    Primitive& p = d_.meshes[mesh].primitives[k];
    if (!p.draco || (!d_.draco_required && is_plain(p))) return;
    const auto [it, is_new] = known_.try_emplace(p, jobs_.size());
    if (is_new) add_job(place("meshes", mesh) + "." + place("primitives", k), p);
    jobs_[it->second].users.push_back(&p);
  }

  bool is_plain(const Primitive& p) const {
    bool plain = accessor(p.indices).view != kNone;
    for (const auto& [name, id] : p.draco->ids)
      plain &= accessor(p.attributes.at(name)).view != kNone;
    return plain;
  }

  void add_job(const std::string& owner, const Primitive& p) {
    const std::string where = owner + ".extensions." + kDraco;
    if (!p.draco->ids.contains("POSITION")) d_.fail(where, "has no attribute POSITION");
    const size_t vertices = accessor(p.attributes.at("POSITION")).count;
    const size_t corners = accessor(p.indices).count * (p.mode == kTriangles ? 1 : 3);
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
    jobs_.push_back({where, p, {}, vertices, corners});
  }

  /// Makes the accessors of the job's primitive hold its mesh. Its indices are not checked against
  /// the number of vertices.
  void decode_primitive(Job& job) {
    Primitive& p = job.primitive;
    const auto mesh = decode(view_bytes(d_, p.draco->view));
    if (!mesh)
      d_.fail(job.where, "cannot be decoded, expected a mesh of Draco, version 2.2 at most");
    // Encoders split vertices where attributes meet, and some exporters do not update the counts;
    // others count triangles instead of corners. Viewers use what Draco contains.
    const size_t vertices = mesh->num_points(), corners = size_t{3} * mesh->num_faces();
    const size_t most_corners = 3 * job.corners;
    const size_t most_vertices = std::max(job.vertices, std::min(2 * job.vertices, most_corners));
    if (vertices > most_vertices)
      d_.fail(job.where, fmt::format("holds {} vertices, expected at most {}, as POSITION has {}",
                                     vertices, most_vertices, job.vertices));
    if (corners > most_corners)
      d_.fail(job.where, fmt::format("holds {} corners of triangles, expected at most {}, as the "
                                     "indices are {}",
                                     corners, most_corners, job.corners));
    if (vertices > job.vertices || corners > job.corners)
      d_.notes.add("Draco holds more than the accessors declare, and all is read", job.where);
    for (const auto& [name, id] : p.draco->ids) {
      const draco::PointAttribute* from = mesh->GetAttributeByUniqueId(id);
      if (!from) d_.fail(job.where, fmt::format("holds no attribute {}", id));
      size_t& index = p.attributes.at(name);
      std::string bytes;
      if (static_cast<size_t>(from->num_components()) != components_of(accessor(index).type) ||
          !convert(*from, accessor(index).component_type, vertices, bytes))
        d_.fail(job.where,
                fmt::format("its attribute {} has other components than its accessor", id));
      put_in_place(index, vertices, std::move(bytes));
    }
    p.mode = kTriangles;
    put_in_place(p.indices, corners, indices_of(*mesh)).component_type = kU32;
  }

  /// Makes the accessor, or a copy if it is used already, refer to `bytes`.
  Accessor& put_in_place(size_t& index, size_t count, std::string bytes) {
    if (accessor(index).view != kNone) {
      d_.accessors.push_back(Accessor(accessor(index)));
      index = d_.accessors.size() - 1;
    }
    Accessor& a = d_.accessors[index];
    a.view = d_.views.size();
    a.offset = 0;
    a.count = count;
    d_.views.push_back({d_.buffers.size(), 0, bytes.size(), 0, {}});
    d_.owned.push_back(std::move(bytes));
    d_.buffers.push_back(d_.owned.back());
    return a;
  }

  struct ByDescription {
    bool operator()(const Primitive& a, const Primitive& b) const {
      return std::tie(a.draco, a.attributes, a.indices, a.mode) <
             std::tie(b.draco, b.attributes, b.indices, b.mode);
    }
  };

  Document& d_;
  const size_t most_;  // bytes of all meshes
  size_t all_ = 0;     // bytes so far
  std::vector<Job> jobs_;
  std::map<Primitive, size_t, ByDescription> known_;  // jobs
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
