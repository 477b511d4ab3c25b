#include "libcommon/formats/portal_worth.h"

#include <optional>

#include <fmt/format.h>

namespace tdpt {
namespace {

std::optional<double> figure(const std::map<std::string, double>& figures, const char* key) {
  const auto at = figures.find(key);
  if (at == figures.end()) return {};
  return at->second;
}

}  // namespace

std::string drawback_of(const std::map<std::string, double>& figures) {
  const auto share = figure(figures, "flux_share"), tightness = figure(figures, "tightness"),
             conductance = figure(figures, "conductance");
  if (share && *share < kNextToNothing)
    return fmt::format("it carries {:.2g} % of the light", 100 * *share);
  if (tightness && *tightness < kNextToNothing)
    return fmt::format("{:.2g} % of the lines through it pass from one side to the other",
                       100 * *tightness);
  if (conductance && *conductance > kWide)
    return fmt::format("a wide way, {:.2g} % of the smaller side's light finds it alone",
                       100 * *conductance);
  return "";
}

std::string worth_sentence(const std::map<std::string, double>& figures, double area) {
  std::string text = fmt::format("{:.4g} m2", figure(figures, "area").value_or(area));
  if (const auto share = figure(figures, "flux_share"))
    text += fmt::format(", {:.1f} % of the light", 100 * *share);
  if (const auto tightness = figure(figures, "tightness"))
    text += fmt::format(", tightness {:.2f}", *tightness);
  if (const auto conductance = figure(figures, "conductance"))
    text += fmt::format(", conductance {:.2g}", *conductance);
  const std::string drawback = drawback_of(figures);
  return drawback.empty() ? text : text + ": " + drawback;
}

}  // namespace tdpt
