#include "tools/tdpt-render/plan/shot_plan.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

namespace tdpt {
namespace {

std::string name_of(const Plan& plan) {
  return plan.label.empty() ? plan.integrator.name : plan.label;
}

const Offer* offer_called(const KeyFrame& key, const std::string& label) {
  const auto at = std::find_if(key.offers.begin(), key.offers.end(),
                               [&](const Offer& o) { return o.plan.label == label; });
  return at == key.offers.end() ? nullptr : &*at;
}

double least_cost(const KeyFrame& key) {
  double least = std::numeric_limits<double>::infinity();
  for (const Offer& offer : key.offers) least = std::min(least, offer.cost);
  return least;
}

// How many keys from `first` on can be rendered by this candidate, and at what cost over the best.
struct Reach {
  size_t keys = 0;
  double excess = 0;
};

Reach reach_of(const std::vector<KeyFrame>& keys, size_t first, const std::string& label) {
  Reach reach;
  for (size_t k = first; k < keys.size(); ++k) {
    const Offer* const offer = offer_called(keys[k], label);
    const double least = least_cost(keys[k]);
    if (!offer || !(offer->cost <= kNoLoss * least)) break;
    ++reach.keys;
    if (least > 0) reach.excess += offer->cost / least - 1;
  }
  return reach;
}

}  // namespace

// The longest run first: no division into runs has fewer.
std::map<int64_t, Plan> even_plans(const std::vector<KeyFrame>& keys) {
  std::map<int64_t, Plan> plans;
  for (size_t k = 0; k < keys.size();) {
    std::string best = keys[k].offers.front().plan.label;
    Reach most;
    for (const Offer& offer : keys[k].offers) {
      const Reach reach = reach_of(keys, k, offer.plan.label);
      if (reach.keys < most.keys || (reach.keys == most.keys && reach.excess >= most.excess))
        continue;
      most = reach;
      best = offer.plan.label;
    }
    for (const size_t end = k + std::max<size_t>(most.keys, 1); k < end; ++k)
      plans[keys[k].frame] = offer_called(keys[k], best)->plan;
  }
  return plans;
}

std::optional<int64_t> next_key(const std::vector<KeyFrame>& keys) {
  const std::map<int64_t, Plan> plans = even_plans(keys);
  for (size_t i = 1; i < keys.size(); ++i) {
    const int64_t before = keys[i - 1].frame, after = keys[i].frame;
    if (plans.at(before).label != plans.at(after).label && after - before > kNear)
      return (before + after) / 2;
  }
  return {};
}

std::string plan_sentence(const PlanFile& shot, int64_t first, int64_t last) {
  struct Run {
    int64_t first, last;
    std::string name;
  };
  std::vector<Run> runs;
  for (int64_t k = first; k <= last; ++k) {
    const std::string name = name_of(shot.of_frame(k));
    if (runs.empty() || runs.back().name != name) runs.push_back({k, k, name});
    runs.back().last = k;
  }
  if (runs.size() == 1) return "one plan for the shot: " + runs[0].name;
  std::vector<std::string> words;
  for (const Run& r : runs) words.push_back(fmt::format("{}-{} by {}", r.first, r.last, r.name));
  return fmt::format("the plan changes within the shot: frames {}", fmt::join(words, ", "));
}

}  // namespace tdpt
