#include "tools/portalfit/choice.h"

#include <fmt/format.h>

#include "libcommon/base/number_words.h"

namespace tdpt {
namespace {

double figure(const Portal& portal, const char* key, double otherwise) {
  const auto at = portal.figures.find(key);
  return at == portal.figures.end() ? otherwise : at->second;
}

}  // namespace

std::vector<std::string> why_useless(const std::vector<Portal>& portals, const FitLimits& limits) {
  std::vector<std::string> why;
  for (const Portal& p : portals) {
    const double conductance = figure(p, "conductance", 0);
    why.push_back(conductance > limits.open_space
                      ? fmt::format("a way as wide as a room, {} of the smaller side's light "
                                    "finds it alone",
                                    percent_words(conductance))
                      : "");
  }
  return why;
}

}  // namespace tdpt
