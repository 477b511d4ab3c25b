// How much light a picture of limited depth leaves out.
//
// Method: ratio estimator over groups of samples, its error by the delta method.
#pragma once
#include <string>
#include <vector>

#include "tools/tdpt-render/path/sample/path.h"

namespace tdpt {

/// Light of paths of more than `depth` edges.
struct Truncation {
  int depth = 0;
  double share = 0;  ///< of all light, [0,1]
  double error = 0;  ///< standard error of the share
};

/// Sums the light of paths within a depth, and of longer ones.
class LightByDepth {
 public:
  explicit LightByDepth(int depth) : depth_(depth) {}
  /// A path of the current group and its weighted luminance.
  void see(const Path& path, double light) {
    (path.k() > depth_ ? groups_.back().beyond : groups_.back().within) += light;
  }
  void merge(const LightByDepth& other) {
    groups_.insert(groups_.end(), other.groups_.begin(), other.groups_.end());
  }
  Truncation beyond() const;

 private:
  struct Group {
    double within = 0, beyond = 0;  // luminance
  };
  int depth_;
  std::vector<Group> groups_ = std::vector<Group>(1);
};

/// "--max-depth 6 leaves out about 25 % of the light".
std::string sentence(const Truncation& beyond);

}  // namespace tdpt
