#include "tools/mincut/explain.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/number_words.h"

namespace tdpt {
namespace {

using cli::Decision;
using cli::Decisions;
using cli::plural;

// The two figures by which every cut is judged.
std::string figures(const CutFacts& f, const CutLimits& limits) {
  return fmt::format("conductance {}, at most {}; smaller side {}, at least {}",
                     number_words(f.conductance, 2), number_words(limits.largest_conductance, 2),
                     percent_words(f.smaller_side()), percent_words(limits.least_area));
}

Decision of_search(const FoundCuts::OfCamera& found, const std::string& price) {
  return {"search", fmt::format("ended after {} of the potential", plural(found.drops, "drop")),
          found.passed > 0
              ? fmt::format("{} more {} wider", found.passed, found.passed == 1 ? "is" : "are")
              : "the potential falls nowhere else",
          price};
}

size_t pairs_of(const CutFile& cut, size_t c) {
  return static_cast<size_t>(std::count_if(cut.arcs.begin(), cut.arcs.end(),
                                           [&](const CutArc& a) { return cut.crosses(a, c); }));
}

// Refused cuts that are bottlenecks all the same.
size_t one_too_many(const FoundCuts::OfCamera& found, const CutLimits& limits) {
  size_t n = 0;
  for (const SeriesCut::Refused& r : found.refused) n += why_refused(r.facts, limits).empty();
  return n;
}

// Of one camera: what was refused and where the search ended. `name`: empty for the only one.
void add_camera(const FoundCuts::OfCamera& found, const std::string& name, size_t most,
                const CutLimits& limits, const std::string& price, Decisions& all) {
  const std::string before = name.empty() ? "" : name + ": ";
  for (const SeriesCut::Refused& r : found.refused)
    all.push_back({fmt::format("{}a cut with {} of the surface on the light's side", before,
                               percent_words(r.facts.area[0])),
                   "refused", r.why + ": " + figures(r.facts, limits), ""});
  if (found.closets > 0)
    all.push_back({before + "closets", fmt::format("{} passed by", found.closets),
                   "no light passes their doors on its way to the camera", "not cut"});
  all.push_back(of_search(found, price));
  all.back().what = before + all.back().what;
  if (const size_t more = one_too_many(found, limits); more > 0)
    all.push_back({before + plural(more, "bottleneck"), "left out",
                   fmt::format("--cuts is {}, and others promise more", most), ""});
}

}  // namespace

Decisions decisions_of(const FoundCuts& found, size_t most, const CutLimits& limits,
                       const Phases& phases) {
  Decisions all;
  for (size_t c = 0; found.file.bottleneck && c < found.facts.size(); ++c)
    all.push_back({fmt::format("cut {}", c + 1), "kept",
                   fmt::format("light has to pass it: {}; {}", figures(found.facts[c], limits),
                               words_for(found.facts[c])),
                   cli::plural(pairs_of(found.file, c), "pivot pair")});
  const std::string flows = fmt::format("{}, verified", plural(found.flows, "maximum flow"));
  for (size_t k = 0; k < found.cameras.size(); ++k) {
    const bool last = k + 1 == found.cameras.size();
    add_camera(found.cameras[k], found.file.name_if_several(k), most, limits,
               last ? flows + ": " + cli::price_of(phases, {"flow"}) : "", all);
  }
  if (found.left_out > 0)
    all.push_back(
        {plural(found.left_out, "cut"), "left out",
         fmt::format("a file has {} at most, and others of the camera promise more", kMostCuts),
         ""});
  if (!found.file.bottleneck)
    all.push_back({"bottleneck", "none", found.file.reason, "the next stages have nothing to do"});
  return all;
}

}  // namespace tdpt
