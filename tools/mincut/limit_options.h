// The limits of mincut as settings.
#pragma once
#include "libcommon/cli/cli.h"
#include "libcommon/math/cut_facts.h"

namespace tdpt {

/// A member of CutLimits: its name as a setting, and its range.
struct CutLimit {
  const char* name;
  double CutLimits::*value;
  double lowest, highest;
};
inline constexpr CutLimit kCutLimits[]{
    {"least-area", &CutLimits::least_area, 0, 1},
    {"least-carried", &CutLimits::least_carried, 0, 1},
    {"straight", &CutLimits::straight, 0, 1},
    {"seen", &CutLimits::seen, 0, 1},
    {"hold", &CutLimits::hold, 0, 1},
    {"least-drop", &CutLimits::least_drop, 0, 1},
    {"loose", &CutLimits::loose, 0, 1e9},
    {"most-drops", &CutLimits::most_drops, 0, 1e9},
};

inline void declare_limits(cli::Options& options, CutLimits& limits) {
  for (const CutLimit& limit : kCutLimits)
    options.limit(limit.name, limits.*limit.value, limit.lowest, limit.highest);
}

}  // namespace tdpt
