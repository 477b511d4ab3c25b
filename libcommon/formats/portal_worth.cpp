#include "libcommon/formats/portal_worth.h"

#include <optional>

#include <fmt/format.h>

#include "libcommon/base/number_words.h"

namespace tdpt {
namespace {

std::optional<double> figure(const std::map<std::string, double>& figures, const char* key) {
  const auto at = figures.find(key);
  if (at == figures.end()) return {};
  return at->second;
}

}  // namespace

std::string drawback_of(const std::map<std::string, double>& figures) {
  const auto tightness = figure(figures, "tightness"), conductance = figure(figures, "conductance");
  if (tightness && *tightness < kNextToNothing)
    return fmt::format("{} of the lines through it pass from one side to the other",
                       percent_words(*tightness));
  if (conductance && *conductance > kWide)
    return fmt::format("a wide way, {} of the smaller side's light finds it alone",
                       percent_words(*conductance));
  return "";
}

std::string worth_sentence(const std::map<std::string, double>& figures, double area) {
  std::string text = fmt::format("{} m2", number_words(figure(figures, "area").value_or(area), 4));
  if (const auto tightness = figure(figures, "tightness"))
    text += fmt::format(", tightness {:.2f}", *tightness);
  if (const auto conductance = figure(figures, "conductance"))
    text += fmt::format(", conductance {}", number_words(*conductance, 2));
  const std::string drawback = drawback_of(figures);
  return drawback.empty() ? text : text + ": " + drawback;
}

}  // namespace tdpt
