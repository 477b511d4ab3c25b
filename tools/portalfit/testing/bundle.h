// Test only: all lines of a grid as one bundle.
#pragma once
#include <numeric>

#include "tools/portalfit/lines.h"

namespace tdpt::testing {

inline Bundle all_of(const LightGrid& grid) {
  Bundle all{&grid.lines, std::vector<uint32_t>(grid.lines.size())};
  std::iota(all.which.begin(), all.which.end(), 0u);
  return all;
}

}  // namespace tdpt::testing
