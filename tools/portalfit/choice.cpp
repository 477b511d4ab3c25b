#include "tools/portalfit/choice.h"

#include <map>

#include <fmt/format.h>

#include "libcommon/base/number_words.h"

namespace tdpt {
namespace {

double figure(const Portal& portal, const char* key, double otherwise) {
  const auto at = portal.figures.find(key);
  return at == portal.figures.end() ? otherwise : at->second;
}

}  // namespace

std::vector<std::string> why_useless(const std::vector<Portal>& portals) {
  std::map<double, double> together;  // by cut
  for (const Portal& p : portals) together[figure(p, "cut", 0)] += figure(p, "flux_share", 1);
  std::vector<std::string> why;
  for (const Portal& p : portals) {
    const double share = together[figure(p, "cut", 0)], conductance = figure(p, "conductance", 0);
    if (share < kLeastTogether)
      why.push_back(
          fmt::format("the portals of its cut carry {} of the light", percent_words(share)));
    else if (conductance > kOpenSpace)
      why.push_back(
          fmt::format("a way as wide as a room, {} of the smaller side's light "
                      "finds it alone",
                      percent_words(conductance)));
    else
      why.emplace_back();
  }
  return why;
}

}  // namespace tdpt
