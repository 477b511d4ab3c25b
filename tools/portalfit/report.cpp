#include "tools/portalfit/report.h"

#include <fmt/format.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/number_words.h"
#include "libcommon/formats/portal_worth.h"

namespace tdpt {
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
