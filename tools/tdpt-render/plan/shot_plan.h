// One plan for a shot where that is no loss: noise of one look from frame to frame.
//
// At its key frames the pilot weighs all candidates [pilot.h]. Two that are nearly as good would
// take turns by chance. So the shot is divided into the fewest runs of key frames such that within
// each run one candidate costs at most kNoLoss times as much as the best at every key.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "tools/tdpt-render/plan/plan.h"

namespace tdpt {

/// A way to render a key frame.
struct Offer {
  Plan plan;
  double cost = 1;  ///< error x work [CandidateEstimate]
};
struct KeyFrame {
  int64_t frame = 0;
  std::vector<Offer> offers;  ///< at least one; different labels
};

inline constexpr double kNoLoss = 1.1;

/// For each key the offer that is taken. `keys`: in order of their frames.
std::map<int64_t, Plan> even_plans(const std::vector<KeyFrame>& keys);

/// The frame at which more must be known to tell where the plan changes: half way between two keys
/// with different plans, unless they lie at most kNear frames apart. Nothing if all is known.
inline constexpr int64_t kNear = 3;
std::optional<int64_t> next_key(const std::vector<KeyFrame>& keys);

/// "one plan for the shot: tdpt", or which frames are rendered by what.
std::string plan_sentence(const PlanFile& shot, int64_t first, int64_t last);

}  // namespace tdpt
