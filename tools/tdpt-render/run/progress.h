// What has been rendered of a picture: its film, and what its numbers hang on. A checkpoint stores
// it, so that a night's work survives its process. How --resume and --shard affect a rendering:
// where it begins, and which samples it has.
#pragma once
#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "libcommon/film/film_file.h"
#include "libcommon/options/render_options.h"
#include "tools/tdpt-render/path/sample/tally.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/plan/noise.h"
#include "tools/tdpt-render/plan/plan.h"

namespace tdpt {

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
  ErrorPilot error_pilot;               ///< as the plan has it
  PictureBlocks blocks;                 ///< of all samples, at the watched pixels [noise.h]
  bool interrupted = false;             ///< by a signal; not stored

  /// The limits, or the number of samples alone once --add-samples has raised that.
  Limits in_force() const { return added > 0 ? Limits{.spp = goal} : limits; }
  uint64_t next() const { return first + film.samples(); }  ///< index of the next sample
  /// Samples per pixel of the whole picture, as far as is known.
  uint64_t spp() const { return std::max(whole > 0 ? whole : goal, next()); }
};

/// What was decided by measuring, in words and numbers: the same in all parts of a picture.
std::string plan_words(const Plan& plan);
/// The label of the candidate that renders by such a plan, and the samples of the exploration.
std::string label_in(const std::string& plan_words);
double explored_in(const std::string& plan_words);

/// A film file of it. `facts`: what is known beside plan and progress; the rest is filled in.
std::string film_bytes(Progress& progress, const Plan& plan, FilmFacts facts,
                       const Channels& channels);
/// The progress in a film file, also in one of a picture's first samples, as exrmerge writes it.
/// `name`: the file's in messages. Throws InputError.
Progress progress_of(FilmFile file, const std::string& name);

/// Throws UsageError for a checkpoint that would be overwritten.
void check_checkpoint(const RenderArguments& a);
/// Makes `progress` that of the part, where there is --shard.
void take_part(const RenderArguments& a, Progress& progress);

/// A picture that was begun before.
struct Begun {
  std::shared_ptr<Progress> progress;  ///< with the limits and the goal of this run
  FilmFacts facts;
};
/// Reads the film of --resume; nothing if none is to be resumed. `is_of`: what determines this
/// picture. Throws UsageError or InputError if they do not belong together.
std::optional<Begun> read_begun(const RenderArguments& a, const Fingerprint& is_of,
                                const Vista& vista);

/// Explains why a film rendered by the code `before` changes when resumed by that of `now`.
std::string other_code_sentence(const std::string& file, const std::string& before,
                                const std::string& now);

}  // namespace tdpt
