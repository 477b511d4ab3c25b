#include "tools/tdpt-render/plan/truncation.h"

#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/number_words.h"

namespace tdpt {

Truncation LightByDepth::beyond() const {
  Truncation result{depth_, 0, 0};
  double all = 0, beyond = 0, squares = 0;
  for (const Group& g : groups_) {
    all += g.within + g.beyond;
    beyond += g.beyond;
  }
  if (!(all > 0)) return result;
  result.share = beyond / all;
  for (const Group& g : groups_) {
    const double off = g.beyond - result.share * (g.within + g.beyond);
    squares += off * off;
  }
  result.error = std::sqrt(squares) / all;
  return result;
}

std::string sentence(const Truncation& beyond) {
  const double most = beyond.share + 2 * beyond.error;
  const std::string depth = fmt::format("--max-depth {} leaves out ", beyond.depth);
  if (beyond.share > 0.995) return depth + "all of the light, or nearly";
  if (most < 0.001) return depth + "less than 0.1 % of the light";
  if (beyond.error > 0.25 * beyond.share)
    return depth + fmt::format("at most about {} of the light", percent_words(most));
  return depth + fmt::format("about {} of the light", percent_words(beyond.share));
}

}  // namespace tdpt
