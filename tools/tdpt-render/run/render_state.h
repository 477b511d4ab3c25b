// Where a rendering stands: its film, and what is to be known to go on from there. A checkpoint
// keeps it, so that a night's work outlives its process.
#pragma once
#include <algorithm>
#include <optional>
#include <string>

#include "libcommon/film/film_file.h"
#include "tools/tdpt-render/path/sample/tally.h"
#include "tools/tdpt-render/plan/sample_count.h"

namespace tdpt {

struct RenderState {
  RenderState(Film empty, const Limits& limits_)
      : film(std::move(empty)), tally(film.unit()), limits(limits_), goal(limits_.spp) {}

  Film film;
  Tally tally;
  Limits limits;
  uint64_t first = 0;  ///< sample of each pixel that the film begins with
  uint64_t goal = 0;   ///< samples of each pixel that it is to hold; 0: as many as the time allows
  uint64_t added = 0;  ///< of those, what was added last: then `limits` hold no more
  uint64_t whole = 0;  ///< of the whole picture, of which this is a part; 0: `goal`
  double seconds = 0, cpu_seconds = 0;  ///< of rendering until now
  double began = 0;                     ///< of those, before the first sample of the picture [s]
  std::optional<TargetOutcome> target;
  ErrorPilot pilot;
  PictureBlocks blocks;

  uint64_t next() const { return first + film.samples(); }  ///< sample that comes next
  /// Of the whole picture, as far as is known.
  uint64_t spp() const { return std::max(whole > 0 ? whole : goal, next()); }
};

/// Sums of the tally that add up over parts of a picture, and back.
Counts counts_of(const Tally& tally);
/// Those that this program does not know, or that there are too many of, are left out.
void add_counts(const Counts& counts, Tally& tally);

/// All but film, tally and blocks, as JSON.
std::string render_state_text(const RenderState& render_state);
/// The blocks as a film file keeps them, and all the rest as the rendering had it. `name`: names
/// the file in messages. Throws InputError.
FilmBlocks blocks_of(const RenderState& render_state);
RenderState render_state_of(FilmFile file, const std::string& name);

}  // namespace tdpt
