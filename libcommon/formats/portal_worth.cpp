// The gain that a portal lets expect, the words for it, and the sentence that tells it; symbols and
// equation stand in the header.
#include "libcommon/formats/portal_worth.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace tdpt {
namespace {

// From doc/portal-worth.md.
constexpr double kTimeRatio = 0.7;         // g_0
constexpr double kTypicalOpening = 0.026;  // c_0
constexpr double kExponent = 0.6;          // p

std::optional<double> figure(const std::map<std::string, double>& figures, const char* key) {
  const auto at = figures.find(key);
  if (at == figures.end()) return {};
  return at->second;
}

}  // namespace

double expected_gain(double share, double tightness, double conductance) {
  const double s = std::clamp(share / (1 - kStrays), 0.0, 1.0), t = std::clamp(tightness, 0.0, 1.0);
  const double c = std::clamp(conductance, 1e-9, 1.0);
  return kTimeRatio / (1 - s + s / (1 + std::pow(kTypicalOpening * t / c, kExponent)));
}

Verdict verdict_of(const std::map<std::string, double>& figures) {
  const auto gain = figure(figures, "expected_gain");
  const auto share = figure(figures, "flux_share"), tightness = figure(figures, "tightness"),
             conductance = figure(figures, "conductance");
  if (!gain) return {Worth::unknown, "worth unknown"};
  if (*gain >= kLittleGain) return {Worth::useful, "useful"};
  if (*gain >= kNoGain) return {Worth::little, "little gain"};
  if (share && *share < kNextToNothing)
    return {Worth::useless, fmt::format("useless: it carries {:.2g} % of the light", 100 * *share)};
  if (tightness && *tightness < kFewLines)
    return {Worth::useless, fmt::format("useless: {:.2g} % of the lines through it pass from one "
                                        "side to the other",
                                        100 * *tightness)};
  if (conductance)
    return {Worth::useless,
            fmt::format("useless: a wide way, {:.2g} % of the smaller side's light finds it alone",
                        100 * *conductance)};
  return {Worth::useless, "useless: it costs more than it gains"};
}

std::string worth_sentence(const std::map<std::string, double>& figures, double area) {
  std::string text = fmt::format("{:.4g} m2", figure(figures, "area").value_or(area));
  if (const auto share = figure(figures, "flux_share"))
    text += fmt::format(", {:.1f} % of the light", 100 * *share);
  if (const auto tightness = figure(figures, "tightness"))
    text += fmt::format(", tightness {:.2f}", *tightness);
  if (const auto gain = figure(figures, "expected_gain"))
    text += fmt::format(", expected gain {:.2g}", *gain);
  return text + ": " + verdict_of(figures).words;
}

}  // namespace tdpt
