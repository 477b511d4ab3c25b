// The state of a rendering: its film, and whatever is needed to resume it. A checkpoint stores it,
// so that a night's work survives its process.
#pragma once
#include <algorithm>
#include <optional>
#include <string>

#include "libcommon/film/film_file.h"
#include "tools/tdpt-render/path/sample/tally.h"
#include "tools/tdpt-render/plan/decision.h"

namespace tdpt {

/// The picture after its first `spp` samples per pixel.
struct FrameRecord {
  uint64_t spp = 0;
  double nonzero = 0;                   ///< share of pixels that are not black
  Vec3d mean;                           ///< over all pixels
  double seconds = 0, cpu_seconds = 0;  ///< of rendering so far
  friend bool operator==(const FrameRecord&, const FrameRecord&) = default;
};

struct RenderState {
  RenderState(Film empty, const Limits& limits_)
      : film(std::move(empty)), tally(film.unit()), limits(limits_), goal(limits_.spp) {}

  Film film;
  Tally tally;
  Limits limits;
  uint64_t first = 0;  ///< first sample of each pixel in the film
  uint64_t goal = 0;   ///< samples per pixel when complete; 0: as many as the time allows
  uint64_t added = 0;  ///< samples that --add-samples last added to the goal; no `limits` then
  uint64_t whole = 0;  ///< of the whole picture, of which this is a part; 0: `goal`
  double seconds = 0, cpu_seconds = 0;  ///< of rendering so far
  double began = 0;                     ///< part of `seconds` before the picture's first sample [s]
  std::optional<TargetOutcome> target;
  ErrorPilot pilot;
  PictureBlocks blocks;              ///< of all samples, at the watched pixels [noise.h]
  std::optional<Measured> measured;  ///< none: a plan was obeyed
  std::vector<FrameRecord> frames;

  uint64_t next() const { return first + film.samples(); }  ///< index of the next sample
  /// Samples per pixel of the whole picture, as far as is known.
  uint64_t spp() const { return std::max(whole > 0 ? whole : goal, next()); }
};

/// The sums of the tally, which add over parts of a picture.
Counts counts_of(const Tally& tally);
/// The reverse. Ignores counts that this program does not know, and surplus ones.
void add_counts(const Counts& counts, Tally& tally);

/// Everything except film, sums of the tally and blocks, as JSON.
std::string render_state_text(const RenderState& render_state);
/// The blocks as a film file stores them, and the render state read back from one. `name`: the
/// file's in messages. Throws InputError.
StateWords blocks_of(const RenderState& render_state);
RenderState render_state_of(FilmFile file, const std::string& name);

}  // namespace tdpt
