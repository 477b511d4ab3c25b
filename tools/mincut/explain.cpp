#include "tools/mincut/explain.h"

#include <fmt/format.h>

namespace tdpt {
namespace {

using cli::Decision;
using cli::Decisions;

// The two figures that every cut is held against.
std::string figures(const CutFacts& f, const CutLimits& limits) {
  return fmt::format("conductance {:.2g}, at most {:.2g}; smaller side {:.2g} %, at least {:.2g} %",
                     f.conductance, limits.largest_conductance, 100 * f.smaller_side(),
                     100 * limits.least_area);
}

Decision of_search(const FoundCuts& found, size_t most, const std::string& price) {
  const std::string chosen = fmt::format("ended after {} {} of the potential", found.drops,
                                         found.drops == 1 ? "drop" : "drops");
  if (found.passed > 0)
    return {"search", chosen, fmt::format("{} more are wider", found.passed), price};
  if (found.file.bottleneck && found.file.cuts.size() == most)
    return {"search", chosen, fmt::format("{} cuts were asked for", most), price};
  return {"search", chosen, "the potential falls nowhere else", price};
}

}  // namespace

Decisions decisions_of(const FoundCuts& found, size_t most, const CutLimits& limits,
                       const Phases& phases) {
  Decisions all;
  for (size_t c = 0; found.file.bottleneck && c < found.facts.size(); ++c)
    all.push_back({fmt::format("cut {}", c + 1), "kept",
                   "light has to pass it: " + figures(found.facts[c], limits), ""});
  for (const SeriesCut::Refused& r : found.refused)
    all.push_back({fmt::format("a cut with {:.2g} % of the surface on the light's side",
                               100 * r.facts.area[0]),
                   "refused", r.why + ": " + figures(r.facts, limits), ""});
  if (found.closets > 0)
    all.push_back({"closets", fmt::format("{} passed by", found.closets),
                   "no light passes their doors on its way to the camera", "not cut"});
  all.push_back(of_search(
      found, most,
      fmt::format("{} maximum flows, verified: {}", found.flows, cli::price_of(phases, {"flow"}))));
  if (!found.file.bottleneck)
    all.push_back({"bottleneck", "none", found.file.reason, "the next stages have nothing to do"});
  return all;
}

}  // namespace tdpt
