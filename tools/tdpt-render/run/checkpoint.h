// What --checkpoint, --resume, --plan and --shard make of a rendering: which plan it obeys, where
// it begins, and what its film says of itself, so that no film is ever added to that of another
// picture.
#pragma once
#include <string>

#include "tools/tdpt-render/run/arguments.h"
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

/// One of `of` parts of a picture's samples.
struct Shard {
  uint64_t index = 0, of = 1;
  /// Its samples, of those from `first` on: as many as others have, or one less.
  SampleRange part(uint64_t first, uint64_t samples) const;
};
/// Reads "I/N". Throws UsageError.
Shard shard_of(const std::string& text);

/// Throws UsageError for options that contradict each other, and for a checkpoint that would be
/// written over.
void check_schedule(const Arguments& a);

/// Of one in the scene its name says all, of another where it stands.
std::string camera_words(const Arguments& a, const Frame& frame, const Camera& camera);

/// All that shapes the picture beside its plan and its samples.
struct Shaping {
  const Scene& scene;
  TakenSky sky;
  std::string camera;                      ///< camera_words()
  std::vector<std::string> portal_hashes;  ///< in order
  int width, height;
  uint64_t seed;
};
Shape shape_of(const Arguments& a, const Shaping& by);
/// And its film: what sums it keeps.
Shape film_shape_of(const Arguments& a, const Shaping& by);

struct Checkpoint {
  RenderSchedule schedule;
  std::string plan_file;  ///< that the plan of the schedule is from; empty: it is to be decided
  /// Attributes of the picture, as the film that is gone on from has them; empty: there is none.
  std::map<std::string, std::string> attributes;
  std::string command;    ///< that made the plan; empty: this one
  std::string processor;  ///< whose code has rendered the film so far; empty: there is none
};
/// Reads what is to be gone on from, or obeyed, and changes `settings` to what that says of limits.
/// Throws UsageError or InputError where they do not belong together.
/// `is_plan`: --plan names a plan to obey.
Checkpoint read_checkpoint(const Arguments& a, const Shaping& by, const World& world, bool is_plan,
                           RenderSettings& settings);

/// Why a film that was rendered by the code `before` becomes another one where that of `now` goes
/// on.
std::string other_code_sentence(const std::string& file, const std::string& before,
                                const std::string& now);

/// Throws InputError where what is gone on from keeps other sums than those options ask for.
void check_film(const Checkpoint& given, const Film::Options& options);

/// The film file of a rendering. `derived`, `attributes`, `channels`: of the whole picture.
std::string film_bytes(RenderState& render_state, const Plan& plan, const Shape& shape,
                       const std::string& processor, const std::vector<std::string>& derived,
                       const std::map<std::string, std::string>& attributes,
                       const Channels& channels);

/// --shard all/N: the commands of the shards, one a line, for a shell: PICTURE.I-of-N.exr of the
/// `output` PICTURE.exr each. `arguments`: the command line. Throws UsageError where that says not
/// how many samples there are, and where shards would be in each other's way.
std::string shard_commands(const Arguments& a, const std::vector<std::string>& arguments,
                           const std::string& output);
/// That merges what they render.
std::string merge_command(const Arguments& a, const std::string& output);

}  // namespace tdpt
