// Light grids as tables (.csv), for users' own stages in any language: lines, probes, air, count.
// Written by tdpt-info --dump; read by portalfit, and lines also by lightgrid. Grammar: man 5
// light-grid.
#pragma once
#include <string>
#include <vector>

#include "libcommon/cli/cli.h"
#include "libcommon/formats/light_grid.h"

namespace tdpt {

/// "lines", "probes", "air", "count".
std::vector<std::string> light_table_names();
/// One table as text, including the header that describes the grid. Numbers are the shortest that
/// round-trip.
std::string light_table_text(const LightGrid& grid, const std::string& table);

struct TableText {
  std::string name;  ///< for messages
  std::string text;
};
/// The grid of a set of tables, each kind at most once. What is missing is derived from the lines:
/// the box, 128 voxels along its longest side, and the counts; all voxels are air. Throws
/// InputError.
LightGrid parse_light_tables(const std::vector<TableText>& texts);

/// The grid of one .vdb, or of several tables of which one has the lines. "-": standard input.
/// Appends what was read to `files`. Throws InputError.
LightGrid read_light(const std::vector<std::string>& paths, std::vector<cli::Common::Input>& files);

/// Bounds on the lines of a table.
struct LineLimits {
  static constexpr double kFarthest = 1e30;                ///< well within single precision
  Vec3d low = Vec3d(-kFarthest), high = Vec3d(kFarthest);  ///< of both ends [metres]
  size_t cuts = kMostCuts;
};
/// Reads a table with at least one line, for use with another grid: in the result only lines,
/// scene_hash, provenance and hash are set. Throws InputError.
LightGrid read_light_lines(const std::string& path, const LineLimits& limits);

}  // namespace tdpt
