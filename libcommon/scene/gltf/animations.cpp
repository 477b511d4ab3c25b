#include "libcommon/scene/gltf/animations.h"

#include <fmt/format.h>
#include <algorithm>

#include "libcommon/scene/gltf/accessors.h"

namespace tdpt::gltf {
namespace {

using Json = nlohmann::json;

constexpr Numbers kTranslations = {"translations", 3, true, false, false, false};
constexpr Numbers kRotations = {"rotations", 4, true, true, true, false};
constexpr Numbers kScales = {"scales", 3, true, false, false, false};
constexpr Numbers kWeights = {"weights", 1, true, true, true, false};

class Animator {
 public:
  explicit Animator(Document& d) : d_(d) {}

  void run(std::vector<std::string>& warnings) {
    for (const Json& a : d_.json.value("animations", Json::array()))
      for (const Json& c : a["channels"]) {
        const Json& target = c["target"];
        if (target["path"] == "pointer") {
          ++pointers_;
          continue;
        }
        move(target["node"].get<size_t>(), target["path"].get<std::string>(),
             a["samplers"][c["sampler"].get<size_t>()]);
      }
    if (moved_) warnings.push_back("the scene is taken at time 0 of its animations");
    if (pointers_ > 0)
      warnings.push_back(counted(pointers_, "animation channel", "moves no node, and is left out",
                                 "move no node, and are left out"));
    if (matrices_ > 0)
      warnings.push_back(counted(matrices_, "animation channel",
                                 "moves a node that has a matrix, and is left out",
                                 "move nodes that have a matrix, and are left out"));
  }

 private:
  void move(size_t index, const std::string& path, const Json& sampler) {
    tinygltf::Node& n = d_.model.nodes[index];
    const auto output = sampler["output"].get<size_t>();
    if (path != "weights" && !n.matrix.empty()) {
      ++matrices_;
      return;
    }
    moved_ = true;
    // Each key of a cubic spline has three values: tangent, value, tangent.
    const bool cubic = sampler.value("interpolation", "LINEAR") == "CUBICSPLINE";
    const auto key = [&](const Numbers& numbers, size_t count) {
      return read_numbers(d_, output, numbers, cubic ? count : 0, count);
    };
    if (path == "translation") n.translation = key(kTranslations, 1);
    if (path == "rotation") n.rotation = key(kRotations, 1);
    if (path == "scale") n.scale = key(kScales, 1);
    if (path == "weights" && n.mesh >= 0) n.weights = key(kWeights, targets_of(n));
  }

  /// Number of morph targets of a node's mesh, the same for all its primitives.
  size_t targets_of(const tinygltf::Node& n) const {
    size_t most = 0;
    for (const tinygltf::Primitive& p : d_.model.meshes[static_cast<size_t>(n.mesh)].primitives)
      most = std::max(most, p.targets.size());
    return most;
  }

  Document& d_;
  bool moved_ = false;
  size_t pointers_ = 0, matrices_ = 0;
};

}  // namespace

void go_to_time_0(Document& d, std::vector<std::string>& warnings) {
  Animator(d).run(warnings);
}

}  // namespace tdpt::gltf
