#include "libcommon/cli/decision.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/number_words.h"
#include "libcommon/base/phases.h"

namespace tdpt::cli {

std::string sentence(const Decision& d) {
  return fmt::format("{}: {}{}{}", d.what, d.chosen,
                     d.reason.empty() ? "" : ", because " + d.reason,
                     d.price.empty() ? "" : " (" + d.price + ")");
}

std::string plural(size_t n, const char* noun) {
  return fmt::format("{} {}{}", n, noun, n == 1 ? "" : "s");
}

std::string price_of(double cpu_seconds) {
  if (cpu_seconds >= 10) return fmt::format("{:.0f} CPU s", cpu_seconds);
  return fmt::format("{} CPU s", number_words(cpu_seconds < 1e-4 ? 0.0 : cpu_seconds, 2));
}

std::string price_of(const Phases& phases, const std::vector<std::string>& names) {
  double sum = 0;
  for (const Phases::Phase& p : phases.all())
    if (std::find(names.begin(), names.end(), p.name) != names.end()) sum += p.cpu_seconds;
  return price_of(sum);
}

}  // namespace tdpt::cli
