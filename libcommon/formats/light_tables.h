// Light grids as tables (.csv), for stages of one's own in any language: lines, probes, air, count.
// Written by tdpt-info --dump; read by portalfit, and lines by lightgrid. Grammar: man 5
// light-grid.
#pragma once
#include <string>
#include <vector>

#include "libcommon/cli/cli.h"
#include "libcommon/formats/light_grid.h"

namespace tdpt {

/// "lines", "probes", "air", "count".
std::vector<std::string> light_table_names();
/// One of them as text, with what the others need to know of the grid. Numbers are the shortest
/// that read back as the same.
std::string light_table_text(const LightGrid& grid, const std::string& table);

struct TableText {
  std::string name;  ///< for messages
  std::string text;
};
/// The grid of a set of tables, each kind at most once. What they leave out is made from the lines:
/// the box, 128 voxels along its longest side, and the counts; all voxels are air. Throws
/// InputError.
LightGrid parse_light_tables(const std::vector<TableText>& texts);

/// The grid of one .vdb, or of tables with that of the lines among them. "-": standard input. What
/// was read is added to `files`. Throws InputError.
LightGrid read_light(const std::vector<std::string>& paths, std::vector<cli::Common::Input>& files);

/// What the lines of a table must keep to.
struct LineLimits {
  static constexpr double kFarthest = 1e30;                ///< well within single precision
  Vec3d low = Vec3d(-kFarthest), high = Vec3d(kFarthest);  ///< of both ends [metres]
  size_t cuts = kMostCuts;
};
/// A table of lines, one at least, for another grid: of the one returned, only lines, scene_hash,
/// provenance and hash count. Throws InputError.
LightGrid read_light_lines(const std::string& path, const LineLimits& limits);

}  // namespace tdpt
