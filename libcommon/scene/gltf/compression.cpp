#include "libcommon/scene/gltf/compression.h"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <tuple>

#include "libcommon/base/file.h"

namespace tdpt::gltf {
namespace {

using Json = nlohmann::json;
using Primitive = tinygltf::Primitive;

// Draco has no bound on its expansion. A flat grid of a million vertices, the most regular mesh
// with an area, is 700 times as large as its compressed bytes.
constexpr size_t kAlways = size_t{1} << 26, kMostOfAByte = 1024;
constexpr size_t kMost = size_t{1} << 33;  // bytes of the largest scene

bool is_required(const Document& d) {
  const Json required = d.json.value("extensionsRequired", Json::array());
  return std::find(required.begin(), required.end(), kDraco) != required.end();
}

class Decoder {
 public:
  explicit Decoder(Document& d) : d_(d), required_(is_required(d)) {
    size_t bytes = 0;
    for (const std::string_view b : d.buffers) bytes += b.size();
    most_ = std::min(kAlways + kMostOfAByte * bytes, kMost);
  }

  void run() {
    for (size_t mesh = 0; mesh < d_.model.meshes.size(); ++mesh)
      for (size_t k = 0; k < d_.model.meshes[mesh].primitives.size(); ++k) collect(mesh, k);
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

  const tinygltf::Accessor& accessor(int index) const {
    return d_.model.accessors[static_cast<size_t>(index)];
  }

  /// Adds a primitive to those to be decoded. Primitives with the same description share one mesh.
  void collect(size_t mesh, size_t k) {
    Primitive& p = d_.model.meshes[mesh].primitives[k];
    const Json& json = d_.json["meshes"][mesh]["primitives"][k];
    if (p.mode < TINYGLTF_MODE_TRIANGLES || !is_draco(json)) return;
    const Json& e = json["extensions"][kDraco];
    if (!required_ && is_plain(p, e)) return;
    const auto [it, is_new] =
        known_.try_emplace({e.dump(), p.attributes, p.indices, p.mode}, jobs_.size());
    if (is_new) {
      Job& job = jobs_.emplace_back();
      job.where = place("meshes", mesh) + "." + place("primitives", k) + ".extensions." + kDraco;
      ask(p, e, job);
    }
    jobs_[it->second].users.push_back(&p);
  }

  bool is_plain(const Primitive& p, const Json& e) const {
    bool plain = accessor(p.indices).bufferView >= 0;
    for (const auto& [name, id] : e["attributes"].items())
      plain &= accessor(p.attributes.at(name)).bufferView >= 0;
    return plain;
  }

  void ask(const Primitive& p, const Json& e, Job& job) {
    if (!e["attributes"].contains("POSITION")) d_.fail(job.where, "has no attribute POSITION");
    DracoRequest& r = job.request;
    r.bytes = view_bytes(d_, e["bufferView"].get<size_t>());
    r.vertices = accessor(p.attributes.at("POSITION")).count;
    const size_t corners = accessor(p.indices).count;
    r.corners = p.mode == TINYGLTF_MODE_TRIANGLES ? corners : 3 * corners;
    for (const auto& [name, id] : e["attributes"].items()) {
      const tinygltf::Accessor& a = accessor(p.attributes.at(name));
      job.attributes.push_back(name);
      r.attributes.push_back({id.get<uint32_t>(), a.componentType,
                              tinygltf::GetNumComponentsInType(static_cast<uint32_t>(a.type))});
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
    p.mode = TINYGLTF_MODE_TRIANGLES;
    put_in_place(p.indices, mesh.corners, mesh.indices).componentType =
        TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    for (size_t i = 0; i < job.attributes.size(); ++i)
      put_in_place(p.attributes.at(job.attributes[i]), mesh.vertices, mesh.attributes[i]);
    for (Primitive* user : job.users) {
      user->mode = p.mode, user->indices = p.indices, user->attributes = p.attributes;
    }
  }

  /// Makes the accessor, or a copy if it is used already, refer to `bytes`.
  tinygltf::Accessor& put_in_place(int& index, size_t count, std::string& bytes) {
    if (accessor(index).bufferView >= 0) {
      d_.model.accessors.push_back(tinygltf::Accessor(accessor(index)));
      index = static_cast<int>(d_.model.accessors.size()) - 1;
    }
    tinygltf::Accessor& a = d_.model.accessors[static_cast<size_t>(index)];
    tinygltf::BufferView view;
    view.buffer = static_cast<int>(d_.buffers.size());
    view.byteLength = bytes.size();
    a.bufferView = static_cast<int>(d_.model.bufferViews.size());
    a.byteOffset = 0;
    a.count = count;
    d_.model.bufferViews.push_back(view);
    d_.owned.push_back(std::move(bytes));
    d_.buffers.push_back(d_.owned.back());
    return a;
  }

  Document& d_;
  bool required_;
  size_t most_ = 0, all_ = 0;  // bytes over all meshes
  size_t more_ = 0;            // meshes that contain more than their accessors declare
  std::vector<Job> jobs_;
  // Key: bufferView and attributes of the extension, indices, mode.
  std::map<std::tuple<std::string, std::map<std::string, int>, int, int>, size_t> known_;
};

}  // namespace

bool is_draco(const nlohmann::json& primitive) {
  return primitive.contains("extensions") && primitive["extensions"].contains(kDraco);
}

void decode_draco_primitives(Document& d) {
  const auto meshes = d.json.find("meshes");
  if (meshes == d.json.end()) return;
  for (const Json& mesh : *meshes)
    for (const Json& p : mesh["primitives"])
      if (is_draco(p)) return Decoder(d).run();
}

}  // namespace tdpt::gltf
