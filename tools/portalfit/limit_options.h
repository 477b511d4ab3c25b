// The limits of portalfit as settings.
#pragma once
#include "libcommon/cli/cli.h"
#include "tools/portalfit/limits.h"

namespace tdpt {

/// A member of FitLimits: its name as a setting, and its range.
struct FitLimit {
  const char* name;
  double FitLimits::*value;
  double lowest, highest;
};
inline constexpr FitLimit kFitLimits[]{
    {"fewest", &FitLimits::fewest, 8, 1e6},
    {"least-edge", &FitLimits::least_edge, 0, 1},
    {"resolved", &FitLimits::resolved, 0, 1000},
    {"widening", &FitLimits::widening, 0.5, 100},
    {"dense-cell", &FitLimits::dense_cell, 0, 1},
    {"points-per-cell", &FitLimits::points_per_cell, 1, 1000},
    {"grazing", &FitLimits::grazing, 0, 1},
    {"missing", &FitLimits::missing, 0, 100},
    {"missing-of-few", &FitLimits::missing_of_few, 0, 100},
    {"missing-of-known", &FitLimits::missing_of_known, 0, 100},
    {"many", &FitLimits::many, 0, 1e9},
    {"outside", &FitLimits::outside, 0, 1},
    {"hardly-any", &FitLimits::hardly_any, 0, 1},
    {"turn", &FitLimits::turn, 1e-4, 1},
    {"rough-lines", &FitLimits::rough_lines, 100, 1e6},
    {"fine-lines", &FitLimits::fine_lines, 100, 1e6},
    {"first-step", &FitLimits::first_step, 1e-4, 1},
    {"fine-step", &FitLimits::fine_step, 1e-4, 1},
    {"rough-last", &FitLimits::rough_last, 1e-4, 1},
    {"fine-last", &FitLimits::fine_last, 1e-4, 1},
    {"alike", &FitLimits::alike, 0.5, 100},
    {"plane-holds", &FitLimits::plane_holds, 0, 1},
    {"blind-end", &FitLimits::blind_end, 0, 1},
    {"parallel", &FitLimits::parallel, 0, 1},
    {"square", &FitLimits::square, 0, 10},
    {"slight", &FitLimits::slight, 0, 1},
    {"within", &FitLimits::within, 0, 1},
    {"most-trimmed", &FitLimits::most_trimmed, 0, 1},
    {"sparse", &FitLimits::sparse, 1, 1000},
    {"beside", &FitLimits::beside, 0, 10},
    {"denser", &FitLimits::denser, 0.5, 100},
    {"mostly", &FitLimits::mostly, 0, 1},
};

inline void declare_limits(cli::Options& options, FitLimits& limits) {
  for (const FitLimit& limit : kFitLimits)
    options.limit(limit.name, limits.*limit.value, limit.lowest, limit.highest);
}

}  // namespace tdpt
