#include "tools/ffgraph/explain.h"

#include <fmt/format.h>

#include "libcommon/base/number_words.h"
#include "libcommon/scene/uses.h"

namespace tdpt {
namespace {

using cli::Decision;
using cli::Decisions;
using cli::plural;

// All surfaces are treated as diffuse: only transmission and lamps matter.
Decisions of_scene(const Scene& scene) {
  return uses_of(scene, {"transmission", "alpha", "punctual lights", "a sky"});
}

// `after`: conductance of the narrowest opening after the round.
std::string gain(const RoundReport& round, double after) {
  return fmt::format("the narrowest of {} let {} of the smaller side's light pass, now {}",
                     plural(round.openings, "opening"), number_words(round.conductance, 2),
                     number_words(after, 2));
}

// A round is worthwhile if the conductance falls below this factor: leaks of a twentieth move no
// border.
constexpr double kPays = 0.95;

Decision of_round(size_t i, const RoundReport& round, double after) {
  const std::string what = fmt::format("round {}", i + 1), price = cli::price_of(round.cpu_seconds);
  if (round.conductance >= 1)
    return {what,
            fmt::format("{} split",
                        round.split == 1 ? "1 patch" : fmt::format("{} patches", round.split)),
            "no opening was found in the network before", price};
  if (round.split == 0) return {what, "not needed", "no patch straddles an opening", price};
  return {what,
          fmt::format("{} split, {}", round.split,
                      after < kPays * round.conductance ? "which paid" : "which changed little"),
          gain(round, after), price};
}

}  // namespace

Decisions decisions_of(const Scene& scene, const LightFlow& flow, const GraphReport& report) {
  Decisions all = of_scene(scene);
  all.push_back({"walks",
                 fmt::format("{} from the light, {} from {} camera", report.light_walks,
                             report.camera_walks, report.camera_hits.size() > 1 ? "each" : "the"),
                 fmt::format("they hit {} and {} surfaces, and both reached {} of {} patches",
                             report.light_hits, report.hits_of_cameras(), report.reached_by_both,
                             flow.patches.size()),
                 cli::price_of(report.phases, {"walks"})});
  for (size_t i = 0; i < report.by_round.size(); ++i) {
    const bool last = i + 1 == report.by_round.size();
    all.push_back(of_round(i, report.by_round[i],
                           last ? narrowest_opening(flow) : report.by_round[i + 1].conductance));
  }
  all.push_back(
      {"splitting", fmt::format("stopped after {}", plural(report.rounds, "round")),
       report.why_stopped,
       fmt::format("{} rays, {} in all", report.rays, cli::price_of(report.phases, {"patches"}))});
  return all;
}

Decisions decisions_of(const Scene& scene, const TriangleSettings& settings,
                       const TriangleReport& report) {
  Decisions all = of_scene(scene);
  const auto largest = [&](const char* what, size_t found, size_t kept) {
    return Decision{what, fmt::format("{} of {} kept", kept, found),
                    found > kept
                        ? fmt::format("those with most hits, {} at most", settings.largest_set)
                        : fmt::format("there are no more than {}", settings.largest_set),
                    cli::price_of(report.phases, {"walks"})};
  };
  all.push_back(largest("triangles that are lit", report.lit, report.kept_lit));
  all.push_back(largest("triangles that are seen", report.seen, report.kept_seen));
  all.push_back({"light and camera", report.shared > 0 ? "joined directly" : "not joined directly",
                 fmt::format("{} are both lit and seen", plural(report.shared, "triangle")),
                 cli::price_of(report.phases, {"patches"})});
  return all;
}

}  // namespace tdpt
