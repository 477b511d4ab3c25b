// Where a rendering stands: its film, and what is to be known to go on from there. A checkpoint
// keeps it, so that a night's work outlives its process.
#pragma once
#include <algorithm>
#include <optional>
#include <string>

#include "libcommon/film/film_file.h"
#include "tools/tdpt-render/path/sample/tally.h"
#include "tools/tdpt-render/plan/pilot.h"

namespace tdpt {

/// How a picture that was to have a relMSE of at most `error` came out.
struct TargetOutcome {
  /// `fixed`: all samples are there that were fixed; `unlit`: none were, the pilot met no light.
  enum class Stop { fixed, spp, time, signal, unlit };

  double error = 0;
  uint64_t pilot_samples = 0;  ///< of each pixel, thrown away
  double pilot_cpu_seconds = 0;
  uint64_t fixed = 0;  ///< samples of each pixel, by the pilot; 0: it did not come to that
  bool retried = false;
  bool may_retry = false;  ///< --set retry was not asked for
  Stop stop = Stop::fixed;
  bool dark = false;             ///< nothing in the scene emits light: there is no error
  std::optional<double> relmse;  ///< of the picture, estimated; from no light nothing is told
  double low = 0, high = 0;      ///< its interval, about 95 %
  bool reached() const { return dark || (relmse && *relmse <= error); }
};

/// What ends a rendering, as it was asked for; 0: no such limit.
struct Limits {
  uint64_t spp = 0;         ///< samples per pixel; 0: as many as `seconds` or the target take
  double seconds = 0;       ///< wall-clock limit of rendering alone
  double target_error = 0;  ///< relMSE to render to, within the limits of spp and seconds
  bool retry = false;       ///< where it is missed, goes on once
  friend bool operator==(const Limits&, const Limits&) = default;
};

struct Standing {
  Standing(Film empty, const Limits& limits_)
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
  Pilot pilot;
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
std::string standing_text(const Standing& standing);
/// The blocks as a film file keeps them, and all the rest as the rendering had it. `name`: names
/// the file in messages. Throws InputError.
FilmBlocks blocks_of(const Standing& standing);
Standing standing_of(FilmFile file, const std::string& name);

}  // namespace tdpt
