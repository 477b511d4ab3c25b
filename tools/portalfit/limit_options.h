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
    {"least-part", &FitLimits::least_part, 0, 1},
    {"support", &FitLimits::support, 0, 1},
    {"one-opening", &FitLimits::one_opening, 0, 1},
    {"sure", &FitLimits::sure, 0, 1},
    {"fewest", &FitLimits::fewest, 8, 1e6},
    {"most-tried", &FitLimits::most_tried, 1, 1000},
    {"least-edge", &FitLimits::least_edge, 0, 1},
    {"beyond", &FitLimits::beyond, 0, 10},
    {"coarse", &FitLimits::coarse, 0, 1000},
    {"open-space", &FitLimits::open_space, 0, 1},
    {"widening", &FitLimits::widening, 0.5, 100},
    {"dense-cell", &FitLimits::dense_cell, 0, 1},
    {"points-per-cell", &FitLimits::points_per_cell, 1, 1000},
    {"grazing", &FitLimits::grazing, 0, 1},
    {"wider", &FitLimits::wider, 0.5, 100},
    {"deeper", &FitLimits::deeper, 0, 10},
    {"missing", &FitLimits::missing, 0, 100},
    {"missing-of-few", &FitLimits::missing_of_few, 0, 100},
    {"missing-of-known", &FitLimits::missing_of_known, 0, 100},
    {"many", &FitLimits::many, 0, 1e9},
    {"outside", &FitLimits::outside, 0, 1},
    {"hardly-any", &FitLimits::hardly_any, 0, 1},
    {"least-cosine", &FitLimits::least_cosine, 0, 1},
    {"turn", &FitLimits::turn, 1e-4, 1},
    {"rough-lines", &FitLimits::rough_lines, 100, 1e6},
    {"fine-lines", &FitLimits::fine_lines, 100, 1e6},
    {"first-step", &FitLimits::first_step, 1e-4, 1},
    {"fine-step", &FitLimits::fine_step, 1e-4, 1},
    {"rough-last", &FitLimits::rough_last, 1e-4, 1},
    {"fine-last", &FitLimits::fine_last, 1e-4, 1},
    {"prism", &FitLimits::prism, 0.5, 100},
    {"dense-tube", &FitLimits::dense_tube, 0, 1},
    {"plane-holds", &FitLimits::plane_holds, 0, 1},
    {"blind-end", &FitLimits::blind_end, 0, 1},
    {"clearly", &FitLimits::clearly, 0, 1},
    {"near-wall", &FitLimits::near_wall, 0, 1},
    {"square", &FitLimits::square, 0, 10},
    {"most-corners", &FitLimits::most_corners, 4, 64},
    {"corner", &FitLimits::corner, 0, 1},
    {"whole-corner", &FitLimits::whole_corner, 0, 1},
    {"within", &FitLimits::within, 0, 1},
    {"clear", &FitLimits::clear, 0, 10},
    {"least-clear", &FitLimits::least_clear, 0, 1},
    {"most-trimmed", &FitLimits::most_trimmed, 0, 1},
    {"sparse", &FitLimits::sparse, 1, 1000},
    {"worth-trimming", &FitLimits::worth_trimming, 0, 1},
    {"denser", &FitLimits::denser, 0.5, 100},
    {"promised", &FitLimits::promised, 0, 1},
    {"least-of-whole", &FitLimits::least_of_whole, 0, 1},
    {"most-fitted", &FitLimits::most_fitted, 1, 1000},
    {"slant", &FitLimits::slant, 0, 1},
    {"most-clipped", &FitLimits::most_clipped, 0, 1},
    {"reach-of-lines", &FitLimits::reach_of_lines, 0.5, 100},
    {"shared", &FitLimits::shared, 0, 1},
    {"next-growth", &FitLimits::next_growth, 0.5, 100},
    {"mostly-open", &FitLimits::mostly_open, 0, 1},
    {"open-enough", &FitLimits::open_enough, 0, 1},
    {"thin-bar", &FitLimits::thin_bar, 0, 100},
    {"mullion", &FitLimits::mullion, 0, 1},
    {"flat", &FitLimits::flat, 0, 1},
    {"turned", &FitLimits::turned, 0, 1},
};

inline void declare_limits(cli::Options& options, FitLimits& limits) {
  for (const FitLimit& limit : kFitLimits)
    options.limit(limit.name, limits.*limit.value, limit.lowest, limit.highest);
}

}  // namespace tdpt
