#include "tools/portalfit/report.h"

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/portalfit/plane.h"

namespace tdpt {
namespace {

using cli::Decision;
using cli::Decisions;

std::string percent(double share) {
  return percent_words(share, 3);
}

// Why it was accepted as a portal.
std::string merits(const Portal& portal, const PortalFitOptions& options) {
  const auto& f = portal.figures;
  if (options.by_paper)
    return "its normal is the main axis of the full voxels, and its plane holds the fullest";
  const std::string support =
      f.contains("support")
          ? fmt::format("; {} of the lines through it join the two sides, at least {}",
                        percent(f.at("support")), percent(kMost))
          : "";
  return fmt::format(
      "by the network {} of the light crosses it, at least {}{}; {}; {:.0f} degrees "
      "between its normal and the mean direction of the light",
      percent(f.at("flux_share")), percent(options.threshold), support,
      worth_sentence(f, f.at("area")), f.at("direction_angle"));
}

Decision of_search(const LightGrid& grid, const FitResult& found, const Phases& phases) {
  const std::string chosen = fmt::format(
      "{} looked at, {} fitted", counted(found.candidates, "candidate"), found.portals.size());
  const std::string price = cli::price_of(phases, {"fit"});
  return {"search", chosen,
          fmt::format("{} of {} lines cross what was found", percent(found.explained),
                      grid.lines.size()),
          price};
}

}  // namespace

Decisions decisions_of(const LightGrid& grid, const PortalFitOptions& options,
                       const FitResult& found, const Phases& phases) {
  if (!grid.bottleneck || grid.lines.empty())
    return {{"search", "left out",
             grid.bottleneck ? "the grid holds no line of light" : grid.reason,
             cli::price_of(phases, {"fit"})}};
  Decisions all{of_search(grid, found, phases)};
  size_t written = 0;
  for (const Portal& portal : found.portals)
    all.push_back({fmt::format("portal.{}", written++), "written", merits(portal, options),
                   number_words(portal.figures.at("area")) + " m2"});
  for (const FitResult::Refusal& r : found.refused)
    all.push_back(
        {"candidate", "refused", r.why + (r.limit.empty() ? "" : "; asked for: " + r.limit), ""});
  if (found.repeated > 0)
    all.push_back({"openings", fmt::format("{} passed by", found.repeated),
                   "they are those of another cut again, or more than --max-portals", ""});
  return all;
}

namespace {

constexpr size_t kMostNamed = 4;

}  // namespace

std::string portals_sentence(const std::vector<Portal>& portals) {
  std::vector<std::string> named;
  const size_t n = portals.size();
  for (size_t i = 0; i < n && (n <= kMostNamed || i + 1 < kMostNamed); ++i) {
    const auto& f = portals[i].figures;
    std::string text = fmt::format("portal.{} {} m2", i, number_words(f.at("area"), 2));
    if (const std::string drawback = drawback_of(f); !drawback.empty())
      text += " (" + drawback + ")";
    named.push_back(text);
  }
  if (named.size() < n) named.push_back(fmt::format("and {} more", n - named.size()));
  return fmt::format("{}: {}", counted(n, "portal"), fmt::join(named, ", "));
}

}  // namespace tdpt
