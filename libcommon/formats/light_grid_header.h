// The '#' lines that describe a light grid: at the head of each of its tables, and as metadata of
// its .vdb. Grammar: man 5 light-grid.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "libcommon/formats/light_grid.h"
#include "libcommon/formats/text_lines.h"

namespace tdpt {

/// What the headers of all tables of one grid say; they must not contradict each other.
struct LightGridHeader {
  LightGrid grid{};  ///< without what it has for each voxel, lines and probes
  bool has_box = false, has_scene = false, has_answer = false, has_flux_share = false;
};

std::string header_of(const LightGrid& grid);

struct HeaderEnd {
  bool more;                     ///< `in` is at the first line that is none of a header
  std::optional<uint64_t> rows;  ///< of the table, if its header says so
};
/// Reads the '#' lines that come next; adds what they say to `all`. Throws InputError.
HeaderEnd read_header(TextLines& in, LightGridHeader& all);

}  // namespace tdpt
