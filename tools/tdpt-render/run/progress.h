// What has been rendered of a picture: its film, and what its numbers hang on. A checkpoint stores
// it with the plan, so that a night's work survives its process.
#pragma once
#include <algorithm>
#include <optional>
#include <string>

#include "libcommon/film/film_file.h"
#include "tools/tdpt-render/path/sample/tally.h"
#include "tools/tdpt-render/plan/noise.h"
#include "tools/tdpt-render/plan/plan.h"

namespace tdpt {

/// The picture after its first `spp` samples per pixel.
struct FrameRecord {
  uint64_t spp = 0;
  double nonzero = 0;                   ///< share of pixels that are not black
  Vec3d mean;                           ///< over all pixels
  double seconds = 0, cpu_seconds = 0;  ///< of rendering so far
  friend bool operator==(const FrameRecord&, const FrameRecord&) = default;
};

struct Progress {
  Progress(Film empty, const Limits& limits_)
      : film(std::move(empty)), tally(film.unit()), limits(limits_), goal(limits_.spp) {}

  Film film;
  Tally tally;
  Limits limits;       ///< that end it: the job's, or those of the run that is resumed
  uint64_t first = 0;  ///< first sample of each pixel in the film
  uint64_t goal = 0;   ///< samples per pixel when complete; 0: as many as the time allows
  uint64_t added = 0;  ///< samples that --add-samples last added to the goal
  uint64_t whole = 0;  ///< of the whole picture, of which this is a part; 0: `goal`
  double seconds = 0, cpu_seconds = 0;  ///< of rendering so far
  double began = 0;                     ///< part of `seconds` before the picture's first sample [s]
  uint64_t retried = 0;                 ///< samples found to be needed by --set retry; 0: none
  PictureBlocks blocks;                 ///< of all samples, at the watched pixels [noise.h]
  std::vector<FrameRecord> frames;      ///< if the job asks for them
  bool interrupted = false;             ///< by a signal; not stored

  /// The limits, or the number of samples alone once --add-samples has raised that.
  Limits in_force() const { return added > 0 ? Limits{.spp = goal} : limits; }
  uint64_t next() const { return first + film.samples(); }  ///< index of the next sample
  /// Samples per pixel of the whole picture, as far as is known.
  uint64_t spp() const { return std::max(whole > 0 ? whole : goal, next()); }
};

/// A film file of it. `facts`: what is known beside plan and progress; the rest is filled in.
std::string film_bytes(Progress& progress, const Plan& plan, FilmFacts facts,
                       const Channels& channels);
/// Plan and progress of a film file, also of one of a picture's first samples, as exrmerge writes
/// it. `name`: the file's in messages. Throws InputError.
Plan plan_of(const FilmFacts& facts, const std::string& name);
Progress progress_of(FilmFile file, const std::string& name);

}  // namespace tdpt
