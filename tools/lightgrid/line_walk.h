// The fine pass of the light grid: a reversible Markov chain over the lines that connect the two
// sides of a cut.
#pragma once
#include "libcommon/formats/light_grid.h"
#include "tools/lightgrid/line_tracer.h"

namespace tdpt {

struct LineWalk {
  std::vector<LightLine> lines;    ///< distributed by etendue, as far as the votes accept them
  std::vector<Probe> probes;       ///< the last line that each chain tried in a random direction
  uint64_t tried = 0, joined = 0;  ///< number of such lines, and how many connect the two sides
};

/// Lines of cut `c` and their probes. `count`: from the coarse pass, per voxel of `grid`; `kept`:
/// its lines, at least one. Returns at most `most` lines, labelled with the cut.
LineWalk walk_among_lines(const Scene& scene, LineTracer& tracer, size_t c, const LightGrid& grid,
                          const std::vector<uint32_t>& count, const std::vector<LightLine>& kept,
                          size_t most, uint64_t seed);

}  // namespace tdpt
